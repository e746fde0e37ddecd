#include "integrators/analysis/linear_stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "integrators/run/amplification.h"

namespace polhode {
namespace {

const double infinity = std::numeric_limits<double>::infinity();
using Complex = std::complex<double>;

struct Intervals {
    const char* method;
    double real, imaginary;
};

// E. Hairer & G. Wanner 1996, IV.2 (explicit methods of order p in p stages), IV.3, IV.5 and IV.7 (A-stable methods).
// Oscillator by half kicks or by alternating updates (L. Verlet 1967): h omega <= 2.
TEST(LinearStability, HasThePublishedIntervals) {
    const Intervals published[] = {
        {"odeint_euler", 2, 0},
        {"arkode_erk2", 2, 0},
        {"arkode_erk3", 2.5127453266, std::sqrt(3.0)},
        {"odeint_rk4", 2.7852935634, 2 * std::numbers::sqrt2},
        {"munthe_kaas4", 2.7852935634, 2 * std::numbers::sqrt2},
        {"implicit_midpoint", infinity, infinity},
        {"simo_wong", infinity, infinity},
        {"radau5", infinity, infinity},
        {"radau13", infinity, infinity},
        {"odeint_rosenbrock4", infinity, infinity},
        {"arkode_dirk4", infinity, infinity},
        {"article_mended", 2, 2},
        {"splitting2", infinity, 2},
        {"fleck_quaternion", 2, 0},
    };
    for (const Intervals& expected : published) {
        const Method* method = find_method(expected.method);
        ASSERT_NE(method, nullptr) << expected.method;
        const double real = *real_interval(*method), imaginary = *imaginary_interval(*method);
        if (std::isinf(expected.real))
            EXPECT_EQ(real, expected.real) << expected.method;
        else
            EXPECT_NEAR(real, expected.real, 1e-6) << expected.method;
        if (std::isinf(expected.imaginary))
            EXPECT_EQ(imaginary, expected.imaginary) << expected.method;
        else
            EXPECT_NEAR(imaginary, expected.imaginary, 1e-6) << expected.method;
    }
}

// The stability polynomial in Hairer & Wanner 1996, IV.2: the sum of z^j / j! up to j = 5, plus z^6 / 600.
TEST(LinearStability, OfDormandAndPrinceIsThatOfTheirPolynomial) {
    const Method& method = *find_method("odeint_dopri5");
    for (const Complex z : {Complex(-1, 0), Complex(-3, 1), Complex(0.3, 2), Complex(0, -4)}) {
        Complex sum = 1, term = 1;
        for (int j = 1; j <= 5; ++j) sum += term *= z / static_cast<double>(j);
        sum += std::pow(z, 6) / 600.0;
        EXPECT_NEAR(method.amplification(z), std::abs(sum), 1e-13 * (1 + std::abs(sum)));
    }
    EXPECT_NEAR(*real_interval(method), 3.306567, 1e-5);
}

// the same method with coefficients from two libraries
TEST(LinearStability, IsTheSameByEitherLibrary) {
    for (const auto& [a, b] :
         {std::pair("odeint_fehlberg78", "arkode_erk8"), std::pair("odeint_cash_karp54", "arkode_erk5")})
        for (const Complex z : {Complex(-1, 0), Complex(-4, 2), Complex(0.3, 2), Complex(0, -5)}) {
            const double first = find_method(a)->amplification(z);
            EXPECT_NEAR(first, find_method(b)->amplification(z), 1e-12 * (1 + first)) << a << z;
        }
}

// for Euler's method |1 + r exp(i phi)| = 1 at r = -2 cos(phi)
TEST(LinearStability, GoesAlongAnyRay) {
    const Method& euler = *find_method("odeint_euler");
    for (const double angle : {3.0, 2.5, 2.0, 1.6})
        EXPECT_NEAR(*stable_length(euler, angle), -2 * std::cos(angle), 1e-6) << angle;
    EXPECT_EQ(*stable_length(euler, 1), 0);
    EXPECT_EQ(stable_length(*find_method("exact"), 2), std::nullopt);
    EXPECT_EQ(linear_amplification(*find_method("taylor"), -1), std::nullopt);
}

TEST(LinearStability, ReachesFarWithoutOverflow) {
    for (const Method* method : methods())
        for (const Complex z : {Complex(-1e8, 0), Complex(-1e100, 1e100), Complex(0, 1e-200), Complex(0, 0)})
            if (const std::optional<double> growth = linear_amplification(*method, z)) {
                EXPECT_FALSE(std::isnan(*growth)) << method->name << z;
                EXPECT_GE(*growth, 0) << method->name << z;
                // the eigenvalues of a pendulum at rest are both 1: rounding changes a double root by sqrt(2^-53)
                if (std::abs(z) < 1) {
                    EXPECT_NEAR(*growth, 1, 2e-8) << method->name << z;
                }
            }
}

/// A pendulum on a torsional spring, about a principal axis of an asymmetric body.
Scene pendulum(double h, double damping, double stiffness, double angle, double rate) {
    const double moment = 3;
    Scene scene;
    scene.name = "pendulum", scene.duration = h;
    scene.body.inertia_B = diagonal(Vector3<double>(2, 2.5, moment));
    scene.initial.orientation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    scene.initial.angular_velocity = {0, 0, rate};
    if (damping > 0) {
        Drag drag;
        drag.rotational = {0, 0, moment * damping / h};
        scene.loads.emplace_back(drag);
    }
    if (stiffness > 0) {
        Spring spring;
        spring.stiffness = moment * stiffness / (h * h);
        scene.loads.emplace_back(spring);
    }
    return scene;
}

/// The spectral radius of one step of the method, measured from two initial states.
std::optional<double> measured_growth(const Method& method, double damping, double stiffness) {
    constexpr double h = 0.5, small = 1e-4;
    double column[2][2];
    for (int i = 0; i < 2; ++i) {
        const Scene scene = pendulum(h, damping, stiffness, i == 0 ? small : 0, i == 1 ? small / h : 0);
        Settings settings;
        settings.step = h, settings.samples = 1;
        const Trajectory run = solve(scene, method, settings);
        if (run.status != Status::ok) return std::nullopt;
        const Sample& end = run.samples.back();
        column[i][0] = 2 * std::atan2(end.q.z, end.q.w) / small;
        column[i][1] = end.angular_velocity_B[2] * h / small;
    }
    return spectral_radius(column[0][0], column[1][0], column[0][1], column[1][1]);
}

TEST(LinearStability, IsThatOfTheStepsTaken) {
    int compared = 0;
    for (const Method* method : methods()) {
        if (method->name.ends_with("_float32")) {
            const Method& wide = *find_method(method->name.substr(0, method->name.size() - 8));
            EXPECT_EQ(method->amplification, wide.amplification) << method->name;
            EXPECT_EQ(method->pendulum_amplification, wide.pendulum_amplification) << method->name;
            continue;
        }
        // skipped: methods with their own springs, a multistep method, and methods without fixed steps
        if (method->name.starts_with("point_") || method->name == "odeint_adams_bashforth_moulton" ||
            !takes_step(*method))
            continue;
        for (const auto& [damping, stiffness] : {std::pair(0.3, 0.0), std::pair(0.0, 0.5), std::pair(0.7, 1.1),
                                                 std::pair(2.5, 3.0), std::pair(3.0, 0.4)}) {
            double expected = 0;
            if (method->amplification) {
                const Complex root = std::sqrt(Complex(damping * damping / 4 - stiffness));
                expected =
                    std::max(method->amplification(-damping / 2 + root), method->amplification(-damping / 2 - root));
            } else if (method->pendulum_amplification) {
                expected = method->pendulum_amplification(damping, stiffness);
            } else {
                continue;
            }
            const std::optional<double> measured = measured_growth(*method, damping, stiffness);
            ASSERT_TRUE(measured) << method->name << ' ' << damping << ' ' << stiffness;
            EXPECT_NEAR(*measured, expected, 1e-6 * (1 + expected))
                << method->name << ' ' << damping << ' ' << stiffness;
            ++compared;
        }
    }
    EXPECT_GT(compared, 5 * 35);
}

// drag only, 400 steps: the motion decays within the stability interval and grows beyond it
TEST(LinearStability, OfAdamsMethodIsThatOfALongRun) {
    const Method& adams = *find_method("odeint_adams_bashforth_moulton");
    const double interval = *real_interval(adams);
    EXPECT_GT(interval, 0.1);
    for (const double share : {0.95, 1.05}) {
        Scene scene = pendulum(0.5, share * interval, 0, 0, 1e-4);
        scene.duration *= 400;
        Settings settings;
        settings.step = 0.5, settings.samples = 1;
        const Trajectory run = solve(scene, adams, settings);
        const bool grew = run.status != Status::ok || std::abs(run.samples.back().angular_velocity_B[2]) > 1e-4;
        EXPECT_EQ(grew, share > 1) << interval;
    }
}

}  // namespace
}  // namespace polhode
