/* What this port gives the module of all Cortex-M ports. */
#include "hal/cortex_m/port.h"

#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/parameter_flash.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/control_interrupt.h"
#include "hal/stm32g474/cycle_counter.h"
#include "hal/stm32g474/flash_errors.h"
#include "hal/stm32g474/pwm.h"
#include "hal/stm32g474/registers.h"
#include "hal/stm32g474/watchdog.h"

const struct hal_facts port_facts = {
    .board_name = BOARD_NAME,
    .control_period_s = CONTROL_PERIOD_us / 1e6,
    .pwm_half_period_counts = PWM_HALF_PERIOD,
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
    .has_encoder_index = ENCODER_INDEX_CHANNEL != 0,
    .bridge_resistance_ohm = BRIDGE_RESISTANCE_OHM,
    .bridge_ntc_beta_K = BRIDGE_NTC_BETA_K,
    .encoder_counts_per_turn = ENCODER_COUNTS_PER_TURN, /* by the build; 0: settings may say */
    .cycle_counter_Hz = CORE_Hz,
    .parameter_page_bytes = FLASH_PAGE_BYTES,
    .parameter_word_bytes = PARAMETER_WORD_BYTES,
};

bool port_bridge_enable(void)
{
    return control_allow_bridge();
}

void port_bridge_disable(void)
{
    control_forbid_bridge();
}

uint16_t port_bridge_temperature(void)
{
    return control_bridge_temperature();
}

uint32_t port_cycle_count(void)
{
    return cycle_counter_read();
}

/* Whole control periods; their index wraps after five days, which is noticed here. */
uint64_t port_time_us(void)
{
    static uint32_t last, wraps;
    const uint32_t primask = interrupts_save_and_disable();
    const uint32_t periods = port_control_period() + 1u; /* 0 before the first */

    wraps += periods < last;
    last = periods;

    const uint64_t all = ((uint64_t)wraps << 32) + periods;

    interrupts_restore(primask);
    return all * CONTROL_PERIOD_us;
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
    parameter_flash_forget_corrected();
    watchdog_feed();
}

/* TIM1's registers answer only with its clock; without, its outputs are off as after a reset. */
IN_FAULT_MEMORY(port_open_bridge)
__attribute__((used)) void port_open_bridge(void)
{
    if (RCC->apb2enr & RCC_APB2ENR_TIM1EN) {
        pwm_open_bridge();
    }
}

enum { NMI_OTHER, NMI_CRYSTAL, NMI_FLASH, NMI_MEMORY };

IN_FAULT_MEMORY(port_nmi_cause)
uint32_t port_nmi_cause(void)
{
    if (RCC->cifr & RCC_CIFR_CSSF) {
        return NMI_CRYSTAL;
    }
    if (FLASH->eccr & FLASH_ECCR_ECCD) {
        return NMI_FLASH;
    }
    const bool clocked = (RCC->apb2enr & RCC_APB2ENR_SYSCFGEN) != 0;

    return clocked && (SYSCFG->cfgr2 & SYSCFG_CFGR2_SPF) ? NMI_MEMORY : NMI_OTHER;
}

const char *port_nmi_text(uint32_t nmi_cause)
{
    static const char *const texts[4] = {"non-maskable interrupt", "clock lost (NMI)",
                                         "double error in flash (NMI)", "parity of SRAM (NMI)"};

    return texts[nmi_cause % 4u];
}

enum reset_cause port_take_reset_cause(void)
{
    const uint32_t csr = RCC->csr;

    RCC->csr = csr | RCC_CSR_RMVF;
    if (csr & RCC_CSR_BORRSTF) {
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
