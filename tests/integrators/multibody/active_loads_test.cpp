// Every kind of load and the forces of every joint type on bodies in maximal coordinates, compared with the equations
// in joint coordinates, where they are generalised forces.
#include "integrators/multibody/multibody_cases.h"

namespace polhode {
namespace {

using namespace multibody_cases;

NamedBody lopsided_body(const char* name) {
    NamedBody body;
    body.name = name;
    body.body.mass = 2, body.body.center_of_mass = {0.125, 0.25, -0.0625};
    body.body.inertia_B = diagonal(Vector3<double>(0.5, 0.75, 1));
    return body;
}

// a free base that carries a body on a joint of this type, with a second axis at 60 degrees to the first
Scene carried(JointType type) {
    Scene scene;
    scene.name = "carried", scene.duration = 0.5;
    scene.bodies = {lopsided_body("base"), lopsided_body("load")};
    scene.bodies[0].initial.angular_velocity = {0.5, -0.25, 0.75};
    Joint joint;
    joint.name = "joint", joint.type = type, joint.parent = "base", joint.child = "load";
    joint.parent_point = {0.5, 0.25, 0}, joint.child_point = {-0.25, 0, 0.5};
    joint.axes[0] = {0, 0.6, 0.8};
    if (type == JointType::universal) joint.axes[1] = {1, 0.5, 0.5};
    if (type == JointType::spherical) joint.angular_velocity = {0.5, 0.25, -1};
    if (type != JointType::spherical && type != JointType::fixed) joint.rate = {0.75, 0};
    if (type == JointType::universal) joint.rate[1] = -0.5;
    scene.joints = {joint};
    return scene;
}

// Measured orders: 0.987 to 1.055 at steps of 1/256 and 1/512 s.
void expect_order_one(const char* what, const Scene& scene) {
    const Case it(scene, 4);
    for (const char* method : {"sequential_impulses_split_10", "xpbd_joints_10"}) {
        EXPECT_NEAR(it.order(method, 1.0 / 256), 1, 0.1) << method << ": " << what;
        EXPECT_LT(it.off(method, 1.0 / 512).attitude, 1e-2) << method << ": " << what;
    }
}

TEST(ActiveLoads, JointsOwnForcesAreTheGeneralizedOnes) {
    for (const auto& [what, type] :
         {std::pair{"revolute", JointType::revolute}, std::pair{"prismatic", JointType::prismatic},
          std::pair{"spherical", JointType::spherical}, std::pair{"universal", JointType::universal}}) {
        Scene scene = carried(type);
        Joint& joint = scene.joints.front();
        const bool two = type == JointType::universal;
        joint.stiffness = {20, two ? 30.0 : 0}, joint.damping = {0.5, two ? 0.25 : 0};
        if (type == JointType::spherical)
            joint.rest_orientation = {0.8, 0, 0.6, 0};
        else
            joint.rest = {0.5, two ? -0.25 : 0};
        if (type == JointType::revolute || type == JointType::prismatic)
            scene.loads.push_back(Motor{"joint", 3, {0.125, 0.375}});
        expect_order_one(what, scene);
    }
}

TEST(ActiveLoads, LoadsMoveBodiesAsTheyDoInJointCoordinates) {
    const auto beside = [](Load load) {
        Scene scene = carried(JointType::revolute);
        scene.loads.push_back(std::move(load));
        return scene;
    };
    const Vector3<double> point(0.5, -0.25, 0.75), vector(4, -2, 3);
    const Window window{0.125, 0.375};
    expect_order_one("torque, body axes", beside(Torque{vector, Frame::body, window, "load"}));
    expect_order_one("torque, world axes", beside(Torque{vector, Frame::world, window, "base"}));
    expect_order_one("force, body axes", beside(Force{vector, Frame::body, point, Frame::body, window, "load"}));
    expect_order_one("force at a point of the world",
                     beside(Force{vector, Frame::world, point, Frame::world, window, "load"}));
    expect_order_one("drag", beside(Drag{{1, 2, 3}, 2, window, "load"}));
    expect_order_one("torsional spring", beside(Spring{10, {0.6, 0, 0.8, 0}, {}, "load"}));
    expect_order_one("spring to the world", beside(PointSpring{"world", point, "load", {1, 0, 0}, 30, 0.5, {}}));
    expect_order_one("spring between the bodies", beside(PointSpring{"base", point, "load", {1, 0, 0}, 30, 0, {}}));
}

TEST(ActiveLoads, ImpulsesStrikeBothBodiesOfAJoint) {
    for (const Frame frame : {Frame::body, Frame::world}) {
        Scene scene = carried(JointType::universal);
        scene.loads.push_back(Impulse{{1, -0.5, 0.75}, frame, {0.5, 0, 0.25}, frame, 0.25, "load"});
        const Case it(scene, 4);
        const double coarse = it.off("sequential_impulses_split_10", 1.0 / 256).attitude,
                     fine = it.off("sequential_impulses_split_10", 1.0 / 1024).attitude;
        EXPECT_LT(fine, coarse / 2.5);
        EXPECT_LT(fine, 5e-3);
    }
}

}  // namespace
}  // namespace polhode
