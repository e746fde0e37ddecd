// Finds the columns in trajectory tables written by other programs.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "motion/foreign_columns.h"

namespace polhode {

/// Assignment of a file's columns to polhode's.
struct ColumnNames {
    /// From polhode's names ("t", "body", "qw", .., "vz") to the file's. A rotation matrix has the keys "r11" to
    /// "r33", Euler angles have the keys "e1" to "e3".
    std::map<std::string, std::string> theirs;
    EulerSequence sequence = EulerSequence::zyx;  ///< Euler sequence of the table
    bool degrees = false;                         ///< whether the Euler angles are in degrees
};

/// Parses "time=t,body=name,rotation=qx:qy:qz:qw,angular_velocity=a:b:c,position=..,origin=..,velocity=..".
/// `rotation` takes four names (x, y, z, w) or the nine of a matrix, row by row. `matrix_by_columns` takes nine,
/// column by column. `euler_zyx=yaw:pitch:roll` takes three, in the order of the rotations; each is about an axis of
/// the frame rotated so far (intrinsic). Throws std::invalid_argument with a one-line message.
ColumnNames parse_columns(std::string_view text);

/// The columns found in a table of another program.
struct ForeignTable {
    ForeignColumns columns;            ///< no places if parse_trajectory() reads the header
    std::vector<std::string> remarks;  ///< which columns are used as which, and which are ignored
};

/// Finds the columns of a table by the given names, or by common names of other programs if none are given. A table
/// with polhode's names only, or with too few known columns, is left to parse_trajectory(). `several`: the table may
/// have a column `body`. Throws InputError if a given column does not exist.
ForeignTable find_foreign_columns(std::string_view text, const std::string& file, const ColumnNames& names,
                                  bool several = false);

}  // namespace polhode
