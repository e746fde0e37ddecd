// Import of whole robots: one robot in three formats, compared with hand-computed positions; merged links and refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "body/mass_properties.h"
#include "body/orientation.h"
#include "places.h"
#include "scene/builtin.h"
#include "scene/inertia_repair.h"
#include "scene/robot_tree.h"
#include "scene/scene_file.h"
#include "text/named_file.h"

namespace polhode {
namespace {

Scene robot_scene(const std::string& text, RobotBase base = RobotBase::format_default) {
    Scene scene;
    scene.name = "robot", scene.duration = 1;
    RobotOptions options;
    options.base = base;
    add_robot(parse_robot(text, "robot.xml", options), options, "robot.xml", scene);
    validate(scene, "robot.xml");
    return scene;
}

std::string robot_fault(const std::string& text, RobotBase base = RobotBase::format_default) {
    try {
        robot_scene(text, base);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

const Joint& joint_named(const Scene& scene, const std::string& name) {
    for (const Joint& joint : scene.joints)
        if (joint.name == name) return joint;
    throw std::out_of_range("no joint " + name);
}

// The placement of a body: its point x is at A x + p.
struct Placed {
    Matrix3<double> A = diagonal(Vector3<double>(1, 1, 1));
    Vector3<double> p;
};
Placed operator*(const Placed& outer, const Placed& inner) { return {outer.A * inner.A, outer.A * inner.p + outer.p}; }
Vector3<double> operator*(const Placed& there, const Vector3<double>& x) { return there.A * x + there.p; }

// Rodrigues' formula.
Placed turned(const Vector3<double>& axis, double angle) {
    const double length = std::sqrt(dot(axis, axis));
    const Vector3<double> n = (1 / length) * axis;
    Placed turn;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            turn.A[i][j] =
                (i == j ? std::cos(angle) : 0) + (1 - std::cos(angle)) * n[i] * n[j] + std::sin(angle) * skew(n)[i][j];
    return turn;
}
Placed moved(const Vector3<double>& by) { return {diagonal(Vector3<double>(1, 1, 1)), by}; }
Placed rpy(double r, double p, double y) { return turned({0, 0, 1}, y) * turned({0, 1, 0}, p) * turned({1, 0, 0}, r); }

// The pose of the child in the parent, from a scene's numbers and the contract's definition of the joint.
Placed by_contract(const Joint& j, double x, double y = 0) {
    const Placed q0{rotation_matrix(normalized(j.parent_orientation)), {}};
    Placed J;
    Vector3<double> slid;
    if (j.type == JointType::revolute) J = turned(j.axes[0], x);
    if (j.type == JointType::universal) J = turned(j.axes[0], x) * turned(j.axes[1], y);
    if (j.type == JointType::prismatic) slid = (x / std::sqrt(dot(j.axes[0], j.axes[0]))) * j.axes[0];
    Placed there = q0 * J;
    there.p = j.parent_point + q0.A * slid - there.A * j.child_point;
    return there;
}

void expect_same(const Placed& a, const Placed& b, double within) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(a.p[i], b.p[i], within) << i;
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(a.A[i][j], b.A[i][j], within) << i << j;
    }
}

const std::string inertial =
    R"(<inertial><origin xyz="0.1 0.2 0.3"/><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial>)";
std::string urdf(const std::string& inside) { return "<robot name='r'>" + inside + "</robot>"; }
std::string link(const std::string& name) { return "<link name='" + name + "'>" + inertial + "</link>"; }
std::string bare(const std::string& name) { return "<link name='" + name + "'/>"; }
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "") {
    return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
           "'/>" + more + "</joint>";
}

TEST(RobotImport, UrdfJointsMoveAsItsMatricesSay) {
    const Scene s = robot_scene(
        urdf(bare("world_link") + link("a") + link("b") + link("c") +
             joint("j1", "revolute", "world_link", "a",
                   "<origin xyz='1 2 3' rpy='0.3 -0.7 1.1'/><axis xyz='0 2 0'/><dynamics damping='0.5' friction='1'/>"
                   "<limit lower='0' upper='1'/>") +
             joint("j2", "prismatic", "a", "b", "<origin xyz='-1 0.5 0.25' rpy='-0.2 0.4 2'/><axis xyz='1 1 0'/>") +
             joint("j3", "continuous", "b", "c", "<origin rpy='3 0 0'/>") + "<transmission name='t1'/>"));
    ASSERT_EQ(s.joints.size(), 3u);
    EXPECT_EQ(s.joints[0].parent, "world");
    EXPECT_EQ(s.joints[0].damping[0], 0.5);
    const double x = 0.4, y = -0.3, z = 2.5, slide = y / std::sqrt(2);
    expect_same(by_contract(joint_named(s, "j1"), x), moved({1, 2, 3}) * rpy(0.3, -0.7, 1.1) * turned({0, 1, 0}, x),
                1e-15);
    expect_same(by_contract(joint_named(s, "j2"), y),
                moved({-1, 0.5, 0.25}) * rpy(-0.2, 0.4, 2) * moved({slide, slide, 0}), 1e-15);
    expect_same(by_contract(joint_named(s, "j3"), z), rpy(3, 0, 0) * turned({1, 0, 0}, z), 1e-15);
    EXPECT_EQ(s.bodies[1].body.mass, 2);
    EXPECT_EQ(s.bodies[1].body.center_of_mass, Vector3<double>(0.1, 0.2, 0.3));
    EXPECT_EQ(s.omitted, (std::vector<std::string>{"transmissions: t1"}));
    EXPECT_EQ(s.assumed,
              (std::vector<std::string>{"gravity: none; neither the file nor the scene defines it",
                                        "limits and friction of joints by rigid laws, with restitution 0: j1",
                                        "links without mass, merged: world_link"}));
}

// A massless link joined by fixed joints does not change the motion, wherever it is.
TEST(RobotImport, LinksWithoutMassAreMergedWithTheirNeighbours) {
    const std::string tilt = "<origin xyz='0.1 0.2 0.3' rpy='0.5 0.6 0.7'/>", on = "<origin xyz='1 0 0' rpy='0 0 1'/>";
    const std::string axis = "<axis xyz='0 0.6 0.8'/>";
    // before the moving joint
    const Scene before =
        robot_scene(urdf(link("a") + bare("m") + link("b") + bare("tip") + joint("f", "fixed", "a", "m", tilt) +
                         joint("j", "revolute", "m", "b", on + axis) + joint("t", "fixed", "b", "tip", tilt)));
    const Placed step = moved({0.1, 0.2, 0.3}) * rpy(0.5, 0.6, 0.7), other = moved({1, 0, 0}) * rpy(0, 0, 1);
    ASSERT_EQ(before.bodies.size(), 2u);
    EXPECT_EQ(joint_named(before, "j").parent, "a");
    expect_same(by_contract(joint_named(before, "j"), 0.9), step * other * turned({0, 0.6, 0.8}, 0.9), 1e-15);
    EXPECT_TRUE(before.omitted.empty());
    EXPECT_EQ(before.assumed,
              (std::vector<std::string>{"gravity: none; neither the file nor the scene defines it",
                                        "links without mass, dropped: tip", "links without mass, merged: m"}));
    // after the moving joint, with a second link on the massless one
    const Scene behind =
        robot_scene(urdf(link("a") + bare("m") + link("b") + link("c") + joint("j", "revolute", "a", "m", on + axis) +
                         joint("f", "fixed", "m", "b", tilt) + joint("k", "prismatic", "m", "c", on + axis)));
    ASSERT_EQ(behind.bodies.size(), 3u);
    EXPECT_EQ(joint_named(behind, "j").child, "b");
    EXPECT_EQ(joint_named(behind, "k").parent, "b");
    const Placed turn = other * turned({0, 0.6, 0.8}, 0.9);
    expect_same(by_contract(joint_named(behind, "j"), 0.9), turn * step, 1e-15);
    expect_same(by_contract(joint_named(behind, "j"), 0.9) * by_contract(joint_named(behind, "k"), 0.5),
                turn * other * moved({0, 0.3, 0.4}), 1e-15);
}

// Two hinges whose axes meet, with a massless link between them, become a universal joint.
TEST(RobotImport, TwoHingesThroughOnePointAreAUniversalJoint) {
    const Scene s =
        robot_scene(urdf(bare("root") + bare("m") + link("b") +
                         joint("j", "revolute", "root", "m",
                               "<origin xyz='1 2 3' rpy='0.1 0.2 0.3'/><axis xyz='0 0 1'/><dynamics damping='3'/>") +
                         // its axis along x' meets the first axis 2 m further up
                         joint("k", "revolute", "m", "b",
                               "<origin xyz='-0.5 0 2' rpy='0.4 0 0'/><axis xyz='1 0 0'/><dynamics damping='4'/>")));
    ASSERT_EQ(s.joints.size(), 1u);
    const Joint& j = s.joints[0];
    EXPECT_EQ(j.type, JointType::universal);
    EXPECT_EQ(j.name, "j+k");
    EXPECT_EQ(j.damping, (std::array<double, 2>{3, 4}));
    for (const auto& [x, y] : {std::pair(0.0, 0.0), std::pair(0.7, 0.0), std::pair(0.7, -1.3)})
        expect_same(by_contract(j, x, y),
                    moved({1, 2, 3}) * rpy(0.1, 0.2, 0.3) * turned({0, 0, 1}, x) * moved({-0.5, 0, 2}) *
                        turned({1, 0, 0}, 0.4) * turned({1, 0, 0}, y),
                    1e-14);
    // axes that do not meet or are parallel: the massless link remains a body
    for (const auto& [origin, axis] : {std::pair("0 0.001 0", "1 0 0"), std::pair("0 0 0", "0 0 -1")}) {
        const std::string more = std::string("<origin xyz='") + origin + "'/><axis xyz='" + axis + "'/>";
        const Robot robot = parse_robot(
            urdf(bare("root") + bare("m") + link("b") + joint("j", "revolute", "root", "m", "<axis xyz='0 0 1'/>") +
                 joint("k", "revolute", "m", "b", more)),
            "robot.xml");
        Scene two;
        add_robot(robot, {}, "robot.xml", two);
        ASSERT_EQ(two.joints.size(), 2u);
        EXPECT_EQ(two.bodies[0].name, "m");
        EXPECT_EQ(two.bodies[0].body.mass, 0);
    }
}

TEST(RobotImport, TheBaseIsHeldOrFree) {
    const std::string robot = urdf(link("base") + link("arm") + joint("j", "revolute", "base", "arm"));
    const Scene held = robot_scene(robot), free = robot_scene(robot, RobotBase::free);
    EXPECT_EQ(joint_named(held, "base_base").type, JointType::fixed);
    EXPECT_EQ(held.joints.size(), 2u);
    ASSERT_EQ(free.joints.size(), 1u);
    EXPECT_EQ(free.bodies[0].initial.position_W, Vector3<double>(0.1, 0.2, 0.3)) << "its origin is the world's";
    // a floating joint makes its child free
    const Scene floating = robot_scene(
        urdf(bare("world_link") + link("base") +
             joint("j", "floating", "world_link", "base", "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/>")));
    EXPECT_TRUE(floating.joints.empty());
    const Vector3<double> p = floating.bodies[0].initial.position_W;
    EXPECT_NEAR(p[0], 1 - 0.2, 1e-15);
    EXPECT_NEAR(p[1], 0.1, 1e-15);
}

// The mass and tensor of a link, for the tests below.
std::string urdf_inertia(double xx, double yy, double zz, double xy = 0, double xz = 0, double yz = 0) {
    return "<inertia ixx='" + std::to_string(xx) + "' iyy='" + std::to_string(yy) + "' izz='" + std::to_string(zz) +
           "' ixy='" + std::to_string(xy) + "' ixz='" + std::to_string(xz) + "' iyz='" + std::to_string(yz) + "'/>";
}
std::string urdf_link(const std::string& name, double mass, const std::string& inertia) {
    return "<link name='" + name + "'><inertial><mass value='" + std::to_string(mass) + "'/>" + inertia +
           "</inertial></link>";
}

// A dummy link with 1e-6 in every entry of its tensor, which no mass distribution has: its moments are 3e-6, 0, 0.
TEST(RobotImport, ImpossibleTensorsOfFixedLinksDoNotMatter) {
    const std::string dummy = urdf_link("dummy", 1e-6, urdf_inertia(1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6));
    // fixed to the world
    const Scene on_world = robot_scene(
        urdf(dummy + link("b") + joint("j", "revolute", "dummy", "b", "<origin xyz='1 2 3'/><axis xyz='0 1 0'/>")));
    ASSERT_EQ(on_world.bodies.size(), 1u);
    EXPECT_EQ(on_world.joints[0].parent, "world");
    EXPECT_EQ(on_world.joints[0].parent_point, Vector3<double>(1, 2, 3));
    // merged with a heavier link, above or below it: the sum of both about the common centre of mass
    const std::string tilt = "<origin xyz='0.1 0.2 0.3' rpy='0.5 0.6 0.7'/>";
    const Scene tip = robot_scene(urdf(bare("w") + link("b") + dummy + joint("j", "revolute", "w", "b") +
                                       joint("t", "fixed", "b", "dummy", tilt)));
    ASSERT_EQ(tip.bodies.size(), 1u);
    const Placed place = moved({0.1, 0.2, 0.3}) * rpy(0.5, 0.6, 0.7);
    Matrix3<double> ones;
    for (int i = 0; i < 3; ++i) ones[i] = {1e-6, 1e-6, 1e-6};
    const MassProperties<double> heavy{2, {0.1, 0.2, 0.3}, diagonal(Vector3<double>(1, 2, 2.5))};
    const MassProperties<double> light{1e-6, place.p, place.A * ones * transposed(place.A)};
    const MassProperties<double> whole = composite<double>({heavy, light});
    EXPECT_DOUBLE_EQ(tip.bodies[0].body.mass, 2 + 1e-6);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(tip.bodies[0].body.inertia_B[i][k], whole.inertia[i][k], 1e-14);
    const Scene head = robot_scene(urdf(bare("w") + dummy + link("b") + joint("j", "revolute", "w", "dummy") +
                                        joint("t", "fixed", "dummy", "b", tilt)));
    ASSERT_EQ(head.bodies.size(), 1u);
    EXPECT_EQ(head.bodies[0].name, "b");
    EXPECT_DOUBLE_EQ(head.bodies[0].body.mass, 2 + 1e-6);
}

// Moments (a, b, c) with the excess e = c - a - b are repaired to the nearest valid ones, (a + e/3, b + e/3, c - e/3).
TEST(RobotImport, TensorsAreRepairedBySmallestChange) {
    const auto plate = [](double izz, bool balance) {
        Scene scene;
        scene.name = "robot", scene.duration = 1;
        RobotOptions options;
        options.balance_inertia = balance;
        const std::string text = urdf(bare("w") + urdf_link("plate", 0.8, urdf_inertia(0.0018, 0.0042, izz)) +
                                      joint("j", "continuous", "w", "plate"));
        add_robot(parse_robot(text, "robot.urdf", options), options, "robot.urdf", scene);
        return scene;
    };
    const Scene rounded = plate(0.006003, false);
    const Matrix3<double>& I = rounded.bodies[0].body.inertia_B;
    EXPECT_NEAR(I[0][0], 0.001801, 1e-17);
    EXPECT_NEAR(I[1][1], 0.004201, 1e-17);
    EXPECT_NEAR(I[2][2], 0.006002, 1e-17);
    ASSERT_EQ(rounded.assumed.size(), 3u);
    EXPECT_EQ(rounded.assumed[1],
              "inertia tensors corrected by the smallest change of the principal moments: plate (excess 0.0005 of the "
              "largest moment 0.006003 kg m^2, largest change 1e-06 kg m^2)");
    validate(rounded, "robot.urdf");
    try {
        plate(0.007, false);
        FAIL() << "an excess of a seventh was accepted";
    } catch (const InputError& error) {
        EXPECT_STREQ(
            error.what(),
            "robot.urdf: line 1: link \"plate\" violates the triangle inequality: its largest principal moment "
            "0.007 kg m^2 exceeds the sum of the other two by 0.143 of its value; correct the tensor, or permit "
            "the smallest correction by \"balance_inertia\": true");
    }
    const Scene balanced = plate(0.007, true);
    EXPECT_NEAR(balanced.bodies[0].body.inertia_B[2][2], 0.007 - 0.001 / 3, 1e-17);
    // a moment that would become negative is set to zero, and the other two are made equal
    const InertiaRepair edge = repair_inertia(diagonal(Vector3<Wide>(-1e-3, 1, 1.0001)));
    EXPECT_NEAR(double(edge.inertia[0][0]), 0, 1e-30);
    EXPECT_NEAR(double(edge.inertia[1][1]), 1.00005, 1e-15);
    EXPECT_NEAR(double(edge.inertia[2][2]), 1.00005, 1e-15);
}

// A massless link at the end of a moving joint is dropped. A massless link with a tensor counts where it is fixed.
TEST(RobotImport, LinksWithoutMassAtTheEnds) {
    const Scene leaf = robot_scene(
        urdf(bare("w") + link("a") + bare("b") + joint("j", "revolute", "w", "a") + joint("k", "revolute", "a", "b")));
    ASSERT_EQ(leaf.bodies.size(), 1u);
    ASSERT_EQ(leaf.joints.size(), 1u);
    EXPECT_EQ(leaf.omitted,
              std::vector<std::string>{"links without mass at moving joints, dropped with their joints: b"});
    const std::string rotor = urdf_link("rotor", 0, urdf_inertia(0.25, 0.5, 0.75));
    const Scene fixed = robot_scene(urdf(bare("w") + link("a") + rotor + joint("j", "revolute", "w", "a") +
                                         joint("t", "fixed", "a", "rotor", "<origin xyz='1 2 3'/>")));
    ASSERT_EQ(fixed.bodies.size(), 1u);
    EXPECT_EQ(fixed.bodies[0].body.mass, 2);
    EXPECT_EQ(fixed.bodies[0].body.center_of_mass, Vector3<double>(0.1, 0.2, 0.3));
    EXPECT_EQ(fixed.bodies[0].body.inertia_B, diagonal(Vector3<double>(1.25, 2.5, 3.25)));
    EXPECT_NE(robot_fault(urdf("<link name='$(arg n)'/>")).find("expand the file with xacro first"), std::string::npos);
}

TEST(RobotImport, WorldIsAnImpliedParentAndFloatingLinksHangOnFixedOnes) {
    const Scene s = robot_scene(urdf(link("a") + joint("j", "revolute", "world", "a", "<origin xyz='1 2 3'/>")));
    EXPECT_EQ(s.joints[0].parent, "world");
    EXPECT_EQ(s.joints[0].parent_point, Vector3<double>(1, 2, 3));
    EXPECT_EQ(s.assumed[1], "joints with parent \"world\" but no link of that name, connected to the world: j");
    const Scene floating = robot_scene(
        urdf(link("a") + link("b") +
             joint("j", "floating", "a", "b", "<origin xyz='1 2 3'/><dynamics damping='1' friction='0'/>")));
    ASSERT_EQ(floating.bodies.size(), 2u);
    EXPECT_EQ(floating.bodies[1].initial.position_W, Vector3<double>(1.1, 2.2, 3.3));
    EXPECT_EQ(floating.omitted, std::vector<std::string>{"damping and friction of floating and planar joints: j"});
}

TEST(RobotImport, ConstructsOfUrdfThatAreNotModelledAreNamed) {
    const Scene s = robot_scene(
        urdf(bare("w") + link("a") + joint("j", "continuous", "w", "a", "<limit effort='1' velocity='2'/>") +
             "<gazebo reference='a'><material>Gazebo/Red</material><mu1>0.2</mu1><selfCollide>1</selfCollide></gazebo>"
             "<gazebo><plugin filename='x.so'/></gazebo><loop_joint name='l'/><link name='b' colour='red'/>" +
             joint("f", "fixed", "a", "b", "<limit lower='0' upper='0'/><dynamics friction='1'/>")));
    EXPECT_EQ(s.omitted,
              (std::vector<std::string>{"<gazebo>: mu1, selfCollide, plugin", "unknown attribute colour of <link>: b",
                                        "unknown element <loop_joint>: l"}));
    const auto message = [](const std::string& text) { return robot_fault(text); };
    EXPECT_EQ(
        message(
            "<robot name='p' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:property name='m' value='1'/></robot>"),
        "robot.xml: line 1, <xacro:property>: is an xacro macro; expand the file with xacro first: xacro FILE > "
        "robot.urdf");
    EXPECT_NE(message(urdf("<link name='${n}'/>")).find("has the xacro expression \"${n}\" in name"),
              std::string::npos);
    EXPECT_NE(message(urdf(link("a") + link("b") + "<drake:joint name='j' type='ball'/>"))
                  .find("is a joint type that is not part of URDF"),
              std::string::npos);
}

// The same robot in three formats.
const char* arm_in_urdf = R"(<robot name="r">
  <link name="foot"><inertial><origin xyz="0 0 0.1" rpy="0 0 0.5"/><mass value="3"/>
    <inertia ixx="1" iyy="2" izz="2.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0.5" iyy="0.75" izz="1" ixy="0.1" ixz="0" iyz="0"/></inertial></link>
  <link name="slide"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hip" type="revolute"><parent link="foot"/><child link="arm"/><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>
    <axis xyz="0 0.6 0.8"/><dynamics damping="0.5"/></joint>
  <joint name="rail" type="prismatic"><parent link="arm"/><child link="slide"/><origin xyz="1 0 0" rpy="0 1.5707963267948966 0"/>
    <axis xyz="0 0 1"/></joint>
</robot>)";
const char* arm_in_mjcf = R"(<mujoco><compiler angle="radian" eulerseq="XYZ"/>
  <default><joint damping="0.5"/><default class="still"><joint damping="0" type="slide"/></default></default>
  <worldbody><geom type="plane" size="1 1 1"/>
  <body name="foot"><inertial pos="0 0 0.1" euler="0 0 0.5" mass="3" diaginertia="1 2 2.5"/>
    <body name="arm" pos="0.1 0.2 0.3" euler="0.4 0.5 0.6">
      <joint name="hip" axis="0 0.6 0.8"/>
      <inertial pos="0.5 0 0" mass="2" fullinertia="0.5 0.75 1 0.1 0 0"/>
      <body name="slide" pos="1 0 0" axisangle="0 3 0 1.5707963267948966" childclass="still">
        <joint name="rail"/>
        <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      </body>
    </body>
  </body></worldbody></mujoco>)";
