// What an attitude may be off where neither the user nor the scene says.
#pragma once

namespace polhode {

/// rad: 1/20 of a degree
constexpr double default_tolerated_attitude = 1e-3;

}  // namespace polhode
