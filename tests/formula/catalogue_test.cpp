// Formula scenes of the catalogue against closed forms and published results.
#include "catalogue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "formula/formula_scene.h"

namespace polhode {
namespace {

TEST(FormulaCatalogue, HasAReferenceForEveryScene) {
    const std::vector<std::string> names = scenes_in("formulas");
    EXPECT_GE(names.size(), 8u);
    for (const std::string& name : names) {
        const Reference truth = reference(find_scene(name), 4, 22);
        EXPECT_TRUE(truth.available) << name << ": " << truth.message;
        EXPECT_LT(truth.bound, 1e-22) << name;
    }
}

// The orbit of the binary64 data against Kepler's equation in long double.
TEST(FormulaCatalogue, FollowsTheKeplerOrbit) {
    const Scene scene = find_scene("formulas/kepler_orbit");
    const Reference truth = reference(scene, 12, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const long double mu = scene.parameters.at(0).value, r0 = 7e6L, v0 = scene.initial.velocity_W[1];
    const long double a = 1 / (2 / r0 - v0 * v0 / mu), e = 1 - r0 / a, n = std::sqrt(mu / (a * a * a));
    EXPECT_NEAR(static_cast<double>(e), 0.3, 1e-12);
    for (const ReferenceSample& sample : truth.samples) {
        long double E = n * sample.t;
        for (int k = 0; k < 60; ++k) E -= (E - e * std::sin(E) - n * sample.t) / (1 - e * std::cos(E));
        EXPECT_NEAR(sample.position_W[0].high, static_cast<double>(a * (std::cos(E) - e)), 1e-6);
        EXPECT_NEAR(sample.position_W[1].high, static_cast<double>(a * std::sqrt(1 - e * e) * std::sin(E)), 1e-6);
    }
}

// Pitch libration on a circular orbit: 2 pi / (n sqrt(3 k)), k = (I_y - I_x) / I_z, times the factor of a pendulum of
// amplitude 2 theta_0 with theta'' = -3/2 n^2 k sin 2 theta: 2 K(sin theta_0) / pi.
TEST(FormulaCatalogue, LibratesWithThePeriodOfThePendulum) {
    Scene scene = find_scene("formulas/gravity_gradient");
    const double n = scene.initial.angular_velocity[2], k = 0.9, amplitude = 0.1;
    const double period =
        2 * std::numbers::pi / (n * std::sqrt(3 * k)) * 2 / std::numbers::pi * std::comp_ellint_1(std::sin(amplitude));
    scene.duration = 2 * period;
    const Trajectory motion = test::solve_with(scene, "taylor", 1e-15, 2);
    ASSERT_EQ(motion.status, Status::ok) << motion.message;
    for (const Sample& sample : motion.samples) {
        const double attitude = 2 * std::atan2(sample.q.z, sample.q.w);
        const double place = std::atan2(sample.position_W[1], sample.position_W[0]);
        const double pitch = std::remainder(attitude - place, 2 * std::numbers::pi);
        // the satellite returns to its largest angle after each period; the orbit is circular to 1e-9
        EXPECT_NEAR(pitch, amplitude, 1e-8) << sample.t;
    }
}

// Librations of a thin rod on a circular orbit in and across the orbital plane. JEOD, RUN_10C, prints the periods
// 3257.94 s and 2821.46 s, which are T / sqrt 3 and T / 2 of an orbit of T = 5642.92 s.
TEST(FormulaCatalogue, LibratesWithThePeriodsOfJeod) {
    constexpr double amplitude = 1e-3, mu = 3.986004418e14;
    const double n = 2 * std::numbers::pi / 5642.92, r = std::cbrt(mu / (n * n));
    for (const bool in_plane : {true, false}) {
        Scene scene = find_scene("formulas/gravity_gradient");
        scene.body.inertia_B = diagonal(Vector3<double>(1e-7, 1, 1));
        scene.initial.position_W = {r, 0, 0};
        scene.initial.velocity_W = {0, n * r, 0};
        const double c = std::cos(amplitude / 2), s = std::sin(amplitude / 2);
        scene.initial.orientation = in_plane ? Quaternion<double>{c, 0, 0, s} : Quaternion<double>{c, 0, s, 0};
        scene.initial.angular_velocity = {0, 0, n};
        scene.initial.angular_velocity_frame = Frame::world;
        scene.duration = 3000;
        const Trajectory motion = test::solve_with(scene, "taylor", 1e-14, 3000);
        ASSERT_EQ(motion.status, Status::ok) << motion.message;
        std::vector<double> zeros;
        double before = amplitude;
        for (const Sample& sample : motion.samples) {
            const Vector3<double> axis = rotate(sample.q, Vector3<double>(1, 0, 0));
            const double place = std::atan2(sample.position_W[1], sample.position_W[0]);
            const double angle =
                in_plane ? std::remainder(std::atan2(axis[1], axis[0]) - place, 2 * std::numbers::pi) : -axis[2];
            const double step = scene.duration / 3000;
            if ((angle > 0) != (before > 0)) zeros.push_back(sample.t - step * angle / (angle - before));
            before = angle;
        }
        ASSERT_EQ(zeros.size(), 2u);
        EXPECT_NEAR(2 * (zeros[1] - zeros[0]), in_plane ? 3257.94 : 2821.46, 0.005) << in_plane;
    }
}

TEST(FormulaCatalogue, ReachesTerminalSpeed) {
    const Scene scene = find_scene("formulas/quadratic_drag");
    const double g = 9.80665, terminal = std::sqrt(scene.body.mass * g / 0.01);
    const Reference truth = reference(scene, 10, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    for (const ReferenceSample& sample : truth.samples)
        EXPECT_NEAR(sample.velocity_W[2].high,
                    -terminal * std::tanh(g * sample.t / terminal + std::atanh(1 / terminal)), 1e-13);
}

// The torque -k |B|^2 of the rate perpendicular to the field only removes energy.
TEST(FormulaCatalogue, DetumblesMonotonically) {
    const Reference truth = reference(find_scene("formulas/detumbling"), 60, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t i = 1; i < truth.samples.size(); ++i)
        EXPECT_LT(truth.samples[i].energy.high, truth.samples[i - 1].energy.high);
    EXPECT_LT(truth.samples.back().energy.high, 0.02 * truth.samples.front().energy.high);
}

// Methods that step over switching points lose their order: RK4 at the saturated regulator, against its order 4 where
// the torque is not limited.
TEST(FormulaCatalogue, SteppingOverSwitchesCostsTheOrder) {
    Scene scene = find_scene("formulas/saturated_regulator");
    scene.duration = 100;
    const auto errors = [&](const Scene& one) {
        const Reference truth = reference(one, 1, 20);
        std::vector<double> all;
        for (const double step : {0.1, 0.05, 0.025}) {
            Settings settings;
            settings.step = step, settings.samples = 1;
            const Trajectory run = solve(pose(one), *find_method("odeint_rk4"), settings);
            const Quaternion<double> between = conjugate(truth.samples.back().rounded().q) * run.samples.back().q;
            all.push_back(std::sqrt(dot(vector_part(between), vector_part(between))));
        }
        return all;
    };
    const std::vector<double> limited = errors(scene);
    for (FormulaParameter& parameter : scene.parameters)
        if (parameter.name == "limit") parameter.value = 1e3;
    const std::vector<double> smooth = errors(scene);
    EXPECT_NEAR(std::log2(smooth[0] / smooth[2]) / 2, 4, 0.3);
    EXPECT_LT(std::log2(limited[0] / limited[2]) / 2, 3);
    EXPECT_GT(limited[2], 1000 * smooth[2]);
}

// I x'' = k (1 - x) - c x' with I = 0.5, k = 8, c = 2: x = 1 - e^(-2 t) (cos b t + 2/b sin b t), b^2 = 12
TEST(FormulaCatalogue, RotatesTheFlywheelToItsTarget) {
    const Trajectory motion = test::solve_with(find_scene("formulas/flywheel_servo"), "taylor", 1e-15, 20);
    ASSERT_EQ(motion.status, Status::ok) << motion.message;
    const double b = std::sqrt(12.0);
    for (const Sample& sample : motion.samples) {
        const double x = 1 - std::exp(-2 * sample.t) * (std::cos(b * sample.t) + 2 / b * std::sin(b * sample.t));
        EXPECT_NEAR(2 * std::atan2(sample.q.z, sample.q.w), x, 1e-14);
    }
}

TEST(FormulaCatalogue, SwingsFurutasPendulumUp) {
    const Trajectory motion = test::solve_with(find_scene("formulas/furuta_swing_up"), "taylor", 1e-14, 60);
    ASSERT_EQ(motion.status, Status::ok) << motion.message;
    // the cosine of the bar's angle from its lowest position
    const auto height = [&](std::size_t i) { return rotate(motion.samples[2 * i + 1].q, Vector3<double>(0, 0, 1))[2]; };
    EXPECT_NEAR(height(0), std::cos(0.25), 1e-15);
    EXPECT_GT(height(20), -0.9);
    EXPECT_LT(height(60), -0.9999);
}

}  // namespace
}  // namespace polhode
