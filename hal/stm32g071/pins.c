#include "hal/stm32g071/pins.h"

#include "hal/stm32g071/board.h"
#include "hal/stm32g071/registers.h"

enum { MODE_ALTERNATE = 2, MODE_OUTPUT = 1, MODE_ANALOG = 3 };
enum { PULL_NONE = 0, PULL_UP = 1, PULL_DOWN = 2 };

static void set(volatile uint32_t *reg, unsigned position, unsigned width, uint32_t value)
{
    *reg = (*reg & ~FIELD(UINT32_MAX, position, width)) | FIELD(value, position, width);
}

struct pin {
    struct gpio_registers *port;
    uint8_t number, mode, alternate, pull;
};

#define PIN_ENTRY(port, number, mode, alternate, pull, peripheral, signal)                         \
    {GPIO##port, number, MODE_##mode, alternate, PULL_##pull},

static const struct pin pins[] = {BOARD_PINS(PIN_ENTRY)};

static void connect(const struct pin *pin)
{
    struct gpio_registers *port = pin->port;

    set(pin->number < 8 ? &port->afrl : &port->afrh, 4u * (pin->number % 8u), 4, pin->alternate);
    set(&port->pupdr, 2u * pin->number, 2, pin->pull);
    set(&port->moder, 2u * pin->number, 2, pin->mode);
}

void pins_connect(void)
{
    for (unsigned i = 0; i < sizeof pins / sizeof pins[0]; i++) {
        connect(&pins[i]);
    }
}
