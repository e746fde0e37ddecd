#include "measure/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "body/elementary.h"

namespace polhode {
namespace {

template <class S>
S magnitude(const S& x) {
    return x < 0 ? -x : x;
}

// Rotation angle of a quaternion of any nonzero length: atan2 cancels the length.
template <class S>
S angle_of(const Quaternion<S>& r) {
    return S(2 * std::atan2(double(length(vector_part(r))), double(magnitude(r.w))));
}

template <class S>
S norm_error(const ComparedBody<S>& c) {
    if (c.orthogonality_defect) return S(*c.orthogonality_defect);
    // |q| - 1 = (|q|^2 - 1) / (|q| + 1), without cancellation in binary64
    const S square = squared_norm(c.computed.q);
    return magnitude(S(square - S(1))) / (square_root(square) + S(1));
}

// Zero if the value is within the round-off of its terms; the error is then absolute.
template <class S>
S or_zero(const S& value, const S& size) {
    return value > S(vanishing) * size ? value : S(0);
}

const std::vector<Measure>& table() {
    static const std::vector<Measure> all{
        {.name = "attitude",
         .title = "attitude",
         .unit = "rad",
         .meaning = "Angle between the attitude and the truth",
         .needs = known_truth,
         .tabled = true,
         .tabled_at_end = true,
         .over_time = true,
         .error = [](const auto& c) { return angle_of(conjugate(c.truth.q) * c.computed.q); }},
        {.name = "omega",
         .title = "angular velocity",
         .unit = "relative",
         .meaning = "|w_B - w_B,truth| over the run's largest |w|",
         .needs = known_truth | known_angular_velocity,
         .tabled = true,
         .error = [](const auto& c) { return length(c.computed.angular_velocity_B - c.truth.angular_velocity_B); },
         .scale = [](const auto& truth) { return length(truth.angular_velocity_B); }},
        {.name = "momentum",
         .title = "angular momentum",
         .unit = "relative",
         .meaning = "|L_W - L_W,truth| as a vector, over the run's largest |L|",
         .needs = known_truth | known_angular_velocity,
         .tabled = true,
         .over_time = true,
         .whole_error =
             [](const auto& c) { return length(c.computed.angular_momentum_W - c.truth.angular_momentum_W); },
         .whole_scale =
             [](const auto& truth) { return or_zero(length(truth.angular_momentum_W), truth.angular_size); }},
        {.name = "energy",
         .title = "energy",
         .unit = "relative",
         .meaning = "|E - E_truth| over the run's largest of |E| and the kinetic energy",
         .needs = known_truth | known_angular_velocity | known_center,
         .tabled = true,
         .over_time = true,
         .whole_error =
             [](const auto& c) { return magnitude(decltype(c.computed.energy)(c.computed.energy - c.truth.energy)); },
         .whole_scale = [](const auto& truth) { return std::max(truth.kinetic, magnitude(truth.energy)); }},
        {.name = "position",
         .title = "position",
         .unit = "m",
         .meaning = "Distance between the centre of mass and its true position",
         .needs = known_truth | known_position,
         .error = [](const auto& c) { return length(c.computed.position_W - c.truth.position_W); },
         .tabled_of_systems = true},
        {.name = "velocity",
         .title = "velocity",
         .unit = "m/s",
         .meaning = "|v - v_truth| of the centre of mass",
         .needs = known_truth | known_velocity,
         .error = [](const auto& c) { return length(c.computed.velocity_W - c.truth.velocity_W); }},
        {.name = "norm",
         .title = "norm of q",
         .unit = "",
         .meaning = "| |q| - 1 |; for matrix methods the Frobenius norm of A^T A - 1",
         .tabled = true,
         .over_time = true,
         .error = [](const auto& c) { return norm_error(c); }},
        {.name = "linear_momentum",
         .title = "linear momentum",
         .unit = "relative",
         .meaning = "|p_W - p_W,truth| of a mechanism without joints to the world, over the run's largest |p|",
         .needs = known_truth | known_velocity | known_free_system,
         .whole_error = [](const auto& c) { return length(c.computed.linear_momentum_W - c.truth.linear_momentum_W); },
         .whole_scale = [](const auto& truth) { return or_zero(length(truth.linear_momentum_W), truth.linear_size); },
         .of_one_body = false,
         .tabled_of_systems = true},
        {.name = "joint_gap",
         .title = "joint gap",
         .unit = "m",
         .meaning = "Largest distance between the two points of a joint, over all joints of the mechanism",
         .needs = known_position,
         .over_time = true,
         .whole_error = [](const auto& c) { return c.joints.gap; },
         .of_one_body = false,
         .tabled_of_systems = true,
         .suffix = ""},
        {.name = "joint_turn",
         .title = "joint misalignment",
         .unit = "rad",
         .meaning = "Largest angle between the two axes of a joint, over all joints of the mechanism",
         .over_time = true,
         .whole_error = [](const auto& c) { return c.joints.turn; },
         .of_one_body = false,
         .tabled_of_systems = true,
         .suffix = ""},
        {.name = "reaction",
         .title = "joint reactions",
         .unit = "relative",
         .meaning = "Error of joint force and torque, each over the run's largest, the largest over all joints of the "
                    "mechanism",
         .needs = known_truth | known_reactions,
         .whole_error = [](const auto& c) { return c.reaction_error; },
         .of_one_body = false,
         .tabled_of_systems = true},
    };
    return all;
}

}  // namespace

std::span<const Measure> measures() { return table(); }

std::size_t measure_index(std::string_view name) {
    const auto found = std::ranges::find(table(), name, &Measure::name);
    if (found == table().end()) throw std::invalid_argument(fmt::format("unknown measure \"{}\"", name));
    return static_cast<std::size_t>(found - table().begin());
}

double attitude_error(const Quaternion<double>& q, const Quaternion<Pair>& reference) {
    const auto wide = [](const Pair& pair) { return Wide(pair.high) + Wide(pair.low); };
    const Quaternion<Wide> truth{wide(reference.w), wide(reference.x), wide(reference.y), wide(reference.z)};
    return double(angle_of(conjugate(truth) * cast<Wide>(q)));
}

}  // namespace polhode
