// Scenes of contact with friction in the catalogue, against closed forms, invariants and published results.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "catalogue.h"
#include "integrators/method.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

constexpr int digits = 20;

// columns of a row of the reference after t
constexpr std::size_t spin = 4, position = 7, velocity = 10;

long double number(const std::string& decimal) { return std::stold(decimal); }

// EXPECT_NEAR compares in double, which has fewer digits than the reference
void expect_equal(const std::string& decimal, long double expected, long double tolerance = 1e-17L) {
    EXPECT_LE(std::abs(number(decimal) - expected), tolerance) << decimal << " instead of " << double(expected);
}

DecimalReference reference_of(const std::string& name, long samples = 1) {
    DecimalReference truth = decimal_reference(find_scene("contact/" + name), samples, digits);
    EXPECT_TRUE(truth.available) << name << ": " << truth.message;
    EXPECT_LE(truth.bound, 1e-20) << name;
    return truth;
}

std::string events_of(const DecimalReference& truth) {
    std::string all;
    for (const DecimalContactEvent& event : truth.contact_events) all += event.event + " ";
    return all;
}

Trajectory motion_of(const std::string& name, long samples) {
    Settings settings;
    settings.tolerance = 1e-13, settings.samples = samples;
    Trajectory motion = solve(find_scene("contact/" + name), *find_method("taylor"), settings);
    EXPECT_EQ(motion.status, Status::ok) << name << ": " << motion.message;
    return motion;
}

// m v^2 / 2 + w I w / 2 - m g x
double energy_of(const Scene& scene, const Sample& s) {
    const auto& gravity = std::get<Gravity>(scene.loads.front());
    const Vector3<double>& w = s.angular_velocity_B;
    return scene.body.mass * (dot(s.velocity_W, s.velocity_W) / 2 - dot(gravity.acceleration_W, s.position_W)) +
           dot(w, scene.body.inertia_B * w) / 2;
}

void expect_constant_energy(const std::string& name, double tolerance) {
    const Scene scene = find_scene("contact/" + name);
    const Trajectory motion = motion_of(name, 20);
    const double first = energy_of(scene, motion.samples.front());
    for (const Sample& sample : motion.samples) EXPECT_NEAR(energy_of(scene, sample), first, tolerance * first) << name;
}

TEST(ContactCatalogue, EverySceneIsSolvedByTaylorAndRefusedByMethodsWithoutContact) {
    const std::vector<std::string> names = scenes_in("contact");
    EXPECT_GE(names.size(), 12u);
    for (const std::string& name : names) {
        Settings settings;
        settings.samples = 2;
        EXPECT_EQ(solve(find_scene(name), *find_method("taylor"), settings).status, Status::ok) << name;
        const Trajectory refused = solve(find_scene(name), *find_method("odeint_dopri5"), settings);
        EXPECT_EQ(refused.status, Status::unsupported) << name;
        EXPECT_FALSE(refused.message.empty()) << name;
    }
}

// Released with |F| = 2/7 m g sin a below mu m g cos a: 5/7 g sin a = 5 m/s^2.
TEST(ContactCatalogue, BallRollsOnTheIncline) {
    const DecimalReference truth = reference_of("ball_incline_rolls");
    expect_equal(truth.columns[1][position], 10);
    expect_equal(truth.columns[1][velocity], 10);
    EXPECT_EQ(events_of(truth), "");
}

// Sliding: g (sin a - mu cos a), and 5/2 mu g cos a / r of the angular velocity.
TEST(ContactCatalogue, BallSlidesOnTheIncline) {
    const DecimalReference truth = reference_of("ball_incline_slides");
    const long double mu = find_scene("contact/ball_incline_slides").planes[0].friction;
    expect_equal(truth.columns[1][velocity], 2 * (7 - 8 * mu), 1e-16L);
    expect_equal(truth.columns[1][spin + 1], 2 * 2.5L * 8 * mu / 0.25L, 1e-15L);
    EXPECT_EQ(truth.contact_intervals.at(0).mode, "sliding");
}

