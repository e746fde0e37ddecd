// Evaluates expressions over any scalar.
//
// P is the scalar of constants, S that of the inputs. Nodes that depend on no input are computed once, in P
// (compute_uniform_values()). All others are computed by Evaluation:
//
//   * For numbers (binary32 to multiprecision) and dual numbers, transcendental functions are computed from their
//     arguments, and switches either from the values or from given signs.
//   * A traced scalar records operations and has no value. The signs of all switches must be given. Transcendental
//     functions are read from additional variables of the system ("auxiliaries"), whose rates follow by the chain rule
//     along the motion: for e = exp(u), de/dt = e du/dt. The equations then consist of +, -, *, /, square roots, sines
//     and cosines. Arguments of switches are auxiliaries, too, so that their Taylor polynomials are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "body/elementary.h"
#include "formula/expression.h"

/// @cond declarations of the C library
#ifdef __clang__
// the C library provides these for every compiler but declares them only for GCC
extern "C" {
polhode::Wide logf128(polhode::Wide);
polhode::Wide atan2f128(polhode::Wide, polhode::Wide);
polhode::Wide asinf128(polhode::Wide);
polhode::Wide acosf128(polhode::Wide);
polhode::Wide tanhf128(polhode::Wide);
polhode::Wide sinhf128(polhode::Wide);
polhode::Wide powf128(polhode::Wide, polhode::Wide);
}
#endif
/// @endcond

namespace polhode::formula {

/// Elementary functions of a scalar that Elementary lacks. The general version calls functions of the scalar's own
/// namespace.
template <class S>
struct Functions {
    static S logarithm(const S& x) { return log(x); }
    static S arctangent(const S& y, const S& x) { return atan2(y, x); }
    static S arcsine(const S& x) { return asin(x); }
    static S arccosine(const S& x) { return acos(x); }
    static S hyperbolic_tangent(const S& x) { return tanh(x); }
    static S hyperbolic_sine(const S& x) { return sinh(x); }
    static S power(const S& x, const S& y) { return pow(x, y); }
    /// -1, 0 or 1.
    static int sign(const S& x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
};

/// @cond specialisations
template <std::floating_point F>
struct Functions<F> {
    static F logarithm(F x) { return std::log(x); }
    static F arctangent(F y, F x) { return std::atan2(y, x); }
    static F arcsine(F x) { return std::asin(x); }
    static F arccosine(F x) { return std::acos(x); }
    static F hyperbolic_tangent(F x) { return std::tanh(x); }
    static F hyperbolic_sine(F x) { return std::sinh(x); }
    static F power(F x, F y) { return std::pow(x, y); }
    static int sign(F x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
};
template <>
struct Functions<Wide> {
    static Wide logarithm(const Wide& x) { return logf128(x); }
    static Wide arctangent(const Wide& y, const Wide& x) { return atan2f128(y, x); }
    static Wide arcsine(const Wide& x) { return asinf128(x); }
    static Wide arccosine(const Wide& x) { return acosf128(x); }
    static Wide hyperbolic_tangent(const Wide& x) { return tanhf128(x); }
    static Wide hyperbolic_sine(const Wide& x) { return sinhf128(x); }
    static Wide power(const Wide& x, const Wide& y) { return powf128(x, y); }
    static int sign(const Wide& x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
};
/// @endcond

/// Whether a scalar is a traced number, which has no value.
template <class S>
concept TracedScalar = requires(S s) {
    s.tape;
    s.node;
};
/// Whether a scalar is a dual number: a value with derivatives.
template <class S>
concept DualScalar = requires(S s) {
    s.value;
    s.slope;
};

/// f(x) and df/dx for a dual number x, from the value and the derivative at the value of x.
template <DualScalar S, class V>
S with_slope(const S& x, const V& value, const V& derivative) {
    S result;
    result.value = value;
    for (std::size_t i = 0; i < result.slope.size(); ++i) result.slope[i] = derivative * x.slope[i];
    return result;
}

/// The sine and the cosine.
template <class S>
S compute_sine(const S& x) {
    S sine(x), cosine(x);
    sine_cosine(x, sine, cosine);
    return sine;
}
template <class S>
S compute_cosine(const S& x) {
    S sine(x), cosine(x);
    sine_cosine(x, sine, cosine);
    return cosine;
}

/// A transcendental operation on numbers. `b` is the second operand of arctangent and power, else not read.
template <class S>
S compute_transcendental(Operation operation, const S& a, const S& b) {
    using F = Functions<S>;
    switch (operation) {
        case Operation::exponential:
            return Elementary<S>::exponential(a);
        case Operation::logarithm:
            return F::logarithm(a);
        case Operation::arctangent:
            return F::arctangent(a, b);
        case Operation::arcsine:
            return F::arcsine(a);
        case Operation::arccosine:
            return F::arccosine(a);
        case Operation::hyperbolic_tangent:
            return F::hyperbolic_tangent(a);
        case Operation::hyperbolic_sine:
            return F::hyperbolic_sine(a);
        case Operation::cube_root:
            return Elementary<S>::cube_root(a);
        default:
            return F::power(a, b);
    }
}

/// The rate of change of a transcendental node of value v, from its operands a and b and their rates.
template <class S>
S transcendental_rate(Operation operation, const S& v, const S& a, const S& b, const S& a_rate, const S& b_rate) {
    const S one(1);
    switch (operation) {
        case Operation::exponential:
            return v * a_rate;
        case Operation::logarithm:
            return a_rate / a;
        case Operation::arctangent:
            return (b * a_rate - a * b_rate) / (a * a + b * b);
        case Operation::arcsine:
            return a_rate / square_root(S(one - a * a));
        case Operation::arccosine:
            return -(a_rate / square_root(S(one - a * a)));
        case Operation::hyperbolic_tangent:
            return (one - v * v) * a_rate;
        case Operation::hyperbolic_sine:
            return square_root(S(one + v * v)) * a_rate;
        case Operation::cube_root:
            return a_rate / (S(3) * (v * v));
        default:
            return (b * v) * (a_rate / a);
    }
}

/// The values of all nodes of an expression for one set of inputs.
///
/// Members refer to the arguments of the constructor, which must outlive the object.
template <class S, class P>
class Evaluation {
  public:
    /// `uniform`: from compute_uniform_values(). `needed`: from find_needed(); other nodes are not computed. `signs`:
    /// the signs of all switches, or null to compute them from the values.
    Evaluation(const Expression& expression, const std::vector<P>& uniform, const std::vector<char>& needed,
               const signed char* signs)
        : expression_(expression),
          uniform_(uniform),
          needed_(needed),
          signs_(signs),
          values_(expression.nodes().size()) {}

