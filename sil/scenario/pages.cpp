#include "sil/scenario/pages.h"

#include "firmware/interface/dictionary.h"
#include "sil/scenario/eds.h"
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
           range + " | " + preset + " | " + (row.in_motion ? "in motion" : "at enable") + " | " +
           setting_sentence(&row) + " |\n";
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
    const std::string head = "| index | setting | unit | range | default | changes | what it is |\n"
                             "| --- | --- | --- | --- | --- | --- | --- |\n";
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
           "How a drive is set: the keys of a scenario's `[drive]`, and the "
           "entries of the stored\nrecord. Written by `steadystep-sil settings` from "
           "`settings_table.h`, which declares each once.\n\n"
           "A range or default of \"rated\" is of the motor's rated current. \"follows\": from "
           "motor, board and period, if it is\nnot given. What changes \"at enable\" is set while "
           "the bridge is off, and acts at the next "
           "`enable`; \"in motion\": also\nin a drive that is ready, at once.\n\n" +
           head + drive + "\n" + choices +
           "\n## The motor\n\nA motor file gives them (`sil/motors/README.md`).\n\n" + head + motor;
}

std::string signals_page()
{
    std::string text =
        "# Signals\n\n"
        "What a drive shows of the last control period: `signals` on the console, columns of "
        "`trace.csv`. Written by\n`steadystep-sil signals` from `signals_table.h`, which declares "
        "each once.\n\n"
        "| index | signal | unit | in `state` | traced | what it is |\n"
        "| --- | --- | --- | --- | --- | --- |\n";
    for (int i = 0; i < SIGNALS; ++i) {
        const signal_row &row = *signal_at(static_cast<drive_signal>(i));
        const struct signal_text &more = *signal_text(static_cast<drive_signal>(i));
        text += format("| 0x%04x | `", unsigned(row.index)) + row.name + "` | " + more.unit +
                " | " + (row.brief[0] != '\0' ? std::string("`") + row.brief + "`" : "") + " | " +
                (more.traced ? "yes" : "") + " | " + more.sentence + " |\n";
    }
    return text;
}

/* "a phase current beyond `overcurrent_trip_A`" */
std::string cause_of(drive_fault fault)
{
    const setting *limit = fault_limit(fault);
    return std::string(fault_at(fault)->cause) +
           (limit == nullptr ? "" : std::string(" `") + limit->name + "`");
}

std::string listed(drive_command_kind kind)
{
    std::string text;
    const parameter_row *parameter = nullptr;
    for (std::size_t i = 0; (parameter = parameter_of(kind, i)) != nullptr; ++i) {
        const auto bit = parameter - parameter_at(drive_parameter{});
        const bool optional = (command_at(kind)->optional >> bit & 1) != 0;
        text += std::string(text.empty() ? "" : ", ") + (optional ? "(" : "") + "`" +
                parameter->name + "`" + (optional ? ")" : "");
    }
    return text;
}

std::string commands_page()
{
    std::string text =
        "# Commands\n\n"
        "What a drive does on command: lines of the console, and `command` of a scenario's "
        "events, which give all\nparameters; there `set-point` is `set-points`. Written by "
        "`steadystep-sil commands` from `commands_table.h`, which\ndeclares each once.\n\n"
        "Parameters in brackets may be left out. The number, written to object 0x2200, gives the "
        "command on a fieldbus.\n\n"
        "| number | command | parameters | legal | acts | what it does |\n"
        "| --- | --- | --- | --- | --- | --- |\n";
    for (int i = 0; i < DRIVE_COMMANDS; ++i) {
        const auto kind = static_cast<drive_command_kind>(i);
        const command_row &row = *command_at(kind);
        text += "| " + std::to_string(row.number) + " | `" + row.name + "` | " + listed(kind) +
                " | " + row.states + " | " + row.planning + " | " + row.sentence + " |\n";
    }
    text += "\n## Parameters\n\n"
            "| index | parameter | unit | range | what it is |\n| --- | --- | --- | --- | --- |\n";
    for (int i = 0; i < DRIVE_PARAMETERS; ++i) {
        const parameter_row &row = *parameter_at(static_cast<drive_parameter>(i));
        text += format("| 0x%04x | `", unsigned(row.index)) + row.name + "` | " + row.unit + " | " +
                shortest(row.least) + "…" + shortest(row.most) + " | " + row.sentence + " |\n";
    }
    return text;
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
        const std::string name = drive_fault_name(fault);
        text += format("| 0x%04x | ", unsigned(fault_at(fault)->code)) + "<a id=\"" + name +
                "\"></a>`" + name + "` | " + cause_of(fault) + " | " + fault_remedy(fault) + " |\n";
    }
    return text;
}

} // namespace

const std::vector<Page> &pages()
{
    static const std::vector<Page> all = {
        {"settings", "settings of a drive: ranges and defaults", settings_page},
        {"commands", "commands of a drive: parameters, states", commands_page},
        {"signals", "signals of a drive: units, meaning", signals_page},
        {"faults", "faults of a drive: causes and remedies", faults_page},
        {"eds", "object dictionary of a drive, as CiA 306 has it", electronic_data_sheet},
    };
    return all;
}

} // namespace scenario
