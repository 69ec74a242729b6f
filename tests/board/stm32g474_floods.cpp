/* Rubbish as fast as a bus of the STM32G474 image carries it: the control interrupt does not
 * notice. */
#include <algorithm>
#include <random>

#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

constexpr std::uint16_t sdo_request = 0x601;
constexpr std::uint8_t read_of_an_object = 0x40;
constexpr std::size_t most_at_once = 50'000; /* of a run: its translated code takes 9 KB a frame */
constexpr std::size_t in_reserve = 200; /* frames that wait for the bus, so that it is never idle */

class Draw
{
  public:
    explicit Draw(unsigned seed) : engine_(seed)
    {
    }
    unsigned below(unsigned count)
    {
        return static_cast<unsigned>(engine_()) % count;
    }

  private:
    std::mt19937 engine_;
};

/* A bus, and what comes on it. */
class Bus
{
  public:
    virtual ~Bus() = default;
    virtual void open(Powered &run)
    {
        (void)run;
    }
    /* Queues one frame behind those before it. */
    virtual void send(Powered &run, Draw &draw) = 0;
    virtual std::size_t waiting(Powered &run) const = 0;
    /* Takes what has been answered. */
    virtual void listen(Powered &run) = 0;
    /* The flood is over. */
    virtual void end(Expectations &expectations, Powered &run, std::size_t frames) = 0;
};

class CanBus final : public Bus
{
  public:
    void send(Powered &run, Draw &draw) override
    {
        (void)run.device.can().send(rubbish(draw));
    }
    std::size_t waiting(Powered &run) const override
    {
        return run.device.can().waiting();
    }
    void listen(Powered &run) override
    {
        (void)run.device.can().take_output();
        (void)run.output();
    }
    void end(Expectations &expectations, Powered &run, std::size_t frames) override
    {
        const Fdcan::Counters &counters = run.device.can().counters;
        std::printf("  %llu received, %llu filtered, %llu answers\n",
                    static_cast<unsigned long long>(counters.received),
                    static_cast<unsigned long long>(counters.filtered),
                    static_cast<unsigned long long>(counters.sent));
        expectations.expect(counters.filtered > frames / 5 && counters.received > frames / 5,
                            "the chip drops what is not for the node, and receives what is");
        expectations.expect(counters.sent > frames / 10 && counters.lost == 0,
                            "the node answers, and the chip loses none");
    }

  private:
    /* Of no use to the node, or a question: nothing that would change what the drive does. */
    static can_frame rubbish(Draw &draw)
    {
        can_frame frame = {static_cast<std::uint16_t>(draw.below(0x800)),
                           static_cast<std::uint8_t>(draw.below(9)),
                           {}};
        for (std::uint8_t &byte : frame.data) {
            byte = static_cast<std::uint8_t>(draw.below(256));
        }
        switch (draw.below(6)) {
        case 0:
            frame.id = sdo_request;
            frame.length = 8;
            break;
        case 1:
            frame.id = sdo_request;
            frame.length = static_cast<std::uint8_t>(draw.below(8));
            break;
        case 2:
            frame.id = 0; /* network management, of any length but its own */
            break;
        case 3:
            frame.id = 0x080;
            break;
        default:
            break;
        }
        if (frame.id == 0 && frame.length == 2) {
            frame.length = 0;
        }
        if (frame.id == sdo_request && frame.length == 8) {
            frame.data[0] = read_of_an_object;
        }
        return frame;
    }
};

/* Frames as text, on the serial line. Some end in LF, which interrupts. */
class SerialLine final : public Bus
{
  public:
    void open(Powered &run) override
    {
        (void)run.type("O\r", 20 * ms);
        received_before_ = run.device.serial_line().counters.received;
    }
    void send(Powered &run, Draw &draw) override
    {
        const std::string line = rubbish(draw) + (draw.below(8) > 0 ? '\r' : '\n');
        sent_ += line.size();
        run.device.serial_line().send(run.machine.now(), line);
    }
    std::size_t waiting(Powered &run) const override
    {
        const std::uint64_t received = run.device.serial_line().counters.received;
        return static_cast<std::size_t>(sent_ + received_before_ - received) / bytes_of_a_frame;
    }
    void listen(Powered &run) override
    {
        answers_ += run.output().size();
    }
    void end(Expectations &expectations, Powered &run, std::size_t frames) override
    {
        std::printf("  %llu bytes sent, %zu answered\n", static_cast<unsigned long long>(sent_),
                    answers_);
        expectations.expect(answers_ > frames / 10, "the node answers meanwhile");
        expectations.expect(run.device.serial_line().counters.overruns == 0,
                            "the chip loses no byte");
        (void)run.type("\rC\r", 300 * ms);
    }

  private:
    static constexpr std::size_t bytes_of_a_frame = 12; /* about */