    /// Computes all needed values. `inputs[i]`: input number i. `auxiliaries[i]`, if not null: the value of the
    /// transcendental node i.
    void compute(const S* inputs, const S* const* auxiliaries = nullptr) {
        const std::vector<Node>& nodes = expression_.nodes();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (!needed_[i] || expression_.is_uniform(static_cast<int>(i))) continue;
            const Node& node = nodes[i];
            if (is_transcendental(node.operation) && auxiliaries)
                values_[i] = *auxiliaries[i];
            else
                values_[i] = compute_node(node, inputs);
        }
    }
    /// The value of a node.
    S value(int node) const {
        const std::size_t i = static_cast<std::size_t>(node);
        return expression_.is_uniform(node) ? S(uniform_[i]) : values_[i];
    }
    /// The sign of a switch.
    int sign(int which) const {
        if (signs_) return signs_[which];
        return sign_of_value(which);
    }
    /// The sign of a switch, computed from the values.
    int sign_of_value(int which) const {
        if constexpr (TracedScalar<S>) {
            return 0;
        } else {
            const Switch& one = expression_.switches()[static_cast<std::size_t>(which)];
            const S argument = value(one.argument);
            if constexpr (DualScalar<S>) {
                using V = decltype(argument.value);
                return one.threshold == no_node ? Functions<V>::sign(argument.value)
                                                : Functions<V>::sign(V(argument.value - value(one.threshold).value));
            } else {
                return one.threshold == no_node ? Functions<S>::sign(argument)
                                                : Functions<S>::sign(S(argument - value(one.threshold)));
            }
        }
    }

    /// The rates of change of all needed nodes after compute(), from those of the inputs.
    std::vector<S> compute_rates(const S* input_rates) const {
        const std::vector<Node>& nodes = expression_.nodes();
        std::vector<S> rates(nodes.size(), S(0));
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (needed_[i] && !expression_.is_uniform(static_cast<int>(i)))
                rates[i] = rate_of(static_cast<int>(i), nodes[i], rates, input_rates);
        return rates;
    }

  private:
    const Expression& expression_;
    const std::vector<P>& uniform_;
    const std::vector<char>& needed_;
    const signed char* signs_;
    std::vector<S> values_;

