// The method `exact` against the truth by Taylor series, which is independent of the closed forms.
#include "integrators/own/exact.h"

#include <gtest/gtest.h>

#include <chrono>

#include "integrators/analysis/conditioning.h"
#include "integrators/scenes.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

Trajectory solved(const Scene& scene, long samples = 10) {
    Settings settings;
    settings.samples = samples;
    return solve(scene, *find_method("exact"), settings);
}

// the largest attitude error divided by kappa 2^-53, with the largest kappa of the run
double in_units_of_rounding(const Scene& scene, double* kappa = nullptr, long samples = 10) {
    const FreshCache cache;
    const Trajectory trajectory = solved(scene, samples);
    EXPECT_EQ(trajectory.status, Status::ok) << scene.name << ": " << trajectory.message;
    const Reference truth = reference(scene, samples);
    EXPECT_TRUE(truth.available) << scene.name << ": " << truth.message;
    const Errors found = errors(error_series(scene, trajectory, truth), trajectory, truth);
    std::vector<double> times;
    for (const ReferenceSample& sample : truth.samples) times.push_back(sample.t);
    const Conditioning condition = conditioning(scene, times);
    EXPECT_TRUE(condition.available) << condition.message;
    const double peak = std::max(1.0, condition.state_peak().value);
    if (kappa != nullptr) *kappa = peak;
    return found["attitude"].max.value() / (peak * float64_roundoff);
}

Scene free_scene(const Vector3<double>& moments, const Vector3<double>& w, double duration) {
    Scene scene = testing::free_body(duration);
    scene.body.inertia_B = diagonal(moments);
    scene.initial.angular_velocity = w;
    return scene;
}

TEST(Exact, IsAsGoodAsItsDataNextToTheSeparatrix) {
    // I = (3, 4, 6), w = (2, 0, 1) is on the separatrix
    double largest = 0;
    for (const double off : {0.0, 1e-3, -1e-3, 1e-5, -1e-6, 3e-7, -1e-8, 1e-10, 1e-13})
        for (const double duration : {5.0, 26.5}) {
            double kappa = 0;
            EXPECT_LT(in_units_of_rounding(free_scene({3, 4, 6}, {2, 0, 1 + off}, duration), &kappa), 10)
                << off << ' ' << duration;
            EXPECT_LT(in_units_of_rounding(free_scene({6, 3, 4}, {-1 - off, 2, 0}, duration)), 10);
            largest = std::max(largest, kappa);
        }
    EXPECT_GT(largest, 1e8) << "nothing was next to the separatrix";
}

// The two large moments differ by no more than the small moment about the line from the pivot to the centre of mass.
TEST(Exact, KnowsABodyThatIsNearlyAPointBesideItsPivot) {
    const FreshCache cache;
    for (const Vector3<double>& arm : {Vector3<double>(0.3, 0.4, 0.5), Vector3<double>(0, 0, 0.5)}) {
        const auto made = [&](double size) {
            Scene scene = free_scene({1 * size, 1.2 * size, 1.5 * size}, {1, 2, 0.5}, 2);
            scene.body.mass = 1, scene.body.center_of_mass = arm, scene.pivot = Vector3<double>();
            return scene;
        };
        for (const double size : {1e-15}) {
            const Trajectory trajectory = solved(made(size));
            ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
            const Reference truth = reference(made(size), 10);
            const Errors found = errors(error_series(made(size), trajectory, truth), trajectory, truth);
            EXPECT_LT(found["attitude"].max.value(), 1e-14) << size;
        }
        EXPECT_EQ(solved(made(1e-25)).status, Status::unsupported);
    }
}

TEST(Exact, IsAsGoodAsItsDataOnCatalogueScenes) {
    for (const char* name : {"free_asymmetric", "separatrix", "near_separatrix", "symmetric", "lagrange_top",
                             "t_handle", "nasa_brick", "feynman_plate", "sphere", "spin_up"}) {
        const Scene scene = find_scene(name);
        if (!has_closed_form(pose(scene))) continue;
        EXPECT_LT(in_units_of_rounding(scene), 20) << name;
    }
    EXPECT_TRUE(has_closed_form(pose(find_scene("lagrange_top"))));
}

