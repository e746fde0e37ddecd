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
        {"t", "s", "the time; a sample at the time of an impulse shows the motion after it"},
        {"body", "", "of scenes of several bodies alone: the body's name; there is a line for each body at each t"},
        {"qw,qx,qy,qz", "",
         "the attitude: the quaternion q that maps body vectors to world vectors, v_W = q v_B q*, as the method left "
         "it, not "
         "normalised for show"},
        {"wx,wy,wz", "rad/s", "the angular velocity, world axes"},
        {"px,py,pz", "m", "the position of the centre of mass, world axes"},
        {"vx,vy,vz", "m/s", "the velocity of the centre of mass, world axes"},
        {"ox,oy,oz", "m", "in files for check, in place of px,py,pz: the position of the body's origin, world axes"},
        {"bound", "rad, and relative",
         "of truth: how far any number of the row may be off, the largest of the attitude in rad and the relative "
         "error of "
         "each other block"},
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
