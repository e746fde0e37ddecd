// Numbers of the page's document: few digits, null for what is not there.
#pragma once

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "body/algebra.h"

namespace polhode {

using Json = nlohmann::ordered_json;

/// The number to so many significant digits; null if it is not finite.
Json number_json(double value, int digits);

/// A list of such numbers.
Json numbers_json(const std::vector<double>& values, int digits);

/// Places evenly over a list of so many, at most `most` of them, its first and last among them.
std::vector<std::size_t> spread(std::size_t count, std::size_t most);

/// Three numbers to six digits.
Json vector_json(const Vector3<double>& v);

/// Four numbers to eight digits: w, x, y, z.
Json quaternion_json(const Quaternion<double>& q);

}  // namespace polhode
