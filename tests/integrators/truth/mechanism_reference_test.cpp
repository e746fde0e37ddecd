// The truth of several bodies as users call it: impulses in both formulations, energies of joints with many rotations.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/jointed_start.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

TEST(ReferenceOfMechanism, IsStruckByImpulses) {
    const FreshCache cache;
    for (unsigned seed = 0; seed < 2; ++seed) {
        Scene scene = random_tree(seed, 3, seed == 0);
        scene.loads = {Impulse{{1, 2, -3}, Frame::world, {0.5, -0.25, 1}, Frame::body, 0.0625, "b2"}};
        const Reference truth = reference(scene, 2);
        ASSERT_TRUE(truth.available) << truth.message;
        EXPECT_GT(std::abs(truth.system[1].kinetic.high - truth.system[0].kinetic.high), 1e-3);
    }
}

// A disc on a hinge with a spring wound up by 20 rad: k x^2 / 2 counts whole rotations, whatever the sample times.
TEST(ReferenceOfMechanism, HasTheEnergyOfASpringThatIsWoundUp) {
    const FreshCache cache;
    Scene scene;
    scene.name = "spring", scene.duration = 4;
    scene.bodies.resize(1);
    scene.bodies[0].name = "disc", scene.bodies[0].body.inertia_B = diagonal(Vector3<double>(1, 1, 2));
    scene.joints.resize(1);
    Joint& hinge = scene.joints[0];
    hinge.name = "hinge", hinge.type = JointType::revolute, hinge.parent = "world", hinge.child = "disc";
    hinge.axes[0] = {0, 0, 1}, hinge.coordinate[0] = 20, hinge.stiffness[0] = 2;
    const Reference truth = reference(scene, 2);
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_EQ(truth.system.size(), 3U);
    for (const ReferenceSystem& system : truth.system) EXPECT_NEAR(system.energy.high, 400, 1e-12) << system.t;
    // x = 20 cos t
    EXPECT_NEAR(truth.system[1].kinetic.high, 400 * std::pow(std::sin(2), 2), 1e-12);
}

}  // namespace
}  // namespace polhode
