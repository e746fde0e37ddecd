#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "integrators/method.h"

namespace polhode {
namespace {

// What choose_method names for a body with drag c (N m s) over 10 s; I = (1, 2, 3), so the fastest decay is c.
std::string chosen(double c, Formulation formulation = Formulation::reduced, bool user_torque = false) {
    Scene scene;
    scene.name = "test", scene.duration = 10;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 1, 1};
    scene.loads = {Drag{{c, c, c}, 0, {}}};
    if (user_torque) scene.loads.push_back(UserTorque{"none", [](const LoadState&) { return Vector3<double>(); }, {}});
    const Choice choice = choose_method(pose(scene, formulation));
    EXPECT_FALSE(choice.why.empty());
    return std::string(choice.method->name);
}

TEST(ChooseMethod, TakesAnImplicitOneWhereDampingDecaysTenThousandTimes) {
    for (const Formulation formulation : {Formulation::reduced, Formulation::full}) {
        EXPECT_EQ(chosen(1100, formulation), "cvode_bdf");
        EXPECT_EQ(chosen(900, formulation), "odeint_fehlberg78");
    }
    EXPECT_EQ(chosen(1e-3), "odeint_fehlberg78");
    EXPECT_EQ(chosen(0), "exact");
    EXPECT_EQ(chosen(0, Formulation::full), "odeint_fehlberg78");
}

// An implicit method would need the derivative of a user's torque.
TEST(ChooseMethod, LeavesAUsersTorqueToAnExplicitOne) {
    EXPECT_EQ(chosen(1100, Formulation::reduced, true), "odeint_fehlberg78");
}

}  // namespace
}  // namespace polhode
