// Which formulation each scene is posed as, and what it is documented to omit.
#include "motion/needs.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "motion/systems.h"

namespace polhode {
namespace {

Scene body_with(const Vector3<double>& moments, const Vector3<double>& w) {
    Scene scene;
    scene.name = "body", scene.duration = 2;
    scene.body.inertia_B = diagonal(moments);
    scene.initial.angular_velocity = w;
    return scene;
}

struct Case {
    const char* name;
    Scene scene;
    SystemKind system;
    int dimension;
    Symmetry symmetry;
    Translation translation;
    std::vector<std::string> omitted;  ///< all of them, in any order

    // prints the name: GoogleTest's default would read uninitialised padding bytes
    friend std::ostream& operator<<(std::ostream& out, const Case& given) { return out << given.name; }
};

Scene with(Scene scene, std::vector<Load> loads) {
    scene.loads = std::move(loads);
    return scene;
}
Scene held(Scene scene, const Vector3<double>& center_of_mass) {
    scene.pivot = Vector3<double>(0, 0, 0);
    scene.body.center_of_mass = center_of_mass;
    return scene;
}
Scene thrown(Scene scene) {
    scene.initial.velocity_W = {1, 2, 3};
    return scene;
}
/// The inertia rotated by 2 atan(1/2) about x: rational entries.
Scene tilted(Scene scene) {
    const double c = 0.6, s = 0.8, I2 = scene.body.inertia_B[1][1], I3 = scene.body.inertia_B[2][2];
    scene.body.inertia_B[1][1] = c * c * I2 + s * s * I3;
    scene.body.inertia_B[2][2] = s * s * I2 + c * c * I3;
    scene.body.inertia_B[1][2] = scene.body.inertia_B[2][1] = c * s * (I2 - I3);
    return scene;
}

const Gravity gravity_down{{0, 0, -9.8}, {}};
const UserTorque nothing{"nothing", [](const LoadState&) { return Vector3<double>(); }, {}};
const std::string pv = "p and v", gyro = "gyroscopic term w x Iw", two_components = "two components of w, two of q",
                  one_component = "one gyroscopic component", no_torque = "torque", of_products = "products of inertia";

const Case cases[] = {
    {"FreeAsymmetric",
     body_with({1, 2, 3}, {1, 1, 1}),
     SystemKind::free_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv, no_torque}},
    {"FreeAsymmetricAboutAPrincipalAxis",
     body_with({1, 2, 3}, {0, 1, 0}),
     SystemKind::principal_axis_rotation,
     3,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv, gyro, two_components}},
    {"FreeSymmetric",
     body_with({1, 1, 1.5}, {1, 0, 1}),
     SystemKind::free_rotation,
     7,
     Symmetry::symmetric,
     Translation::fixed,
     {pv, no_torque, one_component}},
    {"FreeSphere",
     body_with({2, 2, 2}, {1, 2, 3}),
     SystemKind::principal_axis_rotation,
     3,
     Symmetry::spherical,
     Translation::fixed,
     {pv, gyro, two_components}},
    {"LoadedSphere",
     with(body_with({2, 2, 2}, {1, 2, 3}), {Spring{1, {}, {}}}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::spherical,
     Translation::fixed,
     {pv, gyro}},
    {"ThrownAsymmetricUnderGravity",
     with(thrown(body_with({1, 2, 3}, {1, 1, 1})), {gravity_down}),
     SystemKind::free_rotation,
     7,
     Symmetry::asymmetric,
     Translation::closed_form,
     {pv, no_torque}},
    {"TranslationalDragAlone",
     with(thrown(body_with({1, 2, 3}, {1, 1, 1})), {gravity_down, Drag{{}, 0.5, {}}}),
     SystemKind::free_rotation,
     7,
     Symmetry::asymmetric,
     Translation::closed_form,
     {pv, no_torque}},
    {"RotationalDrag",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Drag{{0.1, 0.1, 0.1}, 0, {}}}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv}},
    {"RotationalDragAboutAPrincipalAxis",
     with(body_with({1, 2, 3}, {0, 0, 1}), {Drag{{0.1, 0.2, 0.3}, 0, {}}}),
     SystemKind::principal_axis_rotation,
     3,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv, gyro, two_components}},
    {"LagrangeTop",
     with(held(body_with({1, 1, 0.5}, {0.1, 0, 20}), {0, 0, 0.5}), {gravity_down}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::symmetric,
     Translation::fixed,
     {pv, one_component}},
    {"Pendulum",
     with(held(body_with({1, 2, 2.5}, {0.7, 0, 0}), {0, 0, -0.5}), {gravity_down}),
     SystemKind::principal_axis_rotation,
     3,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv, gyro, two_components}},
    {"PendulumOfAFreeAxis",
     with(held(body_with({1, 2, 2.5}, {0.7, 0.1, 0}), {0, 0, -0.5}), {gravity_down}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv}},
    {"ThrustInBodyAxes",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Force{{0, 0, 1}, Frame::body, {0.1, 0, 0}, Frame::body, {}}}),
     SystemKind::loaded_motion,
     13,
     Symmetry::asymmetric,
     Translation::integrated,
     {}},
    {"ForceAtAWorldPoint",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Force{{0, 0, 1}, Frame::world, {1, 0, 0}, Frame::world, {}}}),
     SystemKind::loaded_motion,
     13,
     Symmetry::asymmetric,
     Translation::integrated,
     {}},
    {"ForceInTheWorldAtABodyPoint",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Force{{0, 0, 1}, Frame::world, {0.1, 0, 0}, Frame::body, {}}}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::asymmetric,
     Translation::closed_form,
     {pv}},
    {"TorqueInTheWorld",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Torque{{0, 0, 1}, Frame::world, {}}}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv}},
    {"TorquesThatCancel",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Torque{{0, 0, 1}, Frame::world, {}}, Torque{{0, 0, -1}, Frame::world, {}}}),
     SystemKind::free_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv, no_torque}},
    {"ImpulseOnAFreeBody",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Impulse{{0, 0, 1}, Frame::world, {1, 0, 0}, Frame::body, 1}}),
     SystemKind::free_rotation,
     7,
     Symmetry::asymmetric,
     Translation::closed_form,
     {pv, no_torque}},
    {"ImpulseInBodyAxes",
     with(body_with({1, 2, 3}, {1, 1, 1}), {Impulse{{0, 0, 1}, Frame::body, {1, 0, 0}, Frame::body, 1}}),
     SystemKind::loaded_motion,
     13,
     Symmetry::asymmetric,
     Translation::integrated,
     {}},
    {"ProductsOfInertia",
     tilted(body_with({1, 2, 3}, {1, 1, 1})),
     SystemKind::free_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv, no_torque, of_products}},
    {"UserTorque",
     with(body_with({1, 2, 3}, {1, 0, 0}), {nothing}),
     SystemKind::loaded_rotation,
     7,
     Symmetry::asymmetric,
     Translation::fixed,
     {pv}},
    {"UserTorqueOnAThrownBody",
     with(thrown(body_with({1, 2, 3}, {1, 0, 0})), {nothing}),
     SystemKind::loaded_motion,
     13,
     Symmetry::asymmetric,
     Translation::integrated,
     {}},
};

