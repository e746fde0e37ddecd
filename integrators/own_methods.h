// Methods from outside the tree among polhode's own.
#pragma once

#include <memory>
#include <span>

#include "integrators/method.h"

namespace polhode {

/// Puts methods behind those of methods(), where every command and experiment finds them by name. To be called before
/// anything has asked for methods(), else std::logic_error is thrown; std::invalid_argument where a name is taken. They
/// outlive whatever uses them.
void add_methods(std::span<const Method> own);

/// Whether there are any that were put there so.
bool has_own_methods();

/// Puts a method behind those of methods(), or in the place of the one that was put there so under its name, at any
/// time: lists that were given out before stay as they are. Methods are kept as long as the program runs. Its identity
/// tells its results from others'. Throws std::invalid_argument where the name is one of the program's own or empty.
void add_method(std::shared_ptr<const Method> method);

}  // namespace polhode
