// Posing a scene: initial states, events, segments, and the closed form of the translation.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "motion/moderate_scene.h"
#include "motion/systems.h"
#include "text/message.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// The initial state of each formulation agrees with the scene.
template <class SystemType>
Sample start(const Problem& problem) {
    std::array<double, SystemType::dimension> y{};
    SystemType(problem).initial(y.data());
    return SystemType(problem).motion(0, y.data());
}

Sample start(const Problem& problem) {
    Sample s;
    with_one_body(problem, [&]<class SystemType>() {
        s = start<SystemType>(problem);
        return Trajectory{};
    });
    return s;
}

RC_GTEST_PROP(InitialState, IsTheScenes, ()) {
    const Scene scene = moderate_scene();
    const Quaternion<double> q = scene.initial.orientation;
    for (Formulation formulation : {Formulation::reduced, Formulation::full}) {
        const Sample s = start(pose(scene, formulation));
        // q and -q are the same attitude; each number has passed a few products
        const double sign = s.q.w * q.w + dot(vector_part(s.q), vector_part(q)) < 0 ? -1 : 1;
        RC_ASSERT(std::abs(sign * s.q.w - q.w) + distance(sign * vector_part(s.q), vector_part(q)) < 1e-14);
        const bool in_world = scene.initial.angular_velocity_frame == Frame::world;
        const Vector3<double> w = in_world ? rotate(s.q, s.angular_velocity_B) : s.angular_velocity_B;
        RC_ASSERT(distance(w, scene.initial.angular_velocity) < 1e-13);
        if (scene.pivot) {
            // the pivot is at rest at the world's origin
            const Vector3<double> to_pivot = rotate(s.q, *scene.pivot - scene.body.center_of_mass);
            RC_ASSERT(length(s.position_W + to_pivot) < 1e-13);
            RC_ASSERT(length(s.velocity_W + cross(rotate(s.q, s.angular_velocity_B), to_pivot)) < 1e-12);
        } else {
            RC_ASSERT(distance(s.position_W, scene.initial.position_W) < 1e-14);
            RC_ASSERT(distance(s.velocity_W, scene.initial.velocity_W) < 1e-14);
        }
    }
}

TEST(Segments, BeginAtEveryEventInside) {
    Scene scene;
    scene.name = "events", scene.duration = 4;
    scene.loads = {Torque{{1, 0, 0}, Frame::body, {1, 2}}, Torque{{0, 1, 0}, Frame::body, {1, 9}},
                   Torque{{0, 0, 1}, Frame::body, {-3, 0.5}}, Impulse{{1, 0, 0}, Frame::body, {}, Frame::body, 3},
                   Impulse{{1, 0, 0}, Frame::body, {}, Frame::body, 7}};
    EXPECT_EQ(event_times(scene), (std::vector<double>{0, 0.5, 1, 2, 3, 4}));
    const Problem problem = pose(scene, Formulation::full);
    ASSERT_EQ(problem.segments.size(), 5u);
    // windows are from <= t < until
    const Vector3<double> expected[5] = {{0, 0, 1}, {}, {1, 1, 0}, {0, 1, 0}, {0, 1, 0}};
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(problem.segments[i].forcing.torque, expected[i]) << i;
        EXPECT_EQ(problem.segments[i].impulses.size(), i == 4 ? 1u : 0u);
    }
    EXPECT_EQ(segment_at(problem, 0.75), 1u);
    EXPECT_EQ(segment_at(problem, 1), 2u);
    EXPECT_EQ(segment_at(problem, 4), 4u);
    scene.loads.push_back(Impulse{{1, 0, 0}, Frame::body, {}, Frame::body, 4});
    EXPECT_EQ(event_times(scene).back(), 4);
    EXPECT_EQ(event_times(scene).size(), 7u);
}

