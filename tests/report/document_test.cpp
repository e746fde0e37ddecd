// Tests the page's document: which data are omitted to keep it small, and that the rest equals the directory's data.
#include "report/document.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "places.h"
#include "report/findings.h"

namespace polhode {
namespace {

class FolderDocument : public ::testing::Test {
  protected:
    FolderDocument() { folder.experiments.push_back({"t", "", "sweep", "", false, {}}), folder.messages.place(""); }

    FolderRow& add(const std::string& scene, const std::string& method, double setting, double error, double seconds) {
        FolderRow row;
        row.scene = folder.scenes.place(scene), row.method = folder.methods.place(method);
        row.formulation = folder.formulations.place("reduced"), row.kind = SettingKind::step, row["setting"] = setting;
        row["attitude_error_max"] = row["attitude_error_final"] = error, row["seconds_median"] = seconds;
        folder.rows.push_back(row);
        return folder.rows.back();
    }
    void add_table(const std::string& name, std::vector<std::string> columns,
                   const std::vector<std::vector<std::string>>& rows) {
        FolderTable table{name, "t", "Title", {std::move(columns), {}}, rows.size()};
        for (const auto& row : rows) {
            table.table.rows.emplace_back();
            for (const std::string& text : row) table.table.rows.back().push_back(text.empty() ? Cell() : Cell(text));
        }
        folder.tables.push_back(table);
    }
    Json document(const Detail& detail = {}) const {
        return report_document({folder, scenes, motions, checks, other, comparison ? &*comparison : nullptr}, detail);
    }
    static bool says(const Json& document, const std::string& remark) {
        return std::ranges::any_of(document["remarks"], [&](const Json& one) {
            return one.get<std::string>().find(remark) != std::string::npos;
        });
    }

