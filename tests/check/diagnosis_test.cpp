// Order of diagnoses, indistinguishable faults, matched updates, impacts, and errors without all columns.
#include "check/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "check/battery.h"
#include "check/check_files.h"
#include "check/file_errors.h"
#include "check/impact_faults.h"
#include "check/known_update.h"
#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using battery::EngineKind;
using battery::Knobs;
using battery::V3;

Scene plain_scene() {
    Scene scene;
    scene.name = "s", scene.duration = 2;
    scene.body.mass = 2, scene.body.inertia_B = diagonal(V3(0.4, 0.7, 1.0));
    scene.initial.angular_velocity = {0.9, 1.3, 0.4};
    scene.initial.orientation = {0.8, 0.48, 0, 0.36};
    return scene;
}

std::vector<std::string> words(const std::vector<Diagnosis>& faults) {
    std::vector<std::string> all;
    for (const Diagnosis& d : faults) all.push_back(d.fault);
    return all;
}

TrajectoryFile of_method(const Scene& scene, const char* method, double step, int rows, int every = 1) {
    Scene timed = scene;
    Settings settings;
    settings.samples = rows, settings.step = step;
    timed.duration = rows * every * step;
    const Trajectory run = solve(timed, *find_method(method), settings);
    EXPECT_EQ(run.status, Status::ok) << run.message;
    TrajectoryFile file;
    file.has_angular_velocity = true;
    for (const Sample& s : run.samples)
        file.rows.push_back({s.t, s.q, rotate(s.q, s.angular_velocity_B), s.position_W, s.velocity_W});
    return file;
}

// A quarter of the force has the effect of four times the mass. Both are reported, the load first.
TEST(Diagnosis, ReportsALoadFaultBeforeAMassFault) {
    for (const double factor : {0.25, 0.04, 3.7}) {
        Scene scene = plain_scene(), given;
        scene.loads.push_back(Force{{1, 0.5, 9}, Frame::body, {0.2, -0.1, 0.1}, Frame::body, {}});
        scene.loads.push_back(Gravity{{0, 0, -9.81}, {}});
        given = scene;
        std::get<Force>(given.loads[0]).vector = factor * std::get<Force>(scene.loads[0]).vector;
        const auto found =
            diagnose(scene, battery::run<double>(given, {}, EngineKind::world_rate, 1.0 / 90, 1, 180)).faults;
        const std::vector<std::string> found_words = words(found);
        ASSERT_FALSE(found_words.empty()) << factor;
        EXPECT_EQ(found_words[0], "force_scaled") << factor;
        EXPECT_TRUE(factor == 0.04 || std::ranges::find(found_words, "density_scaled") != found_words.end()) << factor;
        EXPECT_EQ(found[0].message.find("one of 4 substeps") != std::string::npos, factor == 0.25);
    }
}

// One force acts on a body at rest, so the rotation is no evidence.
TEST(Diagnosis, AForceOnABodyAtRestIsFittedToTheLastDigit) {
    for (const double factor : {0.25, 0.6, 1.75, 12.5}) {
        Scene scene = plain_scene(), given;
        scene.initial.angular_velocity = {}, scene.initial.orientation = {};
        scene.loads.push_back(Force{{0, 0, 7}, Frame::world, {}, Frame::body, {}});
        given = scene;
        std::get<Force>(given.loads[0]).vector[2] *= factor;
        const auto found =
            diagnose(scene, battery::run<double>(given, {}, EngineKind::world_rate, 1.0 / 50, 1, 100)).faults;
        ASSERT_FALSE(found.empty()) << factor;
        EXPECT_EQ(found[0].fault, "force_scaled") << factor;
        EXPECT_LT(found[0].explained, 2e-9) << factor;
    }
}

