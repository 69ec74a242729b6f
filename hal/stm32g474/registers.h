/*
 * The STM32G474's registers, as far as this port uses them. Names follow the reference manual
 * RM0440; structs mirror the register maps, gaps are `reserved`. Every address, bit position, width
 * and interrupt number is compared with an independent register description
 * (tests/board/check_registers.py), so the lines keep to one simple form:
 *
 *   #define FIELD_NAME BIT(position)              a flag
 *   #define FIELD_NAME(value) FIELD(value, position, width)
 *   #define PERIPHERAL ((struct some_registers *)0xaddress)
 */
#ifndef STEADYSTEP_STM32G474_REGISTERS_H
#define STEADYSTEP_STM32G474_REGISTERS_H

#include <stdint.h>

#include "hal/stm32g474/device.h" /* first: structs of CMSIS-Core have members named COMP1... */

#define BIT(position)                 (UINT32_C(1) << (position))
#define FIELD(value, position, width) (((uint32_t)(value) & (BIT(width) - 1u)) << (position))

/* Memories. */
#define FLASH_BANK_1     0x08000000u
#define FLASH_BANK_BYTES 0x40000u /* each of two banks, option DBANK set */
#define FLASH_PAGE_BYTES 2048u

/* ---- Reset and clock control ---- */
struct rcc_registers {
    volatile uint32_t cr, icscr, cfgr, pllcfgr;
    volatile uint32_t reserved0[2];
    volatile uint32_t cier, cifr, cicr;
    volatile uint32_t reserved1;
    volatile uint32_t ahb1rstr, ahb2rstr, ahb3rstr;
    volatile uint32_t reserved2;
    volatile uint32_t apb1rstr1, apb1rstr2, apb2rstr;
    volatile uint32_t reserved3;
    volatile uint32_t ahb1enr, ahb2enr, ahb3enr;
    volatile uint32_t reserved4;
    volatile uint32_t apb1enr1, apb1enr2, apb2enr;
    volatile uint32_t reserved5[9];
    volatile uint32_t ccipr;
    volatile uint32_t reserved6;
    volatile uint32_t bdcr, csr;
};
#define RCC ((struct rcc_registers *)0x40021000u)

#define RCC_CR_HSION                BIT(8)
#define RCC_CR_HSIRDY               BIT(10)
#define RCC_CR_HSEON                BIT(16)
#define RCC_CR_HSERDY               BIT(17)
#define RCC_CR_CSSON                BIT(19)
#define RCC_CR_PLLON                BIT(24)
#define RCC_CR_PLLRDY               BIT(25)
#define RCC_CFGR_SW(value)          FIELD(value, 0, 2)
#define RCC_CFGR_SWS(value)         FIELD(value, 2, 2)
#define RCC_CFGR_HPRE(value)        FIELD(value, 4, 4)
#define RCC_PLLCFGR_PLLSRC(value)   FIELD(value, 0, 2)
#define RCC_PLLCFGR_PLLM(value)     FIELD(value, 4, 4)
#define RCC_PLLCFGR_PLLN(value)     FIELD(value, 8, 7)
#define RCC_PLLCFGR_PLLREN          BIT(24)
#define RCC_PLLCFGR_PLLR(value)     FIELD(value, 25, 2)
#define RCC_CIFR_CSSF               BIT(8)
#define RCC_CICR_CSSC               BIT(8)
#define RCC_AHB1ENR_DMA1EN          BIT(0)
#define RCC_AHB1ENR_DMAMUX1EN       BIT(2)
#define RCC_AHB1ENR_FLASHEN         BIT(8)
#define RCC_AHB2ENR_GPIOAEN         BIT(0)
#define RCC_AHB2ENR_GPIOBEN         BIT(1)
#define RCC_AHB2ENR_GPIOCEN         BIT(2)
#define RCC_AHB2ENR_ADC12EN         BIT(13)
#define RCC_AHB2ENR_ADC345EN        BIT(14)
#define RCC_AHB2ENR_DAC3EN          BIT(18)
#define RCC_AHB2ENR_DAC4EN          BIT(19)
#define RCC_APB1ENR1_TIM2EN         BIT(0)
#define RCC_APB1ENR1_TIM3EN         BIT(1)
#define RCC_APB1ENR1_TIM4EN         BIT(2)
#define RCC_APB1ENR1_TIM5EN         BIT(3)
#define RCC_APB1ENR1_FDCANEN        BIT(25)
#define RCC_APB1ENR1_PWREN          BIT(28)
#define RCC_APB1ENR2_LPUART1EN      BIT(0)
#define RCC_APB2ENR_SYSCFGEN        BIT(0)
#define RCC_APB2ENR_TIM1EN          BIT(11)
#define RCC_APB2ENR_TIM8EN          BIT(13)
#define RCC_CCIPR_LPUART1SEL(value) FIELD(value, 10, 2)
#define RCC_CCIPR_FDCANSEL(value)   FIELD(value, 24, 2)
#define RCC_CSR_LSION               BIT(0)
#define RCC_CSR_LSIRDY              BIT(1)
#define RCC_CSR_RMVF                BIT(23)
#define RCC_CSR_PINRSTF             BIT(26)
#define RCC_CSR_BORRSTF             BIT(27)
#define RCC_CSR_SFTRSTF             BIT(28)
#define RCC_CSR_IWDGRSTF            BIT(29)

