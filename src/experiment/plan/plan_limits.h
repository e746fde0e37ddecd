// Limits of experiments. They bound memory and time before anything is run.
#pragma once

#include <cstddef>

namespace polhode {

inline constexpr std::size_t most_entries = 10'000;              ///< of `scenes` and of `methods`
inline constexpr std::size_t most_varied = 64;                   ///< JSON pointers of `vary`
inline constexpr double most_variants = 10'000;                  ///< per scene: values of `vary` combined
inline constexpr double most_cases = 1'000'000;                  ///< scenes, variants, methods and settings combined
inline constexpr double largest_plan = 256 << 20;                ///< bytes of all scenes' texts and meshes
inline constexpr long most_range_values = 10'000;                ///< `count` of a range
inline constexpr long most_experiment_samples = 1'000'000;       ///< `samples`
inline constexpr long most_repeats = 1'000'000;                  ///< `repeats`
inline constexpr double most_seconds_per_run = 1e6;              ///< `seconds_per_run`
inline constexpr std::size_t longest_experiment_about = 10'000;  ///< bytes of `about`
inline constexpr std::size_t longest_label = 400;  ///< bytes of a varied scene's name; longer names end in a hash

/// Regular expressions: characters, nesting of parentheses, and characters with repetitions expanded.
inline constexpr std::size_t longest_expression = 500;
inline constexpr long deepest_parentheses = 50, most_unrolled = 1000;

}  // namespace polhode
