/*
 * What a scenario needs of a board: a drive in lock-step with a plant, fed by typed lines. Two
 * boards are of this kind: sil::Board, whose firmware is compiled for this machine, and the virtual
 * board, which executes the image of a real one.
 */
#ifndef STEADYSTEP_DRIVE_BOARD_H
#define STEADYSTEP_DRIVE_BOARD_H

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/interface/drive_interface.h"
#include "hal/hal.h"
#include "sil/plant/plant.h"

namespace sil
{

/* Of the reference board (hal/stm32g474: pin map, board.h): trip of its comparators in full scales
   of its current sensing, 7.0 A of 6, and the share of a period that its deadline guard leaves the
   control interrupt. The comparators see the shunts an eighth as large as the converters, and trip
   beyond code 555 of theirs: (8 x 555 - 2048) of 2048 codes. */
constexpr double comparator_trip_share = (8.0 * 555.0 - 2048.0) / 2048.0;
constexpr double control_deadline_share = 0.9;

inline double comparator_trip_A(double current_range_A)
{
    return comparator_trip_share * current_range_A;
}

class DriveBoard
{
  public:
    virtual ~DriveBoard() = default;

    /* Bytes for the drive's serial line. The last one arrives in the period of the coming
       control(): after that period's S(k), before the next one. */
    virtual void send(const std::string &bytes) = 0;
    /* A line, given without its end. */
    void type(const std::string &line)
    {
        send(line + '\n');
    }

    /* Another node of the drive's CAN bus: a frame that it sends as soon as the bus is free, false:
       too many wait, or the board has no bus; those it has received since the last call. */
    virtual bool send_frame(const can_frame &frame)
    {
        static_cast<void>(frame);
        return false;
    }
    virtual std::vector<can_frame> take_frames()
    {
        return {};
    }

    /* The supply fails and returns: the drive starts again, bridge off, with the parameter store as
       it was, while rotor and encoder go on. The coming control() is that of period 0. */
    virtual void power_cycle() = 0;

    /* Faults from outside, in the period of the coming control(). The current of a leg's shunt,
       0...3: A+, A-, B+, B-, towards ground: beyond the comparator's trip it opens the bridge 60 us
       behind S(k), whatever the firmware does. */
    virtual void short_circuit(int leg, double current_A) = 0;
    /* Something holds the control interrupt up, its samples read, until then behind S(k): beyond
       the deadline the bridge opens before the period is over. On a board whose interrupt
       takes time its rest follows, and counts. */
    virtual void stall_control_interrupt(double until_s) = 0;

    /* Levels of the machine's inputs from the coming control() on, HAL_INPUT_..., and of its
       outputs. All inputs are high until then. */
    virtual void put_inputs(std::uint32_t levels) = 0;
    virtual std::uint32_t machine_outputs() const = 0;

    /* One PWM period: the control interrupt with the samples of the present S(k); signals() and
       plant().state() then both belong to S(k) until advance() takes the plant to S(k+1). */
    virtual void control() = 0;
    virtual void advance() = 0;

    virtual const drive_signals &signals() const = 0; /* after control(): of S(k) */
    virtual std::uint64_t drive_hash() const = 0;     /* power cycles: the sum over the starts */
    virtual plant::Plant &plant() = 0;
    virtual const hal_facts &facts() const = 0;

    /* What the drive has written on its serial line since the last call. */
    virtual std::string take_output() = 0;
};

} // namespace sil

#endif