    ResultFolder folder;
    Motions motions;
    const std::map<std::string, Scene> scenes;
    const Json checks = Json::array();
    const ResultFolder* other = nullptr;
    std::optional<FolderComparison> comparison;
};

TEST_F(FolderDocument, OfManyRowsKeepsSomeOfEachCurveAndThoseThatOthersSpeakOf) {
    // the fastest run within 1e-6 rad lies inside a curve, where a stride would skip it
    for (int curve = 0; curve < 4; ++curve)
        for (int k = 0; k < 101; ++k)
            add(curve < 2 ? "a" : "b", curve % 2 ? "taylor" : "dop853", 1.0 / (k + 1), 1e-7,
                k == 57 ? 1e-6 : 1e-3 + 1e-5 * k);
    Detail detail;
    detail.rows = 100;
    const Json thin = document(detail), whole = document();
    EXPECT_EQ(whole["rows"]["count"], 404);
    EXPECT_FALSE(says(whole, "result rows"));
    const auto count = thin["rows"]["count"].get<std::size_t>();
    EXPECT_LE(count, 150u);
    EXPECT_GE(count, 70u);
    EXPECT_EQ(thin["rows"]["total"], 404);
    EXPECT_TRUE(says(thin, "This page contains " + std::to_string(count) + " of 404 result rows"));
    for (const Json& page : {thin, whole}) {
        const Json& rows = page["rows"];
        std::set<std::pair<int, int>> curves;
        for (std::size_t i = 0; i < rows["count"]; ++i) curves.emplace(rows["scene"][i], rows["method"][i]);
        EXPECT_EQ(curves.size(), 4u);
        for (std::size_t s = 0; s < 2; ++s)
            for (const Json& fastest : page["scenes"][s]["fastest"]) {
                const auto at = fastest["row"].get<std::size_t>(), next = fastest["runner_up"].get<std::size_t>();
                EXPECT_EQ(rows["scene"][at], s);
                EXPECT_EQ(rows["seconds"][at], 1e-6);
                EXPECT_EQ(rows["setting"][at], 0.017241);  // 1/58
                EXPECT_NE(rows["method"][at], rows["method"][next]);
            }
        EXPECT_EQ(page["scenes"][0]["fastest"].size(), 2u);  // to 1e-3 and 1e-6 rad
    }
}

// The names in a list in data.ts.
std::set<std::string> names_in_page(const std::string& list) {
    std::ifstream file(source_dir() + "/src/report/page/source/data.ts");
    const std::string text(std::istreambuf_iterator<char>(file), {});
    const std::size_t begin = text.find("export const " + list + " = ["), end = text.find("] as const", begin);
    std::set<std::string> names;
    for (std::size_t at = begin; (at = text.find('"', at + 1)) < end;) {
        const std::size_t close = text.find('"', at + 1);
        names.insert(text.substr(at + 1, close - at - 1));
        at = close;
    }
    return names;
}

TEST_F(FolderDocument, HasTheColumnsOfRowsThatThePageReads) {
    add("a", "taylor", 0.1, 1e-3, 2e-6);
    std::set<std::string> others, numbers;
    for (const ResultColumn& column : result_column_table())
        EXPECT_TRUE(column.page_name.empty() || numbers.insert(column.page_name).second) << column.page_name;
    const Json rows = document()["rows"];
    for (const auto& [name, values] : rows.items())
        if (!numbers.contains(name)) others.insert(name);
    std::set<std::string> expected = names_in_page("indexColumns");
    expected.insert({"count", "total", "messages", "formulations"});
    EXPECT_EQ(others, expected);
    const std::set<std::string> read = names_in_page("numberColumns");
    EXPECT_GT(read.size(), 5u);
    EXPECT_TRUE(std::ranges::includes(numbers, read));
    for (const std::string& name : numbers) EXPECT_EQ(rows[name].size(), 1u) << name;
}

TEST_F(FolderDocument, ThinsCurvesOfOneRow) {
    for (int k = 0; k < 400; ++k) add("scene " + std::to_string(k), "taylor", 0.1, 1e-2, 1e-3);
    Detail detail;
    detail.rows = 100, detail.digits = 3;
    const Json page = document(detail);
    EXPECT_LE(page["rows"]["count"].get<int>(), 150);
    EXPECT_TRUE(says(page, "Numbers are rounded to 3 significant digits."));
}

TEST_F(FolderDocument, TablesDistinguishNumbersFromText) {
    add_table("x", {"name", "count", "value", "mixed", "empty"},
              {{"a", "3", "1.23456789", "1", ""}, {"b", "", "-2e-3", "n/a", ""}, {"c", "4", "7", "2", ""}});
    Detail detail;
    detail.table_rows = 2;
    const Json table = document(detail)["tables"][0];
    EXPECT_EQ(table["title"], "Title");
    const bool numeric[] = {false, true, true, false, false}, integral[] = {false, true, false, false, false};
    for (std::size_t c = 0; c < 5; ++c) {
        EXPECT_EQ(table["columns"][c]["numeric"], numeric[c]) << c;
        EXPECT_EQ(table["columns"][c]["integral"], integral[c]) << c;
    }
    EXPECT_EQ(table["rows"], Json::parse(R"([["a", 3, 1.23457, "1", null], ["b", null, -0.002, "n/a", null]])"));
    EXPECT_EQ(table["total"], 3);
}

TEST_F(FolderDocument, MapsAreTheIntervalsOfTheirTable) {
    add("a", "odeint_rk4", 0.1, 1e-3, 1);
    add_table("stability_maps", {"method", "map", "x", "step_least", "step_largest", "outcome"},
              {{"odeint_rk4", "spin", "1", "0.1", "0.2", "accurate"},
               {"odeint_rk4", "spin", "1", "0.4", "0.8", "diverged"},
               {"odeint_rk4", "spin", "10", "0.1", "0.1", "close"},
               {"odeint_rk4", "spin", "10", "0.2", "0.2", "tolerance_not_met"},
               {"odeint_rk4", "spin", "10", "0.4", "0.8", "no such outcome"},
               {"odeint_rk4", "stiffness", "1", "0.1", "0.1", "failed"},
               {"unknown", "spin", "1", "0.1", "0.1", "failed"}});
    const Json maps = document()["maps"];
    ASSERT_EQ(maps.size(), 2u);
    const Json& spin = maps[0];
    EXPECT_EQ(spin["x_label"], "spin (rad/s)");
    EXPECT_EQ(spin["x"], Json({1, 10}));
    EXPECT_EQ(spin["y"], Json({0.1, 0.2, 0.4, 0.8}));
    // row by row of y: accurate 0, close 1, diverged 4, tolerance_not_met 5; -1 without a known outcome
    EXPECT_EQ(spin["outcome"], Json({0, 1, 0, 5, 4, -1, 4, -1}));
    EXPECT_EQ(maps[1]["x_label"], "stiffness");
    EXPECT_EQ(maps[1]["outcome"], Json::array({6}));
    // every outcome has a name
    EXPECT_EQ(spin["outcomes"].size(), 9u);
    EXPECT_EQ(spin["outcomes"][5], "tolerance_not_met");
    folder.tables[0].table.columns[2] = "y";
    EXPECT_TRUE(document()["maps"].empty());
}

TEST_F(FolderDocument, OfRunsOverTimeKeepsTheFirstWithPointsSpreadOverThem) {
    add("a", "taylor", 0.1, 1e-3, 1);
    for (int run = 0; run < 3; ++run) {
        FolderSeries series;
        series.setting = 0.5 + run;
        for (int k = 0; k <= 1000; ++k) {
            series.t.push_back(k);
            for (auto& errors : series.errors) errors.push_back(1e-9 * k);
        }
        folder.series.push_back(series);
    }
    Detail detail;
    detail.series = 2, detail.series_points = 11;
    const Json page = document(detail);
    ASSERT_EQ(page["drift"].size(), 2u);
    EXPECT_TRUE(says(page, "This page contains the first 2 of 3 runs with errors over time."));
    const Json& run = page["drift"][1];
    EXPECT_EQ(run["setting"], 1.5);
    EXPECT_EQ(run["t"], Json({0, 100, 200, 300, 400, 500, 600, 700, 800, 900, 1000}));
    EXPECT_EQ(run["energy"][5], 5e-7);
    EXPECT_EQ(run["thinned"], true);
    EXPECT_NEAR(run["growth"]["energy"][0].get<double>(), 1, 0.02);
}

TEST_F(FolderDocument, OmitsTheLeastImportantMotionsFirst) {
    for (int scene = 0; scene < 2; ++scene) {
        Json motion{{"scene", scene}, {"methods", Json::array()}};
        for (const char* name : {"odeint_rk4_float32", "no such method", "odeint_rk4", "article_as_written"})
            motion["methods"].push_back({{"method", 0}, {"label", name}, {"message", ""}, {"track", {{"t", 1}}}});
        motion["methods"].push_back({{"method", -1}, {"label", "own.csv"}, {"message", ""}, {"track", {{"t", 1}}}});
        motion["methods"][2]["message"] = "slow";
        motions.list.push_back(motion);
    }
    motions.omissions = {"c is not drawn: why."};
    Detail detail;
    detail.tracks = 4;
    const Json page = document(detail);
    EXPECT_TRUE(says(page, "4 of 10 motions are omitted"));
    EXPECT_TRUE(says(page, "c is not drawn: why."));
    for (const Json& motion : page["motions"]) {
        // two methods per scene: a published update, then one in binary64; user files are always kept
        const bool kept[] = {false, false, true, true, true};
        for (std::size_t i = 0; i < 5; ++i) EXPECT_NE(motion["methods"][i]["track"].is_null(), kept[i]) << i;
        EXPECT_EQ(motion["methods"][0]["message"], "its motion is omitted from this page");
        EXPECT_EQ(motion["methods"][2]["message"], "slow");
    }
    EXPECT_EQ(document()["motions"], motions.list);
    detail.tracks = 2;
    EXPECT_EQ(document(detail)["motions"][1]["methods"][2]["message"], "slow; its motion is omitted from this page");
}

TEST_F(FolderDocument, ComparesTwoDirectories) {
    for (const char* scene : {"a", "b", "c"}) add(scene, "taylor", 0.1, 1e-3, 2e-6);
    add("only here", "taylor", 0.1, 1e-3, 2e-6);
    ResultFolder there = folder;
    there.name = "there", there.rows.pop_back();
    for (FolderRow& row : there.rows) row["seconds_median"] *= 1.5;
    there.rows[1]["attitude_error_max"] = 2e-3, there.rows[2]["seconds_median"] = absent;
    other = &there, comparison = compare_folders(folder, there);
    const Json found = document()["comparison"];
    EXPECT_EQ(found["folder"], "there");
    EXPECT_EQ(found["matched"], 3);
    EXPECT_EQ(found["only_here"], 1);
    EXPECT_EQ(found["only_there"], 0);
    EXPECT_EQ(found["same_bits"], 2);
    EXPECT_EQ(found["all"]["ratio"], 1.5);
    EXPECT_TRUE(found["all"]["low"].is_null());  // two scenes with times
    EXPECT_EQ(found["methods"][0]["ratio"], 1.5);
    EXPECT_EQ(found["pairs"], Json::parse(R"([{"row": 0, "seconds": 3e-6, "error": 0.001},
                                              {"row": 1, "seconds": 3e-6, "error": 0.002}])"));
    other = nullptr;
    EXPECT_TRUE(document()["comparison"].is_null());
}

TEST_F(FolderDocument, ContainsTheDescriptionsOfMethods) {
    add("a", "gone_method", 0.1, 1e-3, 1), add("a", "odeint_rk4", 0.1, 1e-3, 1);
    const Json page = document();
    const Json &gone = page["methods"][0], &known = page["methods"][1];
    EXPECT_EQ(gone["library"], "");
    EXPECT_EQ(gone["order"], 0);
    EXPECT_EQ(known["order"], 4);
    EXPECT_EQ(known["precision"], "binary64");
    EXPECT_EQ(page["families"][known["family"].get<std::size_t>()]["name"], "runge_kutta");
    EXPECT_EQ(known["documentation"].get<std::string>().find('`'), std::string::npos);
    const Json& scene = page["scenes"][0];
    EXPECT_TRUE(scene["duration"].is_null());
    EXPECT_TRUE(scene["motion"].is_null());
}

TEST_F(FolderDocument, OmitsCurvesOfTheLastMotionsIfThereAreTooMany) {
    for (int i = 0; i < 3; ++i) {
        Json contacts = Json::array({{{"t", {0, 1}}}, {{"t", {0, 1}}}});
        Json motion{{"scene", 0}, {"methods", Json::array()}, {"timeline", {{"total", 0}}}, {"remark", ""}};
        motion["contacts"] = i == 1 ? Json::array() : contacts;
        motion["coordinates"] = i == 1 ? Json{{"curves", {1, 2, 3}}} : Json();
        motions.list.push_back(motion);
    }
    EXPECT_FALSE(says(document(), "curves"));
    Detail detail;
    detail.curves = 5;
    const Json page = document(detail);
    EXPECT_EQ(page["motions"][0]["contacts"].size(), 2u);
    EXPECT_EQ(page["motions"][1]["coordinates"]["curves"].size(), 3u);
    EXPECT_TRUE(page["motions"][2]["contacts"].empty());
    EXPECT_EQ(page["motions"][2]["timeline"]["total"], 0);
    EXPECT_NE(page["motions"][2]["remark"], "");
    EXPECT_TRUE(says(page, "1 of 3 motions have no curves"));
}

}  // namespace
}  // namespace polhode
