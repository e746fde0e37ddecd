// The kind `engine_joint_laws` with methods of polhode, whose limits and friction are known.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "experiment/kinds/findings_read.h"
#include "experiment/kinds/kinds.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/run_experiment.h"
#include "integrators/truth/fresh_cache.h"

namespace polhode {
namespace {

TEST(EngineJointLaws, TablesHaveTheLawsOfMethodsOfPolhode) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "engine_joint_laws", "samples": 5,
        "repeats": 1, "scenes": ["joints/coulomb_oscillator", "joints/rack_and_pinion"],
        "methods": ["xpbd_joints_10", "mujoco_joints"],
        "settings": {"steps": [0.016666666666666666, 0.001]}})",
                                                 "x.json"),
                                "x.json", false);
    RunOptions options = quickly();
    const std::filesystem::path directory = std::filesystem::path(::testing::TempDir()) / "polhode_engine_joint_laws";
    std::filesystem::remove_all(directory);
    options.directory = directory.string(), options.quiet = true;
    ASSERT_TRUE(run_experiment(plan, options, "polhode run x"));
    const Findings result = conclude_finished(plan, options.directory);
    std::filesystem::remove_all(directory);

    const Table &limits = table_of(result, "limits"), &friction = table_of(result, "friction"),
                &gears = table_of(result, "gears");
    ASSERT_EQ(limits.rows.size(), 2U);
    const auto &xpbd = limits.rows[0], &mujoco = limits.rows[1];
    // a rigid limit with restitution, and a critically damped spring that returns exp(-2) of the speed
    EXPECT_LT(number(limits, xpbd, "depth at 1/1000 s"), 1e-9);
    EXPECT_LT(number(limits, xpbd, "rebound at 1/1000 s"), 1e-9);
    EXPECT_NEAR(number(limits, xpbd, "restitution at 1/1000 s"), 0.75, 0.01);
    EXPECT_NEAR(number(limits, mujoco, "rebound at 1/1000 s"), 0.135, 0.02);
    EXPECT_EQ(word(limits, mujoco, "restitution at 1/1000 s"), "");
    // friction holds, and creeps for 4 s
    EXPECT_LT(number(friction, friction.rows[0], "creep at 1/1000 s"), 1e-9);
    EXPECT_GT(number(friction, friction.rows[1], "creep at 1/1000 s"), 1e-3);
    // neither has couplings
    for (const auto& row : gears.rows)
        EXPECT_NE(word(gears, row, "message").find("couplings"), std::string::npos) << word(gears, row, "message");
    EXPECT_TRUE(table_of(result, "control").rows.empty());
    EXPECT_EQ(table_of(result, "scenes").rows.size(), 4U);
}

}  // namespace
}  // namespace polhode
