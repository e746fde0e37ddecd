#include "integrators/run/binary32.h"

#include <fmt/format.h>

namespace polhode {
namespace {

constexpr double largest = std::numeric_limits<float>::max(), smallest = std::numeric_limits<float>::min();

bool holds(double x) { return std::abs(x) <= largest; }
bool holds_not_zero(double x) { return holds(x) && x >= smallest; }
bool holds(const Vector3<double>& v) { return holds(v[0]) && holds(v[1]) && holds(v[2]); }

std::string not_held(const char* what, double value) {
    return fmt::format("binary32 cannot represent {} {:.3g}", what, value);
}

}  // namespace

std::string refused_by_binary32(const Problem& problem) {
    const ExactBody<double>& body = problem.body;
    for (int i = 0; i < 3; ++i) {
        const double moment = problem.body.principal.moments[i],
                     inverse = problem.body.principal_inertia.inverse_moments[i];
        if (!holds_not_zero(moment) || !holds_not_zero(inverse)) return not_held("a moment of inertia of", moment);
    }
    if (!holds_not_zero(body.mass)) return not_held("a mass of", body.mass);
    for (const auto& [what, v] :
         {std::pair("an angular velocity of", body.angular_velocity_B), std::pair("a velocity of", body.velocity_W),
          std::pair("a position of", body.position_W)})
        if (!holds(v)) return not_held(what, std::hypot(v[0], v[1], v[2]));
    return "";
}

std::string refused_by_binary32_system(const Problem& problem) {
    std::string why = refused_by_binary32(problem);
    if (why.empty() && problem.needs.user_torque)
        why = "user-defined torques are evaluated in binary64 and are not supported in binary32";
    return why;
}

std::string step_beyond_binary32(double step) { return holds_not_zero(step) ? "" : not_held("a step of", step); }

}  // namespace polhode
