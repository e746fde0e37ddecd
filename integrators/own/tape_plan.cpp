#include "integrators/own/tape_plan.h"

#include <algorithm>
#include <utility>

namespace polhode {
namespace {

class TapePlanner {
  public:
    explicit TapePlanner(TapePlan& plan) : plan_(plan), row_of_(plan.nodes.size(), none) {}

    void plan() {
        dissolve();
        plan_.term_of.assign(plan_.nodes.size(), 0);
        for (int i = 0; i < static_cast<int>(plan_.nodes.size()); ++i)
            if (plan_.place_of[i] != none) decode(i);
        // those of equal length one after another: the processor foresees where a loop ends
        std::stable_sort(algebraic_.begin(), algebraic_.end(),
                         [](const Sum& a, const Sum& b) { return a.end - a.first < b.end - b.first; });
        plan_.algebraic = algebraic_.size();
        plan_.sums = std::move(algebraic_);
        plan_.sums.insert(plan_.sums.end(), trigonometric_.begin(), trigonometric_.end());
        for (Sum& sum : plan_.sums) {
            const auto first = given_.begin() + sum.first, end = given_.begin() + sum.end;
            sum.first = static_cast<int>(plan_.pairs.size());
            plan_.pairs.insert(plan_.pairs.end(), first, end);
            sum.end = static_cast<int>(plan_.pairs.size());
        }
        for (TapePlan::Pair& pair : plan_.pairs)
            if (pair.x < 0) pair.x = static_cast<int>(plan_.source.size()) - 1 - pair.x;
    }

  private:
    using Node = truth::Node<double>;
    using Kind = Node::Kind;
    using Sum = TapePlan::Sum;
    static constexpr int none = TapePlan::none;

    TapePlan& plan_;
    std::vector<int> row_of_;            // by node
    std::vector<TapePlan::Pair> given_;  // in the tape's order; x = -1 - i: the i-th row of slopes
    std::vector<Sum> algebraic_, trigonometric_;

    // places for all but the sums and products that are used by one sum alone
    void dissolve() {
        const int count = static_cast<int>(plan_.nodes.size());
        std::vector<int> uses(plan_.nodes.size(), 0);
        for (int i = 0; i < count; ++i) {
            const bool by_sum = plan_.nodes[i].kind == Kind::combination;
            if (plan_.nodes[i].kind == Kind::state) continue;
            for (const int operand : {plan_.nodes[i].a, plan_.nodes[i].b})
                if (operand >= 0) uses[operand] += by_sum ? 1 : 2;
        }
        for (const truth::Traced<double>& rate : plan_.rates)
            if (rate.node >= 0) uses[rate.node] += 2;
        plan_.place_of.assign(plan_.nodes.size(), none);
        int places = 0;
        for (int i = 0; i < count; ++i) {
            const bool is_linear = plan_.nodes[i].kind == Kind::combination || plan_.nodes[i].kind == Kind::product;
            if (!is_linear || uses[i] > 1) plan_.place_of[i] = places++;
        }
    }
    int row(int node) {
        if (row_of_[node] == none) {
            row_of_[node] = static_cast<int>(plan_.source.size());
            plan_.source.push_back(plan_.place_of[node]);
        }
        return row_of_[node];
    }
    void add_term(int node, double share) { plan_.terms.push_back({share, plan_.place_of[node]}); }
    void decode(int i) {
        const Node& node = plan_.nodes[i];
        const int first = static_cast<int>(given_.size());
        const bool is_trigonometric = node.kind == Kind::sine || node.kind == Kind::cosine;
        plan_.term_of[i] = static_cast<int>(plan_.terms.size());
        switch (node.kind) {
            case Kind::state:
                break;
            case Kind::combination:
            case Kind::product:
                decode_sum(i);
                break;
            case Kind::quotient:
                add_term(node.b, 0);
                if (node.a >= 0) add_term(node.a, 0);
                given_.push_back({1, row(node.b), row(i)});
                break;
            case Kind::sine:
                plan_.slope_of.push_back(plan_.place_of[node.a]);
                [[fallthrough]];
            case Kind::cosine:
                add_term(node.a, 0);
                given_.push_back({1, -static_cast<int>(plan_.slope_of.size()), row(node.b)});
                break;
            case Kind::root:
                add_term(node.a, 0);
                given_.push_back({1, row(i), row(i)});
                break;
        }
        plan_.term_end.push_back(static_cast<int>(plan_.terms.size()));
        const int end = static_cast<int>(given_.size());
        if (end > first) (is_trigonometric ? trigonometric_ : algebraic_).push_back({plan_.place_of[i], first, end});
    }
    // a sum or a product, with all that is dissolved into it
    void decode_sum(int i) {
        std::vector<std::pair<int, double>> open{{i, 1.0}};
        while (!open.empty()) {
            const auto [at, factor] = open.back();
            open.pop_back();
            const Node& node = plan_.nodes[at];
            if (at != i && plan_.place_of[at] != none) {
                add_term(at, factor);
            } else if (node.kind == Kind::combination) {
                if (node.b >= 0) open.emplace_back(node.b, factor * node.factor_b);
                open.emplace_back(node.a, factor * node.factor_a);
            } else {
                for (const auto& [own, other] : {std::pair(node.a, node.b), std::pair(node.b, node.a)}) {
                    plan_.shares.push_back({factor, static_cast<int>(plan_.terms.size()), other});
                    add_term(own, 0);
                }
                given_.push_back({factor, row(node.a), row(node.b)});
            }
        }
    }
};

}  // namespace

TapePlan::TapePlan(const truth::Recording<double>& recording)
    : nodes(recording.tape.nodes), rates(recording.rates), algebraic(0) {
    TapePlanner(*this).plan();
}

}  // namespace polhode