// u = v - r w x n; the ball rolls from t = 2 |u| / (7 mu g) on, with v - 2/7 u (Hopkins and Patterson 1977).
void expect_rolling_after_a_parabola(const std::string& name) {
    const Scene scene = find_scene("contact/" + name);
    const DecimalReference truth = reference_of(name);
    const Vector3<double>&v = scene.initial.velocity_W, &w = scene.initial.angular_velocity;
    const long double r = scene.initial.position_W[2], mu = scene.planes[0].friction,
                      g = -std::get<Gravity>(scene.loads[0]).acceleration_W[2], T = scene.duration;
    const long double u[2] = {v[0] - r * w[1], v[1] + r * w[0]}, slip = std::hypot(u[0], u[1]),
                      rolls = 2 * slip / (7 * mu * g);
    ASSERT_EQ(events_of(truth), "rolls ");
    expect_equal(truth.contact_events[0].t, rolls);
    for (std::size_t i = 0; i < 2; ++i) {
        const long double end = v[i] - 2 * u[i] / 7;
        expect_equal(truth.columns[1][velocity + i], end);
        expect_equal(truth.columns[1][position + i], rolls * (v[i] + end) / 2 + (T - rolls) * end, 1e-16L);
    }
    expect_equal(truth.columns[1][spin + 2], w[2], 1e-16L);
}
TEST(ContactCatalogue, BowlingBallHooksAndRolls) { expect_rolling_after_a_parabola("bowling_ball"); }
TEST(ContactCatalogue, BilliardBallWithSideSpinCurvesAndRolls) {
    expect_rolling_after_a_parabola("billiard_side_spin");
}

// The angular momentum about the chord between the contacts, b = 0.6 r below the centre, is constant.
TEST(ContactCatalogue, BallInAGutterStartsToRollOnBothSides) {
    const DecimalReference truth = reference_of("ball_in_gutter");
    const long double end = 4 / (1 + 0.4L / 0.36L), rolls = (4 - end) / (0.25L * 9 / 0.6L);
    ASSERT_EQ(events_of(truth), "rolls rolls ");
    expect_equal(truth.contact_events[0].t, rolls);
    expect_equal(truth.columns[1][velocity], end);
    expect_equal(truth.columns[1][position], rolls * (4 + end) / 2 + (2 - rolls) * end, 1e-16L);
}
// Friction over mass is 2 at the floor and 0.375 at the wall. A slip changes by 7/2 of the friction at its contact and
// by the other friction; the floor, where the ball rolls first, transmits 2/7 of the friction at the wall.
TEST(ContactCatalogue, BallStartsToRollAtTheFloorAndAtTheWall) {
    const DecimalReference truth = reference_of("ball_and_wall");
    const long double first = 4 / (7 + 0.375L),
                      second = first + (4 - (2 + 3.5L * 0.375L) * first) / (45.0L / 14 * 0.375L);
    ASSERT_EQ(events_of(truth), "rolls rolls lifts_off ");
    expect_equal(truth.contact_events[0].t, first);
    expect_equal(truth.contact_events[1].t, second);
    expect_equal(truth.columns[1][velocity], 4 - 2.375L * first - 5.0L / 7 * 0.375L * (second - first));
}

// First impact at 0.5 s with 4 m/s; all impacts end after 2 e v / (g (1 - e)) = 1 s.
TEST(ContactCatalogue, DroppedBallComesToRest) {
    const DecimalReference truth = reference_of("ball_bounces_to_rest");
    expect_equal(truth.contact_events.front().t, 0.5L);
    expect_equal(truth.contact_events.front().normal_impulse, 6);
    EXPECT_EQ(truth.contact_events.back().event, "accumulates");
    expect_equal(truth.contact_events.back().t, 1.5L);
    expect_equal(truth.columns[1][position + 2], 0.125L);
}

// Each change of v is 2/7 of that of the slip, in impacts and in sliding.
TEST(ContactCatalogue, ThrownBallRolls) {
    const DecimalReference truth = reference_of("ball_bounces_and_rolls");
    EXPECT_EQ(truth.contact_intervals.back().mode, "rolling");
    expect_equal(truth.columns[1][velocity], 3 - 2.0L / 7 * (3 + 0.125L * 16));
    expect_equal(truth.columns[1][velocity + 1], 5.0L / 7);
    bool slips = false, grips = false;
    for (const DecimalContactEvent& event : truth.contact_events) {
        if (event.event != "impact") continue;
        const long double J = std::hypot(number(event.tangential_impulse[0]), number(event.tangential_impulse[1]));
        const bool at_limit = std::abs(J - 0.25L * number(event.normal_impulse)) < 1e-15L;
        slips = slips || at_limit, grips = grips || !at_limit;
    }
    EXPECT_TRUE(slips && grips);
}

// Every impact ends the slip u = v -+ r w: v changes by -2/7 u and w by +- 5/7 u / r. The table returns the ball.
TEST(ContactCatalogue, SuperballReturnsFromTheTable) {
    const DecimalReference truth = reference_of("superball");
    long double v = 3, w = 0;
    const long double r = 0.03125L;
    ASSERT_GE(truth.contact_events.size(), 3u);
    for (std::size_t k = 0; k < truth.contact_events.size(); ++k) {
        EXPECT_EQ(truth.contact_events[k].plane, k % 2);
        const long double side = k % 2 == 0 ? -1 : 1, u = v + side * r * w;
        v -= 2 * u / 7, w -= side * 5 * u / (7 * r);
    }
    expect_equal(truth.columns[1][velocity], v);
    expect_equal(truth.columns[1][spin + 1], w, 1e-15L);
}

