// The right-hand side against the momentum form, written independently from the definitions of the loads:
// d(L_W)/dt = tau_W, m dv/dt = F, and dE/dt = power of the loads without a potential.
#include "motion/equations.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "motion/dual.h"
#include "motion/moderate_scene.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// The loads at t = 0 by their definitions: total force, torque about the pivot or the centre of mass, in world axes.
struct Action {
    Vector3<double> force_W, torque_W;
    double power_without_potential = 0;
};

Action action(const Scene& scene, const Sample& s) {
    Action sum;
    const Vector3<double> w_W = rotate(s.q, s.angular_velocity_B);
    const Vector3<double> about_W = scene.pivot ? Vector3<double>() : s.position_W;
    const auto body_point_W = [&](const Vector3<double>& point) {
        return s.position_W + rotate(s.q, point - scene.body.center_of_mass);
    };
    const auto pull = [&](const Vector3<double>& force_W, const Vector3<double>& at_W, bool potential) {
        sum.force_W = sum.force_W + force_W;
        sum.torque_W = sum.torque_W + cross(at_W - about_W, force_W);
        const Vector3<double> velocity_there = s.velocity_W + cross(w_W, at_W - s.position_W);
        if (!potential) sum.power_without_potential += dot(force_W, velocity_there);
    };
    const auto twist = [&](const Vector3<double>& torque_W, bool potential) {
        sum.torque_W = sum.torque_W + torque_W;
        if (!potential) sum.power_without_potential += dot(torque_W, w_W);
    };
    for (const Load& load : scene.loads) {
        const Window window = window_of(load);
        if (!(window.from <= 0 && 0 < window.until)) continue;
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            pull(scene.body.mass * gravity->acceleration_W, s.position_W, true);
        } else if (const auto* couple = std::get_if<Torque>(&load)) {
            twist(couple->frame == Frame::world ? couple->vector : rotate(s.q, couple->vector), false);
        } else if (const auto* force = std::get_if<Force>(&load)) {
            const bool in_world = force->frame == Frame::world, fixed_in_body = force->point_frame == Frame::body;
            pull(in_world ? force->vector : rotate(s.q, force->vector),
                 fixed_in_body ? body_point_W(force->point) : force->point, in_world && fixed_in_body);
        } else if (const auto* drag = std::get_if<Drag>(&load)) {
            const Vector3<double>&c = drag->rotational, &w = s.angular_velocity_B;
            twist(rotate(s.q, Vector3<double>(-c[0] * w[0], -c[1] * w[1], -c[2] * w[2])), false);
            pull(-drag->translational * s.velocity_W, s.position_W, false);
        } else if (const auto* spring = std::get_if<Spring>(&load)) {
            const Quaternion<double> r = conjugate(spring->rest_orientation) * s.q;
            twist(rotate(s.q, (-2 * spring->stiffness * r.w) * vector_part(r)), true);
        }
    }
    return sum;
}

/// d/dt of R(q) v for v fixed in the body, by automatic differentiation of the rotation.
Vector3<double> rate_of_rotated(const Quaternion<double>& q, const Quaternion<double>& rate, const Vector3<double>& v) {
    const auto with = [](double value, double slope) {
        Dual<1> d(value);
        d.slope[0] = slope;
        return d;
    };
    const Quaternion<Dual<1>> moving{with(q.w, rate.w), with(q.x, rate.x), with(q.y, rate.y), with(q.z, rate.z)};
    const Vector3<Dual<1>> turned = rotate(moving, v);
    return {turned[0].slope[0], turned[1].slope[0], turned[2].slope[0]};
}

/// Round-off of some hundred operations on numbers of size `size`, including the inverse of a tensor whose moments
/// have a ratio of at most 100 (parallel axes included).
double roundoff(double size) { return 1e-12 * (1 + size); }

