// The kind `speed`: factors computed from the times of its runs, and the text where no method reaches an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiment/kinds/findings_read.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/run_experiment.h"
#include "integrators/truth/fresh_cache.h"

namespace polhode {
namespace {

// Runs the plan's cases and its long runs in a separate directory.
Findings findings_of(const Plan& plan) {
    RunOptions options = quickly();
    const std::filesystem::path directory = std::filesystem::path(::testing::TempDir()) / "polhode_speed_study";
    std::filesystem::remove_all(directory);
    options.directory = directory.string(), options.quiet = true;
    EXPECT_TRUE(run_experiment(plan, options, "polhode run x"));
    EXPECT_TRUE(pending_work(plan, options).empty());
    Findings findings = conclude_finished(plan, options.directory);
    std::filesystem::remove_all(directory);
    return findings;
}

TEST(SpeedStudy, ItsFactorsAreThoseOfItsRuns) {
    const FreshCache cache;
    Experiment experiment = parse_experiment(R"({"name": "x", "kind": "speed", "scenes": ["nasa_brick"],
        "methods": ["exact", "taylor", "odeint_fehlberg78"],
        "settings": {"tolerances": [1e-6, 1e-8, 1e-10, 1e-12]}, "samples": 10, "repeats": 3})",
                                             "x.json");
    const Plan plan = make_plan(experiment, "x.json", false);
    const Findings result = findings_of(plan);
    const Table &runs = table_of(result, ""), &margins = table_of(result, "margins"),
                &smallest = table_of(result, "smallest");

    ASSERT_EQ(runs.rows.size(), 9U);
    // for each level: exact, then polhode's fastest method that chooses its steps
    ASSERT_EQ(margins.rows.size(), 6U);
    for (const auto& row : margins.rows) {
        if (std::holds_alternative<std::monostate>(row[column_index(margins, "ratio")])) {
            EXPECT_NE((word(margins, row, "own") + word(margins, row, "peer")).find(" it"), std::string::npos);
            continue;
        }
        const double ratio = number(margins, row, "ratio"), level = number(margins, row, "attitude_error");
        EXPECT_DOUBLE_EQ(ratio, number(margins, row, "peer_seconds") / number(margins, row, "own_seconds"));
        // the time at an error is between the times of the neighbouring runs
        const std::string peer = word(margins, row, "peer");
        double least = HUGE_VAL, most = 0;
        for (const auto& run : runs.rows) {
            if (!peer.starts_with(word(runs, run, "method"))) continue;
            const double seconds = number(runs, run, "seconds_median");
            if (number(runs, run, "attitude_error_max") <= level) most = std::max(most, seconds);
            least = std::min(least, seconds);
        }
        EXPECT_GE(number(margins, row, "peer_seconds"), least);
        EXPECT_LE(number(margins, row, "peer_seconds"), most);
    }
    for (const auto& row : smallest.rows) {
        double least = HUGE_VAL;
        for (const auto& run : runs.rows)
            if (word(smallest, row, "method").starts_with(word(runs, run, "method")))
                least = std::min(least, number(runs, run, "attitude_error_max"));
        EXPECT_EQ(number(smallest, row, "attitude_error_max"), least);
    }
    // taylor at the finest tolerance over T, 10 T and 100 T
    const Table& longer = table_of(result, "long");
    ASSERT_EQ(longer.rows.size(), 3U);
    for (std::size_t i = 0; i < longer.rows.size(); ++i) {
        const auto& row = longer.rows[i];
        EXPECT_EQ(word(longer, row, "status"), "ok");
        EXPECT_EQ(word(longer, row, "scene"), "nasa_brick");
        EXPECT_EQ(number(longer, row, "tolerance"), 1e-12);
        EXPECT_DOUBLE_EQ(number(longer, row, "duration"),
                         number(longer, longer.rows[0], "duration") * std::pow(10.0, static_cast<double>(i)));
    }
}

TEST(SpeedStudy, ReportsWhichMethodsDoNotReachAnError) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "speed", "scenes": ["nasa_brick"],
        "methods": ["taylor", "odeint_dopri5"], "settings": {"tolerances": [0.1]}, "samples": 10, "repeats": 1})",
                                                 "x.json"),
                                "x.json", false);
    const Findings result = findings_of(plan);
    const Table& margins = table_of(result, "margins");
    const auto& last = margins.rows.back();
    EXPECT_EQ(word(margins, last, "peer"), "no library reaches it");
}

// Gravity exerts no torque on a ball, but a ball on a plane has no closed form: no rows of `exact` and no long runs.
TEST(SpeedStudy, ScenesWithPlanesHaveNoClosedForm) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "speed", "scenes": ["contact/bowling_ball"],
        "methods": ["taylor", "cvode_adams"], "settings": {"tolerances": [1e-8, 1e-13]}, "samples": 5, "repeats": 1})",
                                                 "x.json"),
                                "x.json", false);
    const Findings result = findings_of(plan);
    const Table& margins = table_of(result, "margins");
    ASSERT_EQ(margins.rows.size(), 3U);
    EXPECT_EQ(word(margins, margins.rows[0], "own"), "taylor");
    EXPECT_EQ(word(margins, margins.rows[0], "peer"), "cvode_adams");
    EXPECT_GT(number(margins, margins.rows[0], "ratio"), 0);
    for (const NamedTable& named : result.tables)
        if (named.name == "long") {
            EXPECT_TRUE(named.table.rows.empty());
        }
}

}  // namespace
}  // namespace polhode
