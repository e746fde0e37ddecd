// Finds the columns of trajectory tables that other programs wrote.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "motion/foreign_columns.h"

namespace polhode {

/// Which columns of a file hold which of ours.
struct ColumnNames {
    /// By our names: "t", "body", "qw", .., "vz". In place of the quaternion nine of a matrix, "r11" to "r33", or three
    /// of Euler angles, "e1" to "e3".
    std::map<std::string, std::string> theirs;
    EulerSequence sequence = EulerSequence::zyx;  ///< of the Euler angles
    bool degrees = false;                         ///< they are in degrees
};

/// Reads "time=t,body=name,rotation=qx:qy:qz:qw,angular_velocity=a:b:c,position=..,origin=..,velocity=..": a rotation
/// has four names, of x, y, z and w, or nine, of a matrix row by row; "matrix_by_columns=" has nine column by column,
/// "euler_zyx=yaw:pitch:roll" three, in the order in which the turns follow one another, each about an axis where those
/// before have brought it. Throws std::invalid_argument with a line that names the fault and the remedy.
ColumnNames parse_columns(std::string_view text);

/// How a table of another program is read.
struct ForeignTable {
    ForeignColumns columns;            ///< without places where the header is to be read
    std::vector<std::string> remarks;  ///< which columns were taken for which, and which were ignored
};

/// Finds the columns of a table by the names given, or, without any, by the names that other programs use. A table
/// whose names are all polhode's, or with too few known columns, is left to parse_trajectory(). `several`: the table is
/// of several bodies, and may have a column `body`. Throws InputError where a column that was named does not exist.
ForeignTable find_foreign_columns(std::string_view text, const std::string& file, const ColumnNames& names,
                                  bool several = false);

}  // namespace polhode
