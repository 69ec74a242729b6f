#include "sil/scenario/image_run.h"

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

} // namespace

void check_image(const Scenario &scenario, const std::string &numeric)
{
    try {
        virtual_board::require_image_facts(
            scenario.plant, virtual_board::VirtualBoard::numeric_of(scenario.given.image), numeric);
    } catch (const std::invalid_argument &refusal) {
        throw InputError(scenario.locate(refusal.what()) + refusal.what());
    }
}

ImageRun run_image(const Scenario &scenario, const std::string &numeric, std::uint64_t seed)
{
    virtual_board::VirtualBoard board(plant_of(scenario, seed), scenario.given.image, numeric,
                                      scenario.drive);
    ImageRun result{run_typed(scenario, board), board.report()};
    const std::uint64_t worst = result.board.interrupt.total.worst.worst;
    if (result.run.failure.empty() && worst > virtual_board::control_interrupt_budget) {
        result.run.failure =
            format("the control interrupt takes %llu cycles in the worst column; "
                   "%llu are 90 us",
                   static_cast<unsigned long long>(worst),
                   static_cast<unsigned long long>(virtual_board::control_interrupt_budget));
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
    text += format("  of %llu interrupts; budget 15300; start latency %llu...%llu cycles after "
                   "S(k); %llu preemptions, %llu cycles; %llu instructions outside CCM\n",
                   static_cast<unsigned long long>(interrupt.interrupts),
                   static_cast<unsigned long long>(interrupt.latency.least),
                   static_cast<unsigned long long>(interrupt.latency.worst),
                   static_cast<unsigned long long>(interrupt.preemptions),
                   static_cast<unsigned long long>(interrupt.preempting_cycles),
                   static_cast<unsigned long long>(interrupt.outside_fast_code));
    if (board.stack_used_bytes) {
        text += format("  stack %u bytes", static_cast<unsigned>(*board.stack_used_bytes));
    }
    if (cpu_s > 0) {
        text += format("; %.1f x real time", board.simulated_s / cpu_s);
    }
    return text + "\n";
}

} // namespace scenario
