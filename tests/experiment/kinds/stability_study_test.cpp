// The kind `stability`: comparison with published limits, and continuation of an interrupted run.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "build_kind.h"
#include "experiment/kinds/stability.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "integrators/truth/fresh_cache.h"

namespace polhode {
namespace {

Plan plan_of(const std::string& scenes, const std::string& methods) {
    return make_plan(
        parse_experiment(R"({"name": "x", "kind": "stability", "scenes": [)" + scenes + R"(], "methods": [)" + methods +
                             R"(], "settings": {"tolerances": [1e-3, 1e-8]}, "samples": 8,
        "seconds_per_run": 2, "max_evaluations": 20000})",
                         "x.json"),
        "x.json", false);
}

class StabilityStudy : public ::testing::Test {
  protected:
    StabilityStudy() {
        options.directory = (std::filesystem::path(::testing::TempDir()) /
                             ::testing::UnitTest::GetInstance()->current_test_info()->name())
                                .string();
        options.quiet = true, options.jobs = 2;
        std::filesystem::remove_all(options.directory);
    }
    ~StabilityStudy() override { std::filesystem::remove_all(options.directory); }

    const FreshCache cache;
    RunOptions options;
};

const StabilityFinding& finding(const StabilityFindings& found, const std::string& method, SettingKind kind) {
    for (const StabilityFinding& f : found.findings)
        if (f.method->name == method && f.kind == kind) return f;
    throw std::logic_error("no finding for " + method);
}

TEST_F(StabilityStudy, FindsThePublishedLimitsOnDrag) {
    const StabilityFindings found = run_stability_cases(
        plan_of(R"("extreme/drag_100")", R"("odeint_euler", "odeint_rk4", "implicit_midpoint", "radau5", "cvode_bdf")"),
        options);
    EXPECT_EQ(found.missing, 0);
    ASSERT_NEAR(found.scenes[0].fastest_rate, 100, 1e-9);
    EXPECT_TRUE(found.scenes[0].is_linear);
    EXPECT_EQ(found.scenes[0].family, "drag");
    // E. Hairer & G. Wanner 1996, Solving Ordinary Differential Equations II, IV.2: 2 and 2.785
    for (const auto& [method, limit] : {std::pair{"odeint_euler", 2.0}, std::pair{"odeint_rk4", 2.785}}) {
        const StabilityFinding& f = finding(found, method, SettingKind::step);
        ASSERT_TRUE(f.stable) << method;
        EXPECT_NEAR(100 * f.stable->result.setting, limit, 0.05 * limit) << method;
        ASSERT_TRUE(f.beyond);
        EXPECT_EQ(f.beyond->outcome, Outcome::diverged);
        EXPECT_FALSE(f.beyond->result.message.empty());
        ASSERT_TRUE(f.accurate);
        EXPECT_LE(*f.accurate->result.errors["attitude"].max, accurate_attitude);
    }
    // A-stable: stable at the largest step
    const StabilityFinding& midpoint = finding(found, "implicit_midpoint", SettingKind::step);
    ASSERT_TRUE(midpoint.stable);
    EXPECT_EQ(midpoint.stable->result.setting, found.scenes[0].duration / 8);
    EXPECT_FALSE(midpoint.beyond);
    // L-stable, but the attitude rotates too far per step for simplified Newton iterations: the run fails without
    // growth
    const StabilityFinding& radau = finding(found, "radau5", SettingKind::step);
    ASSERT_TRUE(radau.stable);
    EXPECT_GT(100 * radau.stable->result.setting, 2.8);
    for (const StabilityRun& run : radau.runs) EXPECT_NE(run.outcome, Outcome::diverged);
}

TEST_F(StabilityStudy, EveryFailedRowHasAMessage) {
    const Plan plan = plan_of(R"("extreme/spring_1000", "extreme/middle_axis_0.1")",
                              R"("odeint_euler", "article_mended", "radau5", "cvode_adams", "exact")");
    const StabilityFindings found = run_stability_cases(plan, options);
    std::map<Outcome, long> outcomes;
    for (const StabilityFinding& f : found.findings)
        for (const StabilityRun& run : f.runs) {
            ++outcomes[run.outcome];
            if (run.result.status == Status::ok) {
                EXPECT_LE(run.result.errors["attitude"].max.value_or(0), 1) << f.method->name;
            } else if (run.result.status != Status::unsupported) {
                EXPECT_FALSE(run.result.message.empty()) << f.method->name;
            }
            for (const Cell& cell : result_row("x", run.result)) {
                if (const double* value = std::get_if<double>(&cell)) {
                    EXPECT_TRUE(std::isfinite(*value)) << f.method->name;
                }
            }
        }
    // Radau damps a spring at steps far above its period: |R(iy)| < 1
    EXPECT_GT(outcomes[Outcome::damped_to_rest], 0);
    EXPECT_GT(outcomes[Outcome::diverged], 0);
    EXPECT_GT(outcomes[Outcome::accurate], 0);
}

TEST_F(StabilityStudy, GoesOnWhereItWasInterrupted) {
    const Plan plan = plan_of(R"("extreme/drag_100", "extreme/spring_1000")", R"("odeint_rk4", "splitting2")");
    RunOptions part = options;
    part.filter = "drag.*rk4";
    const StabilityFindings first = run_stability_cases(plan, part);
    EXPECT_EQ(first.missing, 3);
    const StabilityFindings whole = run_stability_cases(plan, options);
    EXPECT_EQ(whole.missing, 0);
    // nothing is run twice, so even the times are equal
    const StabilityFindings again = run_stability_cases(plan, options);
    const Table all = stability_table(plan, whole);
    EXPECT_EQ(csv(stability_table(plan, again)), csv(all));
    const long before = static_cast<long>(first.findings[0].runs.size());
    EXPECT_EQ(csv(stability_table(plan, first)), csv({all.columns, {all.rows.begin(), all.rows.begin() + before}}));
    // the maps take the longest time and have a separate test
    if (!optimised_build) GTEST_SKIP() << "the whole study takes minutes in an unoptimised build";
    RunOptions quick = options;
    quick.quick = true;
    const Findings result = find_kind("stability")->make(plan, quick);
    EXPECT_EQ(result.missing, 0);
    EXPECT_EQ(csv(result.tables[0].table), csv(all));
    EXPECT_NE(result.page.find("### odeint_rk4"), std::string::npos);
    EXPECT_NE(result.page.find("### splitting2"), std::string::npos);
}

}  // namespace
}  // namespace polhode
