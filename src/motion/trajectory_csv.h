// Trajectories as CSV files: t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz; of several bodies, body stands after t.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motion/trajectory.h"

namespace polhode {

/// A header line, then one line a sample: t (s); q body to world as the method left it; w in world axes (rad/s); p, v
/// of the centre of mass (m, m/s). Shortest decimals that read back to the same binary64. A trajectory whose status is
/// not ok ends in a comment line that says so. `bodies`: the names of several bodies, in the order of the samples; a
/// column `body` follows t, and at each t there is a line for each.
std::string trajectory_csv(const Trajectory& trajectory, std::span<const std::string> bodies = {});

/// A header line t,joint,fx,fy,fz,tx,ty,tz, then at each of the trajectory's times a line for each joint that it gives
/// reactions of, an empty cell for NaN. `joints`: their names, in the order of Trajectory::reactions.
std::string reactions_csv(const Trajectory& trajectory, std::span<const std::string> joints);

/// One line of a trajectory file, as it stands there.
struct TrajectoryRow {
    double t = 0;                        ///< s
    Quaternion<double> q;                ///< body to world, of any length but zero
    Vector3<double> angular_velocity_W;  ///< rad/s, world axes
    Vector3<double> position_W;          ///< of the centre of mass, or of the body's origin, m
    Vector3<double> velocity_W;          ///< of the centre of mass, m/s

    /// Whether all numbers are equal.
    bool operator==(const TrajectoryRow&) const = default;
};

/// What a trajectory file says. Blocks that it lacks are zero.
struct TrajectoryFile {
    /// At least one; t >= 0 and increasing. Of several bodies: at each t one for each, in the order of `bodies`.
    std::vector<TrajectoryRow> rows;
    std::vector<std::string> bodies;    ///< the names in a column `body`; empty where there is none
    bool has_angular_velocity = false;  ///< wx, wy, wz
    bool has_position = false;          ///< px, py, pz
    bool has_origin = false;            ///< ox, oy, oz in their place: position_W is the body's origin
    bool has_velocity = false;          ///< vx, vy, vz
    std::string read_past;              ///< "line 1 begins with a byte order mark", ..: empty where nothing was

    /// How many rows there are at each time.
    std::size_t bodies_at_once() const { return bodies.empty() ? 1 : bodies.size(); }
    /// Whether the rows, and what is known of them, are equal.
    bool operator==(const TrajectoryFile&) const = default;
};

/// What the four columns of a quaternion hold.
enum class QuaternionColumns {
    by_name,       ///< each what its name says
    scalar_first,  ///< w, x, y, z in the order in which the columns stand, whatever they are named
    scalar_last,   ///< x, y, z, w in the order in which the columns stand, whatever they are named
};

/// Reads trajectory files: columns by name, in any order; t and q must be there, of w, p, v and o (the body's origin,
/// in place of p) whole blocks or nothing; `bound`, which `truth` writes, is read past. Numbers are the binary64
/// nearest to the decimal written, whatever the locale. Lines may end in a carriage return and a line feed, a byte
/// order mark may stand in front
/// (`read_past` says so), `#` begins a comment line, spaces may stand around a cell. Throws InputError ("FILE: line 3,
/// column qw: FAULT; REMEDY"): no header or no sample, an unknown, missing or repeated column, a line of another length
/// than the header, what is no finite number, a time below 0 or not above the one before, a quaternion without a
/// direction (of length below 1e-100 or above 1e100), a blank line between samples, a zero byte, a line of more than 64
/// KiB.
///
/// With a column `body`, a line for each body at each t, in any order of bodies; else InputError. The file's bodies are
/// those at the first t. `bodies`: the names that there may be, in whose order they stand then; where it is empty, any.
TrajectoryFile parse_trajectory(std::string_view text, const std::string& file,
                                QuaternionColumns quaternion = QuaternionColumns::by_name,
                                std::span<const std::string> bodies = {});

/// Reads and parses a file of at most 1 GiB. Throws InputError, also when it cannot be read.
TrajectoryFile read_trajectory(const std::string& path, QuaternionColumns quaternion = QuaternionColumns::by_name,
                               std::span<const std::string> bodies = {});

/// The samples of a trajectory file, as a method gives them: w is turned into body axes, and a body's origin exchanged
/// for its centre of mass (m, from the origin, body axes), by each row's attitude, in 128 bits and rounded once.
std::vector<Sample> samples_of(const TrajectoryFile& file, const Vector3<double>& center_of_mass);
/// The same of several bodies, with the centre of mass of each.
std::vector<Sample> samples_of(const TrajectoryFile& file, std::span<const Vector3<double>> centers_of_mass);

}  // namespace polhode
