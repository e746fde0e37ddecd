// Tables of other programs: columns under other names, picked out and named as ours.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "body/orientation.h"

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

/// A table under our names.
struct ForeignTable {
    std::string text;                  ///< as parse_trajectory() reads it, a line for each of the file's
    std::vector<std::string> remarks;  ///< which columns were taken for which, and which were ignored
};

/// The table with the columns named; without any, those that are known under names that other programs use. A table
/// whose names are all ours already, or of which too little is known, stays as it is, for parse_trajectory() to judge.
/// `several`: the table is of several bodies, and may have a column `body`. A matrix is turned into the quaternion
/// nearest to it. Throws InputError where a column named is not there, a line is too short or an entry of a matrix is
/// no number.
ForeignTable own_columns(std::string text, const std::string& file, const ColumnNames& names, bool several = false);

}  // namespace polhode
