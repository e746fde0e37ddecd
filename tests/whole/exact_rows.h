// Rows of the reference, compared in 50 digits.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "integrators/series/real.h"
#include "integrators/truth/reference.h"

namespace polhode {

using Exact = Real<50>;

/// Columns of a row of the reference after t.
inline constexpr std::size_t attitude = 0, spin = 4, position = 7, velocity = 10;

inline Exact number(const DecimalColumns& row, std::size_t column) { return Exact(row.at(column)); }

inline void expect_equal(const Exact& actual, const Exact& expected, double tolerance = 1e-23) {
    EXPECT_LE(double(abs(Exact(actual - expected))), tolerance) << actual << " instead of " << expected;
}

}  // namespace polhode
