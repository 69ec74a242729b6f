#include "sil/scenario/document.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

/* The library's assertions are reached by some malformed input; thrown, they are a complaint. */
namespace
{
struct LibraryAssertion {
};

[[noreturn]] void break_assertion()
{
    throw LibraryAssertion();
}
} // namespace
#undef NDEBUG
#define TOML_ASSERT(expr)      ((expr) ? static_cast<void>(0) : break_assertion())
#define TOML_MAX_NESTED_VALUES 32
#include <toml++/toml.h>

#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr std::size_t most_key_parts = 16; /* a.b.c has three; deeper tables are nobody's */

Value convert(const toml::node &node, const std::string &file)
{
    Value value;
    value.location = {file, node.source().begin.line};
    if (const toml::table *table = node.as_table()) {
        value.kind = Value::Kind::table;
        for (const auto &[key, child] : *table) {
            value.set(std::string(key.str()), convert(child, file));
        }
    } else if (const toml::array *array = node.as_array()) {
        value.kind = Value::Kind::array;
        for (const toml::node &child : *array) {
            value.items.push_back(convert(child, file));
        }
    } else if (const auto *text = node.as_string()) {
        value.kind = Value::Kind::text;
        value.text = text->get();
    } else if (const auto *boolean = node.as_boolean()) {
        value.kind = Value::Kind::boolean;
        value.boolean = boolean->get();
    } else if (const auto *integer = node.as_integer()) {
        value.kind = Value::Kind::integer;
        value.integer = integer->get();
        value.number = static_cast<double>(integer->get());
    } else if (const auto *number = node.as_floating_point()) {
        value.kind = Value::Kind::number;
        value.number = number->get();
    } else {
        value.kind = Value::Kind::other; /* dates and times mean nothing here */
    }
    return value;
}

/* The value of a --set: TOML if it is, a bare word otherwise (drive.law=pid). */
Value parse_setting_value(const std::string &text, const Location &location)
{
    Value value;
    try {
        Value table = parse_toml("value = " + text, location.file);
        if (table.keys.size() == 1) {
            value = table.items.front();
            value.location = location;
            return value;
        }
    } catch (const InputError &) {
        /* a bare word */
    }
    value.kind = Value::Kind::text;
    value.text = text;
    value.location = location;
    return value;
}

/*
 * How many parts a dotted key has; the library nests as many tables, each of which takes stack. It
 * sees strings and comments as the library does as long as the text is valid; where it is not, the
 * library goes no further.
 */
class KeyDepth
{
  public:
    explicit KeyDepth(const std::string &text) : text_(text)
    {
    }

    /* The first line with too deep a key; 0: none. */
    std::size_t line_too_deep()
    {
        std::size_t dots = 0;
        while (at_ < text_.size()) {
            const char letter = text_[at_];
            if (letter == '"' || letter == '\'') {
                skip_string(letter);
                continue;
            }
            if (letter == '#') {
                at_ = std::min(text_.find('\n', at_), text_.size());
                continue;
            }
            if (letter == '.') {
                if (++dots >= most_key_parts) {
                    return line();
                }
            } else if (std::string_view("=,[]{}\n").find(letter) != std::string_view::npos) {
                dots = 0;
            }
            ++at_;
        }
        return 0;
    }

  private:
    std::size_t line() const
    {
        return 1 + static_cast<std::size_t>(
                       std::count(text_.begin(), text_.begin() + static_cast<long>(at_), '\n'));
    }

    /* Behind the closing quote; a string of one line ends with the line at the latest. */
    void skip_string(char quote)
    {
        const std::string three(3, quote);
        const bool many_lines = text_.compare(at_, 3, three) == 0;
        for (at_ += many_lines ? 3 : 1; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\\' && quote == '"') {
                ++at_;
            } else if (many_lines ? text_.compare(at_, 3, three) == 0
                                  : text_[at_] == quote || text_[at_] == '\n') {
                at_ += many_lines ? 3 : 1;
                break;
            }
        }
        for (int own = 0; many_lines && own < 2 && at_ < text_.size(); ++own) {
            at_ += text_[at_] == quote ? 1 : 0; /* two more may belong to the string */
        }
    }

    const std::string &text_;
    std::size_t at_ = 0;
};