void check_momentum_form(const Problem& problem, const Sample& s, const Rates& rates, bool translation) {
    const Action acting = action(problem.scene, s);
    const Matrix3<double>& I = problem.body.inertia_B;
    const Vector3<double>& w = s.angular_velocity_B;
    // L_W = R I w
    const Vector3<double> L_rate = rate_of_rotated(s.q, rates.q, I * w) + rotate(s.q, I * rates.angular_velocity_B);
    RC_ASSERT(distance(L_rate, acting.torque_W) <
              roundoff(100 * (length(acting.torque_W) + length(I * w) * length(w))));
    // the attitude rotates at w
    for (const Vector3<double>& v : {Vector3<double>(1, 0, 0), Vector3<double>(0.3, -0.5, 0.7)})
        RC_ASSERT(distance(rate_of_rotated(s.q, rates.q, v), rotate(s.q, cross(w, v))) < roundoff(length(w)));
    RC_ASSERT(std::abs(s.q.w * rates.q.w + dot(vector_part(s.q), vector_part(rates.q))) < roundoff(length(w)));
    if (!translation) return;
    RC_ASSERT(distance(rates.position_W, s.velocity_W) < roundoff(length(s.velocity_W)));
    if (problem.body.pivoted) {
        // v = R (w x arm)
        const Vector3<double>&arm = problem.body.arm, alpha = rates.angular_velocity_B;
        const Vector3<double> expected = rate_of_rotated(s.q, rates.q, cross(w, arm)) + rotate(s.q, cross(alpha, arm));
        RC_ASSERT(distance(rates.velocity_W, expected) < roundoff(10 * (length(alpha) + dot(w, w)) * length(arm)));
    } else {
        const Vector3<double> force = problem.body.mass * rates.velocity_W;
        RC_ASSERT(distance(force, acting.force_W) < roundoff(length(acting.force_W)));
    }
}

RC_GTEST_PROP(RightHandSide, FullMotionIsTheMomentumForm, ()) {
    const Problem problem = pose(moderate_scene(), Formulation::full);
    const Sample s = moderate_state(problem);
    check_momentum_form(problem, s, rates_by<FullMotion>(problem, s), true);
}

RC_GTEST_PROP(RightHandSide, LoadedMotionIsTheMomentumForm, ()) {
    const Problem problem = pose(moderate_scene());
    const Sample s = moderate_state(problem);
    check_momentum_form(problem, s, rates_by<LoadedMotion>(problem, s), true);
}

RC_GTEST_PROP(RightHandSide, FullMotionInThePrincipalFrameIsTheMomentumForm, ()) {
    const Problem problem = pose(moderate_scene(), Formulation::full_principal);
    RC_ASSERT(problem.needs.dimension == 13);
    const Sample s = moderate_state(problem);
    check_momentum_form(problem, s, rates_by<LoadedMotion>(problem, s), true);
}

/// The derivative of the scene's reduced formulation agrees with that of the full one.
RC_GTEST_PROP(RightHandSide, ReducedAndFullAgree, ()) {
    const Scene scene = moderate_scene();
    const Problem reduced = pose(scene), full = pose(scene, Formulation::full);
    const Sample s = moderate_state(full);
    const Rates expected = rates_by<FullMotion>(full, s);
    Rates rates;
    RC_TAG(name_of(reduced.needs.system));
    switch (reduced.needs.system) {
        case SystemKind::free_rotation:
            rates = rates_by<FreeRotation>(reduced, s);
            break;
        case SystemKind::loaded_rotation:
            rates = rates_by<LoadedRotation>(reduced, s);
            break;
        case SystemKind::loaded_motion:
            rates = rates_by<LoadedMotion>(reduced, s);
            break;
        default:
            RC_DISCARD("a random state does not rotate about one axis");
    }
    const double size = 100 * (length(expected.angular_velocity_B) + dot(s.angular_velocity_B, s.angular_velocity_B));
    RC_ASSERT(distance(rates.angular_velocity_B, expected.angular_velocity_B) < roundoff(size));
    const Quaternion<double> d{rates.q.w - expected.q.w, rates.q.x - expected.q.x, rates.q.y - expected.q.y,
                               rates.q.z - expected.q.z};
    RC_ASSERT(std::sqrt(squared_norm(d)) < roundoff(length(s.angular_velocity_B)));
    if (reduced.needs.system == SystemKind::loaded_motion)
        RC_ASSERT(distance(rates.velocity_W, expected.velocity_W) < roundoff(10 * length(expected.velocity_W) + size));
}