const char* arm_in_sdf = R"(<sdf version="1.10"><model name="r">
  <link name="foot"><inertial><pose>0 0 0.1 0 0 0.5</pose><mass>3</mass>
    <inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial></link>
  <frame name="seat" attached_to="foot"><pose>0.1 0.2 0.3 0 0 0</pose></frame>
  <link name="arm"><pose relative_to="seat">0 0 0 0.4 0.5 0.6</pose><inertial><pose>0.5 0 0 0 0 0</pose><mass>2</mass>
    <inertia><ixx>0.5</ixx><iyy>0.75</iyy><izz>1</izz><ixy>0.1</ixy></inertia></inertial></link>
  <link name="slide"><pose relative_to="arm" degrees="true">1 0 0 0 90 0</pose><inertial><mass>1</mass>
    <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>
  <joint name="ground" type="fixed"><parent>world</parent><child>foot</child></joint>
  <joint name="hip" type="revolute"><parent>foot</parent><child>arm</child>
    <axis><xyz>0 0.6 0.8</xyz><dynamics><damping>0.5</damping></dynamics></axis></joint>
  <joint name="rail" type="prismatic"><parent>arm</parent><child>slide</child>
    <axis><xyz expressed_in="arm">1 0 0</xyz></axis></joint>
</model></sdf>)";

