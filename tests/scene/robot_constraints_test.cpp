// Equality constraints of MJCF, and gearboxes and mimic joints of SDFormat, against positions and rotations computed by
// hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "body/orientation.h"
#include "motion/mechanism.h"
#include "motion/problem.h"
#include "scene/robot_tree.h"
#include "scene/scene_file.h"

namespace polhode::robot_constraints_test {
namespace {

Scene import(const std::string& text) {
    Scene scene;
    scene.name = "robot", scene.duration = 1;
    const RobotOptions options;
    add_robot(parse_robot(text, "robot.xml", options), options, "robot.xml", scene);
    validate(scene, "robot.xml");
    return scene;
}

const Joint& joint_named(const Scene& scene, const std::string& name) {
    for (const Joint& joint : scene.joints)
        if (joint.name == name) return joint;
    throw std::out_of_range("no joint " + name);
}

bool omits(const Scene& scene, const std::string& what) {
    return std::ranges::any_of(scene.omitted, [&](const std::string& one) { return one.find(what) != one.npos; });
}

std::size_t body_named(const Scene& scene, const std::string& name) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        if (scene.bodies[b].name == name) return b;
    throw std::out_of_range("no body " + name);
}

const std::string inertial = "<inertial pos='0.1 0 -0.2' mass='2' diaginertia='0.5 0.5 0.25'/>";

std::string body(const std::string& name, const std::string& place, const std::string& inside) {
    return "<body name='" + name + "' " + place + ">" + inside + inertial + "</body>";
}

std::string mjcf(const std::string& world, const std::string& equality, const std::string& more = "") {
    return "<mujoco><compiler angle='radian'/>" + more + "<worldbody>" + world + "</worldbody><equality>" + equality +
           "</equality></mujoco>";
}

const std::string two_hinges = body("a", "pos='0 0 1'", "<joint name='h' axis='0 1 0'/>") +
                               body("b", "pos='1 0 1'", "<joint name='k' axis='0 2 0' pos='0 0 0.5' stiffness='3'/>");

TEST(MjcfEquality, JointsBecomeCouplingsAndFixedJoints) {
    const Scene geared = import(mjcf(two_hinges, "<joint joint1='k' joint2='h' polycoef='0.25 -2 0 0 0'/>"));
    ASSERT_EQ(geared.couplings.size(), 1u);
    EXPECT_EQ(geared.couplings[0].first, "h");
    EXPECT_EQ(geared.couplings[0].second, "k");
    EXPECT_EQ(geared.couplings[0].ratio, -2);
    EXPECT_EQ(geared.couplings[0].offset, 0.25);
    EXPECT_TRUE(geared.omitted.empty()) << geared.omitted.front();
    // the same pose as that of a hinge turned by 0.5 rad about its point
    const Scene locked = import(mjcf(two_hinges, "<joint joint1='k' polycoef='0.5'/>"));
    EXPECT_EQ(joint_named(locked, "k").type, JointType::fixed);
    Scene turned = import(mjcf(two_hinges, ""));
    const std::size_t k = static_cast<std::size_t>(&joint_named(turned, "k") - turned.joints.data());
    turned.joints[k].coordinate[0] = 0.5;
    const std::size_t b = body_named(turned, "b");
    const BodyMotion<double> one = mechanism_initial_motions(locked)[b], other = mechanism_initial_motions(turned)[b];
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(one.position_W[i], other.position_W[i], 1e-15);
    EXPECT_NEAR(one.q.y, std::sin(0.25), 1e-15);
    // a parabola is not a coupling, and a disabled constraint has no effect
    const Scene parabola = import(mjcf(two_hinges, "<joint name='p' joint1='k' joint2='h' polycoef='0 1 2 0 0'/>"));
    EXPECT_TRUE(parabola.couplings.empty());
    EXPECT_TRUE(omits(parabola, "equality constraints: p"));
    for (const Scene& off :
         {import(mjcf(two_hinges, "<joint joint1='k' joint2='h' active='false'/>")),
          import(mjcf(two_hinges, "<joint joint1='k' joint2='h'/>", "<option><flag equality='disable'/></option>"))}) {
        EXPECT_TRUE(off.couplings.empty());
        EXPECT_TRUE(off.omitted.empty()) << off.omitted.front();
    }
}

// A four-bar linkage: two cranks of 1 m, a coupler of 2 m between them.
TEST(MjcfEquality, ConnectClosesALoop) {
    const std::string four_bar =
        body("left", "",
             "<joint name='l' axis='0 1 0'/>" + body("coupler", "pos='0 0 1'", "<joint name='c' axis='0 1 0'/>")) +
        body("right", "pos='2 0 0'", "<joint name='r' axis='0 1 0'/>");
    const Scene scene = import(mjcf(four_bar, "<connect name='pin' body1='coupler' body2='right' anchor='2 0 0'/>"));
    ASSERT_EQ(scene.loops.size(), 1u);
    EXPECT_EQ(scene.loops[0].name, "pin");
    EXPECT_EQ(scene.loops[0].type, LoopType::spherical);
    EXPECT_EQ(scene.loops[0].second, "right");
    const Vector3<double> point = scene.loops[0].second_point;
    EXPECT_EQ(point[0], 0);
    EXPECT_EQ(point[1], 0);
    EXPECT_EQ(point[2], 1);
    const Problem problem = pose(scene);
    EXPECT_EQ(mechanism_of(problem).tree().independent_loop_rows(), 2u);
    // to the world: the second point is where the first one is
    const Scene held = import(mjcf(four_bar, "<connect body1='coupler' anchor='2 0 0.5'/>"));
    ASSERT_EQ(held.loops.size(), 1u);
    EXPECT_EQ(held.loops[0].second, "world");
    EXPECT_EQ(held.loops[0].second_point[0], 2);
    EXPECT_EQ(held.loops[0].second_point[2], 1.5);
    EXPECT_TRUE(omits(import(mjcf(four_bar, "<connect name='s' site1='x' site2='y'/>")), "equality constraints: s"));
}

TEST(MjcfEquality, WeldFixesAFreeBody) {
    const std::string bodies = body("arm", "pos='0 0 1'", "<joint name='h' axis='0 1 0'/>") +
                               body("box", "pos='1 0 1.5' quat='0.8 0 0 0.6'", "<freejoint/>");
    const Scene scene = import(mjcf(bodies, "<weld body1='arm' body2='box'/>"));
    ASSERT_EQ(scene.joints.size(), 2u);
    const Joint& weld = scene.joints[scene.joints[0].child == "box" ? 0 : 1];
    EXPECT_EQ(weld.type, JointType::fixed);
    EXPECT_EQ(weld.parent, "arm");
    EXPECT_EQ(weld.parent_point[0] - weld.child_point[0] * 0.28, 1);
    EXPECT_NEAR(weld.parent_orientation.w, 0.8, 1e-16);
    EXPECT_NEAR(weld.parent_orientation.z, 0.6, 1e-16);
    const BodyMotion<double> box = mechanism_initial_motions(scene)[body_named(scene, "box")];
    // centre of mass (0.1, 0, -0.2) rotated by (0.8, 0, 0, 0.6)
    EXPECT_NEAR(box.position_W[0], 1 + 0.1 * 0.28, 1e-15);
    EXPECT_NEAR(box.position_W[1], 0.1 * 0.96, 1e-15);
    EXPECT_NEAR(box.position_W[2], 1.3, 1e-15);
    // a given pose of the second body in the first
    const Scene placed = import(mjcf(bodies, "<weld body1='arm' body2='box' relpose='0 0 -1 1 0 0 0'/>"));
    EXPECT_NEAR(mechanism_initial_motions(placed)[body_named(placed, "box")].position_W[2], -0.2, 1e-15);
    // both bodies are carried by joints
    EXPECT_TRUE(omits(import(mjcf(two_hinges, "<weld name='w' body1='a' body2='b'/>")), "equality constraints: w"));
}

std::string link(const std::string& name) {
    return "<link name='" + name + "'><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz>" +
           "</inertia></inertial></link>";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& inside) {
    return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child +
           "</child>" + inside + "</joint>";
}
std::string sdf(const std::string& inside) {
    return "<sdf version='1.11'><model name='m'>" + inside + "</model></sdf>";
}
std::string axis(const std::string& xyz, const char* tag = "axis") {
    return std::string("<") + tag + "><xyz>" + xyz + "</xyz></" + tag + ">";
}

// The rotation of a body from its start about an axis in the world, for coordinates q of the first and ratio q of the
// second joint.
double rotation_of(Scene scene, const std::string& name, double q, const Vector3<double>& axis_W) {
    Joint& first = scene.joints[scene.joints[0].name == scene.couplings[0].first ? 0 : 1];
    Joint& second = scene.joints[scene.joints[0].name == scene.couplings[0].first ? 1 : 0];
    first.coordinate[0] = q, second.coordinate[0] = scene.couplings[0].ratio * q;
    const BodyMotion<double> body = mechanism_initial_motions(scene)[body_named(scene, name)];
    return 2 * std::atan2(dot(vector_part(body.q), axis_W), body.q.w);
}

// theta2 = -ratio theta1, whatever the directions of the two hinges.
TEST(SdfGearbox, CouplesTwoHingesOfTheReferenceBody) {
    for (const char* first : {"0 0 1", "0 0 -2"})
        for (const char* second : {"0 0 1", "0 0 -3"}) {
            const std::string hinges =
                link("base") + link("a") + link("b") + joint("hold", "fixed", "world", "base", "") +
                joint("h", "revolute", "base", "a", axis(first)) + joint("k", "revolute", "base", "b", axis(second));
            const Scene scene = import(
                sdf(hinges + joint("gear", "gearbox", "a", "b",
                                   axis("0 0 1") + axis("0 0 -1", "axis2") + "<gearbox_ratio>1.5</gearbox_ratio>" +
                                       "<gearbox_reference_body>base</gearbox_reference_body>")));
            ASSERT_EQ(scene.couplings.size(), 1u);
            EXPECT_TRUE(scene.omitted.empty()) << scene.omitted.front();
            const double theta1 = rotation_of(scene, "a", 0.5, {0, 0, 1}),
                         theta2 = rotation_of(scene, "b", 0.5, {0, 0, -1});
            EXPECT_NEAR(std::abs(theta1), 0.5, 1e-15);
            EXPECT_NEAR(theta2, -1.5 * theta1, 1e-15) << first << " " << second;
        }
    const std::string loose = link("base") + link("a") + link("b") + joint("hold", "fixed", "world", "base", "") +
                              joint("h", "revolute", "base", "a", axis("0 0 1"));
    EXPECT_TRUE(omits(import(sdf(loose + joint("gear", "gearbox", "a", "b",
                                               axis("0 0 1") + axis("0 0 1", "axis2") +
                                                   "<gearbox_reference_body>base</gearbox_reference_body>"))),
                      "gearbox joints that do not connect two hinges of their reference body: gear"));
}

TEST(SdfMimic, CouplesTwoJoints) {
    const std::string mimic =
        "<axis><xyz>0 0 1</xyz><mimic joint='h' axis='axis'><multiplier>-2</multiplier><offset>0.25</offset>"
        "<reference>0.5</reference></mimic></axis>";
    const Scene scene =
        import(sdf(link("base") + link("a") + link("b") + joint("hold", "fixed", "world", "base", "") +
                   joint("h", "revolute", "base", "a", axis("0 1 0")) + joint("k", "prismatic", "base", "b", mimic)));
    ASSERT_EQ(scene.couplings.size(), 1u);
    EXPECT_EQ(scene.couplings[0].first, "h");
    EXPECT_EQ(scene.couplings[0].second, "k");
    EXPECT_EQ(scene.couplings[0].ratio, -2);
    EXPECT_EQ(scene.couplings[0].offset, 1.25);
    EXPECT_TRUE(scene.omitted.empty()) << scene.omitted.front();
    EXPECT_NO_THROW(pose(scene));
}

}  // namespace
}  // namespace polhode::robot_constraints_test
