// The method `exact`: evaluates closed forms of the motion. There are no steps and no error other than rounding.
#include "integrators/own/exact.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "integrators/closed_form/closed_form.h"
#include "integrators/method.h"
#include "integrators/run/watch.h"
#include "motion/finite.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using Form = ClosedForm<double>;

// Relative tolerance for symmetry. Computed axes and shifted moments have rounding errors, so moments within two
// units in the last place are taken as equal, and vectors that close to an axis as parallel to it.
double symmetry_tolerance(const Problem& problem) {
    const bool as_given = problem.body.q_BP == Quaternion<double>{} && problem.body.arm == Vector3<double>();
    return as_given ? 0 : 0x1p-51;
}

// Returns whether a free body starts close to the separatrix, where a = I1 (I2 - I1) w1^2 and b = I3 (I3 - I2) w3^2
// are nearly equal. Rounding errors of the initial state, of a and of b are amplified there by up to b / |a - b|.
bool starts_near_separatrix(const Problem& problem) {
    constexpr double near_ratio = 1e-3;
    const Segment& segment = problem.segments.front();
    if (!segment.impulses.empty() || segment.forcing.any_torque()) return false;
    const Vector3<double>&I = problem.body.principal.moments, &w = problem.body.initial_angular_velocity;
    const double middle = std::max(std::min(I[0], I[1]), std::min(std::max(I[0], I[1]), I[2]));
    double a = 0, b = 0;
    for (int i = 0; i < 3; ++i) (I[i] < middle ? a : b) += I[i] * std::abs(middle - I[i]) * w[i] * w[i];
    return std::abs(a - b) < near_ratio * b;
}

// Ratio of the smallest to the largest moment of a free body whose pivot is not its centre of mass; 1 for other
// bodies. The difference of the two larger moments drives the rotation about the third axis. Its rounding error is
// amplified by up to the inverse of this ratio.
double moment_ratio_at_pivot(const Problem& problem) {
    const Segment& segment = problem.segments.front();
    if (!problem.body.pivoted || problem.body.arm == Vector3<double>() || segment.forcing.any_torque()) return 1;
    const Vector3<double>& I = problem.body.principal.moments;
    return std::min({I[0], I[1], I[2]}) / std::max({I[0], I[1], I[2]});
}

std::optional<Form> find_form(const Problem& problem, const Segment& segment, const double* y) {
    constexpr double small = 1e-5;
    if (segment.begin == 0 &&
        (starts_near_separatrix(problem) || (segment.impulses.empty() && moment_ratio_at_pivot(problem) < small &&
                                             problem.needs.symmetry == Symmetry::asymmetric))) {
        const FreeAsymmetricBody<Wide> form(problem.body.wide_principal.moments,
                                            problem.body.wide_initial_angular_velocity,
                                            cast<Wide>(FreeRotation::attitude(y)));
        return std::optional<Form>(std::in_place, std::in_place_type<FreeAsymmetricBody<double>>, form);
    }
    return Form::find(problem.body.principal.moments, segment.forcing, FreeRotation::angular_velocity(y),
                      FreeRotation::attitude(y), symmetry_tolerance(problem));
}

void set_rotation_at(const Form& form, double t, double* y) {
    const Rotation<double> rotation = form.at(t);
    FreeRotation::set_rotation(y, rotation.w, rotation.q);
}

// Outcome of a pass through the pieces of the motion between events.
enum class Traversal {
    complete,
    stopped,         // by the visitor
    no_closed_form,  // a piece has no closed form
    not_finite,      // an impulse led to a state that is not finite
};

// Visits the closed form of each piece, starting from the final state of the previous one. `at`: time reached, s.
template <class Visit>
Traversal visit_pieces(const Problem& problem, double& at, Visit&& visit) {
    double y[FreeRotation::dimension];
    FreeRotation system(problem);
    system.initial(y);
    for (const Segment& segment : problem.segments) {
        system.enter(segment, y);
        at = segment.begin;
        if (!all_finite(std::span<const double>(y))) return Traversal::not_finite;
        const std::optional<Form> form = find_form(problem, segment, y);
        if (!form) return Traversal::no_closed_form;
        if (!visit(segment, *form)) return Traversal::stopped;
        if (!segment.last) set_rotation_at(*form, segment.end - segment.begin, y);
    }
    return Traversal::complete;
}

