#include "hal/cortex_m/serial_line.h"

#include <stdbool.h>

#include "hal/hal.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/port.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/dma.h"
#include "hal/stm32g474/handlers.h"

enum {
    RECEIVE_BYTES = 4096, /* 44 ms at full rate; the background reads at least every 35 ms */
    TRANSMIT_BYTES = 2048,
    LINES = 64,       /* whose ends are stamped and that are not read yet */
    MOVE_WAIT = 100,  /* passes; DMA takes a byte within some cycles */
    BYTE_WAIT = 1000, /* passes at 16 MHz; a byte takes 11 us */
};

struct line_end {
    uint32_t period;
    bool damaged; /* bytes of the line were lost on the wire */
};

/*
 * Positions count bytes since start-up; a buffer holds them modulo its size. The interrupt writes
 * what is stored and ended, the background what it has read: neither waits for the other.
 */
DMA_BUFFER static struct {
    uint8_t bytes[RECEIVE_BYTES];
    struct line_end ends[LINES];
    volatile uint32_t stored; /* behind it no end of a line has been searched for */
    volatile uint32_t lines_ended;
    volatile bool overrun; /* more came than there is room for */
    bool damaged;          /* the line that is being received */

    uint32_t read, lines_read;
    bool behind;        /* the background has dropped bytes of the line it will read next */
    unsigned reporting; /* bytes that are left to report what was dropped: LOST, '\n' */
} receive;

DMA_BUFFER static struct {
    uint8_t bytes[TRANSMIT_BYTES];
    uint32_t written, sent, sending;
} transmit;

static void set_rate(uint64_t clock_Hz)
{
    RCC->apb1enr2 |= RCC_APB1ENR2_LPUART1EN;
    (void)RCC->apb1enr2;
    RCC->ccipr &= ~RCC_CCIPR_LPUART1SEL(3); /* bus clock */

    /* 256 clocks over the rate, rounded (RM0440). */
    LPUART1->brr = (uint32_t)((clock_Hz * 256u + BAUD / 2u) / BAUD);
}

void serial_line_report(const char *text)
{
    if ((RCC->apb1enr2 & RCC_APB1ENR2_LPUART1EN) == 0) {
        set_rate(HSI16_Hz);
        LPUART1->cr1 = LPUART_CR1_UE | LPUART_CR1_TE;
    }
    for (; *text != '\0'; text++) {
        (void)wait_until(&LPUART1->isr, LPUART_ISR_TXE, LPUART_ISR_TXE, BYTE_WAIT);
        LPUART1->tdr = (uint8_t)*text;
    }
}

void serial_line_configure(void)
{
    set_rate(CORE_Hz);
    LPUART1->cr2 = LPUART_CR2_ADD('\n');
    LPUART1->cr3 = LPUART_CR3_DMAR | LPUART_CR3_DMAT | LPUART_CR3_EIE;
    dma_start(DMA_LINE_RECEIVE, DMAMUX_LPUART1_RX, &LPUART1->rdr, receive.bytes, RECEIVE_BYTES,
              DMA_CR_CIRC | DMA_CR_MINC | DMA_CR_PSIZE(DMA_BYTE) | DMA_CR_MSIZE(DMA_BYTE));
    LPUART1->cr1 = LPUART_CR1_UE | LPUART_CR1_RE | LPUART_CR1_TE | LPUART_CR1_CMIE;
    interrupt_enable(LPUART1_IRQn, PRIORITY_LINE);
}

/* Bytes that DMA has stored behind a position of this buffer. */
static uint32_t stored_behind(uint32_t position)
{
    return (RECEIVE_BYTES - dma_remaining(DMA_LINE_RECEIVE) - position) % RECEIVE_BYTES;
}

static void search_line_ends(uint32_t period)
{
    uint32_t position = receive.stored;

    for (uint32_t fresh = stored_behind(position); fresh > 0; fresh--) {
        if (receive.bytes[position++ % RECEIVE_BYTES] == '\n') {
            receive.ends[receive.lines_ended % LINES] = (struct line_end){period, receive.damaged};
            receive.damaged = false;
            receive.lines_ended++;
            receive.stored = position;
        }
    }
    if (receive.stored - receive.read > RECEIVE_BYTES / 2 ||
        receive.lines_ended - receive.lines_read > LINES / 2) {
        receive.overrun = true;
    }
}

