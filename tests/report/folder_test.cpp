// Tests reading of valid and corrupted result directories.
#include "report/folder.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "report/findings.h"
#include "text/message.h"

namespace polhode {
namespace {

const char* const header =
    "experiment,scene,method,setting_kind,setting,status,seconds_min,seconds_median,repeats,steps,rhs_evaluations,"
    "attitude_error_final,attitude_error_max,omega_error_max,energy_error_max,momentum_error_max,norm_error_max,"
    "message,"
    "float64_floor\n";

class Folder : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "polhode-report-XXXXXX").string();
        ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
        path = pattern;
    }
    void TearDown() override { std::filesystem::remove_all(path); }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(std::filesystem::path(path) / name, std::ios::binary) << text;
    }
    // A row of the experiment `t` on free_asymmetric
    static std::string row(const std::string& method, double step, double error, double seconds,
                           const std::string& status = "ok", double energy = 0, double momentum = 0) {
        std::string text = "t,free_asymmetric," + method + ",step," + std::to_string(step) + "," + status;
        for (const double value : {seconds, seconds, 3.0, 10.0, 40.0, error, error, error, energy, momentum, 0.0}) {
            char number[32];
            std::snprintf(number, sizeof number, ",%.17g", value);
            text += number;
        }
        return text + (status == "ok" ? ",,1e-14\n" : ",why,1e-14\n");
    }
    std::string path;
};

TEST_F(Folder, RefusesDeeplyNestedFiles) {
    write("t.csv", header + row("taylor", 0.1, 1e-3, 2e-6));
    const std::string deep = std::string(300'000, '[') + std::string(300'000, ']');
    write("scenes.json", R"({"free_asymmetric": )" + deep + "}");
    write("provenance.json", R"({"t": {"about": )" + deep + "}}");
    const ResultFolder folder = read_folder(path, 100);
    EXPECT_EQ(folder.rows.size(), 1u);
    EXPECT_TRUE(folder.scene_texts.empty());
}

TEST_F(Folder, ReadsRowsSeriesTablesAndWhereTheyAreFrom) {
    write("t.csv", header + row("taylor", 0.1, 1e-3, 2e-6) + row("\"no,such\"\"method\"", 0.2, 1, 1, "diverged"));
    write("t_other.csv", "name,count,error\n\"a, b\",3,1e-3\n,,\n");
    write("drift.csv",
          "scene,method,setting,t,attitude_error,omega_error,energy_error,momentum_error,norm_error,experiment\n"
          "free_asymmetric,taylor,0.1,0,0,0,0,0,0,t\nfree_asymmetric,taylor,0.1,1,1e-3,0,,0,0,t\n"
          "free_asymmetric,taylor,0.2,0,0,0,0,0,0,t\n");
    write("provenance.json", R"({"t": {"about": "A <b>test</b>", "kind": "convergence", "quick": true, "cpu": "X",
          "titles": {"t_other": "Others"}, "versions": {"Boost": "1"}}})");
    const ResultFolder folder = read_folder(path, 100);
    ASSERT_EQ(folder.rows.size(), 2u);
    EXPECT_EQ(folder.rows[0]["seconds_median"], 2e-6);
    EXPECT_EQ(folder.rows[0]["float64_floor"], 1e-14);
    EXPECT_TRUE(std::isnan(folder.rows[0]["step_taken"]));
    EXPECT_EQ(folder.methods.names()[1], "no,such\"method");
    EXPECT_EQ(folder.rows[1].status, Status::diverged);
    EXPECT_EQ(folder.messages.names()[static_cast<std::size_t>(folder.rows[1].message)], "why");
    ASSERT_EQ(folder.series.size(), 2u);
    EXPECT_EQ(folder.series[0].t.size(), 2u);
    EXPECT_TRUE(std::isnan(folder.series[0].errors[2][1]));
    ASSERT_EQ(folder.tables.size(), 1u);
    EXPECT_EQ(folder.tables[0].title, "Others");
    EXPECT_EQ(folder.tables[0].experiment, "t");
    EXPECT_EQ(text_of(folder.tables[0].table.rows[0][0]), "a, b");
    ASSERT_EQ(folder.experiments.size(), 1u);
    EXPECT_EQ(folder.experiments[0].about, "A <b>test</b>");
    EXPECT_TRUE(folder.experiments[0].quick);
    EXPECT_TRUE(read_scenes(folder).contains("free_asymmetric"));
    EXPECT_TRUE(folder.remarks.empty());
}

