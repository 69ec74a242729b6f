/* DMA1: which channel does what, and the little that its users share. */
#ifndef STEADYSTEP_STM32G474_DMA_H
#define STEADYSTEP_STM32G474_DMA_H

#include "hal/stm32g474/device.h"
#include "hal/stm32g474/registers.h"

/* Channels counted from 0, as their multiplexer counts; the manual's channel 1 is 0. */
enum { DMA_LEGS_A, DMA_LEGS_B, DMA_LINE_RECEIVE, DMA_LINE_TRANSMIT };

/* Of what a channel reads or writes: a bank of memory by itself (memory.ld), zero at the start. */
#define DMA_BUFFER __attribute__((section(".bss.dma_buffer")))

/* Connects a channel with a request and enables it. `control` without the enable bit. */
static inline void dma_start(uint32_t channel, uint32_t request,
                             const volatile uint32_t *peripheral, const volatile void *memory,
                             uint32_t count, uint32_t control)
{
    RCC->ahb1enr |= RCC_AHB1ENR_DMA1EN | RCC_AHB1ENR_DMAMUX1EN;
    (void)RCC->ahb1enr;
    DMA1->ch[channel].cr = 0;
    DMA1->ifcr = DMA_IFCR_GIF(channel);
    DMAMUX1->ccr[channel] = DMAMUX_CCR_DMAREQ_ID(request);
    DMA1->ch[channel].par = (uint32_t)(uintptr_t)peripheral;
    DMA1->ch[channel].mar = (uint32_t)(uintptr_t)memory;
    DMA1->ch[channel].ndtr = count;
    __DSB(); /* what it is to send is in memory */
    DMA1->ch[channel].cr = control | DMA_CR_EN;
}

/* Transfers that are left until the end of the buffer. */
static inline uint32_t dma_remaining(uint32_t channel)
{
    return DMA1->ch[channel].ndtr;
}

#endif
