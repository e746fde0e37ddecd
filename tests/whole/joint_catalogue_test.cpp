// Scenes of joints in the catalogue, against closed forms, invariants and equivalent mechanisms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "catalogue.h"
#include "integrators/method.h"
#include "integrators/series/real.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "whole/exact_rows.h"

namespace polhode {
namespace {

DecimalReference reference_of(const std::string& name, long samples, int digits = 25) {
    DecimalReference truth = decimal_reference(find_scene("joints/" + name), samples, digits);
    EXPECT_TRUE(truth.available) << name << ": " << truth.message;
    EXPECT_LE(truth.bound, std::pow(10, -digits)) << name;
    return truth;
}

// the row of a body at a sample
const DecimalColumns& row_of(const DecimalReference& truth, std::size_t sample, std::size_t body = 0) {
    return truth.columns.at(sample * static_cast<std::size_t>(truth.bodies) + body);
}

// the angle of a body that turns about y, in (-pi, pi]
Exact angle_of(const DecimalColumns& row) { return 2 * atan2(number(row, attitude + 2), number(row, attitude)); }

std::vector<std::string> events_of(const DecimalReference& truth, const std::string& kind) {
    std::vector<std::string> times;
    for (const DecimalContactEvent& event : truth.contact_events)
        if (event.event == kind) times.push_back(event.t);
    return times;
}

TEST(JointCatalogue, EverySceneIsSolvedByTaylor) {
    const std::vector<std::string> names = scenes_in("joints");
    EXPECT_GE(names.size(), 12u);
    for (const std::string& name : names) {
        Settings settings;
        settings.samples = 2;
        const Trajectory run = solve(find_scene(name), *find_method("taylor"), settings);
        EXPECT_EQ(run.status, Status::ok) << name << ": " << run.message;
    }
}

// Impacts at t = 1, 2, 2.5, 2.75, ..; samples at the first two show the motion after the impact.
TEST(JointCatalogue, BouncingSliderShowsTheMotionAfterAnImpactAtASample) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("bouncing_slider", 8);
    expect_equal(number(row_of(truth, 1), position + 2), 1);
    expect_equal(number(row_of(truth, 1), velocity + 2), -1);
    for (const auto& [sample, speed] : {std::pair{2, 1.0}, {4, 0.5}, {5, 0.25}, {6, 0.0}, {8, 0.0}}) {
        expect_equal(number(row_of(truth, std::size_t(sample)), position + 2), 0.25, 1e-24);
        expect_equal(number(row_of(truth, std::size_t(sample)), velocity + 2), speed, 1e-20);
    }
    const std::vector<std::string> impacts = events_of(truth, "impact"), rests = events_of(truth, "rests");
    ASSERT_GE(impacts.size(), 20u);
    for (int k = 0; k < 20; ++k)
        expect_equal(Exact(impacts[std::size_t(k)]), 1 + (k == 0 ? 0 : 2 - std::ldexp(1, 1 - k)), 1e-22);
    ASSERT_EQ(rests.size(), 1u);
    expect_equal(Exact(rests[0]), 3, 1e-18);
}

// m x'' = -k x - F sign(x'): turning points (-1)^n (1/2 - n/8) at t = n pi / 2.
TEST(JointCatalogue, CoulombOscillatorStopsAfterFourHalfPeriods) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("coulomb_oscillator", 14);
    const Exact half = acos(Exact(-1)) / 2;
    for (std::size_t i = 0; i < truth.times.size(); ++i) {
        const int n = std::min(4, static_cast<int>(truth.times[i] / static_cast<double>(half)));
        const Exact sign = n % 2 ? -1 : 1, turning = sign * (Exact(0.5) - n * Exact(0.125)), center = sign / 16;
        const Exact t = Exact(truth.times[i]) - n * half;
        expect_equal(number(row_of(truth, i), position),
                     n == 4 ? turning : Exact(center + (turning - center) * cos(Exact(2 * t))));
    }
    const std::vector<std::string> sticks = events_of(truth, "sticks");
    ASSERT_EQ(sticks.size(), 1u);
    expect_equal(Exact(sticks[0]), Exact(4 * half));
}

// m g l (cos b - cos a) = F (a + b) for successive turning points a, -b.
TEST(JointCatalogue, CoulombPendulumStopsWhereTheEnergyBalanceEnds) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("coulomb_pendulum", 1);
    const Exact weight = Exact(1.5) * 9.75 / 2, F(0.75);
    Exact a(1.25);
    int swings = 0;
    while (weight * sin(a) > F) {
        Exact next = a - 2 * F / weight;
        for (int i = 0; i < 60; ++i)
            next -= (weight * (cos(next) - cos(a)) - F * (a + next)) / (-weight * sin(next) - F);
        a = next, ++swings;
    }
    ASSERT_GE(swings, 4);
    expect_equal(angle_of(row_of(truth, 1)), swings % 2 ? Exact(-a) : a);
}

