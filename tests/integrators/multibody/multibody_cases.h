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
