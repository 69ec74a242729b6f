/* Settings on the console of the STM32G474 image, and what the drive makes of them. */
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

constexpr Ticks answer_time = 20 * ms;
constexpr Ticks design_time = 150 * ms; /* twice, if the first is refused */

/* The largest phase current over a time. */
double peak_A(Powered &run, Ticks time)
{
    double peak = 0;
    for (Ticks t = 0; t < time; t += 100 * us) {
        run.run_for(100 * us);
        const auto &state = run.device.power_stage().plant().state();
        peak = std::max({peak, std::fabs(state.i_a_A), std::fabs(state.i_b_A)});
    }
    return peak;
}

bool answers(Powered &run, const std::string &line, const std::string &answer,
             Ticks time = answer_time)
{
    const std::string text = run.type(line + "\n", time);
    std::printf("  %s", text.c_str());
    return count(text, answer) == 1;
}

} // namespace

void settings_act(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    expectations.expect(answers(run, "set hold_current_A 0.8", "acts at the next enable"),
                        "a setting waits for the enable");
    expectations.expect(run.enable(enable_time + design_time),
                        "the drive is designed, and enabled");
    const double held_A = peak_A(run, 10 * ms);
    std::printf("  held with %.2f A\n", held_A);
    expectations.expect(held_A > 0.7 && held_A < 0.9, "and holds with the current that was set");
    expectations.expect(answers(run, "set hold_current_A 1", "error: this is set while"),
                        "no other is taken meanwhile");
    expectations.expect(
        answers(run, "set current_limit_A 1", "ok set current_limit_A=1; acts at once"),
        "a current limit is");
    /* 80 electrical turns: the next enable finds the rotor where its hold draws it. */
    run.device.serial_line().send(run.machine.now(), "move 10.0531 duration_s=0.3\n");
    const double moved_A = peak_A(run, 500 * ms);
    std::printf("  moved with %.2f A at most, 10 rad in 0.3 s would take more\n", moved_A);
    expectations.expect(moved_A < 1.2, "and limits the current");
    (void)run.type("disable\n", answer_time);
    expectations.expect(answers(run, "set law_bandwidth_rad_s 5000", "ok set "),
                        "a bandwidth that no drive bears waits for the enable");
    const bool refused = answers(run, "enable", "what was set is not in force", design_time);
    expectations.expect(refused && !run.bridge_on(), "which is refused");
    expectations.expect(answers(run, "set law_bandwidth_rad_s default", "ok set ") &&
                            run.enable(enable_time + design_time),
                        "and is not without it");
    const Watchdog &watchdog = run.device.watchdog();
    std::printf("  watchdog fed after %.1f ms at the latest, of %.1f\n",
                double(watchdog.counters.longest) / double(ms),
                double(watchdog.timeout()) / double(ms));
    expectations.expect(run.machine.resets().empty() &&
                            watchdog.counters.longest < watchdog.timeout() * 4 / 5,
                        "the watchdog has been fed all the time, with a fifth to spare");
}

} // namespace stm32g474_bench
