#include "integrators/truth/balls/transition.h"

#include <algorithm>
#include <limits>

#include "body/elementary.h"

namespace polhode::truth {
namespace {

constexpr long least_bits = 96;

// right-hand side of y and W together, evaluated along the tape
struct TransitionForm {
    const Recording<Ball>& equations;
    const std::vector<TransitionEntry>& entries;

    template <class S>
    void derivative(const S* y, S* dy) const {
        const std::size_t nodes = equations.tape.nodes.size(), n = equations.rates.size();
        std::vector<S> value(nodes), slope(nodes * n);
        for (std::size_t k = 0; k < entries.size(); ++k) slope[entries[k].row * n + entries[k].column] = y[n + k];
        evaluate_nodes(y, value, slope);
        const auto rate = [&](std::size_t i, const std::vector<S>& of, std::size_t at) {
            const Traced<Ball>& rate_i = equations.rates[i];
            return rate_i.node >= 0 ? rate_i.factor * of[at] : S(0);
        };
        for (std::size_t i = 0; i < n; ++i)
            dy[i] =
                equations.rates[i].node >= 0 ? rate(i, value, equations.rates[i].node) : S(equations.rates[i].factor);
        for (std::size_t k = 0; k < entries.size(); ++k) {
            const auto row = static_cast<std::size_t>(entries[k].row);
            dy[n + k] = rate(row, slope, std::max(equations.rates[row].node, 0) * n + entries[k].column);
        }
    }

  private:
    // Value of each node i, and its slopes in the directions of W's columns j, at i n + j.
    template <class S>
    void evaluate_nodes(const S* y, std::vector<S>& value, std::vector<S>& slope) const {
        using Kind = TapeNode<Ball>::Kind;
        const std::vector<TapeNode<Ball>>& nodes = equations.tape.nodes;
        const std::size_t n = equations.rates.size();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const TapeNode<Ball>& node = nodes[i];
            S* const own = &slope[i * n];
            const S *const a = &slope[static_cast<std::size_t>(std::max(node.a, 0)) * n],
                           *const b = &slope[static_cast<std::size_t>(std::max(node.b, 0)) * n];
            const auto each = [&](const auto& change) {
                for (std::size_t j = 0; j < n; ++j) own[j] = change(j);
            };
            switch (node.kind) {
                case Kind::state:
                    value[i] = y[i];
                    break;
                case Kind::combination:
                    value[i] = node.factor_a * value[node.a];
                    value[i] += node.b >= 0 ? node.factor_b * value[node.b] : S(node.factor_b);
                    each([&](std::size_t j) {
                        return node.b >= 0 ? node.factor_a * a[j] + node.factor_b * b[j] : node.factor_a * a[j];
                    });
                    break;
                case Kind::product:
                    value[i] = value[node.a] * value[node.b];
                    each([&](std::size_t j) { return value[node.a] * b[j] + a[j] * value[node.b]; });
                    break;
                case Kind::quotient: {
                    const S per = S(1) / value[node.b];
                    value[i] = node.a >= 0 ? value[node.a] * per : per;
                    each([&](std::size_t j) {
                        const S less = value[i] * b[j];
                        return (node.a >= 0 ? a[j] - less : -less) * per;
                    });
                    break;
                }
                case Kind::root: {
                    value[i] = square_root(value[node.a]);
                    const S per = S(0.5) / value[i];
                    each([&](std::size_t j) { return a[j] * per; });
                    break;
                }
                case Kind::sine:
                    // the cosine is the next node
                    sine_cosine(value[node.a], value[i], value[i + 1]);
                    each([&](std::size_t j) { return value[i + 1] * a[j]; });
                    break;
                case Kind::cosine:
                    each([&](std::size_t j) { return -(value[i - 1] * a[j]); });
                    break;
            }
        }
    }
};

// W(i, j) is identically zero unless a chain of dependencies "the rate of .. depends on .." leads from i to j.
std::vector<TransitionEntry> find_entries(const Recording<Ball>& equations) {
    const std::vector<TapeNode<Ball>>& nodes = equations.tape.nodes;
    const std::size_t n = equations.rates.size();
    const auto merge_row = [n](char* own, const char* other) {
        for (std::size_t j = 0; j < n; ++j)
            if (other[j]) own[j] = 1;
    };
    std::vector<char> depends(nodes.size() * n), reached(n * n);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        char* const own = &depends[i * n];
        if (nodes[i].kind == TapeNode<Ball>::Kind::state) {
            own[i] = 1;
            continue;
        }
        for (const int operand : {nodes[i].a, nodes[i].b})
            if (operand >= 0 && static_cast<std::size_t>(operand) < i) merge_row(own, &depends[operand * n]);
    }
    for (std::size_t i = 0; i < n; ++i) {
        reached[i * n + i] = 1;
        if (equations.rates[i].node >= 0) merge_row(&reached[i * n], &depends[equations.rates[i].node * n]);
    }
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = 0; i < n; ++i)
            if (reached[i * n + k]) merge_row(&reached[i * n], &reached[k * n]);
    std::vector<TransitionEntry> entries;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (reached[i * n + j]) entries.push_back({static_cast<int>(i), static_cast<int>(j)});
    return entries;
}

