/*
 * LPUART1. HAL_STREAM_LOST stands for what the buffer could not hold, as hal.h says.
 */
#include "hal/cortex_m/serial_line.h"

#include <stdbool.h>

#include "hal/hal.h"
#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/port.h"
#include "hal/cortex_m/wait.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/handlers.h"
#include "hal/stm32g071/registers.h"

enum {
    RECEIVED_BYTES = 512,
    SENT_BYTES = 512,
    LINES = 16,
    /* What comes while the background reads must not reach what it reads. */
    LINES_KEPT = LINES - 4,
    BYTES_KEPT = RECEIVED_BYTES - 16,
    MOVE_TRIES = 100, /* DMA takes a byte within some cycles */
    BYTE_WAIT = 1000  /* passes at 16 MHz; a byte takes 87 us */
};

/* Positions count bytes since start-up. */
struct line_end {
    uint32_t behind;      /* position behind the line feed */
    uint32_t period;      /* of the control interrupt */
    volatile bool harmed; /* bytes of the line came with an error */
};

/* The interrupt writes what has come, the background what it has read. */
static struct {
    uint8_t bytes[RECEIVED_BYTES]; /* written by DMA, round and round */
    volatile uint32_t rounds;      /* completed by DMA */
    struct line_end line[LINES];   /* in order */
    volatile uint32_t lines;       /* ended since start-up */
    uint32_t searched;             /* line feeds up to here are among them */
    volatile bool harmed;          /* the line that is coming in */

    uint32_t read, lines_read;
    uint32_t lost_period; /* of the last line that was dropped */
    bool report_lost, report_lost_end,
        report_harmed; /* HAL_STREAM_LOST, its '\n'; for a beginning */
} receiver;

static struct {
    uint8_t bytes[SENT_BYTES];
    volatile uint32_t sent; /* bytes since start-up, those under way included */
    uint32_t written;
    volatile uint32_t under_way;
} sender;

#define DMA_RECEIVER (&DMA1->channel[1])
#define DMA_SENDER   (&DMA1->channel[2])

static void set_rate(uint64_t clock_Hz)
{
    LPUART1->brr = (uint32_t)((256u * clock_Hz + BAUD / 2u) / BAUD); /* RM0444 */
}

