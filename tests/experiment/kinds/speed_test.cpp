// The study of speed: its factors against the times of its own runs, and what it says where nobody reaches an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "integrators/truth/fresh_cache.h"

namespace polhode {
namespace {

RunOptions quickly() {
    RunOptions options;
    options.quick = true;
    return options;
}

double number(const Table& table, const std::vector<Cell>& row, const char* column) {
    return std::get<double>(row[column_index(table, column)]);
}
std::string text(const Table& table, const std::vector<Cell>& row, const char* column) {
    return text_of(row[column_index(table, column)]);
}

const Table& named(const Findings& result, const std::string& name) {
    return std::find_if(result.tables.begin(), result.tables.end(), [&](const NamedTable& t) { return t.name == name; })
        ->table;
}

TEST(SpeedStudy, ItsFactorsAreThoseOfItsRuns) {
    const FreshCache cache;
    Experiment experiment = parse_experiment(R"({"name": "x", "kind": "speed", "scenes": ["nasa_brick"],
        "methods": ["exact", "taylor", "odeint_fehlberg78"],
        "settings": {"tolerances": [1e-6, 1e-8, 1e-10, 1e-12]}, "samples": 10, "repeats": 3})",
                                             "x.json");
    const Plan plan = make_plan(experiment, "x.json", false);
    const Findings result = find_kind("speed")->make(plan, quickly());
    const Table &runs = named(result, ""), &margins = named(result, "margins"), &smallest = named(result, "smallest");

    ASSERT_EQ(runs.rows.size(), 9U);
    // of each level: exact against all, ours against one, ours against all
    ASSERT_EQ(margins.rows.size(), 9U);
    for (const auto& row : margins.rows) {
        if (std::holds_alternative<std::monostate>(row[column_index(margins, "ratio")])) {
            EXPECT_NE((text(margins, row, "own") + text(margins, row, "peer")).find(" it"), std::string::npos);
            continue;
        }
        const double ratio = number(margins, row, "ratio"), level = number(margins, row, "attitude_error");
        EXPECT_DOUBLE_EQ(ratio, number(margins, row, "peer_seconds") / number(margins, row, "own_seconds"));
        // a time at an error lies between those of the runs on either side of it
        const std::string peer = text(margins, row, "peer");
        double least = HUGE_VAL, most = 0;
        for (const auto& run : runs.rows) {
            if (!peer.starts_with(text(runs, run, "method"))) continue;
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
            if (text(smallest, row, "method").starts_with(text(runs, run, "method")))
                least = std::min(least, number(runs, run, "attitude_error_max"));
        EXPECT_EQ(number(smallest, row, "attitude_error_max"), least);
    }
    for (const auto& row : named(result, "long").rows) EXPECT_EQ(text(named(result, "long"), row, "status"), "ok");
}

TEST(SpeedStudy, SaysWhoDoesNotReachAnError) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "speed", "scenes": ["nasa_brick"],
        "methods": ["taylor", "odeint_dopri5"], "settings": {"tolerances": [0.1]}, "samples": 10, "repeats": 1})",
                                                 "x.json"),
                                "x.json", false);
    const Findings result = find_kind("speed")->make(plan, quickly());
    const Table& margins = named(result, "margins");
    const auto& last = margins.rows.back();
    EXPECT_EQ(text(margins, last, "peer"), "no library reaches it");
}

}  // namespace
}  // namespace polhode