// A tensor that is not rotated equals that with exchanged moments at a rotation by 90 degrees only.
TEST(Diagnosis, DoesNotReportARefutedPermutation) {
    Scene scene = plain_scene();
    scene.initial.orientation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
    scene.initial.angular_velocity = {0.3, 0.2, 0.5};
    scene.loads.push_back(Torque{{0.2, 0, 0.1}, Frame::world, {}});
    for (const auto& [tensor, word] : {std::pair{Knobs::Tensor::not_turned, "inertia_not_rotated"},
                                       {Knobs::Tensor::turned_back, "inertia_rotated_backwards"},
                                       {Knobs::Tensor::diagonal, "inertia_diagonal_in_world_axes"}})
        for (const double hertz : {90.0, 250.0}) {
            Knobs knobs;
            knobs.tensor = tensor;
            const std::vector<std::string> found_words =
                words(diagnose(scene, battery::run<double>(scene, knobs, EngineKind::world_rate, 1 / hertz, 1,
                                                           static_cast<int>(2 * hertz)))
                          .faults);
            EXPECT_EQ(found_words, std::vector<std::string>{word}) << hertz;
        }
}

// With one step per row, the row's first rate is the rate of the step: explicit Euler, not a fault.
TEST(Diagnosis, AFirstRateIsAFaultOfSubstepsOnly) {
    Scene scene = plain_scene();
    scene.loads.push_back(Torque{{0.5, -0.3, 0.4}, Frame::world, {}});
    for (const EngineKind kind : {EngineKind::world_rate, EngineKind::midpoint})
        for (const int substeps : {1, 2, 5, 10}) {
            Knobs knobs;
            knobs.first_rate = true;
            const auto found =
                diagnose(scene, battery::run<double>(scene, knobs, kind, 1.0 / 60 / substeps, substeps, 120)).faults;
            EXPECT_EQ(words(found), substeps == 1 ? std::vector<std::string>()
                                                  : std::vector<std::string>{"attitude_turned_by_first_rate"})
                << substeps << static_cast<int>(kind);
        }
}

Scene off_centre_scene() {
    Scene scene = plain_scene();
    scene.body.center_of_mass = {0.2, -0.1, 0.15};
    scene.initial.velocity_W = {1, -2, 3};
    scene.loads.push_back(Gravity{{0, 0, -9.81}, {}});
    return scene;
}

TEST(Diagnosis, ReportsMissingTermsOfTheOriginsAcceleration) {
    const Scene scene = off_centre_scene();
    for (const EngineKind kind : {EngineKind::world_rate, EngineKind::momentum, EngineKind::midpoint})
        for (const double hertz : {60.0, 240.0})
            for (const bool centripetal : {true, false})
                for (const bool euler : {true, false}) {
                    Knobs knobs;
                    knobs.integrates_origin = true, knobs.has_centripetal = centripetal, knobs.has_euler = euler;
                    std::vector<std::string> wanted;
                    if (!centripetal) wanted.push_back("origin_without_centripetal_term");
                    if (!euler) wanted.push_back("origin_without_euler_term");
                    std::vector<std::string> found_words =
                        words(diagnose(scene, battery::run<double>(scene, knobs, kind, 1 / hertz, 1, 120)).faults);
                    std::ranges::sort(found_words);
                    EXPECT_EQ(found_words, wanted) << hertz << static_cast<int>(kind);
                }
}

TEST(Diagnosis, ReportsVelocitiesOfTheOrigin) {
    const Scene scene = off_centre_scene();
    const V3 center = scene.body.center_of_mass;
    for (const bool has_rate : {true, false})
        for (const bool named_origin : {true, false})
            for (const bool position : {true, false}) {
                TrajectoryFile file = battery::run<double>(scene, {}, EngineKind::world_rate, 1.0 / 120, 1, 200);
                for (TrajectoryRow& row : file.rows) {
                    row.velocity_W = row.velocity_W - cross(row.angular_velocity_W, rotate(row.q, center));
                    if (position) row.position_W = row.position_W - rotate(row.q, center);
                    if (!has_rate) row.angular_velocity_W = {};
                }
                file.has_angular_velocity = has_rate;
                if (named_origin) file.has_position = false, file.has_origin = true;
                // not a known fault: ox,oy,oz hold the centre of mass, and vx,vy,vz the velocity of the origin
                if (named_origin && !position) continue;
                const std::vector<std::string> found_words = words(diagnose(scene, file).faults);
                EXPECT_EQ(found_words, std::vector<std::string>{position && !named_origin ? "origin_for_center_of_mass"
                                                                                          : "velocity_of_origin"})
                    << has_rate << named_origin << position;
            }
}

