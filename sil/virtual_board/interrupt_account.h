/*
 * What the control interrupt costs: cycles by column and stage. Largest and least are of every
 * interrupt, means of those in which the drive controls: periods without a voltage cost a tenth.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_INTERRUPT_ACCOUNT_H
#define STEADYSTEP_VIRTUAL_BOARD_INTERRUPT_ACCOUNT_H

#include <cstdint>
#include <string>
#include <vector>

#include "sil/virtual_board/instruction_costs.h"

namespace virtual_board
{

struct Figures {
    double mean = 0;
    std::uint64_t least = 0, worst = 0;
    std::uint64_t p999 = 0; /* 99.9 % of the values are not above it */
};

/* Counts of whole values, all of them. */
class Distribution
{
  public:
    void add(std::uint64_t value);
    Figures figures() const;

  private:
    std::vector<std::uint32_t> counts_;
    std::uint64_t values_ = 0;
};

/* The same, with the mean of some of the values: 0 if there is none. */
class DistributionInControl
{
  public:
    void add(std::uint64_t value, bool controls);
    Figures figures() const;

  private:
    Distribution all_;
    std::uint64_t sum_ = 0, values_ = 0; /* of the periods in which the drive controls */
};

/* The same in each column of cycles. */
struct CycleFigures {
    Figures nominal, worst, flash;
};

class InterruptAccount
{
  public:
    void set_stages(const std::vector<std::string> &names);

    /* Entry, cycles of its instructions, return; the cycles of both ends are added as the others.
       latency: core cycles from the converter's trigger to the first instruction. */
    void begin();
    void add(unsigned stage, const Cycles &cycles)
    {
        present_[stage] += cycles;
    }
    /* Nominal cycles of an exception that has interrupted it. */
    void add_preempting(std::uint32_t cycles)
    {
        preempting_cycles_ += cycles;
    }
    void count_preemption()
    {
        ++preemptions_;
    }
    void count_outside_fast_code()
    {
        ++outside_now_;
    }
    /* What the present interrupt executes may lie in slower memory. */
    void excuse_place()
    {
        excused_ = true;
    }
    void latency(std::uint64_t cycles)
    {
        latency_.add(cycles);
    }
    void end();

    struct Summary {
        std::uint64_t interrupts = 0;
        std::uint64_t in_control = 0; /* of them; those that the means are of */
        CycleFigures total;
        std::vector<std::string> stage_names;
        std::vector<CycleFigures> stages;
        Figures latency; /* core cycles from S(k) to the first instruction */
        std::uint64_t preemptions = 0, preempting_cycles = 0;
        std::uint64_t outside_fast_code = 0; /* its blocks executed from slower memory */
    };
    Summary summary() const;

  private:
    struct Column {
        DistributionInControl nominal, worst, flash;

        void add(const Cycles &cycles, bool controls);
        CycleFigures figures() const;
    };

    /* Whether the present one has run the position law or the hold. */
    bool controls() const;

    std::vector<std::string> names_;
    std::size_t control_ = 0; /* that stage; beyond the last: the image does not name it */
    std::vector<Cycles> present_;
    Column total_;
    std::vector<Column> stages_;
    Distribution latency_;
    std::uint64_t interrupts_ = 0, in_control_ = 0, preemptions_ = 0, preempting_cycles_ = 0;
    std::uint64_t outside_fast_code_ = 0, outside_now_ = 0;
    bool excused_ = false;
};

} // namespace virtual_board

#endif