/// The closed form of p and v agrees with a Runge-Kutta integration of m dv/dt = m g + F - c v in this test, with
/// windows and an impulse.
RC_GTEST_PROP(Translation, InClosedFormIsTheIntegratedOne, ()) {
    Scene scene;
    scene.name = "thrown", scene.duration = 2;
    scene.body.mass = moderate(0.5, 3);
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    scene.initial.angular_velocity = {1, 1, 1};
    scene.initial.position_W = moderate_vector(), scene.initial.velocity_W = moderate_vector();
    // from no drag to one that decays within a fraction of the run; 1e-9 uses the series
    const double c = *rc::gen::element(0.0, 1e-9, 0.2, 1.0, 20.0);
    const Vector3<double> g = moderate_vector(), F = moderate_vector(), J = moderate_vector();
    scene.loads = {Gravity{g, {}}, Force{F, Frame::world, {}, Frame::body, {0.5, 1.25}}, Drag{{}, c, {0.25, 3}},
                   Impulse{J, Frame::world, {0.1, 0.2, 0.3}, Frame::body, 1}};
    const Problem problem = pose(scene);
    RC_ASSERT(problem.needs.translation == Translation::closed_form);

    Vector3<double> p = scene.initial.position_W, v = scene.initial.velocity_W;
    const int n = 8000;
    const double h = 2.0 / n;
    const std::array<double, 7> state{1, 1, 1, 1, 0, 0, 0};
    for (int i = 0; i <= n; ++i) {
        const double t = i * h;
        if (i == n / 2) v = v + (1 / scene.body.mass) * J;
        if (i % 500 == 0) {
            const Sample s = FreeRotation(problem).motion(t, state.data());
            // the error h^4 (c/m)^4 / 5! with h c/m <= 1e-2, damped: below 1e-9
            RC_ASSERT(distance(s.position_W, p) < 1e-9);
            RC_ASSERT(distance(s.velocity_W, v) < 1e-9);
        }
        const bool pulled = t >= 0.5 && t < 1.25, dragged = t >= 0.25;
        const Vector3<double> a = g + (pulled ? 1 / scene.body.mass : 0.0) * F;
        const double k = dragged ? c / scene.body.mass : 0;
        const auto rate = [&](const Vector3<double>& velocity) { return a - k * velocity; };
        const Vector3<double> k1 = rate(v), k2 = rate(v + h / 2 * k1), k3 = rate(v + h / 2 * k2), k4 = rate(v + h * k3);
        p = p + h * (v + h / 6 * (k1 + k2 + k3));
        v = v + h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
}

TEST(Scales, CoverTheMotion) {
    Scene scene;
    scene.name = "thrown", scene.duration = 10;
    scene.initial.angular_velocity = {0, 0, 2};
    scene.initial.velocity_W = {3, 0, 0};
    scene.loads = {Gravity{{0, 0, -10}, {}}};
    const Problem problem = pose(scene, Formulation::full);
    EXPECT_NEAR(problem.scales.angular_velocity, 2, 0.1);
    EXPECT_NEAR(problem.scales.position, std::hypot(30, 500), 5);
    EXPECT_NEAR(problem.scales.velocity, std::hypot(3, 100), 1);
}

/// The place of the scene part that pose() refuses to ignore; empty if pose() succeeds.
template <class Change>
std::string ignored_part(const Scene& scene, Change&& change) {
    Scene changed = scene;
    change(changed);
    try {
        pose(changed);
    } catch (const InputError& fault) {
        return fault.place();
    }
    return "";
}

TEST(Pose, RefusesWhatSeveralBodiesWouldIgnore) {
    Scene several;
    several.name = "several", several.bodies = {{"a", {}, {}}, {"b", {}, {}}};
    const UserTorque torque{"mine", [](const LoadState&) { return Vector3<double>(); }, {}};
    EXPECT_EQ(ignored_part(several, [](Scene&) {}), "");
    EXPECT_EQ(ignored_part(several, [&](Scene& s) { s.loads = {Gravity{}, torque}; }), "/loads/1");
    EXPECT_EQ(ignored_part(several, [](Scene& s) { s.pivot = Vector3<double>(); }), "/pivot");
    const auto join = [](Scene& s) {
        s.joints.resize(1);
        s.joints[0].name = "hinge", s.joints[0].child = "a";
    };
    EXPECT_EQ(ignored_part(several, [&](Scene& s) { join(s), s.planes = {Plane{}}; }), "/planes");
    EXPECT_EQ(ignored_part(several, [&](Scene& s) { join(s), s.contacts.resize(1); }), "/contacts");
    EXPECT_EQ(ignored_part(several, [](Scene& s) { s.body.mass = 2; }), "/body");
    EXPECT_EQ(ignored_part(several, [](Scene& s) { s.body.inertia_B[0][0] = 1.5; }), "/body");
    EXPECT_EQ(ignored_part(several, [](Scene& s) { s.body.center_of_mass = {1, 0, 0}; }), "/body");
    EXPECT_EQ(ignored_part(several, [](Scene& s) { s.initial.angular_velocity = {1, 0, 0}; }), "/initial");
    EXPECT_EQ(ignored_part(several, [](Scene& s) { s.initial.velocity_W = {1, 0, 0}; }), "/initial");
}

TEST(Pose, RefusesWhatOneBodyWouldIgnore) {
    Scene one;
    one.name = "one", one.duration = 1;
    EXPECT_EQ(ignored_part(one, [](Scene&) {}), "");
    EXPECT_EQ(ignored_part(one, [](Scene& s) { s.joints.emplace_back(); }), "/joints");
    EXPECT_EQ(ignored_part(one, [](Scene& s) { s.loops.emplace_back(); }), "/loops");
    EXPECT_EQ(ignored_part(one, [](Scene& s) { s.loads = {Motor{"hinge", 1, {}}}; }), "/loads/0");
    EXPECT_EQ(ignored_part(one, [](Scene& s) { s.loads = {Gravity{}, PointSpring{}}; }), "/loads/1");
    EXPECT_EQ(ignored_part(one,
                           [](Scene& s) {
                               Torque torque{{0, 0, 1}, Frame::body, {}};
                               torque.body = "arm";
                               s.loads = {torque};
                           }),
              "/loads/0");
}

}  // namespace
}  // namespace polhode
