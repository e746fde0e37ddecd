#include "check/file_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "measure/errors.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

Scene thrown_body() {
    Scene scene;
    scene.name = "thrown", scene.duration = 10;
    scene.body = {2, diagonal(Vector3<double>(1, 2, 2.5)), {0.1, 0.2, 0.3}};
    scene.loads.push_back(Gravity{{0, 0, -9.8}, {}});
    return scene;
}

// A truth that rotates about z at 2 rad/s while it falls, and a file with a growing error.
struct Case {
    Scene scene = thrown_body();
    Reference truth;
    TrajectoryFile file;

    explicit Case(int count) {
        truth.available = true;
        file.has_angular_velocity = file.has_position = file.has_velocity = true;
        const ExactBody<double> body = exact_body<double>(scene);
        for (int k = 0; k <= count; ++k) {
            const double t = 10.0 * k / count, off = 1e-5 * t * std::sin(3 * t);
            ReferenceSample s;
            const Quaternion<double> q{std::cos(t), 0, 0, std::sin(t)};
            const Vector3<double> w{0, 0, 2}, p{t, 0, 50 - 4.9 * t * t}, v{1, 0, -9.8 * t};
            const Invariants<double> exact_values = invariants(scene, body, t, q, w, p, v);
            s.t = t, s.q = {q.w, q.x, q.y, q.z}, s.energy = exact_values.energy;
            for (int i = 0; i < 3; ++i) {
                s.angular_velocity_B[i] = w[i], s.position_W[i] = p[i], s.velocity_W[i] = v[i];
                s.angular_momentum_W[i] = exact_values.angular_momentum_W[i];
            }
            truth.samples.push_back(s);
            const double size = 1 + off;
            file.rows.push_back({t,
                                 {size * std::cos(t + off / 2), 0, 0, size * std::sin(t + off / 2)},
                                 {3 * off, 0, 2 - off},
                                 {t + off, 0, p[2]},
                                 {1, off, v[2]}});
        }
    }
};

// Compares with the errors of the result tables, which are computed independently.
TEST(FileErrorAccumulator, AgreesWithTheErrorsOfTheTables) {
    const Case c(200);
    const FileErrors found = compute_file_errors(c.scene, c.file, c.truth);
    Trajectory trajectory;
    trajectory.samples = samples_of(c.file, c.scene.body.center_of_mass);
    const ErrorSeries series = error_series(c.scene, trajectory, c.truth);
    const auto expect = [&](const ErrorSummary& summary, const std::vector<double>& values) {
        const auto worst = std::max_element(values.begin(), values.end());
        // compute_file_errors() rotates the file's w in 128 bits; the tables round it to binary64
        EXPECT_NEAR(summary.max, *worst, 1e-15);
        EXPECT_EQ(summary.max_time, series.t[static_cast<std::size_t>(worst - values.begin())]);
        EXPECT_NEAR(summary.final, values.back(), 1e-15);
    };
    expect(*found["attitude"], series["attitude"]);
    expect(*found["norm"], series["norm"]);
    expect(*found["omega"], series["omega"]);
    expect(*found["energy"], series["energy"]);
    expect(*found["momentum"], series["momentum"]);
    EXPECT_NEAR(found["velocity"]->max, 1e-5 * 10, 1e-5);
    // ten spans of twenty samples; the first one also has the sample at its start
    ASSERT_EQ(found.over_time.size(), 10u);
    for (std::size_t span = 0; span < 10; ++span) {
        const auto begin = series["attitude"].begin() + static_cast<long>(span == 0 ? 0 : 20 * span + 1);
        EXPECT_NEAR(found.over_time[span].error["attitude"],
                    *std::max_element(begin, series["attitude"].begin() + static_cast<long>(20 * span + 21)), 1e-15);
        EXPECT_DOUBLE_EQ(found.over_time[span].until, static_cast<double>(span + 1));
    }
}

TEST(FileErrorAccumulator, InBinary64AndInPiecesIsTheSameToRounding) {
    const Case c(5000);
    const FileErrors wide = compute_file_errors(c.scene, c.file, c.truth),
                     narrow = compute_file_errors(c.scene, c.file, c.truth, ErrorArithmetic::binary64);
    std::vector<FileErrorAccumulator> pieces;
    for (std::size_t i = 0; i < 7; ++i) {
        const std::size_t begin = 5001 * i / 7, end = 5001 * (i + 1) / 7;
        pieces.emplace_back(c.scene, c.file, ErrorArithmetic::binary64);
        pieces.back().add(begin, std::span(c.truth.samples).subspan(begin, end - begin));
    }
    for (std::size_t i = 1; i < 7; ++i) pieces[0].append(pieces[i]);
    const FileErrors joined = pieces[0].result();
    const auto all = [](const FileErrors& j) {
        std::vector<ErrorSummary> every;
        for (const char* name : {"attitude", "norm", "omega", "energy", "momentum", "position", "velocity"})
            every.push_back(j[name].value());
        return every;
    };
    for (std::size_t i = 0; i < 7; ++i) {
        // pieces give the same bits
        EXPECT_EQ(all(joined)[i].max, all(narrow)[i].max) << i;
        EXPECT_EQ(all(joined)[i].max_time, all(narrow)[i].max_time) << i;
        EXPECT_EQ(all(joined)[i].final, all(narrow)[i].final) << i;
        // positions of 500 m are rounded to 6e-14 m
        const double resolution = i < 5 ? 1e-15 : 1e-13;
        EXPECT_NEAR(all(narrow)[i].max, all(wide)[i].max, resolution) << i;
        EXPECT_NEAR(all(narrow)[i].final, all(wide)[i].final, resolution) << i;
    }
    ASSERT_EQ(joined.over_time.size(), narrow.over_time.size());
    for (std::size_t k = 0; k < joined.over_time.size(); ++k) {
        EXPECT_EQ(joined.over_time[k].error["attitude"], narrow.over_time[k].error["attitude"]);
        EXPECT_EQ(joined.over_time[k].until, narrow.over_time[k].until);
    }
}

TEST(FileErrorAccumulator, RefusesOtherTimes) {
    Case c(10);
    c.truth.samples[3].t += 1e-9;
    EXPECT_THROW(compute_file_errors(c.scene, c.file, c.truth), std::invalid_argument);
    c.truth.samples.pop_back();
    EXPECT_THROW(compute_file_errors(c.scene, c.file, c.truth), std::invalid_argument);
}

TEST(FileErrorAccumulator, OneSampleIsOneSpan) {
    Case c(10);
    c.file.rows = {c.file.rows[4]}, c.truth.samples = {c.truth.samples[4]};
    const FileErrors found = compute_file_errors(c.scene, c.file, c.truth);
    EXPECT_EQ(found.over_time.size(), 1u);
    EXPECT_EQ(found["attitude"]->max_time, 4);
}

}  // namespace
}  // namespace polhode
