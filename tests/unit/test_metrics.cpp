/* Figures of merit on records whose answer is known by hand. */
#include <cmath>
#include <limits>
#include <vector>

#include "sil/scenario/evaluation.h"
#include "sil/scenario/result.h"
#include "unity.h"

using namespace scenario;

namespace
{

constexpr double period_s = 1e-4;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double full_step_rad = 1.5707963267948966 / 50;

bool has_no_value(double figure)
{
    return figure != figure;
}

/* Seconds as rows. */
std::size_t at(double time_s)
{
    return static_cast<std::size_t>(time_s / period_s + 0.5);
}

using Rows = std::vector<Row>;

/* Rows that `shape(row, n)` fills in, n from 0 at time zero. */
template <typename Shape> Rows make_rows(double duration_s, Shape shape)
{
    Rows rows(at(duration_s) + 1);
    for (std::size_t n = 0; n < rows.size(); ++n) {
        rows[n] = {};
        rows[n][RESISTANCE] = rows[n][RESISTANCE_EST] = 1;
        shape(rows[n], n);
    }
    return rows;
}

/* A record that has been read; the first `enabling` rows come before time zero. */
struct Reading {
    Reading(const Rows &rows, const std::vector<Window> &windows, std::size_t enabling = 0)
        : record(period_s), evaluation(record, MetricSettings{}, windows)
    {
        for (std::size_t n = 0; n < rows.size(); ++n) {
            if (n == enabling) {
                record.start_time_here();
            }
            record.append(rows[n]);
        }
        record.end();
    }

    Record record;
    Evaluation evaluation;
};

RowRange rows_of(const Rows &rows, const Window &window)
{
    return Reading(rows, {window}).evaluation.rows_of(window);
}

/* 0...0.1 s at 10 rad/s to 1 rad, then rest; the rotor follows 0.01 s behind. */
void late_move(Row &row, std::size_t n)
{
    const double time_s = static_cast<double>(n) * period_s;
    row[REFERENCE_MOVING] = n < at(0.1) ? 1 : 0;
    row[OMEGA_REF] = n < at(0.1) ? 10 : 0;
    row[THETA_REF] = std::fmin(10 * time_s, 1);
    row[THETA] = row[THETA_EST] = std::fmin(std::fmax(10 * (time_s - 0.01), 0), 1);
}

Metrics over(const Rows &rows, const Window &window)
{
    return Reading(rows, {window}).evaluation.metrics_of(window);
}

void move_ends_with_the_profile_and_rest_follows()
{
    const Rows rows = make_rows(0.2, late_move);
    const RowRange move = rows_of(rows, {Window::Kind::move});
    const RowRange rest = rows_of(rows, {Window::Kind::rest});
    TEST_ASSERT_EQUAL_size_t(0, move.first);
    TEST_ASSERT_EQUAL_size_t(at(0.1), move.last);
    TEST_ASSERT_EQUAL_size_t(at(0.1), rest.first);
    TEST_ASSERT_EQUAL_size_t(rows.size(), rest.last);
}

void a_step_counts_as_motion_until_the_rotor_rests()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[THETA_REF] = n >= at(0.01) ? 0.1 : 0;
        /* Starts two periods late, and passes through zero speed at the peak of its overshoot. */
        const bool moving = n >= at(0.0102) && n < at(0.05) && n != at(0.03);
        row[OMEGA] = moving ? 5 : 0;
    });
    TEST_ASSERT_EQUAL_size_t(at(0.05), rows_of(rows, {Window::Kind::move}).last);
}

void without_motion_everything_is_rest()
{
    const Rows rows = make_rows(0.01, [](Row &, std::size_t) {});
    TEST_ASSERT_TRUE(rows_of(rows, {Window::Kind::move}).empty());
    TEST_ASSERT_EQUAL_size_t(rows.size(), rows_of(rows, {Window::Kind::rest}).last);
}

void enabling_before_time_zero_is_in_no_window()
{
    Rows rows(2, Row{});
    rows[0][THETA] = 100;
    const Reading reading(rows, {}, 1);
    const Metrics all = reading.evaluation.metrics_of({Window::Kind::all});
    TEST_ASSERT_EQUAL_DOUBLE(0, all.position_error_max_rad);
    TEST_ASSERT_EQUAL_DOUBLE(-period_s, reading.record.time_s(0));
}

