#include "sil/scenario/text.h"

#include <charconv>
#include <cstdarg>
#include <cstdio>

namespace scenario
{

std::string format(const char *pattern, ...)
{
    std::va_list arguments, copy;
    va_start(arguments, pattern);
    va_copy(copy, arguments);
    const int length = std::vsnprintf(nullptr, 0, pattern, copy);
    va_end(copy);
    std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
    std::vsnprintf(text.data(), text.size() + 1, pattern, arguments);
    va_end(arguments);
    return text;
}

std::string shortest(double number)
{
    char digits[32];
    const std::to_chars_result end = std::to_chars(digits, digits + sizeof digits, number);
    return std::string(digits, end.ptr);
}

std::string readable(double number)
{
    return format("%.10g", number);
}

std::string in_one_line(std::string text)
{
    for (char &letter : text) {
        letter = static_cast<unsigned char>(letter) < ' ' || letter == '\x7f' ? '?' : letter;
    }
    return text;
}

std::string hexadecimal(std::uint64_t bits)
{
    return format("%016llx", static_cast<unsigned long long>(bits));
}

} // namespace scenario
