/*
 * The STM32G071's registers, as far as this port uses them. Names follow the reference manual
 * RM0444; structs mirror the register maps, gaps are `reserved`. Every address, bit position,
 * width, interrupt and request number is compared with an independent register description
 * (tests/board/check_registers_g071.py), so the lines keep to one simple form:
 *
 *   #define FIELD_NAME BIT(position)              a flag
 *   #define FIELD_NAME(value) FIELD(value, position, width)
 *   #define PERIPHERAL ((struct some_registers *)0xaddress)
 */
#ifndef STEADYSTEP_STM32G071_REGISTERS_H
#define STEADYSTEP_STM32G071_REGISTERS_H

#include <stdint.h>

#define BIT(position)                 (UINT32_C(1) << (position))
#define FIELD(value, position, width) (((uint32_t)(value) & (BIT(width) - 1u)) << (position))

/* Memories. */
#define FLASH_BANK_1     0x08000000u
#define FLASH_BANK_BYTES 0x20000u /* one bank */
#define FLASH_PAGE_BYTES 2048u

/* ---- Reset and clock control ---- */
struct rcc_registers {
    volatile uint32_t cr, icscr, cfgr, pllcfgr, reserved0, crrcr, cier, cifr, cicr;
    volatile uint32_t gpiorstr, ahbrstr, apbrstr1, apbrstr2;
    volatile uint32_t gpioenr, ahbenr, apbenr1, apbenr2;
    volatile uint32_t gpiosmenr, ahbsmenr, apbsmenr1, apbsmenr2;
    volatile uint32_t ccipr, ccipr2, bdcr, csr;
};
#define RCC ((struct rcc_registers *)0x40021000u)

#define RCC_CR_HSIRDY             BIT(10)
#define RCC_CR_PLLON              BIT(24)
#define RCC_CR_PLLRDY             BIT(25)
#define RCC_CFGR_SW(value)        FIELD(value, 0, 3)
#define RCC_CFGR_SWS(value)       FIELD(value, 3, 3)
#define RCC_PLLCFGR_PLLSRC(value) FIELD(value, 0, 2)
#define RCC_PLLCFGR_PLLM(value)   FIELD(value, 4, 3)
#define RCC_PLLCFGR_PLLN(value)   FIELD(value, 8, 7)
#define RCC_PLLCFGR_PLLREN        BIT(28)
#define RCC_PLLCFGR_PLLR(value)   FIELD(value, 29, 3)
#define RCC_GPIOENR_GPIOAEN       BIT(0)
#define RCC_GPIOENR_GPIOBEN       BIT(1)
#define RCC_GPIOENR_GPIOCEN       BIT(2)
#define RCC_AHBENR_DMA1EN         BIT(0)
#define RCC_AHBENR_FLASHEN        BIT(8)
#define RCC_APBENR1_TIM2EN        BIT(0)
#define RCC_APBENR1_TIM3EN        BIT(1)
#define RCC_APBENR1_LPUART1EN     BIT(20)
#define RCC_APBENR1_DBGEN         BIT(27)
#define RCC_APBENR1_PWREN         BIT(28)
#define RCC_APBENR2_TIM1EN        BIT(11)
#define RCC_APBENR2_ADCEN         BIT(20)
#define RCC_CSR_LSION             BIT(0)
#define RCC_CSR_LSIRDY            BIT(1)
#define RCC_CSR_RMVF              BIT(23)
#define RCC_CSR_PINRSTF           BIT(26)
#define RCC_CSR_PWRRSTF           BIT(27)
#define RCC_CSR_SFTRSTF           BIT(28)
#define RCC_CSR_IWDGRSTF          BIT(29)

enum { RCC_SYSCLK_PLLRCLK = 2 };   /* SW, SWS */
enum { RCC_PLL_SOURCE_HSI16 = 2 }; /* PLLSRC */
enum { RCC_PLLM_DIV1 = 0, RCC_PLLR_DIV2 = 1 };

/* ---- Embedded flash ---- */
struct flash_registers {
    volatile uint32_t acr, reserved0, keyr, optkeyr, sr, cr, eccr;
};
#define FLASH ((struct flash_registers *)0x40022000u)

#define FLASH_ACR_LATENCY(value) FIELD(value, 0, 3)
#define FLASH_ACR_PRFTEN         BIT(8)
#define FLASH_ACR_ICEN           BIT(9)
#define FLASH_ACR_DBG_SWEN       BIT(18)
#define FLASH_SR_EOP             BIT(0)
#define FLASH_SR_OPERR           BIT(1)
#define FLASH_SR_PROGERR         BIT(3)
#define FLASH_SR_WRPERR          BIT(4)
#define FLASH_SR_PGAERR          BIT(5)
#define FLASH_SR_SIZERR          BIT(6)
#define FLASH_SR_PGSERR          BIT(7)
#define FLASH_SR_BSY1            BIT(16)
#define FLASH_SR_CFGBSY          BIT(18)
#define FLASH_CR_PG              BIT(0)
#define FLASH_CR_PER             BIT(1)
#define FLASH_CR_PNB(value)      FIELD(value, 3, 7)
#define FLASH_CR_STRT            BIT(16)
#define FLASH_CR_LOCK            BIT(31)
#define FLASH_ECCR_ECCC          BIT(30)
#define FLASH_ECCR_ECCD          BIT(31)

