// Trajectories with a known fault get the diagnosis of that fault. Sound trajectories, however coarse, get none.
#include "check/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "build_kind.h"
#include "catalogue.h"
#include "check/convention.h"
#include "integrators/method.h"
#include "scene/scene_file.h"
#include "whole/broken_engine.h"

namespace polhode {
namespace {

Scene free_body() { return find_scene("free_asymmetric"); }

Scene tilted_free_body() {
    Scene scene = free_body();
    scene.initial.orientation = {0.8, 0.48, 0, 0.36};
    scene.initial.angular_velocity = {0.3, 2, -0.2};
    return scene;
}

Scene heavy_top() {
    Scene scene = find_scene("lagrange_top");
    scene.initial.angular_velocity = {0, 0, 12};
    return scene;
}

Scene driven_body() {
    Scene scene = tilted_free_body();
    scene.name = "driven";
    scene.loads.push_back(Torque{{0.3, -0.2, 0.1}, Frame::body, {}});
    scene.loads.push_back(Torque{{0, 0.1, 0.2}, Frame::world, {}});
    return scene;
}

Scene damped_body() { return find_scene("damped_spin"); }

std::vector<Scene> scenes() {
    std::vector<Scene> all{free_body(), tilted_free_body(), heavy_top(), driven_body()};
    for (Scene& scene : all) scene.duration = 10;
    // one search takes 0.1 s, in builds without optimisation ten times as long
    if (!optimised_build) all.resize(1);
    return all;
}

std::string faults(const std::vector<Diagnosis>& diagnoses) {
    std::string text;
    for (const Diagnosis& d : diagnoses) text += d.fault + ": " + d.message + "\n";
    return text;
}

::testing::AssertionResult diagnosis_is(const Scene& scene, const TrajectoryFile& file, const std::string& fault) {
    const std::vector<Diagnosis> found = diagnose(scene, file).faults;
    if (std::ranges::any_of(found, [&](const Diagnosis& d) { return d.fault == fault; }))
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << scene.name << ": wanted " << fault << ", got\n" << faults(found);
}

// Checks the diagnosis at two steps, in both precisions and without the columns of w.
void expect_diagnosis(const Scene& scene, const Broken& broken, const std::string& fault, bool needs_rates = false) {
    for (const double step : {1.0 / 60, 1.0 / 240}) {
        if (!optimised_build && step > 0.01) continue;
        EXPECT_TRUE(diagnosis_is(scene, engine_run<double>(scene, broken, step, 1), fault)) << "step " << step;
        EXPECT_TRUE(diagnosis_is(scene, engine_run<float>(scene, broken, step, 2), fault)) << "float, step " << step;
        if (needs_rates) continue;
        TrajectoryFile bare = engine_run<double>(scene, broken, step, 1);
        bare.has_angular_velocity = false;
        for (TrajectoryRow& row : bare.rows) row.angular_velocity_W = {};
        EXPECT_TRUE(diagnosis_is(scene, bare, fault)) << "no w, step " << step;
    }
}

TEST(Diagnosis, GyroscopicTermMissing) {
    for (const Scene& scene : scenes()) expect_diagnosis(scene, {.gyroscopic = 0}, "gyroscopic_term_missing");
}

TEST(Diagnosis, GyroscopicTermReversed) {
    for (const Scene& scene : scenes()) expect_diagnosis(scene, {.gyroscopic = -1}, "gyroscopic_term_reversed");
}

TEST(Diagnosis, DampingLeftOn) {
    for (const Scene& scene : scenes())
        for (const double damping : {0.05, 0.3}) expect_diagnosis(scene, {.damping = damping}, "damping_left_on");
    Scene scene = damped_body();
    scene.duration = 10;
    expect_diagnosis(scene, {.damping = 0.1}, "damping_left_on");
}

TEST(Diagnosis, SpeedClamped) {
    for (const Scene& scene : scenes()) {
        const Vector3<double>& w = scene.initial.angular_velocity;
        expect_diagnosis(scene, {.speed_limit = 0.8 * std::sqrt(dot(w, w))}, "speed_clamped");
    }
}

TEST(Diagnosis, WrongTimeStep) {
    for (const Scene& scene : scenes())
        for (const double step_factor : {0.5, 1.2, 50.0 / 60})
            expect_diagnosis(scene, {.step_factor = step_factor}, "wrong_time_step");
}

// Faults that the attitude alone cannot distinguish. Clamping the rate of a nearly steady rotation looks like a slower
// clock; a start 57 times too slow looks like a clamped rate. The file's w decides, or the lack of fitted parameters.
TEST(Diagnosis, ReportsOnlyTheTrueOneOfSimilarFaults) {
    Scene scene = tilted_free_body();
    scene.loads.clear();
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1.5, 2));
    scene.initial.angular_velocity = {0.2, 0.1, 3};
    scene.duration = 5;
    const auto only = [&](const TrajectoryFile& file, const std::string& fault) {
        const std::vector<Diagnosis> found = diagnose(scene, file).faults;
        EXPECT_EQ(found.size(), 1U) << fault << ": " << faults(found);
        EXPECT_TRUE(diagnosis_is(scene, file, fault));
    };
    const Vector3<double>& w = scene.initial.angular_velocity;
    only(engine_run<double>(scene, {.speed_limit = 0.8 * std::sqrt(dot(w, w))}, 1.0 / 960, 16), "speed_clamped");
    only(engine_run<double>(scene, {.step_factor = 0.8}, 1.0 / 960, 16), "wrong_time_step");
    Scene slow = scene;
    slow.initial.angular_velocity = (std::numbers::pi / 180) * slow.initial.angular_velocity;
    only(engine_run<double>(slow, {}, 1.0 / 960, 16), "degrees_for_radians");
}

