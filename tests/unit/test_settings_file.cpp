/* A file of settings: what is written is read as the same settings, bit for bit, and what is not a
   setting is refused with file, line, key and what is allowed. */
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "firmware/interface/settings.h"
#include "sil/scenario/settings_file.h"
#include "tests/reference/motors.h"
#include "unity.h"

using namespace scenario;

namespace
{

constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

drive_settings defaults()
{
    const motor_params motor = reference::bendjedia_2012();
    drive_settings drive{};
    drive_settings_default(&drive, &motor);
    return drive;
}

void read(const std::string &text, drive_settings &drive)
{
    read_settings(parse_toml(text, "x.toml"), drive);
}

drive_settings read_over_defaults(const std::string &text)
{
    drive_settings drive = defaults();
    read(text, drive);
    return drive;
}

std::string complaint(const std::string &text)
{
    try {
        (void)read_over_defaults(text);
    } catch (const InputError &error) {
        return error.what();
    }
    return "";
}

void refuses(const std::string &text, const std::string &expected)
{
    TEST_ASSERT_EQUAL_STRING(expected.c_str(), complaint(text).c_str());
}

void has_line(const std::string &text, const std::string &line)
{
    if (("\n" + text).find("\n" + line + "\n") == std::string::npos) {
        TEST_FAIL_MESSAGE((line + " is missing:\n" + text).c_str());
    }
}

std::uint64_t bits_of(double value)
{
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

void are_same(const drive_settings &expected, const drive_settings &actual)
{
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
        for (std::size_t element = 0; element < row->count; ++element) {
            TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits_of(setting_get(&expected, row, element)),
                                            bits_of(setting_get(&actual, row, element)), row->name);
        }
    }
}

/* Numbers that are the same on every machine. */
class Draw
{
  public:
    explicit Draw(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1)
    {
    }

    std::uint64_t below(std::uint64_t n)
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return (state_ >> 33) % n;
    }

    /* Somewhere in the range; often at its ends, or not given where that may be. */
    double value(const drive_settings &drive, const setting &row)
    {
        const double least = setting_least(&drive, &row), most = setting_most(&drive, &row);
        const std::uint64_t kind = below(6);
        if (row.type != SETTING_REAL) {
            return least + static_cast<double>(below(static_cast<std::uint64_t>(most - least) + 1));
        }
        if (row.preset_base == SETTING_FOLLOWS && kind < 2) {
            return not_given;
        }
        if (kind == 2) {
            return least <= 0 ? -0.0 : least;
        }
        return kind == 3
                   ? most
                   : least + (most - least) * static_cast<double>(below(1u << 30)) / (1u << 30);
    }

    /* Every setting drawn; of the gains those that the law has. */
    drive_settings settings()
    {
        drive_settings drive = defaults();
        const setting *row = nullptr;
        for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
            for (std::size_t element = 0; element < row->count; ++element) {
                const bool unnamed = row->offset == offsetof(drive_settings, law_gains) &&
                                     firmware_image_float.law_gain(drive.law, element) == nullptr;
                setting_put(&drive, row, element, unnamed ? not_given : value(drive, *row));
            }
        }
        return drive;
    }

  private:
    std::uint64_t state_;
};

void what_is_written_is_read_as_the_same_settings_whatever_there_was_before()
{
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        const drive_settings written = Draw(seed).settings();
        const std::string text = settings_text(written);
        drive_settings back = Draw(seed + 1000).settings();
        read(text, back);
        are_same(written, back);
        TEST_ASSERT_EQUAL_STRING(text.c_str(), settings_text(back).c_str());
    }
}

void a_setting_has_a_line_of_its_own_with_its_unit()
{
    drive_settings drive = defaults();
    setting_choose(&drive, setting_of_index(0x2101), 0, POSITION_LAW_STMMS);
    drive.hold_current_A = 0.1 + 0.2;
    drive.current_limit_A = 2;
    drive.detent_torque_Nm[1] = -1e-5;
    drive.encoder_counts_per_turn = 100000;
    drive.hold_at_rest = false;
    const std::string text = settings_text(drive);
    has_line(text, "inductance_H = 9e-04  # H");
    has_line(text, "rotor_teeth = 50");
    has_line(text, "law = \"stmms\"");
    has_line(text, "hold_at_rest = false");
    has_line(text, "feed_forward = true");
    has_line(text, "hold_current_A = 0.30000000000000004  # A");
    has_line(text, "current_limit_A = 2.0  # A");
    has_line(text, "detent_torque_Nm = [0.0, -1e-05, 0.0, 0.0, 0.0, 0.0]  # N m");
    has_line(text, "encoder_counts_per_turn = 100000");
    has_line(text, "hold_delay_s = nan  # s");
    const std::string gain =
        std::string("law_gains.") + firmware_image_float.law_gain(POSITION_LAW_STMMS, 0);
    has_line(text, gain + " = nan");
    has_line(settings_text(read_over_defaults("law = \"stmms\"\n" + gain + " = 3")),
             gain + " = 3.0");
}

