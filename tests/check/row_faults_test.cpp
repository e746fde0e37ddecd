// Diagnoses of rows between an engine's steps and of quaternions that are not normalised.
#include "check/row_faults.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "body/orientation.h"
#include "check/battery.h"
#include "check/diagnosis.h"

namespace polhode {
namespace {

TrajectoryFile steps_of(const Scene& scene, double hertz, int rows) {
    return battery::run<double>(scene, {}, battery::EngineKind::world_rate, 1 / hertz, 1, rows);
}

// Rows of a renderer with `frames` frames per second: the engine's last state, or a state interpolated between two.
TrajectoryFile shown(const TrajectoryFile& steps, double frames, bool interpolated) {
    TrajectoryFile file = steps;
    file.rows.clear();
    const double h = steps.rows[1].t;
    for (int n = 0; n / frames <= steps.rows.back().t - 2 * h; ++n) {
        const double t = n / frames, at = t / h + 1e-9, part = interpolated ? at - std::floor(at) : 0;
        const TrajectoryRow &a = steps.rows[static_cast<std::size_t>(at)],
                            &b = steps.rows[static_cast<std::size_t>(at) + 1];
        TrajectoryRow row = a;
        row.t = t, row.q = slerp(a.q, b.q, part);
        row.angular_velocity_W = a.angular_velocity_W + part * (b.angular_velocity_W - a.angular_velocity_W);
        row.position_W = a.position_W + part * (b.position_W - a.position_W);
        row.velocity_W = a.velocity_W + part * (b.velocity_W - a.velocity_W);
        file.rows.push_back(row);
    }
    return file;
}

std::string describe_faults(const Scene& scene, const TrajectoryFile& file) {
    std::string faults;
    for (const Diagnosis& d : diagnose(scene, file).faults) faults += d.fault + " ";
    return faults;
}

TEST(RowFaults, ReportsRowsBetweenSteps) {
    int seen = 0;
    for (const Scene& scene : battery::scenes()) {
        const TrajectoryFile steps = steps_of(scene, 60, 200);
        EXPECT_TRUE(rows_between_steps(steps).empty()) << scene.name;
        for (const double frames : {144.0, 165.0, 240.0}) {
            EXPECT_EQ(describe_faults(scene, shown(steps, frames, false)), "rows_repeated ") << scene.name << frames;
            EXPECT_EQ(describe_faults(scene, shown(steps, frames, true)), "rows_interpolated ") << scene.name << frames;
            ++seen;
        }
    }
    EXPECT_GE(seen, 30);
}

TEST(RowFaults, LengthsOfQuaternions) {
    const Scene scene = battery::scenes().front();
    TrajectoryFile file = steps_of(scene, 60, 60);
    EXPECT_TRUE(find_length_faults(file).empty());
    // q + (h/2) w q
    for (std::size_t k = 1; k < file.rows.size(); ++k) {
        const Vector3<double> half = (1.0 / 120) * file.rows[k].angular_velocity_W;
        const Quaternion<double> q = file.rows[k - 1].q, change = Quaternion<double>{0, half[0], half[1], half[2]} * q;
        file.rows[k].q = {q.w + change.w, q.x + change.x, q.y + change.y, q.z + change.z};
    }
    const std::vector<Diagnosis> found = find_length_faults(file);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].fault, "quaternion_not_normalised");
    EXPECT_NEAR(found[0].error, norm(file.rows.back().q) - 1, 1e-15);
}

// Normalisation in every n-th row is recognised, however small the deviation is.
TEST(RowFaults, QuaternionsThatAreSeldomNormalised) {
    for (const Scene& scene : battery::scenes())
        for (const double hertz : {60.0, 1000.0})
            for (const int every : {2, 3, 10, 30})
                for (const int substeps : {1, 4}) {
                    battery::Knobs knobs;
                    knobs.first_order = true, knobs.normalised_every = every;
                    const auto kind = battery::EngineKind::world_rate;
                    const auto file = battery::run<double>(scene, knobs, kind, 1 / hertz / substeps, substeps, 120);
                    const std::vector<Diagnosis> found = find_length_faults(file);
                    ASSERT_EQ(found.size(), 1u) << scene.name << hertz << " " << every;
                    EXPECT_EQ(found[0].fault, "quaternion_seldom_normalised");
                    const std::string rows = "only every " + std::to_string(every) + " rows";
                    EXPECT_NE(found[0].message.find(rows), std::string::npos) << found[0].message;
                    // a wrong length in one row breaks the pattern
                    TrajectoryFile other = file;
                    Quaternion<double>& q = other.rows[50].q;
                    q = {1.01 * q.w, 1.01 * q.x, 1.01 * q.y, 1.01 * q.z};
                    EXPECT_TRUE(find_length_faults(other).empty() ||
                                find_length_faults(other)[0].fault != "quaternion_seldom_normalised");
                }
    // rounding to binary32 is not such a pattern
    for (const Scene& scene : battery::scenes())
        EXPECT_TRUE(
            find_length_faults(battery::run<float>(scene, {}, battery::EngineKind::world_rate, 1.0 / 1000, 1, 400))
                .empty())
            << scene.name;
}

}  // namespace
}  // namespace polhode
