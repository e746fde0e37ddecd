#include "integrators/run/stiffness.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "integrators/method.h"
#include "integrators/run/eigenvalues.h"
#include "motion/user_system.h"

namespace polhode {
namespace {

bool has_damping(const Problem& problem) {
    return std::any_of(problem.segments.begin(), problem.segments.end(), [&](const Segment& segment) {
        return segment.forcing.has_damping ||
               (segment.forcing.has_translational_drag && problem.needs.translation == Translation::integrated &&
                !problem.body.pivoted);
    });
}

// The largest |lambda| of the decaying eigenvalues. Those of pure rotation lie on the imaginary axis up to rounding.
double decay_rate(const std::vector<std::complex<double>>& eigenvalues) {
    double rate = 0;
    for (const std::complex<double>& lambda : eigenvalues)
        if (lambda.real() < -1e-3 * std::abs(lambda)) rate = std::max(rate, std::abs(lambda));
    return rate;
}

// For a mechanism: uses its initial state and the largest rate. Finds joints that are stiff from the start, but not
// joints that become stiff later.
Stiffness initial_stiffness(const Problem& problem) {
    constexpr int max_variables = 400;
    const Scene& scene = problem.scene;
    const bool damped =
        std::ranges::any_of(scene.joints, [](const Joint& j) { return j.damping[0] != 0 || j.damping[1] != 0; }) ||
        std::ranges::any_of(scene.loads, [](const Load& l) { return std::holds_alternative<Drag>(l); });
    ErasedSystem system(problem);
    const int n = system.size();
    if (!damped || n > max_variables) return {};
    std::vector<double> y(static_cast<std::size_t>(n)), J(y.size() * y.size());
    system.initial(y.data());
    Stiffness result;
    result.rotation = problem.scales.angular_velocity * scene.duration;
    for (const Segment& segment : problem.segments) {
        std::vector<double> after_impulses = y;
        system.enter(segment, after_impulses.data());
        jacobian(system, segment.begin, after_impulses.data(), J.data());
        if (!std::ranges::all_of(J, [](double entry) { return std::isfinite(entry); })) return {};
        result.decay_times += (segment.end - segment.begin) * decay_rate(eigenvalues(J));
    }
    return result;
}

}  // namespace

Stiffness stiffness(const Problem& problem) {
    const Method* method = find_method("radau");
    if (method && std::holds_alternative<MechanismSystem>(problem.system)) return initial_stiffness(problem);
    if (!method || problem.model() || !has_damping(problem) || problem.needs.user_torque ||
        !problem.scene.planes.empty())
        return {};
    Settings settings;
    settings.tolerance = 1e-3, settings.samples = 50, settings.max_steps = 5000;
    const Trajectory trajectory = solve(problem, *method, settings);
    if (trajectory.status != Status::ok) return {};
    Stiffness result;
    const std::vector<Sample>& samples = trajectory.samples;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        // trapezoidal rule
        const double before = k > 0 ? samples[k].t - samples[k - 1].t : 0;
        const double after = k + 1 < samples.size() ? samples[k + 1].t - samples[k].t : 0;
        const Vector3<double>& w = samples[k].angular_velocity_B;
        result.decay_times += (before + after) / 2 * decay_rate(eigenvalues(problem, samples[k]));
        // right end only: a spin that decays before the next sample rotates the body far less than the trapezoid
        result.rotation += k > 0 ? before * std::sqrt(dot(w, w)) : 0;
    }
    return result;
}

bool is_stiff(const Problem& problem) { return stiffness(problem).stiff(); }

}  // namespace polhode