/* Two profiles with a rest between them: what came to rest there has not ended the move. */
void a_move_goes_on_until_the_last_profile_is_over()
{
    const Rows rows = make_rows(0.3, [](Row &row, std::size_t n) {
        row[REFERENCE_MOVING] = (n < at(0.05) || (n >= at(0.1) && n < at(0.15))) ? 1 : 0;
        row[THETA] = n == at(0.07) ? -3 : n == at(0.2) ? -2 : 0;
    });
    const Reading reading(rows, {});
    const Metrics move = reading.evaluation.metrics_of({Window::Kind::move});
    const Metrics rest = reading.evaluation.metrics_of({Window::Kind::rest});
    TEST_ASSERT_EQUAL_DOUBLE(3, move.position_error_max_rad);
    TEST_ASSERT_EQUAL_DOUBLE(2, rest.position_error_max_rad);
    TEST_ASSERT_EQUAL_size_t(at(0.15), reading.evaluation.rows_of({Window::Kind::move}).last);
}

/* A rotor that turns on behind a step, having paused for less than 10 ms. */
void a_pause_does_not_end_a_step()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[THETA_REF] = n >= at(0.01) ? 0.1 : 0;
        const bool pause = n >= at(0.02) && n < at(0.029);
        row[OMEGA] = n >= at(0.011) && n < at(0.05) && !pause ? 5 : 0;
        row[THETA] = n == at(0.04) ? -3 : 0;
    });
    const Reading reading(rows, {});
    TEST_ASSERT_EQUAL_size_t(at(0.05), reading.evaluation.rows_of({Window::Kind::move}).last);
    const Metrics rest = reading.evaluation.metrics_of({Window::Kind::rest});
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, rest.position_error_max_rad);
}

void explicit_times_include_both_ends()
{
    const Rows rows = make_rows(0.1, late_move);
    const RowRange range = rows_of(rows, {Window::Kind::times, 0.02, 0.05});
    TEST_ASSERT_EQUAL_size_t(at(0.02), range.first);
    TEST_ASSERT_EQUAL_size_t(at(0.05) + 1, range.last);
}

void errors_have_their_largest_mean_square_and_last_value()
{
    const Rows rows = make_rows(3 * period_s, [](Row &row, std::size_t n) {
        const double values[] = {0, -4, 2, -2};
        row[THETA] = values[n];
        row[OMEGA] = -values[n];
        row[LOAD_TORQUE_EST] = values[n];
    });
    const Metrics metrics = over(rows, {Window::Kind::all});
    TEST_ASSERT_EQUAL_DOUBLE(4, metrics.position_error_max_rad);
    TEST_ASSERT_EQUAL_DOUBLE(std::sqrt(6.0), metrics.position_error_rms_rad);
    TEST_ASSERT_EQUAL_DOUBLE(2, metrics.position_error_final_rad);
    TEST_ASSERT_EQUAL_DOUBLE(4, metrics.estimate_error_max_rad);
    TEST_ASSERT_EQUAL_DOUBLE(std::sqrt(6.0), metrics.speed_error_rms_rad_s);
    TEST_ASSERT_EQUAL_DOUBLE(2, metrics.load_torque_error_final_Nm);
}

void the_lag_of_a_move_is_found()
{
    const Metrics metrics = over(make_rows(0.2, late_move), {Window::Kind::move});
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, metrics.position_error_steady_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.01, metrics.lag_s);
}

void only_the_cruise_counts_for_the_lag()
{
    const Rows rows = make_rows(0.2, [](Row &row, std::size_t n) {
        row[REFERENCE_MOVING] = 1;
        row[OMEGA_REF] = n <= at(0.1) ? 10 : 5;
        row[THETA_REF] = n <= at(0.1) ? 0.1 : 0.7;
    });
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.01, over(rows, {Window::Kind::all}).lag_s);
}

/* 20 s at one speed: the rows of the cruise are then kept in pairs, and pairs of pairs. */
void a_long_cruise_has_the_same_later_half()
{
    const Rows rows = make_rows(20, [](Row &row, std::size_t n) {
        row[REFERENCE_MOVING] = 1;
        row[OMEGA_REF] = n < at(1) ? 9 : 10;
        row[THETA_REF] = n < at(10.5) ? 0.1 : 0.3;
    });
    const Metrics metrics = over(rows, {Window::Kind::all});
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.3, metrics.position_error_steady_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.03, metrics.lag_s);
}

void settling_counts_from_the_end_of_the_reference()
{
    const Metrics metrics = over(make_rows(0.2, late_move), {Window::Kind::all});
    /* 2 mrad at 10 rad/s are 0.2 ms before the rotor arrives at 0.11 s. */
    TEST_ASSERT_DOUBLE_WITHIN(2.5e-4, 0.0098, metrics.settling_time_s);
}

