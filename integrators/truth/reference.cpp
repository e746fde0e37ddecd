// Computes reference solutions (ground truth), each with an error bound from the difference of two runs.
//
// find_truth() validates the scene, searches the cache and otherwise calls compute(). compute() repeats attempts with
// more local digits until both runs agree to the requested digits. select_formulas() selects the pair of runs:
//   Formulas::series                      Taylor series, Euler's equations and world momenta (attempt_taylor.h)
//   Formulas::collocation                 Radau IIA, the same formulations, for stiff motion (attempt_collocation.h)
//   Formulas::closed_form                 from both ends, start checked by a series (attempt_closed_form.cpp)
//   attempt_contact()                     Taylor series, contact modes (attempt_contact.h, attempt_spheres.h)
//   Formulas::series_with_formula_loads   Taylor series, Euler's equations and world momenta (attempt_formula.h)
//   Formulas::mechanism_with_formula_loads Taylor series, joint and maximal coordinates (formula_mechanism_attempt.h)
//   Formulas::series_in_joint_coordinates Taylor series, joint and maximal coordinates (attempt_mechanism.h)
// Both runs share rounding errors of the mass properties and the initial state, which their difference does not show.
// SharedData adds these errors to the bound (shared.h).
#include "integrators/truth/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "integrators/contact/joint_events.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/truth/allowance.h"
#include "integrators/truth/attempt.h"
#include "integrators/truth/attempt_formula.h"
#include "integrators/truth/cache.h"
#include "integrators/truth/rounded_decimal.h"
#include "integrators/truth/shared.h"
#include "integrators/truth/strong_damping.h"
#include "motion/contact.h"
#include "motion/problem.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/content_hash.h"
#include "text/interruption.h"

namespace polhode {
namespace {

using truth::Attempt;
using truth::is_strongly_damped;
using truth::Truth;

Truth make_unavailable(std::string message) {
    Truth truth;
    truth.reference.message = std::move(message);
    return truth;
}

constexpr int default_digits = 25;
// digits written beyond the requested ones, so that rounding keeps the requested ones correct
constexpr int guard_digits = 2;

// Beyond this rotation, rad, a series takes hours; a closed form, if there is one, costs the same at any time. Below it
// the series is the reference, so that a closed form is not compared with the same closed form.
constexpr double max_series_rotation = 2e5;
bool prefers_closed_form(const Problem& problem) {
    return problem.scales.angular_velocity * problem.scene.duration > max_series_rotation &&
           truth::has_single_closed_form(problem);
}

// the arithmetic carries at least six digits more than the local error of a step
bool fits_50_digits(double local_digits) { return local_digits <= 44; }
constexpr double min_100_digits = 45;

/// Method that computes the motion.
enum class Formulas {
    closed_form,
    series_in_joint_coordinates,
    collocation,
    series_with_formula_loads,
    mechanism_with_formula_loads,
    series
};

Formulas select_formulas(const Problem& problem) {
    if (std::holds_alternative<MechanismSystem>(problem.system)) return Formulas::series_in_joint_coordinates;
    if (problem.needs.system == SystemKind::mechanism_with_formulas) return Formulas::mechanism_with_formula_loads;
    if (problem.needs.system == SystemKind::body_with_formulas) return Formulas::series_with_formula_loads;
    return prefers_closed_form(problem)  ? Formulas::closed_form
           : is_strongly_damped(problem) ? Formulas::collocation
                                         : Formulas::series;
}

// Runs that pass different events cannot be compared, and flights that are too short for the arithmetic do not end.
// More digits may help in both cases.
bool may_need_digits(const std::string& fault, double local_digits) {
    return fault.starts_with("the two formulations disagree") ||
           (fits_50_digits(local_digits) && fault.find("too many impacts") != std::string::npos);
}

Attempt refused_attempt(const std::string& why) {
    Attempt result;
    result.fault = why;
    return result;
}

// Whether the motion is followed by contact modes.
bool has_contacts(const Problem& problem) {
    return has_sphere_contacts(problem.scene) || !problem.scene.planes.empty();
}

Attempt attempt_contact(const Problem& problem, const std::vector<double>& times, double local_digits) {
    if (has_sphere_contacts(problem.scene))
        return fits_50_digits(local_digits) ? truth::attempt_by_sphere_contacts<50>(problem, times, local_digits)
                                            : truth::attempt_by_sphere_contacts<100>(problem, times, local_digits);
    return fits_50_digits(local_digits) ? truth::attempt_by_contact_modes<50>(problem, times, local_digits)
                                        : truth::attempt_by_contact_modes<100>(problem, times, local_digits);
}

Attempt attempt(const Problem& problem, const std::vector<double>& times, double local_digits) {
    const bool use_50_digits = fits_50_digits(local_digits);
    if (contact::has_joint_events(problem.scene))
        return use_50_digits ? truth::attempt_by_joint_events<50>(problem, times, local_digits)
                             : truth::attempt_by_joint_events<100>(problem, times, local_digits);
    if (has_contacts(problem)) return attempt_contact(problem, times, local_digits);
    switch (select_formulas(problem)) {
        case Formulas::closed_form:
            return truth::attempt_by_closed_form(problem, times, local_digits);
        case Formulas::series_in_joint_coordinates:
            return use_50_digits ? truth::attempt_by_mechanism_series<50>(problem, times, local_digits)
                                 : truth::attempt_by_mechanism_series<100>(problem, times, local_digits);
        case Formulas::collocation:
            return use_50_digits ? truth::attempt_by_collocation<50>(problem, times, local_digits)
                                 : truth::attempt_by_collocation<100>(problem, times, local_digits);
        case Formulas::series_with_formula_loads:
            return use_50_digits ? truth::attempt_by_formula_series<50>(problem, times, local_digits)
                                 : truth::attempt_by_formula_series<100>(problem, times, local_digits);
        case Formulas::mechanism_with_formula_loads:
            if (use_50_digits) return truth::attempt_by_formula_mechanism<50>(problem, times, local_digits);
            return refused_attempt(
                "scenes of several bodies with formulas are computed in 50 digits, which do not suffice");
        case Formulas::series:
            break;
    }
    return use_50_digits ? truth::attempt_by_taylor<50>(problem, times, local_digits)
                         : truth::attempt_by_taylor<100>(problem, times, local_digits);
}

// Effect of rounding errors in the data that both runs share (mass properties, initial state).
class SharedData {
  public:
    SharedData(const Problem& problem, double duration)
        : problem_(problem), radians_(problem.scales.angular_velocity * duration) {}

