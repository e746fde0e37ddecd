// Numbers of the page's document: rounded, and null if undefined.
#pragma once

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "body/algebra.h"

namespace polhode {

using Json = nlohmann::ordered_json;

/// `value` rounded to `digits` significant digits; null if it is not finite.
Json number_json(double value, int digits);

/// A list of numbers, each as by number_json().
Json numbers_json(const std::vector<double>& values, int digits);

/// At most `most` evenly spaced indices into a list of `count` entries, including the first and, if most > 1, the last.
std::vector<std::size_t> spread_indices(std::size_t count, std::size_t most);

/// The vector as three numbers with six digits.
Json vector_json(const Vector3<double>& v);

/// The quaternion as w, x, y, z with eight digits.
Json quaternion_json(const Quaternion<double>& q);

}  // namespace polhode