enum { FLASH_KEY1 = 0x45670123, FLASH_WAIT_STATES_64_MHZ = 2 };

/* ---- General-purpose ports ---- */
struct gpio_registers {
    volatile uint32_t moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afrl, afrh, brr;
};
#define GPIOA ((struct gpio_registers *)0x50000000u)
#define GPIOB ((struct gpio_registers *)0x50000400u)
#define GPIOC ((struct gpio_registers *)0x50000800u)

/* ---- Timers: TIM1 has all registers, the others a part of them at the same places ---- */
struct tim_registers {
    volatile uint32_t cr1, cr2, smcr, dier, sr, egr, ccmr1, ccmr2, ccer, cnt, psc, arr, rcr;
    volatile uint32_t ccr1, ccr2, ccr3, ccr4, bdtr, dcr, dmar, or1, ccmr3, ccr5, ccr6, af1, af2;
};
#define TIM1 ((struct tim_registers *)0x40012c00u)
#define TIM2 ((struct tim_registers *)0x40000000u)
#define TIM3 ((struct tim_registers *)0x40000400u)

#define TIM_CR1_CEN          BIT(0)
#define TIM_CR1_URS          BIT(2)
#define TIM_CR1_DIR          BIT(4)
#define TIM_CR1_CMS(value)   FIELD(value, 5, 2)
#define TIM_CR1_ARPE         BIT(7)
#define TIM_CR2_MMS(value)   FIELD(value, 4, 3)
#define TIM_SMCR_SMS(value)  FIELD(value, 0, 3)
#define TIM_SMCR_TS(value)   FIELD(value, 4, 3)
#define TIM_DIER_CC1IE       BIT(1)
#define TIM_DIER_BIE         BIT(7)
#define TIM_SR_UIF           BIT(0)
#define TIM_SR_CC1IF         BIT(1)
#define TIM_SR_BIF           BIT(7)
#define TIM_EGR_UG           BIT(0)
#define TIM_CCMR_OC1PE       BIT(3) /* CCMR1, and of channels 3 and 4 in CCMR2 */
#define TIM_CCMR_OC1M(value) FIELD(value, 4, 3)
#define TIM_CCMR_OC2PE       BIT(11)
#define TIM_CCMR_OC2M(value) FIELD(value, 12, 3)
#define TIM_CCER_CC1E        BIT(0)
#define TIM_CCER_CC2E        BIT(4)
#define TIM_CCER_CC3E        BIT(8)
#define TIM_CCER_CC4E        BIT(12)
#define TIM_BDTR_OSSI        BIT(10)
#define TIM_BDTR_OSSR        BIT(11)
#define TIM_BDTR_BKE         BIT(12)
#define TIM_BDTR_MOE         BIT(15)
#define TIM_AF1_BKINE        BIT(0)

enum { TIM_CENTRE_ALIGNED_1 = 1 };                     /* CMS */
enum { TIM_MASTER_ENABLE = 1, TIM_MASTER_UPDATE = 2 }; /* MMS */
enum { TIM_SLAVE_TRIGGER = 6, TIM3_TRIGGER_TIM1 = 0 }; /* SMS, TS: ITR0 */
enum { TIM_PWM_1 = 6 };                                /* OCxM: high while CNT < CCR */

/* ---- Analogue-to-digital converter ---- */
struct adc_registers {
    volatile uint32_t isr, ier, cr, cfgr1, cfgr2, smpr;
    volatile uint32_t reserved0[2];
    volatile uint32_t awd1tr, awd2tr, chselr, awd3tr;
    volatile uint32_t reserved1[4];
    volatile uint32_t dr;
};
#define ADC1 ((struct adc_registers *)0x40012400u)

#define ADC_ISR_ADRDY                BIT(0)
#define ADC_ISR_OVR                  BIT(4)
#define ADC_ISR_CCRDY                BIT(13)
#define ADC_CR_ADEN                  BIT(0)
#define ADC_CR_ADSTART               BIT(2)
#define ADC_CR_ADSTP                 BIT(4)
#define ADC_CR_ADVREGEN              BIT(28)
#define ADC_CR_ADCAL                 BIT(31)
#define ADC_CFGR1_DMAEN              BIT(0)
#define ADC_CFGR1_DMACFG             BIT(1)
#define ADC_CFGR1_EXTSEL(value)      FIELD(value, 6, 3)
#define ADC_CFGR1_EXTEN(value)       FIELD(value, 10, 2)
#define ADC_CFGR1_OVRMOD             BIT(12)
#define ADC_CFGR1_CHSELRMOD          BIT(21)
#define ADC_SMPR_SAMPLE_TIME1(value) FIELD(value, 0, 3)
#define ADC_CFGR2_CKMODE(value)      FIELD(value, 30, 2)

