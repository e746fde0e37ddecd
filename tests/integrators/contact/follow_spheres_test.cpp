// Contacts of several spheres: closed forms of impacts with friction, conservation laws, both formulations, refusals.
#include "integrators/contact/follow_spheres.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/contact/cluster_form.h"
#include "integrators/contact/reduced_form.h"
#include "integrators/truth/cluster_multiplier_form.h"
#include "integrators/truth/multiplier_form.h"
#include "scene/scene_file.h"

namespace polhode::contact {
namespace {

const std::string ball_shape = R"({"shape": {"type": "sphere", "radius": 0.125}, "mass": 1})";

std::string ball(const std::string& name, const std::string& initial) {
    return R"({"name": ")" + name + R"(", "body": )" + ball_shape + R"(, "initial": {)" + initial + "}}";
}
Scene scene_of_balls(const std::string& bodies, const std::string& more, double duration = 2) {
    return parse_scene(R"({"name": "balls", "duration": )" + std::to_string(duration) + R"(, "bodies": [)" + bodies +
                           "], " + more + "}",
                       "balls.json");
}

using Reduced = SphereDriver<double, ReducedForm<double>, ClusterForm<double>, ClosedFormImpact>;
using Multiplier =
    SphereDriver<double, truth::MultiplierForm<double>, truth::ClusterMultiplierForm<double>, PhasedImpact>;

template <class Driver>
SphereRun<double> run_spheres(const Scene& scene) {
    return Driver(scene, {0, scene.duration / 2, scene.duration}, ContactSettings{}).run();
}

void expect_near(const Vector3<double>& found, const Vector3<double>& expected, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << "component " << i;
}

// Runs both formulations and compares their ends.
SphereRun<double> run_both(const Scene& scene) {
    SphereRun<double> first = run_spheres<Reduced>(scene);
    const SphereRun<double> second = run_spheres<Multiplier>(scene);
    EXPECT_EQ(first.fault, "");
    EXPECT_EQ(second.fault, "");
    EXPECT_EQ(first.motions.size(), second.motions.size());
    for (std::size_t k = 0; k < std::min(first.motions.size(), second.motions.size()); ++k)
        for (std::size_t i = 0; i < first.motions[k].size(); ++i) {
            expect_near(first.motions[k][i].position_W, second.motions[k][i].position_W, 1e-11);
            expect_near(first.motions[k][i].velocity_W, second.motions[k][i].velocity_W, 1e-11);
        }
    return first;
}

SphereImpact<double> example_impact(double friction) {
    SphereImpact<double> at;
    at.normal_W = Vector3<double>(-0.8, 0.6, 0);
    at.velocity_W = {Vector3<double>(1, 0.25, -0.5), Vector3<double>(-0.5, 0.125, 0.25)};
    at.rotation_W = {Vector3<double>(3, -2, 20), Vector3<double>(1, 4, -2)};
    at.radius = {0.5, 0.25}, at.mass = {2, 0.75}, at.moment = {0.2, 0.01};
    at.restitution = 0.75, at.friction = friction;
    return at;
}

// The slip ends during compression, during restitution, or never, depending on friction.
TEST(SphereImpact, PhasesGiveTheClosedForm) {
    for (const double friction : {0.0, 0.01, 0.2, 0.5, 0.8, 1.0, 2.0, 5.0}) {
        const SphereImpact<double> at = example_impact(friction);
        expect_near(PhasedImpact::impulse(at), ClosedFormImpact::impulse(at), 1e-13);
    }
}

TEST(SphereImpact, ReversesTheNormalVelocityAndLosesEnergy) {
    for (const double friction : {0.0, 0.3, 3.0}) {
        SphereImpact<double> at = example_impact(friction);
        const auto energy = [&] {
            double sum = 0;
            for (std::size_t i = 0; i < 2; ++i)
                sum += at.mass[i] * dot(at.velocity_W[i], at.velocity_W[i]) / 2 +
                       at.moment[i] * dot(at.rotation_W[i], at.rotation_W[i]) / 2;
            return sum;
        };
        const double approach = dot(at.slip_velocity(), at.normal_W), before = energy();
        const Vector3<double> impulse = PhasedImpact::impulse(at);
        for (std::size_t i = 0; i < 2; ++i) {
            const Vector3<double> on_body = i == 0 ? impulse : -impulse;
            at.velocity_W[i] = at.velocity_W[i] + (1 / at.mass[i]) * on_body;
            at.rotation_W[i] = at.rotation_W[i] + (1 / at.moment[i]) * cross(at.arm(i), on_body);
        }
        EXPECT_NEAR(dot(at.slip_velocity(), at.normal_W), -0.75 * approach, 1e-13);
        EXPECT_LT(energy(), before);
        const Vector3<double> u = at.slip_velocity();
        const double slip = length(Vector3<double>(u - dot(u, at.normal_W) * at.normal_W));
        // with much friction the slip ends
        EXPECT_EQ(slip < 1e-12, friction == 3.0);
    }
}

// Alciatore, technical proof TP A-14: the throw of a ball hit straight on by a ball with sidespin.
TEST(FollowSpheres, ThrowsTheObjectBall) {
    const Scene scene = scene_of_balls(ball("cue", R"("velocity": [1, 0, 0], "angular_velocity": [0, 0, 16])") + "," +
                                           ball("object", R"("position": [1, 0, 0])"),
                                       R"("contacts": [{"first": "cue", "second": "object", "restitution": 0.875,
                                                        "friction": 0.0625}])");
    const SphereRun<double> run = run_both(scene);
    ASSERT_EQ(run.motions.size(), 3u);
    // p = (1 + e) v m / 2 = 0.9375; the slip at the contact is w r = 2 m/s along y, and 7 mu p < 2
    const double p = 0.9375, friction = 0.0625 * p;
    expect_near(run.motions[2][1].velocity_W, Vector3<double>(p, friction, 0), 1e-13);
    expect_near(run.motions[2][0].velocity_W, Vector3<double>(1 - p, -friction, 0), 1e-13);
    // the contact is at t = 0.75: friction turns both balls backwards by mu p r / I with I = 2/5 m r^2
    const double change = friction * 0.125 / (0.4 * 0.125 * 0.125);
    EXPECT_NEAR(run.motions[2][0].angular_velocity_B[2], 16 - change, 1e-12);
    EXPECT_NEAR(run.motions[2][1].angular_velocity_B[2], -change, 1e-12);
    const Record<double> record = merge_records(run.records);
    ASSERT_EQ(record.events.size(), 1u);
    EXPECT_NEAR(record.events[0].t, 0.75, 1e-14);
    EXPECT_NEAR(record.events[0].normal_impulse, p, 1e-13);
    EXPECT_EQ(contact_names(scene, record.events[0].plane).body, "cue");
    EXPECT_EQ(contact_names(scene, record.events[0].plane).other, "object");
}