TEST_F(Folder, OmitsATruncatedFileAndReportsIt) {
    write("a.csv", header + row("taylor", 0.1, 1e-3, 2e-6));
    write("b.csv", std::string(header) + "t,free_asym");
    write("c.csv", "");
    write("provenance.json", "{\"t\": {");
    const ResultFolder folder = read_folder(path, 100);
    EXPECT_EQ(folder.rows.size(), 1u);
    ASSERT_EQ(folder.remarks.size(), 2u);
    EXPECT_NE(folder.remarks[0].find("b.csv is omitted: line 2"), std::string::npos) << folder.remarks[0];
}

TEST_F(Folder, ReadsEachColumnThatATableMayHave) {
    Result result;
    result.scene = "free_asymmetric", result.method = "taylor", result.setting_kind = SettingKind::tolerance;
    result.setting = 0.25, result.status = Status::diverged, result.message = "why", result.cut = true;
    result.formulation = Formulation::full, result.steps = 7, result.counts.rejected_steps = 3;
    result.errors["reaction"].max = 0.125, result.errors["attitude"].max = 0.5, result.floors.float32_final = 2;
    write("t.csv", csv({result_columns(TableKind::systems), {result_row("t", result, TableKind::systems)}}));
    const ResultFolder folder = read_folder(path, 1);
    ASSERT_EQ(folder.rows.size(), 1u);
    const FolderRow& row = folder.rows[0];
    EXPECT_EQ(row.kind, SettingKind::tolerance);
    EXPECT_EQ(row.status, Status::diverged);
    EXPECT_TRUE(row.cut);
    EXPECT_EQ(folder.formulations.names(), std::vector<std::string>{name_of(Formulation::full)});
    const std::map<std::string, double> expected{{"setting", 0.25},
                                                 {"repeats", 0},
                                                 {"steps", 7},
                                                 {"rejected_steps", 3},
                                                 {"reaction_error_max", 0.125},
                                                 {"attitude_error_max", 0.5},
                                                 {"float32_floor_final", 2},
                                                 {"error_over_tolerance", 2}};
    for (const ResultColumn& column : result_column_table())
        if (const auto number = expected.find(column.name); number != expected.end())
            EXPECT_EQ(row[column.name], number->second) << column.name;
        else
            EXPECT_TRUE(std::isnan(row[column.name])) << column.name;
}

TEST_F(Folder, NamesTheCellThatCannotBeRead) {
    write("a.csv", header + row("taylor", 0.1, 1e-3, 2e-6));
    write("b.csv", header + row("taylor", 0.1, 1e-3, 2e-6, "fine"));
    const ResultFolder folder = read_folder(path, 100);
    EXPECT_EQ(folder.rows.size(), 1u);
    EXPECT_EQ(folder.remarks, std::vector<std::string>{"b.csv is omitted: column status: fine is an unknown name."});
}

TEST_F(Folder, KeepsAsManyRowsOfATableAsAreWanted) {
    std::string text = "a\n";
    for (int i = 0; i < 50; ++i) text += std::to_string(i) + "\n";
    write("a.csv", text);
    const ResultFolder folder = read_folder(path, 10);
    EXPECT_EQ(folder.tables[0].table.rows.size(), 10u);
    EXPECT_EQ(folder.tables[0].total, 50u);
}

TEST_F(Folder, RefusesWhatIsNone) {
    EXPECT_THROW(read_folder(path + "/none", 1), InputError);
    EXPECT_THROW(read_folder(path, 1), InputError);
    write("notes.txt", "none");
    EXPECT_THROW(read_folder(path, 1), InputError);
    EXPECT_THROW(read_folder(path + "/notes.txt", 1), InputError);
}