TEST(Diagnosis, FirstOrderQuaternionUpdate) {
    for (const Scene& scene : scenes()) {
        // below this step the fault changes a row by less than 1e-6 rad, the noise of binary32 files
        const Vector3<double>& w = scene.initial.angular_velocity;
        for (const double turn : {0.06, 0.03}) {
            const double step = turn / std::sqrt(dot(w, w));
            EXPECT_TRUE(diagnosis_is(scene, engine_run<double>(scene, {.first_order = true}, step, 1),
                                     "first_order_quaternion_update"));
            EXPECT_TRUE(diagnosis_is(scene, engine_run<double>(scene, {.first_order = true}, step, 4),
                                     "first_order_quaternion_update"));
        }
    }
}

// A sound trajectory, as from an engine at a fine step.
TrajectoryFile sound(const Scene& scene) { return engine_run<double>(scene, {}, 1.0 / 960, 16); }

TEST(Diagnosis, ConventionsOfTheQuaternion) {
    for (const Scene& scene : {tilted_free_body(), heavy_top(), driven_body()}) {
        if (!optimised_build && scene.pivot) continue;
        Scene timed = scene;
        timed.duration = 10;
        TrajectoryFile last = sound(timed), inverted = last;
        for (TrajectoryRow& row : last.rows) row.q = {row.q.x, row.q.y, row.q.z, row.q.w};
        EXPECT_TRUE(diagnosis_is(timed, last, "scalar_last_quaternion"));
        EXPECT_EQ(diagnose(timed, last).faults[0].convention, "scalar-last");
        for (TrajectoryRow& row : inverted.rows) row.q = conjugate(row.q);
        EXPECT_TRUE(diagnosis_is(timed, inverted, "inverted_orientation"));
        for (const char* words : {"y-up", "y-up,left-handed", "left-handed"}) {
            TrajectoryFile there = sound(timed);
            const Convention convention = parse_convention(words);
            for (TrajectoryRow& row : there.rows) {
                row.q = quaternion_to(convention.axes, row.q);
                row.angular_velocity_W = pseudovector_to(convention.axes, row.angular_velocity_W);
            }
            EXPECT_TRUE(diagnosis_is(timed, there, "other_axes")) << words;
            EXPECT_EQ(diagnose(timed, there).faults[0].convention, words);
        }
    }
}

TEST(Diagnosis, UnitsAndAxesOfTheRate) {
    for (Scene scene : {tilted_free_body(), heavy_top(), driven_body()}) {
        scene.duration = 10;
        TrajectoryFile degrees = sound(scene), body = degrees;
        for (TrajectoryRow& row : degrees.rows)
            row.angular_velocity_W = (180 / std::numbers::pi) * row.angular_velocity_W;
        EXPECT_TRUE(diagnosis_is(scene, degrees, "angular_velocity_in_degrees"));
        EXPECT_EQ(diagnose(scene, degrees).faults[0].convention, "degrees");
        for (TrajectoryRow& row : body.rows) row.angular_velocity_W = rotate_back(row.q, row.angular_velocity_W);
        EXPECT_TRUE(diagnosis_is(scene, body, "angular_velocity_in_body_axes"));
    }
}

TEST(Diagnosis, StartsOfAnotherScene) {
    for (Scene scene : {tilted_free_body(), driven_body()}) {
        scene.duration = 10;
        Scene other = scene;
        other.initial.angular_velocity_frame = Frame::world;
        EXPECT_TRUE(
            diagnosis_is(scene, engine_run<double>(other, {}, 1.0 / 240, 4), "body_for_world_angular_velocity"));
        other = scene;
        other.initial.orientation = {0.36, 0.8, 0.48, 0};
        EXPECT_FALSE(diagnose(scene, engine_run<double>(other, {}, 1.0 / 240, 4)).faults.empty());
    }
    // a free body that is only slower or faster could also have a wrong clock; a torque distinguishes the two
    Scene scene = driven_body();
    scene.duration = 20;
    Scene other = scene;
    other.initial.angular_velocity = (std::numbers::pi / 180) * scene.initial.angular_velocity;
    EXPECT_TRUE(diagnosis_is(scene, engine_run<double>(other, {}, 1.0 / 240, 4), "degrees_for_radians"));
}

