// The kind `event_truth`, and the closed forms that it compares with the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "catalogue.h"
#include "experiment/kinds/closed_form_numbers.h"
#include "experiment/kinds/closed_forms.h"
#include "experiment/kinds/findings_read.h"
#include "experiment/kinds/kinds.h"
#include "experiment/plan/experiment.h"
#include "integrators/truth/fresh_cache.h"

namespace polhode {
namespace {

std::vector<FormComparison> forms_of(const std::string& name, const Scene& moved, int digits = 20) {
    return compare_closed_forms(find_scene(name), truth::find_truth(moved, 1, digits));
}
std::vector<FormComparison> forms_of(const std::string& name) { return forms_of(name, find_scene(name)); }

const FormComparison& form_of(const std::vector<FormComparison>& forms, const std::string& quantity) {
    const auto found = std::ranges::find(forms, quantity, &FormComparison::quantity);
    if (found == forms.end()) throw std::invalid_argument("no form " + quantity);
    return *found;
}

// 2 |u0| / (7 mu g) for the slip u0, and v0 - 2/7 u0 (Hopkins and Patterson 1977), by hand in binary64
void expect_sliding_ball(const std::string& name, double ux, double uy, double vx, double mu) {
    const FreshCache cache;
    const std::vector<FormComparison> forms = forms_of(name);
    const double t = 2 * std::hypot(ux, uy) / (7 * mu * 9.8);
    EXPECT_NEAR(std::stod(form_of(forms, "start of rolling (s)").expected), t, 1e-15) << name;
    EXPECT_NEAR(std::stod(form_of(forms, "final v_x (m/s)").expected), vx - 2 * ux / 7, 1e-15) << name;
    for (const FormComparison& form : forms) {
        ASSERT_TRUE(form.difference) << name << " " << form.quantity;
        EXPECT_LT(*form.difference, 1e-20) << name << " " << form.quantity;
        EXPECT_FALSE(form.source.empty());
    }
}
TEST(ContactClosedForms, BallsThatSlideAndRoll) {
    expect_sliding_ball("contact/bowling_ball", 8 - 0.109 * 10, -0.5 - 0.109 * 30, 8, 0.12);
    expect_sliding_ball("contact/billiard_side_spin", 1.5 - 0.028575 * 20, -0.028575 * 80, 1.5, 0.2);
}

// Values that are short decimals or known numbers.
TEST(ContactClosedForms, KnownValues) {
    const FreshCache cache;
    const std::vector<FormComparison> ball = forms_of("contact/ball_bounces_to_rest");
    EXPECT_EQ(form_of(ball, "first impact (s)").expected, "0.5");
    EXPECT_EQ(form_of(ball, "end of the impacts (s)").expected, "1.5");
    EXPECT_LT(*form_of(ball, "end of the impacts (s)").difference, 1e-20);
    const std::vector<FormComparison> block = forms_of("contact/block_on_ramp");
    EXPECT_EQ(form_of(block, "final speed (m/s)").expected, "3");
    EXPECT_EQ(form_of(block, "final place (m)").expected, "1");
    const std::vector<FormComparison> shot = forms_of("contact/billiard_natural_angle");
    const double angle = std::atan(std::stod(form_of(shot, "tangent of the natural angle").computed));
    EXPECT_NEAR(angle * 180 / std::numbers::pi, 33.67, 0.005);  // Alciatore, TP 3.3
}
TEST(JointClosedForms, KnownValues) {
    const FreshCache cache;
    const std::vector<FormComparison> oscillator = forms_of("joints/coulomb_oscillator");
    EXPECT_EQ(form_of(oscillator, "stop (s)").expected, "6.283185307179586476925287");
    EXPECT_EQ(form_of(oscillator, "final x (m)").expected, "0");
    EXPECT_LT(*form_of(oscillator, "stop (s)").difference, 1e-20);
    const std::vector<FormComparison> rack = forms_of("joints/rack_and_pinion");
    EXPECT_EQ(form_of(rack, "displacement of the rack (m)").expected, "-4");
    EXPECT_EQ(form_of(rack, "final spin of the pinion (rad/s)").expected, "20");
    EXPECT_EQ(form_of(forms_of("joints/bouncing_slider"), "end of the impacts (s)").expected, "3");
}

// A motion with another coefficient differs from the closed form, and one without the event has no value.
TEST(ClosedFormComparison, FindsAnotherMotion) {
    const FreshCache cache;
    const std::string name = "contact/bowling_ball";
    Scene moved = find_scene(name);
    moved.planes[0].friction = 0.125;
    EXPECT_NEAR(*form_of(forms_of(name, moved, 12), "start of rolling (s)").difference, 0.04, 1e-10);
    moved = find_scene(name);
    moved.duration = 0.5;
    const std::vector<FormComparison> sliding = forms_of(name, moved, 12);
    EXPECT_FALSE(form_of(sliding, "start of rolling (s)").difference);
    EXPECT_EQ(form_of(sliding, "start of rolling (s)").computed, "");
    moved = find_scene("joints/pendulum_with_stops");
    moved.joints[0].limits.restitution = 0.7;
    for (const FormComparison& form : forms_of("joints/pendulum_with_stops", moved, 12))
        EXPECT_GT(*form.difference, 1e-3);
}

TEST(ClosedFormComparison, OtherScenesHaveNone) {
    const FreshCache cache;
    EXPECT_TRUE(forms_of("bouncing_ball").empty());
    Scene unknown = find_scene("contact/bowling_ball");
    EXPECT_TRUE(compare_closed_forms(unknown, truth::Truth()).empty());
}

TEST(ClosedFormComparison, EverySceneOfContactAndJointsHasAForm) {
    std::set<std::string> names;
    for (const auto& forms : {closed_forms::contact_forms(), closed_forms::joint_forms()})
        for (const closed_forms::SceneForms& own : forms) names.insert(std::string(own.scene));
    std::set<std::string> scenes;
    for (const char* folder : {"contact", "joints"})
        for (const std::string& name : scenes_in(folder)) scenes.insert(name);
    EXPECT_EQ(names, scenes);
}

TEST(EventTruthStudy, CountsEventsAndDigits) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "event_truth", "samples": 2,
        "scenes": ["contact/ball_bounces_to_rest", "contact/ball_incline_rolls", "joints/coulomb_oscillator"]})",
                                                 "x.json"),
                                "x.json", false);
    const Findings result = run_event_truth(plan, RunOptions());
    const Table &table = table_of(result, ""), &forms = table_of(result, "closed_forms");
    ASSERT_EQ(table.rows.size(), 3U);
    for (const auto& row : table.rows) {
        EXPECT_GE(std::get<long>(row[column_index(table, "digits_agreed")]), 25);
        EXPECT_LE(number(table, row, "bound"), 1e-25);
        EXPECT_LE(number(table, row, "closed_form_difference"), 1e-24);
    }
    EXPECT_EQ(word(table, table.rows[0], "last_event_time"), "1.500000000000000000000000");
    EXPECT_LE(number(table, table.rows[0], "last_event_bound"), 2e-25);
    EXPECT_EQ(word(table, table.rows[1], "events"), "0");
    EXPECT_EQ(word(table, table.rows[1], "last_event_time"), "");
    EXPECT_EQ(word(table, table.rows[2], "last_event_time").substr(0, 17), "6.283185307179586");
    long listed = 0;
    for (const auto& row : table.rows) listed += std::get<long>(row[column_index(table, "closed_forms")]);
    EXPECT_EQ(static_cast<std::size_t>(listed), forms.rows.size());
}

// --quick requests fewer digits of the same motion.
TEST(EventTruthStudy, QuickRunsRequestFewerDigits) {
    const FreshCache cache;
    const Plan plan = make_plan(parse_experiment(R"({"name": "x", "kind": "event_truth", "samples": 2,
        "scenes": ["contact/ball_incline_slides"]})",
                                                 "x.json"),
                                "x.json", true);
    const Findings result = run_event_truth(plan, quickly());
    const Table& table = table_of(result, "");
    EXPECT_LT(std::get<long>(table.rows.at(0)[column_index(table, "digits_asked")]), 20);
    EXPECT_LT(number(table, table.rows.at(0), "closed_form_difference"), 1e-10);
}

}  // namespace
}  // namespace polhode