enum { ADC_CLOCK_PCLK_DIV2 = 1 };     /* CKMODE */
enum { ADC_TRIGGER_TIM3_TRGO = 3 };   /* EXTSEL */
enum { ADC_RISING_EDGE = 1 };         /* EXTEN */
enum { ADC_SAMPLING_3_5_CYCLES = 1 }; /* SMP1, here SAMPLE_TIME1 */

/* ---- Direct memory access and its request multiplexer ---- */
struct dma_channel_registers {
    volatile uint32_t cr, ndtr, par, mar, reserved0;
};
struct dma_registers {
    volatile uint32_t isr, ifcr;
    struct dma_channel_registers channel[7]; /* channel 1 is channel[0] */
};
#define DMA1 ((struct dma_registers *)0x40020000u)

#define DMA_ISR_TCIF2       BIT(5)
#define DMA_ISR_TCIF3       BIT(9)
#define DMA_IFCR_TCIF1      BIT(1)
#define DMA_IFCR_TCIF2      BIT(5)
#define DMA_IFCR_TCIF3      BIT(9)
#define DMA_CR_EN           BIT(0)
#define DMA_CR_TCIE         BIT(1)
#define DMA_CR_DIR          BIT(4)
#define DMA_CR_CIRC         BIT(5)
#define DMA_CR_MINC         BIT(7)
#define DMA_CR_PSIZE(value) FIELD(value, 8, 2)
#define DMA_CR_MSIZE(value) FIELD(value, 10, 2)
#define DMA_CR_PL(value)    FIELD(value, 12, 2)

enum { DMA_BYTES_1 = 0, DMA_BYTES_2 = 1 };
enum { DMA_PRIORITY_LOW = 0, DMA_PRIORITY_VERY_HIGH = 3 };

struct dmamux_registers {
    volatile uint32_t ccr[7]; /* of DMA channel 1 is ccr[0] */
};
#define DMAMUX1 ((struct dmamux_registers *)0x40020800u)

#define DMAMUX_CCR_DMAREQ_ID(value) FIELD(value, 0, 8)

enum { DMA_REQUEST_ADC1 = 5, DMA_REQUEST_LPUART1_RX = 14, DMA_REQUEST_LPUART1_TX = 15 };

/* ---- Low-power UART ---- */
struct lpuart_registers {
    volatile uint32_t cr1, cr2, cr3, brr;
    volatile uint32_t reserved0[2];
    volatile uint32_t rqr, isr, icr, rdr, tdr, presc;
};
#define LPUART1 ((struct lpuart_registers *)0x40008000u)

#define LPUART_CR1_UE         BIT(0)
#define LPUART_CR1_RE         BIT(2)
#define LPUART_CR1_TE         BIT(3)
#define LPUART_CR1_CMIE       BIT(14)
#define LPUART_CR2_ADD(value) FIELD(value, 24, 8)
#define LPUART_CR3_EIE        BIT(0)
#define LPUART_CR3_DMAR       BIT(6)
#define LPUART_CR3_DMAT       BIT(7)
#define LPUART_ISR_PE         BIT(0)
#define LPUART_ISR_FE         BIT(1)
#define LPUART_ISR_NE         BIT(2)
#define LPUART_ISR_ORE        BIT(3)
#define LPUART_ISR_RXNE       BIT(5)
#define LPUART_ISR_TXE        BIT(7)
#define LPUART_ISR_CMF        BIT(17)
#define LPUART_ICR_PE         BIT(0)
#define LPUART_ICR_FE         BIT(1)
#define LPUART_ICR_NE         BIT(2)
#define LPUART_ICR_ORE        BIT(3)
#define LPUART_ICR_CMF        BIT(17)

/* ---- Independent watchdog ---- */
struct iwdg_registers {
    volatile uint32_t kr, pr, rlr, sr, winr;
};
#define IWDG ((struct iwdg_registers *)0x40003000u)

#define IWDG_SR_PVU BIT(0)
#define IWDG_SR_RVU BIT(1)

enum { IWDG_START = 0xcccc, IWDG_UNLOCK = 0x5555, IWDG_FEED = 0xaaaa };
enum { IWDG_DIV32 = 3 };

/* ---- Debug support ---- */
struct dbg_registers {
    volatile uint32_t idcode, cr, apbfz1, apbfz2;
};
#define DBG ((struct dbg_registers *)0x40015800u)

#define DBG_APBFZ1_TIM3 BIT(1)
#define DBG_APBFZ1_IWDG BIT(12)
#define DBG_APBFZ2_TIM1 BIT(11)

#endif
