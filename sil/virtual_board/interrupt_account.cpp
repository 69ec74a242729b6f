#include "sil/virtual_board/interrupt_account.h"

#include <algorithm>

namespace virtual_board
{

namespace
{

/* Of tools/arm_image/stages.py: it runs with the bridge on, and not in its calibration. */
const char *const control_stage = "position law";

} // namespace

void Distribution::add(std::uint64_t value)
{
    constexpr std::uint64_t most = 1u << 20; /* a hundred times what fits a period */
    const std::uint64_t kept = value < most ? value : most;
    if (kept >= counts_.size()) {
        counts_.resize(kept + 1);
    }
    ++counts_[kept];
    ++values_;
}

Figures Distribution::figures() const
{
    Figures figures;
    if (values_ == 0) {
        return figures;
    }
    const std::uint64_t quantile = values_ - values_ / 1000;
    std::uint64_t seen = 0;
    double sum = 0;
    for (std::uint64_t value = 0; value < counts_.size(); ++value) {
        if (counts_[value] == 0) {
            continue;
        }
        figures.least = seen == 0 ? value : figures.least;
        figures.p999 = seen < quantile ? value : figures.p999;
        figures.worst = value;
        seen += counts_[value];
        sum += static_cast<double>(value) * counts_[value];
    }
    figures.mean = sum / static_cast<double>(values_);
    return figures;
}

void DistributionInControl::add(std::uint64_t value, bool controls)
{
    all_.add(value);
    if (controls) {
        sum_ += value;
        ++values_;
    }
}

Figures DistributionInControl::figures() const
{
    Figures figures = all_.figures();
    figures.mean = values_ == 0 ? 0.0 : static_cast<double>(sum_) / static_cast<double>(values_);
    return figures;
}

void InterruptAccount::Column::add(const Cycles &cycles, bool controls)
{
    nominal.add(cycles.nominal, controls);
    worst.add(cycles.worst, controls);
    flash.add(cycles.flash, controls);
}

CycleFigures InterruptAccount::Column::figures() const
{
    return {nominal.figures(), worst.figures(), flash.figures()};
}

void InterruptAccount::set_stages(const std::vector<std::string> &names)
{
    names_ = names;
    control_ = static_cast<std::size_t>(std::find(names.begin(), names.end(), control_stage) -
                                        names.begin());
    present_.assign(names.size(), Cycles());
    stages_.assign(names.size(), Column());
}

void InterruptAccount::begin()
{
    present_.assign(present_.size(), Cycles());
    outside_now_ = 0;
    excused_ = false;
}

bool InterruptAccount::controls() const
{
    return control_ == present_.size() || present_[control_].nominal > 0;
}

void InterruptAccount::end()
{
    const bool in_control = controls();
    Cycles total;
    for (std::size_t i = 0; i < present_.size(); ++i) {
        stages_[i].add(present_[i], in_control);
        total += present_[i];
    }
    total_.add(total, in_control);
    outside_fast_code_ += excused_ ? 0 : outside_now_;
    ++interrupts_;
    in_control_ += in_control ? 1 : 0;
}

InterruptAccount::Summary InterruptAccount::summary() const
{
    Summary summary;
    summary.interrupts = interrupts_;
    summary.in_control = in_control_;
    summary.total = total_.figures();
    summary.stage_names = names_;
    for (const Column &stage : stages_) {
        summary.stages.push_back(stage.figures());
    }
    summary.latency = latency_.figures();
    summary.preemptions = preemptions_;
    summary.preempting_cycles = preempting_cycles_;
    summary.outside_fast_code = outside_fast_code_;
    return summary;
}

} // namespace virtual_board
