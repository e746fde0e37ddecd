// Square matrices of balls, stored by rows.
#pragma once

#include <cstddef>
#include <vector>

#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

/// a b at the thread's working precision; both are n by n.
std::vector<Ball> product(const std::vector<Ball>& a, const std::vector<Ball>& b, std::size_t n);

/// The inverse of an n by n matrix of doubles, taken exactly, computed with `bits` bits. If the inverse does not exist,
/// all balls are infinite, and so is every bound computed from them.
std::vector<Ball> inverse_of(const std::vector<double>& matrix, std::size_t n, long bits);

}  // namespace polhode::truth
