// Lasting contact of spheres in binary64: closed forms by both formulations, events, refusals.
#include "integrators/contact/follow_cluster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/contact/cluster_form.h"
#include "integrators/contact/follow_spheres.h"
#include "integrators/contact/reduced_form.h"
#include "integrators/truth/cluster_multiplier_form.h"
#include "integrators/truth/multiplier_form.h"
#include "scene/scene_file.h"

namespace polhode::contact {
namespace {

using ReducedClusters = SphereDriver<double, ReducedForm<double>, ClusterForm<double>, ClosedFormImpact>;
using MultiplierClusters =
    SphereDriver<double, truth::MultiplierForm<double>, truth::ClusterMultiplierForm<double>, PhasedImpact>;

constexpr double ball_radius = 0.125, ball_moment = 0.4 * ball_radius * ball_radius;

std::string sphere_text(const std::string& name, const std::string& initial, const std::string& mass = "1") {
    return R"({"name": ")" + name + R"(", "body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": )" + mass +
           R"(}, "initial": {)" + initial + "}}";
}
// two balls at rest on the floor that touch
std::string touching_pair() {
    return sphere_text("a", R"("position": [0, 0, 0.125])") + "," + sphere_text("b", R"("position": [0.25, 0, 0.125])");
}
std::string push_text(const std::string& body, const std::string& force) {
    return R"({"type": "force", "body": ")" + body + R"(", "frame": "world", "point": [0, 0, 0], "vector": )" + force +
           "}";
}
std::string gravity_text(const std::string& acceleration = "[0, 0, -10]") {
    return R"({"type": "gravity", "acceleration": )" + acceleration + "}";
}
std::string floor_text(double friction, double restitution = 0) {
    return R"("planes": [{"normal": [0, 0, 1], "offset": 0, "name": "floor", "restitution": )" +
           std::to_string(restitution) + R"(, "friction": )" + std::to_string(friction) + "}]";
}
std::string contacts_text(double friction, double restitution = 0) {
    return R"("contacts": [{"all": true, "restitution": )" + std::to_string(restitution) + R"(, "friction": )" +
           std::to_string(friction) + "}]";
}
Scene cluster_scene(const std::string& bodies, const std::string& loads, const std::string& more, double duration = 1) {
    return parse_scene(R"({"name": "cluster", "duration": )" + std::to_string(duration) + R"(, "bodies": [)" + bodies +
                           R"(], "loads": [)" + loads + "], " + more + "}",
                       "cluster.json");
}

template <class Driver>
SphereRun<double> run_clusters(const Scene& scene) {
    return Driver(scene, {0, scene.duration / 2, scene.duration}, ContactSettings{}).run();
}
void expect_vector(const Vector3<double>& found, const Vector3<double>& expected, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << "component " << i;
}
// Runs both formulations, compares them and returns the first.
SphereRun<double> follow_both(const Scene& scene, double tolerance = 1e-11) {
    SphereRun<double> first = run_clusters<ReducedClusters>(scene);
    const SphereRun<double> second = run_clusters<MultiplierClusters>(scene);
    EXPECT_EQ(first.fault, "");
    EXPECT_EQ(second.fault, "");
    EXPECT_EQ(first.motions.size(), 3u);
    for (std::size_t k = 0; k < std::min(first.motions.size(), second.motions.size()); ++k)
        for (std::size_t i = 0; i < first.motions[k].size(); ++i) {
            const BodyMotion<double>&m = first.motions[k][i], &n = second.motions[k][i];
            expect_vector(m.position_W, n.position_W, tolerance);
            expect_vector(m.velocity_W, n.velocity_W, 10 * tolerance);
            expect_vector(rotate(m.q, m.angular_velocity_B), rotate(n.q, n.angular_velocity_B), 100 * tolerance);
        }
    return first;
}
std::string sequence_of(const Scene& scene, const SphereRun<double>& run) {
    std::string all;
    for (const Event<double>& event : merge_records(run.records).events) {
        const ContactNames names = contact_names(scene, event.plane);
        all += std::string(event_names[static_cast<std::size_t>(event.kind)]) + " " + names.body + "-" + names.other +
               ", ";
    }
    return all;
}

TEST(FollowCluster, SmoothBallsSlideTogether) {
    const Scene scene = cluster_scene(touching_pair(), gravity_text() + "," + push_text("a", "[4, 0, 0]"),
                                      floor_text(0) + "," + contacts_text(0));
    const SphereRun<double> run = follow_both(scene);
    expect_vector(run.motions[2][0].velocity_W, {2, 0, 0}, 1e-14);
    expect_vector(run.motions[2][1].position_W, {1.25, 0, 0.125}, 1e-14);
    EXPECT_EQ(sequence_of(scene, run), "");
}

// Both balls slide. The friction f N of the pair lifts the first ball and presses the second one to the floor:
// a = F/(2 m) - mu g, N = F / (2 (1 - mu f)); the floor's friction spins them up.
TEST(FollowCluster, PushedBallsSlide) {
    const double F = 20, mu = 0.25, f = 0.0625, N = F / (2 * (1 - mu * f));
    const Scene scene = cluster_scene(touching_pair(), gravity_text() + "," + push_text("a", "[20, 0, 0]"),
                                      floor_text(mu) + "," + contacts_text(f));
    const SphereRun<double> run = follow_both(scene);
    expect_vector(run.motions[2][0].velocity_W, {F / 2 - mu * 10, 0, 0}, 1e-12);
    for (const std::size_t i : {0u, 1u}) {
        const double pressed = 10 + (i == 0 ? -1 : 1) * f * N;
        const double spin = (mu * pressed - f * N) * ball_radius / ball_moment;
        expect_vector(rotate(run.motions[2][i].q, run.motions[2][i].angular_velocity_B), {0, spin, 0}, 1e-11);
    }
}

// Both balls roll and slide on each other: 14/5 m a = F - 2 f N and (1 - f) N = 7/5 m a.
TEST(FollowCluster, PushedBallsRoll) {
    const Scene scene = cluster_scene(touching_pair(), gravity_text() + "," + push_text("a", "[4, 0, 0]"),
                                      floor_text(0.25) + "," + contacts_text(0.25));
    const SphereRun<double> run = follow_both(scene);
    const double a = 4 * 0.75 / 2.8, N = 1.4 * a / 0.75;
    expect_vector(run.motions[2][0].velocity_W, {a, 0, 0}, 1e-13);
    expect_vector(run.motions[2][1].position_W, {0.25 + a / 2, 0, 0.125}, 1e-13);
    // forces of the floor: friction in the direction of the motion, because the pair's friction opposes the rotation
    const std::vector<Vector3<double>>& forces = run.forces_W[1][1];
    expect_vector(forces[0], {a - N, 0, 10 + 0.25 * N}, 1e-12);
}

// Equal balls roll one behind the other with 5/7 g_x and without a force between them.
TEST(FollowCluster, EqualBallsRollDownAnInclineTogether) {
    const Scene scene =
        cluster_scene(touching_pair(), gravity_text("[3.5, 0, -9]"), floor_text(0.5) + "," + contacts_text(0.25));
    const SphereRun<double> run = follow_both(scene);
    for (const std::size_t i : {0u, 1u}) expect_vector(run.motions[2][i].velocity_W, {2.5, 0, 0}, 1e-13);
    EXPECT_EQ(sequence_of(scene, run), "");
}

TEST(FollowCluster, BallsStayAtRest) {
    const Scene scene = cluster_scene(touching_pair(), gravity_text(), floor_text(0.5) + "," + contacts_text(0.25));
    const SphereRun<double> run = follow_both(scene);
    expect_vector(run.motions[2][1].position_W, {0.25, 0, 0.125}, 0);
    EXPECT_EQ(sequence_of(scene, run), "");
}

// A rolling ball arrives at a ball at rest without restitution; momentum and energy of the smooth pair.
TEST(FollowCluster, ArrivesWithoutRestitution) {
    const Scene scene = cluster_scene(sphere_text("a", R"("position": [0, 0, 0.125], "velocity": [1, 0, 0])") + "," +
                                          sphere_text("b", R"("position": [0.5, 0, 0.125])"),
                                      gravity_text(), floor_text(0) + "," + contacts_text(0));
    const SphereRun<double> run = follow_both(scene);
    expect_vector(run.motions[2][0].velocity_W, {0.5, 0, 0}, 1e-14);
    EXPECT_EQ(sequence_of(scene, run), "lands a-b, ");
    ASSERT_EQ(merge_records(run.records).events.size(), 1u);
    EXPECT_NEAR(merge_records(run.records).events[0].normal_impulse, 0.5, 1e-14);
}

// Two forces press the balls together. Impacts start at t1 = sqrt(0.05) and end at t1 (1 + 2 e/(1 - e)) = 3 t1.
TEST(FollowCluster, ImpactsOfAPairAccumulate) {
    const Scene scene = cluster_scene(
        sphere_text("a", R"("position": [0, 0, 0.125])") + "," + sphere_text("b", R"("position": [0.45, 0, 0.125])"),
        gravity_text() + "," + push_text("a", "[4, 0, 0]") + "," + push_text("b", "[-4, 0, 0]"),
        floor_text(0) + "," + contacts_text(0, 0.5));
    const SphereRun<double> run = follow_both(scene);
    const Record<double> record = merge_records(run.records);
    ASSERT_FALSE(record.events.empty());
    EXPECT_EQ(record.events.back().kind, EventKind::accumulates);
    EXPECT_NEAR(record.events.front().t, std::sqrt(0.05), 1e-12);
    EXPECT_NEAR(record.events.back().t, 3 * std::sqrt(0.05), 1e-11);
    expect_vector(run.motions[2][0].position_W, {0.1, 0, 0.125}, 1e-12);
}

// A ball slides from rest down an immovable one and leaves it where the cosine of its line is 2/3 of the first one.
TEST(FollowCluster, LeavesAnImmovableBallAtTwoThirds) {
    const Scene scene =
        cluster_scene(sphere_text("a", R"("position": [0, 0, 0.125])", "1e13") + "," +
                          R"({"name": "b", "body": {"shape": {"type": "sphere", "radius": 0.1875}, "mass": 1},
                "initial": {"position": [0.1875, 0, 0.375]}})",
                      gravity_text(), floor_text(0) + "," + contacts_text(0), 0.375);
    const SphereRun<double> run = follow_both(scene);
    EXPECT_EQ(sequence_of(scene, run), "lifts_off a-b, lands b-floor, ");
    // R w^2 = g c at c = 2/3 4/5; afterwards the horizontal speed R w c is constant
    const double R = 0.3125, c = 1.6 / 3;
    EXPECT_NEAR(run.motions[2][1].velocity_W[0], std::sqrt(10 * R * c) * c, 1e-11);
}

