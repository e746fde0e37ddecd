// Bodies made of points as methods and as the study of them calls these, with what Settings has no place for.
#pragma once

#include "integrators/method.h"
#include "integrators/points/point_motion.h"

namespace polhode {

/// What a run is asked for beyond Settings.
struct PointOptions {
    Arrangement arrangement{};
    std::optional<double> stiffness{};  ///< N/m, of every spring; default_stiffness() where absent
    /// Of the springs' slowest vibration, as a share of the critical one; 0, and 1 for CVODE, where absent.
    std::optional<double> damping_ratio{};
    int iterations = 10;  ///< sweeps over the distances a step, of the position-based update
};

/// What it tells: the trajectory, and the largest | |d| - l | / l over all samples and links.
struct PointRun {
    Trajectory trajectory;
    double largest_stretch = 0;
};

PointRun point_springs_rk4(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_springs_verlet(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_springs_cvode_bdf(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_constraints_ida(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_xpbd(const Problem& problem, const Settings& settings, const PointOptions& options);

}  // namespace polhode