TEST(RobotImport, ThreeFormatsSayTheSame) {
    const Scene a = robot_scene(arm_in_urdf);
    ASSERT_EQ(a.bodies.size(), 3u);
    for (const char* text : {arm_in_mjcf, arm_in_sdf}) {
        const Scene b = robot_scene(text);
        SCOPED_TRACE(write_scene(b));
        ASSERT_EQ(b.bodies.size(), 3u);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(a.bodies[i].name, b.bodies[i].name);
            EXPECT_EQ(a.bodies[i].body.mass, b.bodies[i].body.mass);
            EXPECT_EQ(a.bodies[i].body.center_of_mass, b.bodies[i].body.center_of_mass);
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(a.bodies[i].body.inertia_B[r][c], b.bodies[i].body.inertia_B[r][c], 1e-15);
        }
        for (const char* name : {"hip", "rail"}) {
            const Joint &one = joint_named(a, name), &two = joint_named(b, name);
            EXPECT_EQ(one.parent, two.parent);
            EXPECT_EQ(one.child, two.child);
            EXPECT_EQ(one.damping, two.damping);
            for (const double x : {0.0, 1.25}) expect_same(by_contract(one, x), by_contract(two, x), 1e-15);
        }
    }
}

std::string mjcf(const std::string& inside, const std::string& more = "") {
    return "<mujoco>" + more + "<worldbody>" + inside + "</worldbody></mujoco>";
}
const std::string mjcf_inertial = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";

