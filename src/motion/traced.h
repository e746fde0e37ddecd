// A scalar that records the operations applied to it. Evaluating the right-hand side once on traced numbers gives a
// tape of operations, from which Taylor coefficients of any order follow without further derivations.
//
// A traced number is factor * node, so that scaling needs no operation. Constants are folded (0 x, x + 0, 1 x, 0 / x,
// x / x), equal nodes are shared (value numbering), and products, quotients and functions apply to nodes only. Main
// types: TapeNode and Tape (the operations), Traced (the scalar), Recording (a recorded system).
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "body/elementary.h"

namespace polhode {

/// A node of the tape. Operands precede their node, except that a cosine directly follows the sine that refers to it.
///
///   * state: the a-th variable
///   * combination: factor_a * a + factor_b * b; if b < 0: + factor_b
///   * product: a * b
///   * quotient: a / b; if a < 0: 1 / b
///   * sine, cosine: of a; b is the partner. Both always exist.
///   * root: the square root of a; b < 0
template <class T>
struct TapeNode {
    enum class Kind { state, combination, product, quotient, sine, cosine, root } kind;
    int a, b;
    T factor_a, factor_b;

    bool operator==(const TapeNode&) const = default;
};

/// The operations in recording order. The first nodes are the state variables.
template <class T>
struct Tape {
    std::vector<TapeNode<T>> nodes;

    /// Removes all nodes. Keeps the memory.
    void clear() {
        nodes.clear();
        std::fill(slots_.begin(), slots_.end(), none);
        noted_ = 0;
    }
    /// Returns the index of an equal node, or appends the node and returns its index.
    int add(const TapeNode<T>& node) {
        const int found = find(node, [&](const TapeNode<T>& other) { return other == node; });
        if (found == none) nodes.push_back(node);
        return found == none ? static_cast<int>(nodes.size()) - 1 : found;
    }
    /// Returns the index of the sine of a node; its cosine has the next index.
    int add_sine(int argument) {
        const int place = static_cast<int>(nodes.size());
        const TapeNode<T> sine{TapeNode<T>::Kind::sine, argument, place + 1, T(0), T(0)};
        const int found =
            find(sine, [&](const TapeNode<T>& other) { return other.kind == sine.kind && other.a == argument; });
        if (found != none) return found;
        nodes.push_back(sine);
        nodes.push_back({TapeNode<T>::Kind::cosine, argument, place, T(0), T(0)});
        return place;
    }

  private:
    static constexpr int none = -1;
    // open-addressing hash table with linear probing: node indices by kind and operands, at most half full
    std::vector<int> slots_ = std::vector<int>(1024, none);
    std::size_t noted_ = 0;

    template <class Equal>
    int find(const TapeNode<T>& node, Equal&& equal) {
        for (; noted_ < nodes.size(); ++noted_) note(noted_);
        std::size_t i = first_slot(node);
        while (slots_[i] != none && !equal(nodes[slots_[i]])) i = next(i);
        return slots_[i];
    }
    std::size_t next(std::size_t slot) const { return (slot + 1) & (slots_.size() - 1); }
    std::size_t first_slot(const TapeNode<T>& node) const {
        // the partner of a sine is not part of its key
        const bool has_partner = node.kind == TapeNode<T>::Kind::sine || node.kind == TapeNode<T>::Kind::cosine;
        const std::uint64_t key = (static_cast<std::uint64_t>(node.kind) << 60U) ^
                                  (static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.a + 1)) << 30U) ^
                                  static_cast<std::uint32_t>(has_partner ? 0 : node.b + 1);
        return (key * 0x9E3779B97F4A7C15U >> 32U) & (slots_.size() - 1);
    }
    void note(std::size_t place) {
        if (2 * (place + 1) > slots_.size()) {
            slots_.assign(2 * slots_.size(), none);
            for (std::size_t i = 0; i < place; ++i) put(i);
        }
        put(place);
    }
    void put(std::size_t place) {
        std::size_t i = first_slot(nodes[place]);
        while (slots_[i] != none) i = next(i);
        slots_[i] = static_cast<int>(place);
    }
};

/// A traced number: factor * node, or the constant `factor`.
template <class T>
class Traced {
  public:
    static constexpr int constant = -1;

