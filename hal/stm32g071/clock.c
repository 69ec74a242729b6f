#include "hal/stm32g071/clock.h"

#include "hal/cortex_m/wait.h"
#include "hal/stm32g071/registers.h"

enum { READY_WAIT = 100000 }; /* passes at 16 MHz, > 25 ms; the PLL locks in 40 us */

bool clock_start(void)
{
    RCC->ahbenr |= RCC_AHBENR_FLASHEN;
    /* Without DBG_SWEN no debugger reaches the running program: it can be flashed once only. */
    FLASH->acr = FLASH_ACR_DBG_SWEN | FLASH_ACR_LATENCY(FLASH_WAIT_STATES_64_MHZ) |
                 FLASH_ACR_PRFTEN | FLASH_ACR_ICEN;
    if (!wait_until(&FLASH->acr, FLASH_ACR_LATENCY(7), FLASH_ACR_LATENCY(FLASH_WAIT_STATES_64_MHZ),
                    READY_WAIT)) {
        return false;
    }
    RCC->pllcfgr = RCC_PLLCFGR_PLLSRC(RCC_PLL_SOURCE_HSI16) | RCC_PLLCFGR_PLLM(RCC_PLLM_DIV1) |
                   RCC_PLLCFGR_PLLN(8) | RCC_PLLCFGR_PLLR(RCC_PLLR_DIV2) | RCC_PLLCFGR_PLLREN;
    RCC->cr |= RCC_CR_PLLON;
    if (!wait_until(&RCC->cr, RCC_CR_PLLRDY, RCC_CR_PLLRDY, READY_WAIT)) {
        return false;
    }
    RCC->cfgr = RCC_CFGR_SW(RCC_SYSCLK_PLLRCLK);
    return wait_until(&RCC->cfgr, RCC_CFGR_SWS(7), RCC_CFGR_SWS(RCC_SYSCLK_PLLRCLK), READY_WAIT);
}

void clock_of_blocks(void)
{
    RCC->gpioenr = RCC_GPIOENR_GPIOAEN | RCC_GPIOENR_GPIOBEN | RCC_GPIOENR_GPIOCEN;
    RCC->ahbenr |= RCC_AHBENR_DMA1EN;
    RCC->apbenr1 |=
        RCC_APBENR1_TIM2EN | RCC_APBENR1_TIM3EN | RCC_APBENR1_LPUART1EN | RCC_APBENR1_DBGEN;
    RCC->apbenr2 |= RCC_APBENR2_TIM1EN | RCC_APBENR2_ADCEN;
    (void)RCC->apbenr2; /* a block answers two cycles after its clock is enabled */
}

void cycle_counter_start(void)
{
    TIM2->arr = UINT32_MAX;
    TIM2->egr = TIM_EGR_UG;
    TIM2->cr1 = TIM_CR1_CEN;
}

uint32_t clock_cycles(void)
{
    return TIM2->cnt;
}

void clock_wait_us(uint32_t us)
{
    const uint32_t start = TIM2->cnt;

    while (TIM2->cnt - start < us * CORE_CYCLES_PER_us) {
    }
}
