#include "sil/scenario/pages.h"

#include "firmware/interface/dictionary.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

std::string in_base(double value, unsigned base)
{
    if (base == SETTING_RATED) {
        return value == 1 ? "rated" : shortest(value) + " × rated";
    }
    return shortest(value);
}

std::string range_of(const setting &row)
{
    return in_base(row.least, row.least_base) + "…" + in_base(row.most, row.most_base);
}

std::string default_of(const setting &row)
{
    switch (row.preset_base) {
    case SETTING_FOLLOWS:
    case SETTING_COMPUTED:
        return "follows";
    default:
        return in_base(row.preset, row.preset_base);
    }
}

std::string name_of(const setting &row)
{
    return std::string("`") + row.name + "`" +
           (row.count > 1 ? format(" [%d]", int(row.count)) : "");
}

std::string line(const setting &row, const std::string &range, const std::string &preset)
{
    return format("| 0x%04x | ", unsigned(row.index)) + name_of(row) + " | " + row.unit + " | " +
           range + " | " + preset + " | " + setting_sentence(&row) + " |\n";
}

std::string choice_lines(const setting &row)
{
    std::string text;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(row.most); ++i) {
        const std::string sentence = setting_choice_sentence(&row, i);
        text += std::string(text.empty() ? "" : "; ") + "`" + row.choices[i] + "`" +
                (sentence.empty() ? "" : ": " + sentence);
    }
    return "- `" + std::string(row.name) + "` – " + text + "\n";
}

std::string settings_page()
{
    const std::string head = "| index | setting | unit | range | default | what it is |\n"
                             "| --- | --- | --- | --- | --- | --- |\n";
    std::string motor, drive, choices;
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
        if (setting_is_of_motor(row)) {
            motor += line(*row, range_of(*row), "of the motor");
        } else if (row->type == SETTING_CHOICE) {
            const std::string preset = row->choices[static_cast<std::size_t>(row->preset)];
            drive += line(*row, "below", "`" + preset + "`");
            choices += choice_lines(*row);
        } else if (row->type == SETTING_FLAG) {
            drive += line(*row, "true, false", row->preset != 0 ? "true" : "false");
        } else {
            drive += line(*row, range_of(*row), default_of(*row));
        }
    }
    return "# Settings\n\n"
           "What a drive is told before it is enabled: the keys of a scenario's `[drive]`, and the "
           "entries of the stored\nrecord. Written by `steadystep-sil settings` from "
           "`settings_table.h`, which declares each once.\n\n"
           "A range or default of \"rated\" is of the motor's rated current. \"follows\": from "
           "motor, board and period, if it is\nnot given.\n\n" +
           head + drive + "\n" + choices +
           "\n## The motor\n\nA motor file gives them (`sil/motors/README.md`).\n\n" + head + motor;
}

/* "a phase current beyond `overcurrent_trip_A`" */
std::string cause_of(drive_fault fault)
{
    const setting *limit = fault_limit(fault);
    return std::string(fault_row(fault)->cause) +
           (limit == nullptr ? "" : std::string(" `") + limit->name + "`");
}

std::string faults_page()
{
    std::string text =
        "# Faults\n\n"
        "Why a drive has opened its bridge. `disable` clears a fault; `enable` begins anew. "
        "Written "
        "by `steadystep-sil faults`\nfrom `faults_table.h`, which declares each once.\n\n"
        "Codes are those of an emergency message: of CiA 301 and 402 where one means the same, "
        "from 0xff00 on our own.\n\n"
        "| code | fault | cause | what to do |\n| --- | --- | --- | --- |\n";
    for (int i = DRIVE_FAULT_NONE + 1; i < DRIVE_FAULTS; ++i) {
        const auto fault = static_cast<drive_fault>(i);
        text += format("| 0x%04x | ", unsigned(fault_code(fault))) + "`" + drive_fault_name(fault) +
                "` | " + cause_of(fault) + " | " + fault_remedy(fault) + " |\n";
    }
    return text;
}

} // namespace

const std::vector<Page> &pages()
{
    static const std::vector<Page> all = {
        {"settings", "settings of a drive: ranges and defaults", settings_page},
        {"faults", "faults of a drive: causes and remedies", faults_page},
    };
    return all;
}

} // namespace scenario
