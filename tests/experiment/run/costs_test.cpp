#include "experiment/run/costs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "experiment/run/case_store.h"
#include "experiment/run/run_experiment.h"
#include "text/message.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

Plan plan_of(const std::string& durations, const std::string& kind = "sweep") {
    const std::string text = R"({"name": "t", "kind": ")" + kind +
                             R"(", "scenes": ["free_asymmetric"], "methods": ["odeint_rk4", "odeint_dopri5"],
        "settings": {"steps": [0.1, 0.05], "tolerances": [1e-4, 1e-8]}, "vary": {"/duration": [)" +
                             durations + "]}}";
    return make_plan(parse_experiment(text, "t.json"), "t.json", false);
}

// a table written by cost_table(), with seconds given by a function
Costs costs_of(const Plan& plan, const std::function<double(const std::vector<Cell>&)>& seconds) {
    Table table = cost_table(plan, "/nowhere");
    for (auto& row : table.rows) row[6] = seconds(row);
    return {parse_csv(csv(table)), "plan.csv"};
}

double load_of(const Plan& plan, const Costs& costs, const std::vector<std::vector<int>>& assignment, int shard) {
    double sum = 0;
    for (std::size_t s = 0; s < assignment.size(); ++s) {
        bool any = false;
        for (std::size_t c = 0; c < assignment[s].size(); ++c)
            if (assignment[s][c] == shard) sum += costs.curve_seconds(plan, plan.scenes[s], plan.curves[c]), any = true;
        if (any) sum += costs.truth_seconds(plan, plan.scenes[s]);
    }
    return sum;
}

TEST(Costs, ATableHasEachCaseAndEachTruthOnce) {
    const Plan plan = plan_of("1, 2, 3");
    const Table table = cost_table(plan, "/nowhere");
    EXPECT_EQ(table.columns, Costs::columns());
    ASSERT_EQ(table.rows.size(), 3U * (1 + 6));  // rk4 by step, dopri5 by step and by tolerance
    std::set<std::string> seen;
    for (const auto& row : table.rows) {
        std::string name;
        for (std::size_t c = 0; c < 6; ++c) name += text_of(row[c]) + "\n";
        EXPECT_TRUE(seen.insert(name).second) << name;
        EXPECT_EQ(text_of(row[7]), "assumed");
    }
}

TEST(Costs, UsesMeasuredTimesElseTheMedianOfTheMethod) {
    const Plan plan = plan_of("1, 2, 3");
    const fs::path directory = fs::path(testing::TempDir()) / "polhode_costs";
    fs::remove_all(directory);
    save_duration(directory.string(), "t free_asymmetric{/duration=1} odeint_rk4 step 0.1", 5);
    save_truth_duration(directory.string(), plan, plan.scenes[0], 7);
    save_truth_duration(directory.string(), plan, plan.scenes[0], 0.001);  // from the cache
    std::map<std::string, std::pair<double, std::string>> found;
    for (const auto& row : cost_table(plan, directory.string()).rows)
        found[text_of(row[1]) + " " + text_of(row[2]) + " " + text_of(row[5])] = {std::get<double>(row[6]),
                                                                                  text_of(row[7])};
    using Cost = std::pair<double, std::string>;
    EXPECT_EQ(found["free_asymmetric{/duration=1} odeint_rk4 0.1"], Cost(5, "measured"));
    EXPECT_EQ(found["free_asymmetric{/duration=2} odeint_rk4 0.1"], Cost(5, "other scenes at this setting"));
    EXPECT_EQ(found["free_asymmetric{/duration=2} odeint_rk4 0.05"], Cost(5, "this method at other settings"));
    EXPECT_EQ(found["free_asymmetric{/duration=2} odeint_dopri5 1e-08"], Cost(5, "all other cases"));
    EXPECT_EQ(found["free_asymmetric{/duration=1} truth "], Cost(7, "measured"));
    EXPECT_EQ(found["free_asymmetric{/duration=3} truth "].first, 7);
    fs::remove_all(directory);
}

