#include "experiment/run/sweep.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/sweep_tables.h"
#include "experiment/run/calibration.h"
#include "experiment/run/report.h"
#include "experiment/run/run_experiment.h"
#include "integrators/analysis/conditioning.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

// Uses a separate directory for tables and for the cache of truths.
class Sweep : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        directory_ = fs::path(::testing::TempDir()) / ("polhode_sweep_" + std::string(test->name()));
        fs::remove_all(directory_);
        fs::create_directories(directory_);
        setenv("POLHODE_CACHE", (directory_ / "cache").c_str(), 1);
        options_.directory = (directory_ / "results").string();
        options_.quiet = true;
    }
    void TearDown() override { fs::remove_all(directory_); }

    static Plan plan(const std::string& more = "", const std::string& methods = R"("odeint_rk4", "odeint_dopri5")") {
        return make_plan(parse_experiment(R"({"name": "t", "scenes": ["free_asymmetric"], "methods": [)" + methods +
                                              R"(], "settings": {"steps": [0.1, 0.05], "tolerances": [1e-4, 1e-8]},
                                              "vary": {"/duration": [2, 3]}, "samples": 10, "repeats": 3)" +
                                              more + "}",
                                          "t.json"),
                         "t.json", false);
    }
    std::vector<fs::path> stored() const {
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(fs::path(options_.directory) / ".cases"))
            if (entry.path().extension() == ".csv") files.push_back(entry.path());
        return files;
    }
    // the rows without times
    std::string rows() const {
        Table table{result_columns(), {}};
        for (Result r : finished_results(plan(), options_.directory)) {
            r.seconds_min.reset(), r.seconds_median.reset();
            table.rows.push_back(result_row("t", r));
        }
        return csv(table);
    }

    fs::path directory_;
    RunOptions options_;
};

TEST_F(Sweep, HasARowForEveryCase) {
    const Plan p = plan();
    const SweepCount count = run_sweep(p, options_);
    EXPECT_EQ(count.cases, 12);  // two scenes; rk4 at two steps, dopri5 at two steps and two tolerances
    EXPECT_EQ(count.run, 12);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 12U);
    for (const Result& r : results) {
        EXPECT_EQ(r.status, Status::ok) << r.message;
        EXPECT_GT(*r.seconds_min, 0);
        EXPECT_LE(*r.seconds_min, *r.seconds_median);
        EXPECT_EQ(r.repeats, 3);
        EXPECT_GT(*r.rhs_evaluations, *r.steps);
        EXPECT_LT(*r.errors["attitude"].max, 0.1);
        EXPECT_GE(*r.errors["attitude"].max, *r.errors["attitude"].final);
        EXPECT_EQ(r.step_taken.has_value(), r.setting_kind == SettingKind::step);
        EXPECT_GT(*r.floors.float64, 0x1p-53);
    }
    // a finer setting is more accurate
    for (std::size_t i = 0; i + 1 < results.size(); i += 2)
        EXPECT_GT(*results[i].errors["attitude"].max, *results[i + 1].errors["attitude"].max);
}

TEST_F(Sweep, GoesOnWhereItWasInterrupted) {
    const Plan p = plan();
    run_sweep(p, options_);
    const std::string before = rows();
    EXPECT_EQ(run_sweep(p, options_).run, 0);
    const auto files = stored();
    ASSERT_EQ(files.size(), 12U);
    fs::remove(files[3]);
    // a truncated file is not a finished case
    fs::resize_file(files[7], fs::file_size(files[7]) / 2);
    EXPECT_EQ(pending_cases(p, options_).size(), 2U);
    EXPECT_EQ(run_sweep(p, options_).run, 2);
    EXPECT_EQ(rows(), before);
}

