// Relaxation conserves the energy, keeps the order and meets all sample and event times.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "integrators/scenes.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// Kinetic and gravitational energy of a sample, without normalising q: |q|^2 R(q) r.
double energy(const Scene& scene, const Sample& sample) {
    const ExactBody<double> body = exact_body<double>(scene);
    double E = dot(sample.angular_velocity_B, body.inertia_B * sample.angular_velocity_B) / 2;
    for (const Load& load : scene.loads)
        if (const auto* gravity = std::get_if<Gravity>(&load))
            E -= body.mass * dot(gravity->acceleration_W, rotate(sample.q, body.arm));
    return E;
}

class Relaxed : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Relaxed, ::testing::Values("arkode_erk4_relaxed", "arkode_erk8_relaxed"),
                         [](const auto& of) { return std::string(of.param); });

TEST_P(Relaxed, KeepsTheEnergyToRoundOff) {
    Scene steady = free_body(10);
    steady.initial.angular_velocity = {0, 1, 0};
    for (const Scene& scene : {free_body(20), symmetric_body(20), heavy_top(5), steady})
        for (const Formulation formulation : {Formulation::reduced, Formulation::full})
            for (const bool fixed : {true, false}) {
                Settings settings;
                (fixed ? settings.step : settings.tolerance) = fixed ? 0.02 : 1e-5;
                settings.samples = 41, settings.formulation = formulation;
                const Trajectory t = solve(scene, *find_method(GetParam()), settings);
                ASSERT_EQ(t.status, Status::ok) << t.message;
                const double first = energy(scene, t.samples.front());
                // relaxation stops at 16 ulp, and the evaluations here have rounding errors of that size
                for (const Sample& sample : t.samples)
                    EXPECT_NEAR(energy(scene, sample), first, 3e-14 * std::abs(first)) << scene.name << " " << sample.t;
            }
}

// A relaxed step ends where the energy is right, not at the requested time. Steps to samples inside and between start
// from there, so the motion does not depend on the number of samples.
TEST_P(Relaxed, MeetsTheTimesOfSamplesAndEvents) {
    Scene cut = heavy_top(2);
    cut.loads.push_back(Impulse{{0, 0, 0}, Frame::body, {0, 0, 0}, Frame::body, 0.7731});
    const double h = 0.004;
    const Trajectory few = with_step(heavy_top(2), GetParam(), h), many = with_step(heavy_top(2), GetParam(), h, 125);
    const Trajectory with_event = with_step(cut, GetParam(), h);
    const Quaternion<double> truth = with_step(heavy_top(2), "odeint_fehlberg78", h).samples.back().q;
    const double error = attitude_error(few.samples.back().q, truth);
    for (const Trajectory* other : {&many, &with_event}) {
        ASSERT_EQ(other->status, Status::ok) << other->message;
        EXPECT_LT(attitude_error(other->samples.back().q, truth), 1.5 * error + 1e-12);
    }
}

TEST_P(Relaxed, ErrsInProportionToItsTolerance) {
    const Scene scene = symmetric_body(20);
    std::vector<double> found;
    for (const double R : {1e-4, 1e-6, 1e-8, 1e-10}) {
        const Trajectory trajectory = with_tolerance(scene, GetParam(), R, 40);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        double worst = 0;
        for (const Sample& sample : trajectory.samples)
            worst = std::max(worst, attitude_error(sample.q, symmetric_attitude(scene, sample.t)));
        found.push_back(worst);
    }
    const double slope = std::log10(found.front() / found.back()) / 6;
    EXPECT_GT(slope, 0.75) << ::testing::PrintToString(found);
    EXPECT_LT(slope, 1.25) << ::testing::PrintToString(found);
}

TEST_P(Relaxed, IsUnsupportedWhereTheEnergyIsNotKept) {
    const Trajectory t = with_step(everything(3), GetParam(), 0.01);
    EXPECT_EQ(t.status, Status::unsupported);
    EXPECT_NE(t.message.find("energy"), std::string::npos);
}

// Measured over T = 100 s, h = 0.1 s: attitude error 6.0e-4 plain and 1.9e-4 relaxed, momentum error 9.1e-6 and 1.1e-5.
TEST(Relaxation, LeavesMostOfTheAttitudesError) {
    const Scene scene = free_body(100);
    const Quaternion<double> truth = with_step(scene, "odeint_fehlberg78", 0.02).samples.back().q;
    const double plain = attitude_error(with_step(scene, "arkode_erk4", 0.1).samples.back().q, truth);
    const double relaxed = attitude_error(with_step(scene, "arkode_erk4_relaxed", 0.1).samples.back().q, truth);
    EXPECT_LT(relaxed, 0.7 * plain);
    EXPECT_GT(relaxed, plain / 20);
}

TEST_P(Relaxed, NamesAToleranceOutOfReach) {
    EXPECT_EQ(with_tolerance(free_body(1), GetParam(), 1e-17).status, Status::tolerance_not_met);
}

}  // namespace
}  // namespace polhode
