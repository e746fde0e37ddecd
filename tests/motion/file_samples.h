// The samples of a trajectory file, as a method would have given them.
#pragma once

#include <vector>

#include "body/wide.h"
#include "motion/trajectory_csv.h"

namespace polhode::testing {

/// w turned into body axes and the body's origin exchanged for its centre of mass (m, from the origin, body axes) by
/// each row's attitude, in 128 bits and rounded once.
inline std::vector<Sample> samples_of(const TrajectoryFile& file, const Vector3<double>& center_of_mass) {
    // (1/|q|^2) times a vector turned by q
    const auto scaled = [](const Quaternion<Wide>& q, const Vector3<Wide>& turned) {
        return cast<double>((Wide(1) / squared_norm(q)) * turned);
    };
    std::vector<Sample> samples;
    samples.reserve(file.rows.size());
    for (const TrajectoryRow& row : file.rows) {
        const Quaternion<Wide> q = cast<Wide>(row.q);
        Sample s;
        s.t = row.t, s.q = row.q, s.position_W = row.position_W, s.velocity_W = row.velocity_W;
        s.angular_velocity_B = scaled(q, rotate_back(q, cast<Wide>(row.angular_velocity_W)));
        if (file.has_origin) {
            const Wide size = squared_norm(q);
            const Vector3<Wide> origin = size * cast<Wide>(row.position_W);
            s.position_W = scaled(q, origin + rotate(q, cast<Wide>(center_of_mass)));
        }
        samples.push_back(s);
    }
    return samples;
}

}  // namespace polhode::testing
