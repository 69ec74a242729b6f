#include "sil/scenario/settings_file.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "firmware/interface/settings.h"
#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

bool is_law_gains(const setting &row)
{
    return row.offset == offsetof(drive_settings, law_gains);
}

/* nullptr: it has no more. */
const char *gain_name(const drive_settings &drive, std::size_t gain)
{
    return firmware_image_float.law_gain(drive.law, gain);
}

/* A number, or nan where a setting need not be given. */
bool read_real(TableReader &reader, const std::string &key, const setting &row,
               const drive_settings &drive, double &value)
{
    if (row.preset_base == SETTING_FOLLOWS && reader.is_nan(key)) {
        value = std::numeric_limits<double>::quiet_NaN();
        return true;
    }
    return reader.number(key, value, setting_least(&drive, &row), setting_most(&drive, &row));
}

/* Gains by the law's own names; `path` is that of their table. */
void read_law_gains(TableReader &above, const std::string &path, const setting &row,
                    drive_settings &drive)
{
    const Value *table = above.table(row.name);
    if (table == nullptr) {
        return;
    }
    TableReader reader(*table, path);
    const char *name = nullptr;
    for (std::size_t gain = 0; (name = gain_name(drive, gain)) != nullptr; ++gain) {
        read_real(reader, name, row, drive, drive.law_gains[gain]);
    }
    reader.finish();
}

void read_reals(TableReader &reader, const setting &row, drive_settings &drive)
{
    const double least = setting_least(&drive, &row), most = setting_most(&drive, &row);
    const Value *list = reader.list(row.name, "an array of numbers");
    if (list == nullptr) {
        return;
    }
    if (list->items.size() != row.count) {
        reader.fail(row.name, "expected " + std::to_string(row.count) +
                                  " numbers: " + setting_sentence(&row));
    }
    for (std::size_t i = 0; i < list->items.size(); ++i) {
        const Value &item = list->items[i];
        if (item.kind != Value::Kind::number && item.kind != Value::Kind::integer) {
            reader.fail(row.name, "expected numbers");
        }
        if (!(item.number >= least && item.number <= most)) {
            reader.fail(row.name, "expected numbers in " + readable(least) + "..." +
                                      readable(most) + ", got " + readable(item.number));
        }
        setting_put(&drive, &row, i, item.number);
    }
}

void read_choice(TableReader &reader, const setting &row, drive_settings &drive)
{
    const std::vector<std::string> texts(row.choices,
                                         row.choices + static_cast<std::size_t>(row.most) + 1);
    std::size_t choice = 0;
    if (reader.choice(row.name, choice, texts)) {
        setting_choose(&drive, &row, 0, static_cast<double>(choice));
    }
}

void read_count(TableReader &reader, const setting &row, drive_settings &drive)
{
    std::int64_t count = 0;
    if (reader.integer(row.name, count, static_cast<std::int64_t>(setting_least(&drive, &row)),
                       static_cast<std::int64_t>(setting_most(&drive, &row)))) {
        setting_put(&drive, &row, 0, static_cast<double>(count));
    }
}

void read_flag(TableReader &reader, const setting &row, drive_settings &drive)
{
    bool flag = false;
    if (reader.boolean(row.name, flag)) {
        setting_put(&drive, &row, 0, flag ? 1 : 0);
    }
}

/* Not of the gains. */
void read_setting(TableReader &reader, const setting &row, drive_settings &drive)
{
    double value = 0;
    if (row.count > 1) {
        read_reals(reader, row, drive);
    } else if (row.type == SETTING_CHOICE) {
        read_choice(reader, row, drive);
    } else if (row.type == SETTING_FLAG) {
        read_flag(reader, row, drive);
    } else if (row.type == SETTING_COUNT) {
        read_count(reader, row, drive);
    } else if (read_real(reader, row.name, row, drive, value)) {
        setting_put(&drive, &row, 0, value);
    }
}

/* The rows from `first` on. */
void read_rows(const Value &table, const std::string &path, std::size_t first,
               drive_settings &drive)
{
    TableReader reader(table, path);
    const setting *row = nullptr;
    for (std::size_t i = first; (row = setting_number(i)) != nullptr; ++i) {
        if (is_law_gains(*row)) {
            read_law_gains(reader, (path.empty() ? "" : path + ".") + row->name, *row, drive);
        } else {
            read_setting(reader, *row, drive);
        }
    }
    reader.finish();
}

/* A real number always has a point or an exponent, or a diff would show a change of type. */
std::string real_text(double value)
{
    if (value != value) {
        return "nan";
    }
    const std::string digits = shortest(value);
    return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

std::string value_text(const setting &row, double value)
{
    switch (row.type) {
    case SETTING_CHOICE:
        return "\"" + std::string(row.choices[static_cast<std::size_t>(value)]) + "\"";
    case SETTING_FLAG:
        return value != 0 ? "true" : "false";
    case SETTING_COUNT:
        return std::to_string(static_cast<std::int64_t>(value));
    default:
        return real_text(value);
    }
}

std::string line(const setting &row, const std::string &name, const std::string &value)
{
    const std::string unit = row.unit;
    return name + " = " + value + (unit.empty() ? "" : "  # " + unit) + "\n";
}

std::string gain_lines(const setting &row, const drive_settings &drive)
{
    std::string text;
    const char *name = nullptr;
    for (std::size_t gain = 0; (name = gain_name(drive, gain)) != nullptr; ++gain) {
        text += line(row, std::string(row.name) + "." + name,
                     value_text(row, setting_get(&drive, &row, gain)));
    }
    return text;
}

std::string lines(const setting &row, const drive_settings &drive)
{
    if (is_law_gains(row)) {
        return gain_lines(row, drive);
    }
    if (row.count == 1) {
        return line(row, row.name, value_text(row, setting_get(&drive, &row, 0)));
    }
    std::string list;
    for (std::size_t i = 0; i < row.count; ++i) {
        list += (i == 0 ? "" : ", ") + value_text(row, setting_get(&drive, &row, i));
    }
    return line(row, row.name, "[" + list + "]");
}

} // namespace

void read_drive(const Value &table, drive_settings &drive)
{
    read_rows(table, "drive", SETTINGS_OF_MOTOR, drive);
}

void read_settings(const Value &file, drive_settings &drive)
{
    read_rows(file, "", 0, drive);
}

std::string settings_text(const drive_settings &drive)
{
    std::string text = "# Settings of a drive; nan: not given, it follows from motor and board.\n";
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
        text += lines(*row, drive);
    }
    return text;
}

} // namespace scenario