TEST(Diagnosis, DescribesEvents) {
    Scene struck = plain_scene(), given;
    struck.loads.push_back(Impulse{{1.5, -1, 2}, Frame::world, {0.3, 0.2, -0.1}, Frame::body, 0.75});
    given = struck;
    std::get<Impulse>(given.loads[0]).vector = {};
    const auto found =
        diagnose(struck, battery::run<double>(given, {}, EngineKind::world_rate, 1.0 / 120, 1, 240)).faults;
    ASSERT_FALSE(found.empty());
    EXPECT_NE(found[0].message.find("the step in which the impulse acts at t = 0.75 s"), std::string::npos)
        << found[0].message;
}

TEST(UpdateMatch, MatchesWhatAMethodWrote) {
    const Scene scene = plain_scene();
    for (const double hertz : {60.0, 137.0}) {
        const auto followed = identify_update(scene, of_method(scene, "gyroscopic_explicit", 1 / hertz, 120), 2, 1e-15);
        ASSERT_TRUE(followed);
        EXPECT_EQ(followed->method, "gyroscopic_explicit");
        EXPECT_TRUE(followed->matches && !followed->departure_time);
        EXPECT_NEAR(followed->step * hertz, 1, 1e-9);
        EXPECT_NE(followed->message.find("the file matches the gyroscopic_explicit update"), std::string::npos);
    }
    // several steps per row
    const auto coarse = identify_update(scene, of_method(scene, "gyroscopic_explicit", 1.0 / 70, 60, 7), 7, 1e-15);
    ASSERT_TRUE(coarse);
    EXPECT_TRUE(coarse->matches);
    EXPECT_NEAR(coarse->step, 1.0 / 70, 1e-9);
}

TEST(UpdateMatch, TellsTheRowAtWhichItIsLeft) {
    const Scene scene = plain_scene();
    TrajectoryFile file = of_method(scene, "gyroscopic_explicit", 1.0 / 100, 600);
    // from this row on, half the angular velocity
    Scene slower = scene;
    slower.initial.orientation = file.rows[400].q;
    slower.initial.angular_velocity = 0.5 * rotate_back(file.rows[400].q, file.rows[400].angular_velocity_W);
    const TrajectoryFile rest = of_method(slower, "gyroscopic_explicit", 1.0 / 100, 200);
    for (std::size_t k = 0; k <= 200; ++k) {
        const double t = file.rows[400 + k].t;
        file.rows[400 + k] = rest.rows[k], file.rows[400 + k].t = t;
    }
    const auto followed = identify_update(scene, file, 1, 1e-15);
    ASSERT_TRUE(followed && followed->matches && followed->departure_time);
    EXPECT_NEAR(*followed->departure_time, 4.01, 1e-9);
    EXPECT_NE(followed->message.find("departs from it at t = 4.01 s, where |w| drops"), std::string::npos)
        << followed->message;
}

TEST(UpdateMatch, ResemblesWhatItDoesNotMatch) {
    const Scene scene = plain_scene();
    TrajectoryFile file = of_method(scene, "gyroscopic_explicit", 1.0 / 30, 120);
    for (std::size_t k = 0; k < file.rows.size(); ++k) {
        TrajectoryRow& row = file.rows[k];
        const double off = 1e-4 * std::sin(static_cast<double>(k));
        row.q = normalized(Quaternion<double>{row.q.w, row.q.x + off, row.q.y, row.q.z - off});
    }
    const auto followed = identify_update(scene, file, 1, 1e-15);
    ASSERT_TRUE(followed);
    EXPECT_FALSE(followed->matches);
    EXPECT_NE(followed->message.find("the file resembles the "), std::string::npos);
    // a file with a correct attitude has no update
    Scene still = scene;
    still.initial.angular_velocity = {};
    EXPECT_FALSE(identify_update(still, of_method(still, "gyroscopic_explicit", 1.0 / 30, 60), 1, 1e-15));
}

