#include "integrators/engines/external_method.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "motion/trajectory_csv.h"
#include "places.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// a shell script in place of an engine
std::shared_ptr<const Method> engine(const std::string& script) {
    return external_method({.name = "engine"}, {.arguments = {"sh", "-c", script}});
}

Trajectory solved_by(const std::string& script, Settings settings = {}) {
    return solve(find_scene("free_asymmetric"), *engine(script), settings);
}

std::shared_ptr<const Method> polhode_itself(const std::string& method) {
    EngineCommand command;
    command.arguments = {program_path(), "solve", "/dev/stdin", "--method", method, "--samples", "{samples}"};
    command.by_step = {"--step", "{step}"}, command.by_tolerance = {"--tolerance", "{tolerance}"};
    return external_method({.name = "itself_" + method, .planes = true}, command);
}

double size(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }

void expect_same_samples(const Trajectory& a, const Trajectory& b) {
    ASSERT_EQ(a.status, Status::ok) << a.message;
    ASSERT_EQ(a.samples.size(), b.samples.size());
    // the file has w in world axes: two rotations
    for (std::size_t k = 0; k < a.samples.size(); ++k) {
        const Sample &x = a.samples[k], &y = b.samples[k];
        EXPECT_EQ(x.t, y.t);
        EXPECT_EQ(x.q, y.q);
        EXPECT_EQ(x.position_W, y.position_W);
        EXPECT_EQ(x.velocity_W, y.velocity_W);
        EXPECT_LE(size(x.angular_velocity_B - y.angular_velocity_B), 1e-15 * size(y.angular_velocity_B));
    }
}

// polhode in another process returns what it computes in this process.
TEST(ExternalMethod, IsAMethodLikeAnyOther) {
    for (const char* name : {"free_asymmetric", "every_load"}) {
        const Scene scene = find_scene(name);
        Settings settings;
        settings.samples = 20, settings.tolerance = 1e-9;
        expect_same_samples(solve(scene, *polhode_itself("dop853"), settings),
                            solve(scene, *find_method("dop853"), settings));
        settings.tolerance.reset(), settings.step = scene.duration / 1000;
        expect_same_samples(solve(scene, *polhode_itself("odeint_rk4"), settings),
                            solve(scene, *find_method("odeint_rk4"), settings));
    }
}

TEST(ExternalMethod, IsTimedByItsEndAlone) {
    Settings settings;
    settings.samples = 20, settings.tolerance = 1e-9, settings.record = false, settings.repetitions = 2;
    const Trajectory end = solve(find_scene("lagrange_top"), *polhode_itself("dop853"), settings);
    ASSERT_EQ(end.status, Status::ok) << end.message;
    ASSERT_EQ(end.samples.size(), 1u);
    EXPECT_EQ(end.samples.back().t, find_scene("lagrange_top").duration);
    EXPECT_GT(end.seconds, 0);
}

TEST(ExternalMethod, DeclaresItsSettings) {
    EXPECT_EQ(polhode_itself("dop853")->control, Control::fixed_step_or_tolerance);
    EXPECT_EQ(engine("true")->control, Control::none);
    Settings settings;
    settings.step = 0.1;
    EXPECT_EQ(solved_by("true", settings).message, "engine does not take a step");
}

TEST(ExternalMethod, OwnsItsTexts) {
    std::shared_ptr<const Method> method;
    {
        std::string name = "a name longer than a short string is";
        method = external_method({.name = name}, {.arguments = {"true"}});
        name.assign(name.size(), 'x');
    }
    EXPECT_EQ(method->name, "a name longer than a short string is");
}

TEST(ExternalMethod, PassesOnTheFailureOfItsCommand) {
    const Trajectory failed = solve(find_scene("every_load"), *polhode_itself("exact"));
    EXPECT_EQ(failed.status, Status::failed);
    EXPECT_EQ(failed.message.substr(failed.message.find("exited")),
              "exited with code 2: polhode: exact does not take a tolerance; remove --tolerance");
}

TEST(ExternalMethod, ReportsTheCause) {
    const std::string header = "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz";
    const std::string at_rest = ",1,0,0,0,0,0,0,0,0,0,0,0,0";
    struct {
        std::string script, message;
    } cases[] = {
        {"kill -SEGV $$", "sh was terminated by signal 11"},
        {"echo first >&2; echo 'no licence' >&2; exit 3", "sh exited with code 3: no licence"},
        {"true", "its output is not a trajectory: sh"},
        {"echo hello", "its output is not a trajectory: sh"},
        {"head -c 100000 /dev/zero", "its output is not a trajectory: sh"},
        {"echo " + header + "; echo nan" + at_rest, "its output is not a trajectory: sh"},
        {"echo " + header + "; echo 0" + at_rest, "its output has 1 samples instead of 3"},
        {"echo " + header + "; for t in 0 1 100; do echo $t" + at_rest + "; done",
         "its sample 1 is at t = 1 s instead of"},
        {"echo t,qw,qx,qy,qz; for t in 0 50 100; do echo $t,1,0,0,0; done", "its output has no columns wx, wy, wz"},
    };
    Settings settings;
    settings.samples = 2;
    for (const auto& [script, message] : cases) {
        const Trajectory run = solved_by(script, settings);
        EXPECT_EQ(run.status, Status::failed) << script;
        EXPECT_FALSE(run.limit_reached) << script;
        EXPECT_TRUE(run.samples.empty()) << script;
        EXPECT_EQ(run.message.substr(0, message.size()), message);
    }
    const auto missing = external_method({.name = "engine"}, {.arguments = {"no-such-engine"}});
    EXPECT_EQ(solve(find_scene("free_asymmetric"), *missing).message, "no-such-engine was not found on the PATH");
    const auto elsewhere = external_method({.name = "engine"}, {.arguments = {"/no/such/engine"}});
    EXPECT_EQ(solve(find_scene("free_asymmetric"), *elsewhere).message, "/no/such/engine was not found");
}

// the command has a child that would run for a minute and keeps its output open
TEST(ExternalMethod, StopsACommandThatHangs) {
    Settings settings;
    settings.seconds_limit = 0.3;
    const auto begin = std::chrono::steady_clock::now();
    const Trajectory run = solved_by("sleep 60 & sleep 60", settings);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
    EXPECT_EQ(run.status, Status::failed);
    EXPECT_TRUE(run.limit_reached);
    EXPECT_EQ(run.message, "sh was stopped after 0.3 s");
}

TEST(ExternalMethod, StopsACommandThatPrintsWithoutEnd) {
    const auto method =
        external_method({.name = "engine"}, {.arguments = {"sh", "-c", "yes"}, .most_bytes = std::size_t(1) << 20});
    const Trajectory run = solve(find_scene("free_asymmetric"), *method);
    EXPECT_EQ(run.status, Status::failed);
    EXPECT_EQ(run.message, "sh was stopped: it wrote more than 1048576 bytes");
}

TEST(ExternalMethod, RefusesWhatItCannotHandOver) {
    Scene scene = find_scene("free_asymmetric");
    scene.loads.push_back(UserTorque{"of mine", [](const LoadState&) { return Vector3<double>(); }, {}});
    const Trajectory refused = solve(scene, *engine("true"));
    EXPECT_EQ(refused.status, Status::unsupported);
    EXPECT_EQ(refused.message, "a user-defined torque cannot be passed to another process");
    EXPECT_EQ(refusal(*engine("true"), pose(find_scene("bouncing_ball"))), "engine does not support impacts on planes");
}

}  // namespace
}  // namespace polhode
