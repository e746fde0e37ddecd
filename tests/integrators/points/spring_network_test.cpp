// Spring networks: vibration frequencies against closed forms for molecules, and internal consistency.
#include "integrators/points/spring_network.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "integrators/points/point_motion.h"
#include "integrators/points/stiffness.h"
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
    std::vector<double> r = distorted(body), a(r.size());
    for (int i = 0; i < 3 * body.count(); ++i) r.push_back(moderate(-1, 1));  // velocities
    SpringNetwork(body, body.point_mass, 0.3 * body.point_mass).accelerations(r.data(), a.data());
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
    const std::size_t n = static_cast<std::size_t>(3 * body.count());
    std::vector<double> r = distorted(body), above(n), below(n);
    r.resize(2 * n);  // at rest
    const Eigen::MatrixXd J = network.jacobian(r.data());
    // nearly coincident points have a nearly non-differentiable force
    for (const PointLink& link : body.links)
        RC_PRE(distance(vector_at(r.data(), 3 * link.i), vector_at(r.data(), 3 * link.j)) > 0.05 * body.extent);
    const double h = 1e-5 * body.extent;
    for (std::size_t k = 0; k < n; ++k) {
        const double kept = r[k];
        r[k] = kept + h, network.accelerations(r.data(), above.data());
        r[k] = kept - h, network.accelerations(r.data(), below.data());
        r[k] = kept;
        for (std::size_t i = 0; i < n; ++i)
            RC_ASSERT(std::abs((above[i] - below[i]) / (2 * h) - J(static_cast<long>(i), static_cast<long>(k))) <
                      1e-5 * J.cwiseAbs().maxCoeff());
    }
}

/// A rigid motion does not move the dampers. Other motions lose the power of the dampers, c (d'.u)^2 each.
RC_GTEST_PROP(SpringNetwork, LosesEnergyByItsDampersAlone, ()) {
    Scene scene = moderate_scene();
    scene.pivot.reset();
    const PointBody body = point_body(pose(scene), {});
    const int n = body.count();
    std::vector<double> y = distorted(body), with(y.size()), without(y.size());
    for (int i = 0; i < 3 * n; ++i) y.push_back(moderate(-1, 1));
    const double k = 2 * body.point_mass, c = 0.7 * body.point_mass;
    SpringNetwork(body, k, c).accelerations(y.data(), with.data());
    SpringNetwork(body, k).accelerations(y.data(), without.data());
    double power = 0, taken = 0;
    for (int i = 0; i < 3 * n; ++i) power += body.point_mass * (with[i] - without[i]) * y[3 * n + i];
    for (const PointLink& link : body.links) {
        const Vector3<double> d = vector_at(y.data(), 3 * link.i) - vector_at(y.data(), 3 * link.j);
        const double rate =
            dot(d, vector_at(y.data(), 3 * (n + link.i)) - vector_at(y.data(), 3 * (n + link.j))) / length(d);
        taken += c * rate * rate;
    }
    RC_ASSERT(std::abs(power + taken) <= 1e-12 * taken);
    // the derivative with respect to v
    const Eigen::MatrixXd D = SpringNetwork(body, k, c).velocity_jacobian(y.data());
    for (int i = 0; i < 3 * n; ++i) {
        double product = 0;
        for (int j = 0; j < 3 * n; ++j) product += D(i, j) * y[3 * n + j];
        RC_ASSERT(std::abs(with[i] - without[i] - product) < 1e-12 * D.cwiseAbs().maxCoeff());
    }
    const Vector3<double> w = moderate_vector(), v = moderate_vector();
    for (int i = 0; i < n; ++i) put(y.data(), 3 * (n + i), v + cross(w, vector_at(y.data(), 3 * i)));
    SpringNetwork(body, k, c).accelerations(y.data(), with.data());
    for (int i = 0; i < 3 * n; ++i) RC_ASSERT(std::abs(with[i] - without[i]) < 1e-11);
}

/// Settled points in steady rotation about a principal axis keep their distances.
TEST(SpringNetwork, SettlesIntoASteadyRotation) {
    Scene scene = symmetric_body(1);
    scene.initial.angular_velocity = {0, 0, 3};
    const Problem problem = pose(scene);
    const PointBody body = point_body(problem, {});
    const int n = body.count();
    std::vector<double> y(static_cast<std::size_t>(6 * n)), a(static_cast<std::size_t>(3 * n));
    PointMotion motion(problem, body);
    const double k = 1e6;
    const SpringNetwork network(body, k);
    const Vector3<double> w = motion.initial(y.data());
    network.accelerations(y.data(), a.data());
    EXPECT_LT(std::abs(a[0]), 1e-8);  // unstretched: the points do not rotate
    network.apply_rotation_stretch(w, y.data());
    network.accelerations(y.data(), a.data());
    for (int i = 0; i < n; ++i) {
        const Vector3<double> needed = cross(w, cross(w, vector_at(y.data(), 3 * i)));
        // up to the square of the stretch, m w^2 / k
        EXPECT_LT(distance(vector_at(a.data(), 3 * i), needed), 1e-5 * length(needed));
        EXPECT_GT(length(needed), 1.0);
        EXPECT_LT(distance(vector_at(y.data(), 3 * (n + i)), cross(w, vector_at(y.data(), 3 * i))), 1e-15);
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

TEST(DefaultStiffness, MakesTheSlowestVibrationAHundredTimesAsFastAsTheRotation) {
    for (const Scene& scene : {free_body(2), symmetric_body(2), heavy_top(0.5), everything(1)}) {
        const Problem problem = pose(scene);
        const PointBody body = point_body(problem, {});
        EXPECT_NEAR(
            spring_frequencies(body, default_stiffness(problem, body)).slowest / problem.scales.angular_velocity, 100,
            1e-7)
            << scene.name;
    }
}

}  // namespace
}  // namespace polhode