    /// Smallest error of a reference whose steps have `local_digits` digits.
    double error(double local_digits, double difference = 0) {
        const bool use_50_digits = !prefers_closed_form(problem_) && fits_50_digits(local_digits);
        std::optional<double>& rounding = use_50_digits ? rounding_50_ : rounding_100_;
        if (!rounding)
            rounding = use_50_digits ? truth::shared_rounding<50>(problem_.scene)
                                     : truth::shared_rounding<100>(problem_.scene);
        return truth::shared_error(*rounding, radians_, difference, use_50_digits ? 50 : 100, local_digits);
    }
    /// Adds this error to the bound of an attempt.
    void add_to_bound(Attempt& attempt, double local_digits) {
        double& bound = attempt.truth.reference.bound;
        const double least = error(local_digits, bound);
        if (least <= bound) return;
        bound = least;
        attempt.agreed_digits = std::min(attempt.agreed_digits, -std::log10(least));
    }

  private:
    const Problem& problem_;
    double radians_;
    std::optional<double> rounding_50_, rounding_100_;
};

// Digits that the rotation rate about the axis of the smallest moment loses if it is computed from momenta.
double digits_lost_by_momenta(const Problem& problem) {
    if (!std::holds_alternative<OneBody>(problem.system)) return 0;
    const Vector3<double>& I = problem.body.principal.moments;
    return std::log10(std::max({I[0], I[1], I[2]}) / std::min({I[0], I[1], I[2]}));
}

// Repeats attempts until the digits agree. Each attempt adds the digits that the last one lost (local minus agreed).
Truth compute(const Scene& scene, const std::vector<double>& times, int digits) {
    const Problem problem = pose(scene);
    if (!scene.planes.empty() && is_strongly_damped(problem))
        return make_unavailable("no truth: stiff motions require collocation, which does not support planes");
    double local = digits + 8, max_agreed = 0;
    std::string fault;
    SharedData shared(problem, times.back());
    const double required = std::pow(10.0, -digits);
    if (shared.error(local) > required) local = std::max(local, min_100_digits);
    if (!(shared.error(local) <= required))
        return make_unavailable(
            fmt::format("no truth to {} digits: computing the body's mass, moments, axes and initial state loses them "
                        "to cancellation in 100 digits; fewer are lost with a larger inertia about the centre of mass "
                        "relative to the mass times the pivot's distance squared",
                        digits));
    // Momenta that do not represent a rate let it grow without bound. A closed form, if there is one, is used instead.
    const double lost_digits = digits_lost_by_momenta(problem);
    if (lost_digits + digits > 50) local = std::max(local, min_100_digits);
    const bool without_momenta = !has_contacts(problem) && lost_digits + digits > 100 &&
                                 !prefers_closed_form(problem) && truth::has_single_closed_form(problem);
    for (int attempts = 0; attempts < 3 && local <= 94; ++attempts) {
        Attempt result = without_momenta ? truth::attempt_by_series_and_closed_form(problem, times, local)
                                         : attempt(problem, times, local);
        fault = result.fault;
        if (may_need_digits(fault, local)) {
            local += 10;
            continue;
        }
        if (!fault.empty()) break;
        shared.add_to_bound(result, local);
        // no digit agrees: one of the formulations may have lost the component that determines the motion
        if (result.agreed_digits < 1 && attempts == 0 && truth::has_single_closed_form(problem)) {
            Attempt other = truth::attempt_by_series_and_closed_form(problem, times, digits + 12);
            if (other.fault.empty()) shared.add_to_bound(other, std::max(local, min_100_digits));
            if (other.fault.empty() && other.agreed_digits > result.agreed_digits) result = std::move(other);
        }
        max_agreed = std::max(max_agreed, result.agreed_digits);
        if (result.agreed_digits >= digits) {
            result.truth.reference.available = true;
            return result.truth;
        }
        local = digits + (local - result.agreed_digits) + 6;
    }
    if (!fault.empty()) {
        Truth failed = make_unavailable("no truth: " + fault);
        failed.limit_reached = fault == truth::Allowance::fault;
        return failed;
    }
    return make_unavailable(
        fmt::format("no truth to {} digits: the motion is so sensitive that at most {} digits agree", digits,
                    static_cast<int>(std::max(0.0, std::floor(max_agreed)))));
}

// Returns the reference cached under `key`, or computes it at the given times and caches it.
Truth find_or_compute(const Scene& scene, const std::string& key, const std::vector<double>& times, int digits,
                      double seconds_limit) {
    if (std::optional<Truth> known = truth::read_cached(key)) return *std::move(known);
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const truth::CacheClaim claim(key, [&] { return seconds() > seconds_limit || Interruption::is_requested(); });
    if (std::optional<Truth> known = truth::read_cached(key)) return *std::move(known);
    const truth::Allowance allowance(seconds_limit);
    const truth::MpfrConstants constants;
    Truth result = compute(scene, times, digits);
    result.seconds = seconds();
    // the other thread may have used up its time even if this one has not
    result.limit_reached = !result.reference.available && (truth::Allowance::is_spent() || result.limit_reached);
    if (result.limit_reached)
        result.reference.message = fmt::format("no truth within the limit of {} s", seconds_limit);
    else
        truth::store(key, result);
    return result;
}

// Why no reference can be computed; empty if it can.
std::string refusal(const Scene& scene, int digits) {
    if (digits < 1) throw std::invalid_argument("the number of digits must be at least 1");
    validate(scene, scene.name);
    for (const Load& load : scene.loads)
        if (std::holds_alternative<UserTorque>(load)) return "no truth: user-defined torques are not supported";
    if (digits > most_truth_digits)
        return fmt::format("no truth to {} digits: at most {} digits are available without certification", digits,
                           most_truth_digits);
    return "";
}

DecimalReference convert_to_decimals(const Truth& truth, const Scene& scene, int digits) {
    DecimalReference result;
    result.available = truth.reference.available;
    result.message = truth.reference.message;
    // rounding changes each component by at most 5 10^-written of its value, an attitude by twice that
    const int written = digits + guard_digits;
    result.bound = truth.reference.bound + std::pow(10.0, 1 - written);
    result.scene_hash = content_hash(write_scene(scene));
    for (const std::string& t : truth.impact_decimals)
        result.impact_times.push_back(truth::rounded_decimal(t, written));
    result.impact_time_error = truth.reference.impact_time_error;
    result.bodies = truth.reference.bodies;
    for (std::size_t i = 0; i < truth.reference.samples.size(); i += static_cast<std::size_t>(result.bodies))
        result.times.push_back(truth.reference.samples[i].t);
    const auto rounded = [&](const auto& decimals, auto& columns) {
        for (const auto& exact : decimals) {
            columns.emplace_back();
            for (std::size_t c = 0; c < exact.size(); ++c)
                if (exact[c] != "nan") columns.back()[c] = truth::rounded_decimal(exact[c], written);
        }
    };
    rounded(truth.decimals, result.columns);
    rounded(truth.reaction_decimals, result.reactions);
    result.contact_events = truth.contact_events, result.contact_intervals = truth.contact_intervals;
    for (DecimalContactEvent& event : result.contact_events) {
        event.t = truth::rounded_decimal(event.t, written);
        event.normal_impulse = truth::rounded_decimal(event.normal_impulse, written);
        for (std::string& component : event.tangential_impulse) component = truth::rounded_decimal(component, written);
    }
    for (DecimalContactInterval& interval : result.contact_intervals)
        for (std::string* time : {&interval.from, &interval.to}) *time = truth::rounded_decimal(*time, written);
    return result;
}

}  // namespace

Truth truth::find_truth(const Scene& scene, long samples, int digits, double seconds_limit) {
    if (samples < 1) throw std::invalid_argument("the number of samples must be at least 1");
    if (std::string why = refusal(scene, digits); !why.empty()) return make_unavailable(std::move(why));
    return find_or_compute(scene, truth::cache_key(scene, samples, digits), sample_times(scene.duration, samples),
                           digits, seconds_limit);
}

Truth truth::find_truth(const Scene& scene, const std::vector<double>& times, int digits, double seconds_limit) {
    if (times.empty()) throw std::invalid_argument("no times given");
    for (std::size_t i = 0; i < times.size(); ++i)
        if (!std::isfinite(times[i]) || !(i == 0 ? times[i] >= 0 : times[i] > times[i - 1]))
            throw std::invalid_argument("times must be >= 0 and increase");
    Scene timed = scene;
    if (times.back() > 0) timed.duration = times.back();
    const long samples = static_cast<long>(times.size()) - 1;
    // equally spaced times: their reference may be cached already
    if (samples > 0 && times == sample_times(timed.duration, samples))
        return find_truth(timed, samples, digits, seconds_limit);
    if (std::string why = refusal(timed, digits); !why.empty()) return make_unavailable(std::move(why));
    return find_or_compute(timed, truth::cache_key(timed, times, digits), times, digits, seconds_limit);
}

std::string_view truth_method(const Problem& problem) {
    if (problem.needs.user_torque) return "none";
    const Formulas formulas = select_formulas(problem);
    return formulas == Formulas::closed_form   ? "closed form"
           : formulas == Formulas::collocation ? "collocation"
                                               : "Taylor series";
}

Reference reference(const Scene& scene, long samples, int digits, double seconds_limit) {
    return truth::find_truth(scene, samples, digits, seconds_limit).reference;
}

Reference reference(const Scene& scene, const std::vector<double>& times, int digits, double seconds_limit) {
    return truth::find_truth(scene, times, digits, seconds_limit).reference;
}

DecimalReference decimal_reference(const Scene& scene, long samples, int digits, double seconds_limit) {
    return convert_to_decimals(truth::find_truth(scene, samples, std::max(digits, default_digits), seconds_limit),
                               scene, digits);
}

DecimalReference decimal_reference(const Scene& scene, const std::vector<double>& times, int digits,
                                   double seconds_limit) {
    return convert_to_decimals(truth::find_truth(scene, times, std::max(digits, default_digits), seconds_limit), scene,
                               digits);
}

}  // namespace polhode