void what_does_not_settle_has_no_settling_time()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[THETA_REF] = n > 0 ? 1 : 0;
        row[OMEGA] = 1;
    });
    TEST_ASSERT_TRUE(has_no_value(over(rows, {Window::Kind::all}).settling_time_s));
}

void overshoot_is_measured_beyond_the_target_in_either_direction()
{
    for (const double direction : {1.0, -1.0}) {
        const Rows rows = make_rows(0.1, [&](Row &row, std::size_t n) {
            row[THETA_REF] = n > 0 ? direction : 0;
            row[THETA] = direction * (n > at(0.02) && n < at(0.03) ? 1.05 : 1.0);
        });
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05, over(rows, {Window::Kind::all}).overshoot_rad);
    }
}

void a_move_that_does_not_pass_its_target_has_no_overshoot()
{
    TEST_ASSERT_EQUAL_DOUBLE(0, over(make_rows(0.2, late_move), {Window::Kind::all}).overshoot_rad);
}

void a_load_step_is_timed_until_90_percent_are_estimated()
{
    const Rows rows = make_rows(0.2, [](Row &row, std::size_t n) {
        row[LOAD_TORQUE] = n < at(0.1) ? 0.1 : 0.0;
        row[LOAD_TORQUE_EST] = n < at(0.005) ? 0.0 : n < at(0.103) ? 0.0901 : 0.0099;
    });
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.005,
                              over(rows, {Window::Kind::times, 0, 0.05}).load_torque_t90_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.003,
                              over(rows, {Window::Kind::times, 0.05, 0.2}).load_torque_t90_s);
    TEST_ASSERT_TRUE(has_no_value(over(rows, {Window::Kind::times, 0, 0.004}).load_torque_t90_s));
}

void slip_is_counted_in_full_steps_from_where_the_window_begins()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[THETA] = 0.2 + (n < at(0.05) ? 0.3 : 4.2) * full_step_rad;
    });
    TEST_ASSERT_EQUAL_DOUBLE(4, over(rows, {Window::Kind::all}).slip_full_steps);
    TEST_ASSERT_EQUAL_DOUBLE(0, over(rows, {Window::Kind::times, 0, 0.04}).slip_full_steps);
    TEST_ASSERT_EQUAL_DOUBLE(0, over(rows, {Window::Kind::times, 0.06, 0.1}).slip_full_steps);
}

void currents_are_those_of_one_phase()
{
    const Rows rows = make_rows(1, [](Row &row, std::size_t n) {
        const double angle = 6.283185307179586 * static_cast<double>(n) / 10000.0 * 5;
        row[I_A] = 3 * std::cos(angle);
        row[I_B] = 3 * std::sin(angle);
    });
    const Metrics metrics = over(rows, {Window::Kind::all});
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3, metrics.current_peak_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3 / std::sqrt(2.0), metrics.current_rms_A);
}

void ripple_is_what_the_q_current_does_within_two_milliseconds()
{
    const Rows rows = make_rows(1, [](Row &row, std::size_t n) {
        const double time_s = static_cast<double>(n) * period_s;
        const double ripple = 0.2 * std::cos(6.283185307179586 * 500 * time_s);
        row[I_Q] = 1 + 2 * time_s + (n % 2 == 0 ? 0.05 : -0.05) + ripple;
    });
    /* A 2 ms mean takes nothing of 5 kHz and of 500 Hz but its part of one row too many. */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, std::sqrt(0.05 * 0.05 + 0.2 * 0.2 / 2),
                              over(rows, {Window::Kind::all}).current_ripple_rms_A);
}

void a_current_that_grows_steadily_has_no_ripple()
{
    const Rows rows = make_rows(
        0.1, [](Row &row, std::size_t n) { row[I_Q] = 30 * static_cast<double>(n) * period_s; });
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, over(rows, {Window::Kind::all}).current_ripple_rms_A);
    TEST_ASSERT_TRUE(
        has_no_value(over(rows, {Window::Kind::times, 0, 0.0015}).current_ripple_rms_A));
}

void the_first_fault_of_a_window_is_named()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[DRIVE_FAULT_CODE] = n < at(0.05) ? DRIVE_FAULT_NONE : DRIVE_FAULT_OVERCURRENT;
    });
    TEST_ASSERT_EQUAL_STRING(drive_fault_name(DRIVE_FAULT_OVERCURRENT),
                             over(rows, {Window::Kind::all}).fault.c_str());
    TEST_ASSERT_EQUAL_STRING("none", over(rows, {Window::Kind::times, 0, 0.04}).fault.c_str());
}

