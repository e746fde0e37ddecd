#include "formula/expression.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace polhode::formula {
namespace {

std::uint64_t hash_of(const Node& node) {
    std::uint64_t hash = static_cast<std::uint64_t>(node.operation) << 8U | static_cast<std::uint64_t>(node.test);
    for (const std::uint64_t word :
         {static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.a)),
          static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.b)),
          static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.c)), std::bit_cast<std::uint64_t>(node.value)}) {
        hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 29U;
    }
    return hash;
}

// Results are folded only if they are exact: the rounding error of the operation is zero.
bool is_exact_sum(double a, double b, double sum) {
    const double part = sum - a;
    return std::isfinite(sum) && (a - (sum - part)) + (b - part) == 0;
}
bool is_exact_product(double a, double b, double product) {
    return std::isfinite(product) && std::fma(a, b, -product) == 0 && (std::abs(product) > 1e-290 || a == 0 || b == 0);
}

}  // namespace

int Expression::append(const Node& node) {
    std::vector<int>& same_hash = known_[hash_of(node)];
    for (const int other : same_hash)
        if (nodes_[index(other)] == node) return other;
    if (nodes_.size() >= most_operations) throw LimitError("has more than 10,000 operations");
    bool uniform = node.operation != Operation::input;
    if (node.operation == Operation::choose) {
        const Switch& one = switches_[index(node.a)];
        for (const int operand : {one.argument, one.threshold, node.b, node.c})
            uniform = uniform && (operand == no_node || is_uniform(operand));
    } else if (node.operation != Operation::constant && node.operation != Operation::input) {
        for (const int operand : {node.a, node.b, node.c})
            uniform = uniform && (operand == no_node || is_uniform(operand));
    }
    nodes_.push_back(node), uniform_.push_back(uniform);
    same_hash.push_back(static_cast<int>(nodes_.size()) - 1);
    return same_hash.back();
}

bool Expression::is_number(int node, double value) const {
    return nodes_[index(node)].operation == Operation::number && nodes_[index(node)].value == value;
}

int Expression::number(double value) {
    if (value == 0) value = 0;  // no negative zero
    return append({Operation::number, {}, no_node, no_node, no_node, value});
}
int Expression::pi() { return append(Operation::pi, no_node); }
int Expression::constant(int which) { return append(Operation::constant, which); }
int Expression::input(int which) { return append(Operation::input, which); }

int Expression::add(int a, int b) {
    if (is_number(a, 0)) return b;
    if (is_number(b, 0)) return a;
    if (is_number(a) && is_number(b) && is_exact_sum(value(a), value(b), value(a) + value(b)))
        return number(value(a) + value(b));
    if (nodes_[index(b)].operation == Operation::negate) return subtract(a, nodes_[index(b)].a);
    if (nodes_[index(a)].operation == Operation::negate) return subtract(b, nodes_[index(a)].a);
    if (a < b) std::swap(a, b);
    return append(Operation::add, a, b);
}
int Expression::subtract(int a, int b) {
    if (a == b) return number(0);
    if (is_number(b, 0)) return a;
    if (is_number(a, 0)) return negate(b);
    if (is_number(a) && is_number(b) && is_exact_sum(value(a), -value(b), value(a) - value(b)))
        return number(value(a) - value(b));
    if (nodes_[index(b)].operation == Operation::negate) return add(a, nodes_[index(b)].a);
    return append(Operation::subtract, a, b);
}
int Expression::multiply(int a, int b) {
    if (is_number(a, 0) || is_number(b, 0)) return number(0);
    if (is_number(a, 1)) return b;
    if (is_number(b, 1)) return a;
    if (is_number(a, -1)) return negate(b);
    if (is_number(b, -1)) return negate(a);
    if (is_number(a) && is_number(b) && is_exact_product(value(a), value(b), value(a) * value(b)))
        return number(value(a) * value(b));
    if (nodes_[index(a)].operation == Operation::negate) return negate(multiply(nodes_[index(a)].a, b));
    if (nodes_[index(b)].operation == Operation::negate) return negate(multiply(a, nodes_[index(b)].a));
    if (a < b) std::swap(a, b);
    return append(Operation::multiply, a, b);
}
int Expression::divide(int a, int b) {
    if (is_number(b, 1)) return a;
    if (is_number(a, 0) && !is_number(b, 0)) return a;
    if (is_number(a) && is_number(b) && value(b) != 0) {
        const double quotient = value(a) / value(b);
        if (is_exact_product(quotient, value(b), value(a)) && std::isfinite(quotient)) return number(quotient);
    }
    if (nodes_[index(a)].operation == Operation::negate) return negate(divide(nodes_[index(a)].a, b));
    return append(Operation::divide, a, b);
}
int Expression::negate(int a) {
    if (is_number(a)) return number(-value(a));
    if (nodes_[index(a)].operation == Operation::negate) return nodes_[index(a)].a;
    return append(Operation::negate, a);
}
int Expression::square_root(int a) {
    if (is_number(a) && value(a) >= 0) {
        const double root = std::sqrt(value(a));
        if (is_exact_product(root, root, value(a))) return number(root);
    }
    return append(Operation::square_root, a);
}
int Expression::apply(Operation operation, int a) {
    if (operation == Operation::square_root) return square_root(a);
    return append(operation, a);
}
int Expression::arctangent(int y, int x) { return append(Operation::arctangent, y, x); }