enum { RCC_SYSCLK_HSI16 = 1, RCC_SYSCLK_PLL = 3 }; /* SW, SWS */
enum { RCC_HPRE_DIV1 = 0, RCC_HPRE_DIV2 = 8 };     /* HPRE */
enum { RCC_PLL_SOURCE_HSI16 = 2, RCC_PLL_SOURCE_HSE = 3 };
enum { RCC_PLLR_DIV2 = 0 };
enum { RCC_LPUART1_PCLK = 0 };
enum { RCC_FDCAN_PCLK1 = 2 };

/* ---- Power control ---- */
struct pwr_registers {
    volatile uint32_t cr1, cr2, cr3, cr4, sr1, sr2, scr;
    volatile uint32_t reserved0[25];
    volatile uint32_t cr5;
};
#define PWR ((struct pwr_registers *)0x40007000u)

#define PWR_CR2_PVDE        BIT(0)
#define PWR_CR2_PLS(value)  FIELD(value, 1, 3)
#define PWR_CR3_UCPD1_DBDIS BIT(14)
#define PWR_SR2_VOSF        BIT(10)
#define PWR_SR2_PVDO        BIT(11)
#define PWR_CR5_R1MODE      BIT(8)

/* ---- Embedded flash ---- */
struct flash_registers {
    volatile uint32_t acr, pdkeyr, keyr, optkeyr, sr, cr, eccr;
    volatile uint32_t reserved0;
    volatile uint32_t optr;
};
#define FLASH ((struct flash_registers *)0x40022000u)

#define FLASH_ACR_LATENCY(value) FIELD(value, 0, 4)
#define FLASH_ACR_PRFTEN         BIT(8)
#define FLASH_ACR_ICEN           BIT(9)
#define FLASH_ACR_DCEN           BIT(10)
#define FLASH_ACR_DCRST          BIT(12)
#define FLASH_ACR_DBG_SWEN       BIT(18)
#define FLASH_SR_EOP             BIT(0)
#define FLASH_SR_OPERR           BIT(1)
#define FLASH_SR_PROGERR         BIT(3)
#define FLASH_SR_WRPERR          BIT(4)
#define FLASH_SR_PGAERR          BIT(5)
#define FLASH_SR_SIZERR          BIT(6)
#define FLASH_SR_PGSERR          BIT(7)
#define FLASH_SR_MISERR          BIT(8)
#define FLASH_SR_FASTERR         BIT(9)
#define FLASH_SR_BSY             BIT(16)
#define FLASH_CR_PG              BIT(0)
#define FLASH_CR_PER             BIT(1)
#define FLASH_CR_PNB(value)      FIELD(value, 3, 7)
#define FLASH_CR_BKER            BIT(11)
#define FLASH_CR_STRT            BIT(16)
#define FLASH_CR_LOCK            BIT(31)
#define FLASH_ECCR_BK_ECC        BIT(21)
#define FLASH_ECCR_ECCC          BIT(30)
#define FLASH_ECCR_ECCD          BIT(31)
#define FLASH_OPTR_BFB2          BIT(20)
#define FLASH_OPTR_DBANK         BIT(22)