// The last row of each body.
const DecimalColumns& end_of(const DecimalReference& truth, std::size_t bodies, std::size_t body) {
    return truth.columns[truth.columns.size() - bodies + body];
}
const DecimalContactEvent& first_impact_of(const DecimalReference& truth) {
    return *std::find_if(truth.contact_events.begin(), truth.contact_events.end(),
                         [](const DecimalContactEvent& event) { return event.event == "impact"; });
}

// Rolling with 5/7 of the first speed, a half-ball hit leaves the cue ball its component along the tangent and its
// rotation. Alciatore's TP 3.3: tan = sin a cos a / (sin^2 a + 2/5) for a = 30 degrees.
TEST(ContactCatalogue, CueBallRollsAtTheNaturalAngle) {
    const DecimalReference truth = reference_of("billiard_natural_angle");
    EXPECT_EQ(events_of(truth), "rolls impact slides slides rolls rolls ");
    const long double v = 1.5L * 5 / 7, sine = 0.5L, cosine = std::sqrt(0.75L);
    const auto &cue = end_of(truth, 2, 0), &object = end_of(truth, 2, 1);
    expect_equal(cue[velocity], v * (5 * sine * sine + 2) / 7);
    expect_equal(cue[velocity + 1], -v * 5 * sine * cosine / 7);
    expect_equal(object[velocity], v * cosine * 5 / 7 * cosine);
    expect_equal(object[velocity + 1], v * cosine * 5 / 7 * sine);
}

// The cue ball slides up to the impact; the slip at the impact does not end, so friction is mu times the normal
// impulse.
TEST(ContactCatalogue, ObjectBallIsThrown) {
    const Scene scene = find_scene("contact/billiard_throw");
    const DecimalReference truth = reference_of("billiard_throw");
    const long double r = 0.028575, e = 0.95, mu = 0.06, cloth = 0.2, g = 9.8, m = 0.17;
    const long double cosine = std::sqrt(0.75L), v = std::sqrt(4 - 2 * cloth * g * (0.0625L - 2 * r * cosine));
    const DecimalContactEvent& hit = first_impact_of(truth);
    expect_equal(hit.normal_impulse, (1 + e) / 2 * m * v * cosine);
    long double square = 0;
    for (const std::string& component : hit.tangential_impulse) square += number(component) * number(component);
    EXPECT_NEAR(double(std::sqrt(square) / (mu * number(hit.normal_impulse))), 1, 1e-15);
}

// The speed is multiplied by (1 + e)/2 at each of the first four impacts.
TEST(ContactCatalogue, CradlePassesMomentumThroughItsGaps) {
    const DecimalReference truth = reference_of("newtons_cradle");
    const long double e = 0.95, passed = (1 + e) / 2;
    long double impulse = 0.125L;
    ASSERT_GE(truth.contact_events.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) expect_equal(truth.contact_events[k].normal_impulse, impulse *= passed);
    long double momentum = 0;
    for (std::size_t body = 0; body < 5; ++body) momentum += 0.125L * number(end_of(truth, 5, body)[velocity]);
    EXPECT_NEAR(double(momentum), 0.125, 1e-17);
}

// Harter 1971: the large ball returns with the speed v of the fall, and both balls meet at 2 v.
TEST(ContactCatalogue, LowerBallThrowsTheUpperOne) {
    const DecimalReference truth = reference_of("stacked_ball_drop");
    const long double g = 9.8, large = 0.9, small = 0.1, v = std::sqrt(2 * g);
    ASSERT_EQ(events_of(truth), "impact impact impact impact ");
    expect_equal(truth.contact_events[0].normal_impulse, 2 * large * v, 2e-17L);
    const long double meets = number(truth.contact_events[1].t);
    const long double impulse = 2 * (large * small / (large + small)) * 2 * v;
    expect_equal(truth.contact_events[1].normal_impulse, impulse, 2e-17L);
    expect_equal(end_of(truth, 2, 1)[velocity + 2], -g * meets + impulse / small - g * (2 - meets), 1e-15L);
}

// Up with -(g sin a + mu g cos a) = 10 m/s^2, down with 2 m/s^2.
TEST(ContactCatalogue, BlockSlidesBackDownTheRamp) {
    const DecimalReference truth = reference_of("block_on_ramp");
    expect_equal(truth.columns[1][velocity], 3);
    expect_equal(truth.columns[1][position], 1);
}

