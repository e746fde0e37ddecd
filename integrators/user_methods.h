// Registration of user-defined methods in addition to those of the program.
#pragma once

#include <memory>
#include <span>

#include "integrators/method.h"

namespace polhode {

/// Appends methods to methods(), so that every command and experiment finds them by name. They must outlive all users.
/// Throws std::logic_error if methods() was called before, std::invalid_argument if a name is already in use.
void add_methods(std::span<const Method> own);

/// True if add_methods() has added any.
bool has_user_methods();

/// Appends a method to methods(), or replaces an earlier one that was added under this name, at any time. Lists that
/// were returned before stay unchanged. Methods are kept until the program ends. The identity distinguishes stored
/// results. Throws std::invalid_argument if the name is empty or belongs to a method of the program.
void add_method(std::shared_ptr<const Method> method);

}  // namespace polhode