enum { FLASH_KEY_1 = 0x45670123, FLASH_KEY_2 = (int)0xcdef89ab };

/* ---- General-purpose inputs and outputs ---- */
struct gpio_registers {
    volatile uint32_t moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afr[2];
};
#define GPIOA ((struct gpio_registers *)0x48000000u)
#define GPIOB ((struct gpio_registers *)0x48000400u)
#define GPIOC ((struct gpio_registers *)0x48000800u)

enum { GPIO_MODE_INPUT, GPIO_MODE_OUTPUT, GPIO_MODE_ALTERNATE, GPIO_MODE_ANALOG };
enum { GPIO_PULL_NONE, GPIO_PULL_UP, GPIO_PULL_DOWN };
enum { GPIO_SPEED_LOW, GPIO_SPEED_MEDIUM, GPIO_SPEED_HIGH };

/* ---- System configuration ---- */
struct syscfg_registers {
    volatile uint32_t memrmp, cfgr1, exticr[4], scsr, cfgr2, swpr, skr;
};
#define SYSCFG ((struct syscfg_registers *)0x40010000u)

#define SYSCFG_CFGR2_CLL  BIT(0)
#define SYSCFG_CFGR2_SPL  BIT(1)
#define SYSCFG_CFGR2_PVDL BIT(2)
#define SYSCFG_CFGR2_SPF  BIT(8)

/* ---- Timers: TIM1 and TIM8 have all of these, TIM2...TIM5 a part of them ---- */
struct tim_registers {
    volatile uint32_t cr1, cr2, smcr, dier, sr, egr, ccmr_output[2], ccer, cnt, psc, arr, rcr;
    volatile uint32_t ccr[4], bdtr, ccr5, ccr6, ccmr3, dtr2, ecr, tisel, af1, af2;
};
#define TIM1 ((struct tim_registers *)0x40012c00u)
#define TIM2 ((struct tim_registers *)0x40000000u)
#define TIM3 ((struct tim_registers *)0x40000400u)
#define TIM4 ((struct tim_registers *)0x40000800u)
#define TIM5 ((struct tim_registers *)0x40000c00u)
#define TIM8 ((struct tim_registers *)0x40013400u)

