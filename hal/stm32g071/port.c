/* What this port gives the module of all Cortex-M ports. */
#include "hal/cortex_m/port.h"

#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/parameter_flash.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/bridge.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/converter.h"
#include "hal/stm32g071/registers.h"
#include "hal/stm32g071/watchdog.h"

const struct hal_facts port_facts = {
    .board_name = BOARD_NAME,
    .control_period_s = CONTROL_PERIOD_us / 1e6,
    .pwm_half_period_counts = BRIDGE_HALF_PERIOD_COUNTS,
    .dead_time_s = BRIDGE_DEAD_TIME_s,
    .leg_delay_s = LEG_DELAY_s,
    .low_state_s = LOW_STATE_s,
    .converter_codes = CONVERTER_CODES,
    .current_A_per_code = CURRENT_A_PER_CODE,
    .current_zero_code = CURRENT_ZERO_CODE,
    .current_offset_codes = CURRENT_OFFSET_CODES,
    .bus_V_per_code = BUS_V_PER_CODE,
    .phase_voltage_V_per_code = PHASE_VOLTAGE_V_PER_CODE,
    .has_phase_voltages = true,
    .has_brake = HAS_BRAKE,
    .bridge_resistance_ohm = BRIDGE_RESISTANCE_OHM,
    .bridge_ntc_beta_K = BRIDGE_NTC_BETA_K,
    .cycle_counter_Hz = CORE_CLOCK_Hz,
    .parameter_page_bytes = FLASH_PAGE_BYTES,
    .parameter_word_bytes = PARAMETER_WORD_BYTES,
};

bool port_bridge_enable(void)
{
    return bridge_enable();
}

void port_bridge_disable(void)
{
    bridge_disable();
}

/* Of the last group: DMA writes a half-word at once. */
uint16_t port_bridge_temperature(void)
{
    return *(const volatile uint16_t *)&converter_groups[LEG_VOLTAGE_SAMPLES - 1].temperature;
}

uint32_t port_cycle_count(void)
{
    return clock_cycles();
}

/* The background asks far more often than the counter wraps, every 67 s. */
uint64_t port_time_us(void)
{
    static uint64_t cycles;

    cycles += (uint32_t)(clock_cycles() - (uint32_t)cycles);
    return cycles / CORE_CYCLES_PER_us;
}

void port_defer_interrupts(bool defers)
{
    if (defers) {
        __disable_irq();
    } else {
        __enable_irq();
    }
}

void port_watchdog_feed(void)
{
    watchdog_feed();
}

/* TIM1 and the bridge's RESET answer only with their clocks; without, RESET is pulled low. */
__attribute__((used, noinline)) void port_open_bridge(void)
{
    if (RCC->apbenr2 & RCC_APBENR2_TIM1EN) {
        bridge_open();
    }
}

uint32_t port_nmi_cause(void)
{
    return (FLASH->eccr & FLASH_ECCR_ECCD) != 0;
}

const char *port_nmi_text(uint32_t nmi_cause)
{
    return nmi_cause != 0 ? "double error in flash (NMI)" : "non-maskable interrupt";
}

enum reset_cause port_take_reset_cause(void)
{
    const uint32_t csr = RCC->csr;

    RCC->csr = csr | RCC_CSR_RMVF;
    if (csr & RCC_CSR_PWRRSTF) {
        return RESET_POWER_ON;
    }
    if (csr & RCC_CSR_IWDGRSTF) {
        return RESET_WATCHDOG;
    }
    if (csr & RCC_CSR_SFTRSTF) {
        return RESET_SOFTWARE;
    }
    return csr & RCC_CSR_PINRSTF ? RESET_PIN : RESET_UNKNOWN;
}
