#include "sil/scenario/metrics.h"

#include <algorithm>
#include <cmath>

#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double rest_speed_rad_s = 0.1;
constexpr double rest_time_s = 0.010;
constexpr double ripple_time_s = 0.002;             /* slower than this is no ripple */
constexpr double quarter_turn = 1.5707963267948966; /* a full step, electrical */

/* Magnitudes: a NaN, once in, stays. */
struct Magnitude {
    double max = 0, sum_of_squares = 0, final = 0;
    std::size_t count = 0;

    void add(double value)
    {
        final = std::fabs(value);
        max = final > max || final != final ? final : max;
        sum_of_squares += value * value;
        ++count;
    }
    double rms() const
    {
        return std::sqrt(sum_of_squares / static_cast<double>(count));
    }
};

std::size_t periods(const Record &record, double time_s)
{
    return static_cast<std::size_t>(std::floor(time_s / record.period_s() + 0.5));
}

bool reference_moves(const Record &record, std::size_t row)
{
    return record.at(row, REFERENCE_MOVING) != 0;
}

/* A jump of the reference into `row`, outside any profile. */
bool reference_steps(const Record &record, std::size_t row)
{
    return row > record.time_zero_row() && !reference_moves(record, row) &&
           !reference_moves(record, row - 1) &&
           record.at(row, THETA_REF) != record.at(row - 1, THETA_REF);
}

/* First row from `row` on from which the rotor rests; record.rows() if it never does. */
std::size_t first_row_at_rest(const Record &record, std::size_t row)
{
    const std::size_t needed = periods(record, rest_time_s);
    /* From the step itself until the rotor starts, it does not count as resting. */
    while (row < record.rows() && std::fabs(record.at(row, OMEGA)) < rest_speed_rad_s) {
        ++row;
    }
    std::size_t resting = 0;
    for (; row < record.rows(); ++row) {
        resting = std::fabs(record.at(row, OMEGA)) < rest_speed_rad_s ? resting + 1 : 0;
        if (resting == needed) {
            return row + 1 - needed;
        }
    }
    return record.rows();
}

/* The row after the last one that belongs to a motion of the reference. */
std::size_t end_of_motion(const Record &record)
{
    for (std::size_t row = record.rows(); row-- > record.time_zero_row();) {
        if (reference_moves(record, row)) {
            return row + 1;
        }
        if (reference_steps(record, row)) {
            return first_row_at_rest(record, row);
        }
    }
    return record.time_zero_row();
}

/* The last row of the window in which the reference is still on its way, or its first row. */
std::size_t last_reference_motion(const Record &record, RowRange rows)
{
    for (std::size_t row = rows.last; row-- > rows.first;) {
        if (reference_moves(record, row) || reference_steps(record, row)) {
            return row;
        }
    }
    return rows.first;
}

double settling_time(const Record &record, RowRange rows, double band_rad)
{
    const std::size_t start = last_reference_motion(record, rows);
    for (std::size_t row = rows.last; row-- > start;) {
        const double error = record.at(row, THETA_REF) - record.at(row, THETA);
        if (!(std::fabs(error) <= band_rad)) {
            return row + 1 == rows.last ? Metrics::none
                                        : static_cast<double>(row + 1 - start) * record.period_s();
        }
    }
    return 0;
}

double overshoot(const Record &record, RowRange rows)
{
    const double target = record.at(rows.last - 1, THETA_REF);
    std::size_t arrival = rows.last; /* first row from which the reference stands at the target */
    while (arrival > record.time_zero_row() && record.at(arrival - 1, THETA_REF) == target) {
        --arrival;
    }
    if (arrival == record.time_zero_row()) {
        return 0; /* it never moved */
    }
    const double direction = target > record.at(arrival - 1, THETA_REF) ? 1 : -1;
    double most = 0;
    for (std::size_t row = std::max(arrival, rows.first); row < rows.last; ++row) {
        const double beyond = direction * (record.at(row, THETA) - target);
        most = beyond > most || beyond != beyond ? beyond : most;
    }
    return most;
}

/* Mean position error over the later half of the part at constant speed, and the lag it means. */
void steady_tracking(const Record &record, RowRange rows, Metrics &metrics)
{
    double cruise = 0;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        cruise = std::max(cruise, std::fabs(record.at(row, OMEGA_REF)));
    }
    std::vector<std::size_t> cruising;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        if (reference_moves(record, row) &&
            std::fabs(record.at(row, OMEGA_REF)) >= 0.999 * cruise) {
            cruising.push_back(row);
        }
    }
    if (cruising.empty() || cruise == 0) {
        return;
    }
    double error = 0, speed = 0;
    const std::size_t half = cruising.size() / 2;
    for (std::size_t i = half; i < cruising.size(); ++i) {
        error += record.at(cruising[i], THETA_REF) - record.at(cruising[i], THETA);
        speed += record.at(cruising[i], OMEGA_REF);
    }
    metrics.position_error_steady_rad = error / static_cast<double>(cruising.size() - half);
    metrics.lag_s = error / speed;
}

