// What the columns of trajectory files mean.
#pragma once

#include <span>
#include <string_view>

namespace polhode {

/// Columns that stand together.
struct TrajectoryColumns {
    std::string_view names;    ///< "wx,wy,wz"
    std::string_view unit;     ///< "rad/s"
    std::string_view meaning;  ///< for people, without a full stop
};

/// Those of the files that solve and truth write and check reads, in their order.
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

/// The one line that files carry: which frame, which point, which way q maps.
inline constexpr std::string_view trajectory_comment =
    "# SI; q maps body to world; w, p and v in world axes, p and v of the centre of mass\n";

}  // namespace polhode
