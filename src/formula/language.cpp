#include "formula/language.h"

namespace polhode::formula {
namespace {

constexpr FunctionEntry function_table[] = {
    {"sqrt", "x", "square root"},
    {"cbrt", "x", "real cube root"},
    {"exp", "x", "e^x"},
    {"log", "x", "natural logarithm"},
    {"sin", "x", "sine of an angle in rad"},
    {"cos", "x", "cosine of an angle in rad"},
    {"tan", "x", "tangent of an angle in rad"},
    {"asin", "x", "arcsine, rad"},
    {"acos", "x", "arccosine, rad"},
    {"atan", "x", "arctangent, rad"},
    {"atan2", "y, x", "angle of the point (x, y), rad, in (-pi, pi]"},
    {"sinh", "x", "hyperbolic sine"},
    {"cosh", "x", "hyperbolic cosine"},
    {"tanh", "x", "hyperbolic tangent"},
    {"hypot", "x, y", "sqrt(x^2 + y^2)"},
    {"abs", "x", "absolute value; switches at x = 0"},
    {"sign", "x", "-1, 0 or 1; switches at x = 0"},
    {"min", "x, y", "smaller value; switches at x = y"},
    {"max", "x, y", "larger value; switches at x = y"},
    {"clamp", "x, low, high", "x limited to the range; switches at both limits"},
    {"step", "x", "0 for x < 0, else 1; switches at x = 0"},
    {"if", "condition, a, b", "a if the condition is true, else b; switches where a comparison changes"},
    {"table", "name, x", "value of a table of the scene at x; switches at the points of the table"},
    {"hold", "x, h", "value of a scalar or a vector at the last multiple of h, s: a sampled signal (zero-order hold)"},
    {"dot", "a, b", "dot product of two vectors"},
    {"cross", "a, b", "cross product of two vectors"},
    {"norm", "v", "length of a vector"},
    {"unit", "v", "v / norm(v)"},
    {"to_body", "v", "a vector in world axes, converted to body axes"},
    {"to_world", "v", "a vector in body axes, converted to world axes"},
    {"inertia", "v", "I v with the inertia tensor about the centre of mass, body axes"},
    {"at", "body, point", "position of a point of a body of several, given from its origin in its axes; world axes"},
    {"velocity_at", "body, point", "velocity of a point of a body of several; world axes"},
    {"rotation_error", "q0", "2 sign(r_w) (r_x, r_y, r_z) of r = q0* q, body axes; switches at r_w = 0"},
    {"rotation_vector", "q0", "axis times angle of r = q0* q, rad, body axes; undefined at r = 1; switches at r_w = 0"},
};

constexpr QuantityEntry quantity_table[] = {
    {"t", "scalar", "s", "time"},
    {"q", "quaternion", "", "attitude, body axes to world axes; only as an argument of a function"},
    {"w", "vector", "rad/s", "angular velocity, body axes"},
    {"w_W", "vector", "rad/s", "angular velocity, world axes"},
    {"p", "vector", "m", "position of the centre of mass, world axes"},
    {"v", "vector", "m/s", "velocity of the centre of mass, world axes"},
    {"mass", "scalar", "kg", "mass of the body"},
    {"pi", "scalar", "", "ratio of a circle's circumference to its diameter"},
};

constexpr QuantityEntry joint_table[] = {
    {"angle", "scalar", "rad", "angle of a revolute joint, including full revolutions"},
    {"rate", "scalar", "rad/s", "rate of the angle"},
    {"displacement", "scalar", "m", "displacement of a prismatic joint"},
    {"speed", "scalar", "m/s", "rate of the displacement"},
};

}  // namespace

std::span<const FunctionEntry> formula_functions() { return function_table; }
std::span<const QuantityEntry> formula_quantities() { return quantity_table; }
std::span<const QuantityEntry> formula_joint_quantities() { return joint_table; }

}  // namespace polhode::formula
