#include "sil/virtual_board/board_facts.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "firmware/interface/simulation_only.h"
#include "sil/plant/sensors.h"

namespace virtual_board
{

namespace
{

/* Of the image with the reference wiring: hal/stm32g474/pin_maps/nucleo_g474re.h, board.h. */
constexpr double dead_time_s = 1e-6, leg_delay_s = 20e-9, low_state_s = 4e-6;
constexpr double counts_per_s = 170e6;
constexpr double current_A_per_code = 12.0 / 4096, bus_V_per_code = 31.2 / 4096;
constexpr double phase_voltage_V_per_code = 62.4 / 4096, current_offset_codes = 4;

double period_s(int half_period_counts)
{
    return 2.0 * half_period_counts / counts_per_s;
}

[[noreturn]] void refuse(const char *key, const std::string &given, const std::string &image)
{
    throw std::invalid_argument(std::string(key) + ": " + given + "; the image has " + image);
}

std::string text(double value)
{
    char digits[32];
    std::snprintf(digits, sizeof digits, "%g", value);
    return digits;
}

void require(const char *key, double given, double image)
{
    if (std::fabs(given - image) > 1e-9 * std::fabs(image)) {
        refuse(key, text(given), text(image));
    }
}

} // namespace

hal_facts facts_of(const plant::Config &config, int half_period_counts)
{
    hal_facts facts = {};
    facts.board_name = "virtual board";
    facts.control_period_s = period_s(half_period_counts);
    facts.pwm_half_period_counts = static_cast<std::uint32_t>(half_period_counts);
    facts.dead_time_s = dead_time_s;
    facts.leg_delay_s = leg_delay_s;
    facts.low_state_s = low_state_s;
    facts.converter_codes = 4096;
    facts.current_A_per_code = current_A_per_code;
    facts.current_zero_code = 2048;
    facts.current_offset_codes = current_offset_codes;
    facts.bus_V_per_code = bus_V_per_code;
    facts.phase_voltage_V_per_code = phase_voltage_V_per_code;
    facts.bridge_ntc_beta_K = 3435.0;
    facts.has_phase_voltages = true;
    facts.has_brake = true;
    facts.encoder_counts_per_turn =
        static_cast<std::uint32_t>(config.sensors.encoder_counts_per_turn);
    facts.has_encoder_index = true;
    facts.cycle_counter_Hz = 170'000'000;
    facts.parameter_page_bytes = 2048;
    facts.parameter_word_bytes = 8;
    return facts;
}

void require_image_facts(const plant::Config &config, const ImageMap &image,
                         const std::string &numeric)
{
    if (numeric != image.numeric) {
        refuse("numeric", numeric, image.numeric);
    }
    const plant::BridgeConfig &bridge = config.bridge;
    if (bridge.model != plant::BridgeModel::switched) {
        refuse("plant.bridge", "averaged", "switched");
    }
    require("plant.period_s", bridge.period_s, period_s(image.half_period_counts));
    require("plant.half_period_counts", bridge.half_period_counts, image.half_period_counts);
    require("plant.dead_time_s", bridge.dead_time_s, dead_time_s);
    require("plant.low_state_s", config.sensors.low_state_s, low_state_s);
    require("plant.delay_periods", bridge.delay_periods, 1);
    if (config.sensors.exact) {
        refuse("plant.exact_sensors", "true", "codes of 12 bits");
    }
    require("plant.current_range_A", plant::current_A_per_code(config.sensors), current_A_per_code);
    require("plant.phase_voltage_range_V", plant::phase_voltage_V_per_code(config.sensors),
            phase_voltage_V_per_code);
    require("plant.bus_range_V", plant::bus_V_per_code(config.sensors), bus_V_per_code);
}

void require_image_settings(const drive_settings &settings)
{
    if (const char *setting = simulation_only_setting(&settings)) {
        throw std::invalid_argument(std::string("drive: ") + setting +
                                    ": for simulation, images have nothing of that");
    }
}

} // namespace virtual_board
