// Joints of several coordinates as chains: names, poses against products of rotations and translations, messages.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "motion/mechanism.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

std::string chain_scene(const std::string& joints) {
    return R"({"name": "c", "duration": 1, "bodies": [
  {"name": "arm", "body": {"mass": 2, "inertia": [0.5, 0.75, 1], "center_of_mass": [0.25, 0, -0.5]}}], "joints": [)" +
           joints + "]}";
}

std::string chain_fault(const std::string& joints) {
    try {
        parse_scene(chain_scene(joints), "c.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

struct Frame3 {
    Quaternion<double> q{1, 0, 0, 0};
    Vector3<double> x;

    Frame3 moved(const Vector3<double>& by) const { return {q, x + rotate(q, by)}; }
    Frame3 turned(Vector3<double> axis, double angle) const {
        axis = (1 / length(axis)) * axis;
        const double s = std::sin(angle / 2);
        return {q * Quaternion<double>{std::cos(angle / 2), s * axis[0], s * axis[1], s * axis[2]}, x};
    }
};

void expect_at_start(const Scene& scene, const Frame3& frame) {
    const BodyMotion<double> arm = mechanism_initial_motions(scene)[0];
    EXPECT_LT(length(Vector3<double>(arm.position_W - frame.moved({0.25, 0, -0.5}).x)), 1e-15);
    EXPECT_LT(length(vector_part(conjugate(frame.q) * arm.q)), 1e-15);
}

TEST(JointChains, CompoundAxesActInSequenceAboutTheirOwnPoints) {
    const Scene scene =
        parse_scene(chain_scene(R"({"name": "hip", "type": "compound", "parent": "world", "child": "arm",
      "parent_point": [1, 2, 3], "child_point": [0.5, 0, 0], "parent_orientation": [0.8, 0.6, 0, 0], "axes": [
      {"type": "revolute", "axis": [0, 0, 2], "point": [0, 0.25, 0], "initial": {"angle": 0.5}, "damping": 0.5},
      {"name": "slide", "type": "prismatic", "axis": [1, 1, 0], "initial": {"displacement": 0.75}, "stiffness": 3},
      {"type": "revolute", "axis": [0, 1, 0.5], "point": [0, 0, 1], "initial": {"angle": -1, "rate": 2}, "armature": 0.25}]})"),
                    "c.json");
    ASSERT_EQ(scene.joints.size(), 4u);  // with the fixed joint that places the child's frame
    EXPECT_EQ(scene.joints[0].type, JointType::fixed);
    EXPECT_EQ(scene.joints[1].name, "hip_1");
    EXPECT_EQ(scene.joints[1].damping[0], 0.5);
    EXPECT_EQ(scene.joints[2].name, "slide");
    EXPECT_EQ(scene.joints[3].name, "hip_3");
    EXPECT_EQ(scene.joints[3].armature[0], 0.25);
    EXPECT_EQ(scene.joints[3].child, "arm");
    ASSERT_EQ(scene.bodies.size(), 4u);
    EXPECT_EQ(scene.bodies[0].name, "arm");
    for (std::size_t b = 1; b < 4; ++b) EXPECT_EQ(scene.bodies[b].body.mass, 0);
    Frame3 frame{{0.8, 0.6, 0, 0}, {1, 2, 3}};
    frame = frame.moved({-0.5, 0, 0});
    frame = frame.moved({0, 0.25, 0}).turned({0, 0, 1}, 0.5).moved({0, -0.25, 0});
    frame = frame.moved(Vector3<double>(0.75 / std::sqrt(2), 0.75 / std::sqrt(2), 0));
    frame = frame.moved({0, 0, 1}).turned({0, 1, 0.5}, -1).moved({0, 0, -1});
    expect_at_start(scene, frame);
    // the written scene is the same mechanism
    const Scene again = parse_scene(write_scene(scene), "written");
    EXPECT_EQ(write_scene(again), write_scene(scene));
}

TEST(JointChains, CylindricalAndPlanarJoints) {
    const std::string ends =
        R"("parent": "world", "child": "arm", "parent_point": [1, 0, 0], "child_point": [0, 0.5, 0])";
    const Scene cylinder = parse_scene(
        chain_scene(
            R"({"name": "c", "type": "cylindrical", "axis": [0, 0, 1], "translation": {"initial": {"displacement": 2}},
                        "rotation": {"name": "angle", "initial": {"angle": 0.5}, "friction": 0.25}, )" +
            ends + "}"),
        "c.json");
    ASSERT_EQ(cylinder.joints.size(), 2u);
    EXPECT_EQ(cylinder.joints[0].name, "c_translation");
    EXPECT_EQ(cylinder.joints[1].name, "angle");
    EXPECT_EQ(cylinder.joints[1].friction, 0.25);
    expect_at_start(cylinder, Frame3{{1, 0, 0, 0}, {1, 0, 2}}.turned({0, 0, 1}, 0.5).moved({0, -0.5, 0}));
    const Scene planar = parse_scene(
        chain_scene(R"({"name": "p", "type": "planar", "normal": [0, 1, 0], "first": {"initial": {"displacement": 2}},
                        "second": {"initial": {"displacement": 3}}, "rotation": {"initial": {"angle": 0.5}}, )" +
                    ends + "}"),
        "c.json");
    ASSERT_EQ(planar.joints.size(), 3u);
    expect_at_start(planar, Frame3{{1, 0, 0, 0}, {4, 0, 2}}.turned({0, 1, 0}, 0.5).moved({0, -0.5, 0}));
}