/// Rotation about a principal axis only (a pendulum, or a driven and damped spin): the variables that the scalar
/// system omits have zero rate in the full one, and the others have the same rates.
RC_GTEST_PROP(RightHandSide, OneAxisAndFullAgree, ()) {
    Scene scene;
    scene.name = "one axis", scene.duration = 1;
    const double a = moderate(0.1, 2), b = moderate(0.1, 2), c = moderate(0.1, 2);
    scene.body.mass = moderate(0.2, 3), scene.body.inertia_B = diagonal(Vector3<double>(a + b, b + c, c + a));
    const int k = *rc::gen::inRange(0, 3);
    Vector3<double> axis, along, up;
    axis[k] = 1, along[k] = moderate(-2, 2), up[(k + 2) % 3] = moderate(0.1, 2);
    scene.initial.angular_velocity = along;
    const double angle = moderate(-3, 3);
    scene.initial.orientation = {std::cos(angle), std::sin(angle) * axis[0], std::sin(angle) * axis[1],
                                 std::sin(angle) * axis[2]};
    if (*rc::gen::arbitrary<bool>()) {
        scene.pivot = Vector3<double>(), scene.body.center_of_mass = up;
        Vector3<double> g = moderate_vector();
        g[k] = 0;
        scene.loads = {Gravity{g, {}}, Drag{{0.1, 0.2, 0.3}, 0, {}}};
    } else {
        scene.initial.orientation = moderate_orientation();
        Vector3<double> torque;
        torque[k] = moderate(-2, 2);
        scene.loads = {Torque{torque, Frame::body, {}}, Drag{{0.1, 0.2, 0.3}, 0, {}}};
    }
    const Problem reduced = pose(scene), full = pose(scene, Formulation::full);
    RC_ASSERT(reduced.needs.system == SystemKind::principal_axis_rotation);
    // any state: rate w, rotated from the start by the angle of (c, s)
    const double turned = moderate(-3, 3);
    const std::array<double, 3> y{moderate(-2, 2), std::cos(turned), std::sin(turned)};
    std::array<double, 3> rate{};
    reduced.segments.front().about_axis.derivative(0, y.data(), rate.data());
    const Sample s = PrincipalAxisRotation(reduced).motion(0, y.data());
    const Rates expected = rates_by<FullMotion>(full, s);
    const Vector3<double> axis_B = rotate(reduced.body.q_BP, reduced.body.axis);
    const double size = 100 * (1 + std::abs(y[0]) + length(expected.angular_velocity_B));
    RC_ASSERT(distance(rate[0] * axis_B, expected.angular_velocity_B) < roundoff(size));
    // dq = q0 (dc, ds e) in the posed axes
    const Vector3<double> spin = rate[2] * reduced.body.axis;
    const Quaternion<double> q_rate =
        reduced.body.initial_q * Quaternion<double>{rate[1], spin[0], spin[1], spin[2]} * conjugate(reduced.body.q_BP);
    RC_ASSERT(std::abs(q_rate.w - expected.q.w) + distance(vector_part(q_rate), vector_part(expected.q)) <
              roundoff(size));
}