#define TIM_CR1_CEN           BIT(0)
#define TIM_CR1_DIR           BIT(4)
#define TIM_CR1_CMS(value)    FIELD(value, 5, 2)
#define TIM_CR1_ARPE          BIT(7)
#define TIM_CR2_MMS(value)    FIELD(value, 4, 3)
#define TIM_CR2_OIS1          BIT(8)
#define TIM_CR2_OIS1N         BIT(9)
#define TIM_CR2_OIS2          BIT(10)
#define TIM_CR2_OIS2N         BIT(11)
#define TIM_CR2_OIS3          BIT(12)
#define TIM_CR2_OIS3N         BIT(13)
#define TIM_CR2_OIS4          BIT(14)
#define TIM_CR2_OIS4N         BIT(15)
#define TIM_CR2_MMS2(value)   FIELD(value, 20, 4)
#define TIM_SMCR_SMS(value)   FIELD(value, 0, 3)
#define TIM_SMCR_TS(value)    FIELD(value, 4, 3)
#define TIM_DIER_UIE          BIT(0)
#define TIM_DIER_CC1IE        BIT(1)
#define TIM_DIER_BIE          BIT(7)
#define TIM_SR_UIF            BIT(0)
#define TIM_SR_CC1IF          BIT(1)
#define TIM_SR_BIF            BIT(7)
#define TIM_SR_SBIF           BIT(13)
#define TIM_EGR_UG            BIT(0)
#define TIM_CCMR_CC1S(value)  FIELD(value, 0, 2)
#define TIM_CCMR_OC1PE        BIT(3)
#define TIM_CCMR_OC1M(value)  FIELD(value, 4, 3)
#define TIM_CCMR_CC2S(value)  FIELD(value, 8, 2)
#define TIM_CCMR_OC2PE        BIT(11)
#define TIM_CCMR_OC2M(value)  FIELD(value, 12, 3)
#define TIM_CCMR_IC1F(value)  FIELD(value, 4, 4)
#define TIM_CCMR_IC2F(value)  FIELD(value, 12, 4)
#define TIM_CCMR3_OC5M(value) FIELD(value, 4, 3)
#define TIM_CCER_CC1E         BIT(0)
#define TIM_CCER_CC1P         BIT(1)
#define TIM_CCER_CC1NE        BIT(2)
#define TIM_CCER_CC1NP        BIT(3)
#define TIM_CCER_CC2E         BIT(4)
#define TIM_CCER_CC2P         BIT(5)
#define TIM_CCER_CC2NE        BIT(6)
#define TIM_CCER_CC2NP        BIT(7)
#define TIM_CCER_CC3E         BIT(8)
#define TIM_CCER_CC3P         BIT(9)
#define TIM_CCER_CC3NE        BIT(10)
#define TIM_CCER_CC3NP        BIT(11)
#define TIM_CCER_CC4E         BIT(12)
#define TIM_CCER_CC4P         BIT(13)
#define TIM_CCER_CC4NE        BIT(14)
#define TIM_CCER_CC4NP        BIT(15)
#define TIM_BDTR_DTG(value)   FIELD(value, 0, 8)
#define TIM_BDTR_LOCK(value)  FIELD(value, 8, 2)
#define TIM_BDTR_OSSI         BIT(10)
#define TIM_BDTR_OSSR         BIT(11)
#define TIM_BDTR_BKE          BIT(12)
#define TIM_BDTR_BKP          BIT(13)
#define TIM_BDTR_MOE          BIT(15)
#define TIM_BDTR_BKF(value)   FIELD(value, 16, 4)
#define TIM_AF1_BKINE         BIT(0)
#define TIM_AF1_BKCMP1E       BIT(1)
#define TIM_AF1_BKCMP2E       BIT(2)
#define TIM_AF1_BKCMP3E       BIT(3)
#define TIM_AF1_BKCMP4E       BIT(4)
#define TIM_AF1_BKCMP5E       BIT(5)
#define TIM_AF1_BKCMP6E       BIT(6)
#define TIM_AF1_BKCMP7E       BIT(7)
#define TIM_AF1_BKINP         BIT(9)

enum { TIM_CENTRE_ALIGNED_1 = 1 };                       /* CMS */
enum { TIM_TRGO_UPDATE = 2, TIM_TRGO2_OC5REF = 8 };      /* MMS, MMS2 */
enum { TIM_SLAVE_ENCODER_3 = 3, TIM_SLAVE_TRIGGER = 6 }; /* SMS */
enum { TIM_TRIGGER_TIM1_TRGO = 0 };                      /* TS: ITR0 of TIM2, TIM3 */
enum { TIM_PWM_MODE_1 = 6, TIM_PWM_MODE_2 = 7 };         /* OCxM */

/* ---- Converters ---- */
struct adc_registers {
    volatile uint32_t isr, ier, cr, cfgr, cfgr2, smpr, smpr2;
    volatile uint32_t reserved0;
    volatile uint32_t tr1, tr2, tr3;
    volatile uint32_t reserved1;
    volatile uint32_t sqr1, sqr2, sqr3, sqr4, dr;
    volatile uint32_t reserved2[2];
    volatile uint32_t jsqr;
    volatile uint32_t reserved3[4];
    volatile uint32_t ofr[4];
    volatile uint32_t reserved4[4];
    volatile uint32_t jdr[4];
    volatile uint32_t reserved5[4];
    volatile uint32_t awd2cr, awd3cr;
    volatile uint32_t reserved6[2];
    volatile uint32_t difsel, calfact;
};
#define ADC1 ((struct adc_registers *)0x50000000u)
#define ADC2 ((struct adc_registers *)0x50000100u)
#define ADC3 ((struct adc_registers *)0x50000400u)
#define ADC4 ((struct adc_registers *)0x50000500u)
#define ADC5 ((struct adc_registers *)0x50000600u)

