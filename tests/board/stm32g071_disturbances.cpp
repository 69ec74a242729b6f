/*
 * Runs the image of the STM32G071 board on the emulated core and disturbs it: the converter stops,
 * lines come faster than they are read, the flash is written, the stored settings are not for this
 * board, the program leaves memory.
 *
 * usage: stm32g071_disturbances IMAGE.elf     exit 1 and a line per expectation that does not hold
 */
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "firmware/application/settings_record.h"
#include "sil/virtual_board/image_map.h"
#include "sil/virtual_board/machine.h"
#include "sil/virtual_board/peripherals/stm32g071_board.h"
#include "tests/board/expectations.h"
#include "tests/board/stm32g071_motor.h"

namespace
{

using namespace virtual_board;

constexpr Ticks us = ticks_per_s / 1000000, ms = 1000 * us;
constexpr Ticks start_time = 800 * ms;          /* 0.6 s, and its text */
constexpr std::size_t settings_at = 124 * 1024; /* third page of the store */
constexpr unsigned pend_sv = 14;

Expectations expectations;

void expect(bool held, const char *what)
{
    expectations.expect(held, what);
}

/* A board with the image, powered. */
class Powered
{
  public:
    explicit Powered(const ElfImage &image, const drive_settings *stored = nullptr)
        : machine(stm32g071_board()),
          board(machine, stm32g071::plant_config(), stm32g071::host_baud),
          alarm_([this] { machine.stop(); }), bridge_opens_([this] { watch_bridge(); })
    {
        machine.attach(board);
        machine.load(image);
        if (stored != nullptr) {
            settings_record_encode(stored, 1, &board.flash().memory()[settings_at]);
        }
        board.on_sample = [this] { peak_at = machine.now(); };
        machine.power_on();
    }

    /* Resets, which end a run early, are counted in machine.resets(). */
    void run_for(Ticks time)
    {
        const Ticks end = machine.now() + time;
        while (machine.now() < end) {
            machine.schedule(alarm_, end);
            machine.run();
        }
    }
    std::string type(const std::string &line, Ticks time)
    {
        board.serial().send(machine.now(), line);
        run_for(time);
        return board.serial().take_output();
    }
    /* From the present peak on until the bridge is open, at most this long. */
    Ticks bridge_open_after(Ticks most)
    {
        opened_at_ = 0;
        machine.schedule(bridge_opens_, machine.now());
        run_for(most);
        machine.schedule(bridge_opens_, Event::never);
        return opened_at_;
    }

    Machine machine;
    G071Board board;
    Ticks peak_at = 0;

  private:
    void watch_bridge()
    {
        if (!board.bridge_on()) {
            opened_at_ = machine.now();
            return;
        }
        machine.schedule(bridge_opens_, machine.now() + us);
    }

