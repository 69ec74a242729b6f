#include "hal/stm32g474/watchdog.h"

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/board.h"

enum {
    LSI_Hz = 32000,
    DIVIDED_Hz = LSI_Hz / 4,
    OSCILLATOR_WAIT = 20000, /* passes, > 470 us; LSI starts in 130 us */
    UPDATE_WAIT = 100000,    /* passes, > 2.3 ms; five LSI cycles, 160 us, each */
};

void watchdog_start(void)
{
    DBGMCU->apb1lfzr |= DBGMCU_APB1LFZR_IWDG;
    RCC->csr |= RCC_CSR_LSION;
    if (!wait_until(&RCC->csr, RCC_CSR_LSIRDY, RCC_CSR_LSIRDY, OSCILLATOR_WAIT)) {
        board_fault(BOARD_FAULT_CLOCK_WATCHDOG);
    }
    IWDG->kr = IWDG_KEY_START;
    IWDG->kr = IWDG_KEY_ACCESS;
    IWDG->pr = IWDG_PR_PR(IWDG_PRESCALER_4);
    IWDG->rlr = IWDG_RLR_RL(DIVIDED_Hz * WATCHDOG_ms / 1000);
    if (!wait_until(&IWDG->sr, IWDG_SR_PVU | IWDG_SR_RVU, 0, UPDATE_WAIT)) {
        board_fault(BOARD_FAULT_WATCHDOG);
    }
    watchdog_feed();
}
