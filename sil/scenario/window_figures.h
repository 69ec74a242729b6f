/* The figures of one window, found as its rows come: what is kept does not grow with their number.
 */
#ifndef STEADYSTEP_SCENARIO_WINDOW_FIGURES_H
#define STEADYSTEP_SCENARIO_WINDOW_FIGURES_H

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sil/scenario/metrics.h"
#include "sil/scenario/record.h"

namespace scenario
{

/* What a row says beside the ones before it, whatever the window. */
struct Moment {
    const Row &row;
    bool in_profile;    /* the reference */
    bool in_motion;     /* in a profile, or stepping into this row outside of any */
    bool new_target;    /* it is not where it was */
    double approach;    /* of the target: 1 from below, -1 from above, 0: it has never moved */
    double load_before; /* N m */
};

/* Two quantities side by side in one register. */
typedef double Pair __attribute__((vector_size(16)));

/* Largest magnitudes and sums of squares; a NaN, once in, stays. */
struct Magnitudes {
    Pair max = {0, 0}, squares = {0, 0};

    void add(Pair value)
    {
        const Pair magnitude = value < Pair{0, 0} ? -value : value;
        max = ((magnitude > max) | (magnitude != magnitude)) ? magnitude : max;
        squares += value * value;
    }
};

/* Root mean squares about the means, which may be large against them: each block of rows is summed
   about its own mean, and joined to those before it (Chan, Golub and LeVeque 1979). */
class Deviations
{
  public:
    void add(Pair value);
    Pair rms() const;

  private:
    struct Sum {
        double count = 0;
        Pair mean = {0, 0}, squares = {0, 0};
    };
    static Sum joined(const Sum &sum, const Pair *values, std::size_t count);

    static constexpr std::size_t block_rows = 32;
    Sum sum_;
    std::array<Pair, block_rows> block_;
    std::size_t filled_ = 0;
};

/* The part of the reference's motion at its highest speed, within 0.1 %. */
class Cruise
{
  public:
    void add(double speed_ref, bool in_profile, double position_error);
    /* Over its later half; false: there is none. */
    bool mean(double &position_error, double &lag_s) const;

  private:
    /* Rows in a row; one each up to 65,536 of them, then neighbours share a part. */
    struct Part {
        double slowest, position_error, speed, count;
    };
    static constexpr std::size_t most_parts = 65536;
    void merge_neighbours();

    double fastest_ = 0;
    std::vector<Part> parts_;
    std::size_t first_ = 0; /* those before it were too slow */
};

/* Of the q current about its mean over the rows around each. */
class Ripple
{
  public:
    explicit Ripple(double period_s);
    void add(double value);
    double rms() const; /* NaN: the window is too short */

  private:
    std::size_t next(std::size_t place) const
    {
        return place + 1 < sums_.size() ? place + 1 : 0;
    }

    std::size_t half_;         /* rows on either side */
    std::vector<double> sums_; /* of the first n rows of the window, for the latest n, in a ring */
    std::size_t latest_ = 0;   /* place of that of all rows, */
    std::size_t middle_;       /* and of that of all but the latest half */
    std::size_t rows_ = 0, count_ = 0;
    double squares_ = 0;
};

/* From a load step to 90 % of it being estimated. A load that changes from row to row is none. */
class LoadSteps
{
  public:
    void add(std::size_t place, const Moment &moment);
    /* Of the slowest, in rows; NaN: there is none, or one has not been followed. */
    double longest() const;

  private:
    struct Step {
        std::size_t place;
        double before, step;
    };
    std::vector<Step> open_;
    std::optional<Step> recent_; /* of the row before: a ramp, if the load goes on changing */
    bool ramps_ = false;
    double longest_ = Metrics::none;
};

class WindowFigures
{
  public:
    WindowFigures(const MetricSettings &settings, double period_s);

    void add(const Moment &moment);
    std::size_t rows() const
    {
        return rows_;
    }
    Metrics metrics() const;

  private:
    void settle(const Moment &moment, double position_error);
    void pass_target(const Moment &moment);

    MetricSettings settings_;
    double period_s_;
    std::size_t rows_ = 0;
    double first_estimate_error_ = 0;
    double fault_ = 0;
    Magnitudes errors_, rates_, currents_, voltages_, slip_;
    double voltage_q_least_ = 0, voltage_q_most_ = 0;
    Deviations deviations_; /* of the q voltage and of the position error */
    Cruise cruise_;
    Ripple ripple_;
    LoadSteps load_steps_;
    double overshoot_ = 0;
    std::size_t reference_arrived_ = 0; /* last row of its motion */
    std::size_t outside_ = 0;           /* rows up to the last since then beyond the band, or 0 */
    double last_position_error_ = 0, last_estimate_error_ = 0, last_load_error_Nm_ = 0;
    double last_resistance_ohm_ = 0, last_resistance_est_ohm_ = 0;
};

} // namespace scenario

#endif
