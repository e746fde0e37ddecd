// Penalty contact as stiff ODEs against closed forms, and against the motion of rigid bodies as the stiffness grows.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "contact_cases.h"
#include "integrators/contact_stepping/penalty_model.h"

namespace polhode {
namespace {

using namespace polhode::testing;

class PenaltyOde : public ::testing::TestWithParam<const char*> {
  protected:
    static bool is_linear() { return std::string(GetParam()).find("spring") != std::string::npos; }
    static Sample end_of(const Scene& scene, double tolerance) {
        const Trajectory run = with_tolerance(scene, GetParam(), tolerance);
        EXPECT_EQ(run.status, Status::ok) << run.message;
        return run.samples.empty() ? Sample{} : run.samples.back();
    }
    /// The slope of log error over log R between 1e-4 and 1e-7.
    template <class Error>
    static double order_in_softness(const Error& error) {
        return std::log10(error(1e-4) / error(1e-7)) / 3;
    }
};

/// Without other forces both laws return a ball with the restitution e, also where e is small. Measured: 4e-6.
TEST_P(PenaltyOde, ReboundsWithTheRestitution) {
    for (const double e : {0.1, 0.5, 0.8, 1.0}) {
        Scene scene = on_floor(SolidSphere{0.1}, 0.101, e, 0);
        scene.duration = 0.02, scene.loads.clear();
        scene.initial.velocity_W = {0, 0, -1};
        EXPECT_NEAR(end_of(scene, 1e-6).velocity_W[2], e, 1e-4) << e;
    }
}

/// A ball on the floor sinks until the spring carries it: R r, or R^(2/3) r.
TEST_P(PenaltyOde, SinksUnderItsWeight) {
    constexpr double r = 0.1, R = 1e-3;
    const double depth = r - end_of(on_floor(SolidSphere{r}, r, 0, 0.3), R).position_W[2];
    EXPECT_NEAR(depth / (is_linear() ? R * r : std::cbrt(R * R) * r), 1, 1e-3);
}

/// A ball slides, then rolls: the depth and the slip speed vanish with 1/k, Hunt and Crossley's depth with k^(-2/3).
TEST_P(PenaltyOde, ConvergesToTheRollingBall) {
    constexpr double u = 3, friction = 0.2, r = 0.1;
    const Scene scene = bowling_ball(u, friction);
    const double x = bowled_distance(u, friction, 1);
    const double order = order_in_softness([&](double tolerance) {
        const Vector3<double> p = end_of(scene, tolerance).position_W;
        return std::hypot(p[0] - x, p[2] - r);
    });
    EXPECT_NEAR(order, is_linear() ? 1 : 2.0 / 3, 0.05);
}

/// A ball bounces once: the duration of an impact is k^(-1/2), by Hunt and Crossley k^(-2/5).
TEST_P(PenaltyOde, ConvergesToTheBouncingBall) {
    constexpr double e = 0.8, drop = 0.5;
    Scene scene = on_floor(SolidSphere{0.1}, 0.1 + drop, e, 0.3);
    const double first = std::sqrt(2 * drop / contact_g), speed = e * contact_g * first, after = 0.1;
    scene.duration = first + after;
    const double height = 0.1 + speed * after - contact_g * after * after / 2;
    const double order =
        order_in_softness([&](double tolerance) { return std::abs(end_of(scene, tolerance).position_W[2] - height); });
    EXPECT_NEAR(order, is_linear() ? 0.5 : 0.4, 0.03);
}

/// A block that should stick creeps by v_s |F| / (mu N) / (1 - (F / (mu N))^2)^(1/2), v_s = R (g L)^(1/2).
TEST_P(PenaltyOde, CreepsWhereItShouldStick) {
    constexpr double angle = 0.3, friction = 0.5, R = 1e-5;
    const Sample end = end_of(on_ramp(Box{{0.2, 0.15, 0.05}}, 0.05, angle, friction), R);
    const double ratio = std::tan(angle) / friction, reach = std::sqrt(0.2 * 0.2 + 0.15 * 0.15 + 0.05 * 0.05);
    const double creep = R * std::sqrt(9.81 * reach) * ratio / std::sqrt(1 - ratio * ratio);
    EXPECT_NEAR(end.velocity_W[0] / creep, 1, 0.01);
}

/// A free body is not affected: the same motion as without planes.
TEST_P(PenaltyOde, LeavesAFreeBodyAlone) {
    Scene scene = on_floor(Box{{0.2, 0.15, 0.05}}, 50, 0.5, 0.3);
    scene.initial.angular_velocity = {1, 5, 0.2};
    const Sample with = end_of(scene, 1e-8);
    scene.planes.clear();
    const Sample without = with_tolerance(scene, "radau", 1e-12).samples.back();
    EXPECT_LT(length(with.position_W - without.position_W), 1e-9);
    EXPECT_LT(length(with.angular_velocity_B - without.angular_velocity_B), 1e-8);
}

TEST_P(PenaltyOde, RefusesFrictionTorques) {
    Scene scene = on_floor(SolidSphere{0.1}, 0.1, 0, 0.3);
    scene.planes[0].torsional_friction = 0.01;
    const Trajectory run = with_tolerance(scene, GetParam(), 1e-6);
    EXPECT_EQ(run.status, Status::unsupported);
    EXPECT_NE(run.message.find("torsional"), std::string::npos) << run.message;
}

INSTANTIATE_TEST_SUITE_P(Of, PenaltyOde,
                         ::testing::Values("penalty_spring_damper_radau", "penalty_spring_damper_bdf",
                                           "penalty_hunt_crossley_radau", "penalty_hunt_crossley_bdf"),
                         [](const auto& of) { return std::string(of.param); });

/// The damping of a given restitution inverts the closed forms, also near 0 and 1.
TEST(PenaltyDamping, InvertsTheRestitution) {
    for (const double e : {0.001, 0.1, std::exp(-2.0), 0.5, 0.9, 0.9999}) {
        // near zeta = 1 the closed form has a quotient of small numbers
        EXPECT_NEAR(contact_stepping::spring_restitution(contact_stepping::damping_ratio(e)), e, 1e-10);
        const double d = contact_stepping::hunt_crossley_damping(e), left = 1 - e * d;
        // 1 - e d, about exp(-1/e), is rounded to a multiple of 1e-16
        if (left > 1e-6)
            EXPECT_NEAR(d * (1 + e), std::log((1 + d) / left), 1e-8 * (1 + d));
        else
            EXPECT_NEAR(d * e, 1, 1e-14);
    }
    EXPECT_EQ(contact_stepping::damping_ratio(1), 0);
    EXPECT_EQ(contact_stepping::hunt_crossley_damping(1), 0);
}

}  // namespace
}  // namespace polhode