/* Before time zero there is no load: one that acts from the first row on is a step, too. */
double load_torque_t90(const Record &record, RowRange rows)
{
    double longest = Metrics::none;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        const double before = row == record.time_zero_row() ? 0 : record.at(row - 1, LOAD_TORQUE);
        const double step = record.at(row, LOAD_TORQUE) - before;
        if (step == 0) {
            continue;
        }
        std::size_t reached = row;
        while (reached < rows.last &&
               !((record.at(reached, LOAD_TORQUE_EST) - before) / step >= 0.9)) {
            ++reached;
        }
        if (reached == rows.last) {
            return Metrics::none;
        }
        const double time_s = static_cast<double>(reached - row) * record.period_s();
        longest = time_s <= longest ? longest : time_s;
    }
    return longest;
}

double current_ripple(const Record &record, RowRange rows)
{
    std::vector<double> sum = {0}; /* of the first n rows of the window */
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        sum.push_back(sum.back() + record.at(row, I_Q));
    }
    const std::size_t half = periods(record, ripple_time_s / 2);
    Magnitude ripple;
    for (std::size_t i = half; i + half + 1 < sum.size(); ++i) {
        const double mean = (sum[i + half + 1] - sum[i - half]) / static_cast<double>(2 * half + 1);
        ripple.add(sum[i + 1] - sum[i] - mean);
    }
    return half > 0 && ripple.count > 0 ? ripple.rms() : Metrics::none;
}

/* Root mean square about the mean. Two passes: it is small against the mean. */
template <typename Signal> double deviation(RowRange rows, Signal signal)
{
    double sum = 0, squares = 0;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        sum += signal(row);
    }
    const double count = static_cast<double>(rows.last - rows.first), mean = sum / count;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        const double difference = signal(row) - mean;
        squares += difference * difference;
    }
    return std::sqrt(squares / count);
}

double peak_to_peak(const Record &record, RowRange rows, Column column)
{
    double least = record.at(rows.first, column), most = least;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        least = std::min(least, record.at(row, column));
        most = std::max(most, record.at(row, column));
    }
    return most - least;
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

RowRange rows_of(const Record &record, const Window &window)
{
    const std::size_t zero = record.time_zero_row();
    switch (window.kind) {
    case Window::Kind::move:
        return {zero, end_of_motion(record)};
    case Window::Kind::rest:
        return {end_of_motion(record), record.rows()};
    case Window::Kind::all:
        return {zero, record.rows()};
    case Window::Kind::times:
        break;
    }
    return {zero + periods(record, window.begin_s),
            std::min(record.rows(), zero + periods(record, window.end_s) + 1)};
}

bool contains(const Record &record, const Window &window, double time_s)
{
    const double half_period_s = record.period_s() / 2;
    if (window.kind == Window::Kind::all) {
        return true;
    }
    if (window.kind == Window::Kind::times) {
        return time_s >= window.begin_s - half_period_s && time_s <= window.end_s + half_period_s;
    }
    const RowRange move = rows_of(record, {Window::Kind::move});
    const bool in_move = !move.empty() && time_s <= record.time_s(move.last - 1) + half_period_s;
    return in_move == (window.kind == Window::Kind::move);
}

const std::vector<MetricField> &metric_fields()
{
    static const std::vector<MetricField> fields = {
        {"position_error_max_rad", &Metrics::position_error_max_rad},
        {"position_error_rms_rad", &Metrics::position_error_rms_rad},
        {"position_error_final_rad", &Metrics::position_error_final_rad},
        {"position_error_steady_rad", &Metrics::position_error_steady_rad},
        {"lag_s", &Metrics::lag_s},
        {"position_ripple_rms_rad", &Metrics::position_ripple_rms_rad},
        {"estimate_error_max_rad", &Metrics::estimate_error_max_rad},
        {"estimate_error_rms_rad", &Metrics::estimate_error_rms_rad},
        {"estimate_error_final_rad", &Metrics::estimate_error_final_rad},
        {"speed_error_max_rad_s", &Metrics::speed_error_max_rad_s},
        {"speed_error_rms_rad_s", &Metrics::speed_error_rms_rad_s},
        {"load_torque_error_max_Nm", &Metrics::load_torque_error_max_Nm},
        {"load_torque_error_rms_Nm", &Metrics::load_torque_error_rms_Nm},
        {"load_torque_error_final_Nm", &Metrics::load_torque_error_final_Nm},
        {"load_torque_t90_s", &Metrics::load_torque_t90_s},
        {"overshoot_rad", &Metrics::overshoot_rad},
        {"settling_time_s", &Metrics::settling_time_s},
        {"current_peak_A", &Metrics::current_peak_A},
        {"current_rms_A", &Metrics::current_rms_A},
        {"current_ripple_rms_A", &Metrics::current_ripple_rms_A},
        {"voltage_peak_V", &Metrics::voltage_peak_V},
        {"voltage_rms_V", &Metrics::voltage_rms_V},
        {"voltage_q_peak_to_peak_V", &Metrics::voltage_q_peak_to_peak_V},
        {"voltage_q_ripple_V", &Metrics::voltage_q_ripple_V},
        {"slip_full_steps", &Metrics::slip_full_steps},
        {"resistance_estimate_error_ratio", &Metrics::resistance_estimate_error_ratio},
        {"synchronism_worst", &Metrics::synchronism_worst},
        {"enabling_time_s", &Metrics::enabling_time_s},
        {"enabling_motion_max_rad", &Metrics::enabling_motion_max_rad},
        {"enabling_displacement_rad", &Metrics::enabling_displacement_rad},
        {"commands_refused", &Metrics::commands_refused},
        {"commands_dropped", &Metrics::commands_dropped},
    };
    return fields;
}

