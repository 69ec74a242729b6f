#include "sil/scenario/window_figures.h"

#include <algorithm>
#include <cmath>

#include "firmware/interface/drive_interface.h"

namespace scenario
{

namespace
{

constexpr double ripple_time_s = 0.002;             /* slower than this is no ripple */
constexpr double quarter_turn = 1.5707963267948966; /* a full step, electrical */
constexpr double cruising = 0.999;                  /* of the highest speed */
constexpr double estimated = 0.9;                   /* of a load step */

} // namespace

void Deviations::add(Pair value)
{
    block_[filled_++] = value;
    if (filled_ == block_rows) {
        sum_ = joined(sum_, block_.data(), filled_);
        filled_ = 0;
    }
}

Deviations::Sum Deviations::joined(const Sum &sum, const Pair *values, std::size_t count)
{
    if (count == 0) {
        return sum;
    }
    const double rows = static_cast<double>(count);
    Pair total = {0, 0}, squares = {0, 0};
    for (std::size_t i = 0; i < count; ++i) {
        total += values[i];
    }
    const Pair mean = total / rows;
    for (std::size_t i = 0; i < count; ++i) {
        squares += (values[i] - mean) * (values[i] - mean);
    }
    const double all = sum.count + rows;
    const Pair apart = mean - sum.mean;
    return {all, sum.mean + apart * (rows / all),
            sum.squares + squares + apart * apart * (sum.count * rows / all)};
}

Pair Deviations::rms() const
{
    const Sum sum = joined(sum_, block_.data(), filled_);
    const Pair variance = sum.squares / sum.count;
    return Pair{std::sqrt(variance[0]), std::sqrt(variance[1])};
}

void Cruise::add(double speed_ref, bool in_profile, double position_error)
{
    const double speed = std::fabs(speed_ref);
    fastest_ = std::max(fastest_, speed);
    if (!in_profile || !(speed >= cruising * fastest_)) {
        return;
    }
    while (first_ < parts_.size() && !(parts_[first_].slowest >= cruising * fastest_)) {
        ++first_;
    }
    if (first_ > parts_.size() / 2) {
        parts_.erase(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(first_));
        first_ = 0;
    }
    if (parts_.size() == most_parts) {
        merge_neighbours();
    }
    parts_.push_back({speed, position_error, speed_ref, 1});
}

void Cruise::merge_neighbours()
{
    std::vector<Part> merged;
    merged.reserve(most_parts);
    for (std::size_t i = first_; i < parts_.size(); i += 2) {
        Part part = parts_[i];
        if (i + 1 < parts_.size()) {
            const Part &next = parts_[i + 1];
            part = {std::min(part.slowest, next.slowest), part.position_error + next.position_error,
                    part.speed + next.speed, part.count + next.count};
        }
        merged.push_back(part);
    }
    parts_ = std::move(merged);
    first_ = 0;
}

bool Cruise::mean(double &position_error, double &lag_s) const
{
    const auto counts = [&](const Part &part) { return part.slowest >= cruising * fastest_; };
    double all = 0;
    for (const Part &part : parts_) {
        all += counts(part) ? part.count : 0;
    }
    if (all == 0 || fastest_ == 0) {
        return false;
    }
    const double earlier = std::floor(all / 2);
    double passed = 0, rows = 0, error = 0, speed = 0;
    for (const Part &part : parts_) {
        if (!counts(part)) {
            continue;
        }
        if (passed >= earlier) {
            error += part.position_error;
            speed += part.speed;
            rows += part.count;
        }
        passed += part.count;
    }
    position_error = error / rows;
    lag_s = error / speed;
    return true;
}

Ripple::Ripple(double period_s)
    : half_(static_cast<std::size_t>(std::floor(ripple_time_s / 2 / period_s + 0.5))),
      sums_(2 * half_ + 2, 0.0), middle_(half_ + 2)
{
}

void Ripple::add(double value)
{
    const std::size_t around = 2 * half_ + 1;
    const double sum = sums_[latest_] + value;
    const std::size_t before_middle = middle_;
    latest_ = next(latest_);
    middle_ = next(middle_);
    sums_[latest_] = sum;
    ++rows_;
    if (rows_ < around || half_ == 0) {
        return;
    }
    const double before_all = sums_[next(latest_)];
    const double mean = (sum - before_all) / static_cast<double>(around);
    const double ripple = sums_[middle_] - sums_[before_middle] - mean;
    squares_ += ripple * ripple;
    ++count_;
}

double Ripple::rms() const
{
    return count_ > 0 ? std::sqrt(squares_ / static_cast<double>(count_)) : Metrics::none;
}

void LoadSteps::add(std::size_t place, const Moment &moment)
{
    const double step = moment.row[LOAD_TORQUE] - moment.load_before;
    if (step != 0) {
        recent_ = ramps_ ? std::nullopt : std::optional<Step>({place, moment.load_before, step});
    } else if (recent_) {
        open_.push_back(*recent_);
        recent_.reset();
    }
    ramps_ = step != 0;
    for (std::size_t i = 0; i < open_.size();) {
        const Step &one = open_[i];
        if (!((moment.row[LOAD_TORQUE_EST] - one.before) / one.step >= estimated)) {
            ++i;
            continue;
        }
        const double taken = static_cast<double>(place - one.place);
        longest_ = taken <= longest_ ? longest_ : taken;
        open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

double LoadSteps::longest() const
{
    return open_.empty() && !recent_ ? longest_ : Metrics::none;
}

WindowFigures::WindowFigures(const MetricSettings &settings, double period_s)
    : settings_(settings), period_s_(period_s), ripple_(period_s)
{
}

void WindowFigures::add(const Moment &moment)
{
    const Row &row = moment.row;
    const double position_error = row[THETA_REF] - row[THETA];
    const double estimate_error = row[THETA] - row[THETA_EST];
    const double load_error_Nm = row[LOAD_TORQUE] - row[LOAD_TORQUE_EST];
    if (rows_ == 0) {
        first_estimate_error_ = estimate_error;
        voltage_q_least_ = voltage_q_most_ = row[U_Q];
    }
    const double full_steps_per_rad = settings_.rotor_teeth / quarter_turn;
    errors_.add(Pair{position_error, estimate_error});
    rates_.add(Pair{row[OMEGA] - row[OMEGA_EST], load_error_Nm});
    currents_.add(Pair{row[I_A], row[I_B]});
    voltages_.add(Pair{row[U_A], row[U_B]});
    slip_.add(
        Pair{(estimate_error - first_estimate_error_) * full_steps_per_rad, row[SYNCHRONISM]});
    voltage_q_least_ = std::min(voltage_q_least_, row[U_Q]);
    voltage_q_most_ = std::max(voltage_q_most_, row[U_Q]);
    deviations_.add(Pair{row[U_Q], position_error});
    cruise_.add(row[OMEGA_REF], moment.in_profile, position_error);
    ripple_.add(row[I_Q]);
    load_steps_.add(rows_, moment);
    settle(moment, position_error);
    pass_target(moment);
    if (fault_ == 0) {
        fault_ = row[DRIVE_FAULT_CODE];
    }
    last_position_error_ = position_error;
    last_estimate_error_ = estimate_error;
    last_load_error_Nm_ = load_error_Nm;
    last_resistance_ohm_ = row[RESISTANCE];
    last_resistance_est_ohm_ = row[RESISTANCE_EST];
    ++rows_;
}

/* Since the reference has been on its way for the last time in this window. */
void WindowFigures::settle(const Moment &moment, double position_error)
{
    if (moment.in_motion) {
        reference_arrived_ = rows_;
        outside_ = 0;
    }
    if (!(std::fabs(position_error) <= settings_.settling_band_rad)) {
        outside_ = rows_ + 1;
    }
}

void WindowFigures::pass_target(const Moment &moment)
{
    if (moment.new_target) {
        overshoot_ = 0;
    }
    if (moment.approach != 0) {
        const double beyond = moment.approach * (moment.row[THETA] - moment.row[THETA_REF]);
        overshoot_ = beyond > overshoot_ || beyond != beyond ? beyond : overshoot_;
    }
}

Metrics WindowFigures::metrics() const
{
    Metrics metrics;
    if (rows_ == 0) {
        return metrics;
    }
    const double count = static_cast<double>(rows_);
    const auto rms = [&](double squares) { return std::sqrt(squares / count); };
    const auto of_phases = [&](Pair squares) {
        return std::sqrt((squares[0] + squares[1]) / (2 * count));
    };
    metrics.position_error_max_rad = errors_.max[0];
    metrics.position_error_rms_rad = rms(errors_.squares[0]);
    metrics.position_error_final_rad = std::fabs(last_position_error_);
    cruise_.mean(metrics.position_error_steady_rad, metrics.lag_s);
    metrics.estimate_error_max_rad = errors_.max[1];
    metrics.estimate_error_rms_rad = rms(errors_.squares[1]);
    metrics.estimate_error_final_rad = std::fabs(last_estimate_error_);
    metrics.speed_error_max_rad_s = rates_.max[0];
    metrics.speed_error_rms_rad_s = rms(rates_.squares[0]);
    metrics.load_torque_error_max_Nm = rates_.max[1];
    metrics.load_torque_error_rms_Nm = rms(rates_.squares[1]);
    metrics.load_torque_error_final_Nm = std::fabs(last_load_error_Nm_);
    metrics.load_torque_t90_s = load_steps_.longest() * period_s_;
    metrics.overshoot_rad = overshoot_;
    metrics.settling_time_s = outside_ == 0 ? 0
                              : outside_ == rows_
                                  ? Metrics::none
                                  : static_cast<double>(outside_ - reference_arrived_) * period_s_;
    metrics.current_peak_A = std::max(currents_.max[0], currents_.max[1]);
    metrics.current_rms_A = of_phases(currents_.squares);
    metrics.current_ripple_rms_A = ripple_.rms();
    metrics.voltage_peak_V = std::max(voltages_.max[0], voltages_.max[1]);
    metrics.voltage_rms_V = of_phases(voltages_.squares);
    metrics.voltage_q_peak_to_peak_V = voltage_q_most_ - voltage_q_least_;
    const Pair ripples = deviations_.rms();
    metrics.voltage_q_ripple_V = ripples[0];
    metrics.position_ripple_rms_rad = ripples[1];
    metrics.slip_full_steps = std::floor(slip_.max[0] + 0.5);
    metrics.resistance_estimate_error_ratio =
        std::fabs(last_resistance_est_ohm_ - last_resistance_ohm_) / last_resistance_ohm_;
    metrics.synchronism_worst = slip_.max[1];
    if (fault_ != 0) {
        metrics.fault = drive_fault_name(static_cast<drive_fault>(static_cast<int>(fault_)));
    }
    return metrics;
}

} // namespace scenario