// Inertias computed from MJCF geoms agree with the closed forms of the solids.
TEST(RobotImport, GeomsOfMjcfHaveTheirMass) {
    const auto body = [](const std::string& geoms) {
        return robot_scene(mjcf("<body name='b'><freejoint/>" + geoms + "</body>")).bodies[0].body;
    };
    const double pi = 3.141592653589793;
    const Body ball = body("<geom size='0.5'/>");
    EXPECT_NEAR(ball.mass, 1000 * 4 / 3. * pi * 0.125, 1e-12);
    EXPECT_NEAR(ball.inertia_B[1][1], 0.4 * ball.mass * 0.25, 1e-13);
    const Body box = body("<geom type='box' size='0.1 0.2 0.3' pos='1 0 0' mass='6'/>");
    EXPECT_NEAR(box.inertia_B[0][0], 2 * (0.04 + 0.09), 1e-15);
    EXPECT_EQ(box.center_of_mass, Vector3<double>(1, 0, 0));
    // a cylinder along (3, 0, 4), 10 long
    const Body rod = body("<geom type='cylinder' size='0.5' fromto='0 0 0 6 0 8' mass='12'/>");
    const double along = 12 * 0.25 / 2, across = 12 * 0.25 / 4 + 100;
    EXPECT_NEAR(rod.center_of_mass[2], 4, 1e-15);
    EXPECT_NEAR(rod.inertia_B[0][0], across + (along - across) * 0.36, 1e-12);
    EXPECT_NEAR(rod.inertia_B[0][2], (along - across) * 0.48, 1e-12);
    // a capsule; an ellipsoid; two spheres and a massless third one
    const Body capsule = body("<geom type='capsule' size='0.1 0.2' density='500'/>");
    EXPECT_NEAR(capsule.mass, 500 * pi * (0.01 * 0.4 + 4 / 3. * 0.001), 1e-13);
    const Body ellipsoid = body("<geom type='ellipsoid' size='1 2 3' mass='5'/>");
    EXPECT_NEAR(ellipsoid.inertia_B[2][2], 5, 1e-14);
    const Body two = body(
        "<geom size='0.1' pos='-1 0 0' mass='1'/><geom size='0.1' pos='1 0 0' mass='3'/><geom size='9' mass='0'/>");
    EXPECT_EQ(two.mass, 4);
    EXPECT_NEAR(two.center_of_mass[0], 0.5, 1e-15);
    EXPECT_NEAR(two.inertia_B[1][1], 4 * 0.4 * 0.01 + 1 * 2.25 + 3 * 0.25, 1e-14);
    EXPECT_NE(robot_fault(mjcf("<body><freejoint/><geom type='mesh' mesh='m'/></body>"))
                  .find("has the mesh \"m\", which no <asset> defines"),
              std::string::npos);
}

