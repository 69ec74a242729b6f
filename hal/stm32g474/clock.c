#include "hal/stm32g474/clock.h"

#include <stdbool.h>

#include "hal/cortex_m/crash.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

/*
 * Both sources are divided to the 4 MHz at which the PLL compares: x 85 / 2 = 170 MHz. Register
 * fields hold the division less one.
 */
enum {
    PLL_INPUT_Hz = 4000000,
    PLL_MULTIPLIER = 85,
    SUPPLY_LEVEL = 6,      /* falls below 2.84...2.96 V, is back by 3.04 V (DS12288) */
    FLASH_WAIT_STATES = 4, /* 136...170 MHz in range 1 boost (RM0440, table of wait states) */
};

/* Passes of wait_until at 16 MHz: 4 cycles and more each, so these are lower bounds of time. */
enum {
    SUPPLY_WAIT = 400000,  /* 100 ms */
    CRYSTAL_WAIT = 80000,  /* 20 ms; the crystal takes 2 ms */
    REGULATOR_WAIT = 4000, /* 1 ms */
    PLL_WAIT = 4000,
    SWITCH_WAIT = 4000,
};

static bool start_crystal(void)
{
    if (CRYSTAL_Hz == 0) {
        return false;
    }
    RCC->cr |= RCC_CR_HSEON;
    if (wait_until(&RCC->cr, RCC_CR_HSERDY, RCC_CR_HSERDY, CRYSTAL_WAIT)) {
        return true;
    }
    RCC->cr &= ~RCC_CR_HSEON;
    return false;
}

/* The monitor stays on: from pwm_configure on it opens the bridge. */
static void await_supply(void)
{
    RCC->apb1enr1 |= RCC_APB1ENR1_PWREN;
    (void)RCC->apb1enr1;
    PWR->cr2 = PWR_CR2_PLS(SUPPLY_LEVEL) | PWR_CR2_PVDE;
    if (!wait_until(&PWR->sr2, PWR_SR2_PVDO, 0, SUPPLY_WAIT)) {
        board_fault(BOARD_FAULT_SUPPLY);
    }
}

static void boost_regulator(void)
{
    PWR->cr3 |= PWR_CR3_UCPD1_DBDIS; /* releases the pull-down of USB Type-C on PB6 */
    PWR->cr5 &= ~PWR_CR5_R1MODE;
    if (!wait_until(&PWR->sr2, PWR_SR2_VOSF, 0, REGULATOR_WAIT)) {
        board_fault(BOARD_FAULT_CLOCK_REGULATOR);
    }
}

static void set_flash_latency(void)
{
    /* Without DBG_SWEN no debugger reaches the running program: it can be flashed once only. */
    FLASH->acr = FLASH_ACR_DBG_SWEN | FLASH_ACR_LATENCY(FLASH_WAIT_STATES) | FLASH_ACR_PRFTEN |
                 FLASH_ACR_ICEN | FLASH_ACR_DCEN;
    if (!wait_until(&FLASH->acr, FLASH_ACR_LATENCY(15), FLASH_ACR_LATENCY(FLASH_WAIT_STATES),
                    SWITCH_WAIT)) {
        board_fault(BOARD_FAULT_CLOCK_FLASH_LATENCY);
    }
}

static void start_pll(bool crystal)
{
    const uint32_t source = crystal ? RCC_PLL_SOURCE_HSE : RCC_PLL_SOURCE_HSI16;
    const uint32_t division = (crystal ? CRYSTAL_Hz : HSI16_Hz) / PLL_INPUT_Hz;

    RCC->pllcfgr = RCC_PLLCFGR_PLLSRC(source) | RCC_PLLCFGR_PLLM(division - 1) |
                   RCC_PLLCFGR_PLLN(PLL_MULTIPLIER) | RCC_PLLCFGR_PLLR(RCC_PLLR_DIV2) |
                   RCC_PLLCFGR_PLLREN;
    RCC->cr |= RCC_CR_PLLON;
    if (!wait_until(&RCC->cr, RCC_CR_PLLRDY, RCC_CR_PLLRDY, PLL_WAIT)) {
        board_fault(BOARD_FAULT_CLOCK_PLL);
    }
}

/* Above 80 MHz in two steps, with half the speed for a microsecond (RM0440, PWR, range 1 boost). */
static void switch_to_pll(void)
{
    RCC->cfgr |= RCC_CFGR_HPRE(RCC_HPRE_DIV2);
    RCC->cfgr |= RCC_CFGR_SW(RCC_SYSCLK_PLL);
    if (!wait_until(&RCC->cfgr, RCC_CFGR_SWS(3), RCC_CFGR_SWS(RCC_SYSCLK_PLL), SWITCH_WAIT)) {
        board_fault(BOARD_FAULT_CLOCK_SWITCH);
    }
    wait_cycles(CORE_Hz / 1000000);
    RCC->cfgr &= ~RCC_CFGR_HPRE(15);
}

void clock_start(void)
{
    await_supply();
    const bool crystal = start_crystal();

    boost_regulator();
    set_flash_latency();
    start_pll(crystal);
    switch_to_pll();
    if (crystal) {
        RCC->cr |= RCC_CR_CSSON; /* a stop of the crystal opens the bridge and raises NMI */
    }
}
