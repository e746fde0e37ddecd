#include "experiment/run/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace polhode {
namespace {

constexpr double pilot_revolutions = 50;
constexpr int loosest = -1, tightest = -15;  // decades of tolerance

// evaluations per revolution; infinite for a failed run
double cost(const Problem& problem, const Method& method, const Settings& settings) {
    const Trajectory trajectory = solve(problem, method, settings);
    if (trajectory.status != Status::ok) return std::numeric_limits<double>::infinity();
    return static_cast<double>(trajectory.rhs_evaluations) / pilot_revolutions;
}

double two_digits(double value) { return std::stod(fmt::format("{:.1e}", value)); }

Calibration step_for(const Problem& problem, const Method& method, double revolution, double evaluations) {
    constexpr double steps = 32;
    Settings settings;
    settings.record = false, settings.samples = 1, settings.step = revolution / steps;
    const Trajectory pilot = solve(problem, method, settings);
    if (pilot.status == Status::unsupported) return {false, 0, pilot.message};
    if (pilot.steps < 1) return {false, 0, "the pilot run took no steps: " + pilot.message};
    const double per_step = static_cast<double>(pilot.rhs_evaluations) / static_cast<double>(pilot.steps);
    return {true, revolution * per_step / evaluations, ""};
}

// Finds the tightest affordable decade, then bisects towards the next one. Failed runs are skipped, because a tolerance
// can be too loose for a method as well as too tight.
Calibration tolerance_for(const Problem& problem, const Method& method, double evaluations) {
    Settings settings;
    settings.record = false, settings.samples = 1;
    // a step needs at least one evaluation, so a run with more steps than evaluations is not affordable
    settings.max_steps = static_cast<long>(std::min(pilot_revolutions * evaluations, 1e15)) + 1;
    const auto affordable = [&](int exponent, double further = 0) {
        settings.tolerance = std::pow(10, exponent + further);
        return cost(problem, method, settings) <= evaluations;
    };
    settings.tolerance = 1e-3;
    if (const Trajectory pilot = solve(problem, method, settings); pilot.status == Status::unsupported)
        return {false, 0, pilot.message};
    int exponent = tightest;
    while (exponent <= loosest && !affordable(exponent)) ++exponent;
    if (exponent > loosest)
        return {false, 0, fmt::format("needs more than {:g} evaluations per revolution at any tolerance", evaluations)};
    if (exponent == tightest) return {true, two_digits(std::pow(10, tightest)), ""};
    double below = -1, above = 0;
    while (above - below > 0.02) {
        const double middle = (above + below) / 2;
        (affordable(exponent, middle) ? above : below) = middle;
    }
    return {true, two_digits(std::pow(10, exponent + above)), ""};
}

}  // namespace

double revolution_time(const Scene& scene) {
    const Vector3<double>& w = scene.initial.angular_velocity;
    return 2 * std::numbers::pi / std::sqrt(dot(w, w));
}

Calibration calibrate(const Scene& scene, const Method& method, SettingKind kind, double evaluations) {
    if (is_mechanism(scene)) return {false, 0, "evaluations per revolution are defined for one body only"};
    const double revolution = revolution_time(scene);
    if (!std::isfinite(revolution))
        return {false, 0, "the body is at rest at the start, so evaluations per revolution are undefined"};
    Scene pilot = scene;
    pilot.duration = pilot_revolutions * revolution;
    const Problem problem = pose(pilot);
    return kind == SettingKind::step ? step_for(problem, method, revolution, evaluations)
                                     : tolerance_for(problem, method, evaluations);
}

}  // namespace polhode
