/* The serial line of the STM32G474 image: too much of it, and its ends. */
#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

constexpr char backspace = '\b'; /* fills a line without making it longer */

} // namespace

void lines_overflow(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    run.run_for(8 * ms); /* the line is open, start-up designs the gains */
    std::string lines;
    for (int i = 0; i < 100; i++) {
        lines += "cycles\n";
    }
    run.device.serial_line().send(run.machine.now(), lines);
    run.run_for(250 * ms);
    const std::string text = run.output();
    const std::size_t kept = count(text, "ok cycles");
    std::printf("  %zu lines of 100 are answered\n", kept);
    expectations.expect(count(text, "error: bytes of the line were lost") == 1 &&
                            count(text, "error") == 1 && kept < 100,
                        "more lines than there is room for: the loss is reported once");
    expectations.expect(count(run.type("cycles\n", 30 * ms), "ok cycles") == 1,
                        "the next line is obeyed");

    /* Most of a long line has come, and more than the buffer may hold, when it is first read. */
    run.machine.power_on();
    run.machine.stops_behind_control_interrupt = true;
    const Ticks on = run.machine.now();
    run.machine.run();
    const Ticks first_read = run.machine.now() - on;
    run.machine.stops_behind_control_interrupt = false;
    run.machine.power_on();
    run.run_for(first_read - 35 * ms);
    run.device.serial_line().send(run.machine.now(),
                                  std::string(3600, backspace) + "disable\ncycles\n");
    run.run_for(150 * ms);
    const std::string behind = run.output();
    expectations.expect(count(behind, "ok disable") == 0 &&
                            count(behind, "error: bytes of the line were lost") >= 1,
                        "a line that has lost its beginning is not obeyed");
    expectations.expect(count(behind, "ok cycles") == 1, "but the one behind it is");
    expectations.expect(run.machine.resets().empty(), "no reset");
}

void line_ends(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(run.type("disable", 20 * ms).find("ok disable") == std::string::npos,
                        "a line without an end waits");
    expectations.expect(count(run.type("\n", 20 * ms), "ok disable") == 1, "until its end comes");
    expectations.expect(count(run.type("cycles\r", 30 * ms), "ok cycles") == 1,
                        "a line ended by CR is obeyed");
    expectations.expect(count(run.type("cycles\r\ncycles\n", 40 * ms), "ok cycles") == 2,
                        "and by CR and LF");
    expectations.expect(count(run.type("cycles\r\r\ncycles\r", 40 * ms), "ok cycles") == 2,
                        "empty lines have no answer");
    const std::string longer = run.type(std::string(5000, 'x') + "\ncycles\n", 80 * ms);
    expectations.expect(count(longer, "ok cycles") == 1 && count(longer, "error") == 1,
                        "a line behind one that is longer than the buffer is obeyed");
    const std::string empty = run.type(std::string(5000, '\r') + "cycles\r", 80 * ms);
    expectations.expect(count(empty, "ok cycles") == 1 && count(empty, "error") == 0,
                        "nothing is lost of lines that CR alone ends");
}

void position_outlives_disable(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(count(run.type("set-position 3\n", 20 * ms), "ok set-position") == 1,
                        "the zero is set while disabled");
    const std::string ready = run.type("enable\n", enable_time);
    expectations.expect(count(ready, "reference_rad=3 ") == 1 && count(ready, "position=kept") == 1,
                        "and the drive begins there");
    expectations.expect(count(run.type("set-position 12.5\n", 20 * ms), "ok set-position") == 1 &&
                            count(run.type("move 13\n", 400 * ms), "ok move") == 1,
                        "a move from another zero");
    expectations.expect(count(run.type("state\n", 30 * ms), "position=referenced") == 1,
                        "the axis is referenced then");
    (void)run.type("disable\n", 20 * ms);
    const std::string again = run.type("enable\n", enable_time);
    expectations.expect(count(again, "reference_rad=13 ") == 1 &&
                            count(again, "position=kept") == 1,
                        "disabled and enabled, it is where it was");
    (void)run.type("velocity 5 acceleration_rad_s2=500 jerk_rad_s3=1e5\n", 100 * ms);
    expectations.expect(
        count(run.type("set-position 0\n", 20 * ms), "error: set-position refused: ") == 1,
        "in motion its zero stays");
    (void)run.type("disable\n", 600 * ms); /* until the rotor has come to rest */
    expectations.expect(count(run.type("state\n", 30 * ms), "position=uncertain") == 1,
                        "a rotor that was left in motion is not where it was");
}

} // namespace stm32g474_bench