TEST(Diagnosis, CenterOfMassTakenForTheOrigin) {
    Scene scene = heavy_top();
    scene.duration = 10;
    Scene other = scene;
    other.body.center_of_mass = {};
    EXPECT_TRUE(diagnosis_is(scene, engine_run<double>(other, {}, 1.0 / 240, 4), "center_of_mass_for_origin"));
    // an engine that was given the inertia about the pivot, and the pivot as centre of mass
    other.body.inertia_B = other.body.inertia_B + parallel_axis(scene.body.mass, scene.body.center_of_mass);
    EXPECT_TRUE(diagnosis_is(scene, engine_run<double>(other, {}, 1.0 / 240, 4), "center_of_mass_for_origin"));
    // with a short arm the faults that ignore the centre of mass are indistinguishable: one diagnosis only
    for (const double arm : {0.5, 0.1, 0.02}) {
        Scene near = heavy_top();
        near.duration = 5, near.body.center_of_mass = arm * near.body.center_of_mass;
        Scene broken = near;
        broken.body.center_of_mass = {};
        const std::vector<Diagnosis> found = diagnose(near, engine_run<double>(broken, {}, 1.0 / 240, 4)).faults;
        EXPECT_LE(std::count_if(found.begin(), found.end(),
                                [](const Diagnosis& d) { return d.fault == "center_of_mass_for_origin"; }),
                  1)
            << arm;
    }
    // a thrown body whose file contains the position of its origin
    scene = find_scene("thrown_hammer");
    ASSERT_FALSE(scene.body.center_of_mass == Vector3<double>());
    TrajectoryFile file;
    file.has_position = true;
    Settings fine;
    fine.tolerance = 1e-12;
    for (const Sample& s : solve(scene, *find_method("dop853"), fine).samples)
        file.rows.push_back({s.t, s.q, {}, s.position_W - rotate(s.q, scene.body.center_of_mass), {}});
    EXPECT_TRUE(diagnosis_is(scene, file, "origin_for_center_of_mass"));
    file.has_position = false, file.has_origin = true;
    EXPECT_TRUE(diagnose(scene, file).faults.empty());
    for (TrajectoryRow& row : file.rows) row.position_W = row.position_W + rotate(row.q, scene.body.center_of_mass);
    EXPECT_TRUE(diagnosis_is(scene, file, "center_of_mass_for_origin"));
}

TEST(Diagnosis, TwoFaultsAtOnce) {
    // the default of several engines: no gyroscopic term, and damping
    for (const Scene& scene : {free_body(), tilted_free_body()}) {
        Scene timed = scene;
        timed.duration = 10;
        EXPECT_TRUE(diagnosis_is(timed, engine_run<double>(timed, {.gyroscopic = 0, .damping = 0.1}, 1.0 / 60, 1),
                                 "damping_left_on"));
    }
}

// Sound methods, coarse and fine, on a sample of the plain scenes: their truncation errors must not get a diagnosis.
// Euler's method is not among them, because it is a first-order quaternion update.
class SoundMethod : public ::testing::TestWithParam<const char*> {};

TEST_P(SoundMethod, HasNoDiagnosis) {
    const Method& method = *find_method(GetParam());
    int judged = 0;
    constexpr std::size_t every = optimised_build ? 10 : 61;
    const std::vector<std::string> names = scenes_in();
    for (std::size_t i = std::string_view(GetParam()).size() % every; i < names.size(); i += every) {
        const std::string& name = names[i];
        const Scene scene = find_scene(name);
        Settings settings;
        settings.samples = 200, settings.max_steps = optimised_build ? 300'000 : 30'000;
        std::vector<Settings> all;
        if (takes_tolerance(method))
            for (const double tolerance : {1e-2, 1e-5}) settings.tolerance = tolerance, all.push_back(settings);
        else
            for (const double steps : {1e3, 1e4}) settings.step = scene.duration / steps, all.push_back(settings);
        for (const Settings& one : all) {
            const Trajectory run = solve(scene, method, one);
            if (run.status != Status::ok) continue;
            TrajectoryFile file;
            file.has_angular_velocity = file.has_position = file.has_velocity = true;
            for (const Sample& s : run.samples)
                file.rows.push_back({s.t, s.q, angular_velocity_W(s), s.position_W, s.velocity_W});
            const std::vector<Diagnosis> found = diagnose(scene, file).faults;
            EXPECT_TRUE(found.empty()) << name << ", " << (one.tolerance ? *one.tolerance : *one.step) << "\n"
                                       << faults(found);
            ++judged;
        }
    }
    EXPECT_GE(judged, static_cast<int>(30 / every));
}

INSTANTIATE_TEST_SUITE_P(Methods, SoundMethod,
                         ::testing::Values("cvode_bdf", "arkode_erk2", "arkode_dirk3", "arkode_erk4_relaxed",
                                           "odeint_rk4", "odeint_rosenbrock4", "odeint_rk4_projected", "article_mended",
                                           "article_body_frame"));

}  // namespace
}  // namespace polhode
