// Tables from finished rows, computed from rows with known results.
#include <gtest/gtest.h>

#include <cmath>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/sweep_tables.h"

namespace polhode {
namespace {

Plan plan_of(const std::string& kind, const std::string& settings) {
    return make_plan(parse_experiment(R"({"name": "t", "scenes": ["free_asymmetric", "symmetric"], "methods":
                                          ["odeint_dopri5"], "kind": ")" +
                                          kind + R"(", "settings": )" + settings + "}",
                                      "t.json"),
                     "t.json", false);
}

Result row(const PlannedScene& scene, const PlannedCurve& curve, double setting, double error, double seconds) {
    Result r;
    r.scene = scene.label, r.method = curve.method->name, r.setting_kind = curve.kind, r.setting = setting;
    r.formulation = curve.formulation;
    r.errors["attitude"].max = r.errors["attitude"].final = error;
    r.seconds_min = r.seconds_median = seconds;
    return r;
}

double number(const Table& table, std::size_t row, const char* column) {
    return std::get<double>(table.rows.at(row)[column_index(table, column)]);
}

TEST(GainTable, ComparesTimesAtTheSameError) {
    const Plan plan = plan_of("leave_out", R"({"tolerances": [1e-6, 1e-8, 1e-10]})");
    std::vector<Result> results;
    // seconds = cost error^(-1/5); the full formulation costs 3 times as much and has half the error at each tolerance
    for (const PlannedCurve& curve : plan.curves)
        for (const double tolerance : curve.settings) {
            const bool reduced = curve.formulation == Formulation::reduced;
            const double error = (reduced ? 10 : 5) * tolerance;
            results.push_back(
                row(plan.scenes[0], curve, tolerance, error, (reduced ? 1e-5 : 3e-5) * std::pow(error, -0.2)));
        }
    const Table table = gain_table(plan, results).table;
    ASSERT_EQ(table.rows.size(), 2U);
    EXPECT_NEAR(number(table, 0, "gain"), 3, 1e-9);
    EXPECT_NEAR(number(table, 0, "error_ratio"), 2, 1e-9);
    EXPECT_NEAR(number(table, 0, "attitude_error"), 1e-7, 1e-15);
    // the scene without rows
    EXPECT_EQ(text_of(table.rows[1][column_index(table, "gain")]), "");
}

TEST(GainTable, TakesTheMeanTimeOfRunsAtRoundOff) {
    const Plan plan = plan_of("leave_out", R"({"tolerances": [1e-13, 1e-14]})");
    std::vector<Result> results;
    for (const PlannedCurve& curve : plan.curves)
        for (const double tolerance : curve.settings)
            results.push_back(row(plan.scenes[0], curve, tolerance, tolerance == 1e-13 ? 2e-13 : 2.1e-13,
                                  curve.formulation == Formulation::reduced ? 1e-3 : 2e-3));
    EXPECT_NEAR(number(gain_table(plan, results).table, 0, "gain"), 2, 1e-9);
}

TEST(DigitsTable, CountsFromTheToleranceAndKeepsTheWorst) {
    const Plan plan = plan_of("tolerance", R"({"tolerances": [1e-4, 1e-8]})");
    const PlannedCurve& curve = plan.curves[0];
    std::vector<Result> results{row(plan.scenes[0], curve, 1e-4, 1e-3, 1), row(plan.scenes[0], curve, 1e-8, 1e-5, 1),
                                row(plan.scenes[1], curve, 1e-4, 1e-5, 1), row(plan.scenes[1], curve, 1e-8, 1e-8, 1)};
    results[3].status = Status::tolerance_not_met;
    const Table table = digits_table(plan, results);
    ASSERT_EQ(table.columns, (std::vector<std::string>{"scene", "method", "0.0001", "1e-08"}));
    ASSERT_EQ(table.rows.size(), 4U);
    EXPECT_NEAR(number(table, 0, "0.0001"), 0, 1e-12);   // median of -1 and 1
    EXPECT_NEAR(number(table, 1, "0.0001"), -1, 1e-12);  // worst
    EXPECT_NEAR(number(table, 1, "1e-08"), -3, 1e-12);
    EXPECT_NEAR(number(table, 2, "1e-08"), -3, 1e-12);
    EXPECT_NEAR(number(table, 3, "0.0001"), 1, 1e-12);
    EXPECT_EQ(text_of(table.rows[3][3]), "");  // the run is not `ok`
}

}  // namespace
}  // namespace polhode