TEST(UpdateMatch, IsNoneOfImpactsWhereThereIsNoPlane) {
    const Scene scene = plain_scene();
    for (const char* name : {"gyroscopic_none", "gyroscopic_explicit", "gyroscopic_implicit"}) {
        const auto followed = identify_update(scene, of_method(scene, name, 1.0 / 60, 60), 1, 1e-15);
        ASSERT_TRUE(followed) << name;
        EXPECT_FALSE(find_method(followed->method)->planes) << followed->method;
    }
}

// A ball on a plane in one dimension. `bounce` advances it by one step.
TrajectoryFile bouncing(const Scene& scene, double h, double speed, auto&& bounce) {
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    double z = scene.initial.position_W[2], v = speed;
    for (int k = 0; k * h <= scene.duration + 1e-9; ++k) {
        file.rows.push_back({k * h, {}, {}, {0, 0, z}, {0, 0, v}});
        bounce(z, v, h);
    }
    return file;
}

Scene ball(double restitution) {
    return parse_scene(
        R"({"name": "ball", "duration": 5, "body": {"shape": {"type": "sphere", "radius": 0.3}, "mass": 2},
        "initial": {"position": [0, 0, 1.7]}, "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "planes": [{"normal": [0, 0, 1], "restitution": )" +
            std::to_string(restitution) + "}]}",
        "ball.json", "");
}

TEST(ImpactFaults, BouncesThatGainEnergyAreTold) {
    constexpr double g = 9.81, radius = 0.3;
    for (const double restitution : {1.0, 0.8})
        for (const double h : {1.0 / 60, 1.0 / 200}) {
            const Scene scene = ball(restitution);
            const auto mirrored = bouncing(scene, h, 0, [&](double& z, double& v, double dt) {
                v -= g * dt;
                if (z + v * dt < radius && v < 0) v = -restitution * v;
                z += v * dt;
            });
            const std::vector<Diagnosis> found = impact_faults(scene, mirrored);
            ASSERT_EQ(found.size(), 1u) << restitution << " " << h;
            EXPECT_EQ(found[0].fault, "bounce_gains_energy");
        }
    // the exact motion gets no diagnosis
    const Scene scene = ball(1);
    const double top = std::sqrt(2 * (1.7 - radius) / g);
    TrajectoryFile exact;
    exact.has_angular_velocity = exact.has_position = exact.has_velocity = true;
    for (int k = 0; k <= 300; ++k) {
        const double t = k / 60.0, phase = std::remainder(t, 2 * top);
        exact.rows.push_back({t, {}, {}, {0, 0, 1.7 - g * phase * phase / 2}, {0, 0, -g * phase}});
    }
    EXPECT_TRUE(impact_faults(scene, exact).empty());
}

TEST(ImpactFaults, ARestitutionAppliedTwiceAndAThresholdAreTold) {
    constexpr double g = 9.81, radius = 0.3, e = 0.8, threshold = 2;
    const auto with = [&](double factor, double least) {
        const Scene scene = ball(e);
        return words(impact_faults(scene, bouncing(scene, 1.0 / 240, 0, [&](double& z, double& v, double dt) {
                                       const double to = z + v * dt - g * dt * dt / 2;
                                       if (to >= radius || v >= 0) {
                                           if (to < radius && v == 0) return;
                                           z = to, v -= g * dt;
                                           return;
                                       }
                                       // the time of contact within the step
                                       const double s = std::sqrt(v * v + 2 * g * (z - radius)), until = (v + s) / g;
                                       const double back = s < least ? 0 : factor * s, left = dt - until;
                                       z = radius + (back > 0 ? back * left - g * left * left / 2 : 0);
                                       v = back > 0 ? back - g * left : 0;
                                   })));
    };
    EXPECT_EQ(with(e, 0), std::vector<std::string>());
    EXPECT_EQ(with(e * e, 0), std::vector<std::string>{"restitution_applied_twice"});
    EXPECT_EQ(with(e, threshold), std::vector<std::string>{"bounce_dies_below_threshold"});
}

TEST(ImpactFaults, BouncesThatComeAStepLateAreTold) {
    constexpr double g = 9.81, radius = 0.3;
    const Scene scene = ball(0.8);
    bool inside = false;
    const auto file = bouncing(scene, 1.0 / 120, 0, [&](double& z, double& v, double dt) {
        v -= g * dt;
        if (inside && v < 0) v = -0.8 * (v + g * dt);
        z += v * dt;
        inside = z < radius;
    });
    EXPECT_EQ(words(impact_faults(scene, file)), std::vector<std::string>{"bounce_late"});
}

