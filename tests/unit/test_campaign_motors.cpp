/* What the campaign of random motors says of a run. */
#include <cmath>
#include <string>

#include "sil/scenario/campaign.h"
#include "sil/scenario/hold_yield.h"
#include "tests/reference/motors.h"
#include "unity.h"

using namespace scenario;

namespace
{

constexpr double pi = 3.14159265358979323846;
constexpr double degree_rad = pi / 180 / 50; /* electrical, of 50 teeth */
constexpr double full_step_rad = pi / 2 / 50;
constexpr double count_rad = 2 * pi / 4000;
constexpr std::size_t rows = 10000; /* a second of operation */
constexpr std::size_t settled = rows - 2500;

/* A run of a second whose rotor stands where reference and estimate have it. */
class Course
{
  public:
    explicit Course(int encoder_counts = 0)
    {
        scenario_.motor.params.rotor_teeth = 50;
        scenario_.plant.sensors.encoder_counts_per_turn = encoder_counts;
        result_.scenario = &scenario_;
        result_.all.metrics.fault = "none";
        for (Row &row : course_) {
            row[DRIVE_STATE] = DRIVE_OPERATION_ENABLED;
        }
    }

    Course &with(Column column, std::size_t first, std::size_t last, double value)
    {
        for (std::size_t row = first; row < last; ++row) {
            course_[row][column] = value;
        }
        return *this;
    }
    Course &with_detent()
    {
        scenario_.plant.imperfections.detent_4 = 0.05;
        return *this;
    }
    Course &with_fault(std::size_t row)
    {
        result_.all.metrics.fault = "stalled";
        return with(DRIVE_STATE, row, rows, DRIVE_FAULT);
    }
    Course &with_failure(const char *words = "a move was refused")
    {
        result_.failure = words;
        return *this;
    }
    /* One that the drive bears: what its hold yields is then known. */
    Course &with_motor()
    {
        const motor_params motor = reference::bendjedia_2012();
        scenario_.motor.params = motor;
        drive_settings_default(&scenario_.drive, &motor);
        scenario_.drive.hold_current_A = 0.5 * motor.rated_current_A;
        return *this;
    }
    /* And the default law, of a small motor with steps of 0.9 degrees. */
    Course &with_encoder(double inertia_kgm2)
    {
        motor_params &motor = scenario_.motor.params;
        motor = {1.55, 1.8e-3, 0.11 / (std::sqrt(2) * 1.5), 4e-5, inertia_kgm2, 1.5, 24.0, 100};
        drive_settings_default(&scenario_.drive, &motor);
        drive_settings_select_feedback(&scenario_.drive, DRIVE_FEEDBACK_ENCODER);
        return *this;
    }
    double limit_rad() const
    {
        return result_.hold_yield_rad ? *result_.hold_yield_rad
                                      : HoldYield(scenario_).yield_rad().value_or(0);
    }

    CampaignOutcome outcome()
    {
        Record record(1e-4);
        const std::unique_ptr<CampaignWatch> watch = motors_campaign.watch(scenario_);
        HoldYield yield(scenario_);
        record.add_reader(*watch);
        record.add_reader(yield);
        record.append(Row{}); /* of the enabling */
        record.start_time_here();
        for (const Row &row : course_) {
            record.append(row);
        }
        record.end();
        result_.hold_yield_rad = yield.yield_rad();
        return watch->judge(result_);
    }
    std::string verdict()
    {
        return outcome().verdict;
    }

  private:
    Scenario scenario_;
    Result result_;
    std::vector<Row> course_ = std::vector<Row>(rows);
};

void expect(const char *verdict, Course &course)
{
    TEST_ASSERT_EQUAL_STRING(verdict, course.verdict().c_str());
}

void a_rotor_where_it_belongs_is_held()
{
    Course plain;
    expect("held", plain);
    Course swings;
    expect("held", swings.with(THETA_EST, 100, 200, 44 * degree_rad));
}

void the_estimate_decides_between_commutation_and_a_silent_loss()
{
    Course off, lost;
    expect("commutation beyond 45 degrees", off.with(THETA_EST, 100, 101, 46 * degree_rad));
    expect("lost silently", lost.with(THETA_EST, 100, 101, 91 * degree_rad));
}

void a_fault_is_a_fault_and_what_is_estimated_behind_it_says_nothing()
{
    Course fault;
    fault.with_fault(500).with(THETA_EST, 500, rows, 1e3);
    const CampaignOutcome outcome = fault.outcome();
    TEST_ASSERT_EQUAL_STRING("fault stalled", outcome.verdict.c_str());
    TEST_ASSERT_EQUAL_DOUBLE(0, outcome.figures[0]);
    Course refused;
    expect("failed", refused.with_failure());
}

void the_end_is_judged_to_a_sixteenth_of_a_step_and_a_fifth_with_detent()
{
    for (const double share : {0.99, 1.01}) {
        const char *const verdict = share < 1 ? "held" : "position at the end";
        Course plain, detent;
        expect(verdict, plain.with(THETA, settled, settled + 1, share * full_step_rad / 16)
                            .with(THETA_EST, settled, settled + 1, share * full_step_rad / 16));
        expect(verdict,
               detent.with_detent().with(THETA_REF, rows - 1, rows, share * full_step_rad / 5));
        Course counted(4000);
        expect(verdict,
               counted.with(THETA_REF, settled, rows, share * (full_step_rad / 16 + count_rad)));
    }
    Course earlier;
    expect("held", earlier.with(THETA_REF, 0, settled - 1, full_step_rad));
}

/* Noticed are 6.7 % of the rated torque, 13.5 % of what half of it holds: 7.7 degrees, and what
   half a code of 15 mV feigns, 0.05 rad/s, in 29 ms. Detent torque and friction come on top. */
void what_a_hold_is_computed_to_yield_is_distinguished()
{
    Course bare, with_detent;
    const double yields_rad = bare.with_motor().limit_rad();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.00411, yields_rad);
    const double detent_rad = with_detent.with_motor().with_detent().limit_rad();
    TEST_ASSERT_TRUE(detent_rad > yields_rad + 0.14 / 50 && detent_rad < yields_rad + 0.16 / 50);
    for (const double share : {0.99, 1.01}) {
        Course plain;
        expect(share < 1 ? "within its computed limit" : "position at the end",
               plain.with_motor().with(THETA_REF, settled, rows, share * yields_rad));
    }
    Course unfound(4000);
    expect("refused: position-not-found",
           unfound.with_failure("the drive did not become ready: fault after 1.022 s, fault "
                                "position-not-found"));
}

