// Compiles a recording to a TapeProgram by the recurrences in tape_program.h.
//
// TapeProgrammer first merges sums and products that only one sum uses (merge_single_uses), then emits the operations
// of order 0 (begin, emit_initial_sum) and those of each later order (emit_coefficient, emit_sum, emit_total). The
// terms of a sum are ordered by an estimate of when they become available, in cycles, so that the longest dependency is
// added last.
#include "integrators/tape/tape_program.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "integrators/tape/canonical_order.h"

namespace polhode {
namespace {

using Node = TapeNode<double>;
using Kind = TapeProgram::Kind;
constexpr int none = TapeProgram::none;

class TapeProgrammer {
  public:
    TapeProgrammer(TapeProgram& program, const Recording<double>& recording, bool is_series)
        : program_(program),
          is_series_(is_series),
          nodes_(recording.tape.nodes),
          rates_(recording.rates),
          row_of_(nodes_.size(), none),
          inner_row_of_(nodes_.size(), none) {}

    void write() {
        const int n = program_.states = static_cast<int>(rates_.size());
        program_.slots = n;
        ready_cycle_.assign(n, 0);
        merge_single_uses();
        for (int i = 0; i < count(); ++i) value_of_.push_back(slot());
        program_.values.assign(value_of_.begin(), value_of_.begin() + n);
        program_.next = slot(), program_.inverse_next = slot();
        scale_of_.assign(nodes_.size(), 1);
        for (int i = n; i < count(); ++i)
            if (!is_series_ && is_sum(i))
                emit_initial_sum(i);
            else
                begin(i);
        for (const Traced<double>& rate : rates_) {
            const double scale = rate.node < 0 ? 1 : rate.factor * scale_of_[rate.node];
            const bool is_parameter = !is_series_ && rate.node < 0 && rate.factor == 0;
            program_.first_rates.push_back({rate.node >= 0 ? value_of_[rate.node]
                                            : is_parameter ? none
                                                           : constant(rate.factor),
                                            scale == 1 ? none : constant(scale)});
        }
        if (!is_series_) return;
        for (int i = n; i < count(); ++i)
            if (coefficient_slot_[i] == 0) coefficient_slot_[i] = slot();
        for (int i = n; i < count(); ++i)
            if (coefficient_slot_[i] != none) emit_coefficient(i);
        for (int i = 0; i < n; ++i) {
            const bool changes = rates_[i].node >= 0;
            program_.rates.push_back(
                {changes ? later_rate(rates_[i].node) : constant(0), changes ? program_.first_rates[i].factor : none});
        }
        // The sums of P come first.
        program_.sums = inner_;
        program_.inner = static_cast<int>(inner_.size());
        program_.sums.insert(program_.sums.end(), whole_.begin(), whole_.end());
        for (TapeProgram::Operation& op : program_.step)
            if (op.kind == Kind::sum) op.a += program_.inner;
    }

  private:
    /// x times the number in slot `share` (`none`: 1), times -1 if `negative`
    struct Term {
        int share;
        bool negative;
        int x;
    };
    struct SignedSlot {
        int slot = none;
        bool negative = false;
    };

    TapeProgram& program_;
    bool is_series_;
    const std::vector<Node>& nodes_;
    const std::vector<Traced<double>>& rates_;
    std::vector<int> row_of_, inner_row_of_;  // by node
    std::vector<int> value_of_;               // by node: the slot of coefficient 0
    std::vector<int>
        coefficient_slot_;  // by node: the slot of the coefficient of the current order; none: merged into a sum
    std::vector<int> inverse_of_;
    std::vector<int> uses_;         // by node: 1 for each use by a sum, 2 for each other use
    std::vector<double> scale_of_;  // by node: pending factor of the value, for rates only
    std::vector<TapeProgram::Sum> inner_, whole_;
    std::vector<double> ready_cycle_;           // by slot: estimated cycles from the start of the order
    std::map<std::uint64_t, int> constant_of_;  // by bits of the value

