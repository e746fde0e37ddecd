// Limits on JSON texts: scene files, experiment files, files of engines.
#pragma once

#include <cstddef>

namespace polhode {

inline constexpr std::size_t largest_json = 16 << 20;       ///< bytes
inline constexpr std::size_t most_json_values = 1'000'000;  ///< numbers, strings, arrays and objects
inline constexpr std::size_t deepest_json = 64;             ///< nested objects and arrays

}  // namespace polhode
