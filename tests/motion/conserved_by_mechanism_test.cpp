// Invariants claimed for mechanisms, compared with the quantities along a numerical motion and with the known
// conservation laws of each system.
#include "motion/conserved_by_mechanism.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "motion/mechanism.h"
#include "motion/mechanism_motion.h"

namespace polhode {
namespace {

using V3 = Vector3<double>;
using QuantityNames = std::vector<std::string>;

NamedBody skew_body(const char* name) {
    NamedBody body;
    body.name = name;
    body.body.mass = 1.5, body.body.center_of_mass = {0.25, 0.5, -0.125};
    body.body.inertia_B = diagonal(V3(0.5, 0.75, 1));
    return body;
}

Joint turning_joint(const char* name, JointType type, const char* parent, const char* child,
                    const V3& axis = {1, 0, 0}) {
    Joint joint;
    joint.name = name, joint.type = type, joint.parent = parent, joint.child = child, joint.axes[0] = axis;
    if (type == JointType::universal) joint.axes[1] = {0, 0, 1};
    if (type == JointType::spherical) joint.angular_velocity = {0.5, -0.75, 1};
    if (type != JointType::spherical && type != JointType::fixed) joint.rate[0] = 0.75;
    return joint;
}

Scene scene_of_bodies(std::vector<NamedBody> bodies, std::vector<Joint> joints, std::vector<Load> loads = {}) {
    Scene scene;
    scene.name = "kept", scene.duration = 0.5;
    scene.bodies = std::move(bodies), scene.joints = std::move(joints), scene.loads = std::move(loads);
    return scene;
}

// two bodies joined by a hinge, rotating in flight
Scene flying_pair(std::vector<Load> loads = {}) {
    NamedBody base = skew_body("base");
    base.initial.angular_velocity = {1, 0.5, -0.75}, base.initial.velocity_W = {0.5, 0.25, 1};
    Joint hinge = turning_joint("hinge", JointType::revolute, "base", "arm", {0, 1, 0.5});
    hinge.parent_point = {0, 0.5, 0.25};
    return scene_of_bodies({base, skew_body("arm")}, {hinge}, std::move(loads));
}

// two bodies, the first joined to the world
Scene hung_pair(JointType type, const V3& at, const V3& axis, std::vector<Load> loads = {}) {
    Joint first = turning_joint("first", type, "world", "upper", axis);
    first.parent_point = at;
    Joint second = turning_joint("second", JointType::spherical, "upper", "lower");
    second.parent_point = {0, 0.75, 0};
    return scene_of_bodies({skew_body("upper"), skew_body("lower")}, {first, second}, std::move(loads));
}

Force force_at(const V3& vector, Frame frame, Frame point_frame = Frame::body) {
    return {vector, frame, {0.5, 0, 0}, point_frame, {}, point_frame == Frame::body ? "base" : "arm"};
}

// Integrates by the classical fourth-order Runge-Kutta method in joint coordinates with h = 1/1024 s. Passes every
// fiftieth state to `see`, from 0+ on.
template <class See>
void walk(const Problem& problem, const See& see) {
    MechanismModel model = mechanism_of(problem);
    const auto n = static_cast<std::size_t>(model.dimension());
    std::vector<double> y(n), at(n), k(n), sum(n);
    model.initial(y.data());
    constexpr double h = 1.0 / 1024;
    for (int step = 0; step <= 512; ++step) {
        // all loads start and end at multiples of h
        model.enter(step * h, y.data());
        if (step % 50 == 0) see(step * h, model.motion(y.data()));
        constexpr double ahead[] = {0, 0.5, 0.5, 1}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
        std::ranges::fill(k, 0.0), std::ranges::fill(sum, 0.0);
        for (int stage = 0; stage < 4; ++stage) {
            for (std::size_t i = 0; i < n; ++i) at[i] = y[i] + h * ahead[stage] * k[i];
            model.derivative(at.data(), k.data());
            for (std::size_t i = 0; i < n; ++i) sum[i] += weight[stage] * k[i];
        }
        for (std::size_t i = 0; i < n; ++i) y[i] += h * sum[i];
    }
}

// Checks the names of the invariants. Named ones are constant along the motion, other energies and momenta change.
void expect_conserved(const char* what, const Scene& scene, QuantityNames expected) {
    SCOPED_TRACE(what);
    const Problem problem = pose(scene);
    const std::vector<Conserved> all = conserved_by_mechanism(problem);
    QuantityNames names;
    for (const Conserved& one : all) names.push_back(one.name);
    std::ranges::sort(names), std::ranges::sort(expected);
    EXPECT_EQ(names, expected);

    const MechanismMeasure<double> measure(problem.scene);
    JointCoordinates coordinates(problem.scene);
    std::vector<SystemInvariants<double>> along;
    walk(problem, [&](double t, const std::vector<Sample>& samples) {
        std::vector<BodyMotion<double>> bodies;
        for (const Sample& s : samples)
            bodies.push_back({normalized(s.q), s.angular_velocity_B, s.position_W, s.velocity_W});
        along.push_back(measure.invariants(t, bodies, coordinates));
    });
    constexpr double same = 1e-7, other = 1e-3;
    const auto largest_change = [&](auto quantity) {
        double change = 0;
        for (const auto& at : along) change = std::max(change, length(quantity(at) - quantity(along.front())));
        return change;
    };
    const auto energy = [](const auto& at) { return V3(at.energy, 0, 0); };
    const auto angular = [](const auto& at) { return at.angular_momentum_W; };
    const auto linear = [](const auto& at) { return at.linear_momentum_W; };
    const auto is_named = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
    if (!is_named("energy")) {
        EXPECT_GT(largest_change(energy), other);
    }
    if (!is_named("angular momentum")) {
        EXPECT_GT(largest_change(angular), other);
    }
    if (!is_named("linear momentum")) {
        EXPECT_GT(largest_change(linear), other);
    }
    for (const Conserved& one : all)
        for (const auto& at : along) {
            const V3 vector = one.name.starts_with("angular") ? at.angular_momentum_W : at.linear_momentum_W;
            if (one.name == "energy") {
                EXPECT_NEAR(at.energy, one.value.at(0), same);
            } else if (one.name.ends_with("along u")) {
                EXPECT_NEAR(dot(vector, one.direction), one.value.at(0), same) << one.name;
            } else {
                const V3 projection = vector - dot(vector, one.direction) * one.direction;
                for (int i = 0; i < 3; ++i) EXPECT_NEAR(projection[i], one.value.at(i), same) << one.name << ' ' << i;
            }
        }
}

const Gravity falling{{0, 0, -9.81}, {}};
const std::string conserves_energy = "energy", keeps_L = "angular momentum", keeps_p = "linear momentum",
                  keeps_L_across = keeps_L + " perpendicular to u", keeps_p_across = keeps_p + " perpendicular to u",
                  keeps_L_along = keeps_L + " along u";

TEST(ConservedByMechanism, InFlight) {
    expect_conserved("nothing acts", flying_pair(), {conserves_energy, keeps_L, keeps_p});
    expect_conserved("gravity", flying_pair({falling}), {conserves_energy, keeps_L, keeps_p_across});
    expect_conserved("gravity twice along one line", flying_pair({falling, Gravity{{0, 0, 2}, {}}}),
                     {conserves_energy, keeps_L, keeps_p_across});
    expect_conserved("gravity along two lines", flying_pair({falling, Gravity{{1, 0, 0}, {0.25, 1}}}), {keeps_L});
    expect_conserved("torque, world axes", flying_pair({Torque{{0, 2, 0}, Frame::world, {}, "arm"}}),
                     {keeps_L_across, keeps_p});
    expect_conserved("torque, body axes", flying_pair({Torque{{0, 2, 0}, Frame::body, {}, "arm"}}), {keeps_p});
    expect_conserved("a zero torque", flying_pair({Torque{{0, 0, 0}, Frame::world, {}, "arm"}}),
                     {conserves_energy, keeps_L, keeps_p});
    expect_conserved("force, world axes, at a point of the body", flying_pair({force_at({1, 2, 0}, Frame::world)}),
                     {conserves_energy, keeps_p_across});
    expect_conserved("force at a point of the world", flying_pair({force_at({1, 2, 0}, Frame::world, Frame::world)}),
                     {keeps_p_across});
    expect_conserved("force, body axes", flying_pair({force_at({1, 2, 0}, Frame::body)}), {});
    expect_conserved("drag of turning", flying_pair({Drag{{0.5, 0.5, 0.5}, 0, {}, "base"}}), {keeps_p});
    expect_conserved("drag", flying_pair({Drag{{}, 0.5, {}, "base"}}), {});
    expect_conserved("a torsional spring", flying_pair({Spring{3, {0.6, 0.8, 0, 0}, {}, "arm"}}),
                     {conserves_energy, keeps_p});
    expect_conserved("a spring between the bodies",
                     flying_pair({PointSpring{"base", {1, 0, 0}, "arm", {0, 1, 1}, 3, 0.5, {}}}),
                     {conserves_energy, keeps_L, keeps_p});
    expect_conserved("a spring to the world",
                     flying_pair({PointSpring{"world", {1, 0, 0}, "arm", {0, 1, 1}, 3, 0.5, {}}}), {conserves_energy});
    expect_conserved("a motor", flying_pair({Motor{"hinge", 2, {}}}), {keeps_L, keeps_p});
    Scene damped = flying_pair();
    damped.joints[0].damping[0] = 0.5;
    expect_conserved("a damper", damped, {keeps_L, keeps_p});
    Scene sprung = flying_pair();
    sprung.joints[0].stiffness[0] = 5, sprung.joints[0].rest[0] = 0.5;
    expect_conserved("a joint's spring", sprung, {conserves_energy, keeps_L, keeps_p});
}

TEST(ConservedByMechanism, WithImpulses) {
    const auto impulse = [](Frame frame, double at) {
        return Impulse{{1, 0.5, 0}, frame, {0.5, 0, 0}, Frame::body, at, "arm"};
    };
    // the values are those after the impulse at t = 0
    const std::vector<Conserved> before = conserved_by_mechanism(pose(flying_pair())),
                                 after = conserved_by_mechanism(pose(flying_pair({impulse(Frame::world, 0)})));
    ASSERT_EQ(before.size(), 3u);
    ASSERT_EQ(after.size(), 3u);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(after[2].value[i] - before[2].value[i], V3(1, 0.5, 0)[i], 1e-14);
    expect_conserved("later, world axes", flying_pair({impulse(Frame::world, 0.25)}), {keeps_p_across});
    expect_conserved("later, body axes", flying_pair({impulse(Frame::body, 0.25)}), {});
}

TEST(ConservedByMechanism, HungOnAPoint) {
    const auto ball = JointType::spherical;
    expect_conserved("at the origin, nothing acts", hung_pair(ball, {}, {}), {conserves_energy, keeps_L});
    expect_conserved("at the origin, gravity", hung_pair(ball, {}, {}, {falling}), {conserves_energy, keeps_L_along});
    expect_conserved("elsewhere, nothing acts", hung_pair(ball, {0, 1, 0}, {}), {conserves_energy, keeps_L_along});
    expect_conserved("under the origin, gravity", hung_pair(ball, {0, 0, -2}, {}, {falling}),
                     {conserves_energy, keeps_L_along});
    expect_conserved("beside the origin, gravity", hung_pair(ball, {1, 0, 0}, {}, {falling}), {conserves_energy});
    expect_conserved("a torque about it", hung_pair(ball, {}, {}, {Torque{{0, 0, 1}, Frame::world, {}, "lower"}}), {});
    expect_conserved("a torque across the vertical",
                     hung_pair(ball, {}, {}, {falling, Torque{{1, 0, 0}, Frame::world, {}, "lower"}}), {keeps_L_along});
    expect_conserved("a torque about the vertical",
                     hung_pair(ball, {}, {}, {falling, Torque{{0, 0, 1}, Frame::world, {}, "lower"}}), {});
    expect_conserved("drag", hung_pair(ball, {}, {}, {falling, Drag{{0.5, 0.5, 0.5}, 0, {}, "lower"}}), {});
    expect_conserved("a spring within",
                     hung_pair(ball, {}, {}, {falling, PointSpring{"upper", {}, "lower", {1, 0, 0}, 4, 0.5, {}}}),
                     {conserves_energy, keeps_L_along});
    Scene damped = hung_pair(ball, {}, {}, {falling});
    damped.joints[0].damping[0] = 0.5;
    expect_conserved("a damper to the world", damped, {});
    damped.joints[0].damping[0] = 0, damped.joints[1].damping[0] = 0.5;
    expect_conserved("a damper within", damped, {keeps_L_along});
}

TEST(ConservedByMechanism, HungOnAnAxis) {
    const auto hinge = JointType::revolute;
    expect_conserved("gravity along it", hung_pair(hinge, {0, 0, 1}, {0, 0, 1}, {falling}),
                     {conserves_energy, keeps_L_along});
    expect_conserved("gravity across it", hung_pair(hinge, {}, {1, 0, 0}, {falling}), {conserves_energy});
    expect_conserved("nothing acts", hung_pair(hinge, {}, {1, 0, 0}), {conserves_energy, keeps_L_along});
    expect_conserved("beside the origin", hung_pair(hinge, {0, 1, 0}, {1, 0, 0}), {conserves_energy});
    Scene sprung = hung_pair(hinge, {}, {1, 0, 0});
    sprung.joints[0].stiffness[0] = 4;
    expect_conserved("a spring to the world", sprung, {conserves_energy});
    expect_conserved("a motor on the world", hung_pair(hinge, {}, {1, 0, 0}, {Motor{"first", 2, {}}}), {});
    expect_conserved("a slide", hung_pair(JointType::prismatic, {}, {1, 0, 0}), {conserves_energy});
    expect_conserved("a universal joint", hung_pair(JointType::universal, {}, {1, 0, 0}), {conserves_energy});

    // a second tree joined to the world
    Scene two = hung_pair(hinge, {}, {1, 0, 0});
    two.bodies.push_back(skew_body("beside"));
    two.joints.push_back(turning_joint("third", hinge, "world", "beside", {-2, 0, 0}));
    expect_conserved("two hinges on one line", two, {conserves_energy, keeps_L_along});
    two.joints.back().axes[0] = {0, 1, 0};
    expect_conserved("two hinges on two lines", two, {conserves_energy});
    two.joints.back() = turning_joint("third", JointType::spherical, "world", "beside");
    two.joints.back().parent_point = {3, 0, 0};
    expect_conserved("a hinge and a point of its line", two, {conserves_energy, keeps_L_along});

    Scene closed = hung_pair(hinge, {}, {0, 0, 1}, {falling});
    Loop rod;
    rod.name = "rod", rod.type = LoopType::distance, rod.second = "upper", rod.first_point = {0, 0, 3};
    rod.second_point = {0, 0, 0}, rod.length = 3;
    closed.loops = {rod};
    EXPECT_EQ(conserved_by_mechanism(pose(closed)).size(), 1u);  // a distance to the world, although without an arm
}

TEST(ConservedByMechanism, MotionInPlanes) {
    const auto plane = [](std::vector<NamedBody> bodies, std::vector<Joint> joints) {
        return plane_of_motion(pose(scene_of_bodies(std::move(bodies), std::move(joints), {falling})));
    };
    const std::vector<NamedBody> one{skew_body("a")}, both{skew_body("a"), skew_body("b")};
    const auto hinge = JointType::revolute, slide = JointType::prismatic;
    const auto pair = [](JointType first, const V3& u, JointType second, const V3& v) {
        return std::vector<Joint>{turning_joint("first", first, "world", "a", u),
                                  turning_joint("second", second, "a", "b", v)};
    };
    const auto normal = [](const std::optional<V3>& found, const V3& expected) {
        return found && length(cross(*found, expected)) < 1e-12 && std::abs(length(*found) - 1) < 1e-12;
    };
    const V3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    EXPECT_TRUE(normal(plane(both, pair(hinge, {0, 2, 0}, hinge, {0, -1, 0})), y));
    EXPECT_TRUE(normal(plane(both, pair(hinge, y, slide, x)), y));
    EXPECT_TRUE(normal(plane(both, pair(slide, x, slide, y)), z));
    EXPECT_TRUE(normal(plane(both, pair(hinge, y, JointType::fixed, x)), y));
    EXPECT_FALSE(plane(both, pair(hinge, y, hinge, z)));
    EXPECT_FALSE(plane(both, pair(hinge, y, slide, y)));
    EXPECT_FALSE(plane(both, pair(slide, x, slide, x)));
    EXPECT_FALSE(plane(both, pair(hinge, y, JointType::spherical, x)));
    EXPECT_FALSE(plane(one, {turning_joint("first", slide, "world", "a")}));
    EXPECT_FALSE(plane(one, {turning_joint("first", JointType::universal, "world", "a")}));
    EXPECT_FALSE(plane_of_motion(pose(flying_pair())));

    // the motion stays in this plane
    const Problem problem = pose(scene_of_bodies(both, pair(hinge, y, slide, {1, 0, 1}), {falling}));
    std::vector<double> heights;
    walk(problem, [&](double, const std::vector<Sample>& samples) {
        for (const Sample& sample : samples) heights.push_back(sample.position_W[1]);
    });
    for (std::size_t i = 2; i < heights.size(); ++i) EXPECT_NEAR(heights[i], heights[i % 2], 1e-12);
}

}  // namespace
}  // namespace polhode