TEST_F(Folder, TakesScenesFromTheirOwnFile) {
    write("t.csv", header + row("taylor", 0.1, 1e-3, 2e-6).replace(2, 15, "mine"));
    EXPECT_TRUE(read_scenes(read_folder(path, 1)).empty());
    write("scenes.json", R"({"mine": "{\"name\": \"mine\", \"duration\": 3, )"
                         R"(\"body\": {\"mass\": 1, \"inertia\": [1, 2, 3]}}", "torn": "{"})");
    const auto scenes = read_scenes(read_folder(path, 1));
    ASSERT_EQ(scenes.size(), 1u);
    EXPECT_EQ(scenes.at("mine").duration, 3);
}

TEST_F(Folder, FindsTheFastestAndWhoIsNext) {
    write("t.csv", header + row("taylor", 0.1, 1e-7, 3e-6) + row("taylor", 0.2, 1e-6, 2e-6) +
                       row("cvode", 0.1, 1e-7, 9e-6) + row("odeint_rk4", 0.1, 1e-2, 1e-7) +
                       row("dop853", 0.1, 1e-9, 1e-7, "failed"));
    const ResultFolder folder = read_folder(path, 1);
    const Fastest best = fastest_within(folder, rows_by_scene(folder)[0], 1e-6);
    ASSERT_TRUE(best.row && best.runner_up);
    EXPECT_EQ(*best.row, 1u);
    EXPECT_EQ(*best.runner_up, 2u);
    EXPECT_FALSE(fastest_within(folder, rows_by_scene(folder)[0], 1e-9).row);
    const std::vector<Finding> findings = make_findings(folder);
    ASSERT_FALSE(findings.empty());
    EXPECT_NE(findings[0].title.find("is the fastest to"), std::string::npos) << findings[0].title;
}

TEST_F(Folder, ReportsEnergiesThatHideALostAttitude) {
    write("t.csv", header + row("article_as_written", 0.1, 3, 1e-6, "ok", 1e-3, 1.5) +
                       row("article_as_written", 0.2, 3, 1e-6, "ok", 0.5, 1.5) + row("taylor", 0.1, 1e-9, 1e-6));
    bool told = false;
    for (const Finding& finding : make_findings(read_folder(path, 1)))
        if (finding.title == "Energy hides a lost attitude in 1 run") {
            told = true;
            EXPECT_NE(finding.text.find("article_as_written on free_asymmetric with a step of 0.1 s"),
                      std::string::npos)
                << finding.text;
        }
    EXPECT_TRUE(told);
}

TEST_F(Folder, FitsOrdersAboveTheFloorAlone) {
    // error = 1e-2 h^4 down to a floor at 1e-12, where it varies irregularly
    std::string text = std::string(header);
    text.replace(text.find("float64_floor"), 13, "float64_floor_final");
    for (int k = 0; k < 14; ++k) {
        const double h = std::pow(0.5, k), error = 1e-2 * std::pow(h, 4);
        text += row("odeint_rk4", h, error > 1e-12 ? error : 1e-12 * (1 + k % 3), 1e-6);
    }
    for (std::size_t at = 0; (at = text.find(",1e-14\n", at)) != std::string::npos;) text.replace(at, 7, ",1e-12\n");
    write("t.csv", text);
    const std::vector<FittedOrder> orders = fit_orders(read_folder(path, 1));
    ASSERT_EQ(orders.size(), 1u);
    ASSERT_TRUE(orders[0].observed);
    EXPECT_NEAR(*orders[0].observed, 4, 1e-3);
    EXPECT_EQ(orders[0].claimed, 4);
}

TEST_F(Folder, HasNoFindingsWhereThereAreNoNumbers) {
    write("t.csv", header);
    EXPECT_TRUE(make_findings(read_folder(path, 1)).empty());
    write("t.csv", std::string(header) + "t,s,m,none,,ok,,,,,,,,,,,,,\n");
    EXPECT_TRUE(make_findings(read_folder(path, 1)).empty());
}

}  // namespace
}  // namespace polhode
