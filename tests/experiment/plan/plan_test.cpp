#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "bad_files.h"
#include "experiment/plan/experiment.h"
#include "figure/figure.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

Experiment parsed(const std::string& text) { return parse_experiment(text, "e.json"); }

std::string fault_of(const std::string& text) {
    try {
        make_plan(parsed(text), "e.json", false);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no fault";
}

TEST(ExperimentFile, ReadsEveryKey) {
    const Experiment e = parsed(R"({
        // a comment
        "name": "one", "about": "why", "kind": "drift", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.001, 0.1, 0.01], "tolerances": {"from": 1e-2, "to": 1e-6, "count": 3}},
        "vary": {"/duration": [1, 2.5], "/initial/angular_velocity": [[1, 2, 3]]},
        "samples": 7, "repeats": 2, "seconds_per_run": 0.5, "max_steps": 1000})");
    EXPECT_EQ(e.name, "one");
    EXPECT_EQ(e.about, "why");
    EXPECT_EQ(e.kind, find_kind("drift"));
    EXPECT_EQ(e.steps, (std::vector<double>{0.1, 0.01, 0.001}));  // from coarse to fine
    ASSERT_EQ(e.tolerances.size(), 3U);
    EXPECT_EQ(e.tolerances.front(), 1e-2);
    EXPECT_NEAR(e.tolerances[1], 1e-4, 1e-18);
    EXPECT_EQ(e.tolerances.back(), 1e-6);
    ASSERT_EQ(e.vary.size(), 2U);
    EXPECT_EQ(e.vary[0].pointer, "/duration");
    EXPECT_EQ(e.vary[0].values, (std::vector<std::string>{"1", "2.5"}));
    EXPECT_EQ(e.vary[1].values, (std::vector<std::string>{"[1,2,3]"}));
    EXPECT_EQ(e.samples, 7);
    EXPECT_EQ(e.repeats, 2);
    EXPECT_EQ(e.seconds_per_run, 0.5);
    EXPECT_EQ(e.max_steps, 1000);
}

TEST(ExperimentFile, RefusesWithPlaceAndRemedy) {
    const std::string head = R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk4"])";
    const auto place = [&](const std::string& text, const std::string& expected) {
        const std::string fault = fault_of(text);
        EXPECT_NE(fault.find("e.json: " + expected), std::string::npos) << text << "\n" << fault;
        EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
    };
    place(R"({"scenes": ["symmetric"], "methods": ["odeint_rk4"]})", "");
    place(R"({"name": "a/b", "scenes": ["symmetric"], "methods": ["odeint_rk4"]})", "/name");
    place(head + R"(, "kind": "pie"})", "/kind");
    place(head + R"(, "steps": [1]})", "/steps");
    place(head + R"(, "settings": {"evaluations_per_revolution": [9]}})", "/settings/evaluations_per_revolution");
    place(head + R"(, "kind": "conservation", "settings": {"steps": [1]}})", "/settings");
    place(head + R"(, "max_evaluations": 0})", "/max_evaluations");
    place(head + R"(, "settings": {"steps": [0.1, 0]}})", "/settings/steps/1");
    place(head + R"(, "settings": {"steps": [1e999]}})", "/settings/steps/0");
    place(head + R"(, "settings": {"steps": []}})", "/settings/steps");
    place(head + R"(, "settings": {"steps": {"from": 1, "to": -1, "count": 2}}})", "/settings/steps/to");
    place(head + R"(, "settings": {"steps": {"from": 1, "to": 2, "count": 2000000}}})", "/settings/steps");
    place(head + R"(, "settings": {"steps": [0.1]}, "samples": 0})", "/samples");
    place(head + R"(, "settings": {"steps": [0.1]}, "repeats": 1.5})", "/repeats");
    place(head + R"(, "settings": {"steps": [0.1]}, "seconds_per_run": -1})", "/seconds_per_run");
    place(head + R"(, "settings": {"steps": [0.1]}, "vary": {"/duration": []}})", "/vary");
    place(head + R"(, "settings": {"steps": [0.1]}, "vary": {"duration": [1]}})", "/vary");
    place(head + R"(, "settings": {"steps": [0.1]}, "scenes": ["sphere"]})", "");
    place(head + "}", "/settings");
    place(R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk5"], "settings": {"steps": [1]}})",
          "/methods/0");
    place(R"({"name": "x", "scenes": ["symmetric"], "methods": ["/(/"], "settings": {"steps": [1]}})", "/methods/0");
    place(R"({"name": "x", "scenes": ["/nothing/"], "methods": ["odeint_rk4"], "settings": {"steps": [1]}})",
          "/scenes/0");
    place(R"({"name": "x", "scenes": [], "methods": ["odeint_rk4"], "settings": {"steps": [1]}})", "/scenes");
}

TEST(BadExperiments, EachIsRefusedInOneLineThatNamesFilePlaceAndRemedy) {
    for (const BadFile& bad : bad_files("experiment", ".json")) {
        std::string message;
        try {
            make_plan(find_experiment(bad.path), bad.path, false);
        } catch (const InputError& error) {
            message = error.what();
        }
        expect_one_line(bad, message);
    }
    EXPECT_GE(bad_files("experiment", ".json").size(), 60u);
    expect_whole_catalogue("experiment", ".json");
}

TEST(ExperimentFile, RangesMaySpanAllOfBinary64) {
    const Experiment e = parsed(R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": {"from": 1e-300, "to": 1e300, "count": 7},
                     "tolerances": {"from": 5e-324, "to": 1e-310, "count": 3}}})");
    ASSERT_EQ(e.steps.size(), 7U);
    for (std::size_t i = 0; i < 7; ++i)
        EXPECT_NEAR(std::log10(e.steps[i]), 300 - 100 * static_cast<double>(i), 1e-9) << i;
    ASSERT_EQ(e.tolerances.size(), 3U);
    EXPECT_EQ(e.tolerances.back(), 5e-324);
}

