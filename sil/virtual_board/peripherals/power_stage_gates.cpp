/* The power stage: which gates follow TIM1, and what would burn the bridge. */
#include "sil/virtual_board/peripherals/power_stage.h"

#include <cmath>

namespace virtual_board
{

namespace
{

struct Output {
    Pin pin;
    unsigned alternate;
};
constexpr Output high_side[PowerStage::legs] = {
    {{'C', 0}, 2}, {{'C', 1}, 2}, {{'C', 2}, 2}, {{'C', 3}, 2}};
constexpr Output low_side[PowerStage::legs] = {
    {{'A', 11}, 6}, {{'A', 12}, 6}, {{'B', 15}, 4}, {{'C', 5}, 6}};

} // namespace

/* One bit per gate whose output is enabled and reaches its pin. */
unsigned PowerStage::connected_outputs() const
{
    unsigned gates = 0;
    for (int leg = 0; leg < legs; leg++) {
        const unsigned control = timer_.output_control(leg);
        const Output &high = high_side[leg], &low = low_side[leg];
        gates |= (control & 1u) != 0 && pins_.routed(high.pin, high.alternate) ? 1u << leg : 0u;
        gates |= (control & 4u) != 0 && pins_.routed(low.pin, low.alternate) ? 16u << leg : 0u;
    }
    return gates;
}

bool PowerStage::bridge_on() const
{
    return timer_.outputs_enabled() && !timer_.held() && connected_outputs() == 0xff;
}

/* With MOE set the bridge switches: what then would burn it or is not wired is refused. */
void PowerStage::outputs_enabled() const
{
    const unsigned gates = connected_outputs();
    if (gates == 0) {
        return;
    }
    if (gates != 0xff) {
        chip_.fail("power stage: MOE set while only some gates are connected (mask " +
                   hexadecimal(gates) + ": high sides A+ A- B+ B-, then low sides)");
    }
    for (int leg = 0; leg < legs; leg++) {
        if ((timer_.output_control(leg) & 0xau) != 0) {
            chip_.fail("power stage: TIM1.CCER inverts an output: high and low side conduct at "
                       "once (shoot-through)");
        }
        if (timer_.output_mode(leg) != 6 || !timer_.preloaded(leg)) {
            chip_.fail("power stage: TIM1 channel " + std::to_string(leg + 1) +
                       ": expected PWM mode 1 with preload while MOE is set");
        }
    }
    if (!timer_.idle_outputs_off()) {
        chip_.fail("power stage: TIM1.CR2 OISx: the idle state must leave all gates off");
    }
    const double second = static_cast<double>(ticks_per_s);
    const double dead_s = static_cast<double>(timer_.dead_time()) / second;
    const double expected_s = config_.plant.bridge.dead_time_s;
    if (std::fabs(dead_s - expected_s) > config_.dead_time_tolerance * expected_s) {
        chip_.fail("power stage: TIM1.BDTR DTG gives a dead time of " +
                   std::to_string(dead_s * 1e9) + " ns; expected " +
                   std::to_string(expected_s * 1e9) + " ns" +
                   (dead_s < expected_s ? " (shoot-through)" : ""));
    }
    const unsigned counts = static_cast<unsigned>(config_.plant.bridge.half_period_counts);
    const double period_s = 2.0 * counts * static_cast<double>(timer_.count_ticks()) / second;
    if (timer_.half_period() != counts ||
        std::fabs(period_s - config_.plant.bridge.period_s) > 1e-9) {
        chip_.fail("power stage: TIM1 has a half period of " +
                   std::to_string(timer_.half_period()) + " counts; the plant has " +
                   std::to_string(counts) + " and " +
                   std::to_string(config_.plant.bridge.period_s * 1e6) + " us");
    }
}

} // namespace virtual_board
