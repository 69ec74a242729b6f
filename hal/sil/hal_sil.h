/*
 * The HAL of the simulated drive board: everything of hal.h that is not the plant. Time advances
 * only by hal_sil_next_period(), so all counters are functions of the period index.
 *
 * Kept in one struct by whoever owns the board; `board.context` points back to it, so it must stay
 * where hal_sil_init() found it.
 */
#ifndef STEADYSTEP_HAL_SIL_H
#define STEADYSTEP_HAL_SIL_H

#include "hal/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The STM32G474's flash: erased in pages of 2 KB to 0xff, programmed in double words of 8 bytes. */
enum {
    HAL_SIL_PAGE_BYTES = 2048,
    HAL_SIL_WORD_BYTES = 8,
    HAL_SIL_PAGES = 4,
    HAL_SIL_STREAM_BYTES = 2048, /* capacity of the byte stream in each direction */
    HAL_SIL_WATCHDOG_US = 50000, /* runs from the first feeding on */
};

struct hal_sil_stream {
    uint8_t bytes[HAL_SIL_STREAM_BYTES];
    uint32_t arrived_in[HAL_SIL_STREAM_BYTES]; /* control period of each byte */
    size_t first, count;
};

struct hal_sil {
    struct hal board; /* what the firmware is given */
    struct hal_facts facts;

    uint64_t period;          /* index k of the present S(k), since the first start */
    uint32_t control_period;  /* of the last control interrupt that has begun, since the last start;
                                 UINT32_MAX: none has */
    bool follows;             /* application_follow_control, behind the control interrupt */
    bool bridge_allowed;      /* between bridge_enable and bridge_disable */
    bool trip_latched;        /* by hal_sil_trip, until bridge_disable */
    uint32_t inputs, outputs; /* levels of the machine's */
    uint16_t bridge_temperature;  /* code of its sensor */
    enum hal_index index_awaited; /* HAL_INDEX_PASSED: no edge of it */
    bool index_passed;
    int32_t index_count;
    bool restarted; /* by hal_sil_restart */
    bool watchdog_running;
    uint64_t watchdog_fed_us;
    struct hal_sil_stream to_drive, to_host;
    uint8_t parameters[HAL_SIL_PAGES * HAL_SIL_PAGE_BYTES];
    uint32_t capture[HAL_CAPTURE_WORDS];
};

/*
 * A board at its first period, with an erased parameter store. `facts` is copied; its units of the
 * parameter store are set to the enum's, its cycle_counter_Hz to whole counts per period.
 */
void hal_sil_init(struct hal_sil *sil, const struct hal_facts *facts);

/* The supply has failed and returned: bridge off, no byte on its way, watchdog not running; the
   parameter store and the time go on. */
void hal_sil_restart(struct hal_sil *sil);

/* The control interrupt of the present S(k) begins. */
void hal_sil_control_begins(struct hal_sil *sil);

/* One PWM period passes. */
void hal_sil_next_period(struct hal_sil *sil);

/* An edge of the encoder's index has passed, at this count. */
void hal_sil_index_edge(struct hal_sil *sil, bool rises, int32_t count);

/* The board's overcurrent comparator: opens the bridge and keeps it open until bridge_disable. */
void hal_sil_trip(struct hal_sil *sil);

/* Whether the gates may follow the outputs. */
bool hal_sil_bridge_on(const struct hal_sil *sil);

/* The host's end of the byte stream: number of bytes moved. They arrive in control_period. */
size_t hal_sil_host_write(struct hal_sil *sil, const uint8_t *bytes, size_t count);
size_t hal_sil_host_read(struct hal_sil *sil, uint8_t *bytes, size_t capacity);

/* Whether a real board would by now have been reset by its watchdog. */
bool hal_sil_watchdog_expired(const struct hal_sil *sil);

#ifdef __cplusplus
}
#endif

#endif