// A gripper: the second finger mimics the first.
TEST(RobotImport, MimicJointsBecomeCouplings) {
    const std::string fingers = urdf(link("palm") + link("left") + link("right") +
                                     joint("a", "prismatic", "palm", "left", "<axis xyz='1 0 0'/>") +
                                     joint("b", "prismatic", "palm", "right",
                                           "<axis xyz='1 0 0'/><mimic joint='a' multiplier='-1' offset='0.25'/>"));
    const Scene s = robot_scene(fingers);
    ASSERT_EQ(s.couplings.size(), 1u);
    EXPECT_EQ(s.couplings[0].first, "a");
    EXPECT_EQ(s.couplings[0].second, "b");
    EXPECT_EQ(s.couplings[0].ratio, -1);
    EXPECT_EQ(s.couplings[0].offset, 0.25);
    EXPECT_TRUE(joint_named(s, "b").dependent);
    EXPECT_EQ(std::count_if(s.omitted.begin(), s.omitted.end(),
                            [](const std::string& one) { return one.find("mimic") != one.npos; }),
              0);
    const Scene lost =
        robot_scene(urdf(link("palm") + link("left") +
                         joint("a", "revolute", "palm", "left", "<axis xyz='1 0 0'/><mimic joint='other'/>")));
    EXPECT_TRUE(lost.couplings.empty());
    EXPECT_EQ(std::count_if(lost.omitted.begin(), lost.omitted.end(),
                            [](const std::string& one) { return one.find("mimic") != one.npos; }),
              1);
}

