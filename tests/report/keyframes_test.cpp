// Tests keyframes against closed forms and with an independent reader of tracks.
#include "report/keyframes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "body/mass_properties.h"

namespace polhode {
namespace {

Quaternion<double> about(const Vector3<double>& axis, double angle) {
    const double s = std::sin(angle / 2);
    return {std::cos(angle / 2), s * axis[0], s * axis[1], s * axis[2]};
}

// Free motion of a symmetric body (Landau & Lifshitz, Mechanics, 33): precession about the world's z at the rate a and
// spin about the body's z at the rate b, with an angle between the axes; the centre of mass moves on a parabola.
Sample regular_precession(double t, double a, double b, double angle) {
    Sample s;
    s.t = t;
    s.q = about({0, 0, 1}, a * t) * about({1, 0, 0}, angle) * about({0, 0, 1}, b * t);
    const double x = a * std::sin(angle);
    s.angular_velocity_B = {x * std::sin(b * t), x * std::cos(b * t), a * std::cos(angle) + b};
    s.position_W = {2 * t, 0, 3 * t - 4.9 * t * t};
    s.velocity_W = {2, 0, 3 - 9.8 * t};
    return s;
}

Trajectory precession(double a, double b, double angle, double duration, int samples) {
    Trajectory trajectory;
    for (int k = 0; k <= samples; ++k)
        trajectory.samples.push_back(regular_precession(duration * k / samples, a, b, angle));
    return trajectory;
}

double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
    const Quaternion<double> d = conjugate(a) * b;
    return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

// Sample k of a track, decoded as in the page.
Sample read_back(const Json& track, std::size_t k) {
    const Json& body = track["bodies"][0];
    Sample s;
    s.t = track["t"][k];
    const auto number = [&](const char* list, std::size_t i) { return body[list][i].get<double>(); };
    s.q = normalized(
        Quaternion<double>{number("q", 4 * k), number("q", 4 * k + 1), number("q", 4 * k + 2), number("q", 4 * k + 3)});
    for (std::size_t i = 0; i < 3; ++i) {
        s.angular_velocity_B[i] = number("w", 3 * k + i) * body["w_scale"].get<double>();
        if (body["p"].empty()) continue;
        s.position_W[i] = body["p_start"][i].get<double>() + number("p", 3 * k + i) * body["p_scale"].get<double>();
        s.velocity_W[i] = number("v", 3 * k + i) * body["v_scale"].get<double>();
    }
    return s;
}

TEST(Keyframes, AreWithinTheirBoundOfTheTrueMotionAtAnyTime) {
    const double duration = 10;
    const SampledMotion motion = sampled_motion(precession(2, 3, 0.7, duration, 800));
    const Keyframes keyframes = select_keyframes(motion, {1e-2, 1e-2}, true);
    ASSERT_EQ(keyframes.at.front(), 0u);
    ASSERT_EQ(keyframes.at.back(), 800u);
    EXPECT_LT(keyframes.at.size(), 120u);
    EXPECT_LE(keyframes.off.angle, 1e-2);
    EXPECT_GT(keyframes.off.angle, 1e-5);
    const Json track = track_json(motion, keyframes);
    std::size_t k = 0;
    double worst_angle = 0, worst_length = 0;
    for (int i = 0; i <= 10'000; ++i) {
        const double t = duration * i / 10'000;
        while (k + 2 < keyframes.at.size() && t > motion.t[keyframes.at[k + 1]]) ++k;
        const Sample from = read_back(track, k), to = read_back(track, k + 1), truth = regular_precession(t, 2, 3, 0.7);
        const double part = (t - from.t) / (to.t - from.t);
        worst_angle = std::max(worst_angle, angle_between(truth.q, attitude_between(from, to, part)));
        const Vector3<double> d = truth.position_W - position_between(from, to, part);
        worst_length = std::max(worst_length, std::sqrt(dot(d, d)));
    }
    // between samples the error may slightly exceed its maximum at the samples
    EXPECT_LT(worst_angle, 1.05 * keyframes.off.angle + 1e-4);
    EXPECT_LT(worst_length, 1.05 * keyframes.off.length + 1e-4);
}

TEST(Keyframes, InterpolationIsOfFourthOrder) {
    std::vector<double> errors;
    for (const double h : {0.2, 0.1, 0.05}) {
        double worst = 0;
        for (int k = 0; k < 20; ++k) {
            const Sample from = regular_precession(k * h, 2, 3, 0.7), to = regular_precession((k + 1) * h, 2, 3, 0.7);
            worst = std::max(
                worst, angle_between(regular_precession((k + 0.5) * h, 2, 3, 0.7).q, attitude_between(from, to, 0.5)));
        }
        errors.push_back(worst);
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 4, 0.3);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 4, 0.1);
}

RC_GTEST_PROP(Keyframes, KeepTheToleranceWhateverTheMotion, ()) {
    const double a = *rc::gen::inRange(-50, 50) / 10.0, b = *rc::gen::inRange(-50, 50) / 10.0;
    const double angle = *rc::gen::inRange(0, 31) / 10.0;
    const int samples = 2 * *rc::gen::inRange(1, 200);
    const SampledMotion motion = sampled_motion(precession(a, b, angle, 5, samples));
    const Keyframes keyframes = select_keyframes(motion, {1e-2, 5e-2}, false);
    RC_ASSERT(keyframes.at.back() == motion.t.size() - 1);
    // the error at a keyframe is at most half a grid step, for samples of any spacing
    RC_ASSERT(keyframes.off.angle <= 1e-2);
    RC_ASSERT(std::is_sorted(keyframes.at.begin(), keyframes.at.end()));
}

TEST(Keyframes, EndWithTheLastNumberThatCanBeDrawn) {
    Trajectory trajectory = precession(1, 1, 1, 1, 10);
    trajectory.samples[6].q = {std::nan(""), 0, 0, 0};
    EXPECT_EQ(sampled_motion(trajectory).t.size(), 6u);
    trajectory.samples[0].position_W[1] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(sampled_motion(trajectory).t.size(), 0u);
    EXPECT_TRUE(select_keyframes(sampled_motion(trajectory), {1, 1}, true).at.empty());
}

TEST(Keyframes, DoNotMindTheQuaternionsSign) {
    Trajectory trajectory = precession(2, 3, 0.7, 4, 200);
    const Keyframes before = select_keyframes(sampled_motion(trajectory), {1e-2, 1}, true);
    for (std::size_t k = 0; k < trajectory.samples.size(); k += 3) {
        Quaternion<double>& q = trajectory.samples[k].q;
        q = {-q.w, -q.x, -q.y, -q.z};
    }
    EXPECT_EQ(select_keyframes(sampled_motion(trajectory), {1e-2, 1}, true).at.size(), before.at.size());
}

}  // namespace
}  // namespace polhode
