// Massless bodies, point masses and rods in trees. A scene with a singular mass matrix is refused with the names of
// the body and the joint. Otherwise the accelerations agree with textbook formulas.
#include "motion/tree_inertia.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "motion/massless.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using massless::body_of, massless::joint_of, massless::scene_of;

std::string fault_of(const Scene& scene) {
    try {
        validate(scene, scene.name);
        pose(scene);
    } catch (const InputError& fault) {
        return fault.what();
    }
    return "";
}

// An arm on a hinge with a tip joined to its end.
Scene arm_and_tip(const NamedBody& tip, const Joint& wrist) {
    Scene scene = scene_of("arm", 1);
    scene.bodies = {body_of("arm", 1, {0.5, 0.5, 0.25}, {0, 0, -0.5}), tip};
    scene.joints = {joint_of("shoulder", JointType::revolute, "world", "arm", {1, 0, 0}), wrist};
    return scene;
}

Joint wrist(JointType type, const Vector3<double>& axis = {0, 1, 0}) {
    return joint_of("wrist", type, "arm", "tip", axis, {0, 0, -1});
}

TEST(TreeInertia, NamesTheBodyAndTheMotionWithoutInertia) {
    const NamedBody no_mass = body_of("tip", 0), point = body_of("tip", 2, {}, {0, 0, -0.25});
    const NamedBody rod = body_of("tip", 2, {0.5, 0.5, 0}, {0, 0, -0.25});
    const std::pair<Scene, const char*> refused[] = {
        {arm_and_tip(no_mass, wrist(JointType::revolute)),
         "arm: /bodies/1: \"tip\" has no inertia about joint \"wrist\"; give it mass, or use a fixed joint"},
        {arm_and_tip(no_mass, wrist(JointType::prismatic)),
         "arm: /bodies/1: \"tip\" has no mass along joint \"wrist\"; give it mass, or use a fixed joint"},
        {arm_and_tip(no_mass, wrist(JointType::universal)),
         "arm: /bodies/1: \"tip\" has no inertia about axis 1 of joint \"wrist\"; give it mass, or use a fixed joint"},
        {arm_and_tip(no_mass, wrist(JointType::spherical)),
         "arm: /bodies/1: \"tip\" has no inertia about some axis through joint \"wrist\"; give it mass, or use a fixed "
         "joint"},
        // a point mass on the axis, and a ball joint that lets it rotate about the line to it
        {arm_and_tip(point, wrist(JointType::revolute, {0, 0, 1})),
         "\"tip\" has no inertia about joint \"wrist\"; give it mass away from the axis, or use a fixed joint"},
        {arm_and_tip(point, wrist(JointType::spherical)), "use a universal joint"},
        {arm_and_tip(rod, wrist(JointType::revolute, {0, 0, 1})), "\"tip\" has no inertia about joint \"wrist\""},
        {arm_and_tip(rod, wrist(JointType::spherical)),
         "\"tip\" has no inertia about some axis through joint \"wrist\""},
    };
    for (const auto& [scene, message] : refused) {
        const std::string fault = fault_of(scene);
        EXPECT_NE(fault.find(message), std::string::npos) << "wanted: " << message << "\ngot: " << fault;
    }
    for (const NamedBody& tip : {point, rod})
        for (const JointType type : {JointType::revolute, JointType::prismatic, JointType::universal, JointType::fixed})
            EXPECT_EQ(fault_of(arm_and_tip(tip, wrist(type))), "");
    EXPECT_EQ(fault_of(arm_and_tip(no_mass, wrist(JointType::fixed))), "");
}

// With a massless link between two coaxial hinges, the message names the inner joint, whose motion has no inertia.
TEST(TreeInertia, NamesTheInnerJointOfTwoParallelHinges) {
    Scene scene = scene_of("links", 1);
    scene.bodies = {body_of("link", 0), body_of("tip", 1, {0.5, 0.5, 0.5})};
    scene.joints = {joint_of("inner", JointType::revolute, "world", "link", {0, 0, 1}),
                    joint_of("outer", JointType::revolute, "link", "tip", {0, 0, 1})};
    EXPECT_NE(fault_of(scene).find("/bodies/0: \"link\" has no inertia about joint \"inner\""), std::string::npos)
        << fault_of(scene);
    // hinges with parallel but separate axes, or with axes that are not parallel, have inertia
    scene.joints[1].parent_point = {0.25, 0, 0};
    EXPECT_EQ(fault_of(scene), "");
    scene.joints[1].parent_point = {}, scene.joints[1].axes[0] = {0, 1, 1};
    EXPECT_EQ(fault_of(scene), "");
}