// Returns why the scene has no closed form, or an empty string if it has one.
std::string closed_form_refusal(const Problem& problem) {
    if (problem.formulation != Formulation::reduced)
        return "the full formulation has no closed form; solve without --full";
    if (problem.needs.user_torque) return "user-defined torques have no closed form";
    if (problem.model()) return "only rigid bodies with built-in loads have a closed form";
    if (problem.needs.translation == Translation::integrated)
        return "no closed form: forces couple translation and rotation";
    constexpr double least = 1e-18;
    if (moment_ratio_at_pivot(problem) < least && problem.needs.symmetry == Symmetry::asymmetric)
        return "no closed form: in 113 bits the moments about the pivot do not resolve the difference that drives the "
               "rotation about the third axis";
    double at = 0;
    // A state that is not finite is reported by the run.
    if (visit_pieces(problem, at, [](const Segment&, const Form&) { return true; }) == Traversal::no_closed_form)
        return "no closed form: it exists only for a free body, Lagrange's top, and rotation about one axis under "
               "constant torque and drag";
    return "";
}

Trajectory solve_exact(const Problem& problem, const Settings& settings) {
    const double bound = energy_bound(problem), duration = problem.scene.duration;
    Trajectory trajectory;
    double y[7];
    Budget budget(settings);
    const auto sample = [&](const Segment& segment, const Form& form, double t) {
        if (!budget.may_continue()) {
            budget.report_limit(trajectory);
            return false;
        }
        set_rotation_at(form, t - segment.begin, y);
        return record(problem, FreeRotation(problem).motion(t, y), bound, trajectory);
    };
    const auto run = [&] {
        trajectory.samples.clear();
        SampleQueue samples = settings.record ? sample_queue(problem, settings) : SampleQueue({&duration, 1});
        double at = 0;
        const Traversal traversal = visit_pieces(problem, at, [&](const Segment& segment, const Form& form) {
            for (; samples.in(segment); samples.pop())
                if (!sample(segment, form, samples.front())) return false;
            return true;
        });
        if (traversal == Traversal::not_finite) {
            trajectory.status = Status::diverged;
            trajectory.message = "not finite at " + format_time(at);
        }
        return traversal == Traversal::complete;
    };
    if (settings.record)
        trajectory.samples.reserve(settings.times.empty() ? static_cast<std::size_t>(settings.samples) + 1
                                                          : settings.times.size());
    repeat(settings, trajectory, [&](bool) { return run(); });
    return trajectory;
}

constexpr Method exact_variants[] = {{
    .name = "exact",
    .documentation =
        "The motion in closed form, evaluated at each sample without stepping: t = 10^9 s costs as much as 1 s. Free "
        "bodies, attitude included, by Jacobi's theta functions on both sides of the separatrix, on it and next to it; "
        "symmetric bodies and spheres by rotations; Lagrange's top with nutation, precession and spin as quotients of "
        "theta functions; rotation about one axis under constant torque and linear drag. Impulses and time windows "
        "connect pieces. q is continuous. The only error is round-off: that of the data, times the condition number of "
        "the motion, which grows in proportion to t (about 10^-10 rad for a phase of 10^6 rad).",
    .source = "C. G. J. Jacobi 1849; R. van Zon and J. Schofield 2007, J. Comput. Phys. 225, 145; F. Klein and "
              "A. Sommerfeld 1897",
    .conserves = "all invariants of the motion, to round-off",
    .control = Control::none,
    .solve = solve_exact,
}};

constexpr auto exact_table =
    apply_defaults({.family = Family::closed_form, .refusal = closed_form_refusal}, exact_variants);

}  // namespace

bool has_closed_form(const Problem& problem) { return closed_form_refusal(problem).empty(); }

extern const std::span<const Method> exact_methods{exact_table};

}  // namespace polhode
