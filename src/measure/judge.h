// A trajectory file judged against the truth.
#pragma once

#include <optional>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// The largest errors over a file's samples; those that its columns do not tell are empty.
struct Judgement {
    double attitude_max = 0;                                    ///< rad
    double attitude_max_time = 0;                               ///< s, where that is
    double attitude_final = 0;                                  ///< rad, at the file's last sample
    double norm_max = 0;                                        ///< ||q| - 1|
    std::optional<double> omega_max, energy_max, momentum_max;  ///< relative, as ErrorSeries has them
    std::optional<double> position_max, velocity_max;           ///< m, m/s, of the centre of mass
};

/// Judges sample by sample; `truth` is available and has the file's times, else std::invalid_argument. Omega and
/// momentum need w. Energy needs w, and p and v where the scene has no pivot.
Judgement judge(const Scene& scene, const TrajectoryFile& file, const Reference& truth);

}  // namespace polhode
