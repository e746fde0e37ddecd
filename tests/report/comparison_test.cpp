// Tests the comparison of two directories against numbers computed by hand.
#include "report/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace polhode {
namespace {

TEST(RatioInterval, IsStudentsOfTheLogarithms) {
    // logarithms -0.1, 0.2, 0.1, 0.4, 0.4: mean 0.2, variance 0.045; Student's t of 4 degrees at 97.5 % is 2.776445
    std::vector<std::vector<double>> groups;
    for (const double x : {-0.1, 0.2, 0.1, 0.4, 0.4}) groups.push_back({std::exp(x)});
    const RatioInterval interval = ratio_interval(groups);
    EXPECT_NEAR(interval.ratio, std::exp(0.2), 1e-12);
    const double half = 2.776445 * std::sqrt(0.045 / 5);
    EXPECT_NEAR(*interval.low, std::exp(0.2 - half), 1e-6);
    EXPECT_NEAR(*interval.high, std::exp(0.2 + half), 1e-6);
    EXPECT_EQ(interval.groups, 5);
}

TEST(RatioInterval, TakesEachGroupOnce) {
    // a scene with a thousand runs has the same weight as one with a single run
    const RatioInterval interval = ratio_interval({std::vector<double>(1000, 4.0), {1.0}, {}});
    EXPECT_NEAR(interval.ratio, 2, 1e-12);
    EXPECT_FALSE(interval.low);
    EXPECT_EQ(interval.groups, 2);
}

TEST(RatioInterval, CoversTheTruthAsOftenAsItSays) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal(std::log(1.5), 0.3);
    int covered = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        std::vector<std::vector<double>> groups;
        for (int i = 0; i < 6; ++i) groups.push_back({std::exp(normal(random))});
        const RatioInterval interval = ratio_interval(groups);
        covered += *interval.low <= 1.5 && 1.5 <= *interval.high ? 1 : 0;
    }
    // 95 % of 4000, within four standard deviations
    EXPECT_NEAR(covered, 3800, 4 * std::sqrt(4000 * 0.95 * 0.05));
}

ResultFolder folder_of(const std::vector<std::pair<double, double>>& seconds_and_errors) {
    ResultFolder folder;
    folder.experiments.emplace_back().name = "speed";
    folder.messages.place("");
    for (std::size_t i = 0; i < seconds_and_errors.size(); ++i) {
        FolderRow row;
        row.scene = folder.scenes.place("scene_" + std::to_string(i));
        row.method = folder.methods.place("taylor");
        row.formulation = folder.formulations.place("reduced");
        row.kind = SettingKind::tolerance, row["setting"] = 1e-6;
        row["seconds_median"] = seconds_and_errors[i].first, row["attitude_error_max"] = seconds_and_errors[i].second;
        folder.rows.push_back(row);
    }
    return folder;
}

TEST(Compared, MatchesRowsOfTheSameCase) {
    const ResultFolder here = folder_of({{1, 1e-7}, {2, 1e-8}, {3, 1e-9}, {4, absent}});
    ResultFolder there = folder_of({{2, 1e-7}, {4, 3e-8}, {6, 1e-9}});
    const FolderComparison comparison = compare_folders(here, there);
    EXPECT_EQ(comparison.pairs.size(), 3u);
    EXPECT_EQ(comparison.only_here, 1u);
    EXPECT_EQ(comparison.only_there, 0u);
    EXPECT_EQ(comparison.same_bits, 2u);
    EXPECT_NEAR(comparison.all.ratio, 2, 1e-12);
    ASSERT_EQ(comparison.methods.size(), 1u);
    EXPECT_NEAR(*comparison.methods[0].errors, std::cbrt(3.0), 1e-12);
    // rows with different settings do not match
    there.rows[0]["setting"] = 1e-8;
    EXPECT_EQ(compare_folders(here, there).pairs.size(), 2u);
    EXPECT_EQ(compare_folders(here, there).only_there, 1u);
}

TEST(Compared, ADirectoryEqualsItself) {
    const ResultFolder folder = folder_of({{1, 1e-7}, {2, absent}, {3, 1e-9}, {absent, 2}});
    const FolderComparison comparison = compare_folders(folder, folder);
    EXPECT_EQ(comparison.same_bits, 4u);
    EXPECT_EQ(comparison.all.ratio, 1);
    EXPECT_EQ(*comparison.all.low, 1);
    EXPECT_EQ(*comparison.all.high, 1);
}

}  // namespace
}  // namespace polhode
