#include "hal/stm32g071/pins.h"

#include "hal/stm32g071/board.h"
#include "hal/stm32g071/registers.h"

enum { MODE_ALTERNATE = 2, MODE_OUTPUT = 1, MODE_ANALOG = 3 };
enum { PULL_NONE = 0, PULL_UP = 1, PULL_DOWN = 2 };

static void set(volatile uint32_t *reg, unsigned position, unsigned width, uint32_t value)
{
    *reg = (*reg & ~FIELD(UINT32_MAX, position, width)) | FIELD(value, position, width);
}

static void connect(struct gpio_registers *port, unsigned pin, uint32_t mode, uint32_t alternate,
                    uint32_t pull)
{
    set(pin < 8 ? &port->afrl : &port->afrh, 4u * (pin % 8u), 4, alternate);
    set(&port->pupdr, 2u * pin, 2, pull);
    set(&port->moder, 2u * pin, 2, mode);
}

void pins_connect(void)
{
#define CONNECT(port, number, mode, alternate, pull, peripheral, signal)                           \
    connect(GPIO##port, number, MODE_##mode, alternate, PULL_##pull);
    BOARD_PINS(CONNECT)
#undef CONNECT
}
