// Access to the elements of URDF, MJCF and SDFormat files: errors with their place, numbers, poses and inertials.
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

/// A quaternion of any length but zero, or three turns.
using RobotTurn = std::variant<Quaternion<double>, EulerTurn>;

/// Where an element comes from that was copied from another file: the element's user data points to it.
struct RobotOrigin {
    std::string path;
    int line = 0;
};

/// Reads elements of one file. Each function throws InputError ("FILE: line 12, <inertia>: FAULT; REMEDY") if an
/// element does not have the form that the function expects.
class RobotXml {
  public:
    explicit RobotXml(std::string path, RobotFiles files = {}) : path_(std::move(path)), files_(std::move(files)) {}

    const std::string& path() const { return path_; }
    const RobotFiles& files() const { return files_; }
    /// Keeps an origin as long as this object and its copies exist.
    RobotOrigin* keep(RobotOrigin origin) const { return &origins_->emplace_back(std::move(origin)); }
    [[noreturn]] void fail(const XMLElement& at, const std::string& fault, const std::string& remedy) const;
    /// "line 12", or "other.xml: line 12" of an element from an included file.
    std::string place_of(const XMLElement& at) const;

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

    /// Fails at a negative mass.
    double checked_mass(const XMLElement& at, double mass) const;
    /// The tensor with the entries xx yy zz xy xz yz, whether or not it is that of a distribution of mass.
    static Matrix3<double> tensor(const std::vector<double>& v);
    RobotTurn turn_by(const XMLElement& at, const Quaternion<double>& q) const;

  private:
    std::string path_;
    RobotFiles files_;
    std::shared_ptr<std::deque<RobotOrigin>> origins_ = std::make_shared<std::deque<RobotOrigin>>();
};

inline Vector3<double> three_of(const std::vector<double>& v, std::size_t from = 0) {
    return {v[from], v[from + 1], v[from + 2]};
}

/// Roll, pitch, yaw about the fixed axes x, y, z.
inline EulerTurn roll_pitch_yaw(const Vector3<double>& angles, bool in_degrees) {
    return {{0, 1, 2}, angles, in_degrees, false};
}

/// The <inertial> of a URDF link, with mass and tensor as they stand there.
ImportedBody urdf_inertial(const RobotXml& xml, const XMLElement& inertial);

/// The root element of a file's text. Throws InputError where it is not XML.
const XMLElement& parse_robot_xml(tinyxml2::XMLDocument& document, std::string_view text, const std::string& path);

}  // namespace polhode
