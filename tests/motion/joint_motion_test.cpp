// Joint coordinates from the motions of bodies, compared with the recursion that computes motions from coordinates.
#include "motion/joint_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "motion/tree.h"

namespace polhode {
namespace {

// A chain with a joint of each type between bodies with displaced centres of mass. The universal joint's axes are not
// perpendicular, and no axis is parallel to a coordinate axis.
Scene chain_of_all_types() {
    Scene scene;
    scene.name = "chain", scene.duration = 1;
    constexpr JointType types[] = {JointType::revolute,  JointType::prismatic, JointType::spherical,
                                   JointType::universal, JointType::fixed,     JointType::revolute};
    std::string parent = "world";
    for (const JointType type : types) {
        NamedBody body;
        body.name = "b" + std::to_string(scene.bodies.size());
        body.body.center_of_mass = {0.25, -0.5, 0.125};
        Joint joint;
        joint.name = "j" + std::to_string(scene.joints.size()), joint.type = type;
        joint.parent = parent, joint.child = parent = body.name;
        joint.parent_point = {0.5, 0.25, -1}, joint.child_point = {-0.125, 0.5, 0.75};
        joint.parent_orientation = {0.8, 0, 0.36, 0.48};
        joint.axes = {Vector3<double>{1, 2, -2}, Vector3<double>{-2, 3, 6}};
        scene.bodies.push_back(body), scene.joints.push_back(joint);
    }
    return scene;
}

// A state of the tree with angles up to 30 rad.
std::vector<double> random_state(const Tree<double>& tree, std::mt19937_64& engine) {
    const auto number = [&] { return 2 * std::generate_canonical<double, 53>(engine) - 1; };
    std::vector<double> y(static_cast<std::size_t>(tree.dimension()));
    for (double& x : y) x = 3 * number();
    for (const Link<double>& link : tree.links().links) {
        double* const x = y.data() + link.coordinate;
        if (link.kind == LinkJoint::revolute) *x *= 10;
        if (link.kind != LinkJoint::spherical) continue;
        const Quaternion<double> q = normalized(Quaternion<double>{x[0], x[1], x[2], x[3]});
        x[0] = q.w, x[1] = q.x, x[2] = q.y, x[3] = q.z;
    }
    return y;
}

TEST(JointMotion, InvertsTheRecursionOfTrees) {
    const Scene scene = chain_of_all_types();
    const Tree<double> tree(scene, bodies_mass_properties<double>(scene));
    const JointKinematics<double> kinematics(scene);
    std::mt19937_64 engine(7);
    for (int repeat = 0; repeat < 200; ++repeat) {
        const std::vector<double> y = random_state(tree, engine);
        const std::vector<std::array<double, 2>> coordinates = tree.joint_coordinates(y.data());
        JointCoordinates tracked(scene);
        tracked.set(0, coordinates);
        const auto found = kinematics.at(0, tree.motions(y.data()), tracked);
        ASSERT_EQ(found.size(), scene.joints.size());
        for (const Link<double>& link : tree.links().links) {
            const JointMotion<double>& motion = found[static_cast<std::size_t>(link.joint)];
            const std::size_t axis = static_cast<std::size_t>(link.axis);
            const double* const x = y.data() + link.coordinate;
            const double* const rate = y.data() + link.rate;
            SCOPED_TRACE(testing::Message() << "repeat " << repeat << ", joint " << link.joint);
            if (link.kind != LinkJoint::spherical) {
                EXPECT_NEAR(motion.coordinate[axis], *x, 4e-14);
                // rates of a universal joint are divided by 1 - (a.b)^2 = 0.92
                EXPECT_NEAR(motion.rate[axis], *rate, 2e-13);
                continue;
            }
            const Quaternion<double>& q = motion.orientation;
            const double sign = q.w * x[0] + q.x * x[1] + q.y * x[2] + q.z * x[3] < 0 ? -1 : 1;
            EXPECT_NEAR(sign * q.w, x[0], 1e-14);
            EXPECT_NEAR(sign * q.x, x[1], 1e-14);
            EXPECT_NEAR(sign * q.z, x[3], 1e-14);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(motion.angular_velocity[static_cast<std::size_t>(k)], rate[k], 1e-13);
        }
    }
}

// The rates of all coordinates, those of a quaternion included, are the derivatives of the coordinates: central
// differences along the motion of the tree with constant coordinate rates.
TEST(JointMotion, RatesAreDerivativesOfCoordinates) {
    const Scene scene = chain_of_all_types();
    const Tree<double> tree(scene, bodies_mass_properties<double>(scene));
    const JointKinematics<double> kinematics(scene);
    std::mt19937_64 engine(11);
    const std::vector<double> y = random_state(tree, engine);
    std::vector<double> change(y.size());
    tree.derivative(y.data(), change.data());
    const auto at = [&](double t) {
        std::vector<double> moved = y;
        for (int i = 0; i < tree.links().coordinates; ++i)
            moved[static_cast<std::size_t>(i)] += t * change[static_cast<std::size_t>(i)];
        std::vector<BodyMotion<double>> motions = tree.motions(moved.data());
        for (BodyMotion<double>& motion : motions) motion.q = normalized(motion.q);
        JointCoordinates tracked(scene);
        tracked.set(0, tree.joint_coordinates(y.data()));
        return kinematics.at(0, motions, tracked);
    };
    constexpr double h = 1e-5;
    const auto before = at(-h), now = at(0), after = at(h);
    for (std::size_t j = 0; j < now.size(); ++j) {
        const std::vector<double> rates = now[j].rates(), ahead = after[j].coordinates(),
                                  back = before[j].coordinates();
        // error of the difference: h^2 x'''/6 and round-off / h
        for (std::size_t i = 0; i < rates.size(); ++i) EXPECT_NEAR((ahead[i] - back[i]) / (2 * h), rates[i], 2e-8) << j;
    }
}

TEST(JointMotion, CsvHasALinePerCoordinate) {
    const Scene scene = chain_of_all_types();
    const Tree<double> tree(scene, bodies_mass_properties<double>(scene));
    std::vector<double> y(static_cast<std::size_t>(tree.dimension()));
    tree.initial(y.data());
    JointCoordinates tracked(scene);
    const auto motions = JointKinematics<double>(scene).at(0, tree.motions(y.data()), tracked);
    const double times[] = {0.5};
    const std::string text = joints_csv(times, motions, joint_names(scene));
    EXPECT_TRUE(text.starts_with("t,joint,coordinate,rate\n0.5,j0,")) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 1 + 1 + 4 + 2 + 0 + 1) << text;
}

}  // namespace
}  // namespace polhode