// Two balls in flight that loads press together: their centre moves uniformly; without friction the energy is kept.
TEST(FollowCluster, FreePairKeepsMomentum) {
    const Scene scene = cluster_scene(
        sphere_text("a", "") + "," + sphere_text("b", R"("position": [0.25, 0, 0], "velocity": [0, 1, 0.5])"),
        push_text("a", "[8, 0, 0]") + "," + push_text("b", "[-8, 0, 0]"), contacts_text(0.3));
    const SphereRun<double> run = follow_both(scene);
    const std::vector<BodyMotion<double>>& end = run.motions[2];
    expect_vector(end[0].velocity_W + end[1].velocity_W, {0, 1, 0.5}, 1e-12);
    EXPECT_EQ(sequence_of(scene, run), "lifts_off a-b, ");
}

// A ball on top of another one: rolls, slides, leaves and lands on the floor.
TEST(FollowCluster, FallsOffARollingBall) {
    const Scene scene = cluster_scene(
        sphere_text("a", R"("position": [0, 0, 0.125])") + "," + sphere_text("b", R"("position": [0.15, 0, 0.325])"),
        gravity_text(), floor_text(0.4) + "," + contacts_text(0.3), 0.5);
    const SphereRun<double> run = follow_both(scene, 1e-9);
    EXPECT_EQ(sequence_of(scene, run), "slides a-b, lifts_off a-b, lands b-floor, ");
}

