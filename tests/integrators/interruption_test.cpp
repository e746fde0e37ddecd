// Every long computation stops soon after an interruption is requested and reports it.
#include "text/interruption.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "integrators/method.h"
#include "integrators/own/ensemble.h"
#include "integrators/own/mechanism_ensemble.h"
#include "integrators/truth/reference.h"
#include "motion/ensemble_table.h"
#include "scene/scene_file.h"
#include "text/parallel.h"

namespace polhode {
namespace {

/// Returns true from call n + 1 on.
Interruption::Callback yes_after(std::atomic<int>& asked, int n) {
    return [&asked, n] { return ++asked > n; };
}

TEST(Interruption, IsWantedByNobodyAtFirst) {
    EXPECT_FALSE(Interruption::is_requested());
    {
        const Interruption outer(Interruption::Callback([] { return true; }));
        EXPECT_TRUE(Interruption::is_requested());
        {
            const Interruption inner(Interruption::Callback([] { return false; }));
            EXPECT_FALSE(Interruption::is_requested());
        }
        EXPECT_TRUE(Interruption::is_requested());
    }
    EXPECT_EQ(Interruption::current(), nullptr);
}

TEST(Interruption, EndsEveryKindOfDriver) {
    Scene scene = find_scene("heavy_asymmetric_top");
    scene.duration = 1e5;
    for (const char* name : {"odeint_rk4", "dop853", "taylor", "cvode_adams", "extrapolation", "radau"}) {
        std::atomic<int> asked = 0;
        const Interruption interruption(yes_after(asked, 3));
        Settings settings;
        settings.samples = 1;
        if (std::string(name) == "odeint_rk4") settings.step = 1e-3;
        const Trajectory cut = solve(scene, *find_method(name), settings);
        EXPECT_EQ(cut.status, Status::failed) << name;
        EXPECT_EQ(cut.message, "interrupted") << name;
        EXPECT_EQ(asked, 4) << name;
    }
}

TEST(Interruption, EndsATruthAndKeepsNothing) {
    Scene scene = find_scene("heavy_asymmetric_top");
    scene.duration = 3;
    scene.initial.angular_velocity[2] += 0.125;
    {
        std::atomic<int> asked = 0;
        const Interruption interruption(yes_after(asked, 5));
        EXPECT_FALSE(reference(scene, 10).available);
        EXPECT_GT(asked, 5);
    }
    EXPECT_TRUE(reference(scene, 10).available);
}

TEST(Interruption, EndsEnsemblesRowByRow) {
    Scene scene = find_scene("heavy_asymmetric_top");
    scene.duration = 1000;
    const std::vector<EnsembleBody> bodies(2000, ensemble_body(scene));
    std::atomic<int> asked = 0;
    const Interruption interruption(yes_after(asked, 3));
    EnsembleSettings settings;
    settings.threads = 2;
    for (const EnsembleRow& row : solve_ensemble(scene, bodies, settings)) {
        EXPECT_EQ(row.status, Status::failed);
        EXPECT_TRUE(row.message.starts_with("interrupted")) << row.message;
    }
    Scene pendulum = find_scene("mechanisms/double_pendulum");
    pendulum.duration = 1000;
    const MechanismTable table = parse_ensemble("shoulder.angle\n0.1\n0.2\n", "table", pendulum).mechanisms;
    for (const MechanismRow& row : solve_mechanism_ensemble(pendulum, table, 1, settings)) {
        EXPECT_EQ(row.status, Status::failed);
        EXPECT_TRUE(row.message.starts_with("interrupted")) << row.message;
    }
}

TEST(Interruption, IsInheritedByThreadsThatHelp) {
    std::atomic<int> asked = 0, seen = 0;
    const Interruption interruption(yes_after(asked, 0));
    parallel_for(8, 4, [&](std::size_t) { seen += Interruption::is_requested() ? 1 : 0; });
    EXPECT_EQ(seen, 8);
}

}  // namespace
}  // namespace polhode
