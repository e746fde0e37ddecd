// Errors at contacts in the rows of experiments.
#include "experiment/run/contact_events.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/run/result.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

constexpr long contact_samples = 64;

/// A ball of radius 0.1 m on or above the floor, under gravity of 9.81 m/s^2.
Scene thrown_ball(double height, double speed, double restitution, double friction) {
    Scene scene;
    scene.name = "thrown ball", scene.duration = 1;
    scene.body = body_of(body_source(ShapedBody{SolidSphere{0.1}, {2, false}}));
    scene.initial.position_W = {0, 0, height}, scene.initial.velocity_W = {speed, 0, 0};
    scene.loads = {Gravity{{0, 0, -9.81}, {}}};
    scene.planes = {{{0, 0, 1}, 0, restitution, friction}};
    return scene;
}

struct ContactRow {
    ContactErrors errors;
    std::string message;
};
ContactRow measure_row(const Scene& scene, const char* name, Settings settings) {
    settings.samples = contact_samples;
    const Problem problem = pose(scene);
    const Method& method = *find_method(name);
    ContactRow row;
    row.errors = measure_contacts(method, problem, settings, solve(problem, method, settings),
                                  reference(scene, contact_samples), row.message);
    return row;
}

// The ball slides until t = 2 u / (7 mu g) = 0.437 s. No impact: a comparison of impact times would find no event.
TEST(ContactRows, CompareAllEventsOfAnEventDrivenMethod) {
    const FreshCache cache;
    const Scene scene = thrown_ball(0.1, 3, 0, 0.2);
    Settings fine;
    fine.tolerance = 1e-12;
    const ContactRow row = measure_row(scene, "taylor", fine);
    EXPECT_LT(*row.errors.event_time, 1e-13);
    EXPECT_LT(*row.errors.slip, 1e-13);
    EXPECT_LT(*row.errors.energy_gain, 1e-13);
    EXPECT_EQ(row.message, "");
}

// Time stepping reports no events. The slip, u - 7/2 mu g t until it ends, ends within the step.
TEST(ContactRows, MeasureTimeStepping) {
    const FreshCache cache;
    Settings coarse;
    coarse.step = 1.0 / 64;
    const ContactRow row = measure_row(thrown_ball(0.1, 3, 0, 0.2), "moreau_jean", coarse);
    EXPECT_FALSE(row.errors.event_time);
    EXPECT_LT(*row.errors.slip, 1e-13);
    EXPECT_LT(*row.errors.penetration, 1e-15);
    EXPECT_EQ(row.message, "");
}

// A ball falls from 0.5 m with e = 0.8: its depth at a sample is at most the way of one step, 3.1 m/s h.
TEST(ContactRows, MeasurePenetrationAndImpactTimes) {
    const FreshCache cache;
    const Scene scene = thrown_ball(0.6, 0, 0.8, 0);
    Settings coarse;
    coarse.step = 1.0 / 64;
    const ContactRow stepped = measure_row(scene, "contact_impulses_cone", coarse);
    EXPECT_GT(*stepped.errors.penetration, 0);
    EXPECT_LT(*stepped.errors.penetration, 3.2 / 64);
    EXPECT_FALSE(stepped.errors.slip);
    // the step after the gap closes: late by at most one step at the first impact, and more at later ones
    EXPECT_GT(*stepped.errors.event_time, 0);
    EXPECT_LT(*stepped.errors.event_time, 4.0 / 64);
    EXPECT_EQ(stepped.message, "");
    Settings fine;
    fine.tolerance = 1e-12;
    const ContactRow located = measure_row(scene, "cvode_impacts", fine);
    EXPECT_GT(*located.errors.event_time, 0);
    EXPECT_LT(*located.errors.event_time, 1e-10);
}

TEST(ContactColumns, AreInTablesOfScenesWithPlanes) {
    Result r;
    r.contacts = {0.5, 0.25, 0.125, 2};
    const std::vector<std::string> single = result_columns(), all = result_columns(TableKind::planes);
    const std::vector<std::string> further{"position_error_max", "event_time_error_max", "penetration_max",
                                           "slip_error_max", "contact_energy_gain"};
    ASSERT_EQ(all.size(), single.size() + further.size());
    EXPECT_TRUE(std::equal(single.begin(), single.end(), all.begin()));
    EXPECT_TRUE(std::equal(further.begin(), further.end(), all.begin() + static_cast<long>(single.size())));
    EXPECT_EQ(result_columns(TableKind::all_scenes).size(),
              result_columns(TableKind::systems).size() + further.size() - 1);
    for (const TableKind kind : {TableKind::planes, TableKind::all_scenes, TableKind::stored}) {
        const Result back = parse_result(parse_csv(csv({result_columns(kind), {result_row("e", r, kind)}})), 0);
        EXPECT_EQ(back.contacts.event_time, 0.5);
        EXPECT_EQ(back.contacts.penetration, 0.25);
        EXPECT_EQ(back.contacts.slip, 0.125);
        EXPECT_EQ(back.contacts.energy_gain, 2);
    }
    EXPECT_FALSE(parse_result(parse_csv(csv({single, {result_row("e", r)}})), 0).contacts.slip);
}

}  // namespace
}  // namespace polhode