TEST_F(Sweep, ReportsACorruptedCaseOnceAndRerunsIt) {
    const Plan p = plan(R"(, "kind": "drift")", R"("odeint_rk4")");
    const long cases = run_sweep(p, options_).run;
    std::vector<std::string> files;
    for (const fs::path& file : stored()) files.push_back(file.string());
    std::sort(files.begin(), files.end());
    ASSERT_EQ(files.size(), 2 * static_cast<std::size_t>(cases));  // rows and series
    for (const std::string& damaged : {files[0], files[1]}) {
        std::fstream file(damaged, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(100);
        const int byte = file.get();
        file.seekp(100);
        file.put(static_cast<char>(byte ^ 1));
        file.close();
        ::testing::internal::CaptureStderr();
        EXPECT_EQ(run_sweep(p, options_).run, 1) << damaged;
        EXPECT_EQ(finished_results(p, options_.directory).size(), static_cast<std::size_t>(cases));
        EXPECT_EQ(::testing::internal::GetCapturedStderr(),
                  "polhode: " + damaged +
                      ": corrupted (wrong checksum); it is treated as missing and recomputed when "
                      "needed\n");
    }
}

TEST_F(Sweep, DoesNotTakeAnotherScenesCase) {
    run_sweep(plan(), options_);
    EXPECT_EQ(pending_cases(plan(R"(, "max_steps": 500000)"), options_).size(), 12U);
}

TEST_F(Sweep, GivesTheSameRowsForAnyNumberOfJobsAndShards) {
    run_sweep(plan(), options_);
    const std::string one = rows();
    options_.directory += "_2";
    options_.jobs = 2;
    run_sweep(plan(), options_);
    EXPECT_EQ(rows(), one);
    options_.directory += "_shards";
    options_.shards = 3;
    for (options_.shard = 1; options_.shard <= 3; ++options_.shard) run_sweep(plan(), options_);
    EXPECT_EQ(rows(), one);
}

TEST_F(Sweep, ADryRunKnowsHowLongACaseTookEvenByAnotherProgram) {
    for (const PendingCase& one : pending_cases(plan(), options_)) EXPECT_FALSE(one.seconds_before);
    run_sweep(plan(), options_);
    // another limit changes the keys but not the descriptions of the cases
    const auto again = pending_cases(plan(R"(, "max_steps": 500000)"), options_);
    ASSERT_EQ(again.size(), 12U);
    for (const PendingCase& one : again) EXPECT_GT(one.seconds_before.value_or(0), 0) << one.description;
}

TEST_F(Sweep, ALimitOnEvaluationsCutsByCountAlone) {
    // rk4 needs 4 evaluations per step; the longer scene takes 30 or 60 steps
    const Plan p = plan(R"(, "max_evaluations": 130)", R"("odeint_rk4")");
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 4U);
    EXPECT_EQ(results[2].status, Status::ok) << results[2].message;
    EXPECT_EQ(results[2].rhs_evaluations, 120);
    EXPECT_EQ(results[3].status, Status::failed);
    EXPECT_TRUE(results[3].cut);
    EXPECT_FALSE(results[3].errors["attitude"].max || results[3].seconds_min);
    EXPECT_NE(results[3].message.find("130"), std::string::npos) << results[3].message;
}

TEST_F(Sweep, LeaveOutRunsEveryCaseByAllFormulations) {
    const Plan p = plan(R"(, "kind": "leave_out")");
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 36U);
    const Table table = gain_table(p, results).table;
    ASSERT_EQ(table.rows.size(), 6U);  // two scenes; rk4 by step, dopri5 by step and by tolerance
    for (const auto& row : table.rows) {
        EXPECT_GT(std::get<double>(row[column_index(table, "gain")]), 0);
        // formulations with 13 and 7 variables have the same error at fixed steps
        if (text_of(row[2]) == "step") {
            EXPECT_NEAR(std::get<double>(row[column_index(table, "error_ratio")]), 1, 1e-6);
        }
        EXPECT_EQ(text_of(row[column_index(table, "left_out")]), "p and v; torque");
    }
}

TEST_F(Sweep, ConservationSpendsTheSameOnEveryMethod) {
    const Experiment e = parse_experiment(
        R"({"name": "t", "kind": "conservation", "scenes": ["symmetric"], "samples": 100, "repeats": 3,
            "methods": ["odeint_rk4", "odeint_dopri5"], "settings": {"evaluations_per_revolution": [90, 300]}})",
        "t.json");
    const Plan p = make_plan(e, "t.json", false);
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 6U);
    for (const Result& r : results) {
        ASSERT_EQ(r.status, Status::ok) << r.message;
        const double spent = static_cast<double>(*r.rhs_evaluations) / (100 / revolution_time(p.scenes[0].scene));
        EXPECT_NEAR(spent / *r.evaluations_per_revolution, 1, 0.1) << r.method;
        EXPECT_NEAR(*r.revolutions, 100 / revolution_time(p.scenes[0].scene), 0.01);  // |w| is constant here
    }
    const Table growth = growth_table(p, results).table;
    ASSERT_EQ(growth.rows.size(), 6U);
    // a method that conserves nothing: the energy error grows as t, the attitude error finally as t^2
    const auto number = [&](std::size_t row, const char* column) {
        return std::get<double>(growth.rows[row][column_index(growth, column)]);
    };
    for (std::size_t row = 0; row < 6; ++row) {
        EXPECT_NEAR(number(row, "energy_exponent"), 1, 0.1);
        EXPECT_GT(number(row, "attitude_exponent"), 0.9);
        EXPECT_LT(number(row, "attitude_exponent"), 2.1);
    }
}

