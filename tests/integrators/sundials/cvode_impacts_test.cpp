// Impacts on planes: located as events, at the end of a step, by halving the step, and in multiprecision.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/scenes.h"
#include "integrators/truth/reference.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr double falling_g = 9.80665;

double length(const Vector3<double>& v) { return std::hypot(v[0], v[1], v[2]); }

Scene falling(const Shape& shape, double height, double restitution) {
    Scene scene;
    scene.name = "falling", scene.duration = 2;
    scene.body = body_of(body_source(ShapedBody{shape, {2, false}}));
    scene.initial.position_W = {0, 0, height};
    scene.loads = {Gravity{{0, 0, -falling_g}, {}}};
    scene.planes = {{{0, 0, 1}, 0, restitution, 0}};
    return scene;
}

/// A fall from 1 m: first contact at sqrt(2/g), then after flights of 2 e^k sqrt(2/g).
Scene bouncing(double restitution, double duration) {
    Scene scene = falling(SolidSphere{0.25}, 1.25, restitution);
    scene.duration = duration;
    return scene;
}
std::vector<double> bounce_times(double restitution, double duration) {
    std::vector<double> times;
    const double first = std::sqrt(2 / falling_g);
    for (double t = first, flight = 2 * restitution * first; t < duration; t += flight, flight *= restitution)
        times.push_back(t);
    return times;
}
double height_of_ball(double restitution, double t) {
    double from = 0;
    for (double time : bounce_times(restitution, t)) from = time;
    if (from == 0) return 1.25 - falling_g * t * t / 2;
    const auto bounces = static_cast<double>(bounce_times(restitution, t).size());
    const double up = std::pow(restitution, bounces) * std::sqrt(2 * falling_g), after = t - from;
    return 0.25 + up * after - falling_g * after * after / 2;
}

Trajectory by_impacts(const Scene& scene, double tolerance, long samples = 100) {
    Settings settings;
    settings.tolerance = tolerance, settings.samples = samples;
    return solve(scene, *find_method("cvode_impacts"), settings);
}
Trajectory by_steps(const Scene& scene, const char* name, double step) {
    Settings settings;
    settings.step = step, settings.samples = 100;
    return solve(scene, *find_method(name), settings);
}

double energy_of(const Scene& scene, const Sample& s) {
    return invariants(scene, exact_body<double>(scene), s.t, normalized(s.q), s.angular_velocity_B, s.position_W,
                      s.velocity_W)
        .energy;
}

double largest_late(const std::vector<double>& found, const std::vector<double>& expected) {
    EXPECT_EQ(found.size(), expected.size());
    double late = 0;
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
        late = std::max(late, std::abs(found[i] - expected[i]));
    return late;
}

TEST(CvodeImpacts, OfABallAreAGeometricSequence) {
    for (double e : {0.5, 0.8, 1.0})
        for (double tolerance : {1e-6, 1e-10}) {
            const double T = e == 0.5 ? 1.35 : 2;
            const Trajectory run = by_impacts(bouncing(e, T), tolerance);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            // the time error grows as dp / v with every slower bounce
            const double loss = e == 0.5 ? 3000 : 100;
            EXPECT_LT(largest_late(run.impact_times, bounce_times(e, T)), loss * tolerance);
            for (const Sample& s : run.samples) EXPECT_NEAR(s.position_W[2], height_of_ball(e, s.t), 100 * tolerance);
        }
}

