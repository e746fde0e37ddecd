#include "integrators/run/binary32.h"

#include <fmt/format.h>

namespace polhode {
namespace {

constexpr double max_float = std::numeric_limits<float>::max(), min_float = std::numeric_limits<float>::min();

bool is_representable(double x) { return std::abs(x) <= max_float; }
bool is_representable_nonzero(double x) { return is_representable(x) && x >= min_float; }
bool is_representable(const Vector3<double>& v) {
    return is_representable(v[0]) && is_representable(v[1]) && is_representable(v[2]);
}

std::string format_refusal(const char* what, double value) {
    return fmt::format("binary32 cannot represent {} {:.3g}", what, value);
}

}  // namespace

std::string binary32_refusal(const Problem& problem) {
    const ExactBody<double>& body = problem.body;
    for (int i = 0; i < 3; ++i) {
        const double moment = problem.body.principal.moments[i],
                     inverse = problem.body.principal_inertia.inverse_moments[i];
        if (!is_representable_nonzero(moment) || !is_representable_nonzero(inverse))
            return format_refusal("a moment of inertia of", moment);
    }
    if (!is_representable_nonzero(body.mass)) return format_refusal("a mass of", body.mass);
    for (const auto& [what, v] :
         {std::pair("an angular velocity of", body.angular_velocity_B), std::pair("a velocity of", body.velocity_W),
          std::pair("a position of", body.position_W)})
        if (!is_representable(v)) return format_refusal(what, std::hypot(v[0], v[1], v[2]));
    return "";
}

std::string binary32_system_refusal(const Problem& problem) {
    std::string why = binary32_refusal(problem);
    if (why.empty() && problem.needs.user_torque)
        why = "user-defined torques are evaluated in binary64 and are not supported in binary32";
    return why;
}

std::string binary32_step_refusal(double step) {
    return is_representable_nonzero(step) ? "" : format_refusal("a step of", step);
}

}  // namespace polhode
