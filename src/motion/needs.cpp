#include "motion/needs.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace polhode {
namespace {

using VectorW = Vector3<Wide>;
using QuaternionW = Quaternion<Wide>;

bool vanishes(const VectorW& v) { return v == VectorW(); }

// The component of v perpendicular to the unit axis e; exactly zero if both are along the same coordinate axis.
VectorW across(const VectorW& e, const VectorW& v) { return v - dot(e, v) * e; }

bool translation_couples(const Scene& scene, const std::vector<Forcing<Wide>>& forcings) {
    for (const Forcing<Wide>& f : forcings)
        if (f.has_body_force || !f.world_points.empty()) return true;
    for (const Load& load : scene.loads)
        if (const auto* impulse = std::get_if<Impulse>(&load))
            if (impulse->frame == Frame::body || impulse->point_frame == Frame::world) return true;
    return false;
}

bool at_rest(const ExactBody<Wide>& body, const Scene& scene, const std::vector<Forcing<Wide>>& forcings) {
    if (!vanishes(body.position_W) || !vanishes(body.velocity_W)) return false;
    for (const Forcing<Wide>& f : forcings)
        if (!vanishes(f.acceleration_W)) return false;
    for (const Load& load : scene.loads)
        if (std::holds_alternative<Impulse>(load)) return false;
    return true;
}

// The torque along and perpendicular to e for q = q0 (c, s e), w = rate e.
struct AxisTorque {
    Wide along;
    bool across_vanishes;
};
AxisTorque axis_torque(const Forcing<Wide>& f, const VectorW& e, const QuaternionW& q0, Wide c, Wide s, Wide rate) {
    const QuaternionW q = q0 * QuaternionW{c, s * e[0], s * e[1], s * e[2]};
    const VectorW tau = torque(f, 0, rate * e, q, VectorW(), VectorW());
    return {dot(e, tau), vanishes(across(e, tau))};
}

// The scalar system about e, if w stays along e at any angle. The torque is a quadratic form in (c, s) and linear in
// w, so that three attitudes and one rate determine it. The test is exact: zero, not small.
std::optional<AxisEquations<double>> about(const Forcing<Wide>& f, const VectorW& e, const QuaternionW& q0,
                                           const Matrix3<Wide>& inertia) {
    const Wide diagonal = square_root(Wide(0.5));
    const AxisTorque cc = axis_torque(f, e, q0, 1, 0, 0), ss = axis_torque(f, e, q0, 0, 1, 0);
    const AxisTorque both = axis_torque(f, e, q0, diagonal, diagonal, 0), moving = axis_torque(f, e, q0, 1, 0, 1);
    if (!cc.across_vanishes || !ss.across_vanishes || !both.across_vanishes || !moving.across_vanishes) return {};
    AxisEquations<double> system;
    system.inverse_moment = double(1 / dot(e, inertia * e));
    system.damping = double(cc.along - moving.along);
    system.cc = double(cc.along), system.ss = double(ss.along);
    system.cs = double(2 * both.along - cc.along - ss.along);
    return system;
}

// An impulse keeps w along e if its angular kick is along e at any angle: again a quadratic form in (c, s).
bool conserves_axis(const PosedImpulse<Wide>& impulse, const VectorW& e, const QuaternionW& q0,
                    const ExactBody<Wide>& body, const FullInertia<Wide>& inertia) {
    const Wide pairs[3][2] = {{1, 0}, {0, 1}, {1, 1}};
    for (const auto& [c, s] : pairs) {
        VectorW w, v;
        const QuaternionW q = q0 * QuaternionW{c, s * e[0], s * e[1], s * e[2]};
        apply(impulse, inertia, body.mass, body.pivoted, w, q, VectorW(), v);
        if (!vanishes(across(e, w))) return false;
    }
    return true;
}

bool try_axis(Problem& problem, const ExactBody<Wide>& body, const QuaternionW& q_BP, const VectorW& e,
              const std::vector<Forcing<Wide>>& forcings) {
    const QuaternionW q0 = body.q * q_BP;
    const Matrix3<Wide> axes = rotation_matrix(q_BP);
    const Matrix3<Wide> inertia = transposed(axes) * body.inertia_B * axes;
    const FullInertia<Wide> full{inertia, inverse(inertia)};
    std::vector<AxisEquations<double>> found;
    for (std::size_t i = 0; i < forcings.size(); ++i) {
        const auto system = about(forcings[i], e, q0, inertia);
        if (!system) return false;
        found.push_back(*system);
        for (const auto& impulse : impulses_at(problem.scene, body, problem.segments[i].begin, q_BP))
            if (!conserves_axis(impulse, e, q0, body, full)) return false;
    }
    for (std::size_t i = 0; i < found.size(); ++i) problem.segments[i].about_axis = found[i];
    problem.body.axis = cast<double>(e);
    return true;
}

bool rotates_about_principal_axis(Problem& problem, const ExactBody<Wide>& body, const QuaternionW& q_BP,
                                  const std::vector<Forcing<Wide>>& forcings) {
    // only for given axes: computed principal axes are irrational, and w0 exactly along one would be a coincidence
    const VectorW w = rotate_back(q_BP, body.angular_velocity_B);
    const bool axes_are_principal = problem.body.q_BP == Quaternion<double>{};
    for (int i = 0; i < 3 && axes_are_principal; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (w[j] != 0 || w[k] != 0) continue;
        VectorW e;
        e[i] = 1;
        if (try_axis(problem, body, q_BP, e, forcings)) return true;
    }
    // isotropic body: every axis is principal, and without torque the initial axis persists
    if (problem.needs.symmetry != Symmetry::spherical || !problem.needs.torque_free || vanishes(w)) return false;
    for (const Segment& segment : problem.segments)
        if (!segment.impulses.empty()) return false;
    const VectorW e = (1 / square_root(dot(w, w))) * w;
    for (std::size_t i = 0; i < forcings.size(); ++i)
        problem.segments[i].about_axis.inverse_moment = problem.body.principal.inverse_moments[0];
    problem.body.axis = cast<double>(e);
    return true;
}

void find_symmetry(Problem& problem) {
    Needs& needs = problem.needs;
    const Vector3<double>& I = problem.body.principal.moments;
    // moments that agree in binary64 may still affect a body with very little inertia about the third axis
    const auto moments_agree = [&](int i, int j) {
        constexpr double hardly = 1e-10, negligible = 0x1p-50;
        const int k = 3 - i - j;
        return I[i] == I[j] && (I[k] > hardly * I[i] || std::abs(problem.body.principal.gyroscopic[k]) <= negligible);
    };
    const int equal = moments_agree(0, 1) + moments_agree(1, 2) + moments_agree(2, 0);
    needs.symmetry = equal == 3 ? Symmetry::spherical : equal == 1 ? Symmetry::symmetric : Symmetry::asymmetric;
}

void find_load_kinds(Problem& problem) {
    Needs& needs = problem.needs;
    needs.torque_free = true;
    for (const Segment& segment : problem.segments) {
        needs.user_torque = needs.user_torque || !segment.forcing.user_torques.empty();
        needs.torque_free = needs.torque_free && !segment.forcing.any_torque();
    }
    needs.time_dependent = problem.segments.size() > 1 || needs.user_torque;
}

void omit(Needs& needs, const char* what, const char* why) { needs.omitted.push_back({what, why}); }

void find_translation(Problem& problem, const ExactBody<Wide>& exact, const std::vector<Forcing<Wide>>& forcings) {
    Needs& needs = problem.needs;
    const bool planes = !problem.scene.planes.empty();
    const bool still = !planes && !exact.pivoted && at_rest(exact, problem.scene, forcings);
    if (exact.pivoted) {
        needs.translation = Translation::fixed;
        omit(needs, "p and v", "the pivot is fixed: q and w determine both");
    } else if (still && !translation_couples(problem.scene, forcings)) {
        needs.translation = Translation::fixed;
        omit(needs, "p and v", "no force acts, and the centre of mass starts at rest at the origin");
    } else if (!planes && !translation_couples(problem.scene, forcings) && !needs.user_torque) {
        needs.translation = Translation::closed_form;
        omit(needs, "p and v", "only constant acceleration and linear drag: piecewise closed form");
    } else {
        needs.translation = Translation::integrated;
    }
}

void find_reduced_system(Problem& problem, const ExactBody<Wide>& exact, const QuaternionW& q_BP,
                         const std::vector<Forcing<Wide>>& forcings) {
    Needs& needs = problem.needs;
    const bool couples = needs.translation == Translation::integrated;
    if (!couples && !needs.user_torque && rotates_about_principal_axis(problem, exact, q_BP, forcings)) {
        needs.system = SystemKind::principal_axis_rotation, needs.dimension = 3;
        omit(needs, "gyroscopic term w x Iw", "w stays along one principal axis");
        omit(needs, "two components of w, two of q", "rotation about one axis: rate and half-angle (c, s)");
    } else if (!couples && needs.torque_free) {
        needs.system = SystemKind::free_rotation, needs.dimension = 7;
        const bool has_impulses =
            std::ranges::any_of(problem.segments, [](const Segment& segment) { return !segment.impulses.empty(); });
        omit(needs, "torque", has_impulses ? "zero between impulses: w decouples from q" : "zero: w decouples from q");
        if (needs.symmetry == Symmetry::symmetric)
            omit(needs, "one gyroscopic component",
                 "two moments are equal: the rate about the symmetry axis is constant");
    } else {
        needs.system = couples ? SystemKind::loaded_motion : SystemKind::loaded_rotation;
        needs.dimension = couples ? 13 : 7;
        if (needs.symmetry == Symmetry::symmetric)
            omit(needs, "one gyroscopic component", "two moments are equal: its coefficient is zero");
    }
    if (needs.symmetry == Symmetry::spherical && needs.system != SystemKind::principal_axis_rotation) {
        omit(needs, "gyroscopic term w x Iw", "isotropic body: Iw is parallel to w");
        problem.body.principal_inertia.isotropic = true;
    }
}

}  // namespace

void find_needs(Problem& problem, const ExactBody<Wide>& exact, const Quaternion<Wide>& q_BP,
                const std::vector<Forcing<Wide>>& forcings) {
    Needs& needs = problem.needs;
    find_symmetry(problem);
    find_load_kinds(problem);
    if (problem.formulation != Formulation::reduced) {
        const bool tensor = problem.formulation == Formulation::full;
        needs.system = tensor ? SystemKind::full_motion : SystemKind::loaded_motion;
        needs.dimension = 13, needs.translation = Translation::integrated;
        return;
    }
    if (!(problem.body.principal.q_BP == Quaternion<double>{}))
        omit(needs, "products of inertia", "zero in the principal frame, in which the system is posed");
    find_translation(problem, exact, forcings);
    find_reduced_system(problem, exact, q_BP, forcings);
}

}  // namespace polhode