// The energy changes at impacts only, where e^2 of the kinetic energy remains.
TEST(JointCatalogue, PendulumWithStopsLosesEnergyAtImpactsOnly) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("pendulum_with_stops", 12, 22);
    // m g l (1 - cos x) + J w^2 / 2, J = 0.5 + 1.5 / 4 about the hinge
    const auto energy = [](const Exact& x, const Exact& w) {
        return Exact(Exact(1.5 * 9.75 / 2) * (1 - cos(x)) + Exact(0.875) / 2 * w * w);
    };
    std::vector<Exact> levels{energy(0, 4)};
    for (int k = 0; k < 40; ++k) {
        const Exact at = energy(Exact(k % 2 ? -0.25 : 0.5), 0), before = levels.back() - at;
        if (before < 0) break;
        levels.push_back(at + Exact(0.5625) * before);
    }
    std::size_t level = 0;
    for (std::size_t i = 0; i < truth.times.size(); ++i) {
        const Exact now = energy(angle_of(row_of(truth, i)), number(row_of(truth, i), spin + 1));
        while (level + 1 < levels.size() && abs(Exact(now - levels[level])) > 1e-15) ++level;
        expect_equal(now, levels[level], 1e-19);
    }
    EXPECT_GE(level, 3u);
}

TEST(JointCatalogue, ArmatureMovesAsTheGearedRotorTo28Digits) {
    const FreshCache cache;
    const DecimalReference armature = reference_of("pendulum_with_armature", 6, 28),
                           rotor = reference_of("pendulum_with_rotor", 6, 28);
    for (std::size_t k = 0; k <= 6; ++k)
        for (std::size_t c = 0; c < 13; ++c)
            expect_equal(number(row_of(armature, k), c), number(row_of(rotor, k, 0), c), 1e-26);
}

// The end of the second arm stays on the line x = 0; the energy is constant.
TEST(JointCatalogue, CardanGearMovesAlongALine) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("cardan_gear", 8);
    Exact first;
    for (std::size_t k = 0; k <= 8; ++k) {
        const DecimalColumns &carrier = row_of(truth, k, 0), &small = row_of(truth, k, 1);
        // the end is 1/4 m beyond the centre of mass of the second arm, along (0, 0, -1) of its body
        const Exact angle = angle_of(small);
        expect_equal(number(small, position) - sin(angle) / 4, 0);
        expect_equal(angle, Exact(-angle_of(carrier)));
        Exact energy =
            Exact(0.0625) * pow(number(carrier, spin + 1), 2) + Exact(0.03125) * pow(number(small, spin + 1), 2);
        for (std::size_t c = 0; c < 3; ++c)
            energy += pow(number(carrier, velocity + c), 2) / 2 + pow(number(small, velocity + c), 2) / 4;
        energy += Exact(9.75) * (number(carrier, position + 2) + number(small, position + 2) / 2);
        if (k == 0) first = energy;
        expect_equal(energy, first, 1e-22);
    }
}

// The rack: z'' = -3 m/s^2; the pinion: angle -4 z.
TEST(JointCatalogue, RackFallsWithConstantAcceleration) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("rack_and_pinion", 4);
    for (std::size_t k = 0; k <= 4; ++k) {
        const Exact t(truth.times[k]), z = t - Exact(1.5) * t * t;
        expect_equal(number(row_of(truth, k, 1), position + 2), Exact(z - Exact(0.25)));
        expect_equal(number(row_of(truth, k, 0), spin + 1), Exact(-4 * (1 - 3 * t)), 1e-22);
    }
    // the gear force on the pinion's shaft has no torque left: J w' is the moment of the coupling
    expect_equal(Exact(truth.reactions.at(0)[2]), Exact(18), 1e-22);
}

// z'' = -m g / (m + I / h^2) with h = pitch / (2 pi) as rounded by the reader; the spin is z' / h.
TEST(JointCatalogue, ScrewJackDescendsWithConstantAcceleration) {
    const FreshCache cache;
    const Scene scene = find_scene("joints/screw_jack");
    ASSERT_EQ(scene.couplings.size(), 1u);
    const Exact h(scene.couplings[0].ratio), a = Exact(20 * 9.75) / (20 + (Exact(0.75) + 20 * Exact(1) / 64) / (h * h));
    const DecimalReference truth = reference_of("screw_jack", 4);
    for (std::size_t k = 0; k <= 4; ++k) {
        const Exact t(truth.times[k]);
        expect_equal(number(row_of(truth, k), position + 2), Exact(Exact(0.25) - a * t * t / 2));
        expect_equal(number(row_of(truth, k), spin + 2), Exact(-a * t / h), 1e-22);
    }
}

