#include "tests/one_step/witness.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>
#include <sstream>

#include "tests/one_step/rounded_drive.h"
#include "tests/one_step/state.h"

namespace one_step
{

namespace
{

/* How many are drawn until a period is explained. */
constexpr std::size_t draws[] = {2, 8, 64, 1024, 16384};
/* A value may lie beside those that are drawn by so many of the distances between them. */
constexpr double beside = 1.0;
/* Last places for a sum or a constant, whose rounding is not drawn. */
constexpr double of_sums = 4.0;
constexpr std::size_t examples_shown = 12;

constexpr double float_place = 1.0 / 16777216.0, num_place = 1.0 / 67108864.0,
                 unit_place = 1.0 / 32768.0;

bool is_a_magnitude(const Field &field)
{
    return field.kind != Kind::exact && field.kind != Kind::pointer && field.kind != Kind::bytes;
}

using Bytes = std::vector<unsigned char>;

/* Of the same period, in double. */
struct Outcome {
    Bytes state; /* struct drive */
    hal_outputs outputs;
    std::string otherwise; /* the first field that decides otherwise than the image tested; "" */
};

class Witness
{
  public:
    Witness(const firmware_image &tested, const Layout &layout, Findings &findings)
        : tested_(tested), layout_(layout), findings_(findings),
          state_(layout, std::strcmp(tested.numeric, "float") != 0),
          memory_(1 + firmware_image_double.drive_bytes / sizeof(std::max_align_t)),
          supervision_(layout.field("supervision.state"))
    {
    }

    const firmware_image &tested() const
    {
        return tested_;
    }

    /* Behind that of the image tested; `init` starts the same in double. */
    template <typename Init> bool init(void *drive, const hal *board, Init init)
    {
        board_ = without_effects(*board);
        if (!init(firmware_image_double, memory_.data(), &board_)) {
            return false;
        }
        outputs_ = {};
        synchronised_.clear();
        state_.begin(of_tested(drive), now_in_double());
        return true;
    }

    hal_outputs control_cycle(void *drive, const hal_samples *samples);

  private:
    static hal without_effects(const hal &board);

    static Memory of_tested(const void *drive)
    {
        const auto *const at = static_cast<const unsigned char *>(drive);
        return {at, at, false};
    }
    unsigned char *home()
    {
        return reinterpret_cast<unsigned char *>(memory_.data());
    }
    Memory now_in_double()
    {
        return {home(), home(), true};
    }
    Memory in_double(const Bytes &state)
    {
        return {state.data(), home(), true};
    }
    enum rounding_format format() const
    {
        return std::strcmp(tested_.numeric, "one_motor") == 0 ? ROUNDING_ONE_MOTOR
               : state_.fixed()                               ? ROUNDING_FIXED
                                                              : ROUNDING_FLOAT;
    }

    void synchronise(Memory tested);
    Outcome outcome(Memory after, const hal_outputs &outputs);
    void draw(const hal_samples *samples, Memory after);
    void round_terms(Memory after);
    std::string otherwise(Memory after, const Outcome &other);
    void find_touched(Memory after);
    bool is_double_without_rounding(const hal_samples *samples, Memory after);
    bool compares(const Field &field, Memory after) const;
    double largest_place(const Block &block, Memory after);
    void judge(const hal_samples *samples, Memory after, const hal_outputs &outputs);
    std::string unexplained(Memory after, const hal_outputs &outputs);
    bool is_within(double margin) const;
    double place(const Field &field, Memory after);
    double distance(const Field &field, Memory after, const Bytes &other);
    void note_differences(Memory after);
    std::string describe(const std::string &path, Memory after, const hal_outputs &outputs);