TEST_F(Sweep, AnInducedFailureIsARowAndCutsItsCurveOnly) {
    // 3 s are 30 steps at h = 0.1 and 60 steps at h = 0.05, so the limit cuts the second run
    const Plan p = plan(R"(, "max_steps": 45)");
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 12U);
    long failed = 0, fine = 0;
    for (const Result& r : results) {
        if (r.status == Status::failed) {
            ++failed;
            EXPECT_FALSE(r.message.empty());
            EXPECT_TRUE(r.cut);
            EXPECT_FALSE(r.errors["attitude"].max || r.seconds_min);
        } else {
            ++fine;
            EXPECT_EQ(r.status, Status::ok);
        }
    }
    EXPECT_GE(failed, 2);
    EXPECT_GE(fine, 6);
}

TEST_F(Sweep, FilterTakesSceneAndMethod) {
    options_.filter = "duration=3.*/odeint_rk4$";
    EXPECT_EQ(run_sweep(plan(), options_).cases, 2);
}

TEST_F(Sweep, WritesTablesPicturesAndProvenance) {
    const Plan p = plan(R"(, "kind": "convergence")");
    run_sweep(p, options_);
    write_report(p, conclude(p, finished_results(p, options_.directory)), options_.directory, "polhode run t", false);
    const auto text = [&](const std::string& name) {
        std::ifstream file(fs::path(options_.directory) / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const Table table = parse_csv(text("t.csv"));
    EXPECT_EQ(table.columns, result_columns());
    EXPECT_EQ(table.rows.size(), 12U);
    for (const char* name : {"t.md", "t.tex", "t.json", "t_orders.csv", "t_step.svg", "t_tolerance.pdf"})
        EXPECT_FALSE(text(name).empty()) << name;
    for (const char* key : {"\"compiler\"", "\"flags\"", "\"cpu\"", "\"commit\"", "\"date\"", "\"sundials\"", "\"t\""})
        EXPECT_NE(text("provenance.json").find(key), std::string::npos) << key;
}

TEST_F(Sweep, WritesTheRequestedFormats) {
    const Plan p = plan(R"(, "kind": "convergence")");
    run_sweep(p, options_);
    write_report(p, conclude(p, finished_results(p, options_.directory)), options_.directory, "polhode run t", false,
                 parse_formats("csv,md,svg"));
    std::set<std::string> endings;
    for (const auto& entry : fs::directory_iterator(options_.directory))
        if (entry.is_regular_file() && entry.path().filename().string().starts_with("t"))
            endings.insert(entry.path().extension().string());
    EXPECT_EQ(endings, (std::set<std::string>{".csv", ".md", ".svg"}));
    EXPECT_EQ(parse_formats("svg,md").text(), "md,svg");
    EXPECT_THROW(parse_formats("md,docx"), std::invalid_argument);
    EXPECT_THROW(parse_formats("md,,svg"), std::invalid_argument);
}

TEST_F(Sweep, DriftExperimentsShareTheirFile) {
    const auto drift = [&](const std::string& name, const std::string& method) {
        const Experiment e =
            parse_experiment(R"({"name": ")" + name + R"(", "kind": "drift", "scenes": ["symmetric"], "methods": [")" +
                                 method + R"("], "settings": {"steps": [0.1]}, "samples": 4,
                                                  "vary": {"/duration": [1]}})",
                             "t.json");
        const Plan p = make_plan(e, "t.json", false);
        run_sweep(p, options_);
        write_report(p, conclude(p, finished_results(p, options_.directory)), options_.directory, "polhode run", false);
        std::ifstream file(fs::path(options_.directory) / "drift.csv", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    drift("b", "odeint_rk4");
    const std::string both = drift("a", "odeint_dopri5");
    EXPECT_EQ(drift("b", "odeint_rk4"), both);  // rows are neither repeated nor lost
    const Table table = parse_csv(both);
    ASSERT_EQ(table.rows.size(), 10U);
    EXPECT_EQ(text_of(table.rows[0].back()), "a");
    EXPECT_EQ(text_of(table.rows[0][1]), "odeint_dopri5");
    EXPECT_EQ(text_of(table.rows[5].back()), "b");
    EXPECT_EQ(table.columns[4], "attitude_error");
}

