/*
 * Reads the keys of one table, each with its type and its physical range, and refuses what is
 * left over. Every complaint is one line: file:line: key: what was expected, what was found.
 */
#ifndef STEADYSTEP_SCENARIO_TABLE_READER_H
#define STEADYSTEP_SCENARIO_TABLE_READER_H

#include <cstdint>
#include <string>
#include <vector>

#include "sil/scenario/document.h"

namespace scenario
{

/* The member of `known` closest to `word`, if close enough to be a slip of the pen; else "". */
std::string nearest(const std::string &word, const std::vector<std::string> &known);

/* "one of a, b, c", with the nearest to `word` pointed out. */
std::string one_of(const std::string &word, const std::vector<std::string> &known);

/* Names by the drive's own spelling, in the order of the enumeration. */
template <typename Enum> std::vector<std::string> names_of(const char *(*name)(Enum), int count)
{
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
        names.push_back(name(static_cast<Enum>(i)));
    }
    return names;
}

class TableReader
{
  public:
    /* `path` is the name of the table in complaints, "" at the top. */
    TableReader(const Value &table, std::string path);

    /* Each leaves `target` alone and returns false if the key is absent. */
    bool number(const std::string &key, double &target, double min, double max);
    bool integer(const std::string &key, std::int64_t &target, std::int64_t min, std::int64_t max);
    bool boolean(const std::string &key, bool &target);
    bool text(const std::string &key, std::string &target);
    /* Whether the number nan stands there, which number() refuses. */
    bool is_nan(const std::string &key);
    /* A text out of `names`; gives its index. */
    bool choice(const std::string &key, std::size_t &target, const std::vector<std::string> &names);
    const Value *table(const std::string &key);
    const Value *array(const std::string &key);
    /* An array of something else, `expected` in complaints. */
    const Value *list(const std::string &key, const char *expected);
    const Value *any(const std::string &key);

    void require(const std::string &key) const; /* throws unless present */
    void finish() const;                        /* throws on a key that nobody asked for */

    [[noreturn]] void fail(const std::string &key, const std::string &message) const;

  private:
    const Value *find(const std::string &key, Value::Kind kind, const char *expected);

    const Value &table_;
    std::string path_;
    std::vector<std::string> known_;
};

} // namespace scenario

#endif
