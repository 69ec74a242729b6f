#include "sil/scenario/evaluation.h"

#include <algorithm>
#include <cmath>

#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double rest_speed_rad_s = 0.1;
constexpr double rest_time_s = 0.010;

std::size_t periods(const Record &record, double time_s)
{
    return static_cast<std::size_t>(std::floor(time_s / record.period_s() + 0.5));
}

bool same(const Window &a, const Window &b)
{
    return a.kind == b.kind && a.begin_s == b.begin_s && a.end_s == b.end_s;
}

} // namespace

std::string Window::name() const
{
    switch (kind) {
    case Kind::move:
        return "move";
    case Kind::rest:
        return "rest";
    case Kind::all:
        return "all";
    case Kind::times:
        break;
    }
    return readable(begin_s) + "..." + readable(end_s);
}

Evaluation::Evaluation(Record &record, const MetricSettings &settings,
                       const std::vector<Window> &windows)
    : record_(record), empty_(settings, record.period_s()), all_(empty_), move_(empty_),
      rest_(empty_), rows_at_rest_needed_(periods(record, rest_time_s))
{
    for (const Window &window : windows) {
        if (window.kind == Window::Kind::times && find(window) == nullptr) {
            const RowRange rows = {periods(record, window.begin_s),
                                   periods(record, window.end_s) + 1};
            times_.push_back({window, rows, empty_});
        }
    }
    record.add_reader(*this);
}

const Evaluation::TimesFigures *Evaluation::find(const Window &window) const
{
    const auto found = std::find_if(times_.begin(), times_.end(), [&](const TimesFigures &one) {
        return same(one.window, window);
    });
    return found == times_.end() ? nullptr : &*found;
}

/* Before time zero there is no load: one that acts from the first row on is a step, too. */
Moment Evaluation::moment_of(std::size_t row, const Row &values)
{
    const bool first = row == 0;
    const bool in_profile = values[REFERENCE_MOVING] != 0;
    const bool new_target = !first && values[THETA_REF] != target_;
    const bool steps = new_target && !in_profile && !was_in_profile_;
    if (new_target) {
        approach_ = values[THETA_REF] > target_ ? 1 : -1;
    }
    const Moment moment = {values,     in_profile, in_profile || steps,
                           new_target, approach_,  first ? 0 : load_};
    was_in_profile_ = in_profile;
    target_ = values[THETA_REF];
    load_ = values[LOAD_TORQUE];
    return moment;
}

void Evaluation::end_move_here()
{
    move_ = all_;
    rest_ = empty_;
}

/* A profile ends with its last row, a step when the rotor has begun to rest for long enough; until
   it starts it does not count as resting. */
void Evaluation::follow_motion(const Moment &moment)
{
    if (moment.in_profile) {
        motion_ = Motion::profile;
        return;
    }
    if (moment.in_motion) {
        motion_ = Motion::step_awaits_rotor;
        rows_at_rest_ = 0;
    } else if (motion_ == Motion::profile) {
        motion_ = Motion::over;
        end_move_here();
        return;
    }
    const bool slow = std::fabs(moment.row[OMEGA]) < rest_speed_rad_s;
    if (motion_ == Motion::step_awaits_rotor && !slow) {
        motion_ = rows_at_rest_needed_ > 0 ? Motion::rotor_turns : Motion::profile;
    }
    if (motion_ != Motion::rotor_turns) {
        return;
    }
    rows_at_rest_ = slow ? rows_at_rest_ + 1 : 0;
    if (rows_at_rest_ == 1) {
        end_move_here();
    }
    if (rows_at_rest_ == rows_at_rest_needed_) {
        motion_ = Motion::over;
    }
}

void Evaluation::read(const Record &record, const Row &values)
{
    if (record.rows() < record.time_zero_row()) {
        return;
    }
    const std::size_t row = record.rows() - record.time_zero_row();
    const Moment moment = moment_of(row, values);
    follow_motion(moment);
    all_.add(moment);
    if (motion_ == Motion::over || (motion_ == Motion::rotor_turns && rows_at_rest_ > 0)) {
        rest_.add(moment);
    }
    for (TimesFigures &one : times_) {
        if (row >= one.rows.first && row < one.rows.last) {
            one.figures.add(moment);
        }
    }
}

RowRange Evaluation::rows_of(const Window &window) const
{
    const std::size_t zero = record_.time_zero_row(), end = zero + all_.rows();
    const std::size_t moved = motion_ == Motion::none ? 0
                              : move_has_ended()      ? move_.rows()
                                                      : all_.rows();
    switch (window.kind) {
    case Window::Kind::move:
        return {zero, zero + moved};
    case Window::Kind::rest:
        return {zero + moved, end};
    case Window::Kind::all:
        return {zero, end};
    case Window::Kind::times:
        break;
    }
    return {zero + periods(record_, window.begin_s),
            std::min(end, zero + periods(record_, window.end_s) + 1)};
}

Metrics Evaluation::metrics_of(const Window &window) const
{
    switch (window.kind) {
    case Window::Kind::move:
        return (motion_ == Motion::none ? empty_ : move_has_ended() ? move_ : all_).metrics();
    case Window::Kind::rest:
        return (motion_ == Motion::none ? all_ : move_has_ended() ? rest_ : empty_).metrics();
    case Window::Kind::all:
        return all_.metrics();
    case Window::Kind::times:
        break;
    }
    const TimesFigures *const found = find(window);
    return found != nullptr ? found->figures.metrics() : Metrics();
}

bool Evaluation::contains(const Window &window, double time_s) const
{
    const double half_period_s = record_.period_s() / 2;
    if (window.kind == Window::Kind::all) {
        return true;
    }
    if (window.kind == Window::Kind::times) {
        return time_s >= window.begin_s - half_period_s && time_s <= window.end_s + half_period_s;
    }
    const RowRange move = rows_of({Window::Kind::move});
    const bool in_move = !move.empty() && time_s <= record_.time_s(move.last - 1) + half_period_s;
    return in_move == (window.kind == Window::Kind::move);
}

} // namespace scenario
