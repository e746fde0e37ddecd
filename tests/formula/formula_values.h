// Evaluates formulas of the variables x, y, z, the vector r = (x, y, z) and the attitude q in binary64.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "formula/evaluate.h"
#include "formula/parser.h"

namespace polhode::test {

/// Inputs 0 to 2: x, y, z; 3 to 6: q. Constants 0 to 8: an inertia tensor.
struct FormulaFixture {
    formula::Expression expression;
    formula::Scope scope;

    FormulaFixture() {
        using formula::Type;
        const int n = formula::no_node;
        const std::array<int, 3> x{expression.input(0), expression.input(1), expression.input(2)};
        scope.names["x"] = {Type::scalar, {x[0], n, n, n}};
        scope.names["y"] = {Type::scalar, {x[1], n, n, n}};
        scope.names["z"] = {Type::scalar, {x[2], n, n, n}};
        scope.names["r"] = {Type::vector, {x[0], x[1], x[2], n}};
        for (int i = 0; i < 4; ++i) scope.attitude.push_back(expression.input(3 + i));
        scope.names["q"] = {Type::quaternion,
                            {scope.attitude[0], scope.attitude[1], scope.attitude[2], scope.attitude[3]}};
        for (int i = 0; i < 9; ++i) scope.inertia.push_back(expression.constant(i));
    }
    formula::Value parse(const std::string& text) { return formula::parse_formula(text, scope, expression); }

    /// The values of nodes at 7 inputs, over any scalar with values.
    template <class S = double>
    std::vector<S> values(const std::vector<int>& nodes, const std::vector<S>& inputs) const {
        const std::vector<double> uniform =
            formula::compute_uniform_values<double>(expression, {2, 0.5, 0, 0.5, 3, 0, 0, 0, 4});
        const std::vector<char> needed = formula::find_needed(expression, nodes);
        formula::Evaluation<S, double> evaluation(expression, uniform, needed, nullptr);
        evaluation.compute(inputs.data());
        std::vector<S> result;
        for (const int node : nodes) result.push_back(evaluation.value(node));
        return result;
    }
};

/// The components of a formula at (x, y, z) and q.
inline std::vector<double> formula_values(const std::string& text, double x, double y, double z,
                                          const std::array<double, 4>& q = {1, 0, 0, 0}) {
    FormulaFixture fixture;
    const formula::Value value = fixture.parse(text);
    std::vector<int> nodes;
    for (const int node : value.component)
        if (node != formula::no_node) nodes.push_back(node);
    return fixture.values<double>(nodes, {x, y, z, q[0], q[1], q[2], q[3]});
}

}  // namespace polhode::test
