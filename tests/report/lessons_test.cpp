// Tests the reader of lessons: the numbers of the scene, the names that the page's kernels have, and refusals.
#include "report/lessons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "integrators/method.h"
#include "places.h"
#include "report/document_text.h"
#include "report/report.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

std::string read_source(const std::string& path) {
    std::ifstream file(source_dir() + "/src/report/page/source/" + path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::string lesson_with(const std::string& members) {
    return R"({"name": "n", "title": "t", "text": "one", )" + members + "}";
}

std::string fault_of(const std::string& text) {
    try {
        parse_lesson(text, "lesson.json");
    } catch (const InputError& fault) {
        return fault.what();
    }
    return "";
}

TEST(Lessons, ContainTheNumbersOfTheScene) {
    const Json lesson =
        parse_lesson(lesson_with(R"("scene": "lagrange_top", "update": "gyroscopic_none", "step": 0.01, "duration": 2,
                       "sliders": {"tilt": [0, 1], "moment_x": [0.5, 1]}, "graphs": ["tilt"], "show": ["path", "axes"])"),
                     "lesson.json");
    const Scene scene = find_scene("lagrange_top");
    EXPECT_EQ(lesson["mass"], scene.body.mass);
    EXPECT_EQ(lesson["inertia"], Json({0.75, 0, 0, 0, 0.75, 0, 0, 0, 0.5}));
    EXPECT_EQ(lesson["arm"], Json({0, 0, 0.5}));
    EXPECT_EQ(lesson["gravity"], Json({0, 0, -10}));
    EXPECT_EQ(lesson["angular_velocity"], Json({0, 0, 20}));
    EXPECT_EQ(lesson["orientation"][1].get<double>(), normalized(scene.initial.orientation).x);
    EXPECT_EQ(lesson["text"], Json({"one"}));
    EXPECT_EQ(lesson["show"], "path,axes");
    EXPECT_EQ(lesson["sliders"][0], Json({{"quantity", "tilt"}, {"from", 0}, {"to", 1}}));
    // about the pivot: 0.75 + 1 kg (0.5 m)^2
    EXPECT_EQ(lesson["about"]["moments"], Json({1, 1, 0.5}));
}

TEST(Lessons, BuiltInOnesUseUpdatesOfTheCatalogueThatThePageComputes) {
    const std::string kernels = read_source("lesson/kernels.ts"),
                      contact_kernels = read_source("lesson/contact_kernels.ts");
    ASSERT_FALSE(kernels.empty() || contact_kernels.empty());
    const std::vector<std::string> names = builtin_lesson_names();
    for (const char* name : {"dzhanibekov", "gyroscopic_term", "poinsot", "rattleback", "rolling_ball", "spinning_top",
                             "step_against_error", "tippe_top"})
        EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
    for (const Json& lesson : builtin_lessons_json()) {
        const std::string update = lesson["update"].get<std::string>();
        const std::string& known = lesson["contact"].is_null() ? kernels : contact_kernels;
        EXPECT_NE(known.find('"' + update + '"'), std::string::npos) << update;
        EXPECT_NE(find_method(update), nullptr) << update;
        EXPECT_FALSE(lesson["sliders"].empty()) << lesson["name"];
        EXPECT_FALSE(lesson["graphs"].empty()) << lesson["name"];
    }
    // every name that a refusal offers is one of the page's kernels
    const auto offered = [&](const std::string& scene, const std::string& known) {
        std::istringstream words(
            fault_of(lesson_with(R"("scene": ")" + scene + R"(", "step": 1, "update": "zzzzzzzzzz")")));
        int count = 0;
        for (std::string word; words >> word;) {
            word = word.substr(0, word.find(','));
            if (!find_method(word)) continue;
            EXPECT_NE(known.find('"' + word + '"'), std::string::npos) << word;
            ++count;
        }
        return count;
    };
    EXPECT_EQ(offered("sphere", kernels), 11);
    EXPECT_EQ(offered("contact/bowling_ball", contact_kernels), 5);
}

TEST(Lessons, ContainTheContactOfTheScene) {
    const Json top = find_lesson("tippe_top")["contact"];
    // two balls of 0.01 kg and 0.005 kg, 0.006 m apart: the larger one touches, its centre is 0.002 m above that of
    // mass
    EXPECT_NEAR(top["center"][2].get<double>(), 0.002, 1e-17);
    EXPECT_EQ(top["radius"], 0.02);
    EXPECT_EQ(top["friction"], 0.3);
    EXPECT_EQ(top["normal"], Json({0, 0, 1}));
    EXPECT_EQ(top["axes"], Json({0, 0, 0, 0, 0, 0, 0, 0, 0}));
    EXPECT_NEAR(top["reach"].get<double>(), 0.022, 1e-16);
    const Json stone = find_lesson("rattleback")["contact"];
    EXPECT_EQ(stone["axes"], Json({0.2, 0, 0, 0, 0.03125, 0, 0, 0, 0.0234375}));
    EXPECT_EQ(stone["center"], Json({0, 0, 0.0078125}));
    EXPECT_EQ(stone["velocity"], Json({0.015625, 0, 0}));
    EXPECT_TRUE(find_lesson("poinsot")["contact"].is_null());
}

TEST(Lessons, RefuseWhatThePageCannotCompute) {
    const auto refused = [](const std::string& members, const std::string& place) {
        const std::string fault = fault_of(lesson_with(members));
        EXPECT_TRUE(fault.starts_with("lesson.json: " + place)) << members << "\n" << fault;
        EXPECT_EQ(fault.find('\n'), std::string::npos);
    };
    const std::string run = R"("update": "gyroscopic_none", "step": 0.01)";
    EXPECT_EQ(fault_of(lesson_with(R"("scene": "sphere", )" + run)), "");
    refused(R"("scene": "mechanisms/double_pendulum_spatial", )" + run, "/scene: ");
    refused(R"("scene": "bouncing_ball", )" + run, "/scene: ");
    refused(R"("scene": "damped_spin", )" + run, "/scene: ");
    refused(R"("scene": "sphere", "graphs": ["slip"], )" + run, "/graphs: ");
    refused(R"("scene": "sphere", "sliders": {"friction": [0, 1]}, )" + run, "/sliders/friction: ");
    const std::string impulses = R"("update": "contact_impulses_cone", "step": 0.01)";
    EXPECT_EQ(fault_of(lesson_with(R"("scene": "contact/bowling_ball", )" + impulses)), "");
    refused(R"("scene": "contact/bowling_ball", )" + run, "/update: ");
    refused(R"("scene": "sphere", )" + impulses, "/update: ");
    refused(R"("scene": "contact/bowling_ball", "graphs": ["step_error"], )" + impulses, "/graphs: ");
    refused(R"("scene": "contact/bowling_ball", "sliders": {"friction": [-1, 1]}, )" + impulses,
            "/sliders/friction/0: ");
    // a box, two planes, and a body that falls
    refused(R"("scene": "contact/block_on_ramp", )" + impulses, "/scene: ");
    refused(R"("scene": "contact/ball_in_gutter", )" + impulses, "/scene: ");
    refused(R"("scene": "contact/ball_bounces_to_rest", )" + impulses, "/scene: ");
    refused(R"("scene": "no_such_scene", )" + run, "/scene: ");
    refused(R"("scene": "../up.json", )" + run, "/scene: ");
    refused(R"("scene": "sphere", "update": "gyroscopic_non", "step": 1)", "/update: ");
    refused(R"("scene": "sphere", "update": "gyroscopic_none", "step": 0)", "/step: ");
    refused(R"("scene": "sphere", "update": "gyroscopic_none", "step": 1e-9)", "/step: ");
    refused(R"("scene": "sphere", "sliders": {"spin": [0, 1]}, )" + run, "/sliders/spin: ");
    refused(R"("scene": "sphere", "sliders": {"step": [1, 0.1]}, )" + run, "/sliders/step: ");
    refused(R"("scene": "sphere", "sliders": {"step": [0, 0.1]}, )" + run, "/sliders/step/0: ");
    refused(R"("scene": "sphere", "sliders": {"gravity": [0, 1]}, )" + run, "/sliders/gravity: ");
    refused(R"("scene": "sphere", "sliders": {"tilt": [0, 1]}, )" + run, "/sliders: ");
    refused(R"("scene": "sphere", "graphs": ["heat"], )" + run, "/graphs/0: ");
    refused(R"("scene": "sphere", "colour": 1, )" + run, "/colour: ");
    refused(run, "/scene: ");
    for (const char* name : {"", "../up", "a b", "a\\n"})
        EXPECT_TRUE(fault_of(R"({"name": ")" + std::string(name) +
                             R"(", "title": "t", "text": "t", "scene": "sphere", )" + run + "}")
                        .starts_with("lesson.json: /name: "))
            << name;
}

