// Runs of methods for mechanisms, compared with the motion, and their errors.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/method.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode::multibody_cases {

inline Scene mechanism(const std::string& name, double duration) {
    Scene scene = find_scene("mechanisms/" + name);
    scene.duration = duration;
    return scene;
}

inline Trajectory stepped(const Problem& problem, const std::string& method, double step, long samples = 10) {
    Settings settings;
    settings.step = step, settings.samples = samples;
    return solve(problem, *find_method(method), settings);
}

inline std::vector<BodyMotion<double>> motions_of(const Bodies& bodies) {
    std::vector<BodyMotion<double>> motions;
    for (const Sample& s : bodies)
        motions.push_back({normalized(s.q), s.angular_velocity_B, s.position_W, s.velocity_W});
    return motions;
}

/// The largest error of a position at eight samples, m, of a scene whose events dop853 locates.
inline double position_error(const Problem& problem, const std::string& method, double step) {
    Settings settings;
    settings.tolerance = 1e-11, settings.samples = 8;
    const Trajectory exact = solve(problem, *find_method("dop853"), settings), run = stepped(problem, method, step, 8);
    EXPECT_EQ(exact.status, Status::ok) << exact.message;
    EXPECT_EQ(run.status, Status::ok) << method << ": " << run.message;
    double largest = 0;
    for (std::size_t i = 0; i < std::min(run.samples.size(), exact.samples.size()); ++i)
        largest = std::max(largest, length(run.samples[i].position_W - exact.samples[i].position_W));
    return largest;
}

/// The order of position_error() from steps of duration / steps and a quarter of it. `allowed`: of the longer step.
inline double position_order(const Problem& problem, const std::string& method, double steps, double allowed) {
    const double coarse = position_error(problem, method, problem.scene.duration / steps),
                 fine = position_error(problem, method, problem.scene.duration / (4 * steps));
    EXPECT_LT(coarse, allowed) << method << " on " << problem.scene.name;
    return std::log(coarse / fine) / std::log(4);
}

/// The largest errors over all bodies and samples.
struct Off {
    double attitude = 0;  ///< rad
    double gap = 0;       ///< m
    double turn = 0;      ///< rad, angle between a joint's axes
    double energy = 0;    ///< relative to the largest kinetic energy or energy
};

/// A scene with its motion computed by dop853 in joint coordinates at a tolerance of 1e-12.
class Case {
  public:
    explicit Case(const Scene& scene, long samples = 10)
        : problem(pose(scene)), samples_(samples), measure_(problem.scene) {
        Settings settings;
        settings.tolerance = 1e-12, settings.samples = samples;
        motion_ = solve(problem, *find_method("dop853"), settings);
        EXPECT_EQ(motion_.status, Status::ok) << motion_.message;
    }

    Trajectory run(const std::string& method, double step) const { return stepped(problem, method, step, samples_); }
    Off off(const std::string& method, double step) const {
        const Trajectory trajectory = run(method, step);
        EXPECT_EQ(trajectory.status, Status::ok) << method << ": " << trajectory.message;
        return off(trajectory);
    }
    Off off(const Trajectory& trajectory) const {
        Off largest;
        JointCoordinates near_run(problem.scene), near_motion(problem.scene);
        double scale = 0;
        for (std::size_t k = 0; k < trajectory.moments(); ++k) {
            const auto run = motions_of(trajectory.at(k)), truth = motions_of(motion_.at(k));
            for (std::size_t b = 0; b < run.size(); ++b) {
                const Quaternion<double> gap = conjugate(truth[b].q) * run[b].q;
                largest.attitude =
                    std::max(largest.attitude, 2 * std::atan2(length(vector_part(gap)), std::abs(gap.w)));
            }
            const JointViolations<double> violations = measure_.violations(run);
            largest.gap = std::max(largest.gap, violations.gap);
            largest.turn = std::max(largest.turn, violations.turn);
            const double t = motion_.at(k)[0].t;
            const auto got = measure_.invariants(t, run, near_run);
            const auto asked = measure_.invariants(t, truth, near_motion);
            scale = std::max({scale, std::abs(asked.energy), asked.kinetic});
            largest.energy = std::max(largest.energy, std::abs(got.energy - asked.energy));
        }
        largest.energy /= scale;
        return largest;
    }
    SystemInvariants<double> invariants(const Bodies& bodies) const {
        JointCoordinates coordinates(problem.scene);
        return measure_.invariants(bodies.front().t, motions_of(bodies), coordinates);
    }
    /// The observed order: log2 of the ratio of attitude errors when the step is halved.
    double order(const std::string& method, double step) const {
        return std::log2(off(method, step).attitude / off(method, step / 2).attitude);
    }

    Problem problem;

  private:
    long samples_;
    MechanismMeasure<double> measure_;
    Trajectory motion_;
};

}  // namespace polhode::multibody_cases
