// Runs of bodies made of points, with options that Settings does not have. The methods and the experiment call them.
#pragma once

#include "integrators/method.h"
#include "integrators/points/point_motion.h"

namespace polhode {

/// Options of a run in addition to Settings.
struct PointOptions {
    Arrangement arrangement{};
    std::optional<double> stiffness{};  ///< N/m, of every spring; default: default_stiffness()
    /// Damping ratio of the springs' slowest vibration; 1 is critical. Default: 1 for CVODE, 0 otherwise.
    std::optional<double> damping_ratio{};
    int iterations = 10;  ///< sweeps over the distances per step, for the position-based update
};

/// Result of a run.
struct PointRun {
    Trajectory trajectory;
    double largest_stretch = 0;  ///< largest | |d| - l | / l over all samples and links
};

/// The runs. Each returns an `unsupported` trajectory if the body cannot be made of points.
PointRun point_springs_rk4(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_springs_verlet(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_springs_cvode_bdf(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_constraints_ida(const Problem& problem, const Settings& settings, const PointOptions& options);
PointRun point_xpbd(const Problem& problem, const Settings& settings, const PointOptions& options);

}  // namespace polhode
