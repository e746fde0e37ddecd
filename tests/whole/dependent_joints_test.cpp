// Limits and friction of joints whose coordinates depend on each other by loops.
#include <gtest/gtest.h>

#include <string>

#include "formula/formula_scene.h"
#include "integrators/series/real.h"
#include "integrators/truth/attempt.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/shared.h"

namespace polhode {
namespace {

// A parallelogram: two cranks of 0.5 m, 1 m apart, and a coupler that does not rotate. The angles of the cranks are
// equal, and that of the coupler to the first crank is the opposite. `laws`: members of the crank, the coupler joint
// and the rocker.
Scene parallelogram(const std::string& crank, const std::string& pin, const std::string& rocker) {
    return parse_scene(R"json({"name": "parallelogram", "duration": 4,
      "bodies": [{"name": "left", "body": {"mass": 1, "inertia": [0.0625, 0.0625, 0.03125], "center_of_mass": [0, 0, -0.25]}},
                 {"name": "coupler", "body": {"mass": 2, "inertia": [0.25, 0.25, 0.25], "center_of_mass": [0.5, 0, 0]}},
                 {"name": "right", "body": {"mass": 1.5, "inertia": [0.125, 0.125, 0.0625], "center_of_mass": [0, 0, -0.25]}}],
      "joints": [{"name": "crank", "type": "revolute", "parent": "world", "child": "left", "axis": [0, 1, 0],
                  "initial": {"angle": 1})json" +
                           crank + R"json(},
                 {"name": "pin", "type": "revolute", "parent": "left", "child": "coupler", "axis": [0, 1, 0],
                  "parent_point": [0, 0, -0.5], "initial": {"angle": -1, "dependent": true})json" +
                           pin + R"json(},
                 {"name": "rocker", "type": "revolute", "parent": "world", "child": "right", "axis": [0, 1, 0],
                  "parent_point": [1, 0, 0], "initial": {"angle": 1, "dependent": true})json" +
                           rocker + R"json(}],
      "loops": [{"name": "end", "type": "spherical", "first": "coupler", "first_point": [1, 0, 0], "second": "right",
                 "second_point": [0, 0, -0.5]}],
      "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})json",
                       "parallelogram.json", "");
}

// One degree of freedom: friction of all joints acts as their sum on one of them.
TEST(DependentJoints, FrictionOfAParallelogramAddsUp) {
    const FreshCache cache;
    const Scene one = parallelogram(R"(, "friction": 2)", "", ""),
                all = parallelogram(R"(, "friction": 0.5)", R"(, "friction": 0.75)", R"(, "friction": 0.75)");
    const truth::Truth expected = truth::find_truth(one, 8, 22, 600), found = truth::find_truth(all, 8, 22, 600);
    ASSERT_TRUE(expected.reference.available) << expected.reference.message;
    ASSERT_TRUE(found.reference.available) << found.reference.message;
    EXPECT_LT(test::difference(expected.reference, found.reference, false), 1e-21);
    // it comes to rest: each of the three joints sticks where the only one does
    ASSERT_FALSE(expected.contact_events.empty());
    EXPECT_EQ(expected.contact_events.back().event, "sticks");
    ASSERT_EQ(found.contact_events.size(), 3 * expected.contact_events.size());
    for (std::size_t i = 0; i < found.contact_events.size(); ++i) {
        EXPECT_EQ(found.contact_events[i].event, "sticks");
        const Real<50> difference = Real<50>(found.contact_events[i].t) - Real<50>(expected.contact_events[i / 3].t);
        EXPECT_LT(abs(difference), 1e-21);
    }
    for (const char* method : {"taylor", "dop853", "radau"}) {
        const Trajectory run = test::solve_with(all, method, 1e-11, 8);
        ASSERT_EQ(run.status, Status::ok) << method << ": " << run.message;
        for (std::size_t i = 0; i < run.samples.size(); ++i)
            EXPECT_LT(length(run.samples[i].position_W - expected.reference.samples[i].rounded().position_W), 1e-8)
                << method << i;
    }
}

// A limit of the rocker is one of the crank, and of the pin with the opposite sign.
TEST(DependentJoints, ALimitOfOneJointIsOneOfAll) {
    const FreshCache cache;
    const std::string friction = R"(, "friction": 0.125)";
    const Scene by_crank = parallelogram(friction + R"(, "limits": {"lower": -0.5, "restitution": 0.5})", friction, ""),
                by_rocker = parallelogram(friction, friction, R"(, "limits": {"lower": -0.5, "restitution": 0.5})"),
                by_pin = parallelogram(friction, friction + R"(, "limits": {"upper": 0.5, "restitution": 0.5})", "");
    const Reference expected = reference(by_crank, 6, 22);
    ASSERT_TRUE(expected.available) << expected.message;
    for (const Scene& scene : {by_rocker, by_pin}) {
        const Reference found = reference(scene, 6, 22);
        ASSERT_TRUE(found.available) << found.message;
        EXPECT_LT(test::difference(expected, found, false), 1e-21);
    }
}

}  // namespace
}  // namespace polhode
