#include "check/convention.h"

#include <fmt/format.h>

#include <numbers>
#include <optional>
#include <stdexcept>

#include "text/message.h"

namespace polhode {
namespace {

// Returns v in polhode's axes: v here = M v there.
Vector3<double> rotate_to_z_up(Axes axes, const Vector3<double>& v) {
    switch (axes) {
        case Axes::z_up_right:
            break;
        case Axes::y_up_right:
            return {v[0], -v[2], v[1]};
        case Axes::z_up_left:
            return {v[0], -v[1], v[2]};
        case Axes::y_up_left:
            return {v[0], v[2], v[1]};
    }
    return v;
}

// Returns v in the other axes. Mirrors are their own inverses.
Vector3<double> rotate_from_z_up(Axes axes, const Vector3<double>& v) {
    if (axes == Axes::y_up_right) return {v[0], v[2], -v[1]};
    return rotate_to_z_up(axes, v);
}

bool is_mirror(Axes axes) { return axes == Axes::z_up_left || axes == Axes::y_up_left; }

Vector3<double> apply_handedness(Axes axes, const Vector3<double>& v) { return is_mirror(axes) ? -v : v; }

struct LengthUnit {
    std::string_view name, short_name;
    double metres;
};
constexpr LengthUnit known_lengths[] = {{"metres", "m", 1},
                                        {"centimetres", "cm", 0.01},
                                        {"millimetres", "mm", 0.001},
                                        {"inches", "in", 0.0254},
                                        {"feet", "ft", 0.3048}};

const std::vector<std::string>& convention_words() {
    static const std::vector<std::string> list{
        "y-up",    "z-up",       "left-handed", "right-handed", "scalar-first", "scalar-last", "degrees",
        "radians", "body-rates", "world-rates", "metres",       "centimetres",  "millimetres", "inches",
        "feet",    "unity",      "unreal",      "godot",        "three",        "bullet"};
    return list;
}

// A choice that can be made only once.
template <class T>
struct WordChoice {
    std::optional<T> made;
    std::string word;

    void make(T value, const std::string& by) {
        if (made && *made != value)
            throw std::invalid_argument(fmt::format("{} contradicts {}; give one of them", by, word));
        made = value, word = by;
    }
};

}  // namespace

const std::map<std::string, std::string>& length_units() {
    static const std::map<std::string, std::string> all = [] {
        std::map<std::string, std::string> units;
        for (const LengthUnit& unit : known_lengths) units.emplace(unit.short_name, unit.name);
        return units;
    }();
    return all;
}

std::optional<double> length_unit(std::string_view name) {
    for (const LengthUnit& unit : known_lengths)
        if (name == unit.name || name == unit.short_name) return unit.metres;
    return {};
}

Convention parse_convention(std::string_view text) {
    WordChoice<bool> y_up, left, scalar_last, degrees, body_rates;
    WordChoice<double> unit;
    for (std::size_t begin = 0;;) {
        const std::size_t comma = text.find(',', begin);
        const std::string word(text.substr(begin, comma - begin));
        if (word == "y-up" || word == "z-up")
            y_up.make(word == "y-up", word);
        else if (word == "left-handed" || word == "right-handed")
            left.make(word == "left-handed", word);
        else if (word == "scalar-first" || word == "scalar-last")
            scalar_last.make(word == "scalar-last", word);
        else if (word == "degrees" || word == "radians")
            degrees.make(word == "degrees", word);
        else if (word == "body-rates" || word == "world-rates")
            body_rates.make(word == "body-rates", word);
        else if (word == "unity" || word == "godot" || word == "three" || word == "bullet")
            y_up.make(true, word), left.make(word == "unity", word);
        else if (word == "unreal")
            y_up.make(false, word), left.make(true, word), unit.make(0.01, word);
        else if (word.size() > 2 && length_unit(word))
            unit.make(*length_unit(word), word);
        else
            throw std::invalid_argument(fmt::format("unknown convention {}; {}known: {}",
                                                    word.empty() ? "\"\"" : one_line(word, 60),
                                                    word.empty() || did_you_mean(word, convention_words()).empty()
                                                        ? ""
                                                        : did_you_mean(word, convention_words()) + " ",
                                                    join_with_commas(convention_words())));
        if (comma == text.npos) break;
        begin = comma + 1;
    }
    Convention convention;
    if (y_up.made.value_or(false))
        convention.axes = left.made.value_or(false) ? Axes::y_up_left : Axes::y_up_right;
    else if (left.made.value_or(false))
        convention.axes = Axes::z_up_left;
    if (scalar_last.made)
        convention.quaternion = *scalar_last.made ? QuaternionColumns::scalar_last : QuaternionColumns::scalar_first;
    convention.degrees = degrees.made.value_or(false);
    convention.body_rates = body_rates.made.value_or(false);
    convention.length_unit = unit.made.value_or(1);
    return convention;
}

std::string name_of(const Convention& convention) {
    std::vector<std::string> selected;
    if (convention.axes == Axes::y_up_right || convention.axes == Axes::y_up_left) selected.emplace_back("y-up");
    if (is_mirror(convention.axes)) selected.emplace_back("left-handed");
    if (convention.quaternion == QuaternionColumns::scalar_first) selected.emplace_back("scalar-first");
    if (convention.quaternion == QuaternionColumns::scalar_last) selected.emplace_back("scalar-last");
    if (convention.degrees) selected.emplace_back("degrees");
    if (convention.body_rates) selected.emplace_back("body-rates");
    for (const LengthUnit& unit : known_lengths)
        if (unit.metres == convention.length_unit && unit.metres != 1) selected.emplace_back(unit.name);
    return fmt::format("{}", fmt::join(selected, ","));
}

Vector3<double> vector_from(Axes axes, const Vector3<double>& v) { return rotate_to_z_up(axes, v); }
Vector3<double> vector_to(Axes axes, const Vector3<double>& v) { return rotate_from_z_up(axes, v); }
Vector3<double> pseudovector_from(Axes axes, const Vector3<double>& v) {
    return apply_handedness(axes, rotate_to_z_up(axes, v));
}
Vector3<double> pseudovector_to(Axes axes, const Vector3<double>& v) {
    return apply_handedness(axes, rotate_from_z_up(axes, v));
}

// M R(q) M^T is the rotation by the same angle about the axis, transformed as a pseudovector.
Quaternion<double> quaternion_from(Axes axes, const Quaternion<double>& q) {
    const Vector3<double> u = pseudovector_from(axes, vector_part(q));
    return {q.w, u[0], u[1], u[2]};
}
Quaternion<double> quaternion_to(Axes axes, const Quaternion<double>& q) {
    const Vector3<double> u = pseudovector_to(axes, vector_part(q));
    return {q.w, u[0], u[1], u[2]};
}

void convert(TrajectoryFile& file, const Convention& convention) {
    const Axes axes = convention.axes;
    for (TrajectoryRow& row : file.rows) {
        row.q = quaternion_from(axes, row.q);
        row.angular_velocity_W = pseudovector_from(axes, row.angular_velocity_W);
        if (convention.degrees) row.angular_velocity_W = (std::numbers::pi / 180) * row.angular_velocity_W;
        if (convention.body_rates)
            row.angular_velocity_W = (1 / squared_norm(row.q)) * rotate(row.q, row.angular_velocity_W);
        row.position_W = convention.length_unit * vector_from(axes, row.position_W);
        row.velocity_W = convention.length_unit * vector_from(axes, row.velocity_W);
    }
}

}  // namespace polhode
