// Chebyshev series compared with explicit polynomials.
#include "integrators/truth/balls/chebyshev.h"

#include <gtest/gtest.h>

namespace polhode::truth {
namespace {

// f = 1 - 3 x + 2 x^2 + x^3, g = 2 x - x^2
Ball f(const Ball& x) { return Ball(1) + x * (Ball(-3) + x * (Ball(2) + x)); }
Ball f_slope(const Ball& x) { return Ball(-3) + x * (Ball(4) + Ball(3) * x); }
Ball g(const Ball& x) { return x * (Ball(2) - x); }

ChebyshevSeries series(Ball (*function)(const Ball&), int points) {
    std::vector<Ball> values;
    for (int i = 0; i < points; ++i) values.push_back(function(chebyshev_point(i, points)));
    return interpolated(values);
}

TEST(ChebyshevSeries, InterpolatesMultipliesAndDiffers) {
    const WorkingPrecision precision(128);
    const ChebyshevSeries a = series(f, 4), b = series(g, 6);
    for (const double t : {-1.0, -0.625, 0.0, 0.375, 1.0}) {
        const Ball x(t);
        EXPECT_TRUE((value_at(a, x) - f(x)).contains_zero());
        EXPECT_TRUE((value_at(b, x) - g(x)).contains_zero());
        const Ball both = value_at(product(a, b), x);
        EXPECT_TRUE((both - f(x) * g(x)).contains_zero());
        EXPECT_LT(Bound::radius_of(both).near(), 1e-30);
        EXPECT_TRUE((value_at(derivative(a), x) - f_slope(x)).contains_zero());
    }
}

TEST(ChebyshevSeries, BoundsHoldAndAreNotFarOff) {
    const WorkingPrecision precision(128);
    const ChebyshevSeries a = series(f, 4);
    // the largest values are |f(-1)| = 5 and |f'(-1)| = 4; a sum of absolute values is at most 4 times larger here
    EXPECT_GE(sum_of(a).near(), 5);
    EXPECT_LE(sum_of(a).near(), 20);
    EXPECT_GE(slope_of(a).near(), 4);
    EXPECT_LE(slope_of(a).near(), 16);
}

}  // namespace
}  // namespace polhode::truth