/// The corner of a rotating, falling box that hits first, and the motion after the impact, computed by hand.
TEST(CvodeImpacts, OfATurningBoxStartWhereTheCornerComesDown) {
    Scene scene = falling(Box{{0.1, 0.2, 0.3}}, 1, 1);
    scene.initial.angular_velocity = {2, 0, 0};
    scene.duration = 0.5;
    // at the angle a = 2 t the lowest corner is 0.3 cos a + 0.2 sin a below the centre
    const auto height = [](double t) {
        return 1 - falling_g * t * t / 2 - 0.3 * std::cos(2 * t) - 0.2 * std::sin(2 * t);
    };
    double low = 0.1, high = 0.5;
    for (int i = 0; i < 60; ++i) (height((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
    const Trajectory run = by_impacts(scene, 1e-11, 1000);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    ASSERT_EQ(run.impact_times.size(), 1U) << run.message;
    EXPECT_NEAR(run.impact_times[0], low, 1e-10);
    // planar motion: an edge parallel to x hits the floor, r = (0, y, -h); j = 2 u / (1/m + y^2/I), e = 1
    const double t = low, y = 0.3 * std::sin(2 * t) - 0.2 * std::cos(2 * t), I = 2.0 / 3 * (0.04 + 0.09);
    const double u = -(-falling_g * t + 2 * y), j = 2 * u / (1 / 2.0 + y * y / I);
    const Sample& last = run.samples.back();
    EXPECT_NEAR(last.velocity_W[2], -falling_g * 0.5 + j / 2, 1e-8);
    EXPECT_NEAR(last.angular_velocity_B[0], 2 + y * j / I, 1e-8);
    EXPECT_NEAR(last.angular_velocity_B[1], 0, 1e-9);
}

TEST(CvodeImpacts, OfABoxThatLandsFlatAreFlat) {
    const Trajectory run = by_impacts(falling(Box{{0.1, 0.2, 0.3}}, 1.3, 1), 1e-10);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_LT(largest_late(run.impact_times, bounce_times(1, 2)), 1e-8);
    for (const Sample& s : run.samples) EXPECT_LT(length(s.angular_velocity_B), 1e-9);
}

/// A long, fast-spinning rod near the floor penetrates it for less than one step.
TEST(CvodeImpacts, SeesADipWithinAStep) {
    Scene scene;
    scene.name = "spinning rod", scene.duration = 20;
    // a capsule: spherical ends of radius 0.1 m, 0.9 m from the centre
    scene.body = body_of(body_source(ShapedBody{Capsule{0.1, 0.9}, {1, false}}));
    scene.initial.angular_velocity = {1, 0, 0};
    scene.initial.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // the axis is horizontal
    scene.initial.position_W = {0, 0, 0.99999};                          // it would reach 1e-5 m below the floor
    scene.planes = {{{0, 0, 1}, 0, 1, 0}};
    for (double tolerance : {1e-3, 1e-6}) {
        const Trajectory run = by_impacts(scene, tolerance);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        ASSERT_FALSE(run.impact_times.empty());
        EXPECT_NEAR(run.impact_times[0], std::acos(1.0) + M_PI / 2 - std::acos(0.89999 / 0.9), 20 * tolerance);
    }
}

TEST(CvodeImpacts, KeepEnergyAndTheMomentaAlongTheFloor) {
    Scene scene = falling(Box{{0.1, 0.2, 0.3}}, 1, 1);
    scene.initial.angular_velocity = {1, 4, 2};
    scene.initial.velocity_W = {0.3, -0.2, 0};
    const Trajectory run = by_impacts(scene, 1e-11);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_GT(run.impact_times.size(), 2U);
    const auto L_z = [&](const Sample& s) {
        return rotate(normalized(s.q), exact_body<double>(scene).inertia_B * s.angular_velocity_B)[2];
    };
    for (const Sample& s : run.samples) {
        EXPECT_NEAR(energy_of(scene, s), energy_of(scene, run.samples[0]), 1e-7);
        EXPECT_NEAR(s.velocity_W[0], 0.3, 1e-12);
        EXPECT_NEAR(s.velocity_W[1], -0.2, 1e-12);
        EXPECT_NEAR(L_z(s), L_z(run.samples[0]), 1e-8);
    }
}

TEST(CvodeImpacts, WithFrictionTakeTheSlipAndNeverAddEnergy) {
    Scene scene = bouncing(0.5, 1);
    scene.initial.velocity_W = {3, 0, 0};
    scene.planes[0].friction = 0.1;
    // first impact: J_n = 1.5 m sqrt(2 g), and friction takes 0.1 J_n / m from 3 m/s; the second would take half as
    // much, more than is left until rolling at 5/7 of 3 m/s
    const Trajectory run = by_impacts(scene, 1e-10);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    EXPECT_NEAR(run.samples[60].velocity_W[0], 3 - 0.15 * std::sqrt(2 * falling_g), 1e-8);
    EXPECT_NEAR(run.samples.back().velocity_W[0], 3 * 5.0 / 7, 1e-8);
    EXPECT_NEAR(rotate(run.samples.back().q, run.samples.back().angular_velocity_B)[1], 3 * 5.0 / 7 / 0.25, 1e-7);
    for (std::size_t i = 1; i < run.samples.size(); ++i)
        EXPECT_LE(energy_of(scene, run.samples[i]), energy_of(scene, run.samples[i - 1]) + 1e-9);
}

/// Rest and accumulating impacts (Zeno) are reported with time and number.
TEST(CvodeImpacts, ThatAccumulateEndInFailedByName) {
    const Trajectory zeno = by_impacts(bouncing(0.5, 2), 1e-8);
    EXPECT_EQ(zeno.status, Status::failed);
    EXPECT_NE(zeno.message.find("comes to rest"), std::string::npos) << zeno.message;
    EXPECT_NE(zeno.message.find("impacts up to t = 1.354"), std::string::npos) << zeno.message;
    EXPECT_FALSE(zeno.samples.empty());
    const Trajectory dead = by_impacts(bouncing(0, 2), 1e-8);
    EXPECT_EQ(dead.status, Status::failed);
    EXPECT_NE(dead.message.find("1 impact up to t = 0.4516"), std::string::npos) << dead.message;
    // on the floor from the start
    const Trajectory resting = by_impacts(falling(SolidSphere{0.25}, 0.25, 0.5), 1e-8);
    EXPECT_EQ(resting.status, Status::failed);
    EXPECT_NE(resting.message.find("comes to rest"), std::string::npos) << resting.message;
    // a box that comes to rest after many impacts
    Scene box = falling(Box{{0.1, 0.2, 0.3}}, 0.5, 0.3);
    box.initial.angular_velocity = {1, 2, 0.5};
    box.duration = 10;
    const Trajectory rattling = by_impacts(box, 1e-6);
    EXPECT_EQ(rattling.status, Status::failed);
    EXPECT_NE(rattling.message.find("impacts up to t ="), std::string::npos) << rattling.message;
}

TEST(CvodeImpacts, BetweenTwoWallsAreEvenlySpaced) {
    Scene scene = falling(SolidSphere{0.5}, 0, 1);
    scene.loads.clear();
    scene.duration = 10.2;
    scene.initial.velocity_W = {2, 0, 0};
    scene.planes = {{{-1, 0, 0}, -1.5, 1, 0}, {{1, 0, 0}, -1.5, 1, 0}};  // |x| <= 1 for the centre
    const Trajectory run = by_impacts(scene, 1e-10);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    std::vector<double> expected;
    for (int k = 0; k < 10; ++k) expected.push_back(0.5 + k);
    EXPECT_LT(largest_late(run.impact_times, expected), 1e-9);
}

TEST(Planes, AreUnsupportedByMethodsThatKnowNone) {
    const Problem elastic = pose(bouncing(1, 0.1));
    for (const Method* method : methods()) {
        // some support only inelastic impacts
        const bool bounces = !method->planes || refusal(*method, elastic).empty();
        const Trajectory run = solve(bouncing(bounces ? 1 : 0, 0.1), *method, {});
        EXPECT_EQ(run.status == Status::unsupported, !method->planes && !follows_contacts(*method))
            << method->name << ": " << run.message;
    }
}

TEST(Planes, ChooseTheMethodThatKnowsThem) {
    EXPECT_EQ(choose_method(pose(bouncing(1, 1))).method->name, "cvode_impacts");
}

TEST(ImpactStepping, IsLateByAStepAtMost) {
    for (double step : {1e-2, 1e-3, 1e-4}) {
        const Trajectory run = by_steps(bouncing(1, 2), "impact_stepping", step);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        ASSERT_FALSE(run.impact_times.empty());
        // semi-implicit Euler is below the parabola by g h t / 2, so it may also be early
        EXPECT_NEAR(run.impact_times[0], std::sqrt(2 / falling_g), 2 * step);
    }
}

TEST(ImpactHalving, MeetsThePlaneOfItsOwnMotion) {
    for (double step : {1e-2, 1e-3}) {
        const Trajectory run = by_steps(bouncing(1, 0.5), "impact_halving", step);
        ASSERT_EQ(run.status, Status::ok) << run.message;
        ASSERT_EQ(run.impact_times.size(), 1U);
        // whole steps of semi-implicit Euler fall by g h^2 k (k + 1) / 2, a partial step s by (k g h + s g) s
        double fallen = 0, v = 0, t = 0;
        while (true) {
            if (fallen + (v + falling_g * step) * step > 1) break;
            v += falling_g * step, fallen += v * step, t += step;
        }
        // the partial step consists of halved steps, each with its own update: within one step in any case
        EXPECT_GE(run.impact_times[0], t - 1e-12);
        EXPECT_LE(run.impact_times[0], t + step + 1e-12);
    }
}

TEST(ImpactMethods, EndOnAZenoBallInTime) {
    for (const char* name : {"impact_stepping", "impact_halving"}) {
        const Trajectory run = by_steps(bouncing(0.5, 3), name, 1e-3);
        EXPECT_EQ(run.status, Status::ok) << name << ": " << run.message;
        EXPECT_NEAR(run.samples.back().position_W[2], 0.25, 0.05) << name;
    }
}

/// Without planes the methods support the loads, pivot and events of other scenes.
TEST(ImpactMethods, FollowAHeavyTopAsOthersDo) {
    const Scene top = heavy_top(0.5);
    const Sample expected = with_tolerance(top, "odeint_fehlberg78", 1e-12).samples.back();
    EXPECT_LT(attitude_error(by_impacts(top, 1e-11).samples.back().q, expected.q), 1e-8);
    EXPECT_LT(attitude_error(by_steps(top, "impact_stepping", 1e-5).samples.back().q, expected.q), 1e-2);
}

// truth ---------------------------------------------------------------------------------------------------------------

Reference truth_of(const Scene& scene, long samples = 10) { return reference(scene, samples, 20); }

TEST(TruthOfImpacts, OfABallIsTheGeometricSequence) {
    for (double e : {0.5, 1.0}) {
        const Reference truth = truth_of(bouncing(e, 1.35));
        ASSERT_TRUE(truth.available) << truth.message;
        const std::vector<double> expected = bounce_times(e, 1.35);
        ASSERT_EQ(truth.impact_times.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(truth.impact_times[i].high, expected[i], 1e-15);
        EXPECT_LT(truth.impact_time_error, 1e-20);
        for (const ReferenceSample& s : truth.samples) EXPECT_NEAR(s.position_W[2].high, height_of_ball(e, s.t), 1e-13);
    }
}

/// The square of the first impact's time is 2 h / g, to more digits than binary64 has.
TEST(TruthOfImpacts, LocatesThemToItsDigits) {
    const Reference truth = truth_of(bouncing(1, 0.5));
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_EQ(truth.impact_times.size(), 1U);
    const Wide t = Wide(truth.impact_times[0].high) + truth.impact_times[0].low;
    const Wide residual = t * t * Wide(falling_g) / 2 - 1;
    EXPECT_LT(std::abs(double(residual)), 1e-29);
}

TEST(TruthOfImpacts, KeepsWhatTheImpactsKeep) {
    Scene scene = falling(Box{{0.1, 0.2, 0.3}}, 1, 1);
    scene.initial.angular_velocity = {1, 4, 2};
    scene.initial.velocity_W = {0.25, -0.5, 0};
    scene.duration = 1.5;
    const Reference truth = truth_of(scene);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_GT(truth.impact_times.size(), 1U);
    const auto difference = [](const Pair& a, const Pair& b) { return (a.high - b.high) + (a.low - b.low); };
    for (const ReferenceSample& s : truth.samples) {
        const ReferenceSample& first = truth.samples.front();
        EXPECT_LT(std::abs(difference(s.energy, first.energy)), 1e-19);
        EXPECT_LT(std::abs(difference(s.angular_momentum_W[2], first.angular_momentum_W[2])), 1e-20);
        EXPECT_LT(std::abs(difference(s.velocity_W[0], first.velocity_W[0])), 1e-20);
    }
}

/// Event location with a variable-order method agrees with polynomials in 50 digits.
TEST(TruthOfImpacts, IsWhatCvodeConvergesTo) {
    for (const Shape& shape : {Shape(Box{{0.1, 0.2, 0.3}}), Shape(Capsule{0.1, 0.2}), Shape(Cone{0.2, 0.4}),
                               Shape(Ellipsoid{{0.1, 0.15, 0.3}})}) {
        Scene scene = falling(shape, 1, 0.75);
        scene.initial.angular_velocity = {1, 3, 2};
        scene.initial.orientation = {0.8, 0.6, 0, 0};
        scene.duration = 0.75;
        const Reference truth = truth_of(scene);
        ASSERT_TRUE(truth.available) << truth.message;
        ASSERT_FALSE(truth.impact_times.empty());
        double before = 1;
        for (double tolerance : {1e-6, 1e-9, 1e-11}) {
            const Trajectory run = by_impacts(scene, tolerance, 10);
            ASSERT_EQ(run.status, Status::ok) << run.message;
            std::vector<double> expected;
            for (const Pair& t : truth.impact_times) expected.push_back(t.high);
            const double late = largest_late(run.impact_times, expected);
            EXPECT_LT(late, 1e4 * tolerance);
            EXPECT_LT(late, before);
            before = late;
        }
    }
}

TEST(TruthOfImpacts, OfABoxThatLandsFlatIsFlat) {
    const Reference truth = truth_of(falling(Box{{0.1, 0.2, 0.3}}, 1.3, 1));
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_EQ(truth.impact_times.size(), bounce_times(1, 2).size());
    for (const ReferenceSample& s : truth.samples) EXPECT_EQ(s.angular_velocity_B[0].high, 0);
}

/// The impacts end at sqrt(2 / g) (1 + 2 e / (1 - e)); then the ball rests on the plane.
TEST(TruthOfImpacts, FollowsABallToItsRest) {
    const Reference zeno = truth_of(bouncing(0.5, 2));
    ASSERT_TRUE(zeno.available) << zeno.message;
    EXPECT_NEAR(zeno.impact_times.back().high, 3 * std::sqrt(2 / falling_g), 1e-15);
    EXPECT_NEAR(zeno.samples.back().position_W[2].high, 0.25, 1e-16);
    EXPECT_NEAR(zeno.samples.back().velocity_W[2].high, 0, 1e-18);
    Scene rough = bouncing(1, 1);
    rough.planes[0].friction = 0.1;
    const Reference rubbed = truth_of(rough);
    ASSERT_TRUE(rubbed.available) << rubbed.message;
    EXPECT_EQ(rubbed.samples.back().position_W[2].high, truth_of(bouncing(1, 1)).samples.back().position_W[2].high);
}

/// Two intersecting planes: the ball hits one at (1 - 1/4) / 2 s and the other at (1 - 1/4) / 3 s. Only the velocity
/// component along each normal is reversed.
TEST(TruthOfImpacts, TakeTheSpeedAlongTheNormalTimesTheRestitution) {
    Scene scene = falling(SolidSphere{0.25}, 0, 1);
    scene.duration = 0.5;
    scene.loads.clear();
    scene.initial.velocity_W = {-2, -3, 1}, scene.initial.angular_velocity = {1, 2, 3};
    scene.initial.position_W = {1, 1, 0};
    scene.planes = {Plane{{1, 0, 0}, 0, 0.5, 0}, Plane{{0, 1, 0}, 0, 0.25, 0}};
    const Reference truth = truth_of(scene, 1);
    ASSERT_TRUE(truth.available) << truth.message;
    ASSERT_EQ(truth.impact_times.size(), 2U);
    EXPECT_EQ(truth.impact_times[0].high, 0.25);
    EXPECT_EQ(truth.impact_times[1].high, 0.375);
    const ReferenceSample& end = truth.samples.back();
    EXPECT_EQ(end.velocity_W[0].high, 1);
    EXPECT_EQ(end.velocity_W[1].high, 0.75);
    EXPECT_EQ(end.velocity_W[2].high, 1);
    EXPECT_NEAR(end.position_W[0].high, 0.25 + 0.125, 1e-15);
    EXPECT_EQ(end.angular_velocity_B[1].high, 2);
}

/// A fast-rotating rod with slow flight hits with its end, whose speed comes mainly from the rotation.
TEST(TruthOfImpacts, SeesTheEndOfAFastRod) {
    Scene scene = falling(Box{{0.02, 0.02, 1}}, 0.75, 1);
    scene.duration = 0.05;
    scene.initial.angular_velocity = {40, 0, 0};
    scene.initial.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
    const Reference truth = truth_of(scene, 1);
    ASSERT_TRUE(truth.available) << truth.message;
    EXPECT_GE(truth.impact_times.size(), 1U);
}

}  // namespace
}  // namespace polhode
