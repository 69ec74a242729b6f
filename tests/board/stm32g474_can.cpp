/* The CAN bus of the STM32G474 image: what it writes to FDCAN3, a flood, errors up to bus-off. */
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

constexpr std::uint32_t FDCAN_NBTP = 0x1c, FDCAN_RXGFC = 0x80;
constexpr std::uint16_t boot_up = 0x701, emergency = 0x081, request = 0x601, response = 0x581;
constexpr double kernel_Hz = 170e6;
constexpr std::size_t most_at_once = 50'000; /* of a run: its translated code takes 9 KB a frame */
constexpr std::size_t in_reserve = 200; /* frames that wait for the bus, so that it is never idle */

std::string text(const can_frame &frame)
{
    char line[32];
    int length = std::snprintf(line, sizeof line, "%03x ", frame.id);
    for (unsigned i = 0; i < frame.length; i++) {
        length += std::snprintf(line + length, sizeof line - static_cast<std::size_t>(length),
                                "%02x", frame.data[i]);
    }
    return line;
}

/* What the node has sent since the last call, a line each. */
std::string heard(Powered &run)
{
    std::string lines;
    for (const can_frame &frame : run.device.can().take_output()) {
        lines += text(frame) + '\n';
    }
    return lines;
}

can_frame frame_of(std::uint16_t id, std::initializer_list<unsigned> bytes)
{
    can_frame frame = {id, static_cast<std::uint8_t>(bytes.size()), {}};
    std::transform(bytes.begin(), bytes.end(), frame.data,
                   [](unsigned byte) { return static_cast<std::uint8_t>(byte); });
    return frame;
}

/* Writes an object of `bytes` bytes; whether that is confirmed. */
bool put(Powered &run, unsigned index, unsigned bytes, unsigned value)
{
    (void)run.device.can().send(
        frame_of(request, {0x23u | (4 - bytes) << 2, index & 255, index >> 8, 0, value & 255,
                           value >> 8 & 255, value >> 16 & 255, value >> 24}));
    run.run_for(3 * ms);
    return heard(run).find(text({response, 1, {0x60}})) != std::string::npos;
}

/* As a master does it, in profile velocity: at a turn in a second. */
bool enable_by_bus(Powered &run)
{
    bool confirmed = put(run, 0x6060, 1, 3) && put(run, 0x6040, 2, 6) && put(run, 0x6040, 2, 7);
    run.run_for(600 * ms);
    confirmed = confirmed && put(run, 0x6040, 2, 15) && put(run, 0x60ff, 4, 65536);
    run.run_for(100 * ms);
    return confirmed;
}

double speed(Powered &run)
{
    return run.device.power_stage().plant().state().omega_rad_s;
}