// every row has the floors of its scene, including rows of failed and unsupported runs and of cut curves
TEST_F(Sweep, RowsCarryTheFloorsOfTheirScene) {
    const Plan p = make_plan(parse_experiment(R"({"name": "t", "scenes": ["dzhanibekov"], "vary": {"/duration": [5, 9]},
                                                   "methods": ["odeint_rk4", "odeint_euler"],
                                                   "settings": {"steps": [0.1, 0.01]}, "samples": 10, "repeats": 1,
                                                   "max_steps": 300})",
                                              "t.json"),
                             "t.json", false);
    options_.jobs = 2;
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 8U);
    int cut = 0;
    for (const Result& r : results) {
        cut += r.cut;
        Scene scene = p.scenes[r.scene == p.scenes[0].label ? 0 : 1].scene;
        std::vector<double> times;
        for (int k = 0; k <= 10; ++k) times.push_back(sample_time(scene.duration, k, 10));
        const Conditioning c = conditioning(scene, times);
        EXPECT_EQ(r.floors.float64, c.floor_peak(float64_roundoff).value);
        EXPECT_EQ(r.floors.float32, c.floor_peak(float32_roundoff).value);
        EXPECT_EQ(r.floors.float64_final, c.floor(10, float64_roundoff));
        EXPECT_EQ(r.floors.float32_final, c.floor(10, float32_roundoff));
        EXPECT_GE(*r.floors.float64, *r.floors.float64_final);
    }
    EXPECT_GE(cut, 4);
}

TEST_F(Sweep, DriftContainsTheFloorOverTime) {
    const Plan p = plan(R"(, "kind": "drift")");
    run_sweep(p, options_);
    for (const Result& r : finished_results(p, options_.directory)) {
        ASSERT_EQ(r.series.float64_floor.size(), 11U);
        EXPECT_NEAR(r.series.float64_floor[0], 0x1p-53, 1e-20);
        EXPECT_EQ(r.series.float64_floor.back(), *r.floors.float64_final);
    }
    const std::vector<NamedFigure> figures = drift_figures(p, finished_results(p, options_.directory));
    ASSERT_EQ(figures.size(), 2U);
    const std::vector<Panel>& panels = figures[0].figure.panels;
    ASSERT_EQ(panels[0].guides.size(), 2U);
    EXPECT_EQ(panels[0].guides[0].label, "float64 floor");
    EXPECT_EQ(panels[0].guides[1].y[3], panels[0].guides[0].y[3] * 0x1p29);
    EXPECT_TRUE(panels[1].guides.empty());
}

TEST_F(Sweep, PicturesHaveTheFloorsThatBelongToThem) {
    const Plan p = plan();
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    const Floors& floors = results[0].floors;
    const auto guides = [&](const std::vector<NamedFigure>& figures) {
        return figures.at(0).figure.panels.at(0).guides;
    };
    ASSERT_EQ(guides(work_precision_figures(p, results)).size(), 2U);
    EXPECT_EQ(guides(work_precision_figures(p, results))[0].y[0], *floors.float64);
    EXPECT_EQ(guides(tolerance_figures(p, results))[1].y[0], *floors.float32);
    EXPECT_EQ(guides(convergence_figures(p, results))[0].y[0], *floors.float64_final);
}

// the standard columns, on which users depend, come first and in this order; later columns are found by name
TEST(Result, HasTheContractsColumnsFirst) {
    const std::vector<std::string> standard{"experiment",
                                            "scene",
                                            "method",
                                            "setting_kind",
                                            "setting",
                                            "status",
                                            "seconds_min",
                                            "seconds_median",
                                            "repeats",
                                            "steps",
                                            "rhs_evaluations",
                                            "attitude_error_final",
                                            "attitude_error_max",
                                            "omega_error_max",
                                            "energy_error_max",
                                            "momentum_error_max",
                                            "norm_error_max",
                                            "message"};
    const std::vector<std::string> columns = result_columns();
    ASSERT_GT(columns.size(), standard.size());
    EXPECT_TRUE(std::equal(standard.begin(), standard.end(), columns.begin()));
    for (const char* floor : {"float64_floor", "float32_floor", "float64_floor_final", "float32_floor_final"})
        EXPECT_EQ(std::count(columns.begin() + static_cast<long>(standard.size()), columns.end(), floor), 1) << floor;
}