    int count() const { return static_cast<int>(nodes_.size()); }
    int slot() {
        ready_cycle_.resize(program_.slots + 1, 0);
        return program_.slots++;
    }
    int constant(double value) {
        const auto [found, is_new] = constant_of_.try_emplace(std::bit_cast<std::uint64_t>(value), none);
        if (is_new) {
            found->second = slot();
            program_.constants.push_back({found->second, value});
        }
        return found->second;
    }
    int emit_initial(Kind kind, int a, int b) {
        program_.begin.push_back({kind, slot(), a, b});
        return program_.begin.back().to;
    }
    bool is_sum(int i) const {
        return nodes_[i].kind == Node::Kind::combination || nodes_[i].kind == Node::Kind::product;
    }
    // Assigns slots to all nodes except sums and products that only one sum uses.
    void merge_single_uses() {
        uses_.assign(nodes_.size(), 0);
        for (const Node& node : nodes_) {
            if (node.kind == Node::Kind::state) continue;
            for (const int operand : {node.a, node.b})
                if (operand >= 0) uses_[operand] += node.kind == Node::Kind::combination ? 1 : 2;
        }
        for (const Traced<double>& rate : rates_)
            if (rate.node >= 0) uses_[rate.node] += 2;
        for (int i = 0; i < count(); ++i) {
            coefficient_slot_.push_back(i < program_.states ? i : is_sum(i) && uses_[i] <= 1 ? none : 0);
        }
        inverse_of_.assign(nodes_.size(), none);
    }

    // Emits the value of a node.
    void begin(int i) {
        const Node& node = nodes_[i];
        const int to = value_of_[i], a = node.a >= 0 ? value_of_[node.a] : none;
        const int b = node.b >= 0 ? value_of_[node.b] : none;
        std::vector<TapeProgram::Operation>& list = program_.begin;
        switch (node.kind) {
            case Node::Kind::state:
            case Node::Kind::cosine:
                break;
            case Node::Kind::combination: {
                const bool is_scaled = b == none && node.factor_b == 0;
                int first = a;
                if (is_scaled)
                    list.push_back({Kind::multiply, to, constant(node.factor_a), a});
                else if (node.factor_a != 1)
                    first = emit_initial(Kind::multiply, constant(node.factor_a), a);
                if (is_scaled) break;
                if (b == none)
                    list.push_back({Kind::add, to, first, constant(node.factor_b)});
                else if (std::abs(node.factor_b) == 1)
                    list.push_back({node.factor_b > 0 ? Kind::add : Kind::subtract, to, first, b});
                else
                    list.push_back({Kind::product_plus, to, constant(node.factor_b), b, first});
                break;
            }
            case Node::Kind::product:
                list.push_back({Kind::multiply, to, a, b});
                break;
            case Node::Kind::quotient:
                list.push_back({Kind::divide, to, a == none ? constant(1) : a, b});
                if (is_series_) inverse_of_[i] = a == none ? to : emit_initial(Kind::divide, constant(1), b);
                break;
            case Node::Kind::sine:
                list.push_back({Kind::sine_cosine, to, a, b});
                break;
            case Node::Kind::root:
                list.push_back({Kind::root, to, a});
                if (is_series_) inverse_of_[i] = emit_initial(Kind::divide, constant(0.5), to);
        }
    }

    int row(int node, bool is_inner) {
        int& row = (is_inner ? inner_row_of_ : row_of_)[node];
        if (row == none) row = new_row(coefficient_slot_[node], is_inner ? none : value_of_[node]);
        return row;
    }
    int new_row(int slot, int value) {
        program_.rows.push_back({slot, value});
        return static_cast<int>(program_.rows.size()) - 1;
    }
    /// P of a single pair.
    int inner_sum(int x, int y) {
        const int first = static_cast<int>(program_.pairs.size()), to = slot();
        program_.pairs.push_back({x, y, none, false});
        inner_.push_back({to, first, first + 1});
        return to;
    }
    void step(Kind kind, int to, int a, int b, int c = none) {
        program_.step.push_back({kind, to, a, b, c});
        double last = 0;
        for (const int operand : {a, b, c})
            if (operand != none) last = std::max(last, ready_cycle_[operand]);
        ready_cycle_[to] = last + 4;
    }
    int emit_step(Kind kind, int a, int b) {
        const int to = slot();
        step(kind, to, a, b);
        return to;
    }

