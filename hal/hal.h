/*
 * The whole contract between the drive firmware and a board.
 *
 * A board owns the PWM timer, the converters and the bridge. Once per PWM period it hands one
 * coherent set of raw samples to the control interrupt and takes the duties of the next period.
 * Raw integers cross this border, so that a fixed-point drive needs no floating-point number.
 *
 * Timing of one period T, centre-aligned; 100 us at 10 kHz, of others as much in proportion:
 *
 *   counter peak      ^             ^             ^      legs high around the valley; around the
 *   (low state)       S(k)          S(k+1)        S(k+2) peak all four low sides conduct, so that
 *                                                        the low-side shunts carry the currents
 *   control           [ISR]                              starts at the peak or when the conversion
 *                                                        there ends, must end within 0.9 T
 *   duty in force     D(k-1) -----> D(k) ------->        compares load at the peak only: what is
 *                                                        computed from S(k) acts S(k+1)...S(k+2)
 *
 * Currents are sampled at the peak. A phase voltage is the mean over S(k-1)...S(k) of the
 * difference of its two leg voltages.
 */
#ifndef STEADYSTEP_HAL_H
#define STEADYSTEP_HAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Flags of a sample set. */
enum {
    HAL_FLAG_OVERCURRENT_TRIP = 1u << 0, /* the board's comparator has opened the bridge */
    HAL_FLAG_DEADLINE_MISSED = 1u << 1,  /* the previous control interrupt ended too late */
};

/* One coherent sample set, taken at S(k). */
struct hal_samples {
    uint16_t current_a;      /* ADC code, zero current at facts.current_zero_code */
    uint16_t current_b;      /* ADC code */
    uint16_t bus_voltage;    /* ADC code, 0 V at code 0 */
    int16_t phase_voltage_a; /* signed code, mean over the period that ends at S(k) */
    int16_t phase_voltage_b; /* signed code */
    int32_t encoder_count;   /* quadrature count, wraps; 0 if not fitted */
    uint32_t flags;          /* HAL_FLAG_... */
};

/* The four half-bridges. */
enum hal_leg { HAL_LEG_A_PLUS, HAL_LEG_A_MINUS, HAL_LEG_B_PLUS, HAL_LEG_B_MINUS, HAL_LEGS };

/* What the control interrupt returns, to act over S(k+1)...S(k+2). */
struct hal_outputs {
    /* time high per half period, 0...pwm_half_period_counts; aligned, to be copied in words */
    uint16_t high_counts[HAL_LEGS] __attribute__((aligned(4)));
    bool bridge_on; /* false: all gates off, at once */
};

/* Constant properties of a board, SI units; read at start-up only. */
struct hal_facts {
    const char *board_name;
    double control_period_s;
    uint32_t pwm_half_period_counts; /* timer counts from valley to peak: 8500 at 170 MHz and
                                        10 kHz */
    double dead_time_s;       /* 3 % of the period at most: 10 % of the supply lost is a fault */
    double leg_delay_s;       /* largest difference between the delays of the two legs of a phase */
    double low_state_s;       /* in which all four low sides are to conduct around each S(k), to
                                 measure the currents there; dead time included */
    uint32_t converter_codes; /* codes of currents and bus are 0...converter_codes - 1 */
    double current_A_per_code; /* both phases */
    uint16_t current_zero_code;
    double current_offset_codes; /* largest offset that calibration leaves: drift since, and what
                                    the converter's steps are uneven by */
    double bus_V_per_code;
    double phase_voltage_V_per_code;
    bool has_phase_voltages;
    uint32_t encoder_counts_per_turn; /* 0: no encoder */
    bool zero_delay; /* only in a simulation: the duties of S(k) act S(k)...S(k+1), without the
                        period of delay of the diagram */
    bool has_brake;  /* a resistor that the board's control interrupt connects to the bus as
                        application_brake says, for S(k)...S(k+1); off after a reset */
    bool has_encoder_index; /* the encoder's index is wired; of a board that reads an encoder */
    double bridge_resistance_ohm; /* both conducting switches in series with a phase */
    double bridge_ntc_beta_K;     /* of the NTC resistor that measures the bridge's temperature:
                                     drive/thermal_model.h; 0: none is fitted */
    uint32_t cycle_counter_Hz;
    uint32_t parameter_page_bytes; /* unit of erase of the parameter store */
    uint32_t parameter_word_bytes; /* unit of programming */
};

