// Trajectory files of other programs, whose columns have other names and may hold rotations in other forms.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "body/orientation.h"
#include "motion/trajectory_csv.h"

namespace polhode {

/// Which columns of a file hold what.
struct ForeignColumns {
    /// The place in the file of each column that it has: "t", "body", "qw", .., "vz". In place of the quaternion there
    /// may be the nine entries of a matrix, "r11" to "r33", or Euler angles, "e1" to "e3". Other columns of the file
    /// are ignored. Where this is empty, the file's header names its columns.
    std::map<std::string, std::size_t> places;
    EulerSequence sequence = EulerSequence::zyx;  ///< axes of the Euler angles
    bool degrees = false;                         ///< unit of the Euler angles
};

/// Reads a trajectory file as parse_trajectory() does, with these columns. A matrix, which may deviate from a rotation
/// by 1e-3, becomes the nearest quaternion. `gaps`: the rows of times at which a cell is NaN are skipped, and for each
/// series of skipped times the number of times before it is appended, unless it is 0 or no time follows; null: NaN is
/// refused. Throws InputError, whose line numbers are those of the file.
TrajectoryFile parse_foreign_trajectory(std::string_view text, const std::string& file, const ForeignColumns& columns,
                                        QuaternionColumns quaternion = QuaternionColumns::by_name,
                                        std::span<const std::string> bodies = {},
                                        std::vector<std::size_t>* gaps = nullptr);

}  // namespace polhode