/// dE/dt along the motion by a central difference of the energy in 128 bits. q +- e dq have the same length. With
/// e = 1e-10 the errors, of order e^2 and 1e-34 / e, are far below the 1e-16 of the rates.
RC_GTEST_PROP(Energy, ChangesByThePowerOfWhatHasNoPotential, ()) {
    const Scene scene = moderate_scene();
    const Problem problem = pose(scene, Formulation::full);
    const ExactBody<Wide> exact = exact_body<Wide>(scene);
    const Sample s = moderate_state(problem);
    const Rates rates = rates_by<FullMotion>(problem, s);
    const auto energy = [&](const Wide& e) {
        const Vector3<Wide> w = cast<Wide>(s.angular_velocity_B) + e * cast<Wide>(rates.angular_velocity_B);
        const Vector3<Wide> p = cast<Wide>(s.position_W) + e * cast<Wide>(rates.position_W);
        const Vector3<Wide> v = cast<Wide>(s.velocity_W) + e * cast<Wide>(rates.velocity_W);
        const Quaternion<Wide> q{s.q.w + e * rates.q.w, s.q.x + e * rates.q.x, s.q.y + e * rates.q.y,
                                 s.q.z + e * rates.q.z};
        return invariants(scene, exact, 0, q, w, p, v).energy;
    };
    const Wide e(1e-10);
    const double rate = double((energy(e) - energy(-e)) / (2 * e));
    const Action acting = action(scene, s);
    const double size = (length(acting.torque_W) + length(acting.force_W) + 10) *
                        (length(s.angular_velocity_B) + length(s.velocity_W)) * 100;
    RC_ASSERT(std::abs(rate - acting.power_without_potential) < roundoff(size));
}

/// A user-defined torque receives the state in body axes and returns a vector in body axes, for any posed axes.
RC_GTEST_PROP(UserTorque, ReceivesAndReturnsBodyAxes, ()) {
    Scene scene = moderate_scene();
    scene.loads.clear();
    const auto torque_B = [](const LoadState& s) {
        return s.angular_velocity_B + cross(Vector3<double>(1, 2, 3), vector_part(s.q)) +
               rotate_back(s.q, s.position_W) + 2.0 * s.velocity_W;
    };
    scene.loads = {UserTorque{"of everything", torque_B, {}}};
    const Problem reduced = pose(scene), full = pose(scene, Formulation::full);
    const Sample s = moderate_state(full);
    const Vector3<double> tau = torque_B({0, s});
    const Matrix3<double>& I = full.body.inertia_B;
    const Vector3<double>& w = s.angular_velocity_B;
    for (const Rates& rates : {rates_by<LoadedMotion>(reduced, s), rates_by<FullMotion>(full, s)}) {
        // I dw/dt + w x I w = tau
        const Vector3<double> L_rate = I * rates.angular_velocity_B + cross(w, I * w);
        RC_ASSERT(distance(L_rate, tau) < roundoff(100 * (length(tau) + length(I * w) * length(w))));
    }
}

TEST(Impulse, JumpsByDefinition) {
    // textbook: I dw = r x J about the centre of mass and m dv = J; about a pivot I dw = r x J, and dv follows from it
    Body body;
    body.mass = 2, body.inertia_B = diagonal(Vector3<double>(1, 2, 4));
    const FullInertia<double> inertia{body.inertia_B, inverse(body.inertia_B)};
    const Quaternion<double> q = normalized(Quaternion<double>{1, 2, -1, 0.5});
    const Vector3<double> J(0.3, -0.2, 0.7), point(0.5, 0.4, -0.6), p(1, 2, 3);
    for (Frame frame : {Frame::body, Frame::world})
        for (Frame point_frame : {Frame::body, Frame::world})
            for (bool pivoted : {false, true}) {
                Vector3<double> w(0.1, 0.2, 0.3), v(-1, 0, 1);
                apply(PosedImpulse<double>{J, frame, point, point_frame}, inertia, body.mass, pivoted, w, q, p, v);
                const Vector3<double> J_W = frame == Frame::world ? J : rotate(q, J);
                const Vector3<double> r_W = point_frame == Frame::body ? rotate(q, point) : pivoted ? point : point - p;
                const Vector3<double> dw = inertia.inverse * rotate_back(q, cross(r_W, J_W));
                EXPECT_LT(distance(w, Vector3<double>(0.1, 0.2, 0.3) + dw), 1e-14);
                EXPECT_LT(distance(v, Vector3<double>(-1, 0, 1) + (pivoted ? 0.0 : 0.5) * J_W), 1e-14);
            }
}

}  // namespace
}  // namespace polhode