/* Levels of the machine's inputs, a bit each (firmware/application/machine_io.h). */
enum hal_input {
    HAL_INPUT_LIMIT_MINUS = 1u << 0, /* in the order of 60fdh */
    HAL_INPUT_LIMIT_PLUS = 1u << 1,
    HAL_INPUT_HOME = 1u << 2,
    HAL_INPUT_ENABLE = 1u << 3,
    HAL_INPUT_QUICK_STOP = 1u << 4,
    HAL_INPUTS = (1u << 5) - 1u
};

/* Of its outputs; low after a reset. */
enum hal_output {
    HAL_OUTPUT_ALARM = 1u << 0,
    HAL_OUTPUT_IN_POSITION = 1u << 1,
    HAL_OUTPUT_BRAKE = 1u << 2, /* high: released */
    HAL_OUTPUTS = (1u << 3) - 1u
};

/* What is asked of an encoder's index. */
enum hal_index { HAL_INDEX_PASSED, HAL_INDEX_RISES, HAL_INDEX_FALLS };

/* Words that a board with follow_control has for what is captured. */
enum { HAL_CAPTURE_WORDS = 5376 };

/*
 * A board. Every function may be called from the background loop; bridge_disable also from any
 * interrupt. `context` is the board's own. Blocking times are those of the STM32G474 port; what
 * blocks, blocks the background alone, never the control interrupt.
 */
struct hal {
    void *context;
    const struct hal_facts *facts;
    const char *version; /* of the image: "steadystep 0.2.0 <hash> ..."; the console prints it */

    /* Allows the gates to follow the outputs; false if a hardware trip is latched. < 1 us. */
    bool (*bridge_enable)(void *context);
    /* All gates off at once, safe from anywhere; clears a latched trip. < 1 us. */
    void (*bridge_disable)(void *context);
    /* ADC code of the bridge's temperature, of the last S(k); asked for if facts.bridge_ntc_beta_K
       is above 0. < 1 us. */
    uint16_t (*bridge_temperature)(void *context);
    /* Levels of the machine's inputs and outputs, HAL_INPUT_... and HAL_OUTPUT_...; an input that
       nothing drives is high. Both NULL: the board has none. < 1 us. */
    uint32_t (*inputs_read)(void *context);
    void (*outputs_write)(void *context, uint32_t levels);
    /*
     * An edge of the encoder's index, if facts.has_encoder_index; NULL otherwise, or if nothing
     * asks. HAL_INDEX_RISES, HAL_INDEX_FALLS: from now on hardware keeps the count at that edge,
     * each time it passes; what was kept until now is forgotten; false. The rising edge of a rotor
     * that goes up is the falling one of a rotor that goes down. HAL_INDEX_PASSED: whether it has
     * passed since, or since this was asked last; then `count` is hal_samples.encoder_count at the
     * last passage, where A or B changes with the index the one before or behind. To be asked until
     * the rotor has gone on by 32,767 counts. < 1 us.
     */
    bool (*encoder_index)(void *context, enum hal_index ask, int32_t *count);
    /* Free-running, wraps at 2^32, facts.cycle_counter_Hz. < 1 us. */
    uint32_t (*cycle_count)(void *context);
    /* Time since start-up, never runs backwards. < 1 us. */
    uint64_t (*time_us)(void *context);
    /* Feeds the watchdog; the board resets if this stops for longer than its period. < 1 us. */
    void (*watchdog_feed)(void *context);
    /* Why the board started: one line of text without an end, e.g. "power-on", "reset pin",
       "watchdog", or what it recorded of a crash, "crash: hard fault at 0x08001234 in period 56".
       The same until the next start. < 1 us. */
    const char *(*start_cause)(void *context);