    // Emits the node's coefficient of the current order.
    void emit_coefficient(int i) {
        const Node& node = nodes_[i];
        std::vector<Term> terms;
        SignedSlot sum;
        switch (node.kind) {
            case Node::Kind::state:
                return;
            case Node::Kind::combination:
            case Node::Kind::product:
                sum = emit_sum(i, terms);
                break;
            case Node::Kind::quotient: {
                const int inverse = inverse_of_[i];
                sum = {emit_step(Kind::multiply, inner_sum(row(node.b, true), row(i, true)), inverse), true};
                terms.push_back({emit_initial(Kind::multiply, value_of_[i], inverse), true, coefficient_slot_[node.b]});
                if (node.a >= 0) terms.push_back({inverse, false, coefficient_slot_[node.a]});
                break;
            }
            case Node::Kind::root:
                sum = {emit_step(Kind::multiply, inner_sum(row(i, true), row(i, true)), inverse_of_[i]), true};
                terms.push_back({inverse_of_[i], false, coefficient_slot_[node.a]});
                break;
            case Node::Kind::sine:
            case Node::Kind::cosine: {
                const bool is_sine = node.kind == Node::Kind::sine;
                if (program_.order == none) program_.order = slot(), program_.inverse_order = slot();
                // Row of k times the coefficients of the argument.
                if (is_sine)
                    slope_ = new_row(emit_step(Kind::multiply, program_.order, coefficient_slot_[node.a]), none);
                sum = {emit_step(Kind::multiply, inner_sum(slope_, row(node.b, true)), program_.inverse_order),
                       !is_sine};
                terms.push_back({value_of_[node.b], !is_sine, coefficient_slot_[node.a]});
            }
        }
        emit_total(sum, terms, coefficient_slot_[i]);
    }
    /// Slot of a rate. A rate that is a state itself is copied first, because integration overwrites states.
    int later_rate(int node) {
        return node < program_.states ? emit_step(Kind::add, constant(0), coefficient_slot_[node])
                                      : coefficient_slot_[node];
    }
    int slope_ = none;  // row of the last sine's argument, see emit_coefficient()

    /// weight * x * y for nodes x and y; without y, weight * x; without both, the weight itself.
    struct Part {
        int x, y;
        double weight;
    };
    // Parts of a sum or product, with everything that is merged into it.
    std::vector<Part> parts_of(int i) const {
        std::vector<Part> parts;
        std::vector<std::pair<int, double>> open{{i, 1.0}};
        while (!open.empty()) {
            const auto [at, factor] = open.back();
            open.pop_back();
            const Node& node = nodes_[at];
            if (at != i && coefficient_slot_[at] != none) {
                parts.push_back({at, none, factor});
            } else if (node.kind == Node::Kind::combination) {
                if (node.b >= 0) open.emplace_back(node.b, factor * node.factor_b);
                if (node.b < 0 && node.factor_b != 0) parts.push_back({none, none, factor * node.factor_b});
                open.emplace_back(node.a, factor * node.factor_a);
            } else {
                parts.push_back({node.a, node.b, factor});
            }
        }
        return parts;
    }
    // Emits the value of a sum or product; products are added with fused multiply-adds.
    void emit_initial_sum(int i) {
        if (coefficient_slot_[i] == none) return;
        std::vector<Part> parts = parts_of(i);
        const auto ready_cycle = [&](const Part& part) {
            double last = 0;
            for (const int node : {part.x, part.y})
                if (node != none) last = std::max(last, ready_cycle_[value_of_[node]]);
            return last;
        };
        std::stable_sort(parts.begin(), parts.end(),
                         [&](const Part& a, const Part& b) { return ready_cycle(a) < ready_cycle(b); });
        // A common factor of all parts is multiplied in at the end.
        const double common = std::abs(parts.front().weight);
        const bool is_common =
            std::all_of(parts.begin(), parts.end(), [&](const Part& part) { return std::abs(part.weight) == common; });
        SignedSlot sum;
        for (const Part& part : parts) sum = with(sum, part, is_common ? 1 : std::abs(part.weight));
        const double last = ready_cycle(parts.back()) + 4 * static_cast<double>(parts.size());
        const double scale = (sum.negative ? -1 : 1) * (is_common ? common : 1);
        const bool is_rate_alone = uses_[i] == 2 && is_rate(i);
        if (is_rate_alone)
            scale_of_[i] = scale;
        else if (scale != 1)
            sum.slot = emit_initial(Kind::multiply, constant(scale), sum.slot);
        value_of_[i] = sum.slot;
        ready_cycle_[sum.slot] = last;
    }
    bool is_rate(int i) const {
        return std::any_of(rates_.begin(), rates_.end(), [i](const auto& rate) { return rate.node == i; });
    }
    // sum +- weight x y, weight > 0.
    SignedSlot with(SignedSlot sum, const Part& part, double weight) {
        const bool negative = part.weight < 0;
        if (part.x == none) return add_product(sum, constant(weight), none, negative);
        const int x = value_of_[part.x];
        if (part.y == none && weight == 1) return add_product(sum, x, none, negative);
        if (part.y == none) return add_product(sum, constant(weight), x, negative);
        return add_product(sum, weight == 1 ? x : emit_initial(Kind::multiply, constant(weight), x), value_of_[part.y],
                           negative);
    }
    // sum +- x y, or sum +- x without y.
    SignedSlot add_product(SignedSlot sum, int x, int y, bool negative) {
        const bool alike = sum.negative == negative;
        if (sum.slot == none) return {y == none ? x : emit_initial(Kind::multiply, x, y), negative};
        if (y == none) return {emit_initial(alike ? Kind::add : Kind::subtract, sum.slot, x), sum.negative};
        program_.begin.push_back({alike ? Kind::product_plus : Kind::minus_product, slot(), x, y, sum.slot});
        return {program_.begin.back().to, sum.negative};
    }

