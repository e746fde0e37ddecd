// How a figure with too many curves is split, and which curves its first part shows.
#include "figure/split_figure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace polhode {
namespace {

// the error at setting x is (x / head_start)^2: it decreases with the setting
Curve falling(const std::string& label, const std::string& group, double head_start) {
    Curve curve;
    curve.label = label, curve.group = group;
    for (const double x : {1.0, 0.1, 0.01, 0.001})
        curve.x.push_back(x), curve.y.push_back(x * x / head_start / head_start);
    return curve;
}

std::vector<std::string> labels(const Figure& figure) {
    std::vector<std::string> all;
    for (const Curve& curve : figure.panels.front().curves) all.push_back(curve.label);
    return all;
}

NamedFigure steps_of(int families, int members) {
    NamedFigure whole{"errors", {"Errors", 1, {{"a scene", "step (s)", "error (rad)", true, true, {}}}, "", false}};
    whole.figure.best = Best::greatest_x;
    for (int f = 0; f < families; ++f)
        for (int m = 0; m < members; ++m)
            whole.figure.panels[0].curves.push_back(
                falling(fmt::format("f{}m{}", f, m), fmt::format("family_{}", f), 1 + m + 0.1 * f));
    return whole;
}

TEST(SplitFigure, LeavesAlonePicturesOfTwelveCurvesAndThoseWithoutGroups) {
    EXPECT_EQ(split_figure(steps_of(3, 4)).size(), 1U);
    NamedFigure whole = steps_of(5, 5);
    for (Curve& curve : whole.figure.panels[0].curves) curve.group.clear();
    EXPECT_EQ(split_figure(whole).size(), 1U);
}

TEST(SplitFigure, HasEachCurveInThePictureOfItsFamily) {
    const NamedFigure whole = steps_of(4, 5);
    const std::vector<NamedFigure> parts = split_figure(whole);
    ASSERT_EQ(parts.size(), 5U);
    EXPECT_EQ(parts[0].name, "errors");
    EXPECT_EQ(parts[1].name, "errors_family_0");
    EXPECT_EQ(parts[1].figure.title, "Errors: family_0");
    std::vector<std::string> all;
    for (std::size_t i = 1; i < parts.size(); ++i)
        for (const std::string& label : labels(parts[i].figure)) all.push_back(label);
    EXPECT_EQ(all, labels(whole.figure));
    for (std::size_t i = 1; i < parts.size(); ++i)
        EXPECT_NE(parts[0].figure.note.find(parts[i].name), std::string::npos) << parts[0].figure.note;
}

TEST(SplitFigure, DrawsNoFamilyAgainThatIsThereAlready) {
    NamedFigure whole = steps_of(1, 14);
    whole.figure.panels[0].curves.push_back(falling("alone", "small", 1));
    const std::vector<NamedFigure> parts = split_figure(whole);
    ASSERT_EQ(parts.size(), 3U);
    EXPECT_EQ(labels(parts[0].figure).back(), "alone");
    EXPECT_EQ(parts[0].figure.note.find("small"), std::string::npos);
}

TEST(SplitFigure, SplitsALargeFamilyEvenly) {
    const std::vector<NamedFigure> parts = split_figure(steps_of(2, 26));
    ASSERT_EQ(parts.size(), 7U);
    EXPECT_EQ(parts[1].name, "errors_family_0_1");
    EXPECT_EQ(parts[3].name, "errors_family_0_3");
    for (std::size_t i = 1; i < parts.size(); ++i) {
        EXPECT_GE(labels(parts[i].figure).size(), 8U);
        EXPECT_LE(labels(parts[i].figure).size(), 9U);
    }
}

// a larger head start reaches the level at a larger step
TEST(SplitFigure, ShowsTheBestOfEachFamilyFirst) {
    const std::vector<std::string> seen = labels(split_figure(steps_of(4, 5)).front().figure);
    ASSERT_EQ(seen.size(), 12U);
    for (int f = 0; f < 4; ++f)
        for (int m = 2; m < 5; ++m)
            EXPECT_NE(std::ranges::find(seen, fmt::format("f{}m{}", f, m)), seen.end()) << f << " " << m;
    // every family shows at least one curve, even if all curves of another family are better
    NamedFigure whole = steps_of(2, 20);
    for (Curve& curve : whole.figure.panels[0].curves)
        if (curve.group == "family_0")
            for (double& y : curve.y) y *= 1e4;
    const std::vector<std::string> one = labels(split_figure(whole).front().figure);
    EXPECT_EQ(std::ranges::count_if(one, [](const std::string& label) { return label.starts_with("f0"); }), 1);
    EXPECT_NE(std::ranges::find(one, "f0m19"), one.end());
}

TEST(SplitFigure, KnowsWhichDirectionIsBetter) {
    NamedFigure whole = steps_of(1, 13);
    whole.figure.best = Best::least_x;  // as if x were seconds and all curves reached the same error
    for (std::size_t m = 0; m < 13; ++m) {
        Curve& curve = whole.figure.panels[0].curves[m];
        curve.x.push_back(1e-5 * static_cast<double>(1 + m)), curve.y.push_back(1e-10);
    }
    std::vector<std::string> seen = labels(split_figure(whole).front().figure);
    EXPECT_EQ(std::ranges::find(seen, "f0m12"), seen.end()) << "the slowest";
    whole = steps_of(1, 13);
    whole.figure.best = Best::lowest_end;
    seen = labels(split_figure(whole).front().figure);
    EXPECT_EQ(std::ranges::find(seen, "f0m0"), seen.end()) << "the largest error";
    // a curve that never reaches the level ranks behind all that do
    whole.figure.best = Best::greatest_x;
    Curve& last = whole.figure.panels[0].curves[12];
    last.x = {1}, last.y = {0.9};
    seen = labels(split_figure(whole).front().figure);
    EXPECT_EQ(std::ranges::find(seen, "f0m12"), seen.end());
    whole.figure.panels[0].curves[0].x.clear(), whole.figure.panels[0].curves[0].y.clear();
    seen = labels(split_figure(whole).front().figure);
    EXPECT_NE(std::ranges::find(seen, "f0m12"), seen.end());
}

TEST(SplitFigure, LeavesOutCurvesWithoutAPoint) {
    NamedFigure whole = steps_of(2, 7);
    for (const std::size_t i : {0, 1, 2}) whole.figure.panels[0].curves[i].y.assign(4, 0);
    EXPECT_EQ(split_figure(whole).size(), 1U) << "eleven are left";
    whole = steps_of(2, 8);
    for (const std::size_t i : {0, 1, 2}) whole.figure.panels[0].curves[i].y.assign(4, 0);
    const std::vector<NamedFigure> parts = split_figure(whole);
    // the first part has the five remaining curves of family 0 and all but the worst of family 1
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[1].name, "errors_family_1");
    const std::vector<std::string> seen = labels(parts[0].figure);
    EXPECT_EQ(seen.front(), "f0m3");
    EXPECT_EQ(std::ranges::find(seen, "f1m0"), seen.end());
    EXPECT_NE(parts[0].figure.note.find("12 of 13 curves"), std::string::npos);
}

TEST(SplitFigure, KeepsCurvesThatBelongToNoFamily) {
    NamedFigure whole = steps_of(3, 5);
    Curve floor;
    floor.label = "floor", floor.x = {1e-3, 1}, floor.y = {1e-12, 1e-12};
    whole.figure.panels[0].curves.push_back(floor);
    for (const NamedFigure& part : split_figure(whole)) EXPECT_EQ(labels(part.figure).back(), "floor") << part.name;
}

}  // namespace
}  // namespace polhode
