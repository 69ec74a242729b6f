/* What the board runs: start-up, the control interrupt, the main loop. */
#include <string.h>

#include "firmware/application/application.h"
#include "firmware/design/text.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/converter.h"
#include "hal/stm32g071/core.h"
#include "hal/stm32g071/crash.h"
#include "hal/stm32g071/handlers.h"
#include "hal/stm32g071/image.h"
#include "hal/stm32g071/serial.h"

/* The interrupt begins 3 us behind the peak; this is 7 us behind it. */
enum { CONTROL_BEGINS_ABOVE = BRIDGE_HALF_PERIOD_COUNTS - 7 * CORE_CYCLES_PER_us };

struct application application;

static struct {
    uint32_t period; /* index of the present or last control interrupt */
    struct leg_voltage_mean leg_voltages;
    /* what the last control interrupt took */
    uint32_t counter_at_start; /* of TIM1 */
    uint32_t start, end;       /* cycles */
} control = {.period = UINT32_MAX};

uint32_t board_period(void)
{
    return *(const volatile uint32_t *)&control.period;
}

/* The control interrupt: the group that was taken at S(k) is complete. */
IN_RAM(control_interrupt) void control_interrupt(void)
{
    const struct converter_group *peak = &converter_groups[LEG_VOLTAGE_SAMPLES - 1];
    struct hal_samples samples;

    control.start = clock_cycles();
    control.counter_at_start = TIM1->cnt;
    DMA1->ifcr = DMA_IFCR_TCIF1;
    control.period++;

    const struct leg_voltages legs = converter_leg_voltages();
    const struct phase_voltage_codes voltage = leg_voltage_mean_step(&control.leg_voltages, &legs);
    samples.current_a = peak->current_a;
    samples.current_b = peak->current_b;
    samples.bus_voltage = peak->bus;
    samples.temperature = peak->temperature;
    samples.phase_voltage_a = voltage.a;
    samples.phase_voltage_b = voltage.b;
    samples.encoder_count = 0;
    samples.flags = bridge_begin_period();
    if (control.counter_at_start < CONTROL_BEGINS_ABOVE) {
        samples.flags |= HAL_FLAG_DEADLINE_MISSED; /* began too late, or not at the peak */
    }

    const struct hal_outputs outputs = application_control_interrupt(&application, &samples);
    bridge_end_period(&outputs);
    const uint32_t end = clock_cycles();
    bridge_deadline_met(end);
    control.end = end;
    SCB->icsr = SCB_ICSR_PENDSVSET;
}

/*
 * Right behind it, and preempted by the next: what it took. Each reading of a counter costs the
 * interrupt a dozen cycles, so reading, control and writing are not told apart.
 */
void pend_sv_handler(void)
{
    struct control_cycles_of_period cycles = {.stage = {0}};

    cycles.stage[CONTROL_STAGE_LATENCY] = BRIDGE_HALF_PERIOD_COUNTS - control.counter_at_start;
    cycles.stage[CONTROL_STAGE_CONTROL] = control.end - control.start;
    application_count_cycles(&application, &cycles);
}

static void watchdog_start(void)
{
    /* LSI 32 kHz, divided by 32: 1 kHz. */
    IWDG->kr = IWDG_START;
    IWDG->kr = IWDG_UNLOCK;
    IWDG->pr = IWDG_DIV32;
    IWDG->rlr = WATCHDOG_ms;
    if (!clock_wait_for(&IWDG->sr, IWDG_SR_PVU | IWDG_SR_RVU, 0)) { /* LSI: 0.3 ms */
        board_fault(BOARD_FAULT_WATCHDOG);
    }
    IWDG->kr = IWDG_FEED;
}

/* No pins read an encoder: stored settings that ask for one are not in force. Kept apart for the
   stack of the settings. */
__attribute__((noinline)) static bool start_without_encoder(char error[DRIVE_ERROR_TEXT])
{
    const uint32_t asked = application.facts.encoder_counts_per_turn;
    struct drive_settings settings;

    if (asked == 0) {
        return true;
    }
    drive_settings_default(&settings, &motor_default);
    if (!application_init_with(&application, &board, &settings, error)) {
        return false;
    }
    application.settings_from = APPLICATION_SETTINGS_DEFAULT;
    application.stored_refused = true;
    struct text text = text_in(application.stored_refusal, sizeof application.stored_refusal);
    text_put(&text, "encoder counts per turn=");
    text_unsigned(&text, asked);
    text_put(&text, ": this board reads no encoder, expected 0");
    return true;
}

int main(void)
{
    static char error[DRIVE_ERROR_TEXT];

    if (!clock_start()) {
        board_fault(BOARD_FAULT_CLOCK);
    }
    crash_read_cause();
    bridge_start();
    pins_connect();
    serial_start();
    if (!application_init(&application, &board, &motor_default, error) ||
        !start_without_encoder(error)) {
        (void)serial_write((const uint8_t *)error, strlen(error));
        clock_wait_us(100000); /* for the text to leave */
        board_fault(BOARD_FAULT_SETTINGS_REFUSED);
    }
    if (!converter_start()) {
        board_fault(BOARD_FAULT_ADC_START);
    }
    if (!bridge_run()) {
        board_fault(BOARD_FAULT_PWM_PHASE);
    }
    interrupt_enable(INTERRUPT_DMA1_CHANNEL1, PRIORITY_CONTROL);
    SCB->shpr3 = (uint32_t)PRIORITY_STATISTICS << 22;
    if (!converter_synchronise()) {
        board_fault(BOARD_FAULT_ADC_PHASE);
    }
    bridge_guard_start();
    watchdog_start();
    for (;;) {
        application_background(&application);
        wait_for_interrupt();
    }
}