    /* Whether the board calls application_follow_control behind each control interrupt, before the
       next one; NULL: it cannot. < 1 us. */
    void (*follow_control)(void *context, bool follows);

    /* From true to false no interrupt comes, at most for 2 us: for what the control interrupt is to
       find as a whole. NULL: none comes while the background runs. */
    void (*defer_interrupts)(void *context, bool defers);

    /*
     * Bytes from the host, as they come: at most `capacity`, and none behind the first '\n'; the
     * number read. If the last one is '\n', `line_period` receives the index of the control period
     * in which it arrived: of the last control interrupt that had begun by then. The first since
     * start-up is 0, before it the index is UINT32_MAX. A character-match interrupt stamps it, so
     * that the stamp does not depend on when the background reads. '\r' ends a line, too, but has
     * no stamp: such a line counts from the period in which its '\r' is read, so that what is to
     * happen in the same period every time ends with '\n'. What the board cannot hold is lost; a
     * line that it has lost bytes of, it gives HAL_STREAM_LOST before the '\n' or '\r'. Up to 20
     * us.
     */
    size_t (*stream_read)(void *context, uint8_t *bytes, size_t capacity, uint32_t *line_period);
    /* Bytes to the host: number of bytes taken, as many as there is room for. Up to 20 us. */
    size_t (*stream_write)(void *context, const uint8_t *bytes, size_t count);

    /* Parameter store in the units of real flash, at least four pages: 0 and 1 for what the drive
       learns, 2 and 3 for its settings. false: out of range, not erased, or, of a read, unreadable
       since a loss of power has cut off programming or erasing. Erasing takes up to 25 ms,
       programming 0.1 ms a word, reading 10 us per 100 bytes. A board whose program lies in the
       same bank of flash would stall with it: it refuses (false) while the bridge is on, and blocks
       for up to 40 ms otherwise. */
    bool (*parameters_erase)(void *context, uint32_t page);
    bool (*parameters_program)(void *context, uint32_t offset, const void *data, size_t count);
    bool (*parameters_read)(void *context, uint32_t offset, void *data, size_t count);
};

/* A data frame of a CAN bus with an identifier of 11 bits. */
struct can_frame {
    uint16_t id;
    uint8_t length; /* bytes of data, 0...8 */
    uint8_t data[8];
};

/* How a board stands to its CAN bus. */
enum hal_can_state {
    HAL_CAN_PASSIVE =
        1u << 0,           /* an error counter has reached 128, and not both are below 96 again */
    HAL_CAN_OFF = 1u << 1, /* bus-off: nothing goes or comes until 128 times 11 recessive bits */
    HAL_CAN_LOST = 1u << 2 /* frames have come and were lost for want of space; said once */
};

/* Identifiers that a board is asked to receive. */
enum { HAL_CAN_IDS = 8 };

/*
 * A board's CAN bus, CAN 2.0, data frames of 11-bit identifiers alone; of a board that has one. It
 * is on the bus from its start on, and leaves it by its errors alone. Then it is back by itself,
 * tried once in a second; what was to be sent by then is lost. All of it for the background, none
 * takes more than 20 us, none waits.
 */
struct hal_can {
    void *context;
    /* The next frame that has come; false: none. */
    bool (*receive)(void *context, struct can_frame *frame);
    /* Frames that there is room for; after a start six at least. */
    size_t (*room)(void *context);
    /* Sends, behind what was sent before; lost without room. */
    void (*send)(void *context, const struct can_frame *frame);
    /* Receives these alone from now on, NULL: none, as at the start. What has come stays. */
    void (*accept)(void *context, const uint16_t ids[HAL_CAN_IDS]);
    /* HAL_CAN_...; to be asked once in some milliseconds. */
    uint32_t (*state)(void *context);
};

static inline void hal_defer_interrupts(const struct hal *board, bool defers)
{
    if (board->defer_interrupts != NULL) {
        board->defer_interrupts(board->context, defers);
    }
}

/* A byte that stands for those lost (ASCII CAN); no line may contain it. */
#define HAL_STREAM_LOST 0x18u

#endif