    Event alarm_, bridge_opens_;
    Ticks opened_at_ = 0;
};

void converter_stops(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    const std::string ready = run.type("enable\n", 600 * ms);
    expect(count(ready, "ready:") == 1 && run.board.bridge_on(), "the drive holds the motor");

    /* Behind a control interrupt that has ended. */
    run.machine.stops_behind_control_interrupt = true;
    run.machine.run();
    run.machine.stops_behind_control_interrupt = false;
    const Ticks last_peak = run.peak_at;
    run.board.converter().lose_triggers();
    const Ticks opened = run.bridge_open_after(300 * us);
    std::printf("  the bridge opens %.1f us behind the last peak that was sampled\n",
                static_cast<double>(opened - last_peak) / static_cast<double>(us));
    expect(opened != 0 && opened - last_peak <= 192 * us,
           "without samples the bridge opens at the next deadline");
    run.run_for(900 * ms);
    expect(run.machine.resets().size() == 1 && run.machine.resets().front() == "watchdog",
           "and the watchdog resets the board");
    const std::string text = run.board.serial().take_output();
    expect(count(text, "started by: watchdog") == 1, "which reports it");
}

void lines_overflow(const ElfImage &image)
{
    Powered run(image);
    run.run_for(50 * ms);
    std::string lines;
    for (int i = 0; i < 200; i++) {
        lines += "cycles\n"; /* 121 ms, while start-up designs the gains */
    }
    run.board.serial().send(run.machine.now(), lines);
    run.run_for(1000 * ms);
    const std::string text = run.board.serial().take_output();
    const std::size_t kept = count(text, "ok cycles");
    std::printf("  %zu lines of 200 are answered\n", kept);
    expect(count(text, "error: bytes of the line were lost") == 1, "lost lines are reported once");
    expect(kept >= 10 && kept <= 16 && count(text, "error") == 1,
           "whole lines behind them are kept");
    expect(count(run.type("cycles\n", 30 * ms), "ok cycles") == 1, "the next line is obeyed");
    expect(run.type("disable", 20 * ms).empty(), "a line without an end waits");
    expect(count(run.type("\n", 20 * ms), "ok disable") == 1, "until its end comes");
    expect(count(run.type("cycles\r", 30 * ms), "ok cycles") == 1, "a line ended by CR is obeyed");
    expect(count(run.type("cycles\r\ncycles\n", 40 * ms), "ok cycles") == 2, "and by CR and LF");
    expect(count(run.type(std::string(700, 'x') + "\ncycles\n", 150 * ms), "ok cycles") == 1,
           "a line behind one that is too long is obeyed");
}

void beginning_lost(const ElfImage &image)
{
    Powered probe(image);
    probe.machine.stops_behind_control_interrupt = true;
    probe.machine.run();
    const Ticks first_read = probe.machine.now();

    /* 550 bytes of the line have come when it is read for the first time, 50 follow. */
    Powered run(image);
    run.run_for(first_read - 48 * ms);
    run.board.serial().send(run.machine.now(), std::string(600, ' ') + "disable\ncycles\n");
    run.run_for(1000 * ms);
    const std::string text = run.board.serial().take_output();
    expect(count(text, "ok disable") == 0 && count(text, "error: bytes of the line were lost") == 1,
           "a line that has lost its beginning is not obeyed");
    expect(count(text, "ok cycles") == 1, "but the one behind it is");
}

void flash_is_written(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    expect(count(run.type("store\n", 300 * ms), "ok store") == 1, "store is obeyed, bridge open");
    expect(count(run.type("enable\n", 600 * ms), "ready:") == 1 && run.board.bridge_on(),
           "the bridge closes behind it");
    const std::string refused = run.type("store\n", 300 * ms);
    expect(count(refused, "error: ") == 1 && run.board.bridge_on(),
           "store is refused while the bridge is on, which stays on");
    expect(count(run.type("disable\n", 20 * ms), "ok disable") == 1 && !run.board.bridge_on(),
           "disable opens the bridge");
    expect(count(run.type("store\n", 300 * ms), "ok store") == 1, "store is obeyed again");
    expect(run.machine.resets().empty(), "no reset");
}

/* The double word being programmed is torn, and fails the ECC from then on. */
void supply_fails_in_store(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    (void)run.type("set hold_current_A 0.8\n", 20 * ms);
    expect(count(run.type("store\n", 300 * ms), "ok store") == 1, "a record is stored");
    (void)run.type("set hold_current_A 0.9\n", 20 * ms);
    run.board.serial().send(run.machine.now(), "store\n");
    const auto is_written = [&] { return run.board.flash().busy_until(0) > run.machine.now(); };
    for (int i = 0; i < 10000 && !is_written(); i++) {
        run.run_for(20 * us);
    }
    expect(is_written(), "the next one is being written");
    run.machine.power_on();
    (void)run.board.serial().take_output();
    run.run_for(1000 * ms);
    const std::string text = run.board.serial().take_output();
    expect(run.board.flash().double_errors() > 0 && run.machine.resets().empty() &&
               count(text, "settings: stored") == 1 && count(text, "crash") == 0,
           "the supply fails: what is spoilt is read, and the drive starts");
    expect(count(run.type("get hold_current_A\n", 20 * ms), "hold_current_A=0.8 A") == 1,
           "with the record before");
    expect(count(run.type("store\n", 300 * ms), "ok store") == 1, "and stores the next");
}

void flash_never_ends(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    run.board.flash().wear_out();
    const std::string text = run.type("store\n", 900 * ms);
    expect(count(text, "refused to write") == 1 && run.machine.resets().empty(),
           "a flash that stays busy ends in a refusal, without a reset");
    expect(count(run.type("enable\n", 600 * ms), "ready:") == 1, "and the drive goes on");
}

void debugger_halts(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    RegisterBlock &debug = run.board.debug_support();
    expect(
        debug.read(0x08, 4, Master::core) == (1u << 1 | 1u << 12) &&
            debug.read(0x0c, 4, Master::core) == 1u << 11,
        "TIM1, TIM3 and the watchdog stand still while a debugger halts the core, TIM2 does not");
}

/* Its design takes longer than the watchdog waits. */
void settings_act(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    expect(count(run.type("set hold_current_A 0.8\n", 20 * ms), "acts at the next enable") == 1,
           "a setting waits for the enable");
    expect(count(run.type("enable\n", 1250 * ms), "ready:") == 1 && run.board.bridge_on(),
           "the drive is designed, and enabled");
    expect(count(run.type("get hold_current_A\n", 20 * ms), "hold_current_A=0.8 A") == 1 &&
               count(run.type("set current_limit_A 1\n", 40 * ms), "acts at once") == 1,
           "a limit acts at once");
    (void)run.type("disable\n", 20 * ms);
    (void)run.type("set law_bandwidth_rad_s 5000\n", 20 * ms);
    expect(count(run.type("enable\n", 1500 * ms), "what was set is not in force") == 1 &&
               !run.board.bridge_on(),
           "a set-up that the drive refuses leaves the bridge off");
    (void)run.type("set law_bandwidth_rad_s default\n", 20 * ms);
    expect(count(run.type("enable\n", 1250 * ms), "ready:") == 1, "and the one before in force");
    const Watchdog &watchdog = run.board.watchdog();
    std::printf("  watchdog fed after %.0f ms at the latest, of %.0f\n",
                double(watchdog.counters.longest) / double(ms),
                double(watchdog.timeout()) / double(ms));
    expect(run.machine.resets().empty() && watchdog.counters.longest < watchdog.timeout() * 4 / 5,
           "the watchdog has been fed all the time, with a fifth to spare");
}

void settings_with_encoder(const ElfImage &image)
{
    drive_settings stored;
    drive_settings_default(&stored, &stm32g071::motor);
    stored.motor.rated_current_A = 2.5;
    stored.identify_inductance = true; /* of this machine's firmware, not of the image */
    stored.encoder_counts_per_turn = 4000;
    {
        Powered run(image, &stored);
        run.run_for(1500 * ms);
        const std::string text = run.board.serial().take_output();
        expect(count(text, "settings: stored") == 1 && count(text, "rated_current_A=2.5") == 1 &&
                   count(text, "stored, but not of this image: encoder_counts_per_turn "
                               "identify_inductance") == 1,
               "stored settings are in force but for those of parts left out, which are named");
    }
    stored.feedback = DRIVE_FEEDBACK_ENCODER;
    Powered run(image, &stored);
    run.run_for(1500 * ms);
    const std::string text = run.board.serial().take_output();
    expect(count(text, "settings: default") == 1 &&
               count(text, "not in force: feedback = encoder: this image is for a board "
                           "without one") == 1,
           "stored settings that ask for an encoder are refused");
}

/* What the image has no part for: hal/stm32g071/CMakeLists.txt. */
void settings_of_parts_left_out(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    for (const char *set :
         {"identify_inductance true", "node_id 2", "modbus_rtu true", "inputs_used 8",
          "inputs_low 1", "outputs_low 1", "holding_brake_s 0.5"}) {
        const std::string line = std::string("set ") + set,
                          name = line.substr(4, line.find(' ', 4) - 4);
        const std::string text = run.type(line + "\n", 40 * ms);
        expect(count(text, "error: " + name) == 1, ("refused by name: " + line).c_str());
    }
    expect(count(run.type("set identify_inductance false\n", 40 * ms), "ok set") == 1,
           "what it is without the part is no error");
}

/* hal/stm32g071/CMakeLists.txt, default_laws. */
void laws_are_listed(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    const std::string listed = run.type("get law\n", 50 * ms);
    expect(count(listed, "; state-feedback, microstepping; ") == 1,
           "get law lists the laws that the image carries, and no other");
}

void program_leaves_memory(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    (void)run.type("enable\n", 600 * ms);
    const std::uint32_t vectors = *image.symbol("handlers_start");
    const std::uint8_t nowhere[4] = {1, 0, 0, 0x30};
    std::copy(nowhere, nowhere + 4, run.machine.memory(vectors + 4 * pend_sv, 4));
    const Ticks opened = run.bridge_open_after(200 * us);
    expect(opened != 0, "a fault opens the bridge");
    run.run_for(800 * ms);
    const std::string text = run.board.serial().take_output();
    expect(count(text, "started by: crash: hard fault at 0x") == 1 && count(text, " lr 0x") == 1 &&
               count(text, " in period ") == 1,
           "and is reported at the next start");
}

void bus_is_braked(const ElfImage &image)
{
    Powered run(image);
    run.run_for(start_time);
    const Gpio &port = run.board.pins().port('C');
    run.board.plant().set_bus(29.9);
    run.run_for(ms);
    expect(!port.drives_high(6), "the brake is off below 1.25 of the supply");
    run.board.plant().set_bus(30.3);
    run.run_for(300 * us);
    expect(port.drives_high(6), "and on above");
    run.board.plant().set_bus(24.0);
    run.run_for(300 * us);
    expect(!port.drives_high(6), "until the bus is back");
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "usage: stm32g071_disturbances IMAGE.elf\n");
        return 2;
    }
    try {
        const ElfImage image = ElfImage::read(argv[1]);
        converter_stops(image);
        lines_overflow(image);
        beginning_lost(image);
        flash_is_written(image);
        supply_fails_in_store(image);
        flash_never_ends(image);
        debugger_halts(image);
        settings_act(image);
        settings_with_encoder(image);
        laws_are_listed(image);
        settings_of_parts_left_out(image);
        program_leaves_memory(image);
        bus_is_braked(image);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "stm32g071_disturbances: %s\n", error.what());
        return 1;
    }
    return expectations.failures() > 0 ? 1 : 0;
}
