#include "sil/scenario/dictionary_json.h"

#include <nlohmann/json.hpp>

#include "firmware/interface/dictionary.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

using Json = nlohmann::ordered_json;

/* Where a person looks for a setting: by the first index of each group. */
struct Group {
    unsigned first;
    const char *name;
};

constexpr Group groups[] = {
    {0x2001, "Motor"},
    {0x2009, "Encoder and observer"},
    {0x2100, "Feedback and law"},
    {0x2110, "Control"},
    {0x2120, "Limits"},
    {0x2125, "Link"},
    {0x2130, "Encoder and observer"},
    {0x2140, "Enabling and hold"},
    {0x2150, "Heat and brake"},
    {0x2180, "Control"},
};

const char *group_of(const setting &row)
{
    const char *name = "Other";
    for (const Group &group : groups) {
        if (group.first <= row.index) {
            name = group.name;
        }
    }
    return name;
}

/* {"rated": 2} of the motor's rated current, or a number. */
Json bound(double value, unsigned base)
{
    return base == SETTING_RATED ? Json{{"rated", value}} : Json(value);
}

Json preset_of(const setting &row)
{
    if (setting_is_of_motor(&row) || row.preset_base == SETTING_FOLLOWS ||
        row.preset_base == SETTING_COMPUTED) {
        return nullptr;
    }
    return bound(row.preset, row.preset_base);
}

Json json_of(const setting &row)
{
    const char *const types[] = {"choice", "flag", "real", "count"}; /* of enum setting_type */
    Json json = {{"name", row.name},
                 {"index", row.index},
                 {"elements", row.count},
                 {"type", types[row.type]},
                 {"unit", row.unit},
                 {"group", group_of(row)},
                 {"least", bound(row.least, row.least_base)},
                 {"most", bound(row.most, row.most_base)},
                 {"default", preset_of(row)},
                 {"in_motion", row.in_motion != 0},
                 {"meaning", setting_sentence(&row)}};
    if (row.type == SETTING_CHOICE) {
        for (std::size_t i = 0; i <= static_cast<std::size_t>(row.most); ++i) {
            json["choices"].push_back(
                {{"name", row.choices[i]}, {"meaning", setting_choice_sentence(&row, i)}});
        }
    }
    return json;
}

Json settings_json()
{
    Json json = Json::array();
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
        json.push_back(json_of(*row));
    }
    return json;
}

/* Of a flag or an enumeration its words, by number; a fault shows as its code. */
Json words_of(const signal_row &row)
{
    Json words = Json::array();
    const int count = row.type == SIGNAL_FLAG                   ? 2
                      : row.type == SIGNAL_IS_drive_state       ? int(DRIVE_STATES)
                      : row.type == SIGNAL_IS_drive_synchronism ? int(DRIVE_SYNCHRONISMS)
                      : row.type == SIGNAL_IS_drive_position_reference
                          ? int(DRIVE_POSITION_REFERENCES)
                      : row.type == SIGNAL_IS_drive_command_kind ? int(DRIVE_COMMANDS)
                                                                 : 0;
    for (int value = 0; value < count; ++value) {
        words.push_back(signal_word(&row, value));
    }
    return words;
}

Json signals_json()
{
    Json json = Json::array();
    for (int i = 0; i < SIGNALS; ++i) {
        const signal_row &row = *signal_at(static_cast<drive_signal>(i));
        const struct signal_text &more = *signal_text(static_cast<drive_signal>(i));
        json.push_back({{"name", row.name},
                        {"index", row.index},
                        {"unit", more.unit},
                        {"words", words_of(row)},
                        {"meaning", more.sentence}});
    }
    return json;
}

Json parameters_of(drive_command_kind kind)
{
    Json json = Json::array();
    const parameter_row *parameter = nullptr;
    for (std::size_t i = 0; (parameter = parameter_of(kind, i)) != nullptr; ++i) {
        const auto bit = parameter - parameter_at(drive_parameter{});
        json.push_back({{"name", parameter->name},
                        {"index", parameter->index},
                        {"unit", parameter->unit},
                        {"least", parameter->least},
                        {"most", parameter->most},
                        {"optional", (command_at(kind)->optional >> bit & 1) != 0},
                        {"meaning", parameter->sentence}});
    }
    return json;
}

Json commands_json()
{
    Json json = Json::array();
    for (int i = 0; i < DRIVE_COMMANDS; ++i) {
        const auto kind = static_cast<drive_command_kind>(i);
        const command_row &row = *command_at(kind);
        json.push_back({{"name", row.name},
                        {"number", row.number},
                        {"parameters", parameters_of(kind)},
                        {"legal", row.states},
                        {"meaning", row.sentence}});
    }
    return json;
}

Json faults_json()
{
    Json json = Json::array();
    for (int i = DRIVE_FAULT_NONE + 1; i < DRIVE_FAULTS; ++i) {
        const auto fault = static_cast<drive_fault>(i);
        const setting *limit = fault_limit(fault);
        json.push_back({{"name", drive_fault_name(fault)},
                        {"code", fault_at(fault)->code},
                        {"cause", std::string(fault_at(fault)->cause) +
                                      (limit == nullptr ? "" : std::string(" ") + limit->name)},
                        {"limit", limit == nullptr ? Json(nullptr) : Json(limit->name)},
                        {"remedy", fault_remedy(fault)}});
    }
    return json;
}

Json motor_json(const Motor &motor)
{
    drive_settings settings = {};
    Json values;
    settings.motor = motor.params;
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr && setting_is_of_motor(row); ++i) {
        values[row->name] = setting_get(&settings, row, 0);
    }
    return {{"name", motor.id}, {"description", motor.description}, {"settings", values}};
}

/* Of each law, in the order of the setting's elements. */
Json law_gains_json()
{
    Json json;
    for (int law = 0; law < POSITION_LAW_COUNT; ++law) {
        Json names = Json::array();
        const char *name = nullptr;
        for (std::size_t i = 0;
             (name = firmware_image_float.law_gain(static_cast<position_law>(law), i)) != nullptr;
             ++i) {
            names.push_back(name);
        }
        json[drive_law_name(static_cast<position_law>(law))] = names;
    }
    return json;
}

} // namespace

std::string dictionary_json(const std::vector<Motor> &motors)
{
    Json json = {{"written_by", "steadystep-sil dictionary"},
                 {"version", STEADYSTEP_VERSION},
                 {"settings", settings_json()},
                 {"law_gains", law_gains_json()},
                 {"commands", commands_json()},
                 {"signals", signals_json()},
                 {"faults", faults_json()},
                 {"motors", Json::array()}};
    for (const Motor &motor : motors) {
        json["motors"].push_back(motor_json(motor));
    }
    std::string text = "{";
    for (const auto &[key, value] : json.items()) { /* a row in a line, as differences are read */
        text += std::string(text == "{" ? "\n" : ",\n") + "\"" + key + "\": ";
        if (!value.is_array()) {
            text += value.dump();
            continue;
        }
        text += "[";
        for (std::size_t i = 0; i < value.size(); ++i) {
            text += std::string(i == 0 ? "\n  " : ",\n  ") + value[i].dump();
        }
        text += "\n]";
    }
    return text + "\n}\n";
}

} // namespace scenario
