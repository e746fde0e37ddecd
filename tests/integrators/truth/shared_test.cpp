#include "integrators/truth/shared.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "scene/body_source.h"
#include "scene/scene_file.h"

namespace polhode::truth {
namespace {

// A body of 1 kg, nearly a point, away from its pivot.
Scene nearly_a_point(double size) {
    Scene scene;
    scene.name = "nearly a point", scene.duration = 2;
    scene.body.mass = 1, scene.body.center_of_mass = {0.3, 0.4, 0.5};
    scene.body.inertia_B = diagonal(Vector3<double>(1 * size, 1.2 * size, 1.5 * size));
    scene.pivot = Vector3<double>();
    scene.initial.angular_velocity = {1, 2, 0.5};
    return scene;
}

TEST(SharedRounding, IsNoneOfOrdinaryScenes) {
    for (const char* name : {"free_asymmetric", "box_with_sphere", "mechanisms/arm6"})
        EXPECT_EQ(shared_rounding<50>(find_scene(name)), 0) << name;
}

// A tensor of 10^-n kg m^2 is added to one of about 1 kg m^2: n digits are lost.
TEST(SharedRounding, IsWhatTheShiftToAPivotLoses) {
    for (const double n : {20, 30, 40}) {
        const Scene scene = nearly_a_point(std::pow(10.0, -n));
        EXPECT_NEAR(std::log10(shared_rounding<50>(scene)), n - 51, 2) << n;
        EXPECT_NEAR(std::log10(shared_rounding<100>(scene)), n - 101, 2) << n;
    }
    EXPECT_GT(shared_rounding<50>(nearly_a_point(1e-55)), 0.01);
}

// The thinnest shell in binary64: its mass and tensor are differences of nearly equal numbers.
TEST(SharedRounding, IsWhatAHoleLoses) {
    const auto ball = [](double radius, double sign) {
        return body_source(ShapedBody{SolidSphere{radius}, {sign, true}});
    };
    const double inner = std::nextafter(1.0, 0.0);
    Scene shell = nearly_a_point(1);
    shell.pivot.reset();
    shell.body = body_of(body_source(PartsBody{{{ball(1, 1), {}, {}}, {ball(inner, -1), {}, {}}}}));
    const double lost = shared_rounding<50>(shell);
    EXPECT_GT(lost, 1e-38);
    EXPECT_LT(lost, 1e-32);
    Scene two = find_scene("mechanisms/arm6");
    two.bodies[0].body = shell.body;
    EXPECT_GT(shared_rounding<50>(two), 1e-38);
}

TEST(SharedRounding, CountsWithTheGrowthThatTheStepsErrorsShow) {
    EXPECT_EQ(shared_error(0, 100, 1e-20, 50, 33), 0);
    EXPECT_DOUBLE_EQ(shared_error(1e-40, 9, 0, 50, 33), 1e-38);
    // the steps' errors have grown from 1e-33 to 1e-27
    EXPECT_NEAR(shared_error(1e-40, 9, 1e-27, 50, 33) / 1e-33, 1, 1e-9);
}

TEST(SharedRounding, RaisesThePrecisionOfATruth) {
    const FreshCache cache;
    const Scene scene = nearly_a_point(1e-29);
    const Reference found = reference(scene, 1);
    ASSERT_TRUE(found.available) << found.message;
    EXPECT_NE(found.message.find("100 digits"), std::string::npos) << found.message;
    EXPECT_LE(found.bound, 1e-25);
}

}  // namespace
}  // namespace polhode::truth
