// Impacts on planes: what comes back of the normal speed, and what passes through.
#include "check/impact_faults.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/method.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

// the motion of an engine that was given this scene
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
    int told = 0;
    for (const char* name : {"bouncing_ball", "tumbling_box_bounce", "capsule_bounce", "damped_box_bounce"})
        for (const auto& [method, hertz] :
             {std::pair{"impact_stepping", 240.0}, {"impact_stepping", 1000.0}, {"cvode_impacts", 240.0}}) {
            const Scene scene = find_scene(name);
            EXPECT_TRUE(impact_faults(scene, of_engine(scene, method, hertz)).empty()) << name << method << hertz;
            Scene given = scene;
            double wanted = 0;
            for (Plane& plane : given.planes) plane.restitution = wanted = plane.restitution > 0.5 ? 0.3 : 0.9;
            for (const Diagnosis& d : impact_faults(scene, of_engine(given, method, hertz))) {
                EXPECT_EQ(d.fault, "restitution_wrong") << name << method << hertz;
                ++told;
            }
        }
    EXPECT_GE(told, 9);
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

}  // namespace
}  // namespace polhode
