#include "experiment/run/result.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace polhode {
namespace {

Result of_a_mechanism() {
    Result r;
    r.scene = "chain", r.method = "m", r.setting_kind = SettingKind::step, r.setting = 0.5;
    r.errors["attitude"].max = 0.25, r.errors["position"].max = 0.125, r.errors["joint_gap"].max = 1e-3;
    r.errors["joint_turn"].max = 0, r.errors["reaction"].max = 0.5, r.errors["linear_momentum"].max = 2;
    r.errors.worst_body = "third";
    r.series.t = {0, 1}, r.series["attitude"] = {0, 0.25}, r.series["joint_gap"] = {0, 1e-3};
    r.series["joint_turn"] = {0, 0}, r.series["position"] = {0, 0.125};
    return r;
}

TEST(ResultOfSeveralBodies, HasColumnsAtTheEndOfTheTable) {
    const std::vector<std::string> single = result_columns(), all = result_columns(TableKind::systems);
    const std::vector<std::string> further{"position_error_max", "linear_momentum_error_max", "joint_gap_max",
                                           "joint_turn_max",     "reaction_error_max",        "worst_body"};
    ASSERT_EQ(all.size(), single.size() + further.size());
    EXPECT_TRUE(std::equal(single.begin(), single.end(), all.begin()));
    EXPECT_TRUE(std::equal(further.begin(), further.end(), all.begin() + static_cast<long>(single.size())));
    const Table table{all, {result_row("e", of_a_mechanism(), TableKind::systems)}};
    EXPECT_EQ(text_of(table.rows[0][column_index(table, "joint_gap_max")]), "0.001");
    EXPECT_EQ(text_of(table.rows[0][column_index(table, "worst_body")]), "third");
    EXPECT_EQ(result_row("e", of_a_mechanism()).size(), single.size());
}

TEST(ResultOfSeveralBodies, ReadsBack) {
    const Result r = of_a_mechanism();
    const Table table = parse_csv(csv({result_columns(TableKind::systems), {result_row("e", r, TableKind::systems)}}));
    const Result back = parse_result(table, 0);
    EXPECT_EQ(result_row("e", back, TableKind::systems), result_row("e", r, TableKind::systems));
    EXPECT_EQ(back.errors.worst_body, "third");
    EXPECT_EQ(back.errors["reaction"].max, 0.5);
    // a table of single bodies has no columns for joints
    const Result without = parse_result(parse_csv(csv({result_columns(), {result_row("e", r)}})), 0);
    EXPECT_EQ(without.errors["attitude"].max, 0.25);
    EXPECT_FALSE(without.errors["joint_gap"].max || without.errors["position"].max);
    EXPECT_EQ(without.errors.worst_body, "");
    const ErrorSeries series = parse_series(parse_csv(csv(series_table(r.series))));
    EXPECT_EQ(series["joint_gap"], r.series["joint_gap"]);
    EXPECT_EQ(series["attitude"], r.series["attitude"]);
}

// drift.csv is shared by all experiments, so its columns are always the same.
TEST(ResultOfSeveralBodies, HasSeriesInATableOfTheirOwn) {
    Result single;
    single.scene = "top", single.method = "m", single.series.t = {0}, single.series["attitude"] = {0.5};
    const std::vector<Result> both{of_a_mechanism(), single}, alone{single};
    EXPECT_EQ(drift_table("e", both).columns, drift_table("e", alone).columns);
    EXPECT_EQ(drift_table("e", both).rows.size(), 3U);
    EXPECT_EQ(series_table(single.series).columns.size() + 4, drift_table("e", alone).columns.size());
    const Table joints = joint_drift_table("e", both);
    ASSERT_EQ(joints.rows.size(), 2U);
    EXPECT_EQ(text_of(joints.rows[1][column_index(joints, "scene")]), "chain");
    EXPECT_EQ(text_of(joints.rows[1][column_index(joints, "joint_gap")]), "0.001");
    EXPECT_EQ(text_of(joints.rows[1][column_index(joints, "position_error")]), "0.125");
    EXPECT_TRUE(joint_drift_table("e", alone).rows.empty());
}

TEST(ResultColumns, NameEachMeasureThatATableHas) {
    std::vector<std::string> names;
    for (const ResultColumn& column : result_column_table())
        if (column.is_error) names.push_back(column.name);
    for (const char* name : {"attitude_error_final", "norm_error_max", "position_error_max", "joint_gap_max",
                             "joint_turn_max", "reaction_error_max"})
        EXPECT_EQ(std::ranges::count(names, name), 1) << name;
    EXPECT_EQ(result_column_table()[result_column_index("joint_gap_max")].name, "joint_gap_max");
    EXPECT_THROW(result_column_index("joint_gap"), std::invalid_argument);
}

}  // namespace
}  // namespace polhode