#define ADC_ISR_ADRDY                BIT(0)
#define ADC_ISR_OVR                  BIT(4)
#define ADC_ISR_JEOC                 BIT(5)
#define ADC_ISR_JEOS                 BIT(6)
#define ADC_CR_ADEN                  BIT(0)
#define ADC_CR_ADSTART               BIT(2)
#define ADC_CR_JADSTART              BIT(3)
#define ADC_CR_ADVREGEN              BIT(28)
#define ADC_CR_DEEPPWD               BIT(29)
#define ADC_CR_ADCALDIF              BIT(30)
#define ADC_CR_ADCAL                 BIT(31)
#define ADC_CFGR_DMAEN               BIT(0)
#define ADC_CFGR_DMACFG              BIT(1)
#define ADC_CFGR_EXTSEL(value)       FIELD(value, 5, 5)
#define ADC_CFGR_EXTEN(value)        FIELD(value, 10, 2)
#define ADC_CFGR_JQDIS               BIT(31)
#define ADC_CFGR2_ROVSE              BIT(0)
#define ADC_CFGR2_OVSR(value)        FIELD(value, 2, 3)
#define ADC_CFGR2_OVSS(value)        FIELD(value, 5, 4)
#define ADC_SMPR_SMP(channel, value) FIELD(value, 3 * (channel), 3)
#define ADC_SQR1_L(value)            FIELD(value, 0, 4)
#define ADC_SQR1_SQ1(value)          FIELD(value, 6, 5)
#define ADC_SQR1_SQ2(value)          FIELD(value, 12, 5)
#define ADC_JSQR_JL(value)           FIELD(value, 0, 2)
#define ADC_JSQR_JEXTSEL(value)      FIELD(value, 2, 5)
#define ADC_JSQR_JEXTEN(value)       FIELD(value, 7, 2)
#define ADC_JSQR_JSQ1(value)         FIELD(value, 9, 5)
#define ADC_JSQR_JSQ2(value)         FIELD(value, 15, 5)

struct adc_common_registers {
    volatile uint32_t csr;
    volatile uint32_t reserved0;
    volatile uint32_t ccr;
};
#define ADC12_COMMON  ((struct adc_common_registers *)0x50000300u)
#define ADC345_COMMON ((struct adc_common_registers *)0x50000700u)

#define ADC_CSR_JEOC_MST      BIT(5)
#define ADC_CSR_JEOC_SLV      BIT(21)
#define ADC_CCR_CKMODE(value) FIELD(value, 16, 2)

enum { ADC_CLOCK_HCLK_DIV4 = 3 };                    /* CKMODE */
enum { ADC_TRIGGER_RISING = 1 };                     /* EXTEN, JEXTEN */
enum { ADC_TRIGGER_TIM3_TRGO = 4 };                  /* EXTSEL of ADC3, 4, 5 */
enum { ADC_TRIGGER_TIM1_TRGO2 = 8 };                 /* JEXTSEL of ADC1 and ADC2 */
enum { ADC_OVERSAMPLE_4 = 1, ADC_OVERSAMPLE_8 = 2 }; /* OVSR */
enum { ADC_SAMPLE_2_5 = 0, ADC_SAMPLE_24_5 = 3 };    /* SMP, in ADC clocks */

/* ---- Operational amplifiers ---- */
struct opamp_registers {
    volatile uint32_t csr;
};
#define OPAMP1 ((struct opamp_registers *)0x40010300u)
#define OPAMP2 ((struct opamp_registers *)0x40010304u)
#define OPAMP3 ((struct opamp_registers *)0x40010308u)

#define OPAMP_CSR_OPAMPEN         BIT(0)
#define OPAMP_CSR_VP_SEL(value)   FIELD(value, 2, 2)
#define OPAMP_CSR_VM_SEL(value)   FIELD(value, 5, 2)
#define OPAMP_CSR_OPAHSM          BIT(7)
#define OPAMP_CSR_OPAINTOEN       BIT(8)
#define OPAMP_CSR_PGA_GAIN(value) FIELD(value, 14, 5)

enum { OPAMP_VP_VINP0 = 0, OPAMP_VM_PGA = 2, OPAMP_PGA_GAIN_2 = 0 }; /* the next gains double */

/* ---- Comparators ---- */
struct comp_registers {
    volatile uint32_t csr;
};
#define COMP1 ((struct comp_registers *)0x40010200u)
#define COMP2 ((struct comp_registers *)0x40010204u)
#define COMP3 ((struct comp_registers *)0x40010208u)
#define COMP4 ((struct comp_registers *)0x4001020cu)
#define COMP5 ((struct comp_registers *)0x40010210u)
#define COMP6 ((struct comp_registers *)0x40010214u)
#define COMP7 ((struct comp_registers *)0x40010218u)