    static std::string hexadecimal(Draw &draw, unsigned bytes)
    {
        std::string digits;
        for (unsigned i = 0; i < 2 * bytes; i++) {
            digits += "0123456789ABCDEF"[draw.below(16)];
        }
        return digits;
    }

    /* A line: of any bytes, a frame for nobody, one that is cut off, another node's, a question. */
    static std::string rubbish(Draw &draw)
    {
        char id[8];
        std::string line;
        switch (draw.below(5)) {
        case 0:
            for (unsigned left = 1 + draw.below(8); left > 0; left--) {
                line += "tTrRtabcdef0123456789 \a\x7f"[draw.below(24)];
            }
            return line;
        case 1:
            (void)std::snprintf(id, sizeof id, "t%03X0", draw.below(0x800));
            return id;
        case 2:
            return "t601" + hexadecimal(draw, 2);
        case 3:
            (void)std::snprintf(id, sizeof id, "t%03X2", 0x102 + draw.below(0x580 - 0x102));
            return id + hexadecimal(draw, 2);
        default:
            return "t601840" + hexadecimal(draw, 7);
        }
    }

    std::uint64_t sent_ = 0, received_before_ = 0;
    std::size_t answers_ = 0;
};

struct Latencies {
    std::uint64_t latency, cycles;
};

/* Of the control interrupts of so many frames' time, which it sets; without frames, of `time`. */
Latencies flood(Expectations &expectations, const std::string &image, Bus *bus, std::size_t frames,
                unsigned seed, Ticks &time)
{
    Draw draw(seed);
    Powered run(image);
    (void)run.start();
    expectations.expect(run.enable(), "the drive holds the motor");
    if (bus) {
        bus->open(run);
        bus->listen(run);
    }
    const Ticks begin = run.machine.now();
    std::size_t sent = 0;
    while (bus ? sent < frames : run.machine.now() < begin + time) {
        for (; bus && sent < frames && bus->waiting(run) < in_reserve; sent++) {
            bus->send(run, draw);
        }
        run.run_for(5 * ms);
        if (bus) {
            bus->listen(run);
        }
    }
    time = run.machine.now() - begin;
    if (bus) {
        std::printf("  %zu frames in %.1f s\n", frames,
                    static_cast<double>(time) / static_cast<double>(ticks_per_s));
        bus->end(expectations, run, frames);
        (void)run.type("\n", 30 * ms);
    }
    expectations.expect(run.type("state\n", 60 * ms).find("ok operation-enabled") !=
                            std::string::npos,
                        "the drive is in operation");
    expectations.expect(run.machine.resets().empty(), "no reset");
    const InterruptAccount::Summary summary = run.machine.account().summary();
    return {summary.latency.worst, summary.total.worst.worst};
}

template <class Flooded>
void compare_floods(Expectations &expectations, const std::string &image, std::size_t frames)
{
    Ticks time = 0;
    Latencies with = {0, 0};
    for (unsigned piece = 0; piece * most_at_once < frames; piece++) {
        Flooded bus;
        const Latencies more =
            flood(expectations, image, &bus, std::min(frames, most_at_once), piece + 1, time);
        with = {std::max(with.latency, more.latency), std::max(with.cycles, more.cycles)};
    }
    time = std::min(time, 2000 * ms); /* a longer one would not be worse */
    const Latencies without = flood(expectations, image, nullptr, 0, 0, time);
    std::printf(
        "  first instruction %llu cycles behind S(k) at most, %llu without; end %llu, %llu\n",
        static_cast<unsigned long long>(with.latency),
        static_cast<unsigned long long>(without.latency),
        static_cast<unsigned long long>(with.cycles),
        static_cast<unsigned long long>(without.cycles));
    /* As in any run (budget.py): an exception that is entered as the peak comes, which the virtual
       board nests and the chip spares (sil/virtual_board/README.md, late arrival), and what the
       drive's watches do as a whole, flood or not; which peaks they meet is chance. */
    constexpr std::uint64_t jitter_cycles = 170;
    expectations.expect(with.latency <= without.latency + jitter_cycles,
                        "the control interrupt begins as soon as without a flood");
    expectations.expect(with.cycles <= without.cycles, "and takes as many cycles as without");
}

} // namespace

void can_flood(Expectations &expectations, const std::string &image)
{
    compare_floods<CanBus>(expectations, image, 5000);
}

void can_flood_of_a_million(Expectations &expectations, const std::string &image)
{
    compare_floods<CanBus>(expectations, image, 1'000'000);
}

void line_flood(Expectations &expectations, const std::string &image)
{
    compare_floods<SerialLine>(expectations, image, 5000);
}

void line_flood_of_a_million(Expectations &expectations, const std::string &image)
{
    compare_floods<SerialLine>(expectations, image, 1'000'000);
}

} // namespace stm32g474_bench