// A message about an imported robot names the place in the robot's file.
TEST(TreeInertia, NamesTheLineOfAnImportedRobot) {
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "polhode_tree_inertia";
    std::filesystem::create_directories(folder);
    const std::string inertial =
        "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
    const auto fault = [&](const std::string& robot) {
        std::ofstream(folder / "r.urdf") << robot;
        return fault_of(
            parse_scene(R"({"name": "x", "duration": 1, "import": {"file": "r.urdf"}})", "s.json", folder.string()));
    };
    EXPECT_EQ(fault("<robot name='r'>\n<link name='base'/>\n<link name='a'/>\n<link name='b'>" + inertial +
                    "</link>\n<joint name='j' type='continuous'>\n<parent link='base'/><child link='a'/>"
                    "<axis xyz='0 0 1'/></joint>\n<joint name='k' type='continuous'>"
                    "<parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>"),
              "x: /import: r.urdf: line 5: \"a\" has no inertia about joint \"j\"; give it mass away from the axis, or "
              "use a fixed joint");
    std::filesystem::remove_all(folder);
}

// A free body needs mass and moments, from itself or from bodies fixed to it.
TEST(TreeInertia, AFreeBaseNeedsInertia) {
    Scene scene = scene_of("flight", 1);
    scene.bodies = {body_of("frame", 0), body_of("box", 2, {0.5, 0.75, 1}, {0.5, 0, 0})};
    scene.joints = {joint_of("seat", JointType::fixed, "frame", "box", {0, 1, 0}, {0, 0, 1})};
    scene.bodies[0].initial.velocity_W = {1, 2, 3}, scene.bodies[0].initial.angular_velocity = {0.5, 0.25, -1};
    EXPECT_EQ(fault_of(scene), "");
    scene.joints[0].type = JointType::revolute;
    EXPECT_NE(fault_of(scene).find("/bodies/0: \"frame\" has no mass and is not the child of a joint"),
              std::string::npos)
        << fault_of(scene);
    scene.bodies[0].body.mass = 1;
    EXPECT_NE(
        fault_of(scene).find("\"frame\" has no moment of inertia about some axis and is not the child of a joint"),
        std::string::npos)
        << fault_of(scene);
}

std::vector<double> derivative_at_start(const Scene& scene) {
    Tree<double> tree(scene, bodies_mass_properties<double>(scene));
    tree.set_loads(scene, 0);
    std::vector<double> y(static_cast<std::size_t>(tree.dimension())), dy(y.size());
    tree.initial(y.data());
    tree.derivative(y.data(), dy.data());
    return dy;
}

// A thin rod of length L hinged at its end: theta'' = -3 g sin(theta) / (2 L).
TEST(TreeInertia, ARodSwingsAsTheBookSays) {
    const double L = 1.5, m = 2, g = 9.75, theta = 0.75;
    Scene scene = scene_of("rod", 1);
    scene.bodies = {body_of("rod", m, {m * L * L / 12, m * L * L / 12, 0}, {0, 0, -L / 2})};
    scene.joints = {joint_of("hinge", JointType::revolute, "world", "rod")};
    scene.joints[0].coordinate[0] = theta;
    scene.loads = {Gravity{{0, 0, -g}, {}}};
    EXPECT_NEAR(derivative_at_start(scene)[1], -3 * g * std::sin(theta) / (2 * L), 1e-14);
}

// The textbook equations of the double pendulum of point masses.
TEST(TreeInertia, TwoPointMassesAccelerateAsTheBookSays) {
    const massless::PointMassPendulum p;
    const std::vector<double> dy = derivative_at_start(p.scene(1));
    const double d = p.theta1 - p.theta2, s = std::sin(d), c = std::cos(d);
    const double below = 2 * p.m1 + p.m2 - p.m2 * std::cos(2 * d);
    const double a1 = (-p.g * (2 * p.m1 + p.m2) * std::sin(p.theta1) - p.m2 * p.g * std::sin(p.theta1 - 2 * p.theta2) -
                       2 * s * p.m2 * (p.w2 * p.w2 * p.l2 + p.w1 * p.w1 * p.l1 * c)) /
                      (p.l1 * below);
    const double a2 = 2 * s *
                      (p.w1 * p.w1 * p.l1 * (p.m1 + p.m2) + p.g * (p.m1 + p.m2) * std::cos(p.theta1) +
                       p.w2 * p.w2 * p.l2 * p.m2 * c) /
                      (p.l2 * below);
    EXPECT_NEAR(dy[2], a1, 1e-13 * std::abs(a1));
    EXPECT_NEAR(dy[3], a2 - a1, 1e-13 * std::abs(a2));
}

}  // namespace
}  // namespace polhode
