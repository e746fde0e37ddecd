// Which build the tests run in.
#pragma once

namespace polhode {

/// Optimised. Else with assertions and mostly under a sanitizer, ten times as slow: such a build repeats less and is
/// given more time.
#ifdef NDEBUG
inline constexpr bool optimised_build = true;
#else
inline constexpr bool optimised_build = false;
#endif

}  // namespace polhode
