/* Reading TOML: whatever the text, a tree of values or one line of complaint. */
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "sil/scenario/document.h"
#include "unity.h"

using namespace scenario;

namespace
{

/* The complaint about a text; "" if it is taken. */
std::string complaint(const std::string &text)
{
    try {
        (void)parse_toml(text, "x.toml");
    } catch (const InputError &error) {
        return error.what();
    }
    return "";
}

void begins(const std::string &begin, const std::string &text)
{
    if (text.compare(0, begin.size(), begin) != 0) {
        TEST_FAIL_MESSAGE(("expected " + begin + ", got " + text).c_str());
    }
}

std::string repeated(const std::string &text, std::size_t times)
{
    std::string all;
    for (std::size_t i = 0; i < times; ++i) {
        all += text;
    }
    return all;
}

void what_breaks_an_assertion_of_the_library_is_refused_with_its_line()
{
    begins("x.toml:1: not valid TOML", complaint("x=[}"));
    begins("x.toml:2: not valid TOML", complaint("x = 1\n[[[\ny = 2\n"));
    begins("x.toml:3: not valid TOML", complaint("x = 1\n\ny = [[]}\n\n[table]\n"));
    begins("x.toml:1: not valid TOML", complaint("x = [\n"));
}

void deep_tables_are_refused_before_they_take_the_stack()
{
    const std::string deep = repeated("a.", 50000) + "a";
    const std::string why = "not valid TOML: a key of more than 16 parts";
    begins("x.toml:1: " + why, complaint("[" + deep + "]"));
    begins("x.toml:2: " + why, complaint("x = 1\n" + deep + " = 1\n"));
    begins("x.toml:1: " + why, complaint("x = { y = 1, " + deep + " = 1 }"));
    begins("x.toml:4: " + why, complaint("x = 'a' # b\ny = \"\"\"\n\"\"\"\"\"\n" + deep + " = 1"));
    begins("x.toml:1: " + why, complaint("x = { y = \"\"\"a\"\"\"\", " + deep + " = 1 }"));
    begins("x.toml:1: not valid TOML", complaint("x = " + repeated("[", 50000)));
    begins("x.toml:1: not valid TOML", complaint("x = " + repeated("{a=", 50000)));
}

void dots_that_make_no_key_deep_are_taken()
{
    const std::string dots = repeated(".", 100);
    TEST_ASSERT_EQUAL_STRING("", complaint("x = \"" + dots + "\" # " + dots + "\n").c_str());
    TEST_ASSERT_EQUAL_STRING("",
                             complaint("x = '''\n" + dots + "'''\n'y" + dots + "' = 1\n").c_str());
    TEST_ASSERT_EQUAL_STRING("", complaint("x = [" + repeated("1.5, ", 100) + "]\n").c_str());
    TEST_ASSERT_EQUAL_STRING("", complaint(repeated("a.", 15) + "a = 1\n").c_str());
}

void a_setting_too_deep_is_refused()
{
    Value target;
    try {
        apply_setting(target, repeated("a.", 50000) + "a=1");
        TEST_FAIL_MESSAGE("taken");
    } catch (const InputError &error) {
        begins("--set a.a.", error.what());
    }
}

/* Numbers that are the same on every machine. */
class Mutation
{
  public:
    explicit Mutation(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1)
    {
    }

    std::size_t below(std::size_t n)
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::size_t>((state_ >> 33) % n);
    }

    /* A byte or a few changed, put in, left out or repeated, most of them such as TOML is made of.
     */
    void mutate(std::string &text)
    {
        static constexpr std::string_view letters =
            "[]{}=,.\"'#\n\r\t \\-+_:eEinf0x9aZ\x01\x7f\xc3\xff";
        const std::size_t at = below(text.size() + 1);
        switch (below(5)) {
        case 0:
            text.insert(at, 1, letters[below(letters.size())]);
            break;
        case 1:
            text.erase(at, 1 + below(4));
            break;
        case 2:
            text.insert(at, text.substr(below(text.size() + 1), 1 + below(30)));
            break;
        case 3:
            text.resize(at);
            break;
        default:
            if (at < text.size()) {
                text[at] = letters[below(letters.size())];
            }
            break;
        }
    }

  private:
    std::uint64_t state_;
};

std::vector<std::string> scenario_texts()
{
    std::vector<std::string> texts;
    std::vector<std::filesystem::path> files;
    for (const auto &entry : std::filesystem::directory_iterator(STEADYSTEP_SCENARIOS)) {
        if (entry.path().extension() == ".toml") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path &file : files) {
        std::ifstream stream(file, std::ios::binary);
        texts.emplace_back(std::istreambuf_iterator<char>(stream),
                           std::istreambuf_iterator<char>());
    }
    return texts;
}

void damaged_scenarios_are_taken_or_refused_in_one_line()
{
    constexpr std::uint64_t rounds = 12000;
    const std::vector<std::string> texts = scenario_texts();
    TEST_ASSERT_GREATER_THAN_size_t(100, texts.size());
    std::size_t taken = 0;
    for (std::uint64_t round = 0; round < rounds; ++round) {
        Mutation mutation(round);
        std::string text = texts[round % texts.size()];
        for (std::size_t left = 1 + mutation.below(3); left > 0; --left) {
            mutation.mutate(text);
        }
        const std::string why = complaint(text);
        taken += why.empty() ? 1 : 0;
        if (!why.empty()) {
            begins("x.toml:", why);
            TEST_ASSERT_EQUAL_size_t_MESSAGE(std::string::npos, why.find('\n'), why.c_str());
        }
    }
    TEST_ASSERT_GREATER_THAN_size_t(rounds / 20, taken); /* both come about */
    TEST_ASSERT_LESS_THAN_size_t(rounds * 19 / 20, taken);
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(what_breaks_an_assertion_of_the_library_is_refused_with_its_line);
    RUN_TEST(deep_tables_are_refused_before_they_take_the_stack);
    RUN_TEST(dots_that_make_no_key_deep_are_taken);
    RUN_TEST(a_setting_too_deep_is_refused);
    RUN_TEST(damaged_scenarios_are_taken_or_refused_in_one_line);
    return UNITY_END();
}
