#include "sil/scenario/document.h"

#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <toml++/toml.h>

namespace scenario
{

namespace
{

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
    try {
        return convert(toml::parse(text), name);
    } catch (const toml::parse_error &error) {
        throw InputError(Location{name, error.source().begin.line}.text() +
                         ": not valid TOML: " + std::string(error.description()));
    }
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
