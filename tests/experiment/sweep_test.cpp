#include "experiment/sweep.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "experiment/calibration.h"
#include "experiment/report.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

// A directory of its own for tables and for the cache of truths.
class Sweep : public testing::Test {
  protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        directory_ = fs::path(testing::TempDir()) / ("polhode_sweep_" + std::string(test->name()));
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
    // rows without their times
    std::string rows() const {
        Table table{result_columns(), {}};
        for (Result r : finished_results(plan(), options_.directory)) {
            r.seconds_min.reset(), r.seconds_median.reset();
            table.rows.push_back(row_of("t", r));
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
        EXPECT_LT(*r.errors.attitude_max, 0.1);
        EXPECT_GE(*r.errors.attitude_max, *r.errors.attitude_final);
        EXPECT_EQ(r.step_taken.has_value(), r.setting_kind == SettingKind::step);
    }
    // a finer setting is more accurate
    for (std::size_t i = 0; i + 1 < results.size(); i += 2)
        EXPECT_GT(*results[i].errors.attitude_max, *results[i + 1].errors.attitude_max);
}

TEST_F(Sweep, GoesOnWhereItWasInterrupted) {
    const Plan p = plan();
    run_sweep(p, options_);
    const std::string before = rows();
    EXPECT_EQ(run_sweep(p, options_).run, 0);
    const auto files = stored();
    ASSERT_EQ(files.size(), 12U);
    fs::remove(files[3]);
    // a torn file is no finished case
    fs::resize_file(files[7], fs::file_size(files[7]) / 2);
    EXPECT_EQ(pending_cases(p, options_).size(), 2U);
    EXPECT_EQ(run_sweep(p, options_).run, 2);
    EXPECT_EQ(rows(), before);
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
    // other limits, other keys: the same cases to the reader
    const auto again = pending_cases(plan(R"(, "max_steps": 500000)"), options_);
    ASSERT_EQ(again.size(), 12U);
    for (const PendingCase& one : again) EXPECT_GT(one.seconds_before.value_or(0), 0) << one.words;
}

TEST_F(Sweep, ALimitOnEvaluationsCutsByCountAlone) {
    // rk4: 4 a step, 30 steps and 60 on the longer scene
    const Plan p = plan(R"(, "max_evaluations": 130)", R"("odeint_rk4")");
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 4U);
    EXPECT_EQ(results[2].status, Status::ok) << results[2].message;
    EXPECT_EQ(results[2].rhs_evaluations, 120);
    EXPECT_EQ(results[3].status, Status::failed);
    EXPECT_TRUE(results[3].cut);
    EXPECT_FALSE(results[3].errors.attitude_max || results[3].seconds_min);
    EXPECT_NE(results[3].message.find("130"), std::string::npos) << results[3].message;
}

TEST_F(Sweep, LeaveOutRunsEveryCaseByAllFormulations) {
    const Plan p = plan(R"(, "kind": "leave_out")");
    run_sweep(p, options_);
    const std::vector<Result> results = finished_results(p, options_.directory);
    ASSERT_EQ(results.size(), 36U);
    const Table table = gain_table(p, results);
    ASSERT_EQ(table.rows.size(), 6U);  // two scenes; rk4 by step, dopri5 by step and by tolerance
    for (const auto& row : table.rows) {
        EXPECT_GT(std::get<double>(row[column_index(table, "gain")]), 0);
        // 13 variables and 7 take the same steps: the same error where the steps are fixed
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
    const Table growth = growth_table(p, results);
    ASSERT_EQ(growth.rows.size(), 6U);
    // truncation errors of a method that conserves nothing: energy drifts like t, attitude like t^2 in the end
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
    // 3 s at h = 0.1 are 30 steps, at 0.05 60: the limit cuts the second
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
            EXPECT_FALSE(r.errors.attitude_max || r.seconds_min);
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
    write_report(p, finished_results(p, options_.directory), options_.directory, "polhode run t", false);
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

TEST_F(Sweep, DriftExperimentsShareTheirFile) {
    const auto drift = [&](const std::string& name, const std::string& method) {
        const Experiment e =
            parse_experiment(R"({"name": ")" + name + R"(", "kind": "drift", "scenes": ["symmetric"], "methods": [")" +
                                 method + R"("], "settings": {"steps": [0.1]}, "samples": 4,
                                                  "vary": {"/duration": [1]}})",
                             "t.json");
        const Plan p = make_plan(e, "t.json", false);
        run_sweep(p, options_);
        write_report(p, finished_results(p, options_.directory), options_.directory, "polhode run", false);
        std::ifstream file(fs::path(options_.directory) / "drift.csv", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    drift("b", "odeint_rk4");
    const std::string both = drift("a", "odeint_dopri5");
    EXPECT_EQ(drift("b", "odeint_rk4"), both);  // neither twice nor lost
    const Table table = parse_csv(both);
    ASSERT_EQ(table.rows.size(), 10U);
    EXPECT_EQ(text_of(table.rows[0].back()), "a");
    EXPECT_EQ(text_of(table.rows[0][1]), "odeint_dopri5");
    EXPECT_EQ(text_of(table.rows[5].back()), "b");
    EXPECT_EQ(table.columns[4], "attitude_error");
}

TEST(Result, RowsReadBack) {
    Result r;
    r.scene = "a,\"b\"", r.method = "m", r.setting_kind = SettingKind::tolerance, r.setting = 1e-7;
    r.status = Status::tolerance_not_met, r.message = "ends, badly\nindeed";
    r.seconds_min = 0.1, r.steps = 12, r.errors.attitude_max = 1.0 / 3, r.cut = true, r.repeats = 4;
    const Result back = result_of(parse_csv(csv({result_columns(), {row_of("e", r)}})), 0);
    EXPECT_EQ(csv({result_columns(), {row_of("e", back)}}), csv({result_columns(), {row_of("e", r)}}));
    EXPECT_EQ(back.scene, r.scene);
    EXPECT_EQ(back.message, r.message);
    EXPECT_EQ(*back.errors.attitude_max, 1.0 / 3);
}

}  // namespace
}  // namespace polhode
