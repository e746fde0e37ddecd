// Faults of impacts on planes: wrong restitution, missed impacts, penetration.
#include "check/impact_faults.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "check/plane_battery.h"
#include "integrators/method.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// Solves a scene by a method and writes its rows.
TrajectoryFile of_engine(Scene scene, const char* method, double hertz) {
    Settings settings;
    scene.duration = std::min(scene.duration, 3.0);
    settings.samples = static_cast<long>(hertz * scene.duration);
    if (takes_step(*find_method(method)))
        settings.step = 1 / hertz;
    else
        settings.tolerance = 1e-9;
    const Trajectory run = solve(scene, *find_method(method), settings);
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    for (const Sample& s : run.samples)
        file.rows.push_back({s.t, s.q, rotate(s.q, s.angular_velocity_B), s.position_W, s.velocity_W});
    return file;
}

TEST(ImpactFaults, RestitutionIsTold) {
    int found_count = 0;
    for (const char* name : {"bouncing_ball", "tumbling_box_bounce", "capsule_bounce", "damped_box_bounce"})
        for (const auto& [method, hertz] :
             {std::pair{"impact_stepping", 240.0}, {"impact_stepping", 1000.0}, {"cvode_impacts", 240.0}}) {
            const Scene scene = find_scene(name);
            EXPECT_TRUE(impact_faults(scene, of_engine(scene, method, hertz)).empty()) << name << method << hertz;
            Scene given = scene;
            double wanted = 0;
            for (Plane& plane : given.planes) plane.restitution = wanted = plane.restitution > 0.5 ? 0.3 : 0.9;
            for (const Diagnosis& d : impact_faults(scene, of_engine(given, method, hertz))) {
                // this method never corrects the depth of a contact
                if (method == std::string("impact_stepping") && d.fault == "penetration_kept") continue;
                EXPECT_EQ(d.fault, "restitution_wrong") << name << method << hertz;
                ++found_count;
            }
        }
    EXPECT_GE(found_count, 9);
}

TEST(ImpactFaults, APlaneThatIsNotSeenIsTold) {
    for (const char* name : {"bouncing_ball", "tumbling_box_bounce", "capsule_bounce"}) {
        const Scene scene = find_scene(name);
        Scene given = scene;
        given.planes.clear();
        const std::vector<Diagnosis> found = impact_faults(scene, of_engine(given, "gyroscopic_explicit", 240));
        ASSERT_FALSE(found.empty()) << name;
        EXPECT_EQ(found[0].fault, "impact_missed") << name;
    }
}

// A ball comes to rest inside the plane. A slop, and a penetration below the travel of a row, are accepted.
TEST(ImpactFaults, ADepthThatIsKeptIsTold) {
    int found_count = 0;
    for (const plane_battery::Case& c : plane_battery::cases()) {
        if (!(c.radius > 0) || c.scene.planes[0].restitution > 0.6) continue;
        for (const double hertz : {60.0, 240.0, 1000.0})
            for (const double depth : {0.0, 0.01 * c.radius, 0.1 * c.radius}) {
                plane_battery::Knobs knobs;
                knobs.sunk = depth;
                const std::vector<Diagnosis> found = impact_faults(c.scene, plane_battery::run(c, knobs, hertz));
                if (depth < 0.02 * c.radius) {
                    EXPECT_TRUE(found.empty()) << c.scene.name << hertz << found[0].message;
                    continue;
                }
                ASSERT_EQ(found.size(), 1u) << c.scene.name << hertz;
                EXPECT_EQ(found[0].fault, "penetration_kept");
                EXPECT_NE(found[0].message.find("0.03 m inside plane 0 from t = "), std::string::npos)
                    << found[0].message;
                ++found_count;
            }
    }
    EXPECT_GE(found_count, 3);
}

// Bounces from many heights with many restitutions, down to rest, with several impacts within a row.
TEST(ImpactFaults, SoundBouncesAreNotAccused) {
    int bounces = 0;
    for (plane_battery::Case c : plane_battery::cases())
        for (int i = 0; i < 12; ++i) {
            c.scene.duration = 2.5;
            c.scene.planes[0].restitution = 0.05 + 0.08 * i;
            c.scene.initial.position_W[2] = 1.1 + 0.17 * i;
            if (!(c.radius > 0)) c.scene.initial.angular_velocity = {4.0 - i, 0.7 * i - 3, 1.5};
            for (const double hertz : {60.0, 240.0}) {
                const std::vector<Diagnosis> found = impact_faults(c.scene, plane_battery::run(c, {}, hertz));
                EXPECT_TRUE(found.empty()) << c.scene.name << " " << i << " " << hertz << found[0].message;
                ++bounces;
            }
        }
    EXPECT_GE(bounces, 100);
}

}  // namespace
}  // namespace polhode
