// Energy, momenta, joint coordinates and joint errors of given motions, compared with the definition of each joint.
#include "motion/mechanism_motion.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "motion/exact_body.h"

namespace polhode {
namespace {

// uniform in [-2, 2]
double middling() { return *rc::gen::inRange(-2000, 2001) / 1000.0; }
Vector3<double> moderate_vector() { return {middling(), middling(), middling()}; }
Quaternion<double> moderate_orientation() {
    const Quaternion<double> q{middling(), middling(), middling(), middling()};
    return squared_norm(q) < 1e-3 ? Quaternion<double>{} : normalized(q);
}
// an axis not parallel to a coordinate axis
Vector3<double> moderate_axis() { return {1 + std::abs(middling()), middling(), middling()}; }
Quaternion<Wide> wide_unit(const Quaternion<double>& q) { return normalized(cast<Wide>(q)); }

// exp(axis angle)
Quaternion<Wide> turn_by(const Vector3<double>& axis, Wide angle) {
    const Vector3<Wide> a = cast<Wide>(axis);
    Wide s, c;
    Elementary<Wide>::sine_cosine(angle / 2, s, c);
    const Vector3<Wide> v = (s / length(a)) * a;
    return {c, v[0], v[1], v[2]};
}

Body any_moderate_body() {
    Body body;
    body.mass = 2.5 + middling();
    body.inertia_B = diagonal(Vector3<double>(3 + middling() / 4, 3 + middling() / 4, 3 + middling() / 4));
    body.center_of_mass = moderate_vector();
    return body;
}

BodyMotion<Wide> moderate_motion() {
    return {wide_unit(moderate_orientation()), cast<Wide>(moderate_vector()), cast<Wide>(moderate_vector()),
            cast<Wide>(moderate_vector())};
}

Scene with_bodies(int count) {
    Scene scene;
    scene.name = "bodies", scene.duration = 1;
    for (int i = 0; i < count; ++i) scene.bodies.push_back({"b" + std::to_string(i), any_moderate_body(), {}});
    return scene;
}

Scene two_fixed_bodies() {
    Scene scene;
    scene.name = "two", scene.duration = 1;
    scene.bodies.resize(2);
    scene.bodies[0].name = "a", scene.bodies[0].body.mass = 2, scene.bodies[0].body.center_of_mass = {0.5, 0, 0};
    scene.bodies[1].name = "b", scene.bodies[1].body.mass = 3, scene.bodies[1].body.center_of_mass = {0, 0.25, 0};
    return scene;
}

// The motions of a parent and its child on the joint, at rest.
std::vector<BodyMotion<Wide>> jointed(const Scene& scene, const Quaternion<Wide>& q_parent,
                                      const Vector3<Wide>& parent_center_W, const Quaternion<Wide>& J,
                                      const Vector3<Wide>& slide = {}) {
    const Joint& joint = scene.joints.front();
    const auto center = [&](int i) { return cast<Wide>(scene.bodies[i].body.center_of_mass); };
    std::vector<BodyMotion<Wide>> motions(2);
    const Quaternion<Wide> between = q_parent * wide_unit(joint.parent_orientation);
    motions[0].q = q_parent, motions[0].position_W = parent_center_W;
    motions[1].q = between * J;
    motions[1].position_W = parent_center_W + rotate(q_parent, cast<Wide>(joint.parent_point) - center(0)) +
                            rotate(between, slide) - rotate(motions[1].q, cast<Wide>(joint.child_point) - center(1));
    return motions;
}

RC_GTEST_PROP(MechanismMotion, OneBodyHasTheInvariantsOfABodyAlone, ()) {
    Scene alone;
    alone.name = "alone", alone.duration = 1, alone.body = any_moderate_body();
    const Window window{-0.5 + middling(), 0.5 + middling()};
    alone.loads = {Gravity{moderate_vector(), {}},
                   Gravity{moderate_vector(), window},
                   Force{moderate_vector(), Frame::world, moderate_vector(), Frame::body, window},
                   Force{moderate_vector(), Frame::body, moderate_vector(), Frame::body, {}},
                   Force{moderate_vector(), Frame::world, moderate_vector(), Frame::world, {}},
                   Spring{1.5, moderate_orientation(), window}};
    Scene several = alone;
    several.bodies = {{"only", alone.body, {}}};
    for (Load& load : several.loads)
        std::visit(
            [](auto& l) {
                if constexpr (requires { l.body; }) l.body = "only";
            },
            load);
    const BodyMotion<Wide> m = moderate_motion();
    const double t = middling();
    const Invariants<Wide> expected =
        invariants(alone, exact_body<Wide>(alone), t, m.q, m.angular_velocity_B, m.position_W, m.velocity_W);
    JointCoordinates none(several);
    const MechanismMeasure<Wide> measure(several);
    const SystemInvariants<Wide> found = measure.invariants(t, std::span(&m, 1), none);
    RC_ASSERT(!measure.is_tied_to_world());
    RC_ASSERT(std::abs(double(found.kinetic - expected.kinetic)) < 1e-30);
    RC_ASSERT(std::abs(double(found.energy - expected.energy)) < 1e-30);
    RC_ASSERT(double(length(found.angular_momentum_W - expected.angular_momentum_W)) < 1e-30);
    RC_ASSERT(double(length(found.linear_momentum_W - Wide(alone.body.mass) * m.velocity_W)) < 1e-30);
}

// Momenta and energy of bodies agree with sums over their particles, computed without inertia tensors.
TEST(MechanismMotion, MomentaAndEnergyAreThoseOfTheParticles) {
    // each body is six points at +-d_i on its axes, of mass m / 6 each: moments m/3 (d_j^2 + d_k^2)
    const Vector3<double> d[2] = {{0.5, 1, 1.5}, {2, 0.25, 0.75}};
    const double mass[2] = {6, 12};
    Scene scene;
    scene.name = "points", scene.duration = 1;
    for (int i = 0; i < 2; ++i) {
        Body body;
        body.mass = mass[i];
        for (int k = 0; k < 3; ++k) {
            const double a = d[i][(k + 1) % 3], b = d[i][(k + 2) % 3];
            body.inertia_B[k][k] = mass[i] / 3 * (a * a + b * b);
        }
        scene.bodies.push_back({i == 0 ? "a" : "b", body, {}});
    }
    scene.loads = {Gravity{{0.5, -1, 2}, {}}};
    const std::vector<BodyMotion<Wide>> motions{
        {wide_unit({0.5, 0.5, -0.5, 0.5}), {1, 2, -3}, {4, -5, 6}, {0.5, 0.25, -2}},
        {wide_unit({0.6, 0, 0.8, 0}), {-1, 0.5, 0.25}, {-7, 1, 0.5}, {3, -1, 0.125}}};
    const auto summed = [&](const Vector3<Wide>& about, const Vector3<Wide>& drift) {
        SystemInvariants<Wide> sum;
        for (int i = 0; i < 2; ++i)
            for (int k = 0; k < 6; ++k) {
                Vector3<Wide> r;
                r[static_cast<std::size_t>(k / 2)] = (k % 2 == 0 ? 1 : -1) * d[i][static_cast<std::size_t>(k / 2)];
                const BodyMotion<Wide>& m = motions[static_cast<std::size_t>(i)];
                const Vector3<Wide> p = m.position_W + rotate(m.q, r);
                const Vector3<Wide> v = m.velocity_W + rotate(m.q, cross(m.angular_velocity_B, r));
                const Wide part = mass[i] / 6;
                sum.kinetic += part * dot(v, v) / 2;
                sum.energy += part * (dot(v, v) / 2 - dot(Vector3<Wide>(0.5, -1, 2), p));
                sum.linear_momentum_W = sum.linear_momentum_W + part * v;
                sum.angular_momentum_W = sum.angular_momentum_W + part * cross(p - about, v - drift);
            }
        return sum;
    };
    const auto expect_near = [](const SystemInvariants<Wide>& found, const SystemInvariants<Wide>& expected) {
        EXPECT_LT(std::abs(double(found.kinetic - expected.kinetic)), 1e-29);
        EXPECT_LT(std::abs(double(found.energy - expected.energy)), 1e-29);
        EXPECT_LT(double(length(found.linear_momentum_W - expected.linear_momentum_W)), 1e-29);
        EXPECT_LT(double(length(found.angular_momentum_W - expected.angular_momentum_W)), 1e-29);
    };
    JointCoordinates none(scene);
    const Vector3<Wide> center = (1 / Wide(18)) * (Wide(6) * motions[0].position_W + Wide(12) * motions[1].position_W);
    const Vector3<Wide> drift = (1 / Wide(18)) * (Wide(6) * motions[0].velocity_W + Wide(12) * motions[1].velocity_W);
    expect_near(MechanismMeasure<Wide>(scene).invariants(0, motions, none), summed(center, drift));
    // tied to the world: momenta about the world's origin
    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = JointType::spherical;
    scene.joints[0].child = "a";

    JointCoordinates one(scene);
    EXPECT_TRUE(MechanismMeasure<Wide>(scene).is_tied_to_world());
    expect_near(MechanismMeasure<Wide>(scene).invariants(0, motions, one), summed({}, {}));
}

RC_GTEST_PROP(MechanismMotion, AngularMomentumOfAFreeSystemDoesNotDependOnWhoLooks, ()) {
    const Scene scene = with_bodies(3);
    std::vector<BodyMotion<Wide>> motions{moderate_motion(), moderate_motion(), moderate_motion()};
    const MechanismMeasure<Wide> measure(scene);
    JointCoordinates none(scene);
    const Vector3<Wide> L = measure.invariants(0, motions, none).angular_momentum_W;
    const Vector3<Wide> away = cast<Wide>(moderate_vector()), wind = cast<Wide>(moderate_vector());
    for (BodyMotion<Wide>& m : motions) m.position_W = m.position_W + away, m.velocity_W = m.velocity_W + wind;
    RC_ASSERT(double(length(measure.invariants(0, motions, none).angular_momentum_W - L)) < 1e-30);
}

TEST(MechanismMotion, APointSpringHasThePotentialOfItsStretch) {
    Scene scene = two_fixed_bodies();
    scene.loads = {PointSpring{"a", {1.5, 0, 0}, "b", {0, 0.25, 2}, 8, 1, {1, 2}},
                   PointSpring{"world", {1, 1, 1}, "a", {0.5, 0, 0}, 2, 0, {}}};
    std::vector<BodyMotion<Wide>> motions(2);
    motions[1].position_W = {4, 4, -2};
    // a spring from (1, 0, 0) to (4, 4, 0), stretched by 4; another from (1, 1, 1) to the origin
    const MechanismMeasure<Wide> measure(scene);
    JointCoordinates none(scene);
    EXPECT_NEAR(double(measure.invariants(1.5, motions, none).energy), 8 * 16 / 2.0 + 2 * 3 / 2.0, 1e-15);
    EXPECT_NEAR(double(measure.invariants(2, motions, none).energy), 2 * 3 / 2.0, 1e-15);
}

RC_GTEST_PROP(MechanismMotion, AnglesCountTurnsInTheEnergyOfARevoluteJoint, ()) {
    Scene scene = with_bodies(2);
    const double k = 1.75, rest = 0.5 + middling();
    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = JointType::revolute;
    scene.joints[0].parent = "b0";
    scene.joints[0].child = "b1";
    scene.joints[0].parent_point = moderate_vector();
    scene.joints[0].child_point = moderate_vector();
    scene.joints[0].parent_orientation = moderate_orientation();
    scene.joints[0].axes = {moderate_axis(), {}};
    scene.joints[0].coordinate = {middling(), 0};
    scene.joints[0].stiffness = {k, 0};
    scene.joints[0].rest = {rest, 0};

    const Vector3<double>& axis = scene.joints.front().axes[0];
    const MechanismMeasure<Wide> measure(scene);
    JointCoordinates coordinates(scene);
    const Quaternion<Wide> q_parent = wide_unit(moderate_orientation());
    // 10 rad per sample, more than one rotation, in either direction: the rate determines the number of rotations
    const double rate = *rc::gen::arbitrary<bool>() ? 20 : -20;
    scene.joints.front().rate = {rate, 0};
    for (int i = 0; i <= 20; ++i) {
        const Wide x = Wide(scene.joints.front().coordinate[0]) + Wide(rate) * Wide(i) * Wide(0.5);
        auto motions = jointed(scene, q_parent, {1, 2, 3}, turn_by(axis, x));
        const Vector3<Wide> a = cast<Wide>(axis);
        motions[1].angular_velocity_B = (Wide(rate) / length(a)) * a;
        // the parent rotates too, together with the child
        const Vector3<Wide> w_W{0.25, -3, 1};
        motions[0].angular_velocity_B = rotate_back(motions[0].q, w_W);
        motions[1].angular_velocity_B = motions[1].angular_velocity_B + rotate_back(motions[1].q, w_W);
        JointCoordinates from_start = i == 0 ? JointCoordinates(scene) : coordinates;
        const SystemInvariants<Wide> found = measure.invariants(i * 0.5, motions, from_start);
        coordinates = from_start;
        const Wide expected = Wide(k) * (x - Wide(rest)) * (x - Wide(rest)) / 2;
        RC_ASSERT(std::abs(double(found.energy - found.kinetic - expected)) < 1e-28);
        RC_ASSERT(std::abs(coordinates.values()[0][0] - double(x)) < 1e-13);
    }
}

RC_GTEST_PROP(MechanismMotion, AUniversalJointHasTwoAnglesAboutAxesThatNeedNotBePerpendicular, ()) {
    Scene scene = with_bodies(2);
    const double x = 2 * middling(), y = 2 * middling();
    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = JointType::universal;
    scene.joints[0].parent = "b0";
    scene.joints[0].child = "b1";
    scene.joints[0].parent_orientation = moderate_orientation();
    scene.joints[0].axes = {Vector3<double>(1, middling() / 4, middling() / 4), {middling() / 4, 1, middling() / 4}};
    scene.joints[0].coordinate = {x + middling(), y + middling()};
    scene.joints[0].stiffness = {1.5, 2.5};
    scene.joints[0].rest = {middling(), middling()};

    const Joint& joint = scene.joints.front();
    const Quaternion<Wide> J = turn_by(joint.axes[0], x) * turn_by(joint.axes[1], y);
    const auto motions = jointed(scene, wide_unit(moderate_orientation()), {}, J);
    JointCoordinates coordinates(scene);
    const MechanismMeasure<Wide> measure(scene);
    const double energy = double(measure.invariants(0, motions, coordinates).energy);
    const double dx = x - joint.rest[0], dy = y - joint.rest[1];
    RC_ASSERT(std::abs(coordinates.values()[0][0] - x) < 1e-13);
    RC_ASSERT(std::abs(coordinates.values()[0][1] - y) < 1e-13);
    RC_ASSERT(std::abs(energy - (1.5 * dx * dx + 2.5 * dy * dy) / 2) < 1e-12);
    const JointViolations<Wide> off = measure.violations(motions);
    RC_ASSERT(double(off.gap) < 1e-30);
    RC_ASSERT(double(off.turn) < 1e-15);
}

TEST(MechanismMotion, TheAnglesOfAUniversalJointAreFollowedByTheirRates) {
    Scene scene = two_fixed_bodies();
    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = JointType::universal;
    scene.joints[0].parent = "a";
    scene.joints[0].child = "b";
    scene.joints[0].axes = {Vector3<double>(1, 0, 0.25), {0, 2, 1}};
    scene.joints[0].rate = {7, -5};
    scene.joints[0].stiffness = {1, 1};

    const Joint& joint = scene.joints.front();
    const MechanismMeasure<double> measure(scene);
    JointCoordinates coordinates(scene);
    const auto unit = [](const Vector3<double>& v) { return cast<Wide>((1 / hypotenuse(v)) * v); };
    for (int i = 0; i < 12; ++i) {
        const double t = i;
        const Quaternion<Wide> second = turn_by(joint.axes[1], -5 * t), J = turn_by(joint.axes[0], 7 * t) * second;
        const auto motions = jointed(scene, {}, {}, J);
        // w = exp(b y)* a x' + b y'
        const Vector3<Wide> w = Wide(7) * rotate_back(second, unit(joint.axes[0])) + Wide(-5) * unit(joint.axes[1]);
        std::vector<BodyMotion<double>> rounded;
        for (const BodyMotion<Wide>& m : motions)
            rounded.push_back({cast<double>(m.q), {}, cast<double>(m.position_W), {}});
        rounded[1].angular_velocity_B = cast<double>(w);
        measure.invariants(t, rounded, coordinates);
        EXPECT_NEAR(coordinates.values()[0][0], 7 * t, 1e-12);
        EXPECT_NEAR(coordinates.values()[0][1], -5 * t, 1e-12);
    }
    // coordinates set from an external source
    coordinates.set(20, std::array<std::array<double, 2>, 1>{{{1, 100}}});
    auto motions = jointed(scene, {}, {}, turn_by(joint.axes[0], 1) * turn_by(joint.axes[1], 100));
    std::vector<BodyMotion<double>> rounded;
    for (const BodyMotion<Wide>& m : motions)
        rounded.push_back({cast<double>(m.q), {}, cast<double>(m.position_W), {}});
    EXPECT_NEAR(measure.invariants(20, rounded, coordinates).energy, (1 + 100.0 * 100) / 2, 1e-9);
}

TEST(MechanismMotion, PrismaticAndSphericalJointsHaveTheirPotentials) {
    Scene scene = two_fixed_bodies();
    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = JointType::prismatic;
    scene.joints[0].parent = "a";
    scene.joints[0].child = "b";
    scene.joints[0].parent_point = {1, 2, 3};
    scene.joints[0].parent_orientation = {0.6, 0, 0, 0.8};
    scene.joints[0].axes = {Vector3<double>(0, 3, 4), {}};
    scene.joints[0].stiffness = {10, 0};
    scene.joints[0].rest = {0.25, 0};

    JointCoordinates coordinates(scene);
    auto motions = jointed(scene, wide_unit({0.5, -0.5, 0.5, 0.5}), {7, 8, 9}, {}, {0, -0.75, -1});
    EXPECT_NEAR(double(MechanismMeasure<Wide>(scene).invariants(0, motions, coordinates).energy), 5 * 1.5 * 1.5, 1e-14);
    EXPECT_LT(double(MechanismMeasure<Wide>(scene).violations(motions).gap), 1e-30);

    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = JointType::spherical;
    scene.joints[0].parent = "a";
    scene.joints[0].child = "b";
    scene.joints[0].parent_orientation = {0.6, 0, 0, 0.8};
    scene.joints[0].stiffness = {10, 0};
    scene.joints[0].rest_orientation = {0.8, 0.6, 0, 0};

    // rotated by 2 rad from rest: k (1 - cos 2)
    motions = jointed(scene, wide_unit({0.5, -0.5, 0.5, 0.5}), {7, 8, 9},
                      wide_unit({0.8, 0.6, 0, 0}) * turn_by({1, 2, -1}, 2));
    EXPECT_NEAR(double(MechanismMeasure<Wide>(scene).invariants(0, motions, coordinates).energy),
                10 * (1 - std::cos(2.0)), 1e-14);
}

// A correct joint has no violation. One displaced and rotated by known amounts has these violations.
RC_GTEST_PROP(MechanismMotion, JointsAreClosedWhereTheyShouldBeAndOffByWhatTheyAreMoved, ()) {
    Scene scene = with_bodies(2);
    const JointType type =
        *rc::gen::element(JointType::revolute, JointType::prismatic, JointType::spherical, JointType::fixed);
    scene.joints.assign(1, {});
    scene.joints[0].name = "j";
    scene.joints[0].type = type;
    scene.joints[0].parent = "b0";
    scene.joints[0].child = "b1";
    scene.joints[0].parent_point = moderate_vector();
    scene.joints[0].child_point = moderate_vector();
    scene.joints[0].parent_orientation = moderate_orientation();
    scene.joints[0].axes = {moderate_axis(), {}};

    const Vector3<double>& axis = scene.joints.front().axes[0];
    const Quaternion<Wide> free_turn = type == JointType::revolute    ? turn_by(axis, middling())
                                       : type == JointType::spherical ? wide_unit(moderate_orientation())
                                                                      : Quaternion<Wide>{};
    const Vector3<Wide> free_slide =
        type == JointType::prismatic ? Wide(middling()) * cast<Wide>(axis) : Vector3<Wide>();
    const Quaternion<Wide> q_parent = wide_unit(moderate_orientation());
    const MechanismMeasure<Wide> measure(scene);
    const JointViolations<Wide> closed = measure.violations(jointed(scene, q_parent, {3, 2, 1}, free_turn, free_slide));
    RC_ASSERT(double(closed.gap) < 1e-30);
    RC_ASSERT(double(closed.turn) < 1e-30);
    // perpendicular to the axis: (1 + .., a, b) x (0, 0, 1) = (a, -(1 + ..), 0)
    const Vector3<double> across = cross(axis, Vector3<double>(0, 0, 1));
    const double apart = 0.125, angle = 0.0625;
    const Vector3<Wide> moved = free_slide + (Wide(apart) / length(cast<Wide>(across))) * cast<Wide>(across);
    const auto motions = jointed(scene, q_parent, {3, 2, 1}, turn_by(across, angle) * free_turn, moved);
    const JointViolations<Wide> off = measure.violations(motions);
    RC_ASSERT(std::abs(double(off.gap) - apart) < 1e-15);
    RC_ASSERT(std::abs(double(off.turn) - (type == JointType::spherical ? 0 : angle)) < 1e-15);
    RC_ASSERT(off.gap_joint == 0U);
}

TEST(MechanismMotion, LoopsAreMeasuredAndTheWorstIsNamed) {
    Scene scene = two_fixed_bodies();
    scene.joints.assign(1, {});
    scene.joints[0].name = "held";
    scene.joints[0].type = JointType::spherical;
    scene.joints[0].child = "a";
    scene.joints[0].child_point = {0.5, 0, 0};

    scene.loops.assign(2, {});
    scene.loops[0].name = "rod";
    scene.loops[0].type = LoopType::distance;
    scene.loops[0].first = "a";
    scene.loops[0].first_point = {0.5, 0, 0};
    scene.loops[0].second = "b";
    scene.loops[0].second_point = {0, 0.25, 0};
    scene.loops[0].length = 5.5;
    scene.loops[1].name = "hinge";
    scene.loops[1].type = LoopType::revolute;
    scene.loops[1].first = "world";
    scene.loops[1].first_point = {3, 4, 0};
    scene.loops[1].second = "b";
    scene.loops[1].second_point = {0, 0.25, 0.125};
    scene.loops[1].first_axis = {0, 0, 2};
    scene.loops[1].second_axis = {0, 0, 3};

    std::vector<BodyMotion<Wide>> motions(2);
    motions[1].position_W = {3, 4, 0};
    const MechanismMeasure<Wide> measure(scene);
    EXPECT_EQ(joint_names(scene), (std::vector<std::string>{"held", "rod", "hinge"}));
    JointViolations<Wide> off = measure.violations(motions);
    EXPECT_EQ(double(off.gap), 0.5);
    EXPECT_EQ(joint_names(scene)[off.gap_joint], "rod");
    EXPECT_EQ(double(off.turn), 0);
    EXPECT_EQ(off.turn_joint, JointViolations<Wide>::none);
    motions[1].q = turn_by({1, 1, 0}, 0.25);
    motions[1].position_W = {3.3, 4.4, 0};
    off = measure.violations(motions);
    // the distance of the points (3.3, 4.4, 0) + R (0, 0, 1/8) and (3, 4, 0)
    const Vector3<Wide> apart =
        Vector3<Wide>(Wide(3.3) - 3, Wide(4.4) - 4, 0) + rotate(motions[1].q, Vector3<Wide>(0, 0, 0.125));
    EXPECT_NEAR(double(off.gap), double(length(apart)), 1e-16);
    EXPECT_EQ(off.gap_joint, 2U);
    EXPECT_NEAR(double(off.turn), 0.25, 1e-15);
    EXPECT_EQ(off.turn_joint, 2U);
    // a NaN in the motion gives the violation NaN
    std::vector<BodyMotion<double>> lost(2);
    lost[0].position_W[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(MechanismMeasure<double>(scene).violations(lost).gap));
}

}  // namespace
}  // namespace polhode
