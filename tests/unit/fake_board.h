/* A board whose samples a test sets and whose bridge moves nothing: for one drive at a time. */
#ifndef STEADYSTEP_FAKE_BOARD_H
#define STEADYSTEP_FAKE_BOARD_H

#include "firmware/drive/drive.h"
#include "tests/unit/bench.h"

struct fake_board {
    bool short_circuit; /* latches the trip again as soon as it is cleared */
    bool trip_latched;  /* refuses to enable the bridge until it has been disabled */
    bool bridge_enabled;
};

static struct fake_board fake_board;

static inline bool fake_bridge_enable(void *context)
{
    struct fake_board *board = context;

    board->bridge_enabled = !board->trip_latched;
    return board->bridge_enabled;
}

static inline void fake_bridge_disable(void *context)
{
    struct fake_board *board = context;

    board->bridge_enabled = false;
    board->trip_latched = board->short_circuit;
}

/* All of the board that the drive asks for so far. */
static const struct hal fake_hal = {
    .context = &fake_board,
    .facts = &bench_facts,
    .bridge_enable = fake_bridge_enable,
    .bridge_disable = fake_bridge_disable,
};

/* No current, no voltage, 24 V on the bus. */
static const struct hal_samples samples_at_rest = {
    .current_a = 2048, .current_b = 2048, .bus_voltage = 3151};

#endif