// Graham (1969): assigning the longest work first gives no machine more than 4/3 of the optimum. The optimum is at
// least the mean and at least the longest piece.
TEST(Costs, NoShardGetsMoreThanGrahamsBound) {
    std::string durations;
    for (int i = 1; i <= 40; ++i) durations += (i > 1 ? "," : "") + std::to_string(i);
    const Plan plan = plan_of(durations);
    std::mt19937 random(7);
    for (const int shards : {2, 3, 7, 16}) {
        std::lognormal_distribution<double> seconds(0, 1);
        const Costs costs =
            costs_of(plan, [&](const auto& row) { return text_of(row[2]) == "truth" ? 0 : seconds(random); });
        const auto assignment = assign_shards(plan, costs, shards);
        double most = 0, total = 0, longest = 0;
        for (int shard = 0; shard < shards; ++shard) {
            const double load = load_of(plan, costs, assignment, shard);
            most = std::max(most, load), total += load;
        }
        for (const PlannedScene& scene : plan.scenes) {
            double sum = 0;
            for (const PlannedCurve& curve : plan.curves) sum += costs.curve_seconds(plan, scene, curve);
            longest = std::max(longest, sum);
        }
        EXPECT_LE(most, 4.0 / 3 * std::max(total / shards, longest)) << shards;
    }
}

TEST(Costs, ASceneStaysTogetherUnlessItCostsMoreThanAShare) {
    const Plan plan = plan_of("1, 2, 3, 4");
    // the first scene costs as much as all others together, which have equal costs
    const Costs costs = costs_of(plan, [&](const auto& row) {
        if (text_of(row[2]) == "truth") return 0.0;
        return text_of(row[1]) == plan.scenes[0].label ? 3.0 : 1.0;
    });
    const auto assignment = assign_shards(plan, costs, 4);
    EXPECT_GT(std::set<int>(assignment[0].begin(), assignment[0].end()).size(), 1U);
    for (std::size_t s = 1; s < 4; ++s)
        EXPECT_EQ(std::set<int>(assignment[s].begin(), assignment[s].end()).size(), 1U) << s;
    std::set<int> all;
    for (const auto& scene : assignment) all.insert(scene.begin(), scene.end());
    EXPECT_EQ(all.size(), 4U);
}

TEST(Costs, EveryCurveIsInExactlyOneShard) {
    const Plan plan = plan_of("1, 2, 3, 4, 5");
    RunOptions options;
    options.shards = 3;
    for (const bool by_costs : {false, true}) {
        if (by_costs) options.costs = std::make_shared<const Costs>(costs_of(plan, [](const auto&) { return 1.0; }));
        for (std::size_t s = 0; s < plan.scenes.size(); ++s)
            for (std::size_t c = 0; c < plan.curves.size(); ++c) {
                int taken = 0;
                for (options.shard = 1; options.shard <= 3; ++options.shard)
                    taken += CaseSelection(plan, options).contains(s, c);
                EXPECT_EQ(taken, 1);
            }
    }
}

TEST(Costs, AWrongPlanIsRefusedByItsLine) {
    const auto refused = [](const std::string& text) {
        try {
            const Costs costs(parse_csv(text), "plan.csv");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("not refused");
    };
    const std::string head = "experiment,scene,method,formulation,setting_kind,setting,expected_seconds,source\n";
    EXPECT_NE(refused("a,b\n1,2\n").find("plan.csv: line 1: has no column experiment"), std::string::npos);
    for (const char* seconds : {"", "nan", "inf", "-1", "x", "1 s"})
        EXPECT_NE(refused(head + "e,s,m,,,," + seconds + ",x\n").find("plan.csv: line 2: expected_seconds"),
                  std::string::npos)
            << seconds;
    EXPECT_NE(refused(head + "e,s,m,,,,1,x\ne,s,m,,,,2,x\n").find("line 3: repeats a case of an earlier line"),
              std::string::npos);
}

TEST(Costs, AStudyIsOneRow) {
    const Plan plan = make_plan(find_experiment("gimbal_lock"), "gimbal_lock", true);
    const Table table = work_cost_table(plan, "/nowhere");
    ASSERT_EQ(table.rows.size(), 1U);
    EXPECT_EQ(text_of(table.rows[0][0]), plan.experiment.name);
}

TEST(Costs, IncludesTheCasesOfTheFollowUp) {
    const Plan plan = make_plan(find_experiment("speed"), "speed", true);
    ASSERT_NE(plan.experiment.kind->follow_up, nullptr);
    const Table table = work_cost_table(plan, "/nowhere");
    EXPECT_GT(table.rows.size(), cost_table(plan, "/nowhere").rows.size());
    EXPECT_NO_THROW(Costs(parse_csv(csv(table)), "plan.csv"));
}

}  // namespace
}  // namespace polhode
