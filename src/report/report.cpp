#include "report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "check/check_files.h"
#include "check/limits.h"
#include "report/checks.h"
#include "report/comparison.h"
#include "report/document.h"
#include "report/folder.h"
#include "report/lessons.h"
#include "report/motions.h"
#include "report/page.h"
#include "scene/scene_file.h"
#include "text/atomic_file.h"
#include "text/message.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

// enough for stability maps, whose cells are read from table rows
constexpr std::size_t most_table_rows = 50'000;

// Levels of detail in descending order. The first one that fits into largest_page is used.
constexpr Detail details[] = {
    {100'000, 5, 2000, 2000, 200, 100'000, 1000},
    {100'000, 5, 2000, 2000, 200, 2000, 1000},
    {100'000, 4, 1000, 1000, 100, 1500, 600},
    {100'000, 4, 1000, 1000, 100, 1000, 400},
    {100'000, 3, 500, 500, 80, 700, 250},
    {100'000, 3, 500, 300, 60, 300, 150},
    {60'000, 3, 300, 300, 60, 200, 100},
    {30'000, 3, 200, 100, 60, 100, 60},
    {10'000, 3, 100, 50, 50, 50, 30},
    {3'000, 3, 30, 20, 40, 0, 0},
};

// Returns the name of the trajectories' scene, and adds the scene to the directory's scenes if it is new.
std::string scene_of_files(const ReportRequest& request, ResultFolder& folder, std::map<std::string, Scene>& scenes) {
    if (request.trajectories.empty()) return "";
    if (!request.scene.empty()) {
        if (!scenes.contains(request.scene)) {
            const Scene scene = find_scene(request.scene);
            std::string name = scenes.contains(scene.name) ? request.scene : scene.name;
            folder.scenes.place(name);
            scenes.insert_or_assign(name, scene);
            return name;
        }
        return request.scene;
    }
    std::string stem = fs::path(request.trajectories.front()).stem().string();
    if (scenes.contains(stem)) return stem;
    if (scenes.size() == 1) return scenes.begin()->first;
    throw InputError(one_line(request.trajectories.front(), 300), "", "is not named after a scene of the directory",
                     "give --scene SCENE");
}

// The text of the built front-end.
std::string read_page_template() {
    std::ifstream file(page_template_path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

ReportSummary write_lesson_page(const std::string& lesson, const std::string& output) {
    const Json json = find_lesson(lesson);
    const std::string page_template = read_page_template();
    ResultFolder folder;
    folder.name = json["title"].get<std::string>();
    folder.messages.place("");
    const std::map<std::string, Scene> scenes;
    const Motions motions;
    const Json checks = Json::array();
    const ReportContent content{folder, scenes, motions, checks, nullptr, nullptr, Json::array({json}), true};
    const Json document = report_document(content, details[0]);
    ReportSummary made;
    // named after the argument: the file's own `name` may not choose which file is written
    made.path = output.empty() ? fs::path(lesson).stem().string() + ".html" : output;
    const std::string page =
        fill_page(page_template, folder.name, document.dump(-1, ' ', false, Json::error_handler_t::replace));
    write_atomically(made.path, page);
    made.bytes = page.size();
    return made;
}

ReportSummary write_report_page(const ReportRequest& request) {
    ResultFolder folder = read_folder(request.directory, most_table_rows);
    std::map<std::string, Scene> scenes = read_scenes(folder);
    const std::string scene = scene_of_files(request, folder, scenes);
    std::optional<ResultFolder> other;
    std::optional<FolderComparison> comparison;
    if (!request.against.empty()) {
        other = read_folder(request.against, most_table_rows);
        comparison = compare_folders(folder, *other);
    }
    const std::string page_template = read_page_template();

    CheckedTrajectories checked;
    if (!request.trajectories.empty())
        checked =
            check_trajectories(scenes.at(scene), folder.scenes.find(scene), request.trajectories, request.convention);
    Motions motions;
    if (request.motions) motions = make_motions(folder, scenes, checked.drawn, request.jobs);
    for (std::size_t i = 0; i < motions.of_file.size(); ++i)
        checked.list[i]["motion_method"] = motions.of_file[i] < 0 ? Json() : Json(motions.of_file[i]);

    ReportSummary made;
    made.path = request.output.empty() ? (fs::path(request.directory) / "report.html").string() : request.output;
    const std::string made_in = fs::path(made.path).parent_path().string();
    remove_abandoned(made_in.empty() ? "." : made_in);
    const ReportContent content{folder,
                                scenes,
                                motions,
                                checked.list,
                                other ? &*other : nullptr,
                                comparison ? &*comparison : nullptr,
                                builtin_lessons_json()};
    for (const Detail& detail : details) {
        const Json document = report_document(content, detail);
        const std::string page =
            fill_page(page_template, folder.name, document.dump(-1, ' ', false, Json::error_handler_t::replace));
        if (page.size() > largest_page && &detail != &details[std::size(details) - 1]) continue;
        if (page.size() > largest_page)
            throw std::runtime_error(
                fmt::format("{}: contains more than a page can show; give a directory with fewer scenes",
                            one_line(request.directory, 300)));
        write_atomically(made.path, page);
        made.bytes = page.size();
        made.remarks = document["remarks"].get<std::vector<std::string>>();
        break;
    }
    return made;
}

}  // namespace polhode
