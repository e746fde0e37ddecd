// Actuators and gravity compensation of MJCF, and planar joints of URDF, against forces computed by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scene/robot_tree.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

const std::string actuated_body =
    "<body name='a' gravcomp='0.5'><joint name='h' axis='0 1 0' ref='30'/><inertial pos='0.1 0 0.2' mass='2' "
    "diaginertia='1 1 1'/><body name='b'><joint name='s' type='slide'/><inertial pos='0 0 0' mass='1' "
    "diaginertia='1 1 1'/></body></body>";

Scene actuated(const std::string& actuators, const std::map<std::string, double>& controls = {},
               const std::string& head = "") {
    Scene scene;
    scene.name = "robot", scene.duration = 1;
    RobotOptions options;
    options.controls = controls;
    const std::string text = "<mujoco>" + head + "<worldbody>" + actuated_body + "</worldbody><actuator>" + actuators +
                             "</actuator></mujoco>";
    add_robot(parse_robot(text, "robot.xml", options), options, "robot.xml", scene);
    validate(scene, "robot.xml");
    return scene;
}

// the formula of the only motor, its constant force, or "none"
std::string motor_of(const Scene& scene) {
    std::string found = "none";
    for (const Load& load : scene.loads) {
        if (const auto* formula = std::get_if<FormulaLoad>(&load)) found = formula->joint + ": " + formula->formula;
        if (const auto* motor = std::get_if<Motor>(&load)) found = motor->joint + ": " + std::to_string(motor->force);
    }
    return found;
}

TEST(RobotActuators, ForcesFollowTheirLaws) {
    using Controls = std::map<std::string, double>;
    struct Case {
        std::string actuator;
        Controls controls;
        std::string motor;
    };
    const Case cases[] = {
        {"<motor name='m' joint='s'/>", {}, "none"},
        {"<motor name='m' joint='s' gear='3'/>", {{"m", 0.5}}, "s: 1.500000"},
        {"<motor name='m' joint='s' gear='3' ctrlrange='-0.1 0.1'/>", {{"m", 0.5}}, "s: 0.300000"},
        {"<motor name='m' joint='s' gear='3' forcerange='-0.2 0.2'/>", {{"m", 0.5}}, "s: 0.600000"},
        {"<motor name='m' joint='s' ctrlrange='-0.1 0.1' ctrllimited='false'/>", {{"m", 0.5}}, "s: 0.500000"},
        {"<position name='p' joint='s' kp='20' kv='2'/>",
         {{"p", 0.25}},
         "s: 5 - 20*\"s\".displacement - 2*\"s\".speed"},
        // f = 20 (c - 2 x) - 2 (2 x'), and the force is 2 f
        {"<position name='p' joint='s' kp='20' kv='2' gear='2' forcerange='-4 4'/>",
         {{"p", 0.25}},
         "s: clamp(10 - 80*\"s\".displacement - 8*\"s\".speed, -8, 8)"},
        {"<velocity name='v' joint='s' kv='3'/>", {{"v", 2}}, "s: 6 - 3*\"s\".speed"},
        {"<damper name='d' joint='s' kv='3' ctrlrange='0 1'/>", {{"d", 0.5}}, "s: 0 - 1.5*\"s\".speed"},
        {"<damper name='d' joint='s' kv='3' ctrlrange='0 1'/>", {}, "none"},
        {"<general name='g' joint='s' gainprm='2' biastype='affine' biasprm='0.5 -3 -0.25'/>",
         {{"g", 1}},
         "s: 2.5 - 3*\"s\".displacement - 0.25*\"s\".speed"},
        {"<general name='g' joint='s' gainprm='2' biasprm='0.5 -3 -0.25'/>", {{"g", 1}}, "s: 2.000000"},
    };
    for (const Case& one : cases) {
        const Scene scene = actuated(one.actuator, one.controls);
        EXPECT_EQ(motor_of(scene), one.motor) << one.actuator;
        EXPECT_TRUE(scene.omitted.empty()) << scene.omitted.front();
    }
    // MuJoCo's coordinate is pi/6 where that of the scene is zero
    const std::string servo = motor_of(actuated("<position name='p' joint='h' kp='6'/>"));
    EXPECT_EQ(servo.substr(0, 18), "h: -3.141592653589");
    EXPECT_NE(servo.find(" - 6*\"h\".angle"), std::string::npos) << servo;
}