int Expression::integer_power(int base, long exponent) {
    if (exponent < 0) return divide(number(1), integer_power(base, -exponent));
    if (exponent == 0) return number(1);
    int result = no_node;
    for (int square = base;; square = multiply(square, square)) {
        if (exponent % 2 == 1) result = result == no_node ? square : multiply(result, square);
        exponent /= 2;
        if (exponent == 0) return result;
    }
}

int Expression::power(int base, int exponent) {
    constexpr double most_factors = 1024;
    if (is_number(exponent) && std::abs(value(exponent)) <= most_factors) {
        const double twice = 2 * value(exponent);
        if (twice == std::round(twice)) {
            const long halves = static_cast<long>(twice);
            return integer_power(halves % 2 == 0 ? base : square_root(base), halves % 2 == 0 ? halves / 2 : halves);
        }
    }
    if (is_uniform(exponent)) return append(Operation::power, base, exponent);
    return append(Operation::exponential, multiply(exponent, append(Operation::logarithm, base)));
}

int Expression::compare(int a, int b, const std::string& text) {
    // the sign of a - b, with the part that does not depend on the inputs as the threshold
    Switch one{subtract(a, b), no_node, text};
    if (is_uniform(b) && !is_number(b, 0)) one = {a, b, text};
    for (std::size_t i = 0; i < switches_.size(); ++i)
        if (switches_[i].argument == one.argument && switches_[i].threshold == one.threshold)
            return static_cast<int>(i);
    switches_.push_back(one);
    return static_cast<int>(switches_.size()) - 1;
}

int Expression::choose(int which_switch, Test test, int if_passed, int otherwise) {
    if (if_passed == otherwise) return if_passed;
    return append({Operation::choose, test, which_switch, if_passed, otherwise, 0});
}

int Expression::hold(int argument, int period) {
    if (is_uniform(argument)) return argument;
    for (const Hold& one : holds_)
        if (one.argument == argument && one.period == period) return input(one.input);
    holds_.push_back({argument, period, first_hold_ + static_cast<int>(holds_.size())});
    return input(holds_.back().input);
}