void serial_line_report(const char *text)
{
    if ((LPUART1->cr1 & LPUART_CR1_UE) == 0) {
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
    DMAMUX1->ccr[1] = DMAMUX_CCR_DMAREQ_ID(DMA_REQUEST_LPUART1_RX);
    DMA_RECEIVER->par = (uint32_t)(uintptr_t)&LPUART1->rdr;
    DMA_RECEIVER->mar = (uint32_t)(uintptr_t)receiver.bytes;
    DMA_RECEIVER->ndtr = RECEIVED_BYTES;
    DMA_RECEIVER->cr = DMA_CR_MINC | DMA_CR_CIRC | DMA_CR_PSIZE(DMA_BYTES_1) |
                       DMA_CR_MSIZE(DMA_BYTES_1) | DMA_CR_PL(DMA_PRIORITY_LOW) | DMA_CR_TCIE;
    DMA_RECEIVER->cr |= DMA_CR_EN;
    DMAMUX1->ccr[2] = DMAMUX_CCR_DMAREQ_ID(DMA_REQUEST_LPUART1_TX);
    DMA_SENDER->par = (uint32_t)(uintptr_t)&LPUART1->tdr;
    interrupt_enable(DMA1_CHANNEL2_3_IRQn, PRIORITY_LINE);

    set_rate(CORE_CLOCK_Hz);
    LPUART1->cr2 = LPUART_CR2_ADD('\n');
    LPUART1->cr3 = LPUART_CR3_DMAR | LPUART_CR3_DMAT | LPUART_CR3_EIE;
    LPUART1->cr1 = LPUART_CR1_RE | LPUART_CR1_TE | LPUART_CR1_CMIE;
    LPUART1->cr1 |= LPUART_CR1_UE;
    interrupt_enable(USART3_4_LPUART1_IRQn, PRIORITY_LINE);
}

/* Position of DMA. A round that the interrupt has not counted yet, masked or about to, is added. */
static uint32_t received(void)
{
    uint32_t rounds, uncounted, left;

    do {
        rounds = receiver.rounds;
        left = DMA_RECEIVER->ndtr;
        uncounted = (DMA1->isr & DMA_ISR_TCIF2) != 0 ? 1u : 0u;
        if (uncounted != 0) {
            left = DMA_RECEIVER->ndtr; /* of the round that has begun */
        }
    } while (rounds != receiver.rounds); /* counted meanwhile */
    return (rounds + uncounted) * RECEIVED_BYTES + (RECEIVED_BYTES - left);
}

/*
 * What DMA has overwritten, or is about to, is dropped by lines; whole lines behind it stay.
 * Dropped lines are reported by one of HAL_STREAM_LOST alone; a line of which only the end is left
 * gets one, too.
 */
static void drop_what_is_lost(uint32_t end)
{
    const uint32_t lines = receiver.lines;
    bool dropped = false;

    __COMPILER_BARRIER();
    while (receiver.lines_read != lines &&
           (end - receiver.read > BYTES_KEPT || lines - receiver.lines_read > LINES_KEPT)) {
        if (lines - receiver.lines_read > LINES_KEPT) {
            receiver.lines_read = lines - LINES_KEPT;
        }
        const struct line_end *line = &receiver.line[receiver.lines_read++ % LINES];

        receiver.read = line->behind;
        receiver.lost_period = line->period;
        dropped = true;
    }
    if (dropped) {
        receiver.report_lost = receiver.report_lost_end = true;
        receiver.report_harmed = false;
    }
    if (end - receiver.read > BYTES_KEPT) {
        receiver.read = end;
        receiver.report_harmed = true;
    }
}

size_t serial_line_read(uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    const uint32_t end = received();
    size_t moved = 0;

    drop_what_is_lost(end);
    while (moved < capacity) {
        if (receiver.report_lost) {
            receiver.report_lost = false;
            bytes[moved++] = HAL_STREAM_LOST;
            continue;
        }
        if (receiver.report_lost_end) {
            receiver.report_lost_end = false;
            *line_period = receiver.lost_period;
            bytes[moved++] = '\n';
            break;
        }
        if (receiver.report_harmed) {
            receiver.report_harmed = false;
            bytes[moved++] = HAL_STREAM_LOST;
            continue;
        }
        if (receiver.read == end) {
            break;
        }
        const uint8_t byte = receiver.bytes[receiver.read % RECEIVED_BYTES];

        if (byte == '\n' || byte == '\r') {
            const bool ended = receiver.lines != receiver.lines_read;

            if (byte == '\n' && !ended) {
                break; /* its stamp comes in a moment */
            }
            __COMPILER_BARRIER();
            struct line_end *line = &receiver.line[receiver.lines_read % LINES];
            volatile bool *harmed = ended ? &line->harmed : &receiver.harmed;

            if (*harmed) {
                *harmed = false;
                receiver.report_harmed = true;
                continue;
            }
            if (byte == '\n') {
                *line_period = line->period;
                receiver.lines_read++;
            }
        }
        bytes[moved++] = byte;
        receiver.read++;
        if (byte == '\n') {
            break;
        }
    }
    return moved;
}

/* Sends what lies in one piece; nothing is under way. */
static void send(void)
{
    const uint32_t first = sender.sent % SENT_BYTES;
    const uint32_t waiting = sender.written - sender.sent;
    const uint32_t piece = waiting < SENT_BYTES - first ? waiting : SENT_BYTES - first;

    sender.under_way = piece;
    sender.sent += piece;
    DMA_SENDER->cr = 0;
    if (piece > 0) {
        DMA_SENDER->mar = (uint32_t)(uintptr_t)&sender.bytes[first];
        DMA_SENDER->ndtr = piece;
        DMA_SENDER->cr = DMA_CR_DIR | DMA_CR_MINC | DMA_CR_PSIZE(DMA_BYTES_1) |
                         DMA_CR_MSIZE(DMA_BYTES_1) | DMA_CR_PL(DMA_PRIORITY_LOW) | DMA_CR_TCIE;
        DMA_SENDER->cr |= DMA_CR_EN;
    }
}

size_t serial_line_write(const uint8_t *bytes, size_t count)
{
    size_t moved = 0;

    /* Bytes under way are still read. */
    while (moved < count && sender.written - sender.sent + sender.under_way < SENT_BYTES) {
        sender.bytes[sender.written % SENT_BYTES] = bytes[moved++];
        sender.written++;
    }
    const uint32_t primask = interrupts_save_and_disable();
    if (sender.under_way == 0) {
        send();
    }
    interrupts_restore(primask);
    return moved;
}

void dma1_channel2_3_handler(void)
{
    const uint32_t status = DMA1->isr;

    if ((status & DMA_ISR_TCIF2) != 0) {
        DMA1->ifcr = DMA_IFCR_TCIF2;
        receiver.rounds++;
    }
    if ((status & DMA_ISR_TCIF3) != 0) {
        DMA1->ifcr = DMA_IFCR_TCIF3;
        send();
    }
}

/* One character match may stand for several line feeds that came while it could not be served. */
static void search_line_ends(uint32_t period)
{
    const uint32_t end = received();

    if (end - receiver.searched > RECEIVED_BYTES) {
        receiver.searched = end - RECEIVED_BYTES;
    }
    while (receiver.searched != end) {
        if (receiver.bytes[receiver.searched++ % RECEIVED_BYTES] == '\n') {
            receiver.line[receiver.lines % LINES] =
                (struct line_end){receiver.searched, period, receiver.harmed};
            receiver.harmed = false;
            __COMPILER_BARRIER();
            receiver.lines++;
        }
    }
}

/* Within a byte's time (87 us) of the line feed, the control interrupt notwithstanding. */
void usart3_4_lpuart1_handler(void)
{
    const uint32_t period = port_control_period();
    const uint32_t status = LPUART1->isr;

    if ((status & (LPUART_ISR_FE | LPUART_ISR_NE | LPUART_ISR_ORE)) != 0) {
        LPUART1->icr = LPUART_ICR_FE | LPUART_ICR_NE | LPUART_ICR_ORE;
        receiver.harmed = true;
    }
    if ((status & LPUART_ISR_CMF) != 0) {
        LPUART1->icr = LPUART_ICR_CMF;
        /* The line feed itself may still be on its way to memory. */
        for (int tries = 0; (LPUART1->isr & LPUART_ISR_RXNE) != 0 && tries < MOVE_TRIES; tries++) {
        }
        __COMPILER_BARRIER();
        search_line_ends(period);
    }
}