    const firmware_image &tested_;
    const Layout &layout_;
    Findings &findings_;
    State state_;
    std::vector<std::max_align_t> memory_; /* the instance in double */
    hal board_{};
    Bytes origin_;       /* struct drive in double as the period begins */
    Bytes synchronised_; /* struct drive tested of which that is a copy */
    hal_outputs outputs_{};
    const Field &supervision_;           /* the drive's state */
    bool state_changes_ = false;         /* in this period */
    std::vector<const Block *> touched_; /* by either, in this period */
    Outcome exact_;
    std::vector<Outcome> drawn_;
    std::size_t drawn_count_ = 0;
    std::vector<double> distances_;
};

std::unique_ptr<Witness> witness;

/* The drive in double asks the board for what it has stored, and has no effect on it. */
hal Witness::without_effects(const hal &board)
{
    hal quiet = board;
    quiet.bridge_enable = [](void *) { return true; };
    quiet.bridge_disable = [](void *) {};
    quiet.watchdog_feed = [](void *) {};
    quiet.stream_write = [](void *, const std::uint8_t *, std::size_t count) { return count; };
    if (quiet.outputs_write != nullptr) {
        quiet.outputs_write = [](void *, std::uint32_t) {};
    }
    if (quiet.follow_control != nullptr) {
        quiet.follow_control = [](void *, bool) {};
    }
    return quiet;
}

/* Blocks that have changed since are copied anew; all of them where the parameters have, which say
   what of a union is in use. */
void Witness::synchronise(Memory tested)
{
    bool all = synchronised_.empty();
    if (all) {
        origin_.assign(home(), home() + layout_.double_bytes);
        synchronised_.resize(layout_.tested_bytes);
    }
    std::memcpy(home(), origin_.data(), origin_.size());
    const auto changed = [&](const Block &block) {
        return std::memcmp(tested.at + block.tested, &synchronised_[block.tested],
                           block.tested_bytes) != 0;
    };
    for (const Block &block : layout_.blocks) {
        all = all || (block.name == "params" && changed(block));
    }
    for (const Block &block : layout_.blocks) {
        if (all || changed(block)) {
            state_.copy(block, tested, home());
        }
    }
    std::memcpy(origin_.data(), home(), origin_.size());
    std::memcpy(synchronised_.data(), tested.at, synchronised_.size());
}

hal_outputs Witness::control_cycle(void *drive, const hal_samples *samples)
{
    const Memory after = of_tested(drive);
    synchronise(after);
    const hal_outputs outputs = tested_.control_cycle(drive, samples);
    const hal_outputs exact = firmware_image_double.control_cycle(memory_.data(), samples);
    exact_.state.assign(home(), home() + layout_.double_bytes);
    exact_.outputs = exact;
    state_.compare_gains(after, now_in_double());
    find_touched(after);
    exact_.otherwise = otherwise(after, exact_);
    judge(samples, after, outputs);
    outputs_ = outputs;
    return outputs;
}

void Witness::draw(const hal_samples *samples, Memory after)
{
    if (drawn_count_ == drawn_.size()) {
        drawn_.emplace_back();
    }
    Outcome &one = drawn_[drawn_count_++];
    std::memcpy(home(), origin_.data(), origin_.size());
    if (!state_.fixed()) {
        round_terms(after);
    }
    one.outputs = outputs_;
    rounded_control_cycle(memory_.data(), samples, format(), &one.outputs);
    one.state.assign(home(), home() + layout_.double_bytes);
    one.otherwise = otherwise(after, one);
    findings_.draws++;
}

/* A sum in float is off by 2^-24 of itself, which is less than 2^-24 of each term. */
void Witness::round_terms(Memory after)
{
    for (const Field &field : layout_.fields) {
        if ((field.kind == Kind::num || field.kind == Kind::unit) &&
            state_.in_use(field, after.at)) {
            unsigned char *const at = home() + field.in_double;
            double term = 0;
            std::memcpy(&term, at, sizeof term);
            term += term * rounding_between(-float_place, float_place);
            std::memcpy(at, &term, sizeof term);
        }
    }
}

bool Witness::is_double_without_rounding(const hal_samples *samples, Memory after)
{
    hal_outputs outputs = outputs_;
    std::memcpy(home(), origin_.data(), origin_.size());
    rounded_control_cycle(memory_.data(), samples, ROUNDING_NONE, &outputs);
    for (const Block *const block : touched_) { /* there are bytes between fields */
        for (const std::size_t i : block->fields) {
            const Field &field = layout_.fields[i];
            if (compares(field, after) &&
                std::memcmp(home() + field.in_double, &exact_.state[field.in_double],
                            field.double_bytes) != 0) {
                return false;
            }
        }
    }
    return std::equal(std::begin(outputs.high_counts), std::end(outputs.high_counts),
                      std::begin(exact_.outputs.high_counts)) &&
           outputs.bridge_on == exact_.outputs.bridge_on;
}

/*
 * The start of an alignment writes its own member of the union in struct enabling, of a drive
 * without an encoder, too, before the one that is in use starts anew. What it writes over is not
 * compared in the period in which the state changes.
 */
bool Witness::compares(const Field &field, Memory after) const
{
    return state_.in_use(field, after.at) &&
           (field.condition < 0 || layout_.blocks[field.block].name != "enabling" ||
            !state_changes_);
}

/* What none of them has written need not be compared. */
void Witness::find_touched(Memory after)
{
    touched_.clear();
    state_changes_ = std::memcmp(after.at + supervision_.tested,
                                 &synchronised_[supervision_.tested], supervision_.bytes) != 0;
    for (const Block &block : layout_.blocks) {
        if (std::memcmp(after.at + block.tested, &synchronised_[block.tested],
                        block.tested_bytes) != 0 ||
            std::memcmp(&exact_.state[block.in_double], &origin_[block.in_double],
                        block.double_bytes) != 0) {
            touched_.push_back(&block);
        }
    }
}

std::string Witness::otherwise(Memory after, const Outcome &other)
{
    const Memory there = in_double(other.state);
    for (const Block *const block : touched_) {
        for (const std::size_t i : block->fields) {
            const Field &field = layout_.fields[i];
            if (!compares(field, after)) {
                continue;
            }
            if (field.kind == Kind::exact
                    ? std::memcmp(after.at + field.tested, there.at + field.in_double,
                                  field.bytes) != 0
                    : field.kind == Kind::pointer &&
                          state_.target(field, after) != state_.target(field, there)) {
                return field.path;
            }
        }
    }
    return "";
}

/* The last place of a number of the image tested; of what is a whole number in both: what the last
   place of an angle in turns is worth. */
double Witness::place(const Field &field, Memory after)
{
    constexpr double turn = 4294967296.0;
    switch (field.kind) {
    case Kind::integer:
        return 0.0;
    case Kind::angle:
    case Kind::position:
        return turn * (state_.fixed() ? num_place : float_place / 2.0);
    case Kind::unit:
    case Kind::num:
        if (state_.fixed()) {
            return field.kind == Kind::num ? num_place : unit_place;
        }
        break;
    default:
        if (state_.fixed()) {
            return std::abs(state_.number(field, after)) * unit_place;
        }
    }
    const double now = std::abs(state_.number(field, after));
    const double then = std::abs(state_.number(field, in_double(origin_)));
    const double last = std::max(now, then) * float_place;
    return std::isfinite(last) ? last : 0.0;
}

/* In float, of the largest number of a block: a sum may have it for a term, and be small. */
double Witness::largest_place(const Block &block, Memory after)
{
    double largest = 0;
    for (const std::size_t i : block.fields) {
        const Field &field = layout_.fields[i];
        if (!state_.fixed() && (field.kind == Kind::num || field.kind == Kind::unit) &&
            compares(field, after)) {
            largest = std::max(largest, place(field, after));
        }
    }
    return largest;
}

/* From the image that is tested to the other. */
double Witness::distance(const Field &field, Memory after, const Bytes &other)
{
    const Memory there = in_double(other);
    switch (field.kind) {
    case Kind::angle:
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(state_.whole(field, there)) -
                                         static_cast<std::uint32_t>(state_.whole(field, after)));
    case Kind::position:
    case Kind::integer:
        return static_cast<double>(
            static_cast<std::int64_t>(static_cast<std::uint64_t>(state_.whole(field, there)) -
                                      static_cast<std::uint64_t>(state_.whole(field, after))));
    default:
        break;
    }
    const double mine = state_.number(field, after), its = state_.number(field, there);
    if (mine == its || (std::isnan(mine) && std::isnan(its))) {
        return 0.0;
    }
    const double difference = its - mine;
    return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
}

/* Whether what is tested lies where those are that were drawn. */
bool Witness::is_within(double margin) const
{
    const auto [low, high] = std::minmax_element(distances_.begin(), distances_.end());
    const double apart = margin + beside * (*high - *low);
    return *low - apart <= 0.0 && *high + apart >= 0.0;
}

/* The first field that those which decide alike do not explain; "" if there is none. */
std::string Witness::unexplained(Memory after, const hal_outputs &outputs)
{
    std::vector<const Outcome *> alike; /* to round nothing is a rounding, too */
    if (exact_.otherwise.empty()) {
        alike.push_back(&exact_);
    }
    for (std::size_t i = 0; i < drawn_count_; ++i) {
        if (drawn_[i].otherwise.empty()) {
            alike.push_back(&drawn_[i]);
        }
    }
    if (alike.empty()) {
        return exact_.otherwise;
    }
    for (const Block *const block : touched_) {
        const double largest_term = largest_place(*block, after);
        for (const std::size_t i : block->fields) {
            const Field &field = layout_.fields[i];
            if (!is_a_magnitude(field) || !compares(field, after)) {
                continue;
            }
            const double full =
                field.kind == Kind::num || field.kind == Kind::unit ? largest_term : 0.0;
            distances_.clear();
            for (const Outcome *const one : alike) {
                distances_.push_back(distance(field, after, one->state));
            }
            if (!is_within(of_sums * place(field, after) + full)) {
                return field.path;
            }
        }
    }
    for (std::size_t leg = 0; leg < HAL_LEGS; ++leg) {
        distances_.clear();
        for (const Outcome *const one : alike) {
            distances_.push_back(one->outputs.high_counts[leg] - outputs.high_counts[leg]);
        }
        if (!is_within(0.0)) {
            return "outputs.high_counts";
        }
    }
    for (const Outcome *const one : alike) {
        if (one->outputs.bridge_on != outputs.bridge_on) {
            return "outputs.bridge_on";
        }
    }
    return "";
}

void Witness::judge(const hal_samples *samples, Memory after, const hal_outputs &outputs)
{
    findings_.periods++;
    drawn_count_ = 0;
    const bool alike = exact_.otherwise.empty();
    std::string field;
    for (const std::size_t count : draws) {
        while (drawn_count_ < count) {
            draw(samples, after);
        }
        field = unexplained(after, outputs);
        if (field.empty()) {
            break;
        }
    }
    if (alike) {
        note_differences(after);
    } else {
        findings_.decided_periods++;
        findings_.decided[exact_.otherwise]++;
    }
    if (field.empty() && !is_double_without_rounding(samples, after)) {
        field = "the same without rounding";
    }
    if (!field.empty()) {
        findings_.unexplained_periods++;
        findings_.unexplained[field]++;
        if (findings_.examples.size() < examples_shown) {
            findings_.examples.push_back(describe(field, after, outputs));
        }
        if (findings_.unexplained_periods >= unexplained_max) {
            throw Unexplained("too many periods are not explained");
        }
    }
}

void Witness::note_differences(Memory after)
{
    for (const Block *const block : touched_) {
        for (const std::size_t i : block->fields) {
            const Field &field = layout_.fields[i];
            if (!is_a_magnitude(field) || !compares(field, after)) {
                continue;
            }
            if (field.kind == Kind::integer) {
                continue; /* each has a unit of its own */
            }
            const bool is_whole = field.kind == Kind::angle || field.kind == Kind::position;
            const double full =
                state_.fixed() ? place(field, after) : std::max(place(field, after), float_place);
            const double places =
                std::abs(distance(field, after, exact_.state)) / (is_whole ? 1.0 : full);
            Seen &seen = findings_.blocks[block->name];
            double &worst = is_whole ? seen.angle : seen.places;
            if (places > worst) {
                worst = places;
                (is_whole ? seen.angle_of : seen.places_of) = field.path;
            }
        }
    }
}

std::string Witness::describe(const std::string &path, Memory after, const hal_outputs &outputs)
{
    std::ostringstream text;
    text << "period " << findings_.periods << ": " << path;
    std::size_t alike = 0;
    for (std::size_t i = 0; i < drawn_count_; ++i) {
        alike += drawn_[i].otherwise.empty();
    }
    text << ", " << alike << " of " << drawn_count_ << " draws decide alike";
    if (!exact_.otherwise.empty()) {
        text << ", in double otherwise: " << exact_.otherwise;
    }
    for (const Field &field : layout_.fields) {
        if (field.path != path || !state_.in_use(field, after.at)) {
            continue;
        }
        if (field.kind == Kind::num || field.kind == Kind::unit || field.kind == Kind::coef) {
            text << ", is " << state_.number(field, after) << ", was "
                 << state_.number(field, in_double(origin_));
        }
        if (is_a_magnitude(field)) {
            double low = std::numeric_limits<double>::infinity(), high = -low;
            for (std::size_t i = 0; i < drawn_count_; ++i) {
                if (drawn_[i].otherwise.empty()) {
                    const double one = distance(field, after, drawn_[i].state);
                    low = std::min(low, one);
                    high = std::max(high, one);
                }
            }
            text << ", double off by " << distance(field, after, exact_.state) << ", draws by "
                 << low << "..." << high;
        }
    }
    if (path == "outputs.high_counts") {
        for (std::size_t leg = 0; leg < HAL_LEGS; ++leg) {
            text << " " << outputs.high_counts[leg] << "/" << exact_.outputs.high_counts[leg];
        }
    }
    return text.str();
}

} // namespace

firmware_image witnessed(const firmware_image &tested, const Layout &layout, Findings &findings)
{
    witness = std::make_unique<Witness>(tested, layout, findings);
    firmware_image image = tested;
    image.init = [](void *drive, const hal *board, const drive_settings *settings, char *error) {
        return witness->tested().init(drive, board, settings, error) &&
               witness->init(drive, board,
                             [&](const firmware_image &in_double, void *memory, const hal *quiet) {
                                 return in_double.init(memory, quiet, settings, error);
                             });
    };
    image.init_stored = [](void *drive, const hal *board, const motor_params *motor, char *error) {
        return witness->tested().init_stored(drive, board, motor, error) &&
               witness->init(drive, board,
                             [&](const firmware_image &in_double, void *memory, const hal *quiet) {
                                 return in_double.init_stored(memory, quiet, motor, error);
                             });
    };
    image.control_cycle = [](void *drive, const hal_samples *samples) {
        return witness->control_cycle(drive, samples);
    };
    return image;
}

} // namespace one_step