TEST(FollowSpheres, ConservesMomentaOfThreeBalls) {
    const Scene scene =
        scene_of_balls(ball("a", R"("velocity": [1, 0.0625, 0], "angular_velocity": [3, 1, 16])") + "," +
                           ball("b", R"("position": [1, 0.125, 0], "angular_velocity": [0, 2, 0])") + "," +
                           ball("c", R"("position": [1.5, -0.25, 0.0625], "velocity": [-1, 0.5, 0])"),
                       R"("contacts": [{"all": true, "restitution": 0.75, "friction": 0.25}])");
    const SphereRun<double> run = run_both(scene);
    EXPECT_GE(run.records.back().events.size(), 2u);
    const double moment = 0.4 * 0.125 * 0.125;
    std::array<Vector3<double>, 2> momentum, angular;
    for (const std::size_t k : {0u, 1u})
        for (const BodyMotion<double>& m : run.motions[2 * k]) {
            momentum[k] = momentum[k] + m.velocity_W;
            angular[k] = angular[k] + cross(m.position_W, m.velocity_W) + moment * rotate(m.q, m.angular_velocity_B);
        }
    expect_near(momentum[1], momentum[0], 1e-13);
    expect_near(angular[1], angular[0], 1e-12);
}

// A cradle with gaps passes the whole velocity on.
TEST(FollowSpheres, PassesVelocityAlongACradleWithGaps) {
    const Scene scene =
        scene_of_balls(ball("a", R"("velocity": [2, 0, 0])") + "," + ball("b", R"("position": [0.5, 0, 0])") + "," +
                           ball("c", R"("position": [0.78125, 0, 0])"),
                       R"("contacts": [{"all": true, "restitution": 1}])");
    const SphereRun<double> run = run_both(scene);
    ASSERT_EQ(run.motions.size(), 3u);
    expect_near(run.motions[2][0].velocity_W, Vector3<double>(), 1e-15);
    expect_near(run.motions[2][1].velocity_W, Vector3<double>(), 1e-15);
    expect_near(run.motions[2][2].velocity_W, Vector3<double>(2, 0, 0), 1e-15);
    expect_near(run.motions[2][0].position_W, Vector3<double>(0.25, 0, 0), 1e-14);
    expect_near(run.motions[2][1].position_W, Vector3<double>(0.53125, 0, 0), 1e-14);
}

