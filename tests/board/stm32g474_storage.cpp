/* What the STM32G474 image finds in its parameter store: what was spoilt when the supply failed,
   and settings that ask for an encoder, or for what only a simulation has. */
#include <array>
#include <cmath>

#include "firmware/application/settings_record.h"
#include "firmware/drive/record_log.h"
#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

/* What the drive has learned, firmware/drive/parameter_store.h. */
constexpr record_log learned = {0, 1, 24};
constexpr std::size_t store = Flash::bytes - 4 * Flash::page_bytes;
constexpr std::size_t slot_bytes = 40, slots = Flash::page_bytes / slot_bytes;
constexpr std::uint32_t older = 7;     /* sequence of the record that was there before */
constexpr std::int32_t torque = 30000; /* of its first coefficient, in 1e-7 Nm */

/* A slot of pages 0 and 1 in turn. */
std::size_t place(std::size_t slot)
{
    return store + slot / slots * Flash::page_bytes + slot % slots * slot_bytes;
}

/* Sequence and first coefficient of the record in a slot; sequence 0: there is none. */
std::pair<std::uint32_t, std::int32_t> record_in(Powered &run, std::size_t slot)
{
    const std::uint8_t *const record = &run.device.flash().memory()[place(slot)];
    if (!record_is_valid(&learned, record)) {
        return {0, 0};
    }
    return {static_cast<std::uint32_t>(record_get(&record[4], 4)),
            static_cast<std::int32_t>(record_get(&record[RECORD_HEADER_BYTES], 4))};
}

constexpr int counts_per_turn = 4000;
constexpr Ticks alignment_time = 6000 * ms; /* of an encoder, with the reference motor */

/* Of the reference motor. */
drive_settings defaults()
{
    const motor_params motor = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 3.0, 24.0, 50};
    drive_settings settings;
    drive_settings_default(&settings, &motor);
    return settings;
}

/* Stored: feedback by an encoder, whose counts per turn are the build's to give. */
drive_settings with_encoder()
{
    drive_settings stored = defaults();
    stored.feedback = DRIVE_FEEDBACK_ENCODER;
    return stored;
}

void put_settings(std::vector<std::uint8_t> &flash, const drive_settings &stored)
{
    settings_record_encode(&stored, 1,
                           &flash[store + SETTINGS_RECORD_FIRST_PAGE * Flash::page_bytes]);
}

void ask_for_encoder(std::vector<std::uint8_t> &flash)
{
    put_settings(flash, with_encoder());
}

/* A drive that learns, and knows where its encoder's counts begin. */
void put_learning(std::vector<std::uint8_t> &flash)
{
    drive_settings stored = with_encoder();
    drive_settings_select_feedback(&stored, DRIVE_FEEDBACK_ENCODER);
    stored.encoder_counts_per_turn = counts_per_turn;
    stored.encoder_zero_known = true;
    put_settings(flash, stored);
}

/* With one record in a slot; `fails_at` is asked for the flash's counters. */
void supply_fails(Expectations &expectations, const std::string &image, std::size_t slot,
                  const std::function<bool(const Flash::Counters &)> &fails_at,
                  bool beside_weak_cell = false)
{
    Stm32g474Config config = board_config();
    config.power_stage.plant.sensors.encoder_counts_per_turn = counts_per_turn;
    Powered run(image, config, [slot](std::vector<std::uint8_t> &flash) {
        put_learning(flash);
        std::array<std::uint8_t, RECORD_SLOT_BYTES(24)> record = {};
        record_put(&record[RECORD_HEADER_BYTES], static_cast<std::uint32_t>(torque), 4);
        record_seal(&learned, record.data(), older);
        std::copy_n(record.begin(), RECORD_BYTES(24), &flash[place(slot)]);
    });
    const Flash::Counters &counters = run.device.flash_controller().counters();
    (void)run.start();
    run.device.serial_line().send(run.machine.now(), "store\n");
    for (int i = 0; i < 10000 && !fails_at(counters); ++i) {
        run.run_for(5 * us);
    }
    expectations.expect(fails_at(counters), "the store is being written");
    run.run_for(20 * us);
    const unsigned errors = counters.double_errors;
    if (beside_weak_cell) {
        run.device.flash_controller().weaken(static_cast<std::uint32_t>(place(slot)));
    }
    run.machine.power_on();
    (void)run.output();
    const std::string text = run.start();
    expectations.expect(counters.double_errors > errors && run.machine.resets().empty() &&
                            count(text, "started by: power-on") == 1,
                        "the supply fails: what is spoilt is read, and the drive starts");
    expectations.expect(record_in(run, slot).first == older, "the record before is there");
    expectations.expect(count(run.type("store\n", 100 * ms), "ok store") == 1, "store is obeyed");
    std::pair<std::uint32_t, std::int32_t> saved = {0, 0};
    for (std::size_t i = slot + 1; i < 2 * slots && saved.first == 0; ++i) {
        saved = record_in(run, i);
    }
    expectations.expect(saved.first == older + 1 && std::abs(saved.second - torque) < torque / 100,
                        "and stores what the record before said");
    expectations.expect(run.enable() && run.machine.resets().empty(), "the drive can be enabled");
}

} // namespace

void supply_fails_in_store(Expectations &expectations, const std::string &image)
{
    supply_fails(expectations, image, 0,
                 [](const Flash::Counters &counters) { return counters.programs == 3; });
}

