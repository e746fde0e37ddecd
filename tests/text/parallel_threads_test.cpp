#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>

#include "experiment/run/locks.h"
#include "experiment/run/sweep.h"
#include "text/parallel.h"

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

// the rows of an experiment do not depend on the number of jobs: covers truths, their cache and all kinds of methods
TEST(SweepThreads, FourJobsGiveTheRowsOfOne) {
    const Plan plan = make_plan(parse_experiment(R"({"name": "t", "scenes": ["free_asymmetric", "lagrange_top"],
                             "methods": ["cvode_adams", "cvode_bdf", "odeint_rk4", "odeint_rosenbrock4",
                                         "article_mended"],
                             "settings": {"steps": [0.01], "tolerances": [1e-6]}, "vary": {"/duration": [0.5, 1]},
                             "samples": 5, "repeats": 1})",
                                                 "t.json"),
                                "t.json", false);
    const auto rows = [&](int jobs) {
        const fs::path directory = fs::path(::testing::TempDir()) / ("polhode_threads_" + std::to_string(jobs));
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
            table.rows.push_back(result_row("t", r));
        }
        fs::remove_all(directory);
        return csv(table);
    };
    const std::string one = rows(1);
    EXPECT_NE(one.find("odeint_rosenbrock4,tolerance,"), std::string::npos) << one;
    EXPECT_EQ(rows(4), one);
}

TEST(FileLock, ManyMayComputeButTimingIsAlone) {
    const std::string path = (fs::path(::testing::TempDir()) / "polhode_lock_test").string();
    const std::atomic<bool> never{false};
    std::atomic<int> computing{0}, timing{0}, together{0}, beside{0};
    parallel_for(40, 4, [&](std::size_t i) {
        if (i % 4 == 0) {
            const FileLock alone(path, FileLock::Kind::exclusive, never);
            if (++timing > 1 || computing > 0) ++beside;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            if (computing > 0) ++beside;
            --timing;
        } else {
            const FileLock shared(path, FileLock::Kind::shared, never);
            if (++computing > 1) ++together;
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            --computing;
        }
    });
    EXPECT_EQ(beside, 0);
    EXPECT_GT(together, 0);
    fs::remove(path);
}

TEST(FileLock, AnInterruptEndsTheWaitAndAMissingDirectoryIsNoObstacle) {
    const std::string path = (fs::path(::testing::TempDir()) / "polhode_lock_test_2").string();
    std::atomic<bool> stop{false};
    const FileLock held(path, FileLock::Kind::exclusive, stop);
    std::jthread interrupting([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        stop = true;
    });
    const FileLock waits(path, FileLock::Kind::exclusive, stop);
    EXPECT_TRUE(stop);
    const std::atomic<bool> never{false};
    const FileLock nowhere("/no/such/directory/lock", FileLock::Kind::exclusive, never);
    fs::remove(path);
}

}  // namespace
}  // namespace polhode