// The same limits and friction in two formats.
TEST(RobotImport, LimitsAndFrictionAreReadUnlessSwitchedOff) {
    const auto import = [](const std::string& text, bool on) {
        Scene scene;
        scene.name = "robot", scene.duration = 1;
        RobotOptions options;
        options.base = RobotBase::fixed, options.limits_and_friction = on;
        add_robot(parse_robot(text, "robot.xml", options), options, "robot.xml", scene);
        validate(scene, "robot.xml");
        return scene;
    };
    const std::string urdf_text =
        urdf(link("base") + link("arm") +
             joint("h", "revolute", "base", "arm",
                   "<axis xyz='0 1 0'/><limit lower='-0.5' upper='1.5' effort='1' velocity='1'/>"
                   "<dynamics friction='0.25'/>"));
    const std::string mjcf_text =
        mjcf("<body name='arm'><joint name='h' axis='0 1 0' range='-0.5 1.5' frictionloss='0.25'/>" + mjcf_inertial +
                 "</body>",
             "<compiler angle='radian'/>");
    for (const std::string& text : {urdf_text, mjcf_text}) {
        const Scene with = import(text, true), without = import(text, false);
        const Joint& h = joint_named(with, "h");
        EXPECT_EQ(h.friction, 0.25);
        EXPECT_EQ(h.limits.lower, -0.5);
        EXPECT_EQ(h.limits.upper, 1.5);
        EXPECT_TRUE(with.omitted.empty()) << with.omitted.front();
        EXPECT_EQ(joint_named(without, "h").friction, 0);
        EXPECT_FALSE(joint_named(without, "h").limits.any());
        EXPECT_EQ(without.omitted.size(), 2u);
    }
    const std::string degrees =
        mjcf("<body name='arm'><joint name='h' axis='0 1 0' range='-90 90' ref='45'/>" + mjcf_inertial + "</body>");
    const Scene turned = import(degrees, true);
    EXPECT_NEAR(joint_named(turned, "h").limits.lower, -2.356194490192345, 1e-15);
    EXPECT_NEAR(joint_named(turned, "h").limits.upper, 0.7853981633974483, 1e-15);
}

TEST(RobotImport, JointsOfMjcf) {
    const Scene s = robot_scene(mjcf(
        "<body name='a' pos='0 0 1'><joint name='h' type='hinge' pos='0 0 0.5' axis='0 1 0' stiffness='3' "
        "springref='90' ref='45' "
        "armature='0.1' frictionloss='1' range='-1 1'/>" +
            mjcf_inertial + "<body name='b' quat='0 2 0 0'><joint name='ball' type='ball' damping='2' stiffness='1'/>" +
            mjcf_inertial + "<body name='c'>" + mjcf_inertial +
            "<body name='d' zaxis='1 0 0'><joint name='x' axis='1 0 0' pos='0 0 1' damping='1'/>"
            "<joint name='y' axis='0 1 0' pos='0 0 1'/>" +
            mjcf_inertial + "</body></body></body></body>",
        "<actuator><motor name='m' joint='h'/></actuator><option gravity='0 0 -1'/>"));
    ASSERT_EQ(s.bodies.size(), 4u);
    const Joint& h = joint_named(s, "h");
    EXPECT_NEAR(h.rest[0], 0.7853981633974483, 1e-16);
    EXPECT_EQ(h.stiffness[0], 3);
    EXPECT_EQ(h.armature[0], 0.1);
    // the anchor stays in place
    expect_same(by_contract(h, 0.3), moved({0, 0, 1.5}) * turned({0, 1, 0}, 0.3) * moved({0, 0, -0.5}), 1e-15);
    EXPECT_EQ(joint_named(s, "ball").type, JointType::spherical);
    EXPECT_EQ(joint_named(s, "ball").damping[0], 2);
    EXPECT_EQ(joint_named(s, "ball").stiffness[0], 0);
    EXPECT_EQ(joint_named(s, "c_weld").type, JointType::fixed);
    const Joint& xy = joint_named(s, "x+y");
    EXPECT_EQ(xy.type, JointType::universal);
    expect_same(by_contract(xy, 0.4, 0.5),
                turned({0, 1, 0}, 1.5707963267948966) * moved({0, 0, 1}) * turned({1, 0, 0}, 0.4) *
                    turned({0, 1, 0}, 0.5) * moved({0, 0, -1}),
                1e-15);
    EXPECT_EQ(s.omitted, (std::vector<std::string>{"springs of ball joints: ball"}));
    EXPECT_EQ(s.assumed,
              (std::vector<std::string>{
                  "gravity (0, 0, -1) m/s^2: <option gravity>", "actuators that exert no force with their control: m",
                  "joints that start at a limit, because their limits exclude the coordinate of the file: h "
                  "(-0.767944870877505)",
                  "limits and friction of joints by rigid laws, with restitution 0: h",
                  "pairs of hinges converted to one universal joint: x+y"}));
    // orientations: a quarter turn about z by each of the ways
    for (const char* way : {"quat='1 0 0 1'", "euler='0 0 90'", "axisangle='0 0 1 90'", "xyaxes='0 1 0 -1 0.25 0'"}) {
        const Scene q =
            robot_scene(mjcf("<body name='a' " + std::string(way) + "><joint/>" + mjcf_inertial + "</body>"));
        expect_same(by_contract(q.joints[0], 0), turned({0, 0, 1}, 1.5707963267948966), 1e-15);
    }
}

