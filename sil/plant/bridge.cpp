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

    tabulate();
}

Bridge::PhaseVoltage Bridge::between(const LegVoltage &first, const LegVoltage &second)
{
    return {first.leaves - second.enters, first.enters - second.leaves, first.diode + second.diode};
}

BridgeOutput Bridge::across(const PhaseVoltage &a, const PhaseVoltage &b, bool dead_time)
{
    const bool draws = dead_time || a.if_positive_V != 0.0 || b.if_positive_V != 0.0;
    return {Phases{a.if_positive_V, b.if_positive_V}, Phases{a.if_negative_V, b.if_negative_V},
            Phases{a.diode_V, b.diode_V}, dead_time, draws};
}

/* In dead time the lower diode carries a current that leaves the leg, the upper one that enters
   it. */
void Bridge::tabulate()
{
    const double bus_V = config_.bus_V, drop_V = config_.diode_drop_V;
    const LegVoltage on_low = {0.0, 0.0, 0.0}, on_high = {bus_V, bus_V, 0.0};
    const LegVoltage in_dead_time = {-drop_V, bus_V + drop_V, drop_V};
    const LegVoltage of_leg[leg_states] = {on_low, on_high, in_dead_time, in_dead_time};
    PhaseVoltage of_phase[phase_states];
    for (unsigned state = 0; state < phase_states; state++) {
        of_phase[state] = between(of_leg[state % leg_states], of_leg[state / leg_states]);
    }
    for (unsigned state = 0; state < states; state++) {
        table_[state] = across(of_phase[state % phase_states], of_phase[state / phase_states],
                               (state & all_dead) != 0);
    }
}

void Bridge::set_levels(double bus_V, double diode_drop_V)
{
    config_.bus_V = bus_V;
    config_.diode_drop_V = diode_drop_V;
    require_bridge(config_);
    tabulate();
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

/* All gates off: every leg in dead time for ever. Once allowed, the low switches turn on at once.
 */
void Bridge::off()
{
    append(2.0 * config_.half_period_counts, table_[all_dead]);
    state_ = all_low;
    pending_count_ = 0;
}

void Bridge::averaged(const Duties &duties)
{
    const double V_per_count = config_.bus_V / config_.half_period_counts;
    LegVoltage mean[legs];
    for (int leg = 0; leg < legs; leg++) {
        const double mean_V = V_per_count * duties.high_counts[leg];
        mean[leg] = {mean_V, mean_V, 0.0};
    }
    mean_ = across(between(mean[0], mean[1]), between(mean[2], mean[3]), false);
    append(2.0 * config_.half_period_counts, mean_);
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
    unsigned state = state_;
    double now = 0.0;
    for (;;) {
        const double next_edge = edges[issued].time;
        const double next_end = ended < issued ? edges[ended].time + dead_counts_ : never;
        const bool ends = next_end <= next_edge;
        const double next = ends ? next_end : next_edge;
        if (next >= end) {
            break;
        }
        if (next > now) {
            append(next - now, table_[state]);
            now = next;
        }
        if (ends) {
            const Edge &edge = edges[ended];
            if (latest_edge_[edge.leg] == ended) { /* a later edge restarts the dead time */
                state &= ~(dead << (leg_bits * edge.leg));
            }
            ended++;
        } else {
            const Edge &edge = edges[issued];
            const unsigned place = leg_bits * edge.leg;
            latest_edge_[edge.leg] = issued;
            state = (state & ~(high << place)) | ((edge.level | dead) << place);
            issued++;
        }
    }
    append(end - now, table_[state]);
    state_ = state;
    keep_pending(edges, ended, issued);
}

/* The edges first...last - 1, as seen from the next period, where their dead time ends. */
void Bridge::keep_pending(const Edge *edges, int first, int last)
{
    pending_count_ = 0;
    for (int edge = first; edge < last; edge++) {
        int &latest = latest_edge_[edges[edge].leg];
        if (latest == edge) {
            latest = pending_count_;
            pending_[pending_count_] = edges[edge];
            pending_[pending_count_].time -= 2.0 * config_.half_period_counts;
            pending_count_++;
        }
    }
}

/* The pending edges, then this period's edges, in order of time. */
int Bridge::list_edges(const Duties &duties, Edge *edges) const
{
    const int half = config_.half_period_counts;
    int count = 0;
    for (; count < pending_count_; count++) {
        edges[count] = pending_[count];
    }

    struct Pulse {
        int high_counts;
        unsigned leg;
    } pulses[legs]; /* longest first */
    int pulse_count = 0;
    for (unsigned leg = 0; leg < legs; leg++) {
        const int high_counts = duties.high_counts[leg];
        const unsigned full = high_counts >= half; /* high all through: no edge at the peak */
        if (full != ((state_ >> (leg_bits * leg)) & high)) {
            edges[count++] = {0.0, leg, full};
        }
        if (high_counts > 0 && high_counts < half) {
            int place = pulse_count++;
            for (; place > 0 && pulses[place - 1].high_counts < high_counts; place--) {
                pulses[place] = pulses[place - 1];
            }
            pulses[place] = {high_counts, leg};
        }
    }
    for (int n = 0; n < pulse_count; n++) {
        edges[count++] = {static_cast<double>(half - pulses[n].high_counts), pulses[n].leg, high};
    }
    for (int n = pulse_count - 1; n >= 0; n--) {
        edges[count++] = {static_cast<double>(half + pulses[n].high_counts), pulses[n].leg, 0};
    }
    return count;
}

void Bridge::append(double duration_counts, const BridgeOutput &output)
{
    timetable_.segments[timetable_.count++] = {duration_counts * count_s_, &output};
}

} // namespace plant
