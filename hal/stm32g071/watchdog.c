#include "hal/stm32g071/watchdog.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g071/board.h"

enum { UPDATE_WAIT = 100000 }; /* passes, > 6 ms; five LSI cycles, 160 us, each */

void watchdog_start(void)
{
    DBG->apbfz1 |= DBG_APBFZ1_IWDG;
    /* LSI 32 kHz, divided by 32: 1 kHz. */
    IWDG->kr = IWDG_START;
    IWDG->kr = IWDG_UNLOCK;
    IWDG->pr = IWDG_DIV32;
    IWDG->rlr = WATCHDOG_ms;
    if (!wait_until(&IWDG->sr, IWDG_SR_PVU | IWDG_SR_RVU, 0, UPDATE_WAIT)) {
        board_fault(BOARD_FAULT_WATCHDOG);
    }
    watchdog_feed();
}
