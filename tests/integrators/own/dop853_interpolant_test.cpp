// DOP853's dense output: order, end points, cost, and accuracy of samples compared with steps.
#include "integrators/own/dop853_interpolant.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/scenes.h"

namespace polhode {
namespace {

/// Kepler's problem with mu = 1 and semi-major axis 1, from the periapsis on; counts evaluations.
struct CountedKepler {
    double eccentricity = 0.3;
    long* calls;

    void derivative(double, const double* y, double* dy) const {
        ++*calls;
        const double square = y[0] * y[0] + y[1] * y[1], pull = -1 / (square * std::sqrt(square));
        dy[0] = y[2], dy[1] = y[3], dy[2] = pull * y[0], dy[3] = pull * y[1];
    }
    /// t = E - e sin E, r = (cos E - e, sqrt(1 - e^2) sin E)
    Numbers<4> exact(double t) const {
        const double e = eccentricity, b = std::sqrt(1 - e * e);
        double E = t;
        for (int i = 0; i < 20; ++i) E -= (E - e * std::sin(E) - t) / (1 - e * std::cos(E));
        const double rate = 1 / (1 - e * std::cos(E));
        Numbers<4> y;
        y[0] = std::cos(E) - e, y[1] = b * std::sin(E), y[2] = -rate * std::sin(E), y[3] = rate * b * std::cos(E);
        return y;
    }
};

/// A step of length h from the exact state at t, and its interpolant.
struct Step {
    Numbers<4> start, change;
    std::array<Numbers<4>, dop853_stages> k;
    Dop853Interpolant<Numbers<4>> interpolant{4};

    Step(const CountedKepler& system, double t, double h) : start(system.exact(t)) {
        for (int s = 0; s < dop853_stages; ++s) {
            Numbers<4> y = start;
            for (int j = 0; j < s; ++j)
                for (std::size_t i = 0; i < 4; ++i) y[i] += h * dop853.a[s][j] * k[j][i];
            system.derivative(t + dop853.c[s] * h, y.data(), k[s].data());
        }
        for (std::size_t i = 0; i < 4; ++i) {
            change[i] = 0;
            for (int s = 0; s < dop853_stages; ++s) change[i] += h * dop853.b[s] * k[s][i];
        }
        interpolant.form(system, t, h, start.data(), change, k);
    }
};

double largest_error(const CountedKepler& system, double t, double h) {
    const Step step(system, t, h);
    double error = 0;
    for (int m = 1; m < 40; ++m) {
        const double x = m / 40.0;
        const Numbers<4> change = step.interpolant.change(x), exact = system.exact(t + x * h);
        for (std::size_t i = 0; i < 4; ++i) error = std::max(error, std::abs(step.start[i] + change[i] - exact[i]));
    }
    return error;
}

// halving h divides a local error of C h^9 by 512; Hairer's original interpolant would give 256
TEST(Dop853Interpolant, HasALocalErrorOfOrderNine) {
    long calls = 0;
    const CountedKepler system{.calls = &calls};
    for (const double t : {0.0, 0.25, 0.5}) {
        const double coarse = largest_error(system, t, 0.2), fine = largest_error(system, t, 0.1);
        EXPECT_GT(fine, 1e-13) << "too near to round-off";
        // measured: 8.72, 8.69 and 8.79; less at longer steps
        EXPECT_GT(std::log2(coarse / fine), 8.6) << t << ": " << coarse << ' ' << fine;
    }
}

TEST(Dop853Interpolant, MeetsTheStepAndItsRatesAtBothEnds) {
    long calls = 0;
    const CountedKepler system{.calls = &calls};
    constexpr double h = 0.4;
    const Step step(system, 1, h);
    const Numbers<4> at_start = step.interpolant.change(0), at_end = step.interpolant.change(1);
    Numbers<4> y = step.start, rate(4);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(at_start[i], 0);
        EXPECT_NEAR(at_end[i], step.change[i], 1e-15);
        y[i] += step.change[i];
    }
    system.derivative(1 + h, y.data(), rate.data());
    // one-sided second-order differences at 1e-5: errors h^2 y''' / 3 (1e-5)^2 ~ 1e-11 and round-off 1e-16 / 1e-5
    constexpr double d = 1e-5;
    const auto change = [&](double x) { return step.interpolant.change(x); };
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR((4 * change(d)[i] - change(2 * d)[i]) / (2 * d), h * step.k[0][i], 1e-9);
        EXPECT_NEAR((3 * change(1)[i] - 4 * change(1 - d)[i] + change(1 - 2 * d)[i]) / (2 * d), h * rate[i], 1e-9);
    }
}

TEST(Dop853Interpolant, EvaluatesAsManyRightHandSidesAsItSays) {
    long calls = 0;
    const Step step(CountedKepler{.calls = &calls}, 1, 0.4);
    EXPECT_EQ(calls, dop853_stages + Dop853Interpolant<Numbers<4>>::evaluations);
}

// dense output costs nine evaluations per step that contains samples, whatever their number
TEST(Dop853, PaysForSamplesOncePerStep) {
    const Problem problem = pose(testing::symmetric_body(10));
    Settings settings;
    settings.tolerance = 1e-8, settings.samples = 1000;
    const Trajectory many = solve(problem, *find_method("dop853"), settings);
    EXPECT_EQ(many.sample_evaluations, 9 * many.steps);
    settings.samples = 1;
    const Trajectory ends = solve(problem, *find_method("dop853"), settings);
    EXPECT_EQ(ends.sample_evaluations, 0);
    EXPECT_EQ(ends.rhs_evaluations, many.rhs_evaluations - many.sample_evaluations);
    EXPECT_EQ(ends.rhs_evaluations, 2 + 12 * (ends.steps + *ends.counts.rejected_steps));
    EXPECT_EQ(ends.samples.back().q, many.samples.back().q);
}

}  // namespace
}  // namespace polhode