Recording<Ball> record_transition(const Recording<Ball>& equations, const std::vector<TransitionEntry>& entries,
                                  long bits) {
    const int all = static_cast<int>(equations.rates.size() + entries.size());
    const Recording<Ball> exact = record<Ball>(TransitionForm{equations, entries}, all);
    const WorkingPrecision precision(bits);
    return rounded(exact);
}

}  // namespace

Transition::Transition(const Recording<Ball>& equations, int order, double spare_bits)
    : n_(static_cast<int>(equations.rates.size())),
      bits_(least_bits + static_cast<long>(spare_bits)),
      entries_(find_entries(equations)),
      series_(record_transition(equations, entries_, bits_), order) {}

void Transition::expand(const std::vector<Ball>& point, const Bound& h, const Bound& distance, const Bound& growth,
                        const Bound& allowed, const WeightedNorm& norm) {
    const WorkingPrecision precision(bits_);
    std::vector<Ball> start(point);
    for (Ball& y : start) arb_set_round(y.raw(), y.raw(), bits_);
    for (const TransitionEntry& entry : entries_) start.emplace_back(entry.row == entry.column ? 1 : 0);
    series_.expand(start.data());

    const Defect defects = defect(series_.recording(), term_bounds(series_, h));
    // Bounds the distance of the motion from the polynomial p of this order. A distance that grows at most by `growth`
    // while it is within `allowed`, and stays below `allowed` with this growth, never leaves it.
    const std::vector<Bound> own(defects.rate.begin(), defects.rate.begin() + n_);
    const Bound apart = distance + growth * h * norm.length(own);
    error_.assign(static_cast<std::size_t>(n_) * n_, Bound(std::numeric_limits<double>::infinity()));
    if (!(apart < allowed)) return;
    std::vector<Bound> moved = norm.components(apart);
    moved.resize(start.size());
    const std::vector<Bound> change = change_of_rates(series_.recording(), defects, moved);
    std::vector<std::vector<Bound>> columns(n_, std::vector<Bound>(n_));
    for (std::size_t k = 0; k < entries_.size(); ++k)
        columns[entries_[k].column][entries_[k].row] = change[n_ + k] + defects.rate[n_ + k];
    for (int j = 0; j < n_; ++j) {
        const std::vector<Bound> column = norm.components(growth * h * norm.length(columns[j]));
        for (int i = 0; i < n_; ++i) error_[i * n_ + j] = column[i];
    }
}

bool Transition::is_bounded() const {
    return std::ranges::all_of(error_, [](const Bound& error) { return error.is_finite(); });
}

std::vector<Ball> Transition::at(const Ball& t) const {
    const WorkingPrecision precision(bits_);
    std::vector<Ball> values(series_.dimension()), W(static_cast<std::size_t>(n_) * n_);
    series_.evaluate(t, values.data());
    for (std::size_t k = 0; k < entries_.size(); ++k)
        W[entries_[k].row * n_ + entries_[k].column] = std::move(values[n_ + k]);
    for (std::size_t i = 0; i < W.size(); ++i) W[i] = widened(std::move(W[i]), error_[i]);
    return W;
}

}  // namespace polhode::truth
