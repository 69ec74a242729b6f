/*
 * Runs the image of the STM32G474 board on the virtual board and disturbs it: a debugger halts it,
 * conversions are lost, a comparator trips between two instructions, the program leaves memory,
 * start-up fails, lines come faster than they are read, the supply fails while the store is
 * written.
 *
 * usage: stm32g474_disturbances IMAGE.elf [CASE]     exit 1 and a line per expectation that does
 * not hold
 */
#include <algorithm>
#include <cstring>
#include <exception>

#include "tests/board/stm32g474_bench.h"

namespace
{

using namespace stm32g474_bench;

enum : std::uint32_t { TIM1_CCR1 = 0x40012c34, TIM1_BDTR = 0x40012c44, TIM3_CR1 = 0x40000400 };
constexpr std::uint32_t MOE = 1u << 15;
constexpr unsigned line_interrupt = 16 + Lpuart::interrupt_line;

/* In the control interrupt, and in the background behind it. */
void debugger_halts(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    for (const Ticks behind_peak : {5 * us, 30 * us}) {
        const std::string where = behind_peak < 10 * us ? " in the control interrupt" : "";
        expectations.expect(run.enable(), "the drive holds the motor");
        run.run_behind_peak(behind_peak);
        run.device.halt(true);
        expectations.expect(!run.bridge_on(), "a halt" + where + " opens the bridge");
        run.machine.halt(273 * us);
        expectations.expect(!run.bridge_on(), "which stays open");
        (void)run.output();
        run.device.halt(false);
        run.run_for(1 * us);
        expectations.expect(!run.bridge_on(), "and does not close when the program goes on");
        run.run_for(20 * ms);
        expectations.expect(!run.bridge_on() && count(run.output(), "fault: deadline-missed") == 1,
                            "as the drive has missed a deadline, which it reports");
        expectations.expect(count(run.type("disable\n", 20 * ms), "ok disable") == 1,
                            "disable clears the fault");
    }
    expectations.expect(run.enable(), "the drive holds the motor again");
    expectations.expect(run.machine.resets().empty(), "all conversions are in step: no reset");
}

/*
 * While a control interrupt is held up beyond the next S(k), so that it is not the missing
 * interrupt that reports it: the trigger timer stands from here to the peak, which starts it again.
 */
void conversions_are_lost(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(run.enable(), "the drive holds the motor");
    run.run_behind_peak(60 * us); /* the next control interrupt is that of the next peak */
    run.machine.stall_control_interrupt(0, 130 * us / run.machine.core_cycle());
    run.run_behind_peak(0);
    Event stops([&] { run.machine.store(TIM3_CR1, 4, 0); });
    run.machine.schedule(stops, run.machine.now() + 60 * us);
    run.run_for(ms);
    expectations.expect(run.machine.resets().size() == 1 && !run.bridge_on(),
                        "conversions out of step with the period open the bridge");
    expectations.expect(
        count(run.start(), "started by: crash: leg-voltage conversions out of step or lost") == 1,
        "and are reported at the next start");
}

/* A comparator trips for less than a cycle between the look at the break flags and the write that
   closes the bridge: the flag is up, but the write has its way. */
void break_while_closing(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    int closed = 0;
    bool open = false;
    Event look([&] { open = !run.bridge_on(); });
    run.device.before_write = [&](std::uint32_t address, std::uint32_t value) {
        if (address == TIM1_BDTR && (value & MOE) != 0 && closed++ == 0) {
            run.device.tim1().comparator(0, true);
            run.device.tim1().comparator(0, false);
            run.machine.schedule(look, run.machine.now() + us);
        }
    };
    (void)run.start();
    const std::string text = run.type("enable\n", enable_time);
    expectations.expect(closed == 1 && open, "a trip while the bridge closes opens it within 1 us");
    expectations.expect(count(text, "fault: hardware-overcurrent") == 1, "and is reported");
    expectations.expect(count(run.type("disable\n", 20 * ms), "ok disable") == 1 && run.enable(),
                        "disable clears the fault");
}

void program_leaves_memory(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(run.enable(), "the drive holds the motor");
    const std::uint32_t vectors = *run.elf.symbol("vectors");
    const std::uint8_t nowhere[4] = {1, 0, 0, 0x30};
    std::copy(nowhere, nowhere + 4, run.machine.memory(vectors + 4 * line_interrupt, 4));
    bool opened = false;
    run.device.before_write = [&](std::uint32_t address, std::uint32_t value) {
        opened = opened || (address == TIM1_BDTR && (value & MOE) == 0);
    };
    run.run_behind_peak(60 * us); /* the control interrupt is over */
    run.device.serial_line().send(run.machine.now(), "\n");
    run.run_for(20 * us);
    expectations.expect(opened, "behind a jump to nowhere the program opens the bridge");
    const std::string text = run.start();
    expectations.expect(run.machine.resets().size() == 1 &&
                            count(text, "started by: crash: bus fault at 0x") == 1 &&
                            count(text, " in period ") == 1,
                        "and is reported at the next start");
    run.machine.reset("pin");
    expectations.expect(count(run.start(), "started by: reset pin") == 1,
                        "but not at the one behind");
}

/* With the bridge off. */
void bus_is_braked(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    const Gpio &port = run.device.pins().port('C');
    const auto on = [&](double bus_V, Ticks time) {
        run.device.power_stage().plant().set_bus(bus_V);
        run.run_for(time);
        return port.drives_high(6);
    };
    expectations.expect(!on(29.9, ms), "the brake is off below 1.25 of the supply");
    expectations.expect(on(30.1, 300 * us) && on(29.4, 300 * us), "on from there to 1.22 of it");
    expectations.expect(!on(29.2, 300 * us) && !on(29.9, 300 * us), "and then off");
    expectations.expect(on(30.1, 900 * ms), "it may be on for a second");
    expectations.expect(!on(30.1, 200 * ms) &&
                            count(run.output(), "warning: brake off: at its limit") == 1,
                        "and no longer, which the drive says");
}

/* Of the virtual board: code that is watched by the block writes registers at its instructions' own
   times all the same. */
void compares_are_written_in_turn(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(run.enable(), "the drive holds the motor");
    std::vector<Ticks> written;
    run.device.before_write = [&](std::uint32_t address, std::uint32_t) {
        if (address >= TIM1_CCR1 && address < TIM1_CCR1 + 4 * 4) {
            written.push_back(run.machine.now());
        }
    };
    run.run_behind_peak(50 * us);
    written.clear();
    run.run_for(ms);
    bool in_turn = written.size() == 4 * 10;
    for (std::size_t i = 1; i < written.size(); ++i) {
        in_turn = in_turn && written[i] >= written[i - 1] + run.machine.core_cycle();
    }
    expectations.expect(in_turn, "the four compares of each of ten periods are written in turn, by "
                                 "a cycle or more");
}

const Case cases[] = {
    {"compares-in-turn", compares_are_written_in_turn},
    {"halt", debugger_halts},
    {"conversions-lost", conversions_are_lost},
    {"break-while-closing", break_while_closing},
    {"bus-is-braked", bus_is_braked},
    {"program-leaves-memory", program_leaves_memory},
    {"starts-fail", starts_fail},
    {"starts-fail-for-ever", starts_fail_for_ever},
    {"no-crystal", starts_without_crystal},
    {"chip-supply-sags", chip_supply_sags},
    {"lines-overflow", lines_overflow},
    {"line-ends", line_ends},
    {"position-outlives-disable", position_outlives_disable},
    {"supply-fails-in-store", supply_fails_in_store},
    {"supply-fails-in-erase", supply_fails_in_erase},
    {"supply-fails-beside-weak-cell", supply_fails_beside_weak_cell},
    {"simulation-is-asked-for", simulation_is_asked_for},
    {"no-encoder", encoder_is_asked_for},
    {"homing-on-index", homing_on_index},
    {"settings-act", settings_act},
    {"can-registers", can_registers},
    {"can-flood", can_flood},
    {"can-flood-of-a-million", can_flood_of_a_million, true},
    {"line-flood", line_flood},
    {"line-flood-of-a-million", line_flood_of_a_million, true},
    {"can-bus-off", can_bus_off},
    {"can-without-another-node", can_without_another_node},
    {"can-overrun", can_overrun},
    {"encoder-of-4000-counts", encoder_counts, true},
};

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2 && argc != 3) {
        std::fprintf(stderr, "usage: stm32g474_disturbances IMAGE.elf [CASE]\n");
        return 2;
    }
    Expectations expectations;
    bool found = false;
    for (const Case &one : cases) {
        if (argc == 3 ? std::strcmp(argv[2], one.name) != 0 : one.only_if_asked) {
            continue;
        }
        found = true;
        std::printf("%s\n", one.name);
        try {
            one.run(expectations, argv[1]);
        } catch (const std::exception &error) {
            expectations.expect(false, error.what());
        }
    }
    if (!found) {
        std::fprintf(stderr, "stm32g474_disturbances: no case '%s'\n", argv[2]);
        return 2;
    }
    return expectations.failures() > 0 ? 1 : 0;
}
