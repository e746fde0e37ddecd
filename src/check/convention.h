// What axes, units and orders other programs use, and the way from there to ours.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body/algebra.h"
#include "motion/trajectory_csv.h"

namespace polhode {

/// The axes that a program writes a body and its world in. The scene's body is built in them as well: its point
/// (x, y, z) stands at M (x, y, z) there, so that an attitude of no rotation stays one.
enum class Axes {
    z_up_right,  ///< ours
    y_up_right,  ///< (x, y, z) there is (x, -z, y) here: turned by a quarter about x
    z_up_left,   ///< (x, y, z) there is (x, -y, z) here: the y axis mirrored
    y_up_left,   ///< (x, y, z) there is (x, z, y) here: y and z exchanged
};

/// A program's conventions. The default is ours: z up, right-handed, radians, columns by name.
struct Convention {
    Axes axes = Axes::z_up_right;
    QuaternionColumns quaternion = QuaternionColumns::by_name;
    bool degrees = false;     ///< w in degrees per second, and Euler angles in degrees
    bool body_rates = false;  ///< w in body axes
    double length_unit = 1;   ///< m in the unit of positions and velocities

    bool operator==(const Convention&) const = default;
};

/// Words joined by commas: y-up or z-up, left-handed or right-handed, scalar-first or scalar-last, degrees or radians;
/// body-rates (w in body axes); centimetres, millimetres, inches or feet; or one program's name in the place of
/// several: unity (y-up, left-handed), unreal (z-up, left-handed, centimetres), godot, three and bullet (y-up,
/// right-handed). What is not said is ours. Throws std::invalid_argument, with a line that names the fault and the
/// remedy, on a word that is unknown or contradicts another.
Convention parse_convention(std::string_view text);

/// The words that parse_convention() reads back; empty for ours.
std::string name_of(const Convention& convention);

/// The vector in polhode's axes that is v in the other program's.
Vector3<double> vector_from(Axes axes, const Vector3<double>& v);
/// The angular velocity, or the vector part of a quaternion, that is v in the other program: a mirror turns its sense
/// round.
Vector3<double> pseudovector_from(Axes axes, const Vector3<double>& v);
/// The attitude that is q in the other program.
Quaternion<double> quaternion_from(Axes axes, const Quaternion<double>& q);

/// The vector in the other program's axes that is v here.
Vector3<double> vector_to(Axes axes, const Vector3<double>& v);
/// The angular velocity in the other program's axes that is v here.
Vector3<double> pseudovector_to(Axes axes, const Vector3<double>& v);
/// The attitude in the other program that is q here.
Quaternion<double> quaternion_to(Axes axes, const Quaternion<double>& q);

/// The units of length by their short names, "cm", with the words of them that parse_convention() takes.
const std::map<std::string, std::string>& length_units();

/// The word of a unit of length that --convention takes, in m: 0.01 of "centimetres"; also its short name, "cm".
/// Nothing where there is none.
std::optional<double> length_unit(std::string_view name);

/// Turns a file into polhode's conventions. The order of the quaternion's columns is the reader's matter:
/// read_trajectory(path, convention.quaternion).
void convert(TrajectoryFile& file, const Convention& convention);

}  // namespace polhode