// u (1 + cos p) is constant for mu = tan a, with the angle p between the velocity and the fall line.
TEST(ContactCatalogue, BlockTurnsDownTheSlope) {
    const DecimalReference truth = reference_of("block_across_slope", 4);
    for (const DecimalColumns& row : truth.columns) {
        const long double x = number(row[velocity]), y = number(row[velocity + 1]);
        EXPECT_LE(std::abs(std::hypot(x, y) + x - 4), 1e-17L);
    }
    EXPECT_LT(number(truth.columns[4][velocity + 1]), 0.4L);
}

// Jellett's constant: L . r, with r from the centre of mass to the contact (Gray and Nickel 2000).
TEST(ContactCatalogue, TippeTopRises) {
    const Scene scene = find_scene("contact/tippe_top");
    const Trajectory motion = motion_of("tippe_top", 10);
    const auto jellett = [&](const Sample& s) {
        const Vector3<double> center = rotate(s.q, Vector3<double>() - scene.body.center_of_mass);
        return dot(rotate(s.q, scene.body.inertia_B * s.angular_velocity_B), center - Vector3<double>(0, 0, 0.02));
    };
    const double first = jellett(motion.samples.front());
    for (const Sample& sample : motion.samples) EXPECT_NEAR(jellett(sample), first, 1e-10 * std::abs(first));
    // from 0.0182 m, near the lowest position 0.018 m, towards the highest one, 0.022 m
    EXPECT_GT(motion.samples.back().position_W[2], 0.021);
}

TEST(ContactCatalogue, RollingBodiesConserveEnergy) {
    for (const char* name : {"rolling_coin", "rolling_ellipsoid", "chaplygin_ball"})
        expect_constant_energy(name, 1e-11);
}

// L about the contact point is constant: that about the centre of mass plus m r n x v.
TEST(ContactCatalogue, ChaplyginsBallConservesTheMomentumAboutTheContact) {
    const Scene scene = find_scene("contact/chaplygin_ball");
    const auto momentum = [&](const Sample& s) {
        return rotate(s.q, scene.body.inertia_B * s.angular_velocity_B) +
               cross(Vector3<double>(0, 0, 0.5 * scene.body.mass), s.velocity_W);
    };
    const Trajectory motion = motion_of("chaplygin_ball", 10);
    for (const Sample& sample : motion.samples)
        EXPECT_LE(length(momentum(sample) - momentum(motion.samples.front())), 1e-11);
}

// Steady motion of a thin disc with its centre at rest: w^2 = 4 g sin a / r about the diameter through the contact.
TEST(ContactCatalogue, EulersDiscKeepsItsInclination) {
    const Trajectory motion = motion_of("eulers_disc", 10);
    const Sample& first = motion.samples.front();
    for (const Sample& sample : motion.samples) {
        EXPECT_LE(length(sample.position_W - first.position_W), 1e-10);
        EXPECT_NEAR(rotate(sample.q, Vector3<double>(0, 0, 1))[2], rotate(first.q, Vector3<double>(0, 0, 1))[2], 1e-9);
    }
}

// Garcia and Hubbard 1988: the spin reverses. The body rolls, so that its energy is constant.
TEST(ContactCatalogue, RattlebackReversesItsSpin) {
    const Trajectory motion = motion_of("rattleback", 30);
    double least = 0;
    for (const Sample& sample : motion.samples) least = std::min(least, rotate(sample.q, sample.angular_velocity_B)[2]);
    EXPECT_EQ(motion.samples.front().angular_velocity_B[2], 3);
    EXPECT_LT(least, -1);
    expect_constant_energy("rattleback", 1e-9);
}

// Impulses lie in the friction cone, and no event adds energy.
TEST(ContactCatalogue, ImpactsWithFrictionLoseEnergy) {
    for (const char* name : {"ellipsoid_bounces", "capsule_lands"}) {
        const Scene scene = find_scene(std::string("contact/") + name);
        const Trajectory motion = motion_of(name, 200);
        EXPECT_GE(motion.impact_times.size(), 2u);
        double before = energy_of(scene, motion.samples.front());
        for (const Sample& sample : motion.samples) {
            const double now = energy_of(scene, sample);
            EXPECT_LE(now, before + 1e-9 * before) << name << " at " << sample.t;
            before = now;
        }
    }
}

TEST(ContactCatalogue, CapsuleLandsSlidesAndRolls) {
    const DecimalReference truth = reference_of("capsule_lands");
    ASSERT_FALSE(truth.contact_events.empty());
    for (const DecimalContactEvent& event : truth.contact_events) {
        long double square = 0;
        for (const std::string& component : event.tangential_impulse) square += number(component) * number(component);
        EXPECT_LE(std::sqrt(square), 0.5L * number(event.normal_impulse) * (1 + 1e-17L));
    }
}

}  // namespace
}  // namespace polhode