#define COMP_CSR_EN            BIT(0)
#define COMP_CSR_INMSEL(value) FIELD(value, 4, 3)
#define COMP_CSR_INPSEL        BIT(8)
#define COMP_CSR_HYST(value)   FIELD(value, 16, 3)
#define COMP_CSR_LOCK          BIT(31)

/* INMSEL: channel 1 of DAC3 at COMP1 and COMP3, channel 2 at COMP2 and COMP4; channel 1 of DAC4 at
   COMP5 and COMP7, channel 2 at COMP6. */
enum { COMP_MINUS_DAC3_OR_4 = 4 };
enum { COMP_HYSTERESIS_10_MV = 1 };

/* ---- Converters to analog ---- */
struct dac_registers {
    volatile uint32_t cr, swtrigr, dhr12r1, dhr12l1, dhr8r1, dhr12r2, dhr12l2, dhr8r2, dhr12rd;
    volatile uint32_t dhr12ld, dhr8rd, dor1, dor2, sr, ccr, mcr;
};
#define DAC3 ((struct dac_registers *)0x50001000u)
#define DAC4 ((struct dac_registers *)0x50001400u)

#define DAC_CR_EN1           BIT(0)
#define DAC_CR_EN2           BIT(16)
#define DAC_SR_DAC1RDY       BIT(11)
#define DAC_SR_DAC2RDY       BIT(27)
#define DAC_MCR_MODE1(value) FIELD(value, 0, 3)
#define DAC_MCR_MODE2(value) FIELD(value, 16, 3)
#define DAC_MCR_HFSEL(value) FIELD(value, 14, 2)

enum { DAC_MODE_ON_CHIP = 3 }; /* MODE: to on-chip peripherals, without buffer */
enum { DAC_HFSEL_ABOVE_160_MHZ = 2 };

/* ---- DMA ---- */
struct dma_registers {
    volatile uint32_t isr, ifcr;
    struct dma_channel {
        volatile uint32_t cr, ndtr, par, mar;
        volatile uint32_t reserved0;
    } ch[8];
};
#define DMA1 ((struct dma_registers *)0x40020000u)

#define DMA_CR_EN             BIT(0)
#define DMA_CR_DIR            BIT(4)
#define DMA_CR_CIRC           BIT(5)
#define DMA_CR_MINC           BIT(7)
#define DMA_CR_PSIZE(value)   FIELD(value, 8, 2)
#define DMA_CR_MSIZE(value)   FIELD(value, 10, 2)
#define DMA_CR_PL(value)      FIELD(value, 12, 2)
#define DMA_ISR_TCIF(channel) FIELD(1, 4 * (channel) + 1, 1)
#define DMA_ISR_TEIF(channel) FIELD(1, 4 * (channel) + 3, 1)
#define DMA_IFCR_GIF(channel) FIELD(1, 4 * (channel), 1)

enum { DMA_BYTE, DMA_HALF_WORD }; /* PSIZE, MSIZE */
enum { DMA_PRIORITY_LOW = 0, DMA_PRIORITY_VERY_HIGH = 3 };

struct dmamux_registers {
    volatile uint32_t ccr[16];
};
#define DMAMUX1 ((struct dmamux_registers *)0x40020800u)

#define DMAMUX_CCR_DMAREQ_ID(value) FIELD(value, 0, 8)

enum { DMAMUX_LPUART1_RX = 34, DMAMUX_LPUART1_TX = 35 };
enum { DMAMUX_ADC3 = 37, DMAMUX_ADC4 = 38, DMAMUX_ADC5 = 39 };

/* ---- Serial line ---- */
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

/* ---- CAN ---- */
struct fdcan_registers {
    volatile uint32_t crel, endn;
    volatile uint32_t reserved0;
    volatile uint32_t dbtp, test, rwd, cccr, nbtp, tscc, tscv, tocc, tocv;
    volatile uint32_t reserved1[4];
    volatile uint32_t ecr, psr, tdcr;
    volatile uint32_t reserved2;
    volatile uint32_t ir, ie, ils, ile;
    volatile uint32_t reserved3[8];
    volatile uint32_t rxgfc, xidam, hpms;
    volatile uint32_t reserved4;
    volatile uint32_t rxf0s, rxf0a, rxf1s, rxf1a;
    volatile uint32_t reserved5[8];
    volatile uint32_t txbc, txfqs, txbrp, txbar, txbcr, txbto, txbcf, txbtie, txbcie, txefs, txefa;
};
#define FDCAN3 ((struct fdcan_registers *)0x40006c00u)