TEST(Exact, JoinsPiecesAtImpulsesAndWindows) {
    Scene scene = free_scene({1, 2, 2.5}, {0.4, -0.3, 1.1}, 9);
    scene.body.center_of_mass = {0.1, 0, -0.2};
    scene.initial.position_W = {1, 2, 3}, scene.initial.velocity_W = {0, 0.5, 2};
    scene.loads = {Gravity{{0, 0, -9.81}, {2, 6}},
                   Impulse{{0.3, -0.2, 0.5}, Frame::world, {0.4, 0.1, 0.2}, Frame::body, 3},
                   Impulse{{0.3, 0.1, 0}, Frame::world, {0.1, 0, 0.3}, Frame::body, 7.5}};
    EXPECT_LT(in_units_of_rounding(scene, nullptr, 18), 10);

    Scene top = testing::heavy_top(6);
    top.loads = {Gravity{{0, 0, -9.80665}, {1, 4}}, Impulse{{0, 0.4, 0}, Frame::world, {0, 0, 0.5}, Frame::body, 2}};
    EXPECT_LT(in_units_of_rounding(top, nullptr, 12), 20);

    Scene spin = testing::free_body(8);
    spin.initial.angular_velocity = {0, 3, 0};
    spin.loads = {Torque{{0, -0.7, 0}, Frame::body, {1, 5}}, Drag{{0, 0.9, 0}, 0, {3, 8}}};
    EXPECT_LT(in_units_of_rounding(spin, nullptr, 16), 10);

    Scene sphere = free_scene({2, 2, 2}, {1, -2, 0.5}, 8);
    sphere.loads = {Drag{{0.6, 0.6, 0.6}, 0.3, {}}};
    EXPECT_LT(in_units_of_rounding(sphere), 10);
}

// A tensor that is not diagonal and a centre of mass on a tilted axis: the symmetry holds only up to rounding.
TEST(Exact, FindsTheSymmetryOfATiltedTop) {
    Scene scene = testing::heavy_top(5);
    const Quaternion<double> tilt = normalized(Quaternion<double>{0.8, 0.3, -0.4, 0.2});
    const Matrix3<double> axes = rotation_matrix(tilt);
    scene.body.inertia_B = axes * diagonal(Vector3<double>(0.75, 0.75, 0.5)) * transposed(axes);
    scene.body.center_of_mass = rotate(tilt, Vector3<double>(0, 0, 0.5));
    scene.initial.orientation = normalized(scene.initial.orientation * conjugate(tilt));
    scene.initial.angular_velocity = rotate(tilt, Vector3<double>(0, 0, 20));
    ASSERT_TRUE(has_closed_form(pose(scene)));
    EXPECT_LT(in_units_of_rounding(scene), 60);
}

// An impulse that makes the rate infinite ends every method's run with a failure at once.
TEST(Exact, AnInfiniteRateIsANamedFailure) {
    Scene scene;
    scene.name = "struck beyond all bounds", scene.duration = 1;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    scene.pivot = Vector3<double>(0, 0, 0);
    for (const double at : {0.0, 0.5}) {
        scene.loads = {Impulse{{0, 0, 1e308}, Frame::world, {1e10, 0, 0}, Frame::body, at}};
        for (const Method* method : methods()) {
            // the rate is finite in multiprecision: the truth would step until its time limit
            if (method == find_method("truth")) continue;
            Settings settings;
            settings.samples = 4, settings.max_steps = 10'000;
            const Trajectory run = solve(scene, *method, settings);
            EXPECT_NE(run.status, Status::ok) << method->name;
            EXPECT_TRUE(run.status == Status::unsupported || !run.message.empty()) << method->name;
        }
        const Trajectory exact = solved(scene, 4);
        EXPECT_EQ(exact.status, Status::diverged);
        EXPECT_EQ(exact.message.find("not finite at t = "), 0U) << exact.message;
    }
}