Metrics evaluate(const Record &record, RowRange rows, const MetricSettings &settings)
{
    Metrics metrics;
    if (rows.empty()) {
        return metrics;
    }
    Magnitude position, estimate, speed, load, i_a, i_b, u_a, u_b, slip, synchronism;
    const double full_steps_per_rad = settings.rotor_teeth / quarter_turn;
    const double first_estimate_error =
        record.at(rows.first, THETA) - record.at(rows.first, THETA_EST);
    for (std::size_t i = rows.first; i < rows.last; ++i) {
        const Row &row = record.row(i);
        const double estimate_error = row[THETA] - row[THETA_EST];
        position.add(row[THETA_REF] - row[THETA]);
        estimate.add(estimate_error);
        speed.add(row[OMEGA] - row[OMEGA_EST]);
        load.add(row[LOAD_TORQUE] - row[LOAD_TORQUE_EST]);
        i_a.add(row[I_A]);
        i_b.add(row[I_B]);
        u_a.add(row[U_A]);
        u_b.add(row[U_B]);
        slip.add((estimate_error - first_estimate_error) * full_steps_per_rad);
        synchronism.add(row[SYNCHRONISM]);
        if (row[DRIVE_FAULT_CODE] != 0 && metrics.fault == "none") {
            metrics.fault =
                drive_fault_name(static_cast<drive_fault>(static_cast<int>(row[DRIVE_FAULT_CODE])));
        }
    }
    const Row &last = record.row(rows.last - 1);
    metrics.position_error_max_rad = position.max;
    metrics.position_error_rms_rad = position.rms();
    metrics.position_error_final_rad = position.final;
    steady_tracking(record, rows, metrics);
    metrics.synchronism_worst = synchronism.max;
    metrics.estimate_error_max_rad = estimate.max;
    metrics.estimate_error_rms_rad = estimate.rms();
    metrics.estimate_error_final_rad = estimate.final;
    metrics.speed_error_max_rad_s = speed.max;
    metrics.speed_error_rms_rad_s = speed.rms();
    metrics.load_torque_error_max_Nm = load.max;
    metrics.load_torque_error_rms_Nm = load.rms();
    metrics.load_torque_error_final_Nm = load.final;
    metrics.load_torque_t90_s = load_torque_t90(record, rows);
    metrics.overshoot_rad = overshoot(record, rows);
    metrics.settling_time_s = settling_time(record, rows, settings.settling_band_rad);
    metrics.current_peak_A = std::max(i_a.max, i_b.max);
    metrics.current_rms_A =
        std::sqrt((i_a.sum_of_squares + i_b.sum_of_squares) / (2 * static_cast<double>(i_a.count)));
    metrics.current_ripple_rms_A = current_ripple(record, rows);
    metrics.voltage_peak_V = std::max(u_a.max, u_b.max);
    metrics.voltage_rms_V =
        std::sqrt((u_a.sum_of_squares + u_b.sum_of_squares) / (2 * static_cast<double>(u_a.count)));
    metrics.voltage_q_peak_to_peak_V = peak_to_peak(record, rows, U_Q);
    metrics.voltage_q_ripple_V =
        deviation(rows, [&](std::size_t row) { return record.at(row, U_Q); });
    metrics.position_ripple_rms_rad = deviation(
        rows, [&](std::size_t row) { return record.at(row, THETA_REF) - record.at(row, THETA); });
    metrics.slip_full_steps = std::floor(slip.max + 0.5);
    metrics.resistance_estimate_error_ratio =
        std::fabs(last[RESISTANCE_EST] - last[RESISTANCE]) / last[RESISTANCE];
    metrics.enabling_time_s = settings.enabling_time_s;
    metrics.enabling_motion_max_rad = settings.enabling_motion_max_rad;
    metrics.enabling_displacement_rad = settings.enabling_displacement_rad;
    return metrics;
}

} // namespace scenario
