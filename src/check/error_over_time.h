// One error of a trajectory file as a function of time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// The error in one measure at the times of a file.
struct ErrorOverTime {
    std::vector<double> t;      ///< s
    std::vector<double> error;  ///< in the unit of the measure; the largest of all bodies if the measure is per body
    std::string fault;          ///< why there is no truth, or empty
};

/// Computes the error of `file`, in polhode's conventions, in one of the measures() that `check` reports. Files of
/// one body with more than 2000 rows use binary64, which resolves errors of 1e-15. If no polynomial reference exists,
/// or for several bodies, 2000 evenly spread times are evaluated in 128 bits. Shorter files use 128 bits at all
/// times. Throws InputError, with `name` as the file, if the file lacks columns that the measure needs.
ErrorOverTime error_over_time(const Scene& scene, const TrajectoryFile& file, std::string_view measure,
                              const std::string& name);

}  // namespace polhode