/* A cell that has been corrected is not to hide the torn one behind it. */
void supply_fails_beside_weak_cell(Expectations &expectations, const std::string &image)
{
    supply_fails(
        expectations, image, 0,
        [](const Flash::Counters &counters) { return counters.programs == 3; }, true);
}

/* The page is full: the other one is erased first. */
void supply_fails_in_erase(Expectations &expectations, const std::string &image)
{
    supply_fails(expectations, image, slots - 1,
                 [](const Flash::Counters &counters) { return counters.erases == 1; });
}

/* STEADYSTEP_ENCODER_COUNTS=0, as the image is by default. */
void encoder_is_asked_for(Expectations &expectations, const std::string &image)
{
    Powered run(image, board_config(), ask_for_encoder);
    const std::string text = run.start();
    expectations.expect(count(text, "settings: default") == 1 &&
                            count(text, "not in force: feedback = encoder, but none is known") == 1,
                        "without an encoder settings that ask for one are refused");
}

/* STEADYSTEP_SIMULATION=OFF, as in every image. */
void simulation_is_asked_for(Expectations &expectations, const std::string &image)
{
    const auto start_with = [&image](void (*ask)(drive_settings &)) {
        Powered run(image, board_config(), [ask](std::vector<std::uint8_t> &flash) {
            drive_settings stored = defaults();
            ask(stored);
            put_settings(flash, stored);
        });
        return run.start();
    };
    const std::string smc = start_with([](drive_settings &s) { s.law = POSITION_LAW_SMC; });
    const std::string impulses = start_with(
        [](drive_settings &s) { s.initial_position = DRIVE_INITIAL_POSITION_PUBLISHED_IMPULSES; });
    const std::string wrong =
        start_with([](drive_settings &s) { s.initial_angle_error_rad = 0.01; });
    const std::string foc = start_with([](drive_settings &s) { s.law = POSITION_LAW_FOC; });
    expectations.expect(count(smc, "settings: default") == 1 &&
                            count(smc, "not in force: law = smc: for simulation, this image has") ==
                                1,
                        "a law that is there for simulation is refused");
    expectations.expect(
        count(impulses, "not in force: initial_position = published-impulses: for") == 1,
        "and so are the published impulses");
    expectations.expect(count(wrong, "not in force: initial_angle_error_rad other than 0: for") ==
                            1,
                        "and an initial angle that is wrong on purpose");
    expectations.expect(count(foc, "settings: stored") == 1 && count(foc, "law=foc") == 1,
                        "the other laws are what they were");
}

/* Of an image built with STEADYSTEP_ENCODER_COUNTS=4000. */
void encoder_counts(Expectations &expectations, const std::string &image)
{
    Stm32g474Config config = board_config();
    config.power_stage.plant.sensors.encoder_counts_per_turn = counts_per_turn;
    Powered run(image, config, ask_for_encoder);
    expectations.expect(count(run.start(), "settings: stored") == 1,
                        "with an encoder settings that ask for one are in force");
    expectations.expect(run.enable(alignment_time), "the drive holds the motor");
    const double before = run.device.power_stage().plant().state().theta_rad;
    expectations.expect(count(run.type("move 3\n", 500 * ms), "ok move") == 1, "and moves it");
    const double moved = run.device.power_stage().plant().state().theta_rad - before;
    std::printf("  by %.4f rad\n", moved);
    expectations.expect(std::fabs(moved - 3.0) < 0.02, "as far as its counts per turn make it");
}

/* By CANopen on the serial line; the rotor rests on the index each time, that of the turn behind
   where it was. */
void homing_on_index(Expectations &expectations, const std::string &image)
{
    constexpr double turn_rad = 2 * 3.141592653589793, count_rad = turn_rad / counts_per_turn;
    Stm32g474Config config = board_config();
    plant::SensorConfig &sensors = config.power_stage.plant.sensors;
    sensors.encoder_counts_per_turn = counts_per_turn;
    Powered run(image, config, put_learning);
    const auto put = [&run](const char *object_and_value, Ticks time) {
        (void)run.type(std::string("t6018") + object_and_value + "\r", time);
    };
    const auto homes = [&](const char *method, int turns) {
        put("2F60600006000000", 5 * ms);
        put(method, 5 * ms);
        put("2B4060001F000000", 3000 * ms);
        const std::string said = run.type("t60184041600000000000\r", 5 * ms);
        const double theta_rad = run.device.power_stage().plant().state().theta_rad;
        const double off_rad = theta_rad - sensors.encoder_index_rad - turns * turn_rad;
        std::printf("  %.2f counts off that of turn %d\n", off_rad / count_rad, turns);
        expectations.expect(count(said, "t58184B416000371600") == 1, "homing is attained");
        expectations.expect(std::fabs(off_rad) < 2 * count_rad, "on the index");
        put("2B4060000F000000", 5 * ms);
    };
    (void)run.start();
    (void)run.type("O\rt00020101\r", 20 * ms);
    put("2B40600006000000", 5 * ms);
    put("2B4060000F000000", 500 * ms);
    homes("2F98600022000000", 0);
    put("2F60600001000000", 5 * ms); /* one and a half turns up: it passes what is still captured */
    put("237A600000800100", 5 * ms);
    put("2B4060001F000000", 2000 * ms);
    put("2B4060000F000000", 5 * ms);
    homes("2F98600022000000", 2);
    for (const int turns : {1, 0, -1}) { /* the count is below 0 in the end */
        homes("2F98600021000000", turns);
    }
}

} // namespace stm32g474_bench
