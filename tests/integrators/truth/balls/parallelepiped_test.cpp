// Sets that rotate and shear: points followed individually stay inside, and a rotation does not widen the set.
#include "integrators/truth/balls/parallelepiped.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace polhode::truth {
namespace {

std::vector<Bound> bounds(const std::vector<double>& values) {
    std::vector<Bound> result;
    for (const double value : values) result.emplace_back(value);
    return result;
}

std::vector<Ball> balls(const std::vector<double>& values) {
    std::vector<Ball> result;
    for (const double value : values) result.emplace_back(value);
    return result;
}

double small(int number) { return number % 1000 / 500.0; }

// Steps e <- W e + a with |a_i| <= added_i, followed with 2000 bits.
RC_GTEST_PROP(Parallelepiped, HoldsWhatIsFollowedPointByPoint, ()) {
    constexpr int n = 3, steps = 6;
    const auto numbers =
        *rc::gen::container<std::vector<int>>(2 * n + steps * (n * n + 2 * n), rc::gen::inRange(-999, 1000));
    std::size_t next = 0;
    const auto number = [&] { return small(numbers[next++]); };
    const WorkingPrecision precision(2000);
    std::vector<double> radius;
    std::vector<Ball> e;
    for (int i = 0; i < n; ++i) {
        radius.push_back(std::abs(number()) * 1e-300);
        e.push_back(Ball(radius.back()) * Ball(number() / 2));
    }
    Parallelepiped set({1, 1e6, 1e-3}, bounds(radius));
    for (int step = 0; step < steps; ++step) {
        std::vector<double> W, added;
        std::vector<Ball> moved(n);
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                W.push_back(number());
                moved[i] += Ball(W.back()) * e[j];
            }
        }
        for (int i = 0; i < n; ++i) {
            added.push_back(std::abs(number()) * 1e-301);
            moved[i] += Ball(added.back()) * Ball(number() / 2);
        }
        const std::vector<Bound> image = set.components_after(balls(W));
        set.advance(balls(W), bounds(added));
        e = moved;
        const std::vector<Bound> component = set.components();
        for (int i = 0; i < n; ++i) {
            // the bounds of |e_i| are themselves rounded up in their 30th bit
            RC_ASSERT(Bound(e[i]).near() <= component[i].near() * (1 + 1e-8));
            RC_ASSERT(Bound(e[i]).near() <= (image[i] + Bound(added[i])).near() * (1 + 1e-8));
        }
    }
}

// A box rotated by 0.5 rad and enclosed in a box again would widen at each step. A parallelepiped keeps its size.
TEST(Parallelepiped, TurnsWithoutWrapping) {
    const WorkingPrecision precision(128);
    Parallelepiped set({1, 1}, bounds({1e-30, 1e-30}));
    const double c = std::cos(0.5), s = std::sin(0.5);
    for (int step = 0; step < 10'000; ++step) set.advance(balls({c, -s, s, c}), bounds({0, 0}));
    for (const Bound& component : set.components()) EXPECT_LT(component.near(), 1.5e-30);
}

// e1 <- e1 + e2 / 8, e2 <- e2: the shear grows linearly in time, and the contribution of each step quadratically.
TEST(Parallelepiped, ShearsWithoutExponentialGrowth) {
    const WorkingPrecision precision(128);
    constexpr int steps = 4096;
    Parallelepiped set({1, 1}, bounds({1e-30, 1e-30}));
    for (int step = 0; step < steps; ++step) set.advance(balls({1, 0.125, 0, 1}), bounds({1e-34, 1e-34}));
    const std::vector<Bound> component = set.components();
    const double second = 1e-30 + steps * 1e-34, first = second + steps * 0.125 * second;
    EXPECT_GE(component[0].near(), first * 0.75);  // the sum over steps contributes only half of steps^2
    EXPECT_LT(component[0].near(), 20 * first);
    EXPECT_LT(component[1].near(), 20 * second);
}

}  // namespace
}  // namespace polhode::truth
