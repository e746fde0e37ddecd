// Springs between points: against the vibrations of molecules in closed form, and against themselves.
#include "integrators/points/spring_network.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "integrators/scenes.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

std::vector<double> distorted(const PointBody& body) {
    std::vector<double> r(static_cast<std::size_t>(3 * body.count()));
    for (int i = 0; i < body.count(); ++i)
        put(r.data(), 3 * i, body.rest_B[i] + (0.2 * body.extent) * moderate_vector());
    return r;
}

RC_GTEST_PROP(SpringNetwork, PullsAndTurnsNothingAsAWhole, ()) {
    Scene scene = moderate_scene();
    scene.pivot.reset();
    const PointBody body = point_body(pose(scene), {Arrangement::Kind::box, *rc::gen::inRange(2, 4)});
    const std::vector<double> r = distorted(body);
    std::vector<double> a(r.size());
    SpringNetwork(body, body.point_mass).accelerations(r.data(), a.data());
    Vector3<double> force, torque;
    double size = 0;
    for (int i = 0; i < body.count(); ++i) {
        const Vector3<double> f = vector_at(a.data(), 3 * i);
        force = force + f;
        torque = torque + cross(vector_at(r.data(), 3 * i), f);
        size += length(f);
    }
    RC_ASSERT(length(force) < 1e-14 * size);
    RC_ASSERT(length(torque) < 1e-14 * size * 3 * body.extent);
}

RC_GTEST_PROP(SpringNetwork, HasTheJacobianOfItsForces, ()) {
    const PointBody body = point_body(pose(moderate_scene()), {Arrangement::Kind::simplex});
    const SpringNetwork network(body, body.point_mass);
    std::vector<double> r = distorted(body), above(r.size()), below(r.size());
    const Eigen::MatrixXd J = network.jacobian(r.data());
    // points that (nearly) coincide have a force with (nearly) a corner
    for (const Link& link : body.links)
        RC_PRE(distance(vector_at(r.data(), 3 * link.i), vector_at(r.data(), 3 * link.j)) > 0.05 * body.extent);
    const double h = 1e-5 * body.extent;
    for (std::size_t k = 0; k < r.size(); ++k) {
        const double kept = r[k];
        r[k] = kept + h, network.accelerations(r.data(), above.data());
        r[k] = kept - h, network.accelerations(r.data(), below.data());
        r[k] = kept;
        for (std::size_t i = 0; i < r.size(); ++i)
            RC_ASSERT(std::abs((above[i] - below[i]) / (2 * h) - J(static_cast<long>(i), static_cast<long>(k))) <
                      1e-5 * J.cwiseAbs().maxCoeff());
    }
}

/// Molecules X4 and X3 with equal springs: k/m, 2 k/m, 4 k/m and 3/2 k/m, 3 k/m (G. Herzberg 1945, Infrared and Raman
/// Spectra of Polyatomic Molecules, section II 4).
TEST(SpringFrequencies, AreThoseOfATetrahedronAndATriangle) {
    Scene scene;
    scene.name = "molecule", scene.duration = 1;
    scene.body.mass = 2;
    scene.body.inertia_B = diagonal(Vector3<double>(3, 3, 3));
    const PointBody tetrahedron = point_body(pose(scene), {Arrangement::Kind::simplex});
    ASSERT_EQ(tetrahedron.count(), 4);
    SpringFrequencies found = spring_frequencies(tetrahedron, 7);
    EXPECT_NEAR(found.slowest, std::sqrt(7 / 0.5), 1e-13);
    EXPECT_NEAR(found.fastest, std::sqrt(4 * 7 / 0.5), 1e-13);
    scene.body.inertia_B = diagonal(Vector3<double>(3, 6, 3));
    const PointBody triangle = point_body(pose(scene), {});
    ASSERT_EQ(triangle.count(), 3);
    found = spring_frequencies(triangle, 5);
    EXPECT_NEAR(found.slowest, std::sqrt(1.5 * 5 / (2.0 / 3)), 1e-13);
    EXPECT_NEAR(found.fastest, std::sqrt(3 * 5 / (2.0 / 3)), 1e-13);
}

TEST(DefaultStiffness, MakesTheSlowestVibrationAThousandTimesAsFastAsTheRotation) {
    for (const Scene& scene : {free_body(2), symmetric_body(2), heavy_top(0.5), everything(1)}) {
        const Problem problem = pose(scene);
        const PointBody body = point_body(problem, {});
        EXPECT_NEAR(spring_frequencies(body, default_stiffness(problem, body)).slowest /
                        problem.scales.angular_velocity,
                    1e3, 1e-6)
            << scene.name;
    }
}

}  // namespace
}  // namespace polhode