TEST(Exact, RefusesWhatItDoesNotSolve) {
    const auto status = [](const Scene& scene, Formulation formulation = Formulation::reduced) {
        Settings settings;
        settings.formulation = formulation;
        const Trajectory trajectory = solve(scene, *find_method("exact"), settings);
        EXPECT_FALSE(trajectory.status != Status::ok && trajectory.message.empty());
        return trajectory.status;
    };
    EXPECT_EQ(status(testing::everything(5)), Status::unsupported);
    EXPECT_EQ(status(testing::free_body(5), Formulation::full), Status::unsupported);
    Scene kovalevskaya = find_scene("kovalevskaya");
    EXPECT_EQ(status(kovalevskaya), Status::unsupported);
    Scene damped = testing::free_body(5);
    damped.loads = {Drag{{0.1, 0.1, 0.1}, 0, {}}};
    EXPECT_EQ(status(damped), Status::unsupported);
    // a torque that starts at t = 2 s
    Scene late = testing::free_body(5);
    late.loads = {Torque{{0.1, 0.2, 0}, Frame::body, {2, 5}}};
    EXPECT_EQ(status(late), Status::unsupported);
}

TEST(Exact, LeavesAtAnyTimeTheDigitsThatTheoryLeaves) {
    // integration to 10^6 s is too slow for a test; the closed form in 100 digits has an error of 10^-90
    const double T = 1e6;
    Scene scene = testing::free_body(T);
    const Trajectory far = solved(scene, 1);
    ASSERT_EQ(far.status, Status::ok);
    Reference truth = reference(scene, std::vector<double>{0, T});
    ASSERT_TRUE(truth.available) << truth.message;
    // a phase of w T rad, with a relative accuracy of 2^-53
    EXPECT_LT(attitude_error(far.samples.back().q, truth.samples.back().q), 10 * 3 * T * float64_roundoff);
}

TEST(Exact, CostsTheSameForAnyTime) {
    const auto seconds = [](double duration) {
        const Problem problem = pose(testing::free_body(duration));
        Settings settings;
        settings.samples = 1, settings.record = false, settings.repetitions = 2000;
        double least = 1;
        for (int i = 0; i < 5; ++i) least = std::min(least, solve(problem, *find_method("exact"), settings).seconds);
        return least;
    };
    EXPECT_LT(seconds(1e9), 3 * seconds(1));
}

TEST(Exact, SolvesScenesInAnyUnits) {
    // scaling the moments or the time by 2^k leaves the attitude at corresponding times unchanged: bit for bit, or up
    // to rounding where 128-bit arithmetic is used
    const Trajectory unit = solved(testing::free_body(10));
    for (const int moment : {-400, -30, 0, 30, 400})
        for (const int rate : {-400, -20, 0, 20, 400}) {
            if (std::abs(moment + 2 * rate) > 900) continue;  // the energy would exceed the range of binary64
            const double w = std::ldexp(1.0, rate), I = std::ldexp(1.0, moment);
            Scene scene = free_scene({I, 2 * I, 3 * I}, {w, w, w}, 10 / w);
            scene.body.mass = I;
            const Trajectory scaled = solved(scene);
            ASSERT_EQ(scaled.status, Status::ok) << moment << ' ' << rate << ": " << scaled.message;
            for (std::size_t k = 0; k < scaled.samples.size(); ++k)
                EXPECT_LT(testing::attitude_error(scaled.samples[k].q, unit.samples[k].q), 2e-14)
                    << moment << ' ' << rate;
        }
    // near rotation about the middle axis, down to perturbations whose squares underflow
    for (const double off : {1e-30, 1e-150, 1e-300}) {
        const Trajectory near = solved(free_scene({1, 2, 3}, {off, 5, off}, 20));
        ASSERT_EQ(near.status, Status::ok) << off;
        // the outer components grow from below 1e-100 at the rate w2 sqrt((I2-I1)(I3-I2)/(I1 I3)): no flip yet
        if (off < 1e-100) {
            EXPECT_LT(std::abs(near.samples.back().angular_velocity_B[1] - 5), 1e-12);
        }
    }
}

TEST(Exact, IsWhatAutoStandsFor) {
    EXPECT_EQ(choose_method(pose(testing::free_body(5))).method->name, "exact");
    EXPECT_EQ(choose_method(pose(testing::heavy_top(5))).method->name, "exact");
    EXPECT_NE(choose_method(pose(testing::everything(5))).method->name, "exact");
    EXPECT_NE(choose_method(pose(testing::free_body(5), Formulation::full)).method->name, "exact");
}

}  // namespace
}  // namespace polhode