    T factor{0};
    int node = constant;  ///< constant: the value is `factor`
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
        // canonical order for commutativity: the lower node last, a constant after all nodes
        if (a.node < b.node) return b + a;
        using Kind = typename TapeNode<T>::Kind;
        return {T(1), a.tape->add({Kind::combination, a.node, b.node, a.factor, b.factor}), a.tape};
    }
    friend Traced operator*(const Traced& a, const Traced& b) {
        if (a.is_zero() || b.is_zero()) return Traced();
        if (a.node == constant) return {a.factor * b.factor, b.node, b.tape};
        if (b.node == constant) return {a.factor * b.factor, a.node, a.tape};
        if (a.node < b.node) return b * a;
        using Kind = typename TapeNode<T>::Kind;
        return {a.factor * b.factor, a.tape->add({Kind::product, a.node, b.node, T(0), T(0)}), a.tape};
    }
    friend Traced operator/(const Traced& a, const Traced& b) {
        if (b.node == constant || a.node == b.node)
            return {a.factor / b.factor, b.node == constant ? a.node : constant, a.tape};
        if (a.is_zero()) return Traced();
        using Kind = typename TapeNode<T>::Kind;
        return {a.factor / b.factor, b.tape->add({Kind::quotient, a.node, b.node, T(0), T(0)}), b.tape};
    }
    friend Traced operator-(const Traced& a) { return {-a.factor, a.node, a.tape}; }
    friend Traced operator-(const Traced& a, const Traced& b) { return a + (-b); }

    friend Traced operator+(const T& a, const Traced& b) { return Traced(a) + b; }
    friend Traced operator+(const Traced& a, const T& b) { return a + Traced(b); }
    friend Traced operator-(const T& a, const Traced& b) { return Traced(a) - b; }
    friend Traced operator-(const Traced& a, const T& b) { return a - Traced(b); }
    friend Traced operator*(const T& a, const Traced& b) { return Traced(a) * b; }
    friend Traced operator*(const Traced& a, const T& b) { return a * Traced(b); }
    friend Traced operator/(const T& a, const Traced& b) { return Traced(a) / b; }
    friend Traced operator/(const Traced& a, const T& b) { return a / Traced(b); }
    Traced& operator+=(const Traced& b) { return *this = *this + b; }
    Traced& operator-=(const Traced& b) { return *this = *this - b; }

    /// Called by square_root().
    friend Traced sqrt(const Traced& x) {
        if (x.node == constant) return Traced(T(square_root(x.factor)));
        using Kind = typename TapeNode<T>::Kind;
        return {T(1), x.tape->add({Kind::root, x.scaled(x.factor), constant, T(0), T(0)}), x.tape};
    }
    /// Called by polhode::sine_cosine(). The sign is kept outside: the sine is odd, the cosine even.
    static void sine_cosine(const Traced& x, Traced& sine, Traced& cosine) {
        if (x.node == constant) {
            T s(0), c(1);
            polhode::sine_cosine(x.factor, s, c);
            sine = Traced(s), cosine = Traced(c);
            return;
        }
        const bool negative = x.is_below_zero();
        Tape<T>* const recorded = x.tape;
        const int place = recorded->add_sine(x.scaled(negative ? T(-x.factor) : x.factor));
        sine = {negative ? T(-1) : T(1), place, recorded};
        cosine = {T(1), place + 1, recorded};
    }

  private:
    /// A node with the value factor_ * node.
    int scaled(const T& factor_) const {
        using Kind = typename TapeNode<T>::Kind;
        return factor_ == 1 ? node : tape->add({Kind::combination, node, constant, factor_, T(0)});
    }
    bool is_below_zero() const {
        if constexpr (requires { factor.is_negative(); })
            return factor.is_negative();
        else
            return factor < 0;
    }
    bool is_zero() const { return node == constant && factor == 0; }
};

/// The recording of an autonomous system dy/dt = f(y).
template <class T>
struct Recording {
    Tape<T> tape;
    std::vector<Traced<T>> rates;  ///< one per state variable
};

/// Records form.derivative(y, dy) on `dimension` variables. Removes nodes on which no rate depends.
template <class T, class Form>
Recording<T> record(const Form& form, int dimension) {
    using Kind = typename TapeNode<T>::Kind;
    // large tapes are recorded at each change of mode: allocating them would take longer than recording
    static thread_local Tape<T> tape;
    tape.clear();
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
        for (const int operand : {tape.nodes[i].a, tape.nodes[i].b})
            if (operand >= 0) needed[operand] = 1;
    }
    Recording<T> result;
    result.tape.nodes.reserve(static_cast<std::size_t>(std::count(needed.begin(), needed.end(), 1)));
    std::vector<int> renamed(tape.nodes.size(), Traced<T>::constant);
    for (std::size_t i = 0; i < tape.nodes.size(); ++i) {
        if (!needed[i]) continue;
        TapeNode<T> node = tape.nodes[i];
        renamed[i] = static_cast<int>(result.tape.nodes.size());
        if (node.kind != Kind::state) {
            if (node.a >= 0) node.a = renamed[node.a];
            // the partner of a sine is the next node
            if (node.b >= 0) node.b = node.kind == Kind::sine ? renamed[i] + 1 : renamed[node.b];
        }
        result.tape.nodes.push_back(std::move(node));
    }
    for (const Traced<T>& rate : rates)
        result.rates.emplace_back(rate.factor, rate.node >= 0 ? renamed[rate.node] : Traced<T>::constant, nullptr);
    return result;
}

/// Whether the tape has only sums and products, as proofs and polynomial kernels require.
template <class T>
bool is_polynomial(const Recording<T>& recording) {
    using Kind = typename TapeNode<T>::Kind;
    return std::all_of(recording.tape.nodes.begin(), recording.tape.nodes.end(), [](const TapeNode<T>& node) {
        return node.kind == Kind::state || node.kind == Kind::combination || node.kind == Kind::product;
    });
}

/// @cond specialisations
template <class T>
struct Elementary<Traced<T>> {
    using S = Traced<T>;
    static void sine_cosine(const S& x, S& sine, S& cosine) { S::sine_cosine(x, sine, cosine); }
};
/// @endcond
}  // namespace polhode
