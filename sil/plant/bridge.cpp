#include "sil/plant/bridge.h"

#include "sil/plant/require.h"

namespace plant
{

void require_bridge(const BridgeConfig &config)
{
    require(config.bus_V > 0.0 && config.bus_V <= 1000.0, "bus_V", config.bus_V, "0...1000 V");
    require(config.period_s >= 1e-7 && config.period_s <= 1e-2, "period_s", config.period_s,
            "1e-7...0.01 s");
    require(config.half_period_counts >= 1 && config.half_period_counts <= 65535,
            "half_period_counts", config.half_period_counts, "1...65535");
    const bool dead_time_fits = config.model == BridgeModel::averaged || /* has none */
                                config.dead_time_s < 0.5 * config.period_s;
    require(config.dead_time_s >= 0.0 && dead_time_fits, "dead_time_s", config.dead_time_s,
            "0 to half a period");
    require(config.diode_drop_V >= 0.0 && config.diode_drop_V <= 10.0, "diode_drop_V",
            config.diode_drop_V, "0...10 V");
    require(config.delay_periods == 0 || config.delay_periods == 1, "delay_periods",
            config.delay_periods, "0 or 1");
}

Bridge::Bridge(const BridgeConfig &config) : config_(config)
{
    require_bridge(config);
    count_s_ = config.period_s / (2.0 * config.half_period_counts);
    dead_counts_ = config.dead_time_s / count_s_;
    /* A dead time of whole counts lets coinciding edges coincide in spite of rounding. */
    const double whole = static_cast<double>(static_cast<int>(dead_counts_ + 0.5));
    if (magnitude(dead_counts_ - whole) < 1e-6) {
        dead_counts_ = whole;
    }

    set_voltages();
    for (Leg &leg : legs_) {
        leg = {low_, false, false, 0};
    }
}

/* In dead time the lower diode carries a current that leaves the leg, the upper one that enters
   it. */
void Bridge::set_voltages()
{
    low_ = {0.0, 0.0, 0.0};
    high_ = {config_.bus_V, config_.bus_V, 0.0};
    dead_ = {-config_.diode_drop_V, config_.bus_V + config_.diode_drop_V, config_.diode_drop_V};
}

void Bridge::set_levels(double bus_V, double diode_drop_V)
{
    config_.bus_V = bus_V;
    config_.diode_drop_V = diode_drop_V;
    require_bridge(config_);
    set_voltages();
    for (Leg &leg : legs_) {
        leg.voltage_V = leg.dead ? dead_ : (leg.commanded_high ? high_ : low_);
    }
}

const Timetable &Bridge::period(const Duties &duties)
{
    timetable_.count = 0;
    if (!duties.bridge_on) {
        off();
    } else if (config_.model == BridgeModel::averaged) {
        averaged(duties);
    } else {
        switched(duties);
    }
    return timetable_;
}

/* All gates off: every leg in dead time for ever. */
void Bridge::off()
{
    for (Leg &leg : legs_) {
        leg.voltage_V = dead_;
    }
    dead_legs_ = legs;
    append(2.0 * config_.half_period_counts);
    for (Leg &leg : legs_) {
        leg = {low_, false, false, 0}; /* once allowed, the low switches turn on at once */
    }
    dead_legs_ = 0;
    pending_count_ = 0;
}

void Bridge::averaged(const Duties &duties)
{
    const double V_per_count = config_.bus_V / config_.half_period_counts;
    for (int leg = 0; leg < legs; leg++) {
        const double mean_V = V_per_count * duties.high_counts[leg];
        legs_[leg].voltage_V = {mean_V, mean_V, 0.0};
    }
    append(2.0 * config_.half_period_counts);
}

void Bridge::switched(const Duties &duties)
{
    const double end = 2.0 * config_.half_period_counts;
    const double never = 4.0 * end;
    Edge edges[max_edges + 1];
    const int count = list_edges(duties, edges);
    edges[count].time = never;

    /* Two queues in one list: the edges, and the ends of their dead times. */
    int issued = pending_count_;
    int ended = 0;
    double now = 0.0;
    for (;;) {
        const double next_edge = edges[issued].time;
        const double next_end = ended < issued ? edges[ended].time + dead_counts_ : never;
        const double next = next_end <= next_edge ? next_end : next_edge;
        if (next >= end) {
            break;
        }
        if (next > now) {
            append(next - now);
            now = next;
        }
        if (next_end <= next_edge) {
            Leg &leg = legs_[edges[ended].leg];
            if (leg.latest_edge == ended) { /* a later edge restarts the dead time */
                end_dead_time(leg);
            }
            ended++;
        } else {
            Leg &leg = legs_[edges[issued].leg];
            leg.commanded_high = edges[issued].high;
            leg.latest_edge = issued;
            start_dead_time(leg);
            issued++;
        }
    }
    append(end - now);

    pending_count_ = 0;
    for (; ended < issued; ended++) {
        Leg &leg = legs_[edges[ended].leg];
        if (leg.latest_edge == ended) {
            leg.latest_edge = pending_count_;
            pending_[pending_count_] = edges[ended];
            pending_[pending_count_].time -= end;
            pending_count_++;
        }
    }
}

/* The pending edges, then this period's edges, in order of time. */
int Bridge::list_edges(const Duties &duties, Edge *edges) const
{
    const int half = config_.half_period_counts;
    int high_counts[legs];
    int order[legs]; /* longest high first */
    for (int leg = 0; leg < legs; leg++) {
        high_counts[leg] = duties.high_counts[leg] < half ? duties.high_counts[leg] : half;
        int place = leg;
        for (; place > 0 && high_counts[order[place - 1]] < high_counts[leg]; place--) {
            order[place] = order[place - 1];
        }
        order[place] = leg;
    }

    int count = 0;
    for (; count < pending_count_; count++) {
        edges[count] = pending_[count];
    }
    for (int leg = 0; leg < legs; leg++) {
        const bool full = high_counts[leg] == half; /* high all through: no edge at the peak */
        if (full != legs_[leg].commanded_high) {
            edges[count++] = {0.0, leg, full};
        }
    }
    for (int place = 0; place < legs; place++) {
        const int leg = order[place];
        if (high_counts[leg] > 0 && high_counts[leg] < half) {
            edges[count++] = {static_cast<double>(half - high_counts[leg]), leg, true};
        }
    }
    for (int place = legs - 1; place >= 0; place--) {
        const int leg = order[place];
        if (high_counts[leg] > 0 && high_counts[leg] < half) {
            edges[count++] = {static_cast<double>(half + high_counts[leg]), leg, false};
        }
    }
    return count;
}

void Bridge::start_dead_time(Leg &leg)
{
    dead_legs_ += leg.dead ? 0 : 1;
    leg.voltage_V = dead_;
    leg.dead = true;
}

void Bridge::end_dead_time(Leg &leg)
{
    dead_legs_--;
    leg.dead = false;
    leg.voltage_V = leg.commanded_high ? high_ : low_;
}

void Bridge::append(double duration_counts)
{
    const LegVoltage &a_plus = legs_[0].voltage_V, &a_minus = legs_[1].voltage_V;
    const LegVoltage &b_plus = legs_[2].voltage_V, &b_minus = legs_[3].voltage_V;
    Segment &segment = timetable_.segments[timetable_.count++];
    segment.duration_s = duration_counts * count_s_;
    segment.if_positive_V = Phases{a_plus.leaves - a_minus.enters, b_plus.leaves - b_minus.enters};
    segment.if_negative_V = Phases{a_plus.enters - a_minus.leaves, b_plus.enters - b_minus.leaves};
    segment.diode_V = Phases{a_plus.diode + a_minus.diode, b_plus.diode + b_minus.diode};
    segment.dead_time = dead_legs_ > 0;
}

} // namespace plant