class Posed : public ::testing::TestWithParam<Case> {};

TEST_P(Posed, AsTheSceneNeeds) {
    const Case& expected = GetParam();
    const Needs needs = pose(expected.scene).needs;
    EXPECT_EQ(std::string(name_of(needs.system)), name_of(expected.system));
    EXPECT_EQ(needs.dimension, expected.dimension);
    EXPECT_EQ(needs.symmetry, expected.symmetry);
    EXPECT_EQ(needs.translation, expected.translation);
    std::vector<std::string> found;
    for (const Omission& omission : needs.omitted) {
        found.push_back(omission.what);
        EXPECT_FALSE(omission.why.empty());
    }
    std::vector<std::string> sorted = expected.omitted;
    std::sort(sorted.begin(), sorted.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, sorted);
}

TEST_P(Posed, FullFormulationOmitsNoVariable) {
    const Needs needs = pose(GetParam().scene, Formulation::full).needs;
    EXPECT_EQ(needs.system, SystemKind::full_motion);
    EXPECT_EQ(needs.dimension, 13);
    EXPECT_TRUE(needs.omitted.empty());
}

INSTANTIATE_TEST_SUITE_P(Scenes, Posed, ::testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Needs, DetectsTimeDependence) {
    EXPECT_FALSE(pose(body_with({1, 2, 3}, {1, 1, 1})).needs.time_dependent);
    EXPECT_TRUE(
        pose(with(body_with({1, 2, 3}, {1, 1, 1}), {Torque{{0, 0, 1}, Frame::body, {0.5, 1}}})).needs.time_dependent);
    // a window that covers the whole run causes no time dependence
    EXPECT_FALSE(
        pose(with(body_with({1, 2, 3}, {1, 1, 1}), {Torque{{0, 0, 1}, Frame::body, {-1, 5}}})).needs.time_dependent);
    const Needs user = pose(with(body_with({1, 2, 3}, {1, 1, 1}), {nothing})).needs;
    EXPECT_TRUE(user.time_dependent);
    EXPECT_TRUE(user.user_torque);
}

/// The scalar system is the pendulum equation I dw/dt = -m g l sin(angle), for any initial angle.
TEST(PrincipalAxis, IsThePendulum) {
    const double angle = 0.8, m = 1, l = 0.5, I = 1 + m * l * l;
    Scene scene = with(held(body_with({1, 2, 2.5}, {0.7, 0, 0}), {0, 0, -l}), {gravity_down});
    scene.initial.orientation = {std::cos(angle / 2), std::sin(angle / 2), 0, 0};
    const Problem problem = pose(scene);
    ASSERT_EQ(problem.needs.system, SystemKind::principal_axis_rotation);
    const auto system = PrincipalAxisRotation(problem);
    for (double turned : {0.0, 0.5, 1.9, -2.4}) {
        const double y[3] = {0.7, std::cos(turned / 2), std::sin(turned / 2)};
        double f[3];
        system.derivative(0, y, f);
        EXPECT_NEAR(f[0], -m * 9.8 * l / I * std::sin(angle + turned), 1e-14);
        EXPECT_NEAR(f[1], -0.35 * std::sin(turned / 2), 1e-15);
        EXPECT_NEAR(f[2], 0.35 * std::cos(turned / 2), 1e-15);
    }
}

}  // namespace
}  // namespace polhode
