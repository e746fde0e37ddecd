// What URDF, MJCF and SDFormat files are read by: faults at elements, numbers, poses and inertials.
#pragma once

#include <tinyxml2.h>

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/body_source.h"

namespace polhode {

using tinyxml2::XMLElement;

/// A quaternion of any length but zero, or three turns.
using RobotTurn = std::variant<Quaternion<double>, EulerTurn>;

/// Reads elements of one file; each throws InputError ("FILE: line 12, <inertia>: FAULT; REMEDY") where they are not
/// what is asked for.
class RobotXml {
  public:
    explicit RobotXml(const std::string& path) : path_(path) {}

    const std::string& path() const { return path_; }
    [[noreturn]] void fail(const XMLElement& at, const std::string& fault, const std::string& remedy) const;

    /// The only child of that name.
    const XMLElement& child(const XMLElement& of, const char* name) const;
    /// The same, or nullptr where there is none.
    const XMLElement* optional_child(const XMLElement& of, const char* name) const;
    /// An attribute that is not empty; `what` says in the message what to give.
    std::string name(const XMLElement& at, const char* attribute, const char* what) const;

    /// From `least` to `most` finite numbers between spaces.
    std::vector<double> numbers(const XMLElement& at, const char* what, std::string_view text, std::size_t least,
                                std::size_t most) const;
    /// The n numbers of an attribute, or of an element's text.
    std::vector<double> attribute(const XMLElement& at, const char* name, std::size_t n) const;
    std::vector<double> content(const XMLElement& at, std::size_t n) const;
    /// A number that may be missing.
    double attribute_or(const XMLElement& at, const char* name, double fallback) const;
    double content_or(const XMLElement* at, double fallback) const;
    /// "true" or "1", "false" or "0"; false where it is missing.
    bool flag(const XMLElement& at, const char* name) const;

    double checked_mass(const XMLElement& at, double mass) const;
    /// xx yy zz xy xz yz: the tensor itself.
    Matrix3<double> tensor(const XMLElement& at, const std::vector<double>& v) const;
    RobotTurn turn_by(const XMLElement& at, const Quaternion<double>& q) const;

  private:
    const std::string& path_;
};

inline Vector3<double> three_of(const std::vector<double>& v, std::size_t from = 0) {
    return {v[from], v[from + 1], v[from + 2]};
}

/// Roll, pitch, yaw about the fixed axes x, y, z.
inline EulerTurn roll_pitch_yaw(const Vector3<double>& angles, bool in_degrees) {
    return {{0, 1, 2}, angles, in_degrees, false};
}

/// A position and a turn.
struct RobotPlace {
    Vector3<double> position;  ///< m
    RobotTurn turn;
};

/// SDFormat's <pose>, whatever it is relative to.
RobotPlace sdf_place(const RobotXml& xml, const XMLElement& pose);

/// MJCF's <compiler>.
struct MjcfCompiler {
    EulerTurn euler{{0, 1, 2}, {}, true, true};  ///< with the angles left open
    bool in_degrees = true;
};
MjcfCompiler mjcf_compiler(const RobotXml& xml, const XMLElement& root);
/// The turn that an MJCF element gives by quat, axisangle, euler, xyaxes or zaxis: none where there is none of them.
Quaternion<Wide> mjcf_turn(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler);
/// The least turn that brings z to the direction v, of any length but zero; `what` is named where it is zero.
Quaternion<Wide> turn_from_z(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v);

/// The inertials of a link of each format.
ImportedBody urdf_inertial(const RobotXml& xml, const XMLElement& inertial);
ImportedBody sdf_inertial(const RobotXml& xml, const XMLElement& inertial);
ImportedBody mjcf_inertial(const RobotXml& xml, const XMLElement& inertial, const MjcfCompiler& compiler);

/// The root element of a file's text. Throws InputError where it is not XML.
const XMLElement& parse_robot_xml(tinyxml2::XMLDocument& document, std::string_view text, const std::string& path);

/// A robot file's text: of a built-in scene's `directory` a built-in file. Throws InputError.
std::string robot_text(const std::string& directory, const std::string& file);

}  // namespace polhode
