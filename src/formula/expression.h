// Expressions as a flat list of scalar operations in single-assignment form. Operands precede their operation.
//
// Main types: Node (one operation), Switch (a comparison on which the value depends), Expression (the list, with
// functions that append operations). Equal operations are shared. Operations on numbers are folded only if the result
// is exact in binary64, so that an expression has the same value in every scalar as the formula it was made from.
// evaluate.h evaluates an expression over any scalar.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace polhode::formula {

/// What a node computes from its operands a, b and c.
enum class Operation : std::uint8_t {
    number,              ///< `value`
    pi,                  ///< the ratio of a circle's circumference to its diameter
    constant,            ///< constant number a of the evaluation, known only in the scalar of the evaluation
    input,               ///< input number a: time or state
    add,                 ///< a + b
    subtract,            ///< a - b
    multiply,            ///< a b
    divide,              ///< a / b
    negate,              ///< -a
    square_root,         ///< the square root of a
    sine,                ///< sin a
    cosine,              ///< cos a
    exponential,         ///< e^a
    logarithm,           ///< the natural logarithm of a
    arctangent,          ///< the angle of the point (b, a), in (-pi, pi]
    arcsine,             ///< asin a
    arccosine,           ///< acos a
    hyperbolic_tangent,  ///< tanh a
    hyperbolic_sine,     ///< sinh a
    cube_root,           ///< the real cube root of a
    power,               ///< a^b, a > 0; b does not depend on the inputs
    choose,              ///< b if switch a passes `test`, else c
};

/// The condition of a `choose` on the sign s of a switch.
enum class Test : std::uint8_t {
    positive,      ///< s > 0
    not_negative,  ///< s >= 0
    negative,      ///< s < 0
    not_positive,  ///< s <= 0
};
/// Whether a sign (-1, 0, 1) passes a test.
constexpr bool passes(Test test, int sign) {
    switch (test) {
        case Test::positive:
            return sign > 0;
        case Test::not_negative:
            return sign >= 0;
        case Test::negative:
            return sign < 0;
        case Test::not_positive:
            break;
    }
    return sign <= 0;
}

/// No operand.
inline constexpr int no_node = -1;

/// One operation. Operands are indices of earlier nodes, except where Operation says otherwise.
struct Node {
    Operation operation = Operation::number;
    Test test = Test::positive;  ///< choose
    int a = no_node, b = no_node, c = no_node;
    double value = 0;  ///< number

    bool operator==(const Node&) const = default;
};

/// The sign of node `argument` minus node `threshold`, on which `choose` nodes depend. The threshold does not depend on
/// the inputs.
struct Switch {
    int argument = no_node;
    int threshold = no_node;  ///< no_node: zero
    std::string text;         ///< the part of the formula, for messages
};

/// A value that is sampled at multiples of a period and held between them. It is an input of the expression.
struct Hold {
    int argument = no_node;  ///< the node that is sampled
    int period = no_node;    ///< the node of the period, s, which does not depend on the inputs
    int input = 0;           ///< number of the input
};

/// More operations, or deeper nesting, than the limits permit.
class LimitError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Limit on the number of operations of an expression.
inline constexpr std::size_t most_operations = 10'000;

/// Whether the scalar equations of a tape cannot express the operation, so that its value becomes a variable.
constexpr bool is_transcendental(Operation operation) {
    return operation >= Operation::exponential && operation <= Operation::power;
}

/// A list of operations. The functions append an operation, unless an equal one exists, and return its index. They
/// throw LimitError beyond most_operations.
class Expression {
  public:
    const std::vector<Node>& nodes() const { return nodes_; }
    const std::vector<Switch>& switches() const { return switches_; }
    /// Whether the node depends on no input.
    bool is_uniform(int node) const { return uniform_[index(node)]; }

    int number(double value);
    int pi();
    int constant(int which);
    int input(int which);
    int add(int a, int b);
    int subtract(int a, int b);
    int multiply(int a, int b);
    int divide(int a, int b);
    int negate(int a);
    int square_root(int a);
    /// An operation of one operand: square_root, sine, .., cube_root.
    int apply(Operation operation, int a);
    /// The angle of the point (x, y).
    int arctangent(int y, int x);
    /// base^exponent. A number that is an integer or half an integer needs products and a square root only.
    int power(int base, int exponent);
    /// The switch with the sign of a - b; `text` describes it.
    int compare(int a, int b, const std::string& text);
    int choose(int which_switch, Test test, int if_passed, int otherwise);

    /// The values that are held, in the order of their inputs. The argument of a value may be a value before it.
    const std::vector<Hold>& holds() const { return holds_; }
    /// Makes held values available; they become the inputs from `first` on.
    void allow_holds(int first) { first_hold_ = first; }
    bool allows_holds() const { return first_hold_ >= 0; }
    /// The value of a node at the last multiple of a period.
    int hold(int argument, int period);

    /// Derivatives of a node with respect to the inputs with these numbers, by the reverse mode.
    std::vector<int> differentiate(int node, const std::vector<int>& inputs);

    /// Whether the node is this number.
    bool is_number(int node, double value) const;

  private:
    std::vector<Node> nodes_;
    std::vector<Switch> switches_;
    std::vector<char> uniform_;
    std::vector<Hold> holds_;
    int first_hold_ = -1;
    std::unordered_map<std::uint64_t, std::vector<int>> known_;

    static std::size_t index(int node) { return static_cast<std::size_t>(node); }
    int append(const Node& node);
    int append(Operation operation, int a, int b = no_node) { return append({operation, {}, a, b, no_node, 0}); }
    bool is_number(int node) const { return nodes_[index(node)].operation == Operation::number; }
    double value(int node) const { return nodes_[index(node)].value; }
    int integer_power(int base, long exponent);
    void add_adjoints(int node, int adjoint, std::vector<int>& adjoints);
};

/// The nodes on which `outputs` depend. With `signs` (one per switch) only the branches that they select count.
/// Arguments of the switches of counted branches are included.
std::vector<char> find_needed(const Expression& expression, const std::vector<int>& outputs,
                              const signed char* signs = nullptr);

}  // namespace polhode::formula