TEST(RobotActuators, DefaultsAndSwitches) {
    const std::string head =
        "<default><general ctrlrange='-1 1'/><position kp='7'/><default class='x'><motor gear='5'/>"
        "</default></default>";
    EXPECT_EQ(motor_of(actuated("<position name='p' joint='s'/>", {{"p", 3}}, head)), "s: 7 - 7*\"s\".displacement");
    EXPECT_EQ(motor_of(actuated("<motor name='m' class='x' joint='s'/>", {{"m", 3}}, head)), "s: 5.000000");
    EXPECT_EQ(motor_of(actuated("<position name='p' joint='h'/>", {}, "<option><flag actuation='disable'/></option>")),
              "none");
    const Scene disabled = actuated("<position name='p' group='2' joint='s'/><position name='r' joint='h'/>", {},
                                    "<option actuatorgroupdisable='1 2'/>");
    EXPECT_EQ(motor_of(disabled).substr(0, 2), "h:");
    EXPECT_TRUE(disabled.omitted.empty());
}

// Laws with activation, and transmissions that are not joints, stay omitted.
TEST(RobotActuators, OthersAreReported) {
    for (const char* actuator :
         {"<general name='x' joint='s' dyntype='filter' dynprm='0.1'/>", "<muscle name='x' joint='s'/>",
          "<position name='x' joint='s' kp='1' timeconst='0.1'/>", "<position name='x' joint='s' dampratio='1'/>",
          "<intvelocity name='x' joint='s' actrange='-1 1'/>", "<motor name='x' site='p'/>"}) {
        const Scene scene = actuated(actuator);
        EXPECT_EQ(scene.omitted, std::vector<std::string>{"actuators: x"}) << actuator;
        EXPECT_EQ(motor_of(scene), "none");
    }
    const auto fault_of = [](const std::string& text, const std::map<std::string, double>& controls) {
        try {
            actuated(text, controls);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    EXPECT_NE(fault_of("<motor name='elbow' joint='s'/>", {{"elbw", 1}}).find("did you mean elbow?"),
              std::string::npos);
    EXPECT_NE(fault_of("<motor name='m' joint='none'/>", {}).find("names the joint \"none\", which does not exist"),
              std::string::npos);
    EXPECT_NE(fault_of("<motor name='m' joint='s' ctrlrange='1 -1'/>", {}).find("ctrlrange that is not increasing"),
              std::string::npos);
}

// gravcomp='0.5' of 2 kg at (0.1, 0, 0.2): half of the weight, upwards.
TEST(RobotActuators, GravityCompensationIsAForceAtTheCentreOfMass) {
    const Scene scene = actuated("");
    const auto force =
        std::ranges::find_if(scene.loads, [](const Load& one) { return std::holds_alternative<Force>(one); });
    ASSERT_NE(force, scene.loads.end());
    const Force& lift = std::get<Force>(*force);
    EXPECT_EQ(lift.vector, Vector3<double>(0, 0, 9.81));
    EXPECT_EQ(lift.point, Vector3<double>(0.1, 0, 0.2));
    EXPECT_EQ(lift.body, "a");
    EXPECT_EQ(lift.frame, Frame::world);
}

// A planar joint moves along two directions perpendicular to its axis, and about it.
TEST(RobotActuators, PlanarJointsOfUrdfAreThreeJoints) {
    Scene scene;
    scene.name = "robot", scene.duration = 1;
    const std::string text =
        "<robot name='r'><link name='table'/><link name='puck'><inertial><mass value='1'/><inertia ixx='1' iyy='1' "
        "izz='1' "
        "ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j' type='planar'><parent link='table'/><child "
        "link='puck'/><axis xyz='0 -2 0'/></joint></robot>";
    add_robot(parse_robot(text, "r.urdf"), {}, "r.urdf", scene);
    validate(scene, "r.urdf");
    ASSERT_EQ(scene.joints.size(), 3u);
    EXPECT_EQ(scene.joints[0].type, JointType::prismatic);
    EXPECT_EQ(scene.joints[1].type, JointType::prismatic);
    EXPECT_EQ(scene.joints[2].type, JointType::revolute);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(scene.joints[static_cast<std::size_t>(i)].axes[0][1], 0);
    EXPECT_EQ(dot(scene.joints[0].axes[0], scene.joints[1].axes[0]), 0);
    EXPECT_EQ(scene.joints[2].axes[0], Vector3<double>(0, -2, 0));
    EXPECT_EQ(scene.joints[2].name, "j_rotation");
}

}  // namespace
}  // namespace polhode
