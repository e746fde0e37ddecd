#include "motion/finer_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/problem.h"

namespace polhode {
namespace {

// A body of 1 kg, nearly a point, with its centre of mass at `arm` from the pivot at the origin.
Scene nearly_a_point(double size, const Vector3<double>& arm) {
    Scene scene;
    scene.name = "nearly a point", scene.duration = 1;
    scene.body.mass = 1, scene.body.center_of_mass = arm;
    scene.body.inertia_B = diagonal(Vector3<double>(1 * size, 1.2 * size, 1.5 * size));
    scene.pivot = Vector3<double>();
    scene.initial.angular_velocity = {1, 2, 0.5};
    return scene;
}

// The moment about the line from the pivot to the centre of mass is n.In up to I^2/(m a^2), although the arm adds far
// larger terms to the other moments.
TEST(FinerFrame, KeepsAMomentThatIsNothingBesideTheArms) {
    const Vector3<double> arm(0.3, 0.4, 0.5), n = (1 / length(arm)) * arm;
    for (const double size : {1e-12, 1e-20, 1e-28}) {
        const Scene scene = nearly_a_point(size, arm);
        const double right = dot(n, scene.body.inertia_B * n);
        const Problem problem = pose(scene);
        const Vector3<double>& I = problem.body.principal.moments;
        const int least = I[0] < I[1] ? (I[0] < I[2] ? 0 : 2) : (I[1] < I[2] ? 1 : 2);
        EXPECT_NEAR(I[least] / right, 1, 10 * size + 1e-15) << size;
        EXPECT_NEAR(problem.body.principal.inverse_moments[least] * right, 1, 10 * size + 1e-15) << size;
        // the component of w along n agrees with the scene, along the frame's unit vector of the least moment
        const double along = std::abs(problem.body.initial_angular_velocity[least]);
        EXPECT_NEAR(along, std::abs(dot(n, scene.initial.angular_velocity)), 10 * size + 1e-14) << size;
    }
}

// (I1 - I2)/I3 is accurate although the arm's contribution hides the difference of I1 and I2 in binary64.
TEST(FinerFrame, KeepsADifferenceThatTheMomentsDoNotShow) {
    for (const double size : {1e-12, 1e-20, 1e-28}) {
        const Problem problem = pose(nearly_a_point(size, {0, 0, 0.5}));
        EXPECT_NEAR(problem.body.principal.gyroscopic[2], -0.2 / 1.5, 1e-15) << size;
        EXPECT_NEAR(problem.body.principal.gyroscopic[0], 1, 10 * size + 1e-15) << size;
        EXPECT_EQ(problem.needs.symmetry, Symmetry::asymmetric) << size;
    }
}

TEST(FinerFrame, IsForNoOrdinaryBody) {
    const auto needed = [](const Scene& scene, bool moved) {
        const Problem problem = pose(scene);
        return needs_finer_frame(cast<Wide>(problem.body.inertia_B), moved, problem.body.principal.moments);
    };
    EXPECT_FALSE(needed(nearly_a_point(1, {0.3, 0.4, 0.5}), true));
    EXPECT_TRUE(needed(nearly_a_point(1e-20, {0.3, 0.4, 0.5}), true));
    // a needle in its principal axes needs no finer frame
    Scene needle = nearly_a_point(1, {});
    needle.body.inertia_B = diagonal(Vector3<double>(1e-40, 1, 1));
    EXPECT_FALSE(needed(needle, false));
}

}  // namespace
}  // namespace polhode
