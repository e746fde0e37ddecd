// Tables of initial states of a mechanism: the meaning of each column, and refusals.
#include "motion/mechanism_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bad_files.h"
#include "motion/ensemble_stream.h"
#include "motion/ensemble_table.h"

namespace polhode {
namespace {

NamedBody body_named(const char* name) {
    NamedBody body;
    body.name = name;
    body.body.mass = 2, body.body.inertia_B = diagonal(Vector3<double>(1, 1.25, 1.5));
    return body;
}

Joint joint_named(const char* name, JointType type, const char* parent, const char* child) {
    Joint joint;
    joint.name = name, joint.type = type, joint.parent = parent, joint.child = child;
    joint.axes[0] = {0, 1, 0};
    if (type == JointType::universal) joint.axes[1] = {1, 0, 0};
    return joint;
}

// a free base that carries one joint of each type
Scene scene_of_all_joints() {
    Scene scene;
    scene.name = "all joints", scene.duration = 1;
    for (const char* name : {"base", "arm", "sled", "ball", "cross", "plate"}) scene.bodies.push_back(body_named(name));
    scene.joints = {joint_named("hinge", JointType::revolute, "base", "arm"),
                    joint_named("rail", JointType::prismatic, "base", "sled"),
                    joint_named("socket", JointType::spherical, "base", "ball"),
                    joint_named("cardan", JointType::universal, "base", "cross"),
                    joint_named("weld", JointType::fixed, "base", "plate")};
    return scene;
}

std::string refusal_of(const std::string& text) {
    try {
        parse_ensemble(text, "starts.csv", scene_of_all_joints(), BadRows::pass_over);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(MechanismTable, EachColumnSetsItsOwnNumberOnly) {
    const Scene scene = scene_of_all_joints();
    const auto columns = mechanism_columns(scene);
    // columns: one-coordinate joints 5, universal 4, spherical 7, fixed 0; one mass per body; 13 more for the free base
    EXPECT_EQ(columns.size(), 5u + 5 + 7 + 4 + 6 + 13);
    Scene numbered = scene;
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].number(numbered) = 100 + static_cast<double>(i);
    for (std::size_t i = 0; i < columns.size(); ++i)
        EXPECT_EQ(columns[i].number(numbered), 100 + static_cast<double>(i)) << columns[i].name;
}

TEST(MechanismTable, NumbersGoWhereTheirColumnsSay) {
    const Scene scene = scene_of_all_joints();
    const EnsembleTable table = parse_ensemble(
        "id,hinge.angle,hinge.rate,rail.displacement,rail.speed,cardan.angle2,cardan.rate1,socket.qw,socket.qx,"
        "socket.qy,socket.qz,socket.wx,socket.wy,socket.wz,base.qw,base.qx,base.qy,base.qz,base.px,base.py,base.pz,"
        "base.wz,base.wy,base.wx,base.vx,base.vy,base.vz,hinge.stiffness,hinge.rest,hinge.damping,sled.mass\n"
        "a,0.1,0.2,0.3,0.4,0.5,0.6,0.6,0,0.8,0,1,2,3,0,0.6,0,0.8,4,5,6,9,8,7,10,11,12,13,14,15,16\n",
        "starts.csv", scene);
    ASSERT_EQ(table.rows(), 1u);
    EXPECT_EQ(table.ids.front(), "a");
    EXPECT_FALSE(table.mechanisms.only_starts());
    const Scene row = table.mechanisms.scene_of(scene, 0);
    EXPECT_EQ(row.joints[0].coordinate[0], 0.1);
    EXPECT_EQ(row.joints[0].rate[0], 0.2);
    EXPECT_EQ(row.joints[1].coordinate[0], 0.3);
    EXPECT_EQ(row.joints[1].rate[0], 0.4);
    EXPECT_EQ(row.joints[3].coordinate[0], 0);
    EXPECT_EQ(row.joints[3].coordinate[1], 0.5);
    EXPECT_EQ(row.joints[3].rate[0], 0.6);
    EXPECT_EQ(row.joints[2].orientation, (Quaternion<double>{0.6, 0, 0.8, 0}));
    EXPECT_EQ(row.joints[2].angular_velocity, Vector3<double>(1, 2, 3));
    EXPECT_EQ(row.bodies[0].initial.orientation, (Quaternion<double>{0, 0.6, 0, 0.8}));
    EXPECT_EQ(row.bodies[0].initial.position_W, Vector3<double>(4, 5, 6));
    EXPECT_EQ(row.bodies[0].initial.angular_velocity, Vector3<double>(7, 8, 9));
    EXPECT_EQ(row.bodies[0].initial.velocity_W, Vector3<double>(10, 11, 12));
    EXPECT_EQ(row.joints[0].stiffness[0], 13);
    EXPECT_EQ(row.joints[0].rest[0], 14);
    EXPECT_EQ(row.joints[0].damping[0], 15);
    EXPECT_EQ(row.bodies[2].body.mass, 16);
    EXPECT_EQ(row.bodies[1].body.mass, 2);
}

TEST(MechanismTable, KnowsWhetherAllRowsAreMotionsOfOneMechanism) {
    const Scene scene = scene_of_all_joints();
    for (const auto& [text, only_starts] :
         {std::pair{"hinge.angle,cardan.rate2\n1,2\n", true}, std::pair{"id,hinge.angle,rail.damping\na,1,2\n", false},
          std::pair{"arm.mass\n1\n", false}}) {
        EXPECT_EQ(parse_ensemble(text, "t.csv", scene).mechanisms.only_starts(), only_starts) << text;
        EXPECT_EQ(ensemble_of_text(text, "t.csv", scene)->empty_table().mechanisms.only_starts(), only_starts) << text;
    }
}

TEST(MechanismTable, ARowThatIsNoStartStopsNoOther) {
    const EnsembleTable table =
        parse_ensemble("id,arm.mass,hinge.angle\na,1,2\nb,-1,2\nc,1,x\nd,1\ne,1e999,1\nf,,1\n\"g,1,1\nh,3,4\n",
                       "starts.csv", scene_of_all_joints(), BadRows::pass_over);
    EXPECT_EQ(table.ids, (std::vector<std::string>{"a", "h"}));
    EXPECT_EQ(table.row_numbers(1), (std::vector<std::size_t>{1, 8}));
    EXPECT_EQ(table.mechanisms.numbers, (std::vector<double>{1, 2, 3, 4}));
    ASSERT_EQ(table.refused.size(), 6u);
    const char* const faults[] = {"mass",  "x is not a number", "has 2 cells under 3 columns",
                                  "1e999", "is empty",          "quotes"};
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(table.refused[i].row, i + 2);
        EXPECT_NE(table.refused[i].fault.find(faults[i]), std::string::npos) << table.refused[i].fault;
        EXPECT_NE(table.refused[i].fault.find("line " + std::to_string(i + 3)), std::string::npos)
            << table.refused[i].fault;
    }
}

TEST(MechanismTable, RefusesWhatIsNoTableOfStarts) {
    for (const auto& [text, fault] :
         {std::pair{"", "is empty"}, std::pair{"id\na\n", "has no column but id"},
          std::pair{"socket.qw,socket.qx\n1,0\n", "column socket.qy is missing"},
          std::pair{"base.px\n1\n", "column base.py is missing"},
          std::pair{"hinge.angle\n", "has a header but no rows"}, std::pair{"arm.mass\n-1\n", "has no valid row"},
          std::pair{"hinge.angles\n1\n", "hinge.angles"},
          // a body that a joint carries has no start of its own, a weld no coordinate
          std::pair{"arm.px,arm.py,arm.pz\n1,2,3\n", "arm.px"}, std::pair{"weld.angle\n1\n", "weld.angle"}}) {
        const std::string message = refusal_of(text);
        EXPECT_NE(message.find(fault), std::string::npos) << text << ": " << message;
        EXPECT_EQ(message.find("starts.csv"), 0u) << message;
    }
}

}  // namespace
}  // namespace polhode