/* Two steps of 0.6 of what is noticed, the second with the first or against it; while the hold
   leads any step; and in motion none. */
void loads_that_go_unnoticed_add_up_until_the_next_motion()
{
    Course still, adds, takes_back, leads, moves;
    const double noticed_rad = still.with_motor().limit_rad();
    const double step_Nm = 0.6 * 0.0318; /* noticed are 31.8 mN m of 0.236 */
    const auto loaded = [&](Course &course, double second_Nm, double second_moving, double held) {
        course.with_motor().with(HOLDING, 0, rows, 1).with(LOAD_TORQUE, 100, rows, step_Nm);
        course.with(LOAD_TORQUE, 200, rows, second_Nm)
            .with(REFERENCE_MOVING, 150, 250, second_moving);
        course.with(HOLDING, 300, 310, held);
        course.outcome();
        return course.limit_rad();
    };
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, noticed_rad, loaded(takes_back, 0, 0, 1));
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, noticed_rad + 0.2 * 0.1345 / 50,
                              loaded(adds, 2 * step_Nm, 0, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, noticed_rad + (asin(5 * 0.1345) - asin(0.1345)) / 50,
                              loaded(leads, 5 * 0.0318, 1, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, noticed_rad, loaded(moves, 5 * 0.0318, 1, 0));
}

/* 900 rad/s of a rotor of 12 g cm^2 are 0.97 N m/rad; the detent torque has 2.2 at its steepest. */
void detent_torque_steeper_than_the_law_is_stiff_is_a_limit_with_an_encoder()
{
    const auto of = [](double inertia_kgm2, bool detent) {
        Course course(4000);
        course.with_motor().with_encoder(inertia_kgm2);
        if (detent) {
            course.with_detent();
        }
        course.outcome();
        return course.limit_rad();
    };
    const double torque_Nm = 0.05 * 0.11;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, torque_Nm / (12e-7 * 900 * 900) + count_rad, of(12e-7, true));
    TEST_ASSERT_EQUAL_DOUBLE(0, of(12e-7, false));
    TEST_ASSERT_EQUAL_DOUBLE(0, of(60e-7, true));
}

/* Three quarters of a count of 4,000 are 3.4 degrees; with 40,000 three degrees are more. */
void ready_is_wrong_with_a_zero_that_is_off()
{
    for (const int counts : {4000, 40000}) {
        const double allowed_rad = counts == 4000 ? 0.75 * count_rad : 3 * degree_rad;
        for (const double share : {0.99, 1.01}) {
            Course course(counts);
            expect(share < 1 ? "held" : "wrong ready",
                   course.with(THETA_EST, 0, 5, share * allowed_rad));
        }
    }
    Course sensorless, later(4000);
    expect("held", sensorless.with(THETA_EST, 0, 5, 20 * degree_rad));
    expect("held", later.with(THETA_EST, 20, 25, 20 * degree_rad));
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(a_rotor_where_it_belongs_is_held);
    RUN_TEST(the_estimate_decides_between_commutation_and_a_silent_loss);
    RUN_TEST(a_fault_is_a_fault_and_what_is_estimated_behind_it_says_nothing);
    RUN_TEST(the_end_is_judged_to_a_sixteenth_of_a_step_and_a_fifth_with_detent);
    RUN_TEST(what_a_hold_is_computed_to_yield_is_distinguished);
    RUN_TEST(loads_that_go_unnoticed_add_up_until_the_next_motion);
    RUN_TEST(detent_torque_steeper_than_the_law_is_stiff_is_a_limit_with_an_encoder);
    RUN_TEST(ready_is_wrong_with_a_zero_that_is_off);
    return UNITY_END();
}