void an_estimate_that_is_not_finite_gives_no_figure()
{
    const Rows rows =
        make_rows(0.1, [](Row &row, std::size_t n) { row[THETA_EST] = n == at(0.05) ? nan : 0; });
    const Metrics metrics = over(rows, {Window::Kind::all});
    TEST_ASSERT_TRUE(has_no_value(metrics.estimate_error_max_rad));
    TEST_ASSERT_TRUE(has_no_value(metrics.estimate_error_rms_rad));
    TEST_ASSERT_TRUE(has_no_value(metrics.slip_full_steps));
}

void an_empty_window_gives_no_figure()
{
    const Rows rows = make_rows(0.01, [](Row &, std::size_t) {});
    TEST_ASSERT_TRUE(has_no_value(over(rows, {Window::Kind::move}).position_error_max_rad));
}

void the_hash_sees_every_bit_and_treats_all_nan_alike()
{
    Row row{};
    Record a(period_s), b(period_s), c(period_s), d(period_s);
    a.append(row);
    row[BUS] = std::numeric_limits<double>::denorm_min();
    b.append(row);
    row[BUS] = nan;
    c.append(row);
    row[BUS] = -nan;
    d.append(row);
    TEST_ASSERT_TRUE(a.hash() != b.hash());
    TEST_ASSERT_TRUE(b.hash() != c.hash());
    TEST_ASSERT_TRUE(c.hash() == d.hash());
}

void the_hash_is_fnv_1a_over_words()
{
    Row row;
    for (std::size_t i = 0; i < COLUMNS; ++i) {
        row[i] = static_cast<double>(i + 1);
    }
    Record record(period_s);
    record.append(row);
    TEST_ASSERT_EQUAL_HEX64(0x6d91dd1ca2b90acdu, record.hash()); /* computed apart */
}

void time_is_the_number_nearest_to_the_decimal()
{
    const Record record(period_s);
    TEST_ASSERT_TRUE(record.time_s(3) == 0.0003);
    TEST_ASSERT_TRUE(record.time_s(567) == 0.0567);
}

void up_to_19_seeds_the_worst_decides_then_95_percent()
{
    std::vector<double> values;
    for (int i = 1; i <= 19; ++i) {
        values.push_back(i);
    }
    TEST_ASSERT_EQUAL_DOUBLE(19, percentile_95(values));
    values.push_back(1000);
    TEST_ASSERT_EQUAL_DOUBLE(19, percentile_95(values));
    values.back() = 19;
    values.front() = nan;
    TEST_ASSERT_EQUAL_DOUBLE(19, percentile_95(values));
    values.pop_back();
    TEST_ASSERT_TRUE(has_no_value(percentile_95(values)));
}

/* Results of one expectation on as many seeds as there are values. */
std::vector<Result> results_with(const Expectation &expectation, const std::vector<double> &values)
{
    std::vector<Result> results;
    for (const double value : values) {
        Result result;
        result.seed = results.size() + 1;
        const bool held = (!expectation.max || value <= *expectation.max) &&
                          (!expectation.min || value >= *expectation.min);
        result.observations = {{value, "", held}};
        results.push_back(result);
    }
    return results;
}

void the_worst_seed_is_named()
{
    Expectation at_most, at_least, between;
    at_most.max = 5;
    at_least.min = 5;
    between.min = 3;
    between.max = 5;
    const Judgement high = judge(at_most, 0, results_with(at_most, {1, 9, 3}));
    const Judgement low = judge(at_least, 0, results_with(at_least, {9, 1, 3, 7}));
    const Judgement out = judge(between, 0, results_with(between, {4, 1, 5}));
    TEST_ASSERT_FALSE(high.held);
    TEST_ASSERT_EQUAL_UINT64(2, high.worst_seed);
    TEST_ASSERT_EQUAL_DOUBLE(9, high.worst.value);
    TEST_ASSERT_FALSE(low.held);
    TEST_ASSERT_EQUAL_UINT64(2, low.worst_seed);
    TEST_ASSERT_FALSE(out.held);
    TEST_ASSERT_EQUAL_UINT64(2, out.worst_seed);
}