#define FDCAN_CCCR_INIT          BIT(0)
#define FDCAN_CCCR_CCE           BIT(1)
#define FDCAN_NBTP_NTSEG2(value) FIELD(value, 0, 7)
#define FDCAN_NBTP_NTSEG1(value) FIELD(value, 8, 8)
#define FDCAN_NBTP_NBRP(value)   FIELD(value, 16, 9)
#define FDCAN_NBTP_NSJW(value)   FIELD(value, 25, 7)
#define FDCAN_PSR_EP             BIT(5)
#define FDCAN_PSR_EW             BIT(6)
#define FDCAN_PSR_BO             BIT(7)
#define FDCAN_IR_RFN             BIT(0)
#define FDCAN_IR_RFL             BIT(2)
#define FDCAN_IE_RFNE            BIT(0)
#define FDCAN_ILE_EINT0          BIT(0)
#define FDCAN_RXGFC_RRFE         BIT(0)
#define FDCAN_RXGFC_RRFS         BIT(1)
#define FDCAN_RXGFC_ANFE(value)  FIELD(value, 2, 2)
#define FDCAN_RXGFC_ANFS(value)  FIELD(value, 4, 2)
#define FDCAN_RXGFC_LSS(value)   FIELD(value, 16, 5)
#define FDCAN_RXF0S_FFL(value)   FIELD(value, 0, 4)
#define FDCAN_RXF0S_FGI(value)   FIELD(value, 8, 2)
#define FDCAN_TXFQS_TFQPI(value) FIELD(value, 16, 2)
#define FDCAN_TXFQS_TFQF         BIT(21)

enum { FDCAN_REJECT = 2 }; /* ANFE, ANFS */

/* Its message RAM (RM0440, FDCAN message RAM): FDCAN1 and FDCAN2 have 0x350 bytes each before it.
 */
enum { FDCAN_FIFO_ELEMENTS = 3, FDCAN_TX_ELEMENTS = 3 };
struct fdcan_element {
    volatile uint32_t id, control; /* R0 and R1, T0 and T1 */
    volatile uint32_t data[16];
};
struct fdcan_message_ram {
    volatile uint32_t standard_filter[28];
    volatile uint32_t extended_filter[16];
    struct fdcan_element rx_fifo0[FDCAN_FIFO_ELEMENTS], rx_fifo1[FDCAN_FIFO_ELEMENTS];
    volatile uint32_t tx_events[6];
    struct fdcan_element tx_buffer[FDCAN_TX_ELEMENTS];
};

enum { FDCAN_FILTER_DUAL = 1, FDCAN_FILTER_FIFO0 = 1 }; /* SFT, SFEC of a standard filter */

/* ---- Independent watchdog ---- */
struct iwdg_registers {
    volatile uint32_t kr, pr, rlr, sr, winr;
};
#define IWDG ((struct iwdg_registers *)0x40003000u)

#define IWDG_PR_PR(value)  FIELD(value, 0, 3)
#define IWDG_RLR_RL(value) FIELD(value, 0, 12)
#define IWDG_SR_PVU        BIT(0)
#define IWDG_SR_RVU        BIT(1)

enum { IWDG_KEY_FEED = 0xaaaa, IWDG_KEY_ACCESS = 0x5555, IWDG_KEY_START = 0xcccc };
enum { IWDG_PRESCALER_4 = 0 };

/* ---- Debug support ---- */
struct dbgmcu_registers {
    volatile uint32_t idcode, cr, apb1lfzr, apb1hfzr, apb2fzr;
};
#define DBGMCU ((struct dbgmcu_registers *)0xe0042000u)

#define DBGMCU_APB1LFZR_TIM3 BIT(1)
#define DBGMCU_APB1LFZR_IWDG BIT(12)
#define DBGMCU_APB2FZR_TIM1  BIT(11)

#endif