    // Emits the W of a sum or product in the current order; appends its other parts to `terms`.
    SignedSlot emit_sum(int i, std::vector<Term>& terms) {
        struct Product {
            int x, y;
            double weight;
        };
        std::vector<Product> products;
        for (const Part& part : parts_of(i)) {
            const double share = std::abs(part.weight);
            if (part.y != none)
                products.push_back({row(part.x, false), row(part.y, false), part.weight});
            else if (part.x != none)
                terms.push_back({share == 1 ? none : constant(share), part.weight < 0, coefficient_slot_[part.x]});
        }
        if (products.empty()) return {};
        const auto ready_cycle = [&](const Product& p) {
            return std::max(ready_cycle_[program_.rows[p.x].slot], ready_cycle_[program_.rows[p.y].slot]);
        };
        std::stable_sort(products.begin(), products.end(),
                         [&](const Product& a, const Product& b) { return ready_cycle(a) < ready_cycle(b); });
        const int first = static_cast<int>(program_.pairs.size()), to = slot();
        const double weight = products.front().weight;
        for (const Product& p : products) {
            const double relative = p.weight / weight, size = std::abs(relative);
            program_.pairs.push_back({p.x, p.y, size == 1 ? none : constant(size), relative < 0});
        }
        program_.step.push_back({Kind::sum, to, static_cast<int>(whole_.size())});
        whole_.push_back({to, first, static_cast<int>(program_.pairs.size())});
        ready_cycle_[to] = ready_cycle(products.back()) + 10 + 4 * static_cast<double>(products.size());
        if (std::abs(weight) == 1) return {to, weight < 0};
        return {emit_step(Kind::multiply, constant(std::abs(weight)), to), weight < 0};
    }

    // to = sum + all terms, the last available term last.
    void emit_total(SignedSlot sum, std::vector<Term>& terms, int to) {
        std::stable_sort(terms.begin(), terms.end(),
                         [&](const Term& a, const Term& b) { return ready_cycle_[a.x] < ready_cycle_[b.x]; });
        // Start with a term that is not negative, if there is one.
        if (sum.slot == none) {
            const auto positive = std::find_if(terms.begin(), terms.end(), [](const Term& t) { return !t.negative; });
            if (positive != terms.end()) std::rotate(terms.begin(), positive, positive + 1);
        }
        for (std::size_t j = 0; j < terms.size(); ++j) {
            const bool is_last = j + 1 == terms.size();
            sum = with(sum, terms[j], is_last ? to : none);
        }
        if (!sum.negative && sum.slot == to) return;
        if (!sum.negative && terms.empty() && program_.step.back().to == sum.slot) {
            if (program_.step.back().kind == Kind::sum) whole_.back().to = to;
            program_.step.back().to = to;
            ready_cycle_[to] = ready_cycle_[sum.slot];
            return;
        }
        // A single term of factor 1 needs a copy; a negative result changes sign.
        if (sum.negative)
            step(Kind::subtract, to, constant(0), sum.slot);
        else
            step(Kind::add, to, constant(0), sum.slot);
    }
    SignedSlot with(SignedSlot sum, const Term& term, int to) {
        if (sum.slot == none && term.share == none) return {term.x, term.negative};
        const bool alike = sum.negative == term.negative;
        if (to == none) to = slot();
        if (sum.slot == none) {
            step(Kind::multiply, to, term.share, term.x);
            return {to, term.negative};
        }
        if (term.share == none) {
            if (alike)
                step(Kind::add, to, sum.slot, term.x);
            else if (term.negative)
                step(Kind::subtract, to, sum.slot, term.x);
            else
                step(Kind::subtract, to, term.x, sum.slot);
            return {to, alike && sum.negative};
        }
        const Kind kind = alike           ? (sum.negative ? Kind::minus_product_minus : Kind::product_plus)
                          : term.negative ? Kind::minus_product
                                          : Kind::product_minus;
        step(kind, to, term.share, term.x, sum.slot);
        return {to, false};
    }
};

}  // namespace

TapeProgram::TapeProgram(const Recording<double>& recording, Purpose purpose) : states(0), slots(0) {
    TapeProgrammer(*this, in_canonical_order(recording), purpose == Purpose::series).write();
}

}  // namespace polhode
