#include "integrators/run/binary32.h"

#include <fmt/format.h>

#include <algorithm>

namespace polhode {
namespace {

constexpr double largest = std::numeric_limits<float>::max(), smallest = std::numeric_limits<float>::min();

bool holds(double x) { return std::abs(x) <= largest; }
bool holds_not_zero(double x) { return holds(x) && x >= smallest; }
bool holds(const Vector3<double>& v) { return holds(v[0]) && holds(v[1]) && holds(v[2]); }

}  // namespace

std::string beyond_binary32(const Problem& problem, const Settings& settings) {
    const auto refused = [](const char* what, double value) {
        return fmt::format("binary32 does not hold {} {:.3g}", what, value);
    };
    const ExactBody<double>& body = problem.body;
    for (int i = 0; i < 3; ++i) {
        const double moment = problem.principal.moments[i], inverse = problem.principal_inertia.inverse_moments[i];
        if (!holds_not_zero(moment) || !holds_not_zero(inverse)) return refused("a moment of inertia of", moment);
    }
    if (!holds_not_zero(body.mass)) return refused("a mass of", body.mass);
    if (!holds_not_zero(*settings.step)) return refused("a step of", *settings.step);
    for (const auto& [what, v] :
         {std::pair("an angular velocity of", body.angular_velocity_B), std::pair("a velocity of", body.velocity_W),
          std::pair("a place of", body.position_W)})
        if (!holds(v)) return refused(what, std::hypot(v[0], v[1], v[2]));
    return "";
}

}  // namespace polhode