// SDFormat: frames relative to other frames, and a universal joint.
TEST(RobotImport, FramesOfSdf) {
    const std::string i = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
    const std::string text =
        "<sdf version='1.9'><world name='w'><model name='ground'><static>true</static><link name='l'/></model>"
        "<model name='m'><pose>10 0 0 0 0 1</pose><link name='a'><pose>1 0 0 0 0 0</pose>" +
        i +
        "</link>"
        "<link name='b'><pose relative_to='j'>0 0 -1 0 0 0</pose>" +
        i +
        "</link>"
        "<joint name='j' type='universal'><pose relative_to='a'>0 2 0 0.5 0 0</pose><parent>a</parent><child>b</child>"
        "<axis><xyz>1 0 "
        "0</xyz><dynamics><spring_stiffness>2</spring_stiffness><spring_reference>0.5</spring_reference></dynamics></"
        "axis>"
        "<axis2><xyz>0 1 0</xyz><limit><lower>0</lower></limit></axis2></joint></model></world></sdf>";
    const auto import = [&](bool laws) {
        Scene scene;
        scene.name = "robot", scene.duration = 1;
        RobotOptions options;
        options.limits_and_friction = laws;
        add_robot(parse_robot(text, "robot.sdf", options), options, "robot.sdf", scene);
        return scene;
    };
    const Scene s = import(true);
    // the limit of the second axis splits the joint
    ASSERT_EQ(s.joints.size(), 2u);
    expect_same(by_contract(joint_named(s, "j_1"), 0.2) * by_contract(joint_named(s, "j_2"), 0.3),
                moved({0, 2, 0}) * rpy(0.5, 0, 0) * turned({1, 0, 0}, 0.2) * turned({0, 1, 0}, 0.3) * moved({0, 0, -1}),
                1e-15);
    EXPECT_EQ(joint_named(s, "j_2").limits.lower, 0);
    const Scene whole = import(false);
    ASSERT_EQ(whole.joints.size(), 1u);
    const Joint& j = whole.joints[0];
    expect_same(by_contract(j, 0.2, 0.3),
                moved({0, 2, 0}) * rpy(0.5, 0, 0) * turned({1, 0, 0}, 0.2) * turned({0, 1, 0}, 0.3) * moved({0, 0, -1}),
                1e-15);
    EXPECT_EQ(j.stiffness, (std::array<double, 2>{2, 0}));
    EXPECT_EQ(j.rest, (std::array<double, 2>{0.5, 0}));
    // a model not joined to the world is free and starts at its pose
    EXPECT_NEAR(s.bodies[0].initial.position_W[0], 10 + std::cos(1.0), 1e-15);
    EXPECT_NEAR(s.bodies[0].initial.position_W[1], std::sin(1.0), 1e-15);
    EXPECT_TRUE(s.omitted.empty());
    EXPECT_EQ(whole.omitted, (std::vector<std::string>{"joint limits: j"}));
}

