#include "hal/stm32g071/serial.h"

#include <stdbool.h>

#include "hal/hal.h"
#include "hal/stm32g071/board.h"
#include "hal/stm32g071/clock.h"
#include "hal/stm32g071/core.h"

enum { LINES = 16 };

static struct {
    uint8_t bytes[SERIAL_RECEIVED_BYTES]; /* written by DMA, round and round */
    volatile uint32_t rounds;             /* completed by DMA */
    uint32_t read;                        /* bytes since start-up */
    volatile uint32_t line_period[LINES]; /* stamps of the line feeds, in order */
    volatile uint32_t lines;              /* stamped since start-up */
    uint32_t lines_read;
    volatile bool harmed; /* a byte came with an error */
} receiver;

static struct {
    uint8_t bytes[SERIAL_SENT_BYTES];
    volatile uint32_t sent; /* bytes since start-up, those under way included */
    uint32_t written;
    volatile uint32_t under_way;
} sender;

#define DMA_RECEIVER (&DMA1->channel[1])
#define DMA_SENDER   (&DMA1->channel[2])

void serial_start(void)
{
    DMAMUX1->ccr[1] = DMAMUX_CCR_DMAREQ_ID(DMA_REQUEST_LPUART1_RX);
    DMA_RECEIVER->par = (uint32_t)(uintptr_t)&LPUART1->rdr;
    DMA_RECEIVER->mar = (uint32_t)(uintptr_t)receiver.bytes;
    DMA_RECEIVER->ndtr = SERIAL_RECEIVED_BYTES;
    DMA_RECEIVER->cr = DMA_CR_MINC | DMA_CR_CIRC | DMA_CR_PSIZE(DMA_BYTES_1) |
                       DMA_CR_MSIZE(DMA_BYTES_1) | DMA_CR_PL(DMA_PRIORITY_LOW) | DMA_CR_TCIE;
    DMA_RECEIVER->cr |= DMA_CR_EN;
    DMAMUX1->ccr[2] = DMAMUX_CCR_DMAREQ_ID(DMA_REQUEST_LPUART1_TX);
    DMA_SENDER->par = (uint32_t)(uintptr_t)&LPUART1->tdr;
    interrupt_enable(INTERRUPT_DMA1_CHANNEL2_3, PRIORITY_LINE);

    LPUART1->brr = (uint32_t)((256ull * CORE_CLOCK_Hz + SERIAL_BAUD / 2) / SERIAL_BAUD);
    LPUART1->cr2 = LPUART_CR2_ADD('\n');
    LPUART1->cr3 = LPUART_CR3_DMAR | LPUART_CR3_DMAT | LPUART_CR3_EIE;
    LPUART1->cr1 = LPUART_CR1_RE | LPUART_CR1_TE | LPUART_CR1_CMIE;
    LPUART1->cr1 |= LPUART_CR1_UE;
    interrupt_enable(INTERRUPT_USART3_4_LPUART1, PRIORITY_LINE);
}

static uint32_t received(void)
{
    uint32_t rounds, left;

    do {
        rounds = receiver.rounds;
        left = DMA_RECEIVER->ndtr;
    } while (rounds != receiver.rounds || (DMA1->isr & DMA_ISR_TCIF2) != 0);
    return rounds * SERIAL_RECEIVED_BYTES + (SERIAL_RECEIVED_BYTES - left);
}

/* Drops everything and tells it with a byte that spoils the line it belongs to. */
static size_t lose(uint8_t *bytes)
{
    const uint32_t primask = interrupts_save_and_disable();

    receiver.harmed = false;
    receiver.read = received();
    receiver.lines_read = receiver.lines;
    interrupts_restore(primask);
    bytes[0] = HAL_STREAM_LOST;
    return 1;
}

size_t serial_read(uint8_t *bytes, size_t capacity, uint32_t *line_period)
{
    const uint32_t available = received() - receiver.read;
    size_t moved = 0;

    if (capacity == 0) {
        return 0;
    }
    if (receiver.harmed || available > SERIAL_RECEIVED_BYTES ||
        receiver.lines - receiver.lines_read > LINES) {
        return lose(bytes);
    }
    while (moved < capacity && moved < available) {
        const uint8_t byte = receiver.bytes[receiver.read % SERIAL_RECEIVED_BYTES];

        if (byte == '\n' && receiver.lines == receiver.lines_read) {
            break; /* its stamp comes in a moment */
        }
        bytes[moved++] = byte;
        receiver.read++;
        if (byte == '\n') {
            *line_period = receiver.line_period[receiver.lines_read++ % LINES];
            break;
        }
    }
    return moved;
}

/* Sends what lies in one piece; nothing is under way. */
static void send(void)
{
    const uint32_t first = sender.sent % SERIAL_SENT_BYTES;
    const uint32_t waiting = sender.written - sender.sent;
    const uint32_t piece =
        waiting < SERIAL_SENT_BYTES - first ? waiting : SERIAL_SENT_BYTES - first;

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

size_t serial_write(const uint8_t *bytes, size_t count)
{
    size_t moved = 0;

    /* Bytes under way are still read. */
    while (moved < count && sender.written - sender.sent + sender.under_way < SERIAL_SENT_BYTES) {
        sender.bytes[sender.written % SERIAL_SENT_BYTES] = bytes[moved++];
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

/* Within a byte's time (87 us) of the line feed, the control interrupt notwithstanding. */
void usart3_4_lpuart1_handler(void)
{
    const uint32_t status = LPUART1->isr;

    if ((status & LPUART_ISR_CMF) != 0) {
        LPUART1->icr = LPUART_ICR_CMF;
        receiver.line_period[receiver.lines % LINES] = board_period();
        receiver.lines++;
    }
    if ((status & (LPUART_ISR_FE | LPUART_ISR_NE | LPUART_ISR_ORE)) != 0) {
        LPUART1->icr = LPUART_ICR_FE | LPUART_ICR_NE | LPUART_ICR_ORE;
        receiver.harmed = true;
    }
}
