// Least-squares fits of numbers of a scene to measured motion, by Levenberg and Marquardt's method (Eigen's, after
// MINPACK) on the derivatives that sensitivities() computes.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "motion/trajectory.h"
#include "scene/scene_numbers.h"

namespace polhode {

/// A quantity that can be measured.
enum class FitQuantity {
    attitude,            ///< qw, qx, qy, qz
    angular_velocity_W,  ///< wx, wy, wz, rad/s
    angular_velocity_B,  ///< wx_B, wy_B, wz_B as a gyroscope measures them, rad/s
    position_W,          ///< px, py, pz of the centre of mass, m
    velocity_W,          ///< vx, vy, vz of the centre of mass, m/s
};

/// One measured component.
struct FitColumn {
    std::string name;                              ///< "wx_B"; "lower.wx_B" for several bodies
    FitQuantity quantity = FitQuantity::attitude;  ///< what is measured
    std::size_t component = 0;                     ///< index of the component: x, y, z; w, x, y, z of a quaternion
    std::size_t body = 0;                          ///< index of the body
};

/// Measured motion.
struct FitData {
    std::vector<double> times;       ///< s, increasing from 0 or later
    std::vector<FitColumn> columns;  ///< at least one
    std::vector<double> values;      ///< by time, then by column
};

/// Reads the name of a column. `bodies`: the names of the scene's bodies, one or several. Throws std::invalid_argument
/// with a one-line message.
FitColumn fit_column(std::string_view name, const std::vector<std::string>& bodies);

/// Reads measured motion (CSV with a header): `t` and columns of FitColumn. `columns`: those to use, all others are
/// ignored; if empty, all with a known name are used. Throws InputError.
FitData parse_fit_data(std::string_view text, const std::string& file, const std::vector<std::string>& bodies,
                       const std::vector<std::string>& columns);

/// Parameters of fit_numbers().
struct FitSettings {
    std::vector<double> deviations;  ///< standard deviation of the noise by column; if empty, estimated as one number
    double tolerance = 1e-11;        ///< relative, of the motion and of its derivatives
    int max_evaluations = 100;       ///< of motion and derivatives
    double seconds_limit = std::numeric_limits<double>::infinity();  ///< processor time of the thread, s
};

/// Numbers of a scene that were fitted.
struct Fit {
    Status status = Status::ok;      ///< failed: the motion or its derivatives cannot be computed, or no convergence
    std::string message;             ///< why the status is not ok
    std::vector<double> values;      ///< the fitted numbers
    std::vector<double> errors;      ///< their standard errors
    std::vector<double> covariance;  ///< covariance of the fitted numbers, row by row
    std::vector<double> residuals;   ///< root mean square of motion minus data by column, in units of the column
    int evaluations = 0;             ///< number of evaluations: motion and derivatives
};

/// Fits the numbers at the JSON pointers to the data; the scene's numbers are the first guess. The status is failed
/// if the data do not determine the numbers; the message names the combination that is free. The standard errors
/// suppose independent noise of the given deviations, or of one deviation that is estimated from the residuals.
/// Throws InputError if a pointer or the scene is invalid.
Fit fit_numbers(const SceneNumbers& scene, const std::vector<std::string>& pointers, const FitData& data,
                const FitSettings& settings = {});

}  // namespace polhode
