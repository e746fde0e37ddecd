#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <vector>

#include "integrators/own/ensemble_scenes.h"
#include "text/parallel.h"

namespace polhode {
namespace {

bool same_bits(const Sample& a, const Sample& b) {
    return a.t == b.t && a.q == b.q && a.angular_velocity_B == b.angular_velocity_B && a.position_W == b.position_W;
}

TEST(EnsembleThreads, SameBitsForAnyNumber) {
    for (const bool heavy : {false, true}) {
        const Scene scene = heavy ? testing::top_scene(0.05) : testing::free_scene(10);
        auto bodies = heavy ? testing::tops(1100, false, 1) : testing::free_bodies(2100, 1);
        bodies[700].mass = -1;
        const auto one = solve_ensemble(scene, bodies);
        EXPECT_EQ(one[700].status, Status::failed);
        for (const int threads : {2, 3}) {
            EnsembleSettings settings;
            settings.threads = threads;
            const auto rows = solve_ensemble(scene, bodies, settings);
            ASSERT_EQ(rows.size(), one.size());
            for (std::size_t i = 0; i < rows.size(); ++i) {
                ASSERT_EQ(rows[i].status, one[i].status) << i;
                ASSERT_TRUE(same_bits(rows[i].end, one[i].end)) << i << " on " << threads;
            }
        }
    }
}

TEST(EnsembleThreads, OneByOneToo) {
    Scene scene = testing::free_scene(0.1);
    scene.loads = {UserTorque{"spin up", [](const LoadState&) { return Vector3<double>(0.1, 0, 0); }, {}}};
    const auto bodies = testing::free_bodies(40, 2);
    EnsembleSettings settings;
    const auto one = solve_ensemble(scene, bodies, settings);
    settings.threads = 3;
    const auto rows = solve_ensemble(scene, bodies, settings);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].status, Status::ok) << rows[i].message;
        EXPECT_TRUE(same_bits(rows[i].end, one[i].end)) << i;
    }
}

// Blocks of bodies, solved by several threads at once.
TEST(EnsembleThreads, ASolverMovesBodiesSomeAtATime) {
    for (const bool heavy : {false, true}) {
        const Scene scene = heavy ? testing::top_scene(0.05) : testing::free_scene(10);
        const auto bodies = heavy ? testing::tops(300, false, 3) : testing::free_bodies(300, 3);
        const auto whole = solve_ensemble(scene, bodies);
        const EnsembleSolver solver(scene, {});
        EXPECT_GE(solver.block(), 64u);
        std::vector<EnsembleRow> rows(bodies.size());
        constexpr std::size_t some = 70;
        parallel_for((bodies.size() + some - 1) / some, 3, [&](std::size_t i) {
            const std::size_t first = i * some, count = std::min(some, bodies.size() - first);
            solver.solve(std::span(bodies).subspan(first, count), std::span(rows).subspan(first, count));
        });
        for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_TRUE(same_bits(rows[i].end, whole[i].end)) << i;
        EXPECT_THROW(solver.solve(bodies, std::span(rows).first(2)), std::invalid_argument);
    }
    Scene pushed = testing::free_scene(1);
    pushed.loads = {UserTorque{"push", [](const LoadState&) { return Vector3<double>(1, 0, 0); }, {}}};
    EXPECT_LE(EnsembleSolver(pushed, {}).block(), 16u) << "long runs are shared by threads";
}

}  // namespace
}  // namespace polhode
