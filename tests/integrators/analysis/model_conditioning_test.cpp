// Condition numbers of mechanisms, compared with closed forms of the variational equation and with finite differences.
#include "integrators/analysis/model_conditioning.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "integrators/method.h"
#include "integrators/series/linear_algebra.h"
#include "motion/formula_mechanism.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// a mass of 1 kg, 0.5 m from the hinge, with 0.25 kg m^2 about its centre: I = 0.5 kg m^2, m g l = 5 N m
Scene pendulum(const std::string& joint, const std::string& more = "") {
    return parse_scene(R"({"name": "p", "duration": 2,
        "bodies": [{"name": "bob", "body": {"mass": 1, "inertia": [0.25, 0.25, 0.25], "center_of_mass": [0, 0, -0.5]}}],
        "joints": [{"name": "pin", "parent": "world", "child": "bob", )" +
                           joint + "}], " + more + R"("loads": [{"type": "gravity", "acceleration": [0, 0, -10]}]})",
                       "p");
}

double norm(double a, double b, double c, double d) {
    Eigen::Matrix2d m;
    m << a, b, c, d;
    return m.jacobiSvd().singularValues()[0];
}

Conditioning conditioning_at(const Scene& scene, const std::vector<double>& times) {
    return conditioning(pose(scene), times);
}

// upright theta'' = l^2 theta, so S = (cosh, sinh / l; l sinh, cosh), with rates in units of their scale
TEST(ConditioningOfMechanism, OfAPendulumUprightGrowsAsItsLinearSolution) {
    const Scene scene = pendulum(R"("type": "revolute", "axis": [0, 1, 0], "initial": {"angle": 3.141592653589793})");
    const double s = mechanism_of(pose(scene)).scales()[1], l = std::sqrt(10.0);
    const std::vector<double> times{0, 0.5, 1, 2};
    const Conditioning kappa = conditioning_at(scene, times);
    ASSERT_TRUE(kappa.available) << kappa.message;
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double c = std::cosh(l * times[k]), f = std::sinh(l * times[k]);
        EXPECT_NEAR(kappa.state[k] / norm(c, s * f / l, l * f / s, c), 1, 1e-5) << times[k];
        EXPECT_NEAR(kappa.attitude[k] / std::hypot(c, s * f / l), 1, 1e-5) << times[k];
    }
}

TEST(ConditioningOfMechanism, OfAPendulumAtRestStaysSmall) {
    const Scene scene = pendulum(R"("type": "revolute", "axis": [0, 1, 0])");
    const double s = mechanism_of(pose(scene)).scales()[1], l = std::sqrt(10.0);
    const Conditioning kappa = conditioning_at(scene, {0.3, 2});
    ASSERT_TRUE(kappa.available) << kappa.message;
    for (std::size_t k = 0; k < 2; ++k) {
        const double c = std::cos(l * kappa.times[k]), f = std::sin(l * kappa.times[k]);
        EXPECT_NEAR(kappa.state[k] / norm(c, s * f / l, -l * f / s, c), 1, 1e-5);
    }
}

// a spherical joint at one point and a loop at another act as a hinge: kappa is that of the upright pendulum
TEST(ConditioningOfMechanism, LoopsLeaveTheChangesThatTheyAllow) {
    const Scene scene =
        pendulum(R"("type": "spherical", "initial": {"orientation": [0, 0, 1, 0]})",
                 R"("loops": [{"name": "second", "type": "spherical", "first": "world", "first_point": [0, 1, 0],
            "second": "bob", "second_point": [0, 1, 0]}], )");
    const double s = mechanism_of(pose(scene)).scales()[4], l = std::sqrt(10.0);
    const Conditioning kappa = conditioning_at(scene, {1});
    ASSERT_TRUE(kappa.available) << kappa.message;
    EXPECT_NE(kappa.message.find(" 2 directions"), std::string::npos) << kappa.message;
    EXPECT_NEAR(kappa.attitude[0] / std::hypot(std::cosh(l), s * std::sinh(l) / l), 1, 1e-5);
}