TEST(JointChains, AScrewIsACoupledCylindricalJoint) {
    const Scene screw = parse_scene(
        chain_scene(
            R"({"name": "s", "type": "screw", "parent": "world", "child": "arm", "axis": [0, 0, 1], "pitch": 0.5,
                        "translation": {"initial": {"dependent": true}}, "rotation": {"initial": {"angle": 1, "rate": 2}}})"),
        "c.json");
    ASSERT_EQ(screw.couplings.size(), 1u);
    EXPECT_EQ(screw.couplings[0].first, "s_rotation");
    EXPECT_NEAR(screw.couplings[0].ratio, 0.5 / 6.283185307179586, 1e-17);
    expect_at_start(screw, Frame3{{1, 0, 0, 0}, {0, 0, 0.5 / 6.283185307179586}}.turned({0, 0, 1}, 1));
    const BodyMotion<double> arm = mechanism_initial_motions(screw)[0];
    EXPECT_NEAR(arm.velocity_W[2], 1 / 6.283185307179586, 1e-15);
}

TEST(JointChains, AFreeJointIsAFreeBody) {
    const Scene scene = parse_scene(
        chain_scene(
            R"({"name": "f", "type": "free", "parent": "world", "child": "arm", "initial": {"position": [1, 2, 3]}})"),
        "c.json");
    EXPECT_TRUE(scene.joints.empty());
    EXPECT_EQ(scene.bodies[0].initial.position_W[2], 3);
}

TEST(JointChains, MessagesNameThePlaceInTheFile) {
    const std::string ends = R"("parent": "world", "child": "arm")";
    EXPECT_NE(
        chain_fault(R"({"name": "a", "type": "compound", )" + ends +
                    R"(, "axes": [{"type": "revolute", "axis": [1, 0, 0]}, {"type": "revolute", "axis": [0, 0, 0]}]})")
            .find("/joints/0/axes/1/axis"),
        std::string::npos);
    EXPECT_NE(
        chain_fault(R"({"name": "a", "type": "planar", "normal": [0, 0, 1], "rotation": {"damp": 1}, )" + ends + "}")
            .find("damp"),
        std::string::npos);
    EXPECT_NE(chain_fault(R"({"name": "a", "type": "compound", "axes": [], )" + ends + "}").find("/joints/0/axes"),
              std::string::npos);
    EXPECT_NE(chain_fault(R"({"name": "a", "type": "free", "parent": "arm", "child": "arm"})").find("/joints/0/parent"),
              std::string::npos);
}

}  // namespace
}  // namespace polhode