void what_a_file_leaves_out_stays()
{
    drive_settings drive = defaults();
    drive.hold_current_A = 1;
    drive.hold_ramp_s = 0.02;
    read("supply_V = 30\nhold_ramp_s = 0.03\n", drive);
    TEST_ASSERT_EQUAL_DOUBLE(30, drive.motor.supply_V);
    TEST_ASSERT_EQUAL_DOUBLE(0.37, drive.motor.resistance_ohm);
    TEST_ASSERT_EQUAL_DOUBLE(1, drive.hold_current_A);
    TEST_ASSERT_EQUAL_DOUBLE(0.03, drive.hold_ramp_s);
    read("hold_current_A = nan\n", drive);
    TEST_ASSERT_TRUE(drive.hold_current_A != drive.hold_current_A);
}

void feedback_and_law_bring_their_defaults()
{
    drive_settings drive = defaults();
    drive.law_bandwidth_rad_s = 150;
    drive.law_gains[0] = 7;
    read("hold_at_rest = true\nfeedback = \"encoder\"\n", drive); /* in whatever order */
    TEST_ASSERT_EQUAL_INT(POSITION_LAW_FEEDBACK_LINEARISATION, drive.law);
    TEST_ASSERT_TRUE(drive.detent_learning);
    TEST_ASSERT_TRUE(drive.hold_at_rest);
    TEST_ASSERT_TRUE(drive.law_bandwidth_rad_s != drive.law_bandwidth_rad_s);
    TEST_ASSERT_TRUE(drive.law_gains[0] != drive.law_gains[0]);
}

void what_is_no_setting_is_refused_with_what_is_allowed()
{
    refuses("law = \"pid\"\nholt_current_A = 1.0\n",
            "x.toml:2: holt_current_A: unknown key (did you mean hold_current_A?)");
    const std::string of_list = complaint("colour = 1\n");
    TEST_ASSERT_EQUAL_size_t(0, of_list.find("x.toml:1: colour: unknown key, expected one of "
                                             "resistance_ohm, inductance_H, "));
    refuses("hold_current_A = 3.5\n",
            "x.toml:1: hold_current_A: expected a number in 0.03...3, got 3.5");
    refuses("rated_current_A = 2.0\nhold_current_A = 2.5\n",
            "x.toml:2: hold_current_A: expected a number in 0.02...2, got 2.5");
    refuses("hold_current_A = \"much\"\n",
            "x.toml:1: hold_current_A: expected a number in 0.03...3, got \"much\"");
    refuses("supply_V = nan\n", "x.toml:1: supply_V: expected a number in 5...400, got nan");
    refuses("rotor_teeth = 50.5\n",
            "x.toml:1: rotor_teeth: expected an integer in 1...1000, got 50.5");
    refuses("feed_forward = 1\n", "x.toml:1: feed_forward: expected true or false, got 1");
    refuses("observer = \"modell\"\n", "x.toml:1: observer: expected one of model, high-gain (did "
                                       "you mean model?), got \"modell\"");
    refuses("detent_torque_Nm = 0.1\n",
            "x.toml:1: detent_torque_Nm: expected an array of numbers, got 0.1");
    refuses("detent_torque_Nm = [0, 0, 0, 0, 0, 200]\n",
            "x.toml:1: detent_torque_Nm: expected numbers in -100...100, got 200");
    refuses("detent_torque_Nm = [0, 0, 0, 0, 0, true]\n",
            "x.toml:1: detent_torque_Nm: expected numbers");
    TEST_ASSERT_EQUAL_size_t(
        0, complaint("detent_torque_Nm = [0]\n").find("x.toml:1: detent_torque_Nm: expected 6 "));
    TEST_ASSERT_EQUAL_size_t(0, complaint("law = \"stmms\"\nlaw_gains.k = true\n")
                                    .find("x.toml:2: law_gains.k: unknown key"));
    TEST_ASSERT_EQUAL_size_t(
        0, complaint("law = \"pid\"\n\nsupply_V = = 24\n").find("x.toml:3: not valid TOML: "));
    TEST_ASSERT_EQUAL_size_t(
        0, complaint("supply_V = 24\nsupply_V = 24\n").find("x.toml:2: not valid TOML: "));
}

void a_scenario_says_nothing_of_the_motor_in_its_drive()
{
    drive_settings drive = defaults();
    try {
        read_drive(parse_toml("supply_V = 30\n", "x.toml"), drive);
        TEST_FAIL_MESSAGE("taken");
    } catch (const InputError &error) {
        TEST_ASSERT_EQUAL_size_t(0, std::string(error.what()).find("x.toml:1: drive.supply_V: "));
    }
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
    RUN_TEST(what_is_written_is_read_as_the_same_settings_whatever_there_was_before);
    RUN_TEST(a_setting_has_a_line_of_its_own_with_its_unit);
    RUN_TEST(what_a_file_leaves_out_stays);
    RUN_TEST(feedback_and_law_bring_their_defaults);
    RUN_TEST(what_is_no_setting_is_refused_with_what_is_allowed);
    RUN_TEST(a_scenario_says_nothing_of_the_motor_in_its_drive);
    return UNITY_END();
}
