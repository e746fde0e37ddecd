// Access to the elements of URDF, MJCF and SDFormat files: located errors, numbers, poses and inertials.
#pragma once

#include <tinyxml2.h>

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scene/body_source.h"
#include "scene/robot_files.h"

namespace polhode {

using tinyxml2::XMLElement;

/// A quaternion of any nonzero length, or three rotations.
using RobotRotation = std::variant<Quaternion<double>, EulerRotation>;

/// The origin of an element copied from another file. The element's user data points to it.
struct RobotOrigin {
    std::string path;
    int line = 0;
};

/// Reads elements of one file. Each function throws InputError ("FILE: line 12, <inertia>: FAULT; REMEDY") if an
/// element does not have the expected form.
class RobotXml {
  public:
    explicit RobotXml(std::string path, RobotFiles files = {}) : path_(std::move(path)), files_(std::move(files)) {}

    const std::string& path() const { return path_; }
    const RobotFiles& files() const { return files_; }
    /// Keeps an origin alive as long as this object and its copies exist.
    RobotOrigin* keep(RobotOrigin origin) const { return &origins_->emplace_back(std::move(origin)); }
    [[noreturn]] void fail(const XMLElement& at, const std::string& fault, const std::string& remedy) const;
    /// "line 12", or "other.xml: line 12" for an element from an included file.
    std::string place_of(const XMLElement& at) const;

    /// The only child with this name.
    const XMLElement& child(const XMLElement& of, const char* name) const;
    /// The only child with this name, or nullptr if there is none.
    const XMLElement* optional_child(const XMLElement& of, const char* name) const;
    /// A non-empty attribute; `what` names it in the message.
    std::string name(const XMLElement& at, const char* attribute, const char* what) const;

    /// Parses `least` to `most` finite numbers separated by spaces.
    std::vector<double> numbers(const XMLElement& at, const char* what, std::string_view text, std::size_t least,
                                std::size_t most) const;
    /// Exactly n numbers from an attribute, or from an element's text.
    std::vector<double> attribute(const XMLElement& at, const char* name, std::size_t n) const;
    std::vector<double> content(const XMLElement& at, std::size_t n) const;
    /// An optional number.
    double attribute_or(const XMLElement& at, const char* name, double fallback) const;
    double content_or(const XMLElement* at, double fallback) const;
    /// Parses "true" or "1", "false" or "0"; false if missing.
    bool flag(const XMLElement& at, const char* name) const;

    /// Throws if the mass is negative.
    double checked_mass(const XMLElement& at, double mass) const;
    /// The tensor with the entries xx yy zz xy xz yz, without checks.
    static Matrix3<double> tensor(const std::vector<double>& v);
    RobotRotation rotate_by(const XMLElement& at, const Quaternion<double>& q) const;

  private:
    std::string path_;
    RobotFiles files_;
    std::shared_ptr<std::deque<RobotOrigin>> origins_ = std::make_shared<std::deque<RobotOrigin>>();
};

/// Three numbers of v, starting at index `from`.
inline Vector3<double> three_of(const std::vector<double>& v, std::size_t from = 0) {
    return {v[from], v[from + 1], v[from + 2]};
}

/// Roll, pitch, yaw: rotations about the fixed axes x, y, z.
inline EulerRotation roll_pitch_yaw(const Vector3<double>& angles, bool in_degrees) {
    return {{0, 1, 2}, angles, in_degrees, false};
}

/// The <inertial> of a URDF link, with mass and tensor as written.
ImportedBody urdf_inertial(const RobotXml& xml, const XMLElement& inertial);

/// The root element of a file's text. Throws InputError if it is not XML.
const XMLElement& parse_robot_xml(tinyxml2::XMLDocument& document, std::string_view text, const std::string& path);

}  // namespace polhode
