#include "hal/stm32g474/fdcan.h"

#include <string.h>

#include "hal/cortex_m/interrupts.h"
#include "hal/cortex_m/port.h"
#include "hal/stm32g474/handlers.h"
#include "hal/stm32g474/registers.h"

enum {
    RECEIVE_FRAMES = 32, /* at one in a millisecond, the longest that the background is away */
    TRANSMIT_FRAMES =
        8, /* behind those in the chip: an answer, four PDOs, a heartbeat, emergencies */
    FILTERS = HAL_CAN_IDS / 2,
    REST_PERIODS = 1000000 / CONTROL_PERIOD_us, /* between two ways out of bus-off */
};

/* FDCAN1, 2 and 3 share a memory, of which each has as much. */
#define MESSAGE_RAM ((struct fdcan_message_ram *)0x4000a400u + 2)

/* Positions count frames since start-up; a buffer holds them modulo its size. */
static struct {
    struct can_frame frames[RECEIVE_FRAMES];
    volatile uint32_t stored, read;
    volatile bool lost;
} receive;

static struct {
    struct can_frame frames[TRANSMIT_FRAMES];
    uint32_t written, sent;
} transmit;

static bool off;          /* bus-off, when state() looked last */
static uint32_t tried_in; /* period of the last way out of it */

static void configure_filters(const uint16_t *ids)
{
    for (uint32_t i = 0; i < FILTERS; i++) {
        MESSAGE_RAM->standard_filter[i] =
            ids == NULL ? 0u
                        : FIELD(FDCAN_FILTER_DUAL, 30, 2) | FIELD(FDCAN_FILTER_FIFO0, 27, 3) |
                              FIELD(ids[2u * i], 16, 11) | FIELD(ids[2u * i + 1u], 0, 11);
    }
}

void fdcan_configure(void)
{
    RCC->apb1enr1 |= RCC_APB1ENR1_FDCANEN;
    (void)RCC->apb1enr1;
    RCC->ccipr = (RCC->ccipr & ~RCC_CCIPR_FDCANSEL(3)) | RCC_CCIPR_FDCANSEL(RCC_FDCAN_PCLK1);

    FDCAN3->cccr = FDCAN_CCCR_INIT | FDCAN_CCCR_CCE;
    /* Fields hold a value less one; the quantum that comes first is in none. */
    FDCAN3->nbtp = FDCAN_NBTP_NBRP(CAN_PRESCALER - 1) |
                   FDCAN_NBTP_NTSEG1(CAN_QUANTA - 1 - CAN_SEGMENT_2 - 1) |
                   FDCAN_NBTP_NTSEG2(CAN_SEGMENT_2 - 1) | FDCAN_NBTP_NSJW(CAN_SEGMENT_2 - 1);
    FDCAN3->rxgfc = FDCAN_RXGFC_RRFE | FDCAN_RXGFC_RRFS | FDCAN_RXGFC_ANFE(FDCAN_REJECT) |
                    FDCAN_RXGFC_ANFS(FDCAN_REJECT) | FDCAN_RXGFC_LSS(FILTERS);
    configure_filters(NULL);
    FDCAN3->ie = FDCAN_IE_RFNE;
    FDCAN3->ile = FDCAN_ILE_EINT0;
    interrupt_enable(FDCAN3_IT0_IRQn, PRIORITY_CAN);
    FDCAN3->cccr = 0;
}

static void store(const struct fdcan_element *element)
{
    struct can_frame *frame = &receive.frames[receive.stored % RECEIVE_FRAMES];
    const uint32_t data[2] = {element->data[0], element->data[1]};
    const uint32_t length = element->control >> 16 & 15u;

    if (receive.stored - receive.read == RECEIVE_FRAMES) {
        receive.lost = true;
        return;
    }
    frame->id = (uint16_t)(element->id >> 18 & 0x7ffu);
    frame->length = (uint8_t)(length < 8u ? length : 8u);
    memcpy(frame->data, data, sizeof data);
    receive.stored++;
}

/* Of what comes meanwhile, it is raised again. */
void fdcan_interrupt(void)
{
    FDCAN3->ir = FDCAN_IR_RFN;
    for (uint32_t i = 0; i < FDCAN_FIFO_ELEMENTS; i++) {
        const uint32_t status = FDCAN3->rxf0s;
        const uint32_t at = status >> 8 & 3u;

        if ((status & FDCAN_RXF0S_FFL(15)) == 0u) {
            break;
        }
        store(&MESSAGE_RAM->rx_fifo0[at]);
        FDCAN3->rxf0a = at;
    }
}

/* What waits goes on its way. */
static void feed(void)
{
    for (uint32_t status; transmit.sent != transmit.written; transmit.sent++) {
        status = FDCAN3->txfqs;
        if ((status & FDCAN_TXFQS_TFQF) != 0u) {
            break;
        }
        const struct can_frame *frame = &transmit.frames[transmit.sent % TRANSMIT_FRAMES];
        const uint32_t at = status >> 16 & 3u;
        struct fdcan_element *element = &MESSAGE_RAM->tx_buffer[at];
        uint32_t data[2];

        memcpy(data, frame->data, sizeof data);
        element->id = (uint32_t)frame->id << 18;
        element->control = (uint32_t)frame->length << 16;
        element->data[0] = data[0];
        element->data[1] = data[1];
        FDCAN3->txbar = BIT(at);
    }
}

static bool take(void *context, struct can_frame *frame)
{
    (void)context;
    feed();
    if (receive.read == receive.stored) {
        return false;
    }
    *frame = receive.frames[receive.read % RECEIVE_FRAMES];
    receive.read++;
    return true;
}

static size_t room(void *context)
{
    (void)context;
    return TRANSMIT_FRAMES - (transmit.written - transmit.sent);
}

/* While the bus is off nothing waits: what is heard first behind it is that it is back. */
static void send(void *context, const struct can_frame *frame)
{
    if (!off && room(context) > 0u) {
        transmit.frames[transmit.written % TRANSMIT_FRAMES] = *frame;
        transmit.written++;
        feed();
    }
}

static void accept(void *context, const uint16_t ids[HAL_CAN_IDS])
{
    (void)context;
    configure_filters(ids);
}

/* The chip itself stays out after bus-off. CCE drops what it was to send. */
static void leave_bus_off(void)
{
    const uint32_t period = port_control_period();

    if ((FDCAN3->cccr & FDCAN_CCCR_INIT) != 0u && period - tried_in >= REST_PERIODS) {
        tried_in = period;
        transmit.sent = transmit.written;
        FDCAN3->cccr = FDCAN_CCCR_INIT | FDCAN_CCCR_CCE;
        FDCAN3->cccr = 0;
    }
}

static uint32_t state(void *context)
{
    static bool passive;
    const uint32_t psr = FDCAN3->psr;
    const bool lost = receive.lost || (FDCAN3->ir & FDCAN_IR_RFL) != 0u;

    (void)context;
    receive.lost = false;
    FDCAN3->ir = FDCAN_IR_RFL;
    passive = (psr & FDCAN_PSR_EP) != 0u || (passive && (psr & FDCAN_PSR_EW) != 0u);
    off = (psr & FDCAN_PSR_BO) != 0u;
    if (off) {
        leave_bus_off();
    }
    return (passive ? HAL_CAN_PASSIVE : 0u) | (off ? HAL_CAN_OFF : 0u) | (lost ? HAL_CAN_LOST : 0u);
}

const struct hal_can fdcan = {
    .receive = take, .room = room, .send = send, .accept = accept, .state = state};
