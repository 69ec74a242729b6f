/*
 * An input file as a tree of values that remember where they were written, so that every complaint
 * can name file, line and key. Files inherit (`base`) and are overridden (`--set`) on this tree;
 * what the values mean is not known here.
 */
#ifndef STEADYSTEP_SCENARIO_DOCUMENT_H
#define STEADYSTEP_SCENARIO_DOCUMENT_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace scenario
{

/* Bad input, in one line: where, which key, what was expected. Ends the program with code 2. */
class InputError : public std::runtime_error
{
  public:
    using std::runtime_error::runtime_error;
};

struct Location {
    std::string file;     /* path as the user gave it, or a command-line argument */
    std::size_t line = 0; /* from 1; 0: no line, as in an argument */

    std::string text() const; /* "file:line" or "file" */
};

struct Value {
    enum class Kind { boolean, integer, number, text, array, table, other };

    Kind kind = Kind::table;
    Location location;
    bool boolean = false;
    std::int64_t integer = 0;
    double number = 0; /* also of an integer */
    std::string text;
    std::vector<std::string> keys; /* of a table: keys[i] names items[i] */
    std::vector<Value> items;      /* of a table or an array */

    const Value *find(std::string_view key) const; /* in a table; nullptr: absent */
    Value *find(std::string_view key);
    void set(const std::string &key, Value value);
};

/* Throws InputError if the file cannot be read or is not TOML. */
Value read_toml(const std::filesystem::path &file);

/* The same of a text; `name` stands for its file in complaints. */
Value parse_toml(const std::string &text, const std::string &name);

/* Puts `over` on top of `target`: tables are merged key by key, everything else is replaced. */
void merge(Value &target, const Value &over);

/* Applies the `table.key=value` of one --set; the value is TOML, or else a bare word. */
void apply_setting(Value &target, const std::string &setting);

/* Applies all of them; a key that is set twice throws InputError. */
void apply_settings(Value &target, const std::vector<std::string> &settings);

} // namespace scenario

#endif