void serial_line_interrupt(void)
{
    const uint32_t isr = LPUART1->isr;

    LPUART1->icr = LPUART_ICR_CMF | LPUART_ICR_ORE | LPUART_ICR_FE | LPUART_ICR_NE | LPUART_ICR_PE;
    if (isr & (LPUART_ISR_ORE | LPUART_ISR_FE | LPUART_ISR_NE | LPUART_ISR_PE)) {
        receive.damaged = true;
    }
    /* The matched byte may still be on its way to memory. */
    (void)wait_until(&LPUART1->isr, LPUART_ISR_RXNE, 0, MOVE_WAIT);
    __DSB();
    search_line_ends(port_control_period());
    __DSB();
}

/* After too much, or a line too long to have an end: goes on behind it. */
static void drop_if_overrun(void)
{
    const uint32_t primask = interrupts_save_and_disable();

    if ((int32_t)(receive.read - receive.stored) > 0) { /* bytes of a line without an end so far */
        receive.stored = receive.read;
    }
    if (stored_behind(receive.stored) > RECEIVE_BYTES / 2) {
        receive.stored += stored_behind(receive.stored);
        receive.overrun = true;
    }
    if (receive.overrun) {
        receive.overrun = false;
        receive.behind = receive.bytes[(receive.stored - 1u) % RECEIVE_BYTES] != '\n';
        receive.damaged = receive.damaged && receive.behind;
        receive.reporting = 2;
        receive.read = receive.stored;
        receive.lines_read = receive.lines_ended;
    }
    interrupts_restore(primask);
}

/* Whether bytes of the line that is being read were lost; forgets it. */
static bool take_damage(void)
{
    const uint32_t primask = interrupts_save_and_disable();
    bool *damaged = receive.lines_read == receive.lines_ended
                        ? &receive.damaged
                        : &receive.ends[receive.lines_read % LINES].damaged;
    const bool taken = *damaged || receive.behind;

    *damaged = false;
    receive.behind = false;
    interrupts_restore(primask);
    return taken;
}

/* The usual pass: no interrupt is held up for it. */
static bool nothing_came(void)
{
    return receive.read == receive.stored && stored_behind(receive.read) == 0 && !receive.overrun &&
           receive.reporting == 0;
}

size_t serial_line_read(uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    size_t count = 0;

    if (nothing_came()) {
        return 0;
    }
    drop_if_overrun();
    if (receive.reporting == 2 && capacity > 0) {
        bytes[count++] = HAL_STREAM_LOST;
        receive.reporting--;
    }
    if (receive.reporting == 1 && count < capacity) {
        bytes[count++] = '\n';
        receive.reporting--;
        *line_period = port_control_period();
        return count;
    }
    for (uint32_t fresh = stored_behind(receive.read); count < capacity && fresh > 0; fresh--) {
        const uint8_t byte = receive.bytes[receive.read % RECEIVE_BYTES];

        if (byte == '\n') {
            if (receive.lines_read == receive.lines_ended) {
                break; /* its interrupt is about to come */
            }
            if (take_damage()) {
                bytes[count++] = HAL_STREAM_LOST;
                fresh++; /* the byte stays */
                continue;
            }
            *line_period = receive.ends[receive.lines_read % LINES].period;
            receive.lines_read++;
            receive.read++;
            bytes[count++] = byte;
            break;
        }
        if (byte == '\r' && take_damage()) {
            bytes[count++] = HAL_STREAM_LOST;
            fresh++;
            continue;
        }
        bytes[count++] = byte;
        receive.read++;
    }
    return count;
}

/* What has been written goes on its way. */
static void send(void)
{
    if (transmit.sending > 0) {
        if (dma_remaining(DMA_LINE_TRANSMIT) > 0) {
            return;
        }
        transmit.sent += transmit.sending;
        transmit.sending = 0;
    }
    if (transmit.written != transmit.sent) {
        const uint32_t first = transmit.sent % TRANSMIT_BYTES;
        const uint32_t waiting = transmit.written - transmit.sent;
        const uint32_t to_end = TRANSMIT_BYTES - first;

        transmit.sending = waiting < to_end ? waiting : to_end;
        dma_start(DMA_LINE_TRANSMIT, DMAMUX_LPUART1_TX, &LPUART1->tdr, &transmit.bytes[first],
                  transmit.sending,
                  DMA_CR_DIR | DMA_CR_MINC | DMA_CR_PSIZE(DMA_BYTE) | DMA_CR_MSIZE(DMA_BYTE));
    }
}

size_t serial_line_write(const uint8_t *bytes, size_t count)
{
    size_t moved = 0;

    for (; moved < count && transmit.written - transmit.sent < TRANSMIT_BYTES; moved++) {
        transmit.bytes[transmit.written++ % TRANSMIT_BYTES] = bytes[moved];
    }
    send();
    return moved;
}
