// Square matrices of balls, row by row.
#pragma once

#include <cstddef>
#include <vector>

#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

/// a b, at the thread's working precision; both n by n.
std::vector<Ball> product(const std::vector<Ball>& a, const std::vector<Ball>& b, std::size_t n);

/// The inverse of an n by n matrix of doubles, taken exactly, computed in so many bits. Where it cannot be inverted:
/// balls that are not finite, so that every bound made of them is infinite.
std::vector<Ball> inverse_of(const std::vector<double>& matrix, std::size_t n, long bits);

}  // namespace polhode::truth