// Energy without dissipation, and the mimic finger.
TEST(JointCatalogue, ArmWithGripperKeepsEnergyAndTheMimicRatio) {
    const FreshCache cache;
    const Reference truth = reference(find_scene("joints/arm_with_gripper"), 4, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const double first = truth.system[0].energy.high;
    for (const ReferenceSystem& at : truth.system) EXPECT_NEAR(at.energy.high, first, 1e-13 * std::abs(first));
    for (std::size_t k = 0; k <= 4; ++k) {
        // in the hand's axes both fingers are equally far from the middle
        const auto body = [&](std::size_t b) { return truth.samples[k * 5 + b].rounded(); };
        const Vector3<double> middle = 0.5 * (body(3).position_W + body(4).position_W) - body(2).position_W;
        const Vector3<double> in_hand = rotate(conjugate(body(2).q), middle);
        EXPECT_NEAR(in_hand[0], 0, 1e-15) << k;
        EXPECT_NEAR(in_hand[2], -0.125, 1e-15) << k;
    }
}

// The equations of Landau and Lifshitz for two point masses, by Runge and Kutta's method in long double.
TEST(JointCatalogue, PointMassDoublePendulumFollowsTheTextbook) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("point_mass_double_pendulum", 4, 22);
    using Long = long double;
    constexpr Long m1 = 1, m2 = 0.5L, l1 = 1, l2 = 0.75L, g = 9.75L;
    using State = std::array<Long, 4>;  // angles from the vertical and their rates
    const auto slope = [&](const State& y) {
        const Long d = y[0] - y[1], c = std::cos(d), s = std::sin(d);
        // (m1 + m2) l1 a + m2 l2 b cos d = -m2 l2 w2^2 sin d - (m1 + m2) g sin x1;  l1 a cos d + l2 b = l1 w1^2 sin d -
        // g sin x2
        const Long p = -m2 * l2 * y[3] * y[3] * s - (m1 + m2) * g * std::sin(y[0]);
        const Long q = l1 * y[2] * y[2] * s - g * std::sin(y[1]);
        const Long a = (p - m2 * c * q) / (l1 * (m1 + m2 - m2 * c * c));
        return State{y[2], y[3], a, (q - l1 * a * c) / l2};
    };
    State y{1.5L, 2, 0, 0};
    constexpr int steps = 20000;
    constexpr Long h = 2.0L / steps;
    for (int i = 0; i <= steps; ++i) {
        if (i % (steps / 4) == 0) {
            const std::size_t k = static_cast<std::size_t>(i / (steps / 4));
            // bodies rotate about +y, so that positive angles move the mass to -x
            expect_equal(number(row_of(truth, k, 0), position), Exact(-l1 * std::sin(y[0])), 1e-13);
            expect_equal(number(row_of(truth, k, 1), position), Exact(-l1 * std::sin(y[0]) - l2 * std::sin(y[1])),
                         1e-13);
        }
        const auto at = [&](const State& k, Long step) {
            State z = y;
            for (std::size_t j = 0; j < 4; ++j) z[j] += step * k[j];
            return slope(z);
        };
        const State k1 = slope(y), k2 = at(k1, h / 2), k3 = at(k2, h / 2), k4 = at(k3, h);
        for (std::size_t j = 0; j < 4; ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
}

TEST(JointCatalogue, TrebuchetKeepsItsEnergyAndThrows) {
    const FreshCache cache;
    const Reference truth = reference(find_scene("joints/trebuchet"), 10, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const double first = truth.system[0].energy.high;
    double fastest = 0;
    for (std::size_t k = 0; k <= 10; ++k) {
        EXPECT_NEAR(truth.system[k].energy.high, first, 1e-13 * std::abs(first)) << k;
        const Vector3<double> v = truth.samples[3 * k + 2].rounded().velocity_W;
        fastest = std::max(fastest, length(v));
    }
    EXPECT_GT(fastest, 25);
}

// All joint forces are internal: the centre of mass flies a parabola and the angular momentum about it is constant,
// through impacts at limits and changes of friction.
TEST(JointCatalogue, HopperInFlightKeepsItsMomenta) {
    const FreshCache cache;
    const Scene scene = find_scene("joints/hopper_in_flight");
    const DecimalReference truth = reference_of("hopper_in_flight", 8, 22);
    EXPECT_GE(truth.contact_events.size(), 3u);
    std::vector<std::size_t> bodies;
    Exact mass(0);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        if (scene.bodies[b].body.mass > 0) bodies.push_back(b), mass += scene.bodies[b].body.mass;
    Exact x0, z0, u0, w0, L0;
    for (std::size_t k = 0; k <= 8; ++k) {
        Exact x(0), z(0), u(0), w(0), L(0);
        for (const std::size_t b : bodies) {
            const DecimalColumns& row = row_of(truth, k, b);
            const Exact m(scene.bodies[b].body.mass);
            const Exact px = number(row, position), pz = number(row, position + 2), vx = number(row, velocity),
                        vz = number(row, velocity + 2);
            x += m * px / mass, z += m * pz / mass, u += m * vx / mass, w += m * vz / mass;
            L += m * (pz * vx - px * vz) + Exact(scene.bodies[b].body.inertia_B[1][1]) * number(row, spin + 1);
        }
        L -= mass * (z * u - x * w);
        if (k == 0) x0 = x, z0 = z, u0 = u, w0 = w, L0 = L;
        const Exact t(truth.times[k]);
        expect_equal(x, Exact(x0 + u0 * t), 1e-20);
        expect_equal(z, Exact(z0 + w0 * t - Exact(9.75) / 2 * t * t), 1e-20);
        expect_equal(u, u0, 1e-20);
        expect_equal(L, L0, 1e-19);
    }
}

// The energy never grows, and joints stick and hit limits. The truth itself compares two formulations with all events.
TEST(JointCatalogue, Arm6DissipatesAtLimitsAndByFriction) {
    const FreshCache cache;
    const Scene scene = find_scene("joints/arm6_limits_friction");
    const Reference truth = reference(scene, 8, 20);
    ASSERT_TRUE(truth.available) << truth.message;
    for (std::size_t k = 1; k <= 8; ++k) EXPECT_LT(truth.system[k].energy.high, truth.system[k - 1].energy.high) << k;
}

// The angular momentum stays zero; the wheels' spins follow J (w_wheel + axis . w_hub)' = torque about each axis.
TEST(JointCatalogue, ReactionWheelsTurnTheHubWithoutAngularMomentum) {
    const FreshCache cache;
    const Scene scene = find_scene("joints/reaction_wheels");
    const Reference truth = reference(scene, 8, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    double largest = 0;
    for (const ReferenceSystem& at : truth.system)
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(at.angular_momentum_W[i].high, 0, 1e-17);
            EXPECT_NEAR(at.linear_momentum_W[i].high, 0, 1e-17);
        }
    for (std::size_t k = 0; k <= 8; ++k)
        largest = std::max(largest, length(truth.samples[5 * k].rounded().angular_velocity_B));
    EXPECT_GT(largest, 0.01);
}

// x = r cos a + sqrt(l^2 - r^2 sin^2 a) for the prescribed angle a.
TEST(JointCatalogue, SliderFollowsTheDrivenCrank) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("driven_slider_crank", 3);
    const Exact r(0.75), l(1.25);
    for (std::size_t k = 0; k <= 3; ++k) {
        const Exact t(k), a = 4 * t + sin(Exact(4 * t)) / 4;
        expect_equal(number(row_of(truth, k, 2), position), r * cos(a) + sqrt(Exact(l * l - r * r * sin(a) * sin(a))),
                     1e-24);
    }
}

// x = 7/64 (1 - cos 8 t) on the coordinate of the left finger, up to the limit of the thumb at 1/16 m.
TEST(JointCatalogue, GripperOpensToTheLimitOfTheThumb) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("gripper_closes", 2);
    const Exact first = acos(Exact(Exact(3) / 7)) / 8;
    expect_equal(Exact(events_of(truth, "impact").at(0)), first, 1e-24);
    expect_equal(number(row_of(truth, 1, 0), position), Exact(0.125), 1e-24);
    expect_equal(number(row_of(truth, 2, 0), position), Exact(0.0625), 1e-24);
    EXPECT_GE(events_of(truth, "rests").size(), 2u);
}

// While the block sticks, the spring and the inertia on the belt, at x = t/2 + (1 - cos 2 t)/8, need friction:
// 4 x + 2 x'' = 2 t + 1/2 + cos(2 t)/2. It slips where this is 3.
TEST(JointCatalogue, BlockSlipsOnTheBeltAndSticksAgain) {
    const FreshCache cache;
    const DecimalReference truth = reference_of("stick_slip_belt", 1);
    const std::vector<std::string> slips = events_of(truth, "slips"), sticks = events_of(truth, "sticks");
    ASSERT_EQ(slips.size(), 2u);
    ASSERT_EQ(sticks.size(), 2u);
    const Exact t(slips[0]);
    expect_equal(2 * t + Exact(0.5) + cos(Exact(2 * t)) / 2, Exact(3), 1e-23);
}

}  // namespace
}  // namespace polhode
