#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <string>

#include "experiment/parallel.h"
#include "experiment/report.h"
#include "experiment/sweep.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

TEST(ParallelFor, CallsEachIndexOnce) {
    for (const int jobs : {-1, 1, 2, 7, 64}) {
        std::vector<int> calls(1000, 0);
        parallel_for(calls.size(), jobs, [&](std::size_t i) { ++calls[i]; });
        EXPECT_EQ(calls, std::vector<int>(1000, 1)) << jobs << " jobs";
    }
    parallel_for(0, 4, [](std::size_t) { FAIL() << "there is no index"; });
}

TEST(ParallelFor, ThrowsTheFirstExceptionOnceAllThreadsHaveStopped) {
    for (const int jobs : {1, 4}) {
        std::atomic<int> inside{0};
        EXPECT_THROW(parallel_for(100, jobs,
                                  [&](std::size_t i) {
                                      ++inside;
                                      if (i == 10) {
                                          --inside;
                                          throw std::runtime_error("the tenth");
                                      }
                                      --inside;
                                  }),
                     std::runtime_error);
        EXPECT_EQ(inside, 0);
    }
}

TEST(ParallelFor, SumsAsOneThreadDoes) {
    std::vector<double> squares(10000);
    parallel_for(squares.size(), 8, [&](std::size_t i) { squares[i] = static_cast<double>(i * i); });
    // sum of i^2, i < n: (n - 1) n (2 n - 1) / 6, below 2^53
    EXPECT_EQ(std::accumulate(squares.begin(), squares.end(), 0.0), 9999.0 * 10000 * 19999 / 6);
}

// truths, their cache and the errors of every kind of method, on threads
TEST(SweepThreads, FourJobsGiveTheRowsOfOne) {
    const Plan plan = make_plan(parse_experiment(R"({"name": "t", "scenes": ["free_asymmetric", "lagrange_top"],
                             "methods": ["cvode_adams", "cvode_bdf", "odeint_rk4", "odeint_rosenbrock4",
                                         "article_mended"],
                             "settings": {"steps": [0.01], "tolerances": [1e-6]}, "vary": {"/duration": [0.5, 1]},
                             "samples": 5, "repeats": 1})",
                                                 "t.json"),
                                "t.json", false);
    const auto rows = [&](int jobs) {
        const fs::path directory = fs::path(testing::TempDir()) / ("polhode_threads_" + std::to_string(jobs));
        fs::remove_all(directory);
        fs::create_directories(directory);
        setenv("POLHODE_CACHE", (directory / "cache").c_str(), 1);
        RunOptions options;
        options.directory = (directory / "results").string();
        options.jobs = jobs;
        options.quiet = true;
        run_sweep(plan, options);
        Table table{result_columns(), {}};
        for (Result r : finished_results(plan, options.directory)) {
            r.seconds_min.reset(), r.seconds_median.reset();
            table.rows.push_back(row_of("t", r));
        }
        fs::remove_all(directory);
        return csv(table);
    };
    const std::string one = rows(1);
    EXPECT_NE(one.find("odeint_rosenbrock4,tolerance,"), std::string::npos) << one;
    EXPECT_EQ(rows(4), one);
}

}  // namespace
}  // namespace polhode
