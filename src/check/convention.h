// Axes, units and component orders of other programs, and the conversion to polhode's.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body/algebra.h"
#include "motion/trajectory_csv.h"

namespace polhode {

/// The axes in which a program writes the body and its world. The body itself is built in these axes too: its point
/// (x, y, z) is at M (x, y, z) there. The identity attitude is therefore the identity in all conventions.
enum class Axes {
    z_up_right,  ///< polhode's axes
    y_up_right,  ///< (x, y, z) there is (x, -z, y) here: a rotation by 90 degrees about x
    z_up_left,   ///< (x, y, z) there is (x, -y, z) here: the y axis mirrored
    y_up_left,   ///< (x, y, z) there is (x, z, y) here: y and z exchanged
};

/// The conventions of a program. The default is polhode's: z up, right-handed, radians, columns by name.
struct Convention {
    Axes axes = Axes::z_up_right;
    QuaternionColumns quaternion = QuaternionColumns::by_name;
    bool degrees = false;     ///< w in degrees per second, and Euler angles in degrees
    bool body_rates = false;  ///< w in body axes
    double length_unit = 1;   ///< m in the unit of positions and velocities

    bool operator==(const Convention&) const = default;
};

/// Parses words joined by commas: y-up or z-up, left-handed or right-handed, scalar-first or scalar-last, degrees or
/// radians, body-rates (w in body axes) or world-rates, and metres, centimetres, millimetres, inches or feet. The
/// name of a program replaces several words: unity (y-up, left-handed), unreal (z-up, left-handed, centimetres),
/// godot, three and bullet (y-up, right-handed). The default is polhode's convention. Throws std::invalid_argument
/// with a one-line message if a word is unknown or contradicts another.
Convention parse_convention(std::string_view text);

/// Returns the words that parse_convention() reads back; empty for polhode's convention.
std::string name_of(const Convention& convention);

/// Converts a vector from the other program's axes to polhode's.
Vector3<double> vector_from(Axes axes, const Vector3<double>& v);
/// Converts an angular velocity, or the vector part of a quaternion, from the other program's axes to polhode's. A
/// change of handedness also reverses its sign.
Vector3<double> pseudovector_from(Axes axes, const Vector3<double>& v);
/// Converts an attitude from the other program's axes to polhode's.
Quaternion<double> quaternion_from(Axes axes, const Quaternion<double>& q);

/// Converts a vector from polhode's axes to the other program's.
Vector3<double> vector_to(Axes axes, const Vector3<double>& v);
/// Converts an angular velocity from polhode's axes to the other program's.
Vector3<double> pseudovector_to(Axes axes, const Vector3<double>& v);
/// Converts an attitude from polhode's axes to the other program's.
Quaternion<double> quaternion_to(Axes axes, const Quaternion<double>& q);

/// Maps the short name of each unit of length ("cm") to the word that parse_convention() accepts ("centimetres").
const std::map<std::string, std::string>& length_units();

/// Returns the unit of length with this name ("centimetres" or "cm") in m, 0.01. Returns nothing for an unknown name.
std::optional<double> length_unit(std::string_view name);

/// Converts a file to polhode's conventions. The reader handles the order of the quaternion's columns:
/// read_trajectory(path, convention.quaternion).
void convert(TrajectoryFile& file, const Convention& convention);

}  // namespace polhode
