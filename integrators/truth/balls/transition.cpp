#include "integrators/truth/balls/transition.h"

#include <array>
#include <cstdint>
#include <limits>

#include "motion/dual.h"

namespace polhode::truth {
namespace {

// y and W by the one right-hand side on dual numbers
template <int n>
struct TransitionForm {
    const EulerForm<Ball>& form;
    const std::vector<TransitionEntry>& entries;

    template <class S>
    void derivative(const S* y, S* dy) const {
        using D = Dual<n, S, Ball>;
        std::array<D, n> moved, rate;
        for (int i = 0; i < n; ++i) moved[i].value = y[i];
        for (std::size_t k = 0; k < entries.size(); ++k) moved[entries[k].row].slope[entries[k].column] = y[n + k];
        form.derivative_of<n == BodyState::motion>(moved.data(), rate.data());
        for (int i = 0; i < n; ++i) dy[i] = rate[i].value;
        for (std::size_t k = 0; k < entries.size(); ++k) dy[n + k] = rate[entries[k].row].slope[entries[k].column];
    }
};

// W(i, j) is zero throughout unless j reaches i along the arrows "the rate of .. depends on ..".
std::vector<TransitionEntry> entries_of(const EulerForm<Ball>& form) {
    const int n = form.dimension();
    const Recording<Ball> recording = record<Ball>(form, n);
    const std::vector<Node<Ball>>& nodes = recording.tape.nodes;
    std::vector<std::uint32_t> depends(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].kind == Node<Ball>::Kind::state)
            depends[i] = 1U << i;
        else
            depends[i] = depends[nodes[i].a] | (nodes[i].b >= 0 ? depends[nodes[i].b] : 0);
    }
    std::vector<std::uint32_t> reached(n);
    for (int i = 0; i < n; ++i)
        reached[i] = 1U << i | (recording.rates[i].node >= 0 ? depends[recording.rates[i].node] : 0);
    for (int k = 0; k < n; ++k)
        for (int i = 0; i < n; ++i)
            if (reached[i] >> k & 1U) reached[i] |= reached[k];
    std::vector<TransitionEntry> entries;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            if (reached[i] >> j & 1U) entries.push_back({i, j});
    return entries;
}

Recording<Ball> recorded(const EulerForm<Ball>& form, const std::vector<TransitionEntry>& entries) {
    const int n = form.dimension(), all = n + static_cast<int>(entries.size());
    Recording<Ball> exact = n == BodyState::rotation
                                ? record<Ball>(TransitionForm<BodyState::rotation>{form, entries}, all)
                                : record<Ball>(TransitionForm<BodyState::motion>{form, entries}, all);
    const WorkingPrecision precision(Transition::bits);
    return rounded(exact);
}

}  // namespace

Transition::Transition(const EulerForm<Ball>& form, int order)
    : n_(form.dimension()), entries_(entries_of(form)), series_(recorded(form, entries_), order) {}

void Transition::expand(const std::vector<Ball>& point, const Bound& h, const Bound& distance, const Bound& growth,
                        const Bound& allowed, const WeightedNorm& norm) {
    const WorkingPrecision precision(bits);
    std::vector<Ball> start(point);
    for (Ball& y : start) arb_set_round(y.raw(), y.raw(), bits);
    for (const TransitionEntry& entry : entries_) start.emplace_back(entry.row == entry.column ? 1 : 0);
    series_.expand(start.data());

    const Defect defects = defect(series_.recording(), term_bounds(series_, h));
    // The motion against the polynomial p of this order. What grows by no more than `growth` as long as it is within
    // `allowed`, and comes to less, never leaves it.
    const std::vector<Bound> own(defects.rate.begin(), defects.rate.begin() + n_);
    const Bound apart = distance + growth * h * norm.length(own);
    error_.assign(static_cast<std::size_t>(n_) * n_, Bound(std::numeric_limits<double>::infinity()));
    if (!(apart < allowed)) return;
    std::vector<Bound> moved = norm.components(apart);
    moved.resize(start.size());
    const std::vector<Bound> change = change_of_rates(series_.recording(), defects.node, moved);
    std::vector<std::vector<Bound>> columns(n_, std::vector<Bound>(n_));
    for (std::size_t k = 0; k < entries_.size(); ++k)
        columns[entries_[k].column][entries_[k].row] = change[n_ + k] + defects.rate[n_ + k];
    for (int j = 0; j < n_; ++j) {
        const std::vector<Bound> column = norm.components(growth * h * norm.length(columns[j]));
        for (int i = 0; i < n_; ++i) error_[i * n_ + j] = column[i];
    }
}

std::vector<Ball> Transition::at(const Ball& t) const {
    const WorkingPrecision precision(bits);
    std::vector<Ball> values(series_.dimension()), W(static_cast<std::size_t>(n_) * n_);
    series_.evaluate(t, values.data());
    for (std::size_t k = 0; k < entries_.size(); ++k)
        W[entries_[k].row * n_ + entries_[k].column] = std::move(values[n_ + k]);
    for (std::size_t i = 0; i < W.size(); ++i) W[i] = widened(std::move(W[i]), error_[i]);
    return W;
}

}  // namespace polhode::truth
