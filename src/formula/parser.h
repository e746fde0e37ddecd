// Parses formulas into operations of an Expression (expression.h).
//
// The parser descends recursively by precedence: or, and, not, comparison, + -, * /, unary minus, ^, components. Every
// value has a type: scalar, vector, quaternion or condition. Vectors are three scalar operations each. Names are
// resolved by a Scope, which the scene fills.
//
// The parser is hand-written because exprtk and muParser have neither vectors nor exact derivatives nor multiprecision,
// dual and traced scalars.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "formula/expression.h"

namespace polhode::formula {

/// The type of a value.
enum class Type { scalar, vector, quaternion };

/// "a scalar", "a vector" or "a quaternion".
const char* name_of(Type type);

/// A value: the nodes of its one, three or four components. Quaternions are (w, x, y, z).
struct Value {
    Type type = Type::scalar;
    std::array<int, 4> component{no_node, no_node, no_node, no_node};
};

/// A function of one variable, given by points with increasing x.
struct TableData {
    std::vector<double> x, y;
    bool cubic = false;  ///< piecewise cubic, monotone between points, with a continuous derivative; else linear
};

/// The motion of one of several bodies, for the position and the velocity of a point of it.
struct BodyScope {
    Value position;             ///< centre of mass, world axes
    Value velocity;             ///< centre of mass, world axes
    Value angular_velocity;     ///< body axes
    Value center;               ///< from the body's origin to the centre of mass, body axes
    std::array<int, 9> axes{};  ///< body axes to world axes, row by row
};

/// What the names in a formula mean.
struct Scope {
    std::map<std::string, Value, std::less<>> names;  ///< quantities, parameters and definitions
    std::map<std::string, TableData, std::less<>> tables;
    /// For at and velocity_at: bodies by name. Empty: these functions are not available.
    std::map<std::string, BodyScope, std::less<>> bodies;
    /// For to_body, to_world and the rotation functions: the attitude. Empty: these functions are not available.
    std::vector<int> attitude;
    /// For inertia(v): the tensor about the centre of mass, row by row, body axes. Empty: not available.
    std::vector<int> inertia;
};

/// A fault in a formula.
class FormulaError : public std::runtime_error {
  public:
    FormulaError(std::size_t column, const std::string& fault, const std::string& remedy)
        : std::runtime_error(fault), column_(column), remedy_(remedy) {}
    std::size_t column() const { return column_; }  ///< from 1
    const std::string& remedy() const { return remedy_; }

  private:
    std::size_t column_;
    std::string remedy_;
};

inline constexpr std::size_t most_formula_characters = 10'000;
inline constexpr int most_formula_depth = 100;

/// Appends the operations of a formula to the expression and returns its value. Throws FormulaError.
Value parse_formula(std::string_view text, const Scope& scope, Expression& expression);

/// The rotation matrix |q|^2 R(q) of a quaternion, row by row.
std::array<int, 9> rotation_matrix_nodes(Expression& expression, const std::vector<int>& q);
/// The product of a matrix, row by row, and a vector; `transposed`: of its transpose.
Value multiply_matrix(Expression& expression, const std::array<int, 9>& matrix, const Value& v, bool transposed);
/// The cross product.
Value cross_product(Expression& expression, const Value& a, const Value& b);

/// Whether a text can be a name: a letter or "_", then letters, digits and "_".
bool is_identifier(std::string_view text);
/// Whether the language uses the name itself: a function, a quantity of the state, or a word such as "and".
bool is_reserved(std::string_view name);

}  // namespace polhode::formula