// Adds d(node)/d(operand) times the adjoint of the node to the adjoint of each operand.
void Expression::add_adjoints(int node, int adjoint, std::vector<int>& adjoints) {
    const auto contribute = [&](int operand, int amount) {
        int& sum = adjoints[index(operand)];
        sum = sum == no_node ? amount : add(sum, amount);
    };
    const Node n = nodes_[index(node)];
    const auto squared = [&](int a) { return multiply(a, a); };
    const auto one_plus = [&](int a) { return add(number(1), a); };
    switch (n.operation) {
        case Operation::number:
        case Operation::pi:
        case Operation::constant:
        case Operation::input:
            return;
        case Operation::add:
            contribute(n.a, adjoint), contribute(n.b, adjoint);
            return;
        case Operation::subtract:
            contribute(n.a, adjoint), contribute(n.b, negate(adjoint));
            return;
        case Operation::multiply:
            contribute(n.a, multiply(adjoint, n.b)), contribute(n.b, multiply(adjoint, n.a));
            return;
        case Operation::divide:
            contribute(n.a, divide(adjoint, n.b)), contribute(n.b, negate(divide(multiply(adjoint, node), n.b)));
            return;
        case Operation::negate:
            contribute(n.a, negate(adjoint));
            return;
        case Operation::square_root:
            contribute(n.a, divide(adjoint, add(node, node)));
            return;
        case Operation::sine:
            contribute(n.a, multiply(adjoint, append(Operation::cosine, n.a)));
            return;
        case Operation::cosine:
            contribute(n.a, negate(multiply(adjoint, append(Operation::sine, n.a))));
            return;
        case Operation::exponential:
            contribute(n.a, multiply(adjoint, node));
            return;
        case Operation::logarithm:
            contribute(n.a, divide(adjoint, n.a));
            return;
        case Operation::arctangent: {
            const int scaled = divide(adjoint, add(squared(n.a), squared(n.b)));
            contribute(n.a, multiply(scaled, n.b)), contribute(n.b, negate(multiply(scaled, n.a)));
            return;
        }
        case Operation::arcsine:
        case Operation::arccosine: {
            const int slope = divide(adjoint, square_root(subtract(number(1), squared(n.a))));
            contribute(n.a, n.operation == Operation::arcsine ? slope : negate(slope));
            return;
        }
        case Operation::hyperbolic_tangent:
            contribute(n.a, multiply(adjoint, subtract(number(1), squared(node))));
            return;
        case Operation::hyperbolic_sine:
            contribute(n.a, multiply(adjoint, square_root(one_plus(squared(node)))));
            return;
        case Operation::cube_root:
            contribute(n.a, divide(adjoint, multiply(number(3), squared(node))));
            return;
        case Operation::power:
            contribute(n.a, multiply(adjoint, divide(multiply(n.b, node), n.a)));
            return;
        case Operation::choose:
            contribute(n.b, choose(n.a, n.test, adjoint, number(0)));
            contribute(n.c, choose(n.a, n.test, number(0), adjoint));
            return;
    }
}

std::vector<int> Expression::differentiate(int node, const std::vector<int>& inputs) {
    std::vector<int> places;
    for (const int which : inputs) places.push_back(input(which));
    const int size = static_cast<int>(nodes_.size());
    std::vector<int> adjoints(nodes_.size(), no_node);
    adjoints[index(node)] = number(1);
    for (int i = size; i-- > 0;)
        if (adjoints[index(i)] != no_node && !is_uniform(i)) {
            const int adjoint = adjoints[index(i)];
            adjoints.resize(std::max(adjoints.size(), nodes_.size()), no_node);
            add_adjoints(i, adjoint, adjoints);
        }
    std::vector<int> result;
    for (const int place : places)
        result.push_back(adjoints[index(place)] == no_node ? number(0) : adjoints[index(place)]);
    return result;
}

std::vector<char> find_needed(const Expression& expression, const std::vector<int>& outputs, const signed char* signs) {
    const std::vector<Node>& nodes = expression.nodes();
    std::vector<char> needed(nodes.size(), 0);
    std::vector<int> pending = outputs;
    const auto visit = [&](int node) {
        if (node != no_node && !needed[static_cast<std::size_t>(node)]) pending.push_back(node);
    };
    while (!pending.empty()) {
        const int next = pending.back();
        pending.pop_back();
        if (needed[static_cast<std::size_t>(next)]) continue;
        needed[static_cast<std::size_t>(next)] = 1;
        const Node& node = nodes[static_cast<std::size_t>(next)];
        if (node.operation == Operation::choose) {
            const Switch& one = expression.switches()[static_cast<std::size_t>(node.a)];
            visit(one.argument), visit(one.threshold);
            const bool passed = signs && passes(node.test, signs[node.a]);
            if (!signs || passed) visit(node.b);
            if (!signs || !passed) visit(node.c);
        } else if (node.operation != Operation::constant && node.operation != Operation::input) {
            visit(node.a), visit(node.b), visit(node.c);
        }
    }
    return needed;
}

}  // namespace polhode::formula
