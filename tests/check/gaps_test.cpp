// Rows with NaN, and errors over time compared with the errors of compute_file_errors().
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "check/check_files.h"
#include "check/error_over_time.h"
#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "motion/foreign_columns.h"
#include "scene/scene_file.h"
#include "text/json_document.h"

namespace polhode {
namespace {

struct GappedFile {
    std::vector<double> times;
    std::vector<std::size_t> gaps;
};
GappedFile read_with_gaps(const std::string& text, const ForeignColumns& columns = {}) {
    GappedFile read;
    for (const TrajectoryRow& row :
         parse_foreign_trajectory(text, "f.csv", columns, QuaternionColumns::by_name, {}, &read.gaps).rows)
        read.times.push_back(row.t);
    return read;
}

TEST(Gaps, LeaveOutRowsThatAreNotANumber) {
    const GappedFile file =
        read_with_gaps("t,qw,qx,qy,qz\n0,nan,0,0,0\n1,1,0,0,0\n2,1,0,NaN,0\n3,-nan,0,0,0\n4,1,0,0,0\n5,1,0,0,0\n");
    EXPECT_EQ(file.times, (std::vector<double>{1, 4, 5}));
    EXPECT_EQ(file.gaps, (std::vector<std::size_t>{1}));
}

TEST(Gaps, LeaveOutAllBodiesAtATime) {
    const GappedFile file = read_with_gaps(
        "t,body,qw,qx,qy,qz\n0,a,1,0,0,0\n0,b,1,0,0,0\n1,a,1,0,0,0\n1,b,nan,0,0,0\n2,a,1,0,0,0\n2,b,1,0,0,0\n");
    EXPECT_EQ(file.times, (std::vector<double>{0, 0, 2, 2}));
    EXPECT_EQ(file.gaps, (std::vector<std::size_t>{1}));
}

TEST(Gaps, AreOfTheColumnsThatAreRead) {
    const std::string text = "t,note,qw,qx,qy,qz\n0,nan,1,0,0,0\n1,,nan,0,0,0\n2,nan,1,0,0,0\n";
    const GappedFile file = read_with_gaps(text, {{{"t", 0}, {"qw", 2}, {"qx", 3}, {"qy", 4}, {"qz", 5}}});
    EXPECT_EQ(file.times, (std::vector<double>{0, 2}));
    EXPECT_EQ(file.gaps, (std::vector<std::size_t>{1}));
}

TEST(Gaps, LeaveOtherFaultsToTheReader) {
    for (const char* text : {"", "t,qw\n", "a,b\nnan,1\n", "t,nanny\n0,inf\n", "t,qw,qx,qy,qz\n0,inf,0,0,0\n"})
        EXPECT_THROW(read_with_gaps(text), InputError) << text;
    EXPECT_TRUE(read_with_gaps("t,qw,qx,qy,qz\n0,1,0,0,0").gaps.empty());
    EXPECT_THROW(parse_trajectory("t,qw,qx,qy,qz\n0,nan,0,0,0\n", "f.csv"), InputError);
}

// The last row may have a NaN and no line feed.
TEST(Gaps, EndWithTheText) {
    const GappedFile file = read_with_gaps("t,qw,qx,qy,qz\n0,1,0,0,0\n1,nan,0,0,0");
    EXPECT_EQ(file.times, (std::vector<double>{0}));
    EXPECT_TRUE(file.gaps.empty());
}

TrajectoryFile solved(const Scene& scene, long samples) {
    Settings settings;
    settings.samples = samples, settings.step = scene.duration / static_cast<double>(samples);
    const Trajectory run = solve(scene, *find_method("odeint_rk4"), settings);
    return parse_trajectory(trajectory_csv(run, body_names(scene)), "run.csv", QuaternionColumns::by_name,
                            body_names(scene));
}

// Few rows are computed in 128 bits, many in binary64.
TEST(ErrorOverTime, HasTheLargestThatTheJudgeFinds) {
    const Scene scene = find_scene("free_asymmetric");
    for (const long samples : {500L, 5000L}) {
        const TrajectoryFile file = solved(scene, samples);
        std::vector<double> times;
        for (const TrajectoryRow& row : file.rows) times.push_back(row.t);
        const FileErrors file_errors = compute_file_errors(scene, file, reference(scene, times));
        for (const char* measure : {"attitude", "omega", "energy", "momentum"}) {
            const ErrorOverTime errors = error_over_time(scene, file, measure, "run.csv");
            ASSERT_EQ(errors.fault, "");
            ASSERT_EQ(errors.error.size(), file.rows.size());
            const double largest = std::ranges::max(errors.error);
            EXPECT_NEAR(largest, file_errors[measure]->max, 1e-6 * largest + 2e-15) << measure;
            EXPECT_NEAR(errors.error.back(), file_errors[measure]->final, 1e-6 * largest + 2e-15) << measure;
        }
    }
}

TEST(ErrorOverTime, OfSeveralBodiesIsTheWorstOnes) {
    const Scene scene = find_scene("mechanisms/double_pendulum");
    Settings settings;
    settings.samples = 50, settings.step = scene.duration / 2000;
    const Trajectory run = solve(scene, *find_method("odeint_rk4"), settings);
    ASSERT_EQ(run.status, Status::ok) << run.message;
    const TrajectoryFile file = parse_trajectory(trajectory_csv(run, body_names(scene)), "run.csv",
                                                 QuaternionColumns::by_name, body_names(scene));
    std::vector<double> times;
    for (std::size_t k = 0; k < file.rows.size(); k += file.bodies_at_once()) times.push_back(file.rows[k].t);
    const FileErrors file_errors = compute_file_errors(scene, file, reference(scene, times));
    const ErrorOverTime errors = error_over_time(scene, file, "attitude", "run.csv");
    EXPECT_EQ(errors.error.size(), 51U);
    EXPECT_EQ(std::ranges::max(errors.error), file_errors["attitude"]->max);
}

TEST(ErrorOverTime, RefusesWhatTheFileDoesNotTell) {
    const Scene scene = find_scene("free_asymmetric");
    TrajectoryFile file = solved(scene, 10);
    file.has_angular_velocity = false;
    EXPECT_NO_THROW(error_over_time(scene, file, "attitude", "run.csv"));
    for (const char* measure : {"omega", "energy", "momentum"})
        EXPECT_THROW(error_over_time(scene, file, measure, "run.csv"), InputError) << measure;
    file.has_angular_velocity = true, file.has_velocity = false;
    EXPECT_NO_THROW(error_over_time(scene, file, "momentum", "run.csv"));
    EXPECT_THROW(error_over_time(scene, file, "energy", "run.csv"), InputError);
}

}  // namespace
}  // namespace polhode