void a_figure_that_is_only_reported_holds_and_its_worst_seed_is_named()
{
    const Expectation reported;
    std::vector<Result> results(3);
    const double values[] = {1, 9, nan};
    for (std::size_t i = 0; i < results.size(); ++i) {
        results[i].seed = i + 1;
        results[i].reported = {{values[i], "", true}};
    }
    const Judgement judgement = judge(reported, 0, results, &Result::reported);
    TEST_ASSERT_TRUE(judgement.held);
    TEST_ASSERT_EQUAL_UINT64(3, judgement.worst_seed);
    results.pop_back();
    TEST_ASSERT_EQUAL_DOUBLE(9, judge(reported, 0, results, &Result::reported).typical.value);
}

void a_run_without_a_value_is_the_worst()
{
    Expectation at_most;
    at_most.max = 5;
    const Judgement judgement = judge(at_most, 0, results_with(at_most, {1, nan, 3}));
    TEST_ASSERT_FALSE(judgement.held);
    TEST_ASSERT_EQUAL_UINT64(2, judgement.worst_seed);
}

/* 20 V, in the second half with a square wave of 3 V on it. */
void the_ripple_of_the_q_voltage_is_about_its_mean()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[U_Q] = n < at(0.05) ? 20 : n % 2 == 0 ? 23 : 17;
    });
    const Metrics quiet = over(rows, {Window::Kind::times, 0, 0.0499});
    const Metrics loud = over(rows, {Window::Kind::times, 0.05, 0.0999});
    TEST_ASSERT_EQUAL_DOUBLE(0, quiet.voltage_q_peak_to_peak_V);
    TEST_ASSERT_EQUAL_DOUBLE(0, quiet.voltage_q_ripple_V);
    TEST_ASSERT_EQUAL_DOUBLE(6, loud.voltage_q_peak_to_peak_V);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3, loud.voltage_q_ripple_V);
}

void the_ripple_of_the_position_is_its_error_about_its_mean()
{
    const Rows rows = make_rows(0.1, [](Row &row, std::size_t n) {
        row[THETA_REF] = 0.5;
        row[THETA] = 0.499 + (n % 2 == 0 ? 2e-5 : -2e-5);
    });
    const Metrics metrics = over(rows, {Window::Kind::times, 0, 0.0999});
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2e-5, metrics.position_ripple_rms_rad);
}

} // namespace

void setUp(void)
{
}

void tearDown(void)
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(move_ends_with_the_profile_and_rest_follows);
    RUN_TEST(the_ripple_of_the_q_voltage_is_about_its_mean);
    RUN_TEST(the_ripple_of_the_position_is_its_error_about_its_mean);
    RUN_TEST(a_step_counts_as_motion_until_the_rotor_rests);
    RUN_TEST(without_motion_everything_is_rest);
    RUN_TEST(enabling_before_time_zero_is_in_no_window);
    RUN_TEST(a_move_goes_on_until_the_last_profile_is_over);
    RUN_TEST(a_pause_does_not_end_a_step);
    RUN_TEST(explicit_times_include_both_ends);
    RUN_TEST(a_long_cruise_has_the_same_later_half);
    RUN_TEST(errors_have_their_largest_mean_square_and_last_value);
    RUN_TEST(the_lag_of_a_move_is_found);
    RUN_TEST(only_the_cruise_counts_for_the_lag);
    RUN_TEST(settling_counts_from_the_end_of_the_reference);
    RUN_TEST(what_does_not_settle_has_no_settling_time);
    RUN_TEST(overshoot_is_measured_beyond_the_target_in_either_direction);
    RUN_TEST(a_move_that_does_not_pass_its_target_has_no_overshoot);
    RUN_TEST(a_load_step_is_timed_until_90_percent_are_estimated);
    RUN_TEST(slip_is_counted_in_full_steps_from_where_the_window_begins);
    RUN_TEST(currents_are_those_of_one_phase);
    RUN_TEST(ripple_is_what_the_q_current_does_within_two_milliseconds);
    RUN_TEST(a_current_that_grows_steadily_has_no_ripple);
    RUN_TEST(the_first_fault_of_a_window_is_named);
    RUN_TEST(an_estimate_that_is_not_finite_gives_no_figure);
    RUN_TEST(an_empty_window_gives_no_figure);
    RUN_TEST(the_hash_sees_every_bit_and_treats_all_nan_alike);
    RUN_TEST(the_hash_is_fnv_1a_over_words);
    RUN_TEST(time_is_the_number_nearest_to_the_decimal);
    RUN_TEST(up_to_19_seeds_the_worst_decides_then_95_percent);
    RUN_TEST(the_worst_seed_is_named);
    RUN_TEST(a_figure_that_is_only_reported_holds_and_its_worst_seed_is_named);
    RUN_TEST(a_run_without_a_value_is_the_worst);
    return UNITY_END();
}
