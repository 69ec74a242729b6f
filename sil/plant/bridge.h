/*
 * Two H-bridges on one bus: turns the duties of a period into a timetable of the voltages that act
 * on the phases. Knows nothing of the motor: where a leg is in dead time its voltage depends on
 * the sign of the current, so a segment carries the phase voltage for either sign.
 *
 * Time is counted in timer counts from S(k), the counter's peak; a half period is
 * half_period_counts, and leg l is commanded high within half period +- high_counts[l].
 */
#ifndef STEADYSTEP_PLANT_BRIDGE_H
#define STEADYSTEP_PLANT_BRIDGE_H

#include "sil/plant/phases.h"
#include "sil/plant/plant.h"

namespace plant
{

/* What acts on the phases while no switch changes. */
struct BridgeOutput {
    Phases if_positive_V; /* phase voltage while the current is positive, */
    Phases if_negative_V; /* and while negative; above if_positive_V when a leg is in dead time */
    Phases diode_V;       /* sum of the forward drops in the path of the current */
    bool dead_time;       /* some leg is in dead time: the two voltages differ somewhere */
    bool draws;           /* the bus may carry current */

    /* The voltages without the drops. */
    Phases bus_if_positive_V() const
    {
        return if_positive_V + diode_V;
    }
    Phases bus_if_negative_V() const
    {
        return if_negative_V - diode_V;
    }
};

/* A stretch of time in which no switch changes. */
struct Segment {
    double duration_s;
    const BridgeOutput *output;
};

struct Timetable {
    static constexpr int capacity = 40; /* 16 edges, 16 ends of dead time, the period's end */
    Segment segments[capacity];
    int count = 0;

    const Segment *begin() const
    {
        return segments;
    }
    const Segment *end() const
    {
        return segments + count;
    }
};

void require_bridge(const BridgeConfig &config); /* throws std::invalid_argument */

class Bridge
{
  public:
    explicit Bridge(const BridgeConfig &config); /* throws std::invalid_argument */

    /* Bus and diodes from the present S(k) on; the switches stay as they are. */
    void set_levels(double bus_V, double diode_drop_V);

    /* The segments of S(k)...S(k+1) with these duties in force; valid until the next call. */
    const Timetable &period(const Duties &duties);

  private:
    static constexpr int legs = 4;             /* A+, A-, B+, B- */
    static constexpr int max_edges = 4 * legs; /* pending, at the peak, rising, falling */

    /* The states of all legs are the bits of one number, two for each: what is commanded, and
       whether it is in dead time. A phase's current leaves its first leg and enters its second. */
    static constexpr unsigned high = 1, dead = 2, leg_bits = 2, leg_states = 4;
    static constexpr unsigned phase_bits = 2 * leg_bits, phase_states = leg_states * leg_states;
    static constexpr unsigned states = phase_states * phase_states;
    static constexpr unsigned all_low = 0x00, all_dead = 0xaa;

    struct Edge {
        double time; /* counts from S(k) */
        unsigned leg;
        unsigned level; /* high or 0 */
    };
    /* Of a leg: its voltage while current leaves or enters it, and the drop of its diodes. */
    struct LegVoltage {
        double leaves, enters, diode;
    };
    /* Of a phase, as in Segment. */
    struct PhaseVoltage {
        double if_positive_V, if_negative_V, diode_V;
    };

    static PhaseVoltage between(const LegVoltage &first, const LegVoltage &second);
    static BridgeOutput across(const PhaseVoltage &a, const PhaseVoltage &b, bool dead_time);
    void tabulate();
    void off();
    void averaged(const Duties &duties);
    void switched(const Duties &duties);
    int list_edges(const Duties &duties, Edge *edges) const;
    void keep_pending(const Edge *edges, int first, int last);
    void append(double duration_counts, const BridgeOutput &output);

    BridgeConfig config_;
    double count_s_;
    double dead_counts_;
    BridgeOutput table_[states]; /* of each state of all legs */
    BridgeOutput mean_ = {};     /* of a period, averaged */
    unsigned state_ = all_low;
    int latest_edge_[legs] = {0, 0, 0, 0}; /* its index in the period's list */
    Edge pending_[legs]; /* edges of the last period whose dead time reaches into this one */
    int pending_count_ = 0;
    Timetable timetable_;
};

} // namespace plant

#endif
