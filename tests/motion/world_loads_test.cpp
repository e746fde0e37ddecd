// Loads in world axes, compared with the equations in body axes.
#include "motion/world_loads.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "motion/moderate_scene.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using namespace polhode::testing;

RC_GTEST_PROP(WorldLoads, AreThoseOfTheEquationsOfMotion, ()) {
    Scene scene = moderate_scene();
    if (*rc::gen::arbitrary<bool>())
        scene.loads.push_back(UserTorque{
            "any",
            [](const LoadState& s) { return s.angular_velocity_B + 0.5 * s.position_W + s.q.x * s.velocity_W; },
            {}});
    const Problem problem = pose(scene, Formulation::full);
    const Forcing<double>& forcing = problem.segments.front().forcing;
    const Sample s = moderate_state(problem);
    const Matrix3<double> A = rotation_matrix(s.q);
    const WorldLoads loads(problem);
    const Vector3<double> torque_W = loads.torque_W(
        0, A, [&] { return s.q; }, A * s.angular_velocity_B, s.position_W, s.velocity_W);
    const Vector3<double> torque_B = torque(forcing, 0, s.angular_velocity_B, s.q, s.position_W, s.velocity_W);
    // sums of a dozen products of numbers up to 10
    RC_ASSERT(distance(torque_W, rotate(s.q, torque_B)) < 1e-12);
    if (!problem.body.pivoted) {
        const Rates rates = rates_by<FullMotion>(problem, s);
        RC_ASSERT(distance(loads.acceleration_W(A, s.velocity_W), rates.velocity_W) < 1e-12);
    }
}

RC_GTEST_PROP(WorldLoads, StrikeAsTheEquationsOfMotionDo, ()) {
    Scene scene = moderate_scene();
    scene.loads.push_back(Impulse{moderate_vector(), any_frame(), moderate_vector(), any_frame(), 0});
    const Problem problem = pose(scene, Formulation::full);
    const Segment& segment = problem.segments.front();
    const Sample s = moderate_state(problem);
    const Matrix3<double> A = rotation_matrix(s.q);

    Vector3<double> L = A * (problem.body.inertia_B * s.angular_velocity_B), v = s.velocity_W;
    WorldLoads<>::apply_impulses(problem, segment, A, s.position_W, L, v);

    Vector3<double> w = s.angular_velocity_B, u = s.velocity_W;
    for (const auto& impulse : segment.impulses)
        apply(impulse, problem.body.full_inertia, problem.body.mass, problem.body.pivoted, w, s.q, s.position_W, u);
    RC_ASSERT(distance(transposed(A) * L, problem.body.inertia_B * w) < 1e-11);
    RC_ASSERT(distance(v, u) < 1e-12);
}

}  // namespace
}  // namespace polhode
