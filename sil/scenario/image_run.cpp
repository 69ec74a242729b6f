#include "sil/scenario/image_run.h"

#include <algorithm>
#include <stdexcept>

#include "sil/scenario/text.h"
#include "sil/virtual_board/board_facts.h"

namespace scenario
{

namespace
{

std::string figures_line(const std::string &name, const virtual_board::CycleFigures &figures)
{
    std::string text = format("  %-20s", name.c_str());
    for (const virtual_board::Figures &column : {figures.nominal, figures.worst, figures.flash}) {
        text +=
            format("  %7.0f %6llu %6llu", column.mean, static_cast<unsigned long long>(column.p999),
                   static_cast<unsigned long long>(column.worst));
    }
    return text + "\n";
}

double us(double cycles)
{
    return cycles * 1e6 / virtual_board::core_Hz;
}

} // namespace

void check_image(const Scenario &scenario, const std::string &numeric)
{
    try {
        virtual_board::VirtualBoard::require(scenario.given.image, scenario.plant, numeric);
        const double fitted_A = sil::comparator_trip_A(scenario.plant.sensors.current_range_A);
        if (scenario.comparator_trip_A != fitted_A) {
            throw std::invalid_argument(format("plant.comparator_trip_A: %g; the image has %g",
                                               scenario.comparator_trip_A, fitted_A));
        }
    } catch (const std::invalid_argument &refusal) {
        throw InputError(scenario.locate(refusal.what()) + refusal.what());
    }
}

ImageRun run_image(const Scenario &scenario, const std::string &numeric, std::uint64_t seed,
                   Record &record)
{
    virtual_board::VirtualBoard board(plant_of(scenario, seed), scenario.given.image, numeric,
                                      scenario.drive);
    ImageRun result{run_typed(scenario, board, record), board.report()};
    /* From S(k), as hal.h counts the deadline. */
    const virtual_board::InterruptAccount::Summary &interrupt = result.board.interrupt;
    const std::uint64_t worst = interrupt.latency.worst + interrupt.total.worst.worst;
    const bool stalled = std::any_of(scenario.events.begin(), scenario.events.end(),
                                     [](const Event &event) { return event.stall_us.has_value(); });
    if (result.run.failure.empty() && !stalled && worst > result.board.budget_cycles) {
        result.run.failure =
            format("the control interrupt ends %llu cycles behind S(k) in the worst column; "
                   "%llu are 90 %% of the period",
                   static_cast<unsigned long long>(worst),
                   static_cast<unsigned long long>(result.board.budget_cycles));
    }
    return result;
}

std::string interrupt_table(const virtual_board::BoardReport &board, double cpu_s)
{
    const virtual_board::InterruptAccount::Summary &interrupt = board.interrupt;
    std::string text =
        format("  control interrupt, cycles%s\n  %-20s  %-22s  %-22s  %s\n", "", "",
               "nominal: mean p99.9 max", "worst, from CCM", "worst, from flash, uncached");
    for (std::size_t i = 0; i < interrupt.stages.size(); ++i) {
        text += figures_line(interrupt.stage_names[i], interrupt.stages[i]);
    }
    text += figures_line("total", interrupt.total);
    const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    const virtual_board::Figures &latency = interrupt.latency;
    const double worst_us = us(static_cast<double>(latency.worst));
    const double least_us = us(static_cast<double>(latency.least));
    text +=
        format("  of %llu interrupts, means of the %llu in which the drive controls; budget %llu "
               "from S(k); %llu instructions outside CCM\n",
               count(interrupt.interrupts), count(interrupt.in_control), count(board.budget_cycles),
               count(interrupt.outside_fast_code));
    text += format("  start after S(k): least %llu, mean %.1f, worst %llu cycles (%.3f, %.3f, %.3f "
                   "us); jitter %.3f us\n",
                   count(latency.least), latency.mean, count(latency.worst), least_us,
                   us(latency.mean), worst_us, worst_us - least_us);
    text += format("  beside it: %llu preemptions, %llu cycles; serial line %llu bytes in, %llu "
                   "out; flash %llu pages erased, %llu double words programmed\n",
                   count(interrupt.preemptions), count(interrupt.preempting_cycles),
                   count(board.bytes_received), count(board.bytes_sent), count(board.flash_erases),
                   count(board.flash_programs));
    if (board.stack_used_bytes) {
        text += format("  stack %u bytes", static_cast<unsigned>(*board.stack_used_bytes));
    }
    if (cpu_s > 0) {
        text += format("; %.1f x real time", board.simulated_s / cpu_s);
    }
    return text + "\n";
}

} // namespace scenario
