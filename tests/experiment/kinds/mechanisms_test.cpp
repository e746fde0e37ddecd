// The kinds `mechanism_truth` and `joints`, and the published numbers of mechanisms.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "build_kind.h"
#include "experiment/kinds/findings_read.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/published_figures.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/run_experiment.h"
#include "integrators/truth/fresh_cache.h"

namespace polhode {
namespace {

TEST(PublishedFigures, DecimalsKeepTheirDigits) {
    for (const char* text : {"-929.47789813801915283", "0.040822240119645808436", "16.000000000000000001",
                             "3.0000000000000000000", "-7.5000000000000000000e-9"})
        EXPECT_EQ(format_wide(parse_wide(text), 20), text);
    EXPECT_EQ(format_wide(parse_wide("9.9999"), 3), "10.0");
    EXPECT_EQ(format_wide(parse_wide("299792458.5"), 4), "299800000");
    EXPECT_EQ(format_wide(Wide(0), 5), "0");
}

// The double four-bar moves like a pendulum, whose motion by quadrature is known to 15 digits.
TEST(PublishedFigures, TheFourBarIsItsQuadrature) {
    const FreshCache cache;
    int of_quadrature = 0;
    for (const PublishedFigure& figure : compare_figures(true, 2)) {
        ASSERT_TRUE(figure.difference) << figure.computed;
        if (figure.source == "Exudyn") {
            EXPECT_GE(*figure.correct_digits, 5) << figure.quantity;
            EXPECT_LE(*figure.correct_digits, 7) << figure.quantity;
        } else {
            EXPECT_LT(*figure.difference, 5e-15) << figure.quantity;
            ++of_quadrature;
        }
    }
    EXPECT_EQ(of_quadrature, 4);
}

TEST(MechanismTruthStudy, CountsAndAgrees) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "mechanism_truth", "samples": 2,
        "scenes": ["mechanisms/physical_pendulum", "mechanisms/slider_crank"]})",
                                                 "x.json"),
                                "x.json", true);
    const Findings result = run_mechanism_truth(plan, quickly());
    const Table& table = table_of(result, "");
    ASSERT_EQ(table.rows.size(), 2U);
    EXPECT_EQ(word(table, table.rows[1], "degrees_of_freedom"), "1");
    EXPECT_EQ(word(table, table.rows[1], "loop_rows"), "5");
    EXPECT_EQ(word(table, table.rows[1], "redundant_rows"), "3");
    for (const auto& row : table.rows) {
        if (!optimised_build && word(table, row, "bound").empty()) continue;  // not computed within its limit of 1 s
        EXPECT_LE(number(table, row, "bound"), 1e-25);
        EXPECT_LT(number(table, row, "joint_gap_max"), 1e-28);
        EXPECT_GE(std::get<long>(row[column_index(table, "digits_agreed")]), 25);
    }
}

TEST(JointsStudy, TellsGapsAndOrders) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "joints", "samples": 2, "repeats": 1,
        "scenes": ["mechanisms/physical_pendulum"], "vary": {"/duration": [0.5]},
        "methods": ["sequential_impulses_10", "reduced_semi_implicit_euler"],
        "settings": {"steps": [0.01, 0.005, 0.0025, 0.00125]}})",
                                                 "x.json"),
                                "x.json", false);
    RunOptions options = quickly();
    const std::filesystem::path directory = std::filesystem::path(::testing::TempDir()) / "polhode_joints_study";
    std::filesystem::remove_all(directory);
    options.directory = directory.string(), options.quiet = true;
    EXPECT_TRUE(run_experiment(plan, options, "polhode run x"));
    const Findings result = conclude_finished(plan, options.directory);
    std::filesystem::remove_all(directory);
    const Table &scenes = table_of(result, "scenes"), &methods = table_of(result, "methods");
    ASSERT_EQ(scenes.rows.size(), 2U);
    EXPECT_EQ(methods.rows.size(), 8U);
    for (const auto& row : scenes.rows) EXPECT_NEAR(number(scenes, row, "order"), 1, 0.2);
    for (const auto& row : scenes.rows) {
        const bool maximal = word(scenes, row, "method") == "sequential_impulses_10";
        EXPECT_EQ(number(scenes, row, "joint_gap at 1/100 s") > 1e-9, maximal);
    }
}

}  // namespace
}  // namespace polhode
