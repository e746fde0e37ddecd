#include "integrators/tape/canonical_order.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace polhode {
namespace {

using Node = TapeNode<double>;
using Kind = Node::Kind;
constexpr int constant = Traced<double>::constant;

bool is_symmetric(const Node& node) { return node.kind == Kind::combination || node.kind == Kind::product; }

// The partner of a sine or cosine is not an operand, nor is the index of a state.
int first_operand(const Node& node) { return node.kind == Kind::state ? constant : node.a; }
int second_operand(const Node& node) { return is_symmetric(node) || node.kind == Kind::quotient ? node.b : constant; }

// Positions of the nodes in an order in which operands precede their users. Nodes are grouped by depth, then sorted
// by operation and operand positions. Positions are unique because equal nodes are recorded once.
std::vector<int> ranks(const std::vector<Node>& nodes) {
    std::vector<int> rank(nodes.size()), level(nodes.size(), 0);
    std::vector<std::vector<int>> levels;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const int operand : {first_operand(nodes[i]), second_operand(nodes[i])})
            if (operand >= 0) level[i] = std::max(level[i], level[operand] + 1);
        levels.resize(std::max<std::size_t>(levels.size(), level[i] + 1));
        levels[level[i]].push_back(static_cast<int>(i));
    }
    const auto key = [&](int i) {
        const Node& node = nodes[i];
        // Compare numbers by their bits, so that NaN has a place in the order too.
        auto factor_a = std::bit_cast<std::int64_t>(node.factor_a);
        auto factor_b = std::bit_cast<std::int64_t>(node.factor_b);
        int a = first_operand(node), b = second_operand(node);
        a = a >= 0 ? rank[a] : constant, b = b >= 0 ? rank[b] : constant;
        if (node.kind == Kind::state) a = node.a;
        if (is_symmetric(node) && a < b) std::swap(a, b), std::swap(factor_a, factor_b);
        // Measured: with the slowest operations first, programs are as fast as in the recorded order.
        return std::tuple(-static_cast<int>(node.kind), a, b, factor_a, factor_b);
    };
    int next = 0;
    for (std::vector<int>& here : levels) {
        std::sort(here.begin(), here.end(), [&](int i, int j) { return key(i) < key(j); });
        for (const int i : here) rank[i] = next++;
    }
    return rank;
}

}  // namespace

Recording<double> in_canonical_order(const Recording<double>& recording) {
    const std::vector<Node>& nodes = recording.tape.nodes;
    const std::vector<int> rank = ranks(nodes);
    std::vector<int> order(nodes.size()), renamed(nodes.size(), constant);
    for (std::size_t i = 0; i < nodes.size(); ++i) order[rank[i]] = static_cast<int>(i);
    Recording<double> result;
    std::vector<Node>& ordered = result.tape.nodes;
    ordered.reserve(nodes.size());
    for (const int i : order) {
        if (renamed[i] != constant) continue;
        Node node = nodes[i];
        const int place = renamed[i] = static_cast<int>(ordered.size());
        if (node.kind == Kind::sine || node.kind == Kind::cosine) {
            // Sine and cosine are adjacent, sine first.
            const int sine = node.kind == Kind::sine ? i : node.b, cosine = nodes[sine].b;
            renamed[sine] = place, renamed[cosine] = place + 1;
            ordered.push_back({Kind::sine, renamed[node.a], place + 1, 0, 0});
            ordered.push_back({Kind::cosine, renamed[node.a], place, 0, 0});
            continue;
        }
        if (first_operand(node) >= 0) node.a = renamed[node.a];
        if (second_operand(node) >= 0) node.b = renamed[node.b];
        // Put the operand of lower position last, as in recordings.
        if (is_symmetric(node) && node.a < node.b) std::swap(node.a, node.b), std::swap(node.factor_a, node.factor_b);
        ordered.push_back(node);
    }
    for (const Traced<double>& rate : recording.rates)
        result.rates.emplace_back(rate.factor, rate.node >= 0 ? renamed[rate.node] : constant, nullptr);
    return result;
}

}  // namespace polhode
