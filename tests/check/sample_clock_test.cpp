#include "check/sample_clock.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>

namespace polhode {
namespace {

TrajectoryFile file_at(const std::vector<double>& times) {
    TrajectoryFile file;
    for (const double t : times) file.rows.push_back({t, {}, {}, {}, {}});
    return file;
}

// The grid is restored from any first sample on.
RC_GTEST_PROP(SampleClock, RestoresGridsThatWereRounded, ()) {
    const double duration = *rc::gen::element(1.0, 4.0, 20.0, 100.0);
    const long steps = *rc::gen::inRange<long>(50, 5000);
    const long first = *rc::gen::inRange<long>(0, 20), count = *rc::gen::inRange<long>(20, steps - 20);
    const bool nine_digits = *rc::gen::arbitrary<bool>();
    std::vector<double> grid, rounded;
    double largest = 0;
    for (long k = first; k < first + count; ++k) {
        const double t = sample_time(duration, k, steps);
        const float narrow = static_cast<float>(t);
        grid.push_back(t);
        rounded.push_back(nine_digits ? std::strtod(fmt::format("{:.9g}", narrow).c_str(), nullptr)
                                      : static_cast<double>(narrow));
        if (t > 0) largest = std::max(largest, std::abs(rounded.back() - t) / t);
    }
    TrajectoryFile file = file_at(rounded);
    const std::optional<double> dt = restore_clock(file, duration);
    if (largest == 0) {
        RC_ASSERT(!dt.has_value());
        return;
    }
    RC_ASSERT(dt.has_value());
    for (std::size_t k = 0; k < grid.size(); ++k) RC_ASSERT(std::abs(file.rows[k].t - grid[k]) <= 1e-9 * grid[k]);
}

TEST(SampleClock, ARoundStepIsFoundToTheBit) {
    std::vector<double> times;
    for (int k = 0; k <= 500; ++k) times.push_back(static_cast<double>(static_cast<float>(k / 60.0)));
    TrajectoryFile file = file_at(times);
    EXPECT_EQ(restore_clock(file, 100), 1.0 / 60);
    for (int k = 0; k <= 500; ++k) EXPECT_DOUBLE_EQ(file.rows[static_cast<std::size_t>(k)].t, k / 60.0);
}

TEST(SampleClock, LeavesOtherClocksAlone) {
    std::vector<double> doubles, adding, uneven;
    double sum = 0;
    float narrow_sum = 0;
    std::vector<double> narrow_adding;
    for (int k = 0; k <= 1000; ++k) {
        doubles.push_back(k * 0.01), adding.push_back(sum), uneven.push_back(k * k * 0.01);
        narrow_adding.push_back(static_cast<double>(narrow_sum));
        sum += 0.01, narrow_sum += 0.01f;
    }
    // steps that are not simple numbers, with all digits or printed with twelve digits
    std::vector<double> odd_rate, odd_printed;
    for (int k = 0; k <= 473; ++k) {
        odd_rate.push_back(k / 47.3);
        odd_printed.push_back(std::strtod(fmt::format("{:.12g}", k / 47.3).c_str(), nullptr));
    }
    for (const std::vector<double>& times :
         {doubles, adding, uneven, narrow_adding, odd_rate, odd_printed, {0.0, 1.0}, {3.0}}) {
        TrajectoryFile file = file_at(times);
        EXPECT_FALSE(restore_clock(file, 10).has_value());
        EXPECT_EQ(file, file_at(times));
    }
}

}  // namespace
}  // namespace polhode
