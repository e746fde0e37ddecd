// Descriptions of the columns of trajectory files.
#pragma once

#include <array>
#include <iterator>
#include <span>
#include <string_view>

#include "motion/trajectory.h"

namespace polhode {

/// A group of columns.
struct TrajectoryColumns {
    std::string_view names;    ///< "wx,wy,wz"
    std::string_view unit;     ///< "rad/s"
    std::string_view meaning;  ///< for readers, without a full stop
};

/// The column groups of the files that solve and truth write and check reads, in order.
inline std::span<const TrajectoryColumns> trajectory_columns() {
    static constexpr TrajectoryColumns all[] = {
        {"t", "s", "time; a sample at the time of an impulse gives the motion after the impulse"},
        {"body", "", "only in scenes with several bodies: name of the body; each time has one line per body"},
        {"qw,qx,qy,qz", "",
         "attitude: the quaternion q that maps body vectors to world vectors, v_W = q v_B q*, as the method computed "
         "it, not normalised"},
        {"wx,wy,wz", "rad/s", "angular velocity, world axes"},
        {"px,py,pz", "m", "position of the centre of mass, world axes"},
        {"vx,vy,vz", "m/s", "velocity of the centre of mass, world axes"},
        {"ox,oy,oz", "m", "only in files for check, instead of px,py,pz: position of the body's origin, world axes"},
        {"bound", "rad, and relative",
         "only in the output of truth: error bound of the row, the largest of the attitude error in rad and the "
         "relative error of each other block"},
    };
    return all;
}

/// The columns of a sample, in the order in which motion_numbers() gives their numbers.
inline constexpr std::string_view motion_columns[] = {"t",  "qw", "qx", "qy", "qz", "wx", "wy",
                                                      "wz", "px", "py", "pz", "vx", "vy", "vz"};

/// A sample by its columns.
inline std::array<double, std::size(motion_columns)> motion_numbers(const Sample& s) {
    const Vector3<double> w = angular_velocity_W(s), &p = s.position_W, &v = s.velocity_W;
    return {s.t, s.q.w, s.q.x, s.q.y, s.q.z, w[0], w[1], w[2], p[0], p[1], p[2], v[0], v[1], v[2]};
}

/// The one line that files carry: which frame, which point, which way q maps.
inline constexpr std::string_view trajectory_comment =
    "# SI; q maps body to world; w, p and v in world axes, p and v of the centre of mass\n";

}  // namespace polhode