    S compute_node(const Node& node, const S* inputs) const {
        switch (node.operation) {
            case Operation::input:
                return inputs[node.a];
            case Operation::add:
                return value(node.a) + value(node.b);
            case Operation::subtract:
                return value(node.a) - value(node.b);
            case Operation::multiply:
                return value(node.a) * value(node.b);
            case Operation::divide:
                return value(node.a) / value(node.b);
            case Operation::negate:
                return -value(node.a);
            case Operation::square_root:
                return polhode::square_root(value(node.a));
            case Operation::sine:
                return compute_sine(value(node.a));
            case Operation::cosine:
                return compute_cosine(value(node.a));
            case Operation::choose:
                return passes(node.test, sign(node.a)) ? value(node.b) : value(node.c);
            default:
                return transcendental(node);
        }
    }
    S transcendental(const Node& node) const {
        if constexpr (TracedScalar<S>) {
            return S(0);
        } else if constexpr (DualScalar<S>) {
            const S a = value(node.a);
            const S b = node.b == no_node ? S(0) : value(node.b);
            const auto v = compute_transcendental(node.operation, a.value, b.value);
            using V = std::remove_const_t<decltype(v)>;
            // the rates are linear in those of the operands
            const V by_a = transcendental_rate<V>(node.operation, v, a.value, b.value, V(1), V(0));
            S result = with_slope(a, v, by_a);
            // the exponent may depend on parameters
            if (node.operation == Operation::power && std::ranges::any_of(b.slope, [](V x) { return x != V(0); })) {
                const V by_b = v * Functions<V>::logarithm(a.value);
                for (std::size_t i = 0; i < result.slope.size(); ++i) result.slope[i] += by_b * b.slope[i];
            }
            if (node.operation == Operation::arctangent) {
                const V by_b = transcendental_rate<V>(node.operation, v, a.value, b.value, V(0), V(1));
                for (std::size_t i = 0; i < result.slope.size(); ++i) result.slope[i] += by_b * b.slope[i];
            }
            return result;
        } else {
            return compute_transcendental<S>(node.operation, value(node.a), node.b == no_node ? S(0) : value(node.b));
        }
    }
    S rate_of(int index, const Node& node, const std::vector<S>& rates, const S* input_rates) const {
        const auto rate = [&](int operand) {
            return operand == no_node || expression_.is_uniform(operand) ? S(0)
                                                                         : rates[static_cast<std::size_t>(operand)];
        };
        switch (node.operation) {
            case Operation::input:
                return input_rates[node.a];
            case Operation::add:
                return rate(node.a) + rate(node.b);
            case Operation::subtract:
                return rate(node.a) - rate(node.b);
            case Operation::multiply:
                return value(node.a) * rate(node.b) + rate(node.a) * value(node.b);
            case Operation::divide:
                return (rate(node.a) - value(index) * rate(node.b)) / value(node.b);
            case Operation::negate:
                return -rate(node.a);
            case Operation::square_root:
                return rate(node.a) / (value(index) + value(index));
            case Operation::sine:
                return compute_cosine(value(node.a)) * rate(node.a);
            case Operation::cosine:
                return -(compute_sine(value(node.a)) * rate(node.a));
            case Operation::choose:
                return passes(node.test, sign(node.a)) ? rate(node.b) : rate(node.c);
            default:
                return transcendental_rate<S>(node.operation, value(index), value(node.a),
                                              node.b == no_node ? S(0) : value(node.b), rate(node.a), rate(node.b));
        }
    }
};

/// The values of all nodes that depend on no input; other values are not used. `constants[i]`: constant number i.
template <class P>
std::vector<P> compute_uniform_values(const Expression& expression, const std::vector<P>& constants) {
    const std::vector<Node>& nodes = expression.nodes();
    std::vector<P> values(nodes.size(), P(0));
    const auto at = [&](int node) -> const P& { return values[static_cast<std::size_t>(node)]; };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Node& node = nodes[i];
        if (!expression.is_uniform(static_cast<int>(i))) continue;
        switch (node.operation) {
            case Operation::number:
                values[i] = P(node.value);
                break;
            case Operation::pi:
                values[i] = Elementary<P>::pi();
                break;
            case Operation::constant:
                values[i] = constants[static_cast<std::size_t>(node.a)];
                break;
            case Operation::input:
                break;
            case Operation::add:
                values[i] = at(node.a) + at(node.b);
                break;
            case Operation::subtract:
                values[i] = at(node.a) - at(node.b);
                break;
            case Operation::multiply:
                values[i] = at(node.a) * at(node.b);
                break;
            case Operation::divide:
                values[i] = at(node.a) / at(node.b);
                break;
            case Operation::negate:
                values[i] = -at(node.a);
                break;
            case Operation::square_root:
                values[i] = polhode::square_root(at(node.a));
                break;
            case Operation::sine:
                values[i] = compute_sine(at(node.a));
                break;
            case Operation::cosine:
                values[i] = compute_cosine(at(node.a));
                break;
            case Operation::choose: {
                const Switch& one = expression.switches()[static_cast<std::size_t>(node.a)];
                const P difference =
                    one.threshold == no_node ? at(one.argument) : P(at(one.argument) - at(one.threshold));
                values[i] = passes(node.test, Functions<P>::sign(difference)) ? at(node.b) : at(node.c);
                break;
            }
            default:
                values[i] =
                    compute_transcendental<P>(node.operation, at(node.a), node.b == no_node ? P(0) : at(node.b));
        }
    }
    return values;
}

}  // namespace polhode::formula
