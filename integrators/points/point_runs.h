// Runs of bodies made of points, with the options that Settings has no place for: the methods and the experiment call
// them.
#pragma once

#include "integrators/method.h"
#include "integrators/points/point_motion.h"

namespace polhode {

/// What a run is asked for beyond Settings.
struct PointOptions {
    Arrangement arrangement{};
    std::optional<double> stiffness{};  ///< N/m, of every spring; default_stiffness() where absent
    /// The damping of the springs' slowest vibration as a share of the critical one. Where absent: 1 for CVODE, else 0.
    std::optional<double> damping_ratio{};
    int iterations = 10;  ///< sweeps over the distances a step, of the position-based update
};

/// What a run gives.
struct PointRun {
    Trajectory trajectory;
    double largest_stretch = 0;  ///< the largest | |d| - l | / l over all samples and links
};

PointRun point_springs_rk4(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_springs_verlet(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_springs_cvode_bdf(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_constraints_ida(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_xpbd(const Problem& problem, const Settings& settings, const PointOptions& options);

}  // namespace polhode