TEST_F(Sweep, ReportsTheExpectedErrorOfAnInaccurateRun) {
    // a long unstable spin: errors grow by a factor of e in about a second
    const Plan p = make_plan(parse_experiment(R"({"name": "t", "scenes": ["dzhanibekov"], "vary": {"/duration": [60]},
                                                   "methods": ["odeint_dopri5"], "settings": {"tolerances": [1e-2]},
                                                   "samples": 4, "repeats": 1})",
                                              "t.json"),
                             "t.json", false);
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 1U);
    const Result& r = results.front();
    ASSERT_EQ(r.status, Status::tolerance_not_met) << r.message;
    const Scene& scene = p.scenes.front().scene;
    const double kappa = conditioning(scene, {scene.duration}).attitude.front();
    EXPECT_NE(r.message.find(fmt::format("; kappa(T) times the tolerance is {:.2g}", kappa * 1e-2)), std::string::npos)
        << r.message << " " << kappa;
    EXPECT_TRUE(r.counts.rejected_steps.has_value());
}

TEST(Result, ContainsSolverCountsAndErrorOverTolerance) {
    Result r;
    r.scene = "s", r.method = "m", r.setting_kind = SettingKind::tolerance, r.setting = 0.25;
    r.counts = {12, 3, std::nullopt}, r.errors["attitude"].max = 1.25;
    Table row{result_columns(), {result_row("e", r)}};
    EXPECT_EQ(text_of(row.rows[0][column_index(row, "error_over_tolerance")]), "5");
    const Result back = parse_result(parse_csv(csv(row)), 0);
    EXPECT_EQ(back.counts.rejected_steps, 12);
    EXPECT_EQ(back.counts.newton_failures, 3);
    EXPECT_FALSE(back.counts.order_reductions.has_value());
    // a run by step has no tolerance
    r.setting_kind = SettingKind::step;
    row.rows = {result_row("e", r)};
    EXPECT_EQ(text_of(row.rows[0][column_index(row, "error_over_tolerance")]), "");
    // older rows have no counts
    row.columns.resize(row.columns.size() - 4), row.rows[0].resize(row.columns.size());
    EXPECT_FALSE(parse_result(row, 0).counts.rejected_steps.has_value());
}

TEST(Result, RowsFromBeforeTheFloorsReadBack) {
    Result r;
    r.scene = "s", r.method = "m", r.floors.float64 = 1e-13, r.series.t = {0, 1}, r.series["attitude"] = {0, 0.5};
    r.series.float64_floor = {1e-16, 2e-16};
    Table row{result_columns(), {result_row("e", r)}}, series = series_table(r.series);
    EXPECT_EQ(parse_result(row, 0).floors.float64, 1e-13);
    EXPECT_EQ(parse_series(series).float64_floor, r.series.float64_floor);
    while (row.columns.back() != "revolutions") row.columns.pop_back(), row.rows[0].pop_back();
    ASSERT_EQ(row.columns.back(), "revolutions");
    EXPECT_FALSE(parse_result(row, 0).floors.float64.has_value());
    EXPECT_EQ(parse_result(row, 0).method, "m");
    series.columns.pop_back();
    for (auto& line : series.rows) line.pop_back();
    EXPECT_TRUE(parse_series(series).float64_floor.empty());
    EXPECT_EQ(parse_series(series)["attitude"], r.series["attitude"]);
}

TEST(Result, RowsReadBack) {
    Result r;
    r.scene = "a,\"b\"", r.method = "m", r.setting_kind = SettingKind::tolerance, r.setting = 1e-7;
    r.status = Status::tolerance_not_met, r.message = "ends, badly\nindeed";
    r.seconds_min = 0.1, r.steps = 12, r.errors["attitude"].max = 1.0 / 3, r.cut = true, r.repeats = 4;
    const Result back = parse_result(parse_csv(csv({result_columns(), {result_row("e", r)}})), 0);
    EXPECT_EQ(csv({result_columns(), {result_row("e", back)}}), csv({result_columns(), {result_row("e", r)}}));
    EXPECT_EQ(back.scene, r.scene);
    EXPECT_EQ(back.message, r.message);
    EXPECT_EQ(*back.errors["attitude"].max, 1.0 / 3);
}

}  // namespace
}  // namespace polhode
