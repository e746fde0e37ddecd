// Reported counts of right-hand sides against the number of calls, for every method.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "integrators/method.h"
#include "integrators/scenes.h"
#include "motion/user_system.h"

namespace polhode {
namespace {

/// What a method counts under a user-defined torque; integrators/README.md lists the counts that are not the calls.
enum class Count {
    calls,
    sweeps,            ///< passes over all distances, ten per call
    calls_after_pose,  ///< the method poses the scene again, which calls the torque as well
};

Count count_of(const Method& method, const Scene& scene) {
    if (method.name == "point_xpbd") return Count::sweeps;
    if (method.name.starts_with("xpbd_rigid") && scene.pivot) return Count::calls_after_pose;
    return Count::calls;
}

/// Methods that evaluate a record of the equations made at the start of the run instead of the user-defined system.
bool records_equations(const Method& method) { return method.name == "taylor" || method.name == "extrapolation"; }

/// Settings with 1, 10 and 1000 samples, kept or not.
std::vector<Settings> all_settings(const Method& method, double duration) {
    std::vector<Settings> all;
    for (const long samples : {1L, 10L, 1000L})
        for (const bool record : {true, false})
            for (const bool by_step : {true, false}) {
                if (by_step ? !takes_step(method) : !takes_tolerance(method)) continue;
                Settings settings;
                (by_step ? settings.step : settings.tolerance) = by_step ? duration / 200 : 1e-6;
                settings.samples = samples, settings.record = record;
                all.push_back(settings);
            }
    return all;
}

std::string description_of(const Settings& settings) {
    return fmt::format("{} samples, {}, {}", settings.samples, settings.record ? "kept" : "not kept",
                       settings.step ? "by step" : "by tolerance");
}

/// Bodies under a torque that counts its calls: without and with events, with a pivot, and with integrated translation.
std::vector<Scene> counting_scenes(long& calls) {
    const UserTorque counting{"counting",
                              [&calls](const LoadState& now) {
                                  ++calls;
                                  return -0.1 * now.angular_velocity_B;
                              },
                              {}};
    Scene free = testing::free_body(2), struck = free, top = testing::heavy_top(1), flying = testing::everything(1);
    free.loads = {counting};
    struck.loads = {counting, Torque{{0.1, 0, 0}, Frame::world, {0.37, 1.25}},
                    Impulse{{0, 0.1, 0}, Frame::body, {1, 0, 0}, Frame::body, 0.777}};
    top.loads.push_back(counting), flying.loads.push_back(counting);
    return {free, struck, top, flying};
}

class Counts : public ::testing::TestWithParam<const Method*> {};

// The counts also hold for runs that end early, because angles meet gimbal lock or springs break. A run by fixed steps
// that diverges reports the evaluations up to the step that diverged, although it continued beyond this step.
TEST_P(Counts, AreTheCallsOfAUserTorque) {
    const Method& method = *GetParam();
    long calls = 0;
    for (const Scene& scene : counting_scenes(calls)) {
        const Problem problem = pose(scene, method.formulation.value_or(Formulation::reduced));
        if (!refusal(method, problem).empty()) continue;
        std::optional<long> of_posing;
        for (const Settings& settings : all_settings(method, scene.duration)) {
            calls = 0;
            const Trajectory run = solve(problem, method, settings);
            const long called = calls;
            if (run.status == Status::unsupported) continue;
            const std::string where = fmt::format("{}, {}: {}", scene.name, description_of(settings), run.message);
            EXPECT_LE(run.sample_evaluations, run.rhs_evaluations) << where;
            EXPECT_EQ(solve(problem, method, settings).rhs_evaluations, run.rhs_evaluations) << where;
            if (run.status == Status::diverged) {
                EXPECT_LE(run.rhs_evaluations, called) << where;
                continue;
            }
            switch (count_of(method, scene)) {
                case Count::calls:
                    EXPECT_EQ(run.rhs_evaluations, called) << where;
                    break;
                case Count::sweeps:
                    EXPECT_EQ(run.rhs_evaluations, 10 * called) << where;
                    break;
                case Count::calls_after_pose:
                    if (!of_posing) of_posing = called - run.rhs_evaluations;
                    EXPECT_EQ(run.rhs_evaluations, called - *of_posing) << where;
                    break;
            }
        }
    }
}

/// A pendulum in its angle that counts its right-hand sides in doubles.
struct CountedPendulum {
    std::shared_ptr<long> calls;

    int dimension() const { return 2; }
    void initial(double* y) const { y[0] = 2, y[1] = 0; }
    template <class S>
    void derivative(const S* y, S* dy) const {
        if constexpr (std::is_same_v<S, double>) ++*calls;
        S s(0), c(0);
        sine_cosine(y[0], s, c);
        dy[0] = y[1], dy[1] = -9.0 * s;
    }
    std::vector<double> scales() const { return {1, 3}; }
    std::vector<double> events() const { return {0.3}; }
    void enter(double t, double* y) const {
        if (t == 0.3) y[1] += 0.5;
    }
    std::vector<Sample> motion(const double* y) const {
        Sample bob;
        bob.position_W = {y[0], 0, 0}, bob.velocity_W = {y[1], 0, 0};
        return {bob};
    }
};

TEST_P(Counts, AreTheCallsOfAUserDefinedSystem) {
    const Method& method = *GetParam();
    if (!method.general_systems) return;
    const auto calls = std::make_shared<long>(0);
    const Problem problem = pose(CountedPendulum{calls}, 1.0);
    if (!refusal(method, problem).empty()) return;
    for (const Settings& settings : all_settings(method, 1)) {
        *calls = 0;
        const Trajectory run = solve(problem, method, settings);
        const long called = *calls;
        ASSERT_EQ(run.status, Status::ok) << run.message;
        if (records_equations(method)) {
            // at most two evaluations for the first step of extrapolation, at the start and after the event
            EXPECT_LE(called, 4) << description_of(settings);
            EXPECT_GT(run.rhs_evaluations, 0);
        } else {
            EXPECT_EQ(run.rhs_evaluations, called) << description_of(settings);
        }
    }
}

std::string name_of_counting_method(const ::testing::TestParamInfo<const Method*>& info) {
    return std::string(info.param->name);
}

INSTANTIATE_TEST_SUITE_P(Methods, Counts, ::testing::ValuesIn(methods().begin(), methods().end()),
                         name_of_counting_method);

}  // namespace
}  // namespace polhode