// The rotation does not depend on the position, so its energy is compared without v.
TEST(FileErrorAccumulator, ComparesTheEnergyOfRotationWithoutTheVelocity) {
    Scene scene = plain_scene();
    scene.loads.push_back(Gravity{{0, 0, -9.81}, {}});
    scene.initial.velocity_W = {30, 0, 0};
    TrajectoryFile file = of_method(scene, "gyroscopic_explicit", 1.0 / 60, 60);
    std::vector<double> times;
    for (const TrajectoryRow& row : file.rows) times.push_back(row.t);
    const FileErrors file_errors = compute_file_errors(scene, file, reference(scene, times));
    ASSERT_TRUE(file_errors["energy"]);
    // rotational energy computed from the file's w
    const auto energy = [&](const TrajectoryRow& row) {
        const V3 w = rotate_back(row.q, row.angular_velocity_W);
        return dot(w, scene.body.inertia_B * w) / 2;
    };
    double largest = 0;
    for (const TrajectoryRow& row : file.rows)
        largest = std::max(largest, std::abs(energy(row) / energy(file.rows[0]) - 1));
    EXPECT_NEAR(file_errors["energy"]->max, largest, 1e-12);
    EXPECT_GT(largest, 1e-6);
    // a force at a point fixed in the world makes the rotation depend on the position
    scene.loads.push_back(Force{{1, 0, 0}, Frame::world, {0, 0, 1}, Frame::world, {}});
    EXPECT_FALSE(compute_file_errors(scene, file, reference(scene, times))["energy"]);
}

// NaN counts as the largest error: in one piece and in several, for one body and for several.
TEST(FileErrorAccumulator, NotANumberIsTheLargestError) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(is_larger<double>(nan, 3) && is_larger<double>(2, 1) && !is_larger<double>(1, 1) &&
                !is_larger<double>(5, nan) && !is_larger<double>(nan, nan));
    const Scene scene = plain_scene();
    TrajectoryFile file = of_method(scene, "gyroscopic_explicit", 1.0 / 60, 60);
    file.rows[20].angular_velocity_W[1] = nan;
    std::vector<double> times;
    for (const TrajectoryRow& row : file.rows) times.push_back(row.t);
    const Reference truth = reference(scene, times);
    FileErrorAccumulator whole(scene, file, ErrorArithmetic::binary64), later(scene, file, ErrorArithmetic::binary64);
    const std::span<const ReferenceSample> samples = truth.samples;
    whole.add(0, samples.first(15));
    later.add(15, samples.subspan(15));
    whole.append(later);
    for (const FileErrors& file_errors : {compute_file_errors(scene, file, truth), whole.result()}) {
        EXPECT_TRUE(std::isnan(file_errors["omega"]->max));
        EXPECT_EQ(file_errors["omega"]->max_time, file.rows[20].t);
        EXPECT_TRUE(std::ranges::any_of(file_errors.over_time,
                                        [](const ErrorSpan& span) { return std::isnan(span.error["omega"]); }));
    }
    const Scene pair = find_scene("mechanisms/double_pendulum");
    Scene timed = pair;
    timed.duration = 0.2;
    Settings settings;
    settings.samples = 10;
    const Trajectory run = solve(timed, *find_method("taylor"), settings);
    const Reference right = reference(timed, 10);
    ASSERT_TRUE(right.available && run.status == Status::ok);
    TrajectoryFile several;
    several.has_angular_velocity = several.has_position = several.has_velocity = true;
    several.bodies = body_names(timed);
    for (const Sample& s : run.samples)
        several.rows.push_back({s.t, s.q, rotate(s.q, s.angular_velocity_B), s.position_W, s.velocity_W});
    several.rows[9].velocity_W[0] = nan;
    EXPECT_TRUE(std::isnan(compute_file_errors(timed, several, right)["velocity"]->max));
}

}  // namespace
}  // namespace polhode