TEST(Lessons, AreReadFromFiles) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "polhode_lesson";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "mine.json")
        << R"({"name": "mine", "duration": 1, "body": {"mass": 1, "inertia": [1, 2, 2.5]}, )"
        << R"("initial": {"angular_velocity": [1, 2, 3]}})";
    std::ofstream(folder / "lesson.json")
        << lesson_with(R"("scene": "mine.json", "update": "gyroscopic_none", "step": 0.01)");
    const Json lesson = find_lesson((folder / "lesson.json").string());
    EXPECT_EQ(lesson["scene"], "mine");
    EXPECT_EQ(lesson["angular_velocity"], Json({1, 2, 3}));
    EXPECT_TRUE(lesson["arm"].is_null());
    EXPECT_THROW(find_lesson((folder / "none.json").string()), InputError);
    std::filesystem::remove_all(folder);
}

TEST(Lessons, PageContainsOneLessonAndNothingElse) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "polhode_lesson_page";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "template.html") << page_template;
    ASSERT_EQ(setenv("POLHODE_REPORT_PAGE", (folder / "template.html").c_str(), 1), 0);
    const ReportSummary made = write_lesson_page("poinsot", (folder / "page.html").string());
    unsetenv("POLHODE_REPORT_PAGE");
    std::ifstream file(made.path);
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(made.bytes, page.size());
    EXPECT_NE(page.find("<title>Poinsot's ellipsoid</title>"), std::string::npos);
    const Json document = Json::parse(document_text(page));
    EXPECT_EQ(document["lesson_page"], true);
    ASSERT_EQ(document["lessons"].size(), 1u);
    EXPECT_EQ(document["lessons"][0], find_lesson("poinsot"));
    EXPECT_EQ(document["rows"]["count"], 0);
    EXPECT_TRUE(document["scenes"].empty());
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace polhode