// A ball of 64 kg falls with 2 m/s on a ball of 1 kg at rest on the floor. Hundreds of impacts between them and with
// the floor at one instant bring both to rest. Each series transmits the momentum of 128 N s.
TEST(FollowSpheres, ManyImpactsAtOneInstantEnd) {
    const std::string heavy = R"({"name": "b", "body": {"shape": {"type": "sphere", "radius": 0.125}, "mass": 64},
                                  "initial": {"position": [0, 0, 0.575]}})";
    const Scene scene = scene_of_balls(ball("a", R"("position": [0, 0, 0.125])") + "," + heavy,
                                       R"("loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
                                          "planes": [{"normal": [0, 0, 1], "offset": 0, "restitution": 0.5}],
                                          "contacts": [{"all": true, "restitution": 0.5}])",
                                       1);
    const SphereRun<double> run = run_both(scene);
    for (std::size_t i = 0; i < 2; ++i) {
        expect_near(run.motions.back()[i].position_W, {0, 0, 0.125 + 0.25 * static_cast<double>(i)}, 1e-12);
        expect_near(run.motions.back()[i].velocity_W, {0, 0, 0}, 1e-12);
    }
    ASSERT_GE(run.records.back().events.size(), 300u);
    for (const std::size_t k : {std::size_t{0}, run.records.size() - 1}) {
        double sum = 0;
        for (const Event<double>& event : run.records[k].events) sum += event.normal_impulse;
        EXPECT_NEAR(sum, 128, 1e-8);
    }
}

// A cradle without gaps is not determined by the laws for pairs.
TEST(FollowSpheres, EndsAtAnImpactOnTouchingSpheres) {
    const std::string touching = ball("a", R"("velocity": [2, 0, 0])") + "," + ball("b", R"("position": [0.5, 0, 0])") +
                                 "," + ball("c", R"("position": [0.75, 0, 0])");
    const SphereRun<double> cradle =
        run_spheres<Reduced>(scene_of_balls(touching, R"("contacts": [{"all": true, "restitution": 1}])"));
    EXPECT_EQ(
        cradle.fault,
        "the impact of a and b at t = 0.125 s acts through touching spheres on b and c: the laws for pairs do not "
        "determine it");
}

// A rolling ball hits a ball at rest: it keeps its spin and rolls on with 2/7 v, the other one rolls with 5/7 v. Both
// slide for the time 2 v / (7 mu g).
TEST(FollowSpheres, RollsAgainAfterACollisionOnATable) {
    const Scene scene = scene_of_balls(
        ball("a", R"("position": [0, 0, 0.125], "velocity": [2, 0, 0], "angular_velocity": [0, 16, 0])") + "," +
            ball("b", R"("position": [1, 0, 0.125])"),
        R"("loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
           "planes": [{"normal": [0, 0, 1], "restitution": 0, "friction": 0.25, "name": "table"}],
           "contacts": [{"all": true, "restitution": 1}])");
    const SphereRun<double> run = run_both(scene);
    ASSERT_EQ(run.motions.size(), 3u);
    expect_near(run.motions[2][0].velocity_W, Vector3<double>(4.0 / 7, 0, 0), 1e-12);
    expect_near(run.motions[2][1].velocity_W, Vector3<double>(10.0 / 7, 0, 0), 1e-12);
    const double impact = 0.375, rolls = impact + 2 * 2 / (7 * 0.25 * 10);
    std::vector<double> times;
    for (const Event<double>& event : merge_records(run.records).events)
        if (event.kind == EventKind::rolls) times.push_back(event.t);
    ASSERT_EQ(times.size(), 2u);
    EXPECT_NEAR(times[0], rolls, 1e-11);
    EXPECT_NEAR(times[1], rolls, 1e-11);
    // x = v t while rolling; while sliding the speed changes by mu g
    const double slides = rolls - impact, after = 2 - rolls;
    EXPECT_NEAR(run.motions[2][0].position_W[0], 0.75 + 1.25 * slides * slides + 4.0 / 7 * after, 1e-11);
    EXPECT_NEAR(run.motions[2][1].position_W[0], 1 + 2 * slides - 1.25 * slides * slides + 10.0 / 7 * after, 1e-11);
}

