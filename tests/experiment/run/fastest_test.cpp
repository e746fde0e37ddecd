#include "experiment/run/fastest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace polhode {
namespace {

Result row(const std::string& scene, const std::string& method, double setting, double error, double seconds) {
    Result r;
    r.scene = scene, r.method = method, r.setting_kind = SettingKind::tolerance, r.setting = setting;
    r.status = Status::ok, r.seconds_median = seconds, r.errors["attitude"].max = error;
    return r;
}

std::vector<Result> some_rows() {
    return {
        row("free_asymmetric", "taylor", 1e-4, 1e-5, 12.3e-6),
        row("free_asymmetric", "taylor", 1e-8, 2e-9, 20e-6),
        row("free_asymmetric", "taylor", 1e-12, 1e-13, 4.5e-3),
        row("free_asymmetric", "dop853", 1e-4, 1e-4, 6e-6),
        row("free_asymmetric", "dop853", 1e-8, 1e-7, 25e-6),
        row("a_scene_of_a_name_that_is_far_too_long{/duration=1000}", "cvode_adams", 1e-6, 1e-3, 1.25),
        row("a_scene_of_a_name_that_is_far_too_long{/duration=1000}", "odeint_fehlberg78_projected", 1e-6, 1e-3, 2.5)};
}

TEST(Fastest, IsTheFirstOfTheMethodsThatReachIt) {
    const std::vector<Result> rows = some_rows();
    const auto coarse = sort_by_time(rows, "free_asymmetric", 1e-3);
    ASSERT_EQ(coarse.size(), 2U);
    EXPECT_EQ(coarse[0]->method, "dop853");
    EXPECT_EQ(coarse[1]->seconds_median, 12.3e-6) << "its fastest run, not its finest";
    const auto fine = sort_by_time(rows, "free_asymmetric", 1e-9);
    ASSERT_EQ(fine.size(), 1U);
    EXPECT_EQ(fine[0]->setting, 1e-12);
    EXPECT_TRUE(sort_by_time(rows, "free_asymmetric", 1e-15).empty());
}

TEST(RunTable, IsAligned) {
    EXPECT_EQ(run_table(some_rows(), {100, false}),
              R"(scene                 error (rad)  fastest      setting     time  runner-up                    ratio
free_asymmetric              1e-3  dop853       R 1e-4   6.00 us  taylor                        2.05
                             1e-6  taylor       R 1e-8   20.0 us  dop853                        1.25
                             1e-9  taylor       R 1e-12  4.50 ms
                            1e-12  taylor       R 1e-12  4.50 ms
a_scene_o..ion=1000}         1e-3  cvode_adams  R 1e-6    1.25 s  odeint_fehlberg78_projected   2.00
                             1e-6  none
                             1e-9  none
                            1e-12  none
)");
}

TEST(RunTable, FitsItsWidthAndHasColorsOnRequest) {
    for (const int width : {80, 100, 200}) {
        std::istringstream lines(run_table(some_rows(), {width, false}));
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), static_cast<std::size_t>(width));
    }
    EXPECT_EQ(run_table(some_rows(), {}).find('\x1b'), std::string::npos);
    EXPECT_NE(run_table(some_rows(), {100, true}).find("\x1b[32m"), std::string::npos);
}

TEST(RunTable, IsEmptyWithoutAChoice) {
    EXPECT_EQ(run_table({}, {}), "");
    EXPECT_EQ(run_table({row("symmetric", "taylor", 1e-4, 1e-5, 1)}, {}), "");
    std::vector<Result> untimed = some_rows();
    for (Result& r : untimed) r.seconds_median.reset();
    EXPECT_EQ(run_table(untimed, {}), "");
    std::vector<Result> failed = some_rows();
    for (Result& r : failed) r.status = Status::failed;
    EXPECT_EQ(run_table(failed, {}), "");
}

TEST(PrefixedSeconds, HaveThreeDigits) {
    EXPECT_EQ(format_seconds(12.34e-6), "12.3 us");
    EXPECT_EQ(format_seconds(4.5e-3), "4.50 ms");
    EXPECT_EQ(format_seconds(999.6e-6), "1.00 ms");
    EXPECT_EQ(format_seconds(99.96e-9), "100 ns");
    EXPECT_EQ(format_seconds(1), "1.00 s");
    EXPECT_EQ(format_seconds(7265), "7265 s");
    EXPECT_EQ(format_seconds(0), "0 s");
    EXPECT_EQ(format_seconds(std::nan("")), "-");
}

TEST(Shortened, KeepsBothEnds) {
    EXPECT_EQ(shorten("short", 10), "short");
    EXPECT_EQ(shorten("0123456789abcdef", 10), "0123..cdef");
    EXPECT_EQ(shorten("0123456789abcdef", 11).size(), 11U);
    EXPECT_EQ(shorten("0123456789", 3), "012");
}

}  // namespace
}  // namespace polhode
