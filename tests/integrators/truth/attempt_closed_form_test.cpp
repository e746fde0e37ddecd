// Truth by closed form: when it applies, its flight, and its comparison with the series.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/truth/attempt.h"

namespace polhode::truth {
namespace {

Scene thrown_body(double duration) {
    Scene scene;
    scene.name = "thrown", scene.duration = duration;
    scene.body.mass = 2, scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {1, 0.5, 2};
    scene.initial.position_W = {1, 2, 3}, scene.initial.velocity_W = {4, -5, 6};
    scene.loads.push_back(Gravity{{0.5, 0, -8}, {}});
    return scene;
}

TEST(AttemptByClosedForm, FliesAsAStoneDoes) {
    const Problem problem = pose(thrown_body(16));
    ASSERT_TRUE(has_single_closed_form(problem));
    const std::vector<double> times{0, 0.5, 4, 16};
    const Attempt attempt = attempt_by_closed_form(problem, times, 33);
    ASSERT_EQ(attempt.fault, "");
    EXPECT_GE(attempt.agreed_digits, 25);
    ASSERT_EQ(attempt.truth.reference.samples.size(), times.size());
    for (const ReferenceSample& s : attempt.truth.reference.samples) {
        EXPECT_EQ(s.position_W[0].high, 1 + 4 * s.t + 0.25 * s.t * s.t);
        EXPECT_EQ(s.position_W[2].high, 3 + 6 * s.t - 4 * s.t * s.t);
        EXPECT_EQ(s.velocity_W[2].high, 6 - 8 * s.t);
    }
    // the rotation agrees with the series
    const Attempt series = attempt_by_taylor<50>(problem, times, 33);
    for (std::size_t k = 0; k < times.size(); ++k) {
        const ReferenceSample &a = attempt.truth.reference.samples[k], &b = series.truth.reference.samples[k];
        EXPECT_EQ(a.q.x.high, b.q.x.high);
        EXPECT_EQ(a.angular_velocity_B[1].high, b.angular_velocity_B[1].high);
        EXPECT_EQ(a.energy.high, b.energy.high);
    }
}

// Both runs of the closed form agree in nearly all of their hundred digits. The attempt still claims only the digits
// that the series confirms at its start.
TEST(AttemptByClosedForm, ClaimsNoMoreThanTheSeriesSays) {
    const Attempt attempt = attempt_by_closed_form(pose(thrown_body(16)), {0, 16}, 12);
    ASSERT_EQ(attempt.fault, "");
    EXPECT_LT(attempt.agreed_digits, 30);
    EXPECT_GT(attempt.agreed_digits, 9);
    EXPECT_NEAR(std::log10(attempt.truth.reference.bound), -attempt.agreed_digits, 1e-9);
}

TEST(AttemptByClosedForm, IsNoneUnderWhatChangesTheFlight) {
    for (const Load& load : {Load(Drag{{0, 0, 0}, 0.5, {}}), Load(Force{{1, 0, 0}, Frame::body, {}, Frame::body, {}}),
                             Load(Impulse{{1, 0, 0}, Frame::world, {}, Frame::body, 1}),
                             Load(Torque{{1, 0, 0}, Frame::body, {}}), Load(Gravity{{0, 0, -1}, {1, 2}})}) {
        Scene scene = thrown_body(4);
        scene.loads.push_back(load);
        EXPECT_FALSE(has_single_closed_form(pose(scene))) << load.index();
    }
}

}  // namespace
}  // namespace polhode::truth
