#include "sil/scenario/table_reader.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

/* Levenshtein distance. */
std::size_t edits_between(const std::string &a, const std::string &b)
{
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        row[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

std::string describe(const Value &value)
{
    switch (value.kind) {
    case Value::Kind::boolean:
        return value.boolean ? "true" : "false";
    case Value::Kind::integer:
        return std::to_string(value.integer);
    case Value::Kind::number:
        return readable(value.number);
    case Value::Kind::text:
        return "\"" + value.text + "\"";
    case Value::Kind::array:
        return "an array";
    case Value::Kind::table:
        return "a table";
    case Value::Kind::other:
        break;
    }
    return "a date or time";
}

} // namespace

std::string nearest(const std::string &word, const std::vector<std::string> &known)
{
    std::string best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const std::string &candidate : known) {
        const std::size_t edits = edits_between(word, candidate);
        if (edits < least) {
            least = edits;
            best = candidate;
        }
    }
    return least <= 2 + word.size() / 4 ? best : "";
}

std::string one_of(const std::string &word, const std::vector<std::string> &known)
{
    std::string text = "one of ";
    for (std::size_t i = 0; i < known.size(); ++i) {
        text += (i == 0 ? "" : ", ") + known[i];
    }
    const std::string guess = nearest(word, known);
    return guess.empty() ? text : text + " (did you mean " + guess + "?)";
}

TableReader::TableReader(const Value &table, std::string path)
    : table_(table), path_(std::move(path))
{
    if (table.kind != Value::Kind::table) {
        throw InputError(table.location.text() + ": " + path_ + ": expected a table, got " +
                         describe(table));
    }
}

void TableReader::fail(const std::string &key, const std::string &message) const
{
    const Value *value = table_.find(key);
    const Location &where = value != nullptr ? value->location : table_.location;
    throw InputError(where.text() + ": " + (path_.empty() ? "" : path_ + ".") + key + ": " +
                     message);
}

const Value *TableReader::find(const std::string &key, Value::Kind kind, const char *expected)
{
    const Value *value = any(key);
    const bool integer_as_number =
        value != nullptr && kind == Value::Kind::number && value->kind == Value::Kind::integer;
    if (value != nullptr && value->kind != kind && !integer_as_number) {
        fail(key, std::string("expected ") + expected + ", got " + describe(*value));
    }
    return value;
}

const Value *TableReader::any(const std::string &key)
{
    known_.push_back(key);
    return table_.find(key);
}

bool TableReader::number(const std::string &key, double &target, double min, double max)
{
    const std::string expected = "a number in " + readable(min) + "..." + readable(max);
    const Value *value = find(key, Value::Kind::number, expected.c_str());
    if (value == nullptr) {
        return false;
    }
    if (!(value->number >= min && value->number <= max)) { /* also refuses NaN */
        fail(key, "expected " + expected + ", got " + describe(*value));
    }
    target = value->number;
    return true;
}

bool TableReader::integer(const std::string &key, std::int64_t &target, std::int64_t min,
                          std::int64_t max)
{
    const std::string expected =
        "an integer in " + std::to_string(min) + "..." + std::to_string(max);
    const Value *value = find(key, Value::Kind::integer, expected.c_str());
    if (value == nullptr) {
        return false;
    }
    if (value->integer < min || value->integer > max) {
        fail(key, "expected " + expected + ", got " + describe(*value));
    }
    target = value->integer;
    return true;
}

bool TableReader::boolean(const std::string &key, bool &target)
{
    const Value *value = find(key, Value::Kind::boolean, "true or false");
    if (value != nullptr) {
        target = value->boolean;
    }
    return value != nullptr;
}

bool TableReader::text(const std::string &key, std::string &target)
{
    const Value *value = find(key, Value::Kind::text, "a text in quotes");
    if (value != nullptr) {
        target = value->text;
    }
    return value != nullptr;
}

bool TableReader::is_nan(const std::string &key)
{
    const Value *value = table_.find(key);
    const bool nan =
        value != nullptr && value->kind == Value::Kind::number && value->number != value->number;
    if (nan) {
        known_.push_back(key);
    }
    return nan;
}

bool TableReader::choice(const std::string &key, std::size_t &target,
                         const std::vector<std::string> &names)
{
    std::string word;
    if (!text(key, word)) {
        return false;
    }
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
        fail(key, "expected " + one_of(word, names) + ", got \"" + word + "\"");
    }
    target = static_cast<std::size_t>(found - names.begin());
    return true;
}

const Value *TableReader::table(const std::string &key)
{
    return find(key, Value::Kind::table, "a table");
}

const Value *TableReader::array(const std::string &key)
{
    return list(key, "an array of tables");
}

const Value *TableReader::list(const std::string &key, const char *expected)
{
    return find(key, Value::Kind::array, expected);
}

void TableReader::require(const std::string &key) const
{
    if (table_.find(key) == nullptr) {
        fail(key, "is missing");
    }
}

void TableReader::finish() const
{
    for (const std::string &key : table_.keys) {
        if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
            const std::string guess = nearest(key, known_);
            fail(key, guess.empty() ? "unknown key, expected " + one_of(key, known_)
                                    : "unknown key (did you mean " + guess + "?)");
        }
    }
}

} // namespace scenario
