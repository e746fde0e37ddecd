// The names of the formula language, with one line of documentation each. The parser, its error messages and the
// language's reference page read these tables.
#pragma once

#include <span>
#include <string_view>

namespace polhode::formula {

/// A function of the language.
struct FunctionEntry {
    std::string_view name;
    std::string_view arguments;  ///< for example "x" or "y, x"
    std::string_view about;
};

/// A quantity of the state that formulas can read.
struct QuantityEntry {
    std::string_view name;
    std::string_view type;  ///< "scalar", "vector" or "quaternion"
    std::string_view unit;
    std::string_view about;
};

/// All functions, in the order of the reference page.
std::span<const FunctionEntry> formula_functions();

/// The quantities of a scene of one body. In a scene of several bodies, those of a body are written NAME.w, NAME.p, ..
std::span<const QuantityEntry> formula_quantities();

/// The quantities of a joint of one degree of freedom, written NAME.angle, NAME.rate, ..
std::span<const QuantityEntry> formula_joint_quantities();

}  // namespace polhode::formula