TEST(RobotImport, RefusesWhatItCannotMake) {
    const std::string two = link("a") + link("b");
    const std::string sdf_link =
        "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>";
    const auto sdf = [&](const std::string& more) {
        return "<sdf><model name='m'><link name='a'>" + sdf_link + "<link name='b'>" + sdf_link + more +
               "</model></sdf>";
    };
    const std::pair<std::string, const char*> faults[] = {
        {"<robot>", "is not XML"},
        {"<car/>", "is not the root element of a known format"},
        {urdf(""), "has no link with a mass"},
        {urdf(bare("a")), "has no link with a mass"},
        {urdf(two + joint("j", "screw", "a", "b")), "has the type \"screw\""},
        {urdf(two + joint("j", "fixed", "a", "bb")), "refers to \"bb\", which is not a link"},
        {urdf(two + joint("j", "fixed", "a", "b") + joint("k", "fixed", "a", "b")),
         "makes \"b\" the child of joint \"k\", but it is already the child of \"j\""},
        {urdf(two + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")), "has joints that form a cycle"},
        {urdf(link("a") + link("a")), "is a second link \"a\""},
        {urdf(two + joint("j", "fixed", "a", "b") + joint("j", "fixed", "b", "a")), "is a second joint \"j\""},
        {urdf(two + joint("j", "revolute", "a", "b", "<axis xyz='0 0 0'/>")), "<axis>: is zero"},
        {urdf(two + link("c") + joint("j", "revolute", "a", "b") + joint("k", "floating", "b", "c")),
         "joint \"k\" is a free joint below a moving link"},
        {urdf(link("a")), "cannot move: \"a\" and all other links are fixed to the world"},
        {mjcf("<body><joint type='screw'/>" + mjcf_inertial + "</body>"), "has the type \"screw\""},
        {mjcf("<body><joint/><freejoint/>" + mjcf_inertial + "</body>"),
         "is a free joint of the body \"body1\", which is not a child of the world or has other joints"},
        {mjcf("<body class='x'><joint class='x'/>" + mjcf_inertial + "</body>"), "has the class \"x\""},
        {mjcf("<body><composite type='cable' prefix='c'/>" + mjcf_inertial + "</body>"),
         "generates bodies by <composite> \"c\", which is not supported"},
        {mjcf("<body quat='1 0 0 0' euler='0 0 0'>" + mjcf_inertial + "</body>"), "has two orientations"},
        {mjcf("", "<include file='other.xml'/>"), "is referenced by a robot description given as text"},
        {mjcf("<body name='a'>" + mjcf_inertial + "</body><body name='a'>" + mjcf_inertial + "</body>"),
         "is a second body \"a\""},
        {mjcf("<body><joint/><geom type='capsule' size='1'/></body>"), "has 1 numbers in size"},
        {"<sdf/>", "has no <model> with a link"},
        {sdf("<joint name='j' type='helix'><parent>a</parent><child>b</child></joint>"), "has the type \"helix\""},
        {sdf("<joint name='j' type='revolute'><parent>a</parent><child>b</child></joint>"), "has no <axis>"},
        {sdf("<joint name='j' type='fixed'><parent>a</parent><child>c</child></joint>"), "refers to \"c\""},
        {sdf("<frame name='f'><pose relative_to='g'/></frame><frame name='g' attached_to='f'/>"
             "<joint name='j' type='fixed'><pose relative_to='f'>0 0 0 0 0 "
             "0</pose><parent>a</parent><child>b</child></joint>"),
         "is placed relative to itself"},
    };
    for (const auto& [text, fault] : faults) {
        const std::string message = robot_fault(text);
        EXPECT_NE(message.find(fault), std::string::npos) << text << "\n" << message;
        EXPECT_EQ(message.find("robot.xml: "), 0u) << message;
    }
}

// A scene that imports a robot, and the built-in arm.
TEST(RobotImport, TheBuiltInArmIsReadFromTheProgramAndFromItsFile) {
    const Scene built_in = find_scene("mechanisms/arm6");
    allow_outside_files(true);  // its robot file is in ../robots
    const Scene from_file = read_scene(source_dir() + "/experiments/scenes/mechanisms/arm6.json");
    allow_outside_files(false);
    EXPECT_EQ(write_scene(built_in), write_scene(from_file));
    ASSERT_EQ(built_in.bodies.size(), 6u);
    ASSERT_EQ(built_in.joints.size(), 6u);
    EXPECT_EQ(joint_named(built_in, "waist").coordinate[0], 0.25);
    EXPECT_EQ(joint_named(built_in, "flange_roll").rate[0], 4);
    EXPECT_EQ(built_in.omitted, (std::vector<std::string>{"joint limits: waist, shoulder, elbow, wrist_bend"}));
    EXPECT_EQ(built_in.assumed,
              (std::vector<std::string>{"links without mass, dropped: tool", "links without mass, merged: base"}));
    // the written scene needs no robot file
    EXPECT_EQ(write_scene(parse_scene(write_scene(built_in), "written")), write_scene(built_in));
    // with all angles zero the flange is upright above the foot
    Placed tip;
    for (const Joint& joint : built_in.joints) tip = tip * by_contract(joint, 0);
    const Vector3<double> there = tip * Vector3<double>(0, 0, 0);
    EXPECT_NEAR(there[0], 0.06, 1e-15);
    EXPECT_NEAR(there[1], 0, 1e-15);
    EXPECT_NEAR(there[2], 0.36 + 0.08 + 0.45 + 0.38 + 0.09, 1e-15);
    EXPECT_NEAR(tip.A[2][2], 1, 1e-15);
}

// When a robot violates a rule of scenes, the message contains the robot's names instead of indices.
TEST(RobotImport, FaultsOfTheSceneNameTheLink) {
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "polhode_robot_names";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "r.urdf") << urdf(link("base, with comma") + link("b") +
                                             joint("j", "revolute", "base, with comma", "b"));
    try {
        parse_scene(R"({"name": "a", "duration": 1, "import": {"file": "r.urdf"}})", "s.json", folder.string());
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find("s.json: /import: r.urdf: line 1, body \"base, with comma\", name: "),
                  0u)
            << error.what();
    }
    std::filesystem::remove_all(folder);
}

TEST(RobotImport, TheMemberImport) {
    const auto fault = [](const std::string& members) -> std::string {
        try {
            parse_scene(R"({"name": "a", "duration": 1, )" + members + "}", "file.json",
                        std::string(builtin_directory) + "mechanisms");
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    const std::string file = R"("import": {"file": "../robots/arm6.urdf")";
    EXPECT_EQ(fault(file + "}"), "");
    EXPECT_EQ(fault(file + R"(, "initial": {"elbo": {}}})"),
              "file.json: /import/initial/elbo: is neither a joint nor a free body of the robot; did you mean elbow?");
    EXPECT_EQ(fault(file + R"(, "initial": {"elbow": {"speed": 1}}})"),
              "file.json: /import/initial/elbow/speed: is an unknown key; known keys: angle, rate, dependent");
    EXPECT_NE(fault(file + R"(, "base": "loose"})").find("/import/base: is the string \"loose\""), std::string::npos);
    EXPECT_NE(fault(file + R"(, "link": "forearm"})").find("/import/link: is an unknown key"), std::string::npos);
    EXPECT_NE(fault(R"("import": {"file": "arm6.urdf"})").find("/import: mechanisms/arm6.urdf: is not a built-in file"),
              std::string::npos);
    EXPECT_NE(fault(file + R"(}, "bodies": [])").find("/bodies: is given together with \"import\""), std::string::npos);
    EXPECT_NE(fault(file + R"(}, "joints": [])").find("/joints: is given together with \"import\""), std::string::npos);
    EXPECT_NE(fault(file + R"(}, "pivot": [0, 0, 0])").find("/pivot: is given together with \"import\""),
              std::string::npos);
    EXPECT_EQ(fault(file + R"(, "initial": {"elbow": {"dependent": true}}},
        "loops": [{"name": "l", "type": "spherical", "first": "flange", "second": "world"}])"),
              "");
}

}  // namespace
}  // namespace polhode
