#include "integrators/analysis/conditioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "integrators/analysis/model_conditioning.h"
#include "integrators/analysis/sensitivity_closed_form.h"
#include "integrators/analysis/spectral_norm.h"
#include "integrators/run/processor_time.h"
#include "integrators/run/stiffness.h"
#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/sensitivity_session.h"
#include "motion/formula_model.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/interruption.h"

namespace polhode {
namespace {

// Tolerance R: an error of R in the state grows to kappa R, and the relative error of kappa along the motion is about
// the same. Adams' formulas reach order 12, so that a fine tolerance costs little: on a chaotic top with kappa 6e6,
// 2530 steps at 1e-9 give a relative error of 1e-2, 5737 steps at 1e-14 give 1e-7.
constexpr double adams_tolerance = 1e-14, bdf_tolerance = 1e-9;

// Derivative of p and v with respect to their initial values if both have a closed form; the same for all three axes.
// dv decays, and dp is its integral.
struct FreeFlight {
    double velocity_factor = 1, position_slope = 0;  // dv/dv0; dp/dv0, s

    void advance(const Segment& segment, double until) {
        const double k = segment.forcing.has_translational_drag ? segment.forcing.specific_drag : 0;
        const double t = until - segment.begin;
        position_slope += velocity_factor * (k == 0 ? t : -std::expm1(-k * t) / k);
        velocity_factor *= std::exp(-k * t);
    }
    double norm(const Scales& scales) const {
        Eigen::Matrix2d block;
        block << 1, position_slope * scales.velocity / scales.position, 0, velocity_factor;
        return spectral_norm(block);
    }
};

// Adds kappa from the derivative S at time t. `flight`: derivative of p and v up to the start of the segment.
template <class M>
void append_kappa(Conditioning& result, const Problem& problem, const Segment& segment, double t, const M& S,
                  FreeFlight flight) {
    const Eigen::Matrix<double, 3, M::ColsAtCompileTime> attitude = S.template topRows<3>();
    double state = spectral_norm(S);
    if (problem.needs.translation == Translation::closed_form) {
        flight.advance(segment, t);
        state = std::max(state, flight.norm(problem.scales));
    }
    result.times.push_back(t), result.state.push_back(state), result.attitude.push_back(spectral_norm(attitude));
}

template <class SystemType>
Conditioning run_sensitivities(const Problem& problem, const std::vector<double>& times,
                               const ConditioningSettings& settings) {
    Conditioning result;
    const bool stiff = is_stiff(problem);
    const double tolerance = settings.tolerance.value_or(stiff ? bdf_tolerance : adams_tolerance);
    const long max_steps = settings.max_steps;
    const double end = processor_time() + settings.seconds_limit;
    SensitivitySession<SystemType> session(problem, stiff ? Multistep::bdf : Multistep::adams,
                                           stiff ? Iteration::newton : Iteration::functional, tolerance);
    FreeFlight flight;
    const auto fail = [&](std::string message) {
        result.message = std::move(message);
        return false;
    };
    SampleQueue samples(times);
    const Segment* current = nullptr;
    const auto enter = [&](const Segment& segment) {
        if (samples.empty()) return false;
        current = &segment;
        const int flag = session.enter(segment);
        return flag >= 0 || fail(session.failure(flag).message);
    };
    const auto record = [&](double t) {
        const Sensitivity<SystemType> S = t == session.time() ? session.sensitivity() : session.sensitivity_inside(t);
        append_kappa(result, problem, *current, t, S, flight);
        return std::isfinite(result.state.back()) || fail(fmt::format("kappa is beyond binary64 at t = {:g} s", t));
    };
    const auto integrate = [&](const Segment& segment) {
        while (session.time() < segment.end && !samples.empty()) {
            result.limit_reached = ++result.steps > max_steps;
            if (result.limit_reached)
                return fail(fmt::format("stopped at the limit of {} steps, at t = {:g} s", max_steps, session.time()));
            if (Interruption::is_requested()) return fail("interrupted");
            if (processor_time() > end)
                return fail(fmt::format("stopped at the limit of {} s", settings.seconds_limit));
            if (const int flag = session.step(); flag < 0) return fail(session.failure(flag).message);
            for (; samples.due(segment, session.time()); samples.pop())
                if (!record(samples.front())) return false;
        }
        flight.advance(segment, segment.end);
        return true;
    };
    follow(problem.segments, samples, enter, record, integrate);
    result.available = samples.empty();
    if (!result.available) return result;
    result.message =
        fmt::format("CVODES' forward sensitivities, {}, relative tolerance {:g}, {} steps",
                    stiff ? "backward differentiation formulas" : "Adams' formulas", tolerance, result.steps);
    return result;
}

// Above this rotation, rad, CVODES takes about 10^5 steps; a closed form, if there is one, takes none.
constexpr double max_radians_by_steps = 4000;

bool try_closed_form(const Problem& problem, const std::vector<double>& times, Conditioning& result) {
    if (!(problem.scales.angular_velocity * times.back() > max_radians_by_steps)) return false;
    const std::vector<Eigen::Matrix<double, 6, 6>> derivatives = sensitivity_by_closed_form(problem, times);
    if (derivatives.empty()) return false;
    for (std::size_t k = 0; k < times.size(); ++k)
        append_kappa(result, problem, problem.segments.front(), times[k], derivatives[k], {});
    result.available = true;
    result.message = "differences of the closed form in 113 bits";
    return true;
}

Conditioning compute_conditioning(const Problem& problem, const std::vector<double>& times,
                                  const ConditioningSettings& settings) {
    if (Conditioning closed_form; try_closed_form(problem, times, closed_form)) return closed_form;
    if (problem.needs.translation == Translation::integrated)
        return run_sensitivities<LoadedMotion>(problem, times, settings);
    if (problem.needs.torque_free) return run_sensitivities<FreeRotation>(problem, times, settings);
    return run_sensitivities<LoadedRotation>(problem, times, settings);
}

void check_times(const std::vector<double>& times) {
    if (times.empty()) throw std::invalid_argument("no times given");
    for (std::size_t i = 0; i < times.size(); ++i)
        if (!std::isfinite(times[i]) || times[i] < (i == 0 ? 0 : times[i - 1]))
            throw std::invalid_argument("times must be finite, not negative and not decreasing");
}

// Why the motion has no conditioning; empty if it has.
std::string conditioning_refusal(const Problem& problem) {
    if (!problem.scene.planes.empty()) return "conditioning through impacts on planes is not supported";
    if (has_sphere_contacts(problem.scene)) return "conditioning through contacts of spheres is not supported";
    for (const Joint& joint : problem.scene.joints) {
        if (!joint.motion.empty()) return "conditioning with prescribed motions of joints is not supported";
        if (joint.friction != 0 || joint.limits.any())
            return "conditioning through friction and limits of joints is not supported";
    }
    if (has_switches(problem)) return "conditioning through switching points of formulas is not supported";
    return problem.needs.system == SystemKind::user_defined ? "conditioning is not available for user-defined systems"
                                                            : "";
}

Peak find_peak(const std::vector<double>& times, const std::vector<double>& values) {
    Peak peak;
    for (std::size_t k = 0; k < values.size(); ++k)
        if (k == 0 || values[k] > peak.value) peak = {values[k], times[k]};
    return peak;
}

}  // namespace

Peak Conditioning::state_peak() const { return find_peak(times, state); }
Peak Conditioning::attitude_peak() const { return find_peak(times, attitude); }
double Conditioning::floor(std::size_t k, double roundoff) const {
    return std::min(attitude.at(k) * roundoff, std::numbers::pi);
}
Peak Conditioning::floor_peak(double roundoff) const {
    const Peak peak = attitude_peak();
    return {std::min(peak.value * roundoff, std::numbers::pi), peak.time};
}

Conditioning conditioning(const Problem& problem, const std::vector<double>& times,
                          const ConditioningSettings& settings) {
    check_times(times);
    if (problem.formulation != Formulation::reduced && !problem.model())
        return conditioning(problem.scene, times, settings);
    Conditioning result;
    result.message = conditioning_refusal(problem);
    if (!result.message.empty()) return result;
    if (times.back() > problem.scene.duration)
        throw std::invalid_argument("times must not exceed the scene's duration");
    result =
        problem.model() ? model_conditioning(problem, times, settings) : compute_conditioning(problem, times, settings);
    if (const double limit = 1 / float64_roundoff; result.state_peak().value > limit) {
        std::size_t k = 0;
        while (!(result.state[k] > limit)) ++k;
        result.message +=
            fmt::format("; from t = {:g} s on, binary64 cannot follow this motion: kappa is that of a nearby motion",
                        result.times[k]);
    }
    return result;
}

Conditioning conditioning(const Scene& scene, const std::vector<double>& times, const ConditioningSettings& settings) {
    check_times(times);
    Scene extended = scene;
    extended.duration = std::max(scene.duration, times.back());
    return conditioning(pose(extended), times, settings);
}

}  // namespace polhode