/* Of no use to the node, or a question: nothing that would change what the drive does. */
can_frame rubbish(std::mt19937 &draw)
{
    const auto any = [&draw](unsigned count) { return draw() % count; };
    can_frame frame = {
        static_cast<std::uint16_t>(any(0x800)), static_cast<std::uint8_t>(any(9)), {}};
    for (std::uint8_t &byte : frame.data) {
        byte = static_cast<std::uint8_t>(any(256));
    }
    switch (any(6)) {
    case 0:
        frame.id = request;
        frame.length = 8;
        frame.data[0] = 0x40; /* reads some object */
        break;
    case 1:
        frame.id = request;
        frame.length = static_cast<std::uint8_t>(any(8));
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
    if (frame.id == request && frame.length == 8) {
        frame.data[0] = 0x40;
    }
    return frame;
}

struct Latencies {
    std::uint64_t latency, cycles;
};

/* Of the control interrupts of so many frames' time: without frames, if `flooded` is false. */
Latencies flood(Expectations &expectations, const std::string &image, std::size_t frames,
                unsigned seed, Ticks &time, bool flooded)
{
    std::mt19937 draw(seed);
    Powered run(image);
    (void)run.start();
    expectations.expect(run.enable(), "the drive holds the motor");
    (void)heard(run);
    const Ticks begin = run.machine.now();
    std::size_t sent = 0;
    while (flooded ? sent < frames : run.machine.now() < begin + time) {
        for (; flooded && sent < frames && run.device.can().waiting() < in_reserve; sent++) {
            (void)run.device.can().send(rubbish(draw));
        }
        run.run_for(5 * ms);
        (void)run.device.can().take_output();
        (void)run.output();
    }
    time = run.machine.now() - begin;
    if (flooded) {
        const Fdcan::Counters &counters = run.device.can().counters;
        const double busy_s = static_cast<double>(time) / static_cast<double>(ticks_per_s);
        std::printf("  %zu frames in %.1f s: %llu received, %llu filtered, %llu answers\n", frames,
                    busy_s, static_cast<unsigned long long>(counters.received),
                    static_cast<unsigned long long>(counters.filtered),
                    static_cast<unsigned long long>(counters.sent));
        expectations.expect(counters.filtered > frames / 5 && counters.received > frames / 5,
                            "the chip drops what is not for the node, and receives what is");
        expectations.expect(counters.sent > frames / 10 && counters.lost == 0,
                            "the node answers, and the chip loses none");
        (void)run.type("\n", 30 * ms);
    }
    expectations.expect(run.type("state\n", 60 * ms).find("ok operation-enabled") !=
                            std::string::npos,
                        "the drive is in operation");
    expectations.expect(run.machine.resets().empty(), "no reset");
    const InterruptAccount::Summary summary = run.machine.account().summary();
    return {summary.latency.worst, summary.total.worst.worst};
}

void compare_floods(Expectations &expectations, const std::string &image, std::size_t frames)
{
    Ticks time = 0;
    Latencies with = {0, 0};
    for (unsigned piece = 0; piece * most_at_once < frames; piece++) {
        const Latencies more =
            flood(expectations, image, std::min(frames, most_at_once), piece + 1, time, true);
        with = {std::max(with.latency, more.latency), std::max(with.cycles, more.cycles)};
    }
    time = std::min(time, 2000 * ms); /* a longer one would not be worse */
    const Latencies without = flood(expectations, image, frames, 0, time, false);
    std::printf(
        "  first instruction %llu cycles behind S(k) at most, %llu without; end %llu, %llu\n",
        static_cast<unsigned long long>(with.latency),
        static_cast<unsigned long long>(without.latency),
        static_cast<unsigned long long>(with.cycles),
        static_cast<unsigned long long>(without.cycles));
    /* An exception that is entered as the peak comes, which the virtual board nests and the chip
       spares (sil/virtual_board/README.md, late arrival), and an instruction of the background. */
    constexpr std::uint64_t entry_cycles = 29, instruction_cycles = 12;
    expectations.expect(with.latency <= without.latency + entry_cycles + instruction_cycles,
                        "the control interrupt begins as soon as without a flood");
    expectations.expect(with.cycles <= without.cycles, "and takes as many cycles as without");
}

} // namespace

void can_registers(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    const Fdcan &can = run.device.can();
    /* RM0440: fields hold a value less one, the first quantum is in none of them. */
    const std::uint32_t nbtp = can.kept(FDCAN_NBTP);
    const double prescaler = field(nbtp, 16, 9) + 1, before = field(nbtp, 8, 8) + 2,
                 behind = field(nbtp, 0, 7) + 1, jump = field(nbtp, 25, 7) + 1;
    std::printf("  NBTP %08x: %g quanta, sample point %.1f %%, jump %g\n",
                static_cast<unsigned>(nbtp), before + behind, 100 * before / (before + behind),
                jump);
    expectations.expect(kernel_Hz / (prescaler * (before + behind)) == 500e3,
                        "500 kbit/s, exactly");
    expectations.expect(before / (before + behind) >= 0.85 && before / (before + behind) <= 0.875,
                        "sampled at 85...87.5 % of a bit");
    expectations.expect(jump <= behind && jump >= 4, "the jump fits segment 2");
    expectations.expect(field(can.kept(FDCAN_RXGFC), 4, 2) >= 2 &&
                            field(can.kept(FDCAN_RXGFC), 2, 2) >= 2 &&
                            (can.kept(FDCAN_RXGFC) & 3u) == 3u,
                        "what no filter names, remote and extended frames are rejected");
    run.run_for(10 * ms);
    expectations.expect(heard(run) == text({boot_up, 1, {0}}) + '\n', "boot-up, and nothing else");
}

