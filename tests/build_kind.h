// The kind of build that the tests run in.
#pragma once

namespace polhode {

/// True in optimised builds. Other builds have assertions and mostly a sanitizer and are ten times slower; there
/// tests repeat less and have more time.
#ifdef NDEBUG
inline constexpr bool optimised_build = true;
#else
inline constexpr bool optimised_build = false;
#endif

}  // namespace polhode