bool breaks_assertion(const std::string &text)
{
    try {
        (void)toml::parse(text);
    } catch (const toml::parse_error &) {
        /* cut off in the middle of something */
    } catch (const LibraryAssertion &) {
        return true;
    }
    return false;
}

/* The library does not say where it is: the first line with which the text breaks the assertion,
   which all that is longer does as well. */
std::size_t line_of_assertion(const std::string &text)
{
    std::vector<std::size_t> ends; /* of lines */
    for (std::size_t at = 0; at < text.size(); ++at) {
        at = std::min(text.find('\n', at), text.size());
        ends.push_back(at);
    }
    const auto broken = std::partition_point(ends.begin(), ends.end(), [&](std::size_t end) {
        return !breaks_assertion(text.substr(0, end));
    });
    return static_cast<std::size_t>(broken - ends.begin()) + 1;
}

} // namespace

std::string Location::text() const
{
    return line == 0 ? file : file + ":" + std::to_string(line);
}

const Value *Value::find(std::string_view key) const
{
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (keys[i] == key) {
            return &items[i];
        }
    }
    return nullptr;
}

Value *Value::find(std::string_view key)
{
    return const_cast<Value *>(std::as_const(*this).find(key));
}

void Value::set(const std::string &key, Value value)
{
    if (Value *present = find(key)) {
        *present = std::move(value);
    } else {
        keys.push_back(key);
        items.push_back(std::move(value));
    }
}

Value read_toml(const std::filesystem::path &file)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        throw InputError(file.string() + ": no such file");
    }
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) {
        throw InputError(file.string() + ": cannot be read");
    }
    return parse_toml(text.str(), file.string());
}

Value parse_toml(const std::string &text, const std::string &name)
{
    const auto complain = [&](std::size_t line, const std::string &what) {
        throw InputError(Location{name, line}.text() + ": not valid TOML: " + in_one_line(what));
    };
    if (const std::size_t line = KeyDepth(text).line_too_deep()) {
        complain(line, "a key of more than " + std::to_string(most_key_parts) + " parts");
    }
    try {
        return convert(toml::parse(text), name);
    } catch (const toml::parse_error &error) {
        complain(error.source().begin.line, std::string(error.description()));
    } catch (const LibraryAssertion &) {
        complain(line_of_assertion(text), "a character that has no place here");
    }
    return {};
}

void merge(Value &target, const Value &over)
{
    for (std::size_t i = 0; i < over.keys.size(); ++i) {
        Value *present = target.find(over.keys[i]);
        const Value &value = over.items[i];
        if (present != nullptr && present->kind == Value::Kind::table &&
            value.kind == Value::Kind::table) {
            present->location = value.location;
            merge(*present, value);
        } else {
            target.set(over.keys[i], value);
        }
    }
}

void apply_setting(Value &target, const std::string &setting)
{
    const Location location{"--set " + setting, 0};
    const std::size_t equals = setting.find('=');
    if (KeyDepth(setting).line_too_deep() != 0) {
        throw InputError("--set " + setting.substr(0, 20) + "...: a key of more than " +
                         std::to_string(most_key_parts) + " parts");
    }
    if (equals == std::string::npos || equals == 0 || equals + 1 == setting.size()) {
        throw InputError(location.text() + ": expected table.key=value");
    }
    Value *table = &target;
    std::size_t begin = 0;
    for (std::size_t dot; (dot = setting.find('.', begin)) < equals; begin = dot + 1) {
        const std::string name = setting.substr(begin, dot - begin);
        if (table->find(name) == nullptr) {
            Value empty;
            empty.location = location;
            table->set(name, empty);
        }
        table = table->find(name);
        if (table->kind != Value::Kind::table) {
            throw InputError(location.text() + ": " + setting.substr(0, dot) +
                             ": has no keys of its own");
        }
    }
    table->set(setting.substr(begin, equals - begin),
               parse_setting_value(setting.substr(equals + 1), location));
}

void apply_settings(Value &target, const std::vector<std::string> &settings)
{
    std::set<std::string> keys;
    for (const std::string &setting : settings) {
        const std::string key = setting.substr(0, setting.find('='));
        if (!keys.insert(key).second) {
            throw InputError("--set " + setting + ": " + key + ": set twice");
        }
        apply_setting(target, setting);
    }
}

} // namespace scenario