void can_flood(Expectations &expectations, const std::string &image)
{
    compare_floods(expectations, image, 5000);
}

void can_flood_of_a_million(Expectations &expectations, const std::string &image)
{
    compare_floods(expectations, image, 1'000'000);
}

/* A master commands the drive; then what the node sends is destroyed. */
void can_bus_off(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    run.run_for(10 * ms);
    expectations.expect(enable_by_bus(run) && run.bridge_on() && speed(run) > 3.0,
                        "a master turns the motor");
    expectations.expect(put(run, 0x1017, 2, 2), "the node has a heartbeat");
    run.device.can().disturb(~0u);
    run.run_for(100 * ms);
    expectations.expect(run.device.can().counters.bus_offs == 1, "its frames end in bus-off");
    run.run_for(200 * ms);
    expectations.expect(!run.bridge_on() && std::fabs(speed(run)) < 1.0,
                        "the drive has stopped, and is off");
    expectations.expect(heard(run).empty(), "nobody hears of it so far");
    run.run_for(3000 * ms);
    std::printf("  %llu times bus-off in 3.3 s\n",
                static_cast<unsigned long long>(run.device.can().counters.bus_offs));
    expectations.expect(run.device.can().counters.bus_offs >= 3 &&
                            run.device.can().counters.bus_offs <= 5,
                        "once in a second it tries to come back");
    run.device.can().disturb(0);
    run.run_for(1100 * ms);
    const std::string back = heard(run);
    expectations.expect(back.find("081 40811100") == 0, "then it says that it is back, first");
    expectations.expect(count(back, "081 0000") == 1 && count(back, "701 7f") > 5,
                        "that nothing is wrong any more, and beats");
    expectations.expect(enable_by_bus(run) && run.bridge_on(), "the master has the drive again");
    expectations.expect(count(run.type("disable\n", 20 * ms), "ok disable") == 1 &&
                            run.machine.resets().empty(),
                        "the console is there, too");
}

void can_without_another_node(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    run.device.can().acknowledge(false);
    (void)run.start();
    run.run_for(200 * ms);
    expectations.expect(heard(run).empty() && run.device.can().counters.bus_offs == 0,
                        "a node that is alone sends on, and does not leave the bus");
    expectations.expect(run.enable(), "the console's drive does not mind");
    run.device.can().acknowledge(true);
    run.run_for(20 * ms);
    const std::string said = heard(run);
    expectations.expect(said.find("701 00\n081 2081") == 0,
                        "who comes hears its boot-up, and that it was error passive");
    for (int i = 0; i < 40; i++) {
        (void)put(run, 0x1017, 2, 0);
    }
    (void)run.device.can().send(frame_of(request, {0x40, 0x01, 0x10, 0, 0, 0, 0, 0}));
    run.run_for(5 * ms);
    expectations.expect(heard(run).find("581 4f01100000") == 0,
                        "with frames that succeed it is over");
}

/* More than there is room for, while the background designs the drive anew. */
void can_overrun(Expectations &expectations, const std::string &image)
{
    Powered run(image);
    (void)run.start();
    run.run_for(1100 * ms);
    (void)heard(run);
    (void)run.type("set inertia_kgm2 3e-4\n", 30 * ms);
    for (int i = 0; i < 250; i++) {
        (void)run.device.can().send(frame_of(0x000, {}));
    }
    (void)run.type("enable\n", 100 * ms);
    expectations.expect(run.device.can().counters.lost == 0, "the chip itself loses none");
    expectations.expect(count(heard(run), "081 1081") == 1,
                        "the node says, once, that some are lost");
    expectations.expect(put(run, 0x1017, 2, 0), "and goes on");
}

} // namespace stm32g474_bench