// Three balls in a row: a tree of contacts.
TEST(FollowCluster, PushesTwoBalls) {
    const Scene scene =
        cluster_scene(touching_pair() + "," + sphere_text("c", R"("position": [0.5, 0, 0.125])"),
                      gravity_text() + "," + push_text("a", "[6, 0, 0]"), floor_text(0) + "," + contacts_text(0));
    const SphereRun<double> run = follow_both(scene);
    for (const std::size_t i : {0u, 1u, 2u}) expect_vector(run.motions[2][i].velocity_W, {2, 0, 0}, 1e-13);
}

TEST(FollowCluster, NamesWhatIsNotSupported) {
    const std::string wall = R"("planes": [{"normal": [0, 0, 1], "offset": 0, "name": "floor", "restitution": 0},
        {"normal": [-1, 0, 0], "offset": -0.375, "name": "wall", "restitution": 0}], )";
    const Scene corner =
        cluster_scene(touching_pair(), gravity_text() + "," + push_text("a", "[4, 0, 0]"), wall + contacts_text(0));
    EXPECT_EQ(run_clusters<ReducedClusters>(corner).fault,
              "b touches another sphere and two planes at t = 0 s: lasting contacts of a sphere with a sphere and "
              "several planes are not supported");
}

}  // namespace
}  // namespace polhode::contact