TEST(Plan, AVariationMayAddAKey) {
    const Plan plan = make_plan(parsed(R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.1]}, "vary": {"/tolerated": [{"attitude": 0.25}], "/about": ["varied"]}})"),
                                "e.json", false);
    ASSERT_EQ(plan.scenes.size(), 1U);
    EXPECT_EQ(tolerated_error(plan.scenes[0].scene, "attitude"), 0.25);
}

TEST(Plan, VariesScenesInAllCombinations) {
    const Plan plan = make_plan(parsed(R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.1]}, "vary": {"/duration": [1, 2], "/body/mass": [3, 4, 5]}})"),
                                "e.json", false);
    ASSERT_EQ(plan.scenes.size(), 6U);
    EXPECT_EQ(plan.scenes[4].label, "symmetric{/duration=2,/body/mass=4}");
    EXPECT_EQ(plan.scenes[4].scene.duration, 2);
    EXPECT_EQ(plan.scenes[4].scene.body.mass, 4);
    EXPECT_EQ(plan.scenes[4].canonical, write_scene(plan.scenes[4].scene));
}

TEST(Plan, AVariationIsCheckedAsAnyScene) {
    EXPECT_NE(fault_of(R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.1]}, "vary": {"/body/mass": [-1]}})")
                  .find("/body/mass"),
              std::string::npos);
}

TEST(Plan, GivesEachMethodTheSettingsItTakes) {
    const Plan plan = make_plan(parsed(R"({"name": "x", "scenes": ["symmetric"],
        "methods": ["odeint_rk4", "odeint_dopri5", "cvode_bdf"], "settings": {"steps": [0.1], "tolerances": [1e-6]}})"),
                                "e.json", false);
    ASSERT_EQ(plan.curves.size(), 4U);
    EXPECT_EQ(plan.curves[0].kind, SettingKind::step);
    EXPECT_EQ(plan.curves[1].method, plan.curves[2].method);
    EXPECT_NE(plan.curves[1].kind, plan.curves[2].kind);
    EXPECT_EQ(plan.curves[3].kind, SettingKind::tolerance);
}

TEST(Plan, AMethodThatAPatternFindsMayHaveNoSetting) {
    const Plan plan = make_plan(parsed(R"({"name": "x", "scenes": ["symmetric"], "methods": ["/odeint_rk4$|cvode_bdf/"],
        "settings": {"steps": [0.1]}})"),
                                "e.json", false);
    ASSERT_EQ(plan.curves.size(), 1U);
    EXPECT_EQ(plan.curves[0].method->name, "odeint_rk4");
}

TEST(Plan, QuickKeepsEveryThirdSetting) {
    const Plan plan = make_plan(parsed(R"({"name": "x", "scenes": ["symmetric"], "methods": ["odeint_rk4"],
        "settings": {"steps": [0.4, 0.3, 0.2, 0.1]}, "repeats": 9, "seconds_per_run": 3})"),
                                "e.json", true);
    EXPECT_EQ(plan.curves[0].settings, (std::vector<double>{0.4, 0.1}));
    EXPECT_EQ(plan.experiment.repeats, 3);
    EXPECT_EQ(plan.experiment.max_evaluations, 100000);
    EXPECT_EQ(plan.experiment.seconds_per_run,
              3);  // not reduced, because a time limit gives different tables on different machines
}

// a method has the same style in every plan
TEST(Plan, MethodsHaveOneStyleEverywhere) {
    for (const char* name : {"contrast", "work_precision", "leave_out", "projection", "convergence", "speed"})
        for (const PlannedCurve& curve : make_plan(find_experiment(name), name, false).curves) {
            EXPECT_EQ(curve.style.color, method_style(*curve.method).color) << curve.method->name;
            EXPECT_EQ(curve.style.mark, method_style(*curve.method).mark) << curve.method->name;
        }
}

TEST(Plan, BuiltInExperimentsAreSound) {
    for (const std::string name : {"contrast", "convergence", "work_precision", "speed"}) {
        const Plan plan = make_plan(find_experiment(name), name, false);
        EXPECT_EQ(plan.experiment.name, name);
        EXPECT_FALSE(plan.scenes.empty());
        EXPECT_FALSE(plan.curves.empty());
    }
}

}  // namespace
}  // namespace polhode
