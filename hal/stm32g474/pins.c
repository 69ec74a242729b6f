#include "hal/stm32g474/pins.h"

#include "hal/cortex_m/port.h"
#include "hal/stm32g474/board.h"
#include "hal/stm32g474/registers.h"

struct pin {
    struct gpio_registers *port;
    uint8_t number, mode, alternate, pull;
};

#define PIN_ENTRY(port, number, mode, alternate, pull, peripheral, signal)                         \
    {GPIO##port, number, GPIO_MODE_##mode, alternate, GPIO_PULL_##pull},

static const struct pin pins[] = {BOARD_PINS(PIN_ENTRY)};

#define PORT_CLOCK(port, number, mode, alternate, pull, peripheral, signal)                        \
    | RCC_AHB2ENR_GPIO##port##EN

static void connect(const struct pin *pin)
{
    const uint32_t twice = 2u * pin->number;
    const uint32_t afr = pin->number / 8u;
    const uint32_t quad = 4u * (pin->number % 8u);
    struct gpio_registers *port = pin->port;

    port->pupdr = (port->pupdr & ~FIELD(3, twice, 2)) | FIELD(pin->pull, twice, 2);
    port->ospeedr = (port->ospeedr & ~FIELD(3, twice, 2)) | FIELD(GPIO_SPEED_MEDIUM, twice, 2);
    port->afr[afr] = (port->afr[afr] & ~FIELD(15, quad, 4)) | FIELD(pin->alternate, quad, 4);
    port->moder = (port->moder & ~FIELD(3, twice, 2)) | FIELD(pin->mode, twice, 2);
}

void pins_connect(void)
{
    RCC->ahb2enr |= 0 BOARD_PINS(PORT_CLOCK);
    (void)RCC->ahb2enr;
    for (uint32_t i = 0; i < sizeof pins / sizeof pins[0]; i++) {
        connect(&pins[i]);
    }
}

void pins_led(int on)
{
    LED_PORT->bsrr = on ? BIT(LED_PIN) : BIT(LED_PIN + 16);
}

uint32_t port_inputs_read(void)
{
    return MACHINE_INPUTS_PORT->idr >> MACHINE_INPUTS_PIN & HAL_INPUTS;
}

/* Sets and clears at once. */
void port_outputs_write(uint32_t levels)
{
    MACHINE_OUTPUTS_PORT->bsrr = (levels & HAL_OUTPUTS) << MACHINE_OUTPUTS_PIN |
                                 (~levels & HAL_OUTPUTS) << (MACHINE_OUTPUTS_PIN + 16u);
}
