/* The CAN bus of the STM32G474 image: what it writes to FDCAN3, errors up to bus-off. */
#include <algorithm>
#include <cmath>

#include "tests/board/stm32g474_bench.h"

namespace stm32g474_bench
{

namespace
{

constexpr std::uint32_t FDCAN_NBTP = 0x1c, FDCAN_RXGFC = 0x80;
constexpr std::uint16_t boot_up = 0x701, emergency = 0x081, request = 0x601, response = 0x581;
constexpr double kernel_Hz = 170e6;

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
