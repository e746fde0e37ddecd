// Methods from outside the tree among polhode's own.
#pragma once

#include <span>

#include "integrators/method.h"

namespace polhode {

/// Puts methods behind those of methods(), where every command and experiment finds them by name. To be called before
/// anything has asked for methods(), else std::logic_error is thrown; std::invalid_argument where a name is taken. They
/// outlive whatever uses them.
void add_methods(std::span<const Method> own);

/// Whether there are any.
bool has_own_methods();

}  // namespace polhode
