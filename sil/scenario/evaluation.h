/*
 * Reads a record once, as it comes, and knows the figures of its windows: move, rest, all, and
 * those that were asked for beforehand.
 */
#ifndef STEADYSTEP_SCENARIO_EVALUATION_H
#define STEADYSTEP_SCENARIO_EVALUATION_H

#include <optional>
#include <vector>

#include "sil/scenario/window.h"
#include "sil/scenario/window_figures.h"

namespace scenario
{

class Evaluation : public RowReader
{
  public:
    /* Reads that record and no other; `windows`: of Kind::times. */
    Evaluation(Record &record, const MetricSettings &settings, const std::vector<Window> &windows);

    void read(const Record &record, const Row &row) override;

    /* Behind the last row. */
    RowRange rows_of(const Window &window) const;
    Metrics metrics_of(const Window &window) const;
    /* Whether a time lies in the window; what comes before time zero belongs to what it is
       followed by. */
    bool contains(const Window &window, double time_s) const;

  private:
    /* Of the reference, and of the rotor behind a step; what is open may yet turn out to be the
       end of the move. */
    enum class Motion { none, profile, step_awaits_rotor, rotor_turns, over };

    struct TimesFigures {
        Window window;
        RowRange rows; /* from time zero on, as far as the record goes */
        WindowFigures figures;
    };

    Moment moment_of(std::size_t row, const Row &values);
    void follow_motion(const Moment &moment);
    void end_move_here();
    bool move_has_ended() const
    {
        return motion_ == Motion::none || motion_ == Motion::over;
    }
    const TimesFigures *find(const Window &window) const;

    const Record &record_;
    const WindowFigures empty_;
    WindowFigures all_;
    WindowFigures move_, rest_; /* as if the move had ended where it seemed to */
    std::vector<TimesFigures> times_;

    Motion motion_ = Motion::none;
    std::size_t rows_at_rest_needed_, rows_at_rest_ = 0;
    /* Of the row before. */
    bool was_in_profile_ = false;
    double target_ = 0, approach_ = 0, load_ = 0;
};

} // namespace scenario

#endif
