// A scalar that records what is done to it. The right-hand side, run once on traced numbers, leaves a list of its
// operations, from which Taylor coefficients follow to any order: the one right-hand side is all that is ever written.
//
// A traced number is factor * node, so that scaling costs nothing; constants fold (0 x, x + 0, 1 x), equal nodes are
// made once, and products are of nodes alone.
#pragma once

#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

namespace polhode::truth {

/// A node of the tape: a state variable, factor_a * a + factor_b * b (b < 0: a constant factor_b), or a * b.
template <class T>
struct Node {
    enum class Kind { state, combination, product } kind;
    int a, b;
    T factor_a, factor_b;

    bool operator==(const Node&) const = default;
};

/// The operations in the order in which they were recorded; the first nodes are the state variables.
template <class T>
struct Tape {
    std::vector<Node<T>> nodes;

    int add(const Node<T>& node) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (nodes[i] == node) return static_cast<int>(i);
        nodes.push_back(node);
        return static_cast<int>(nodes.size()) - 1;
    }
};

template <class T>
class Traced {
  public:
    static constexpr int constant = -1;

    T factor{0};
    int node = constant;  ///< constant: the number is `factor` itself
    Tape<T>* tape = nullptr;

    Traced() = default;
    template <class A>
    requires(std::constructible_from<T, const A&> && !std::same_as<A, Traced>) explicit Traced(const A& value)
        : factor(value) {}
    Traced(T factor_, int node_, Tape<T>* tape_) : factor(std::move(factor_)), node(node_), tape(tape_) {}

    friend Traced operator+(const Traced& a, const Traced& b) {
        if (a.node == b.node) {
            const T sum = a.factor + b.factor;
            return sum == 0 ? Traced() : Traced(sum, a.node, a.tape);
        }
        if (a.is_zero()) return b;
        if (b.is_zero()) return a;
        // the lower node last, a constant last of all: one form for a + b and b + a
        if (a.node < b.node) return b + a;
        using Kind = typename Node<T>::Kind;
        return {T(1), a.tape->add({Kind::combination, a.node, b.node, a.factor, b.factor}), a.tape};
    }
    friend Traced operator*(const Traced& a, const Traced& b) {
        if (a.is_zero() || b.is_zero()) return Traced();
        if (a.node == constant) return {a.factor * b.factor, b.node, b.tape};
        if (b.node == constant) return {a.factor * b.factor, a.node, a.tape};
        if (a.node < b.node) return b * a;
        using Kind = typename Node<T>::Kind;
        return {a.factor * b.factor, a.tape->add({Kind::product, a.node, b.node, T(0), T(0)}), a.tape};
    }
    friend Traced operator-(const Traced& a) { return {-a.factor, a.node, a.tape}; }
    friend Traced operator-(const Traced& a, const Traced& b) { return a + (-b); }

    friend Traced operator+(const T& a, const Traced& b) { return Traced(a) + b; }
    friend Traced operator+(const Traced& a, const T& b) { return a + Traced(b); }
    friend Traced operator-(const T& a, const Traced& b) { return Traced(a) - b; }
    friend Traced operator-(const Traced& a, const T& b) { return a - Traced(b); }
    friend Traced operator*(const T& a, const Traced& b) { return Traced(a) * b; }
    friend Traced operator*(const Traced& a, const T& b) { return a * Traced(b); }

  private:
    bool is_zero() const { return node == constant && factor == 0; }
};

/// An autonomous polynomial system dy/dt = f(y), recorded.
template <class T>
struct Recording {
    Tape<T> tape;
    std::vector<Traced<T>> rates;  ///< of each state variable
};

/// Records form.derivative(y, dy) on `dimension` variables, and drops what no rate depends on.
template <class T, class Form>
Recording<T> record(const Form& form, int dimension) {
    using Kind = typename Node<T>::Kind;
    Tape<T> tape;
    std::vector<Traced<T>> state, rates(dimension);
    for (int i = 0; i < dimension; ++i) {
        tape.nodes.push_back({Kind::state, i, 0, T(0), T(0)});
        state.emplace_back(T(1), i, &tape);
    }
    form.derivative(state.data(), rates.data());

    std::vector<char> needed(tape.nodes.size(), 0);
    for (int i = 0; i < dimension; ++i) needed[i] = 1;
    for (const Traced<T>& rate : rates)
        if (rate.node >= 0) needed[rate.node] = 1;
    for (std::size_t i = tape.nodes.size(); i-- > static_cast<std::size_t>(dimension);) {
        if (!needed[i]) continue;
        needed[tape.nodes[i].a] = 1;
        if (tape.nodes[i].b >= 0) needed[tape.nodes[i].b] = 1;
    }
    Recording<T> result;
    std::vector<int> renamed(tape.nodes.size(), Traced<T>::constant);
    for (std::size_t i = 0; i < tape.nodes.size(); ++i) {
        if (!needed[i]) continue;
        Node<T> node = tape.nodes[i];
        if (node.kind != Kind::state) {
            node.a = renamed[node.a];
            if (node.b >= 0) node.b = renamed[node.b];
        }
        renamed[i] = static_cast<int>(result.tape.nodes.size());
        result.tape.nodes.push_back(std::move(node));
    }
    for (const Traced<T>& rate : rates)
        result.rates.emplace_back(rate.factor, rate.node >= 0 ? renamed[rate.node] : Traced<T>::constant, nullptr);
    return result;
}

}  // namespace polhode::truth
