// Trajectories as CSV files: t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz; for several bodies with the column body after
// t.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motion/trajectory.h"

namespace polhode {

/// A header line, then one line per sample: t (s); q body to world, as output by the method; w in world axes (rad/s);
/// p and v of the centre of mass (m, m/s). Numbers are the shortest decimals that read back to the same binary64. If
/// the status is not ok, the last line is a comment with the status. `bodies`: the names of several bodies in the
/// order of the samples; a column `body` follows t, with one line per body at each t.
std::string trajectory_csv(const Trajectory& trajectory, std::span<const std::string> bodies = {});

/// A header line t,joint,fx,fy,fz,tx,ty,tz, then at each time one line per joint for which the trajectory has
/// reactions. NaN is an empty cell. `joints`: their names, in the order of Trajectory::reactions.
std::string reactions_csv(const Trajectory& trajectory, std::span<const std::string> joints);

/// One line of a trajectory file, unconverted.
struct TrajectoryRow {
    double t = 0;                        ///< s
    Quaternion<double> q;                ///< body to world, of any nonzero length
    Vector3<double> angular_velocity_W;  ///< rad/s, world axes
    Vector3<double> position_W;          ///< centre of mass, or the body's origin, m
    Vector3<double> velocity_W;          ///< centre of mass, m/s

    /// Whether all numbers are equal.
    bool operator==(const TrajectoryRow&) const = default;
};

/// The contents of a trajectory file. Missing blocks are zero.
struct TrajectoryFile {
    /// At least one; t >= 0 and increasing. For several bodies: at each t one row per body, in the order of `bodies`.
    std::vector<TrajectoryRow> rows;
    std::vector<std::string> bodies;    ///< names from the column `body`; empty if there is none
    bool has_angular_velocity = false;  ///< wx, wy, wz
    bool has_position = false;          ///< px, py, pz
    bool has_origin = false;            ///< ox, oy, oz in place of px, py, pz: position_W is the body's origin
    bool has_velocity = false;          ///< vx, vy, vz
    std::string skipped_content;        ///< what was skipped: "line 1 begins with a byte order mark", ..

    /// The number of rows at each time.
    std::size_t bodies_at_once() const { return bodies.empty() ? 1 : bodies.size(); }
    /// Whether the rows and their descriptions are equal.
    bool operator==(const TrajectoryFile&) const = default;
};

/// How the four quaternion columns are interpreted.
enum class QuaternionColumns {
    by_name,       ///< by the name of each column
    scalar_first,  ///< w, x, y, z in column order, whatever their names
    scalar_last,   ///< x, y, z, w in column order, whatever their names
};

/// Parses a trajectory file, with columns by name in any order. t and q are required. w, p, v and o (the body's
/// origin, in place of p) must be complete or absent. `bound`, which `truth` writes, is skipped. Numbers are the
/// binary64 nearest to the decimal written, independent of the locale. Lines may end in a carriage return and a line
/// feed, the file may begin with a byte order mark (reported in `skipped_content`), `#` begins a comment line, and
/// spaces around cells are ignored. Throws InputError ("FILE: line 3, column qw: FAULT; REMEDY") for: no header or no
/// sample; an unknown, missing or repeated column; a line whose length differs from the header's; a cell that is not
/// a finite number; a time below 0 or not above the previous one; a quaternion of length below 1e-100 or above 1e100;
/// a blank line between samples; a zero byte; a line longer than 64 KiB.
///
/// With a column `body`, each time must have one line per body, in any order; otherwise throws InputError. The file's
/// bodies are those at the first t. `bodies`: the permitted names, which also define the order of the rows; if empty,
/// any names.
TrajectoryFile parse_trajectory(std::string_view text, const std::string& file,
                                QuaternionColumns quaternion = QuaternionColumns::by_name,
                                std::span<const std::string> bodies = {});

/// Reads and parses a file of at most 1 GiB. Throws InputError, also if it cannot be read.
TrajectoryFile read_trajectory(const std::string& path, QuaternionColumns quaternion = QuaternionColumns::by_name,
                               std::span<const std::string> bodies = {});

/// Converts the rows of a trajectory file to samples: w to body axes, and a body's origin to its centre of mass
/// (given in m, from the origin, body axes), by each row's attitude. Computed in 128 bits and rounded once.
std::vector<Sample> samples_of(const TrajectoryFile& file, const Vector3<double>& center_of_mass);
/// Converts the rows of a trajectory file of several bodies to samples, with the centre of mass of each body.
std::vector<Sample> samples_of(const TrajectoryFile& file, std::span<const Vector3<double>> centers_of_mass);

}  // namespace polhode