// The friction of a rolling ball's impact has a vertical part: the struck ball is pressed on the table.
TEST(FollowSpheres, FollowsFrictionBetweenBallsOnATable) {
    const Scene scene = scene_of_balls(
        ball("a", R"("position": [0, 0, 0.125], "velocity": [2, 0, 0], "angular_velocity": [0, 16, 0])") + "," +
            ball("b", R"("position": [1, 0.0625, 0.125])"),
        R"("loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
           "planes": [{"normal": [0, 0, 1], "restitution": 0.5, "friction": 0.25}],
           "contacts": [{"all": true, "restitution": 0.875, "friction": 0.0625}])",
        1.5);
    const SphereRun<double> run = run_both(scene);
    ASSERT_EQ(run.motions.size(), 3u);
    EXPECT_LT(run.motions[2][0].velocity_W[1], 0);
    EXPECT_GT(run.motions[2][1].velocity_W[1], 0);
}

void expect_refusal(const std::string& bodies, const std::string& more, const std::string& fault) {
    try {
        scene_of_balls(bodies, more);
        ADD_FAILURE() << "accepted: " << more;
    } catch (const std::exception& error) {
        EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
    }
}

TEST(SphereContacts, RefusesInvalidEntries) {
    const std::string two = ball("a", "") + "," + ball("b", R"("position": [1, 0, 0])");
    const auto refuses = [&](const std::string& entries, const std::string& fault) {
        expect_refusal(two, R"("contacts": [)" + entries + "]", fault);
    };
    refuses(R"({"first": "a", "second": "c", "restitution": 1})", "/contacts/0/second");
    refuses(R"({"first": "a", "second": "a", "restitution": 1})", "give two different bodies");
    refuses(R"({"first": "a", "restitution": 1})", "second");
    refuses(R"({"first": "a", "second": "b", "restitution": 1}, {"first": "b", "second": "a", "restitution": 1})",
            "a second time");
    refuses(R"({"all": true, "restitution": 2})", "/contacts/0/restitution");
    refuses(R"({"all": true, "restitution": 1, "friction": -1})", "/contacts/0/friction");
    refuses(R"({"all": true, "first": "a", "restitution": 1})", "together with \"all\"");
    const std::string all = R"("contacts": [{"all": true, "restitution": 1}])";
    expect_refusal(ball("a", "") + "," + ball("b", R"("position": [0.125, 0, 0])"), all, "overlap by 0.125 m");
    expect_refusal(two + R"(, {"name": "c", "body": {"shape": {"type": "box", "half_extents": [1, 1, 1]}, "mass": 1},
                            "initial": {"position": [5, 0, 0]}})",
                   all, "/bodies/2/body");
    expect_refusal(two + R"(, {"name": "c", "body": )" + ball_shape + "}",
                   all + R"(, "joints": [{"name": "j", "type": "spherical", "parent": "a", "child": "c"}])",
                   "together with joints");
    expect_refusal(two, R"("planes": [{"normal": [0, 0, 1], "restitution": 1}])",
                   "is penetrated 0.125 m deep by \"a\"");
}

TEST(SphereContacts, WritesWhatItReads) {
    const Scene scene = scene_of_balls(ball("a", "") + "," + ball("b", R"("position": [1, 0, 0])"),
                                       R"("contacts": [{"first": "a", "second": "b", "restitution": 0.5},
                                                       {"all": true, "restitution": 1, "friction": 0.25}])");
    const Scene again = parse_scene(write_scene(scene), "again.json");
    ASSERT_EQ(again.contacts.size(), 2u);
    EXPECT_EQ(again.contacts[0].second, "b");
    EXPECT_EQ(again.contacts[0].restitution, 0.5);
    EXPECT_TRUE(again.contacts[1].all);
    EXPECT_EQ(again.contacts[1].friction, 0.25);
}

}  // namespace
}  // namespace polhode::contact