// Two bodies in series with an impulse: kappa includes the derivative of the jump. Compared with differences.
TEST(ConditioningOfMechanism, PassesImpulses) {
    const auto scene = [](double angle) {
        return parse_scene(fmt::format(R"({{"name": "two", "duration": 1,
            "bodies": [{{"name": "a", "body": {{"mass": 1, "inertia": [0.1, 0.1, 0.1], "center_of_mass": [0, 0, -0.5]}}}},
                       {{"name": "b", "body": {{"mass": 1, "inertia": [0.1, 0.1, 0.1], "center_of_mass": [0, 0, -0.5]}}}}],
            "joints": [{{"name": "s", "type": "revolute", "parent": "world", "child": "a", "axis": [0, 1, 0],
                         "initial": {{"angle": {:.17g}, "rate": 1}}}},
                       {{"name": "e", "type": "revolute", "parent": "a", "parent_point": [0, 0, -1], "child": "b",
                         "axis": [0, 1, 0], "initial": {{"angle": 0.5}}}}],
            "loads": [{{"type": "gravity", "acceleration": [0, 0, -10]}},
                      {{"type": "impulse", "body": "b", "vector": [3, 0, 0], "frame": "body", "point": [0, 0, -1],
                        "at": 0.5}}]}})",
                                       angle),
                           "two");
    };
    const double h = 1e-5;
    const auto end = [&](double angle) {
        Settings settings;
        settings.samples = 1, settings.tolerance = 1e-13;
        return solve(pose(scene(angle)), *find_method("taylor"), settings).samples;
    };
    const std::vector<Sample> ahead = end(0.4 + h), behind = end(0.4 - h);
    double grown = 0;
    for (std::size_t b = 2; b < 4; ++b) {
        const Quaternion<double> r = conjugate(behind[b].q) * ahead[b].q;
        grown = std::max(grown, 2 * std::hypot(r.x, r.y, r.z) / (2 * h));
    }
    const Conditioning kappa = conditioning_at(scene(0.4), {1});
    ASSERT_TRUE(kappa.available) << kappa.message;
    // kappa is at least the growth in one direction, and the angle is one of the sensitive directions
    EXPECT_GE(kappa.attitude[0], grown * (1 - 1e-4));
    EXPECT_LE(kappa.attitude[0], 30 * grown);
}

TEST(ConditioningOfMechanism, OfALongChainFollowsSomeDirections) {
    const Conditioning kappa = conditioning_at(find_scene("mechanisms/chain_100"), {0.01});
    ASSERT_TRUE(kappa.available) << kappa.message;
    EXPECT_NE(kappa.message.find("16 directions (random combinations"), std::string::npos) << kappa.message;
    EXPECT_GT(kappa.state[0], 0.5);
}

// A body at rest with the torque -k w, at the end of a spring -c p: both are linear, so S is known in blocks.
TEST(ConditioningOfFormulas, OfALinearMotionIsItsClosedForm) {
    const Scene scene = parse_scene(R"json({"name": "linear", "duration": 2,
        "body": {"mass": 1, "inertia": [0.5, 0.5, 0.5]}, "initial": {"position": [0.25, 0, 0]},
        "parameters": {"k": 0.75, "c": 9},
        "loads": [{"type": "torque", "frame": "body", "formula": "-k*w"},
                  {"type": "potential", "formula": "0.5*c*dot(p, p)"}]})json",
                                    "linear");
    const Scales scales = pose(scene).scales;
    const std::vector<double> times{0.25, 1, 2};
    const Conditioning kappa = conditioning_at(scene, times);
    ASSERT_TRUE(kappa.available) << kappa.message;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double t = times[i], decay = std::exp(-1.5 * t), turn = (1 - decay) / 1.5 * scales.angular_velocity;
        const double cosine = std::cos(3 * t), sine = std::sin(3 * t), s = scales.velocity / scales.position;
        const double translation = norm(cosine, s * sine / 3, -3 * sine / s, cosine);
        EXPECT_NEAR(kappa.attitude[i], std::hypot(1, turn), 1e-7) << t;
        EXPECT_NEAR(kappa.state[i], std::max(norm(1, turn, 0, decay), translation), 1e-6) << t;
    }
}

// The same damping as a formula and as a load of the joint, solved by the same equations but different models.
TEST(ConditioningOfFormulas, OfAMechanismIsThatOfTheBuiltInLoad) {
    const std::string joint = R"("type": "revolute", "axis": [0, 1, 0], "initial": {"angle": 2.5, "rate": -1})";
    const Scene built_in = pendulum(joint + R"(, "damping": 0.5)");
    Scene formula = pendulum(joint);
    FormulaLoad motor;
    motor.kind = FormulaKind::motor, motor.joint = "pin", motor.formula = "-0.5*pin.rate";
    formula.loads.push_back(motor);
    const Conditioning expected = conditioning_at(built_in, {1, 2}), kappa = conditioning_at(formula, {1, 2});
    ASSERT_TRUE(kappa.available) << kappa.message;
    // the scales of the rates are estimates
    const double ratio = tree_scales(pose(formula))[1] / tree_scales(pose(built_in))[1];
    EXPECT_NEAR(ratio, 1, 0.05);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(kappa.state[i] / expected.state[i], 1, 2 * std::abs(ratio - 1) + 1e-6);
        EXPECT_NEAR(kappa.attitude[i] / expected.attitude[i], 1, 2 * std::abs(ratio - 1) + 1e-6);
    }
}

TEST(ConditioningOfFormulas, IsRefusedThroughSwitchingPoints) {
    const Conditioning kappa = conditioning_at(find_scene("formulas/saturated_regulator"), {1});
    EXPECT_FALSE(kappa.available);
    EXPECT_NE(kappa.message.find("switching points"), std::string::npos) << kappa.message;
}

}  // namespace
}  // namespace polhode
