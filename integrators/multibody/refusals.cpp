#include "integrators/multibody/refusals.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "motion/mechanism.h"
#include "text/message.h"

namespace polhode::multibody {

namespace {

std::string system_refusal(const Problem& problem) {
    if (std::holds_alternative<MechanismSystem>(problem.system)) return "";
    if (problem.needs.system == SystemKind::mechanism_with_formulas)
        return "this method does not support loads given by formulas";
    return std::holds_alternative<UserSystem>(problem.system)
               ? "this method supports only scenes of several bodies, not user-defined systems"
               : "this method supports only scenes of several bodies with joints";
}

std::string restitution_refusal(const Scene& scene) {
    for (const Joint& joint : scene.joints)
        if (joint.limits.any() && joint.limits.restitution > 0)
            return fmt::format("the limits of joint \"{}\" have a restitution, which the method does not support",
                               one_line(joint.name, 60));
    return "";
}

}  // namespace

std::string mechanism_refusal(const Problem& problem) {
    for (const Joint& joint : problem.scene.joints)
        if (joint.friction != 0 || joint.limits.any())
            return "this method does not support friction and limits of joints";
    return system_refusal(problem);
}

std::string impulse_refusal(const Problem& problem) {
    if (std::string why = system_refusal(problem); !why.empty()) return why;
    if (!problem.scene.couplings.empty()) return "this method does not support couplings of joints";
    for (const Joint& joint : problem.scene.joints)
        if (joint.armature != std::array<double, 2>{})
            return fmt::format("joint \"{}\" has an armature, which the method does not support",
                               one_line(joint.name, 60));
    return body_without_inertia(problem.scene);
}

std::string soft_limit_refusal(const Problem& problem) {
    std::string why = restitution_refusal(problem.scene);
    return why.empty() ? impulse_refusal(problem) : why;
}

std::string reduced_limit_refusal(const Problem& problem) {
    if (std::string why = system_refusal(problem); !why.empty()) return why;
    if (!problem.scene.loops.empty()) return "this method does not support loops";
    if (!problem.scene.couplings.empty()) return "this method does not support couplings of joints";
    return restitution_refusal(problem.scene);
}

std::string mechanism_binary32_refusal(const Problem& problem) {
    if (!std::holds_alternative<MechanismSystem>(problem.system)) return "";
    if (std::string why = impulse_refusal(problem); !why.empty()) return why;
    constexpr double largest = std::numeric_limits<float>::max(), smallest = std::numeric_limits<float>::min();
    const auto holds = [&](double x) { return std::abs(x) <= largest; };
    const auto holds_well = [&](double x) { return holds(x) && holds(1 / x) && std::abs(x) >= smallest; };
    for (const LinkBody<double>& body : mechanism_of(problem).tree().links().bodies) {
        if (!holds_well(body.mass)) return fmt::format("binary32 cannot represent a mass of {:.3g}", body.mass);
        const Matrix3<double> inverse_inertia = inverse(body.inertia_B);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (!holds(body.inertia_B[i][j]) || !holds(inverse_inertia[i][j]) || !holds_well(body.inertia_B[i][i]))
                    return fmt::format("binary32 cannot represent a moment of inertia of {:.3g}", body.inertia_B[i][i]);
    }
    const Scales& scales = problem.scales;
    if (!holds(scales.position) || !holds(scales.velocity) || !holds(scales.angular_velocity))
        return "binary32 cannot represent the bodies' positions or velocities";
    return "";
}

}  // namespace polhode::multibody
