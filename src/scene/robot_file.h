// Inertials of robot descriptions: URDF, MJCF and SDFormat.
#pragma once

#include <string>
#include <string_view>

#include "scene/body_source.h"

namespace polhode {

/// The inertial of a link (URDF, SDFormat) or body (MJCF), the format told by the root element. The link's frame is the
/// body's own; the inertial's pose says where the centre of mass is and which axes the tensor is in. `link` is a name,
/// or names of nested models and the link joined by "::" where one name alone would be ambiguous. Throws InputError
/// ("FILE: line 12, <inertia>: FAULT; REMEDY"): what is no such file, an unknown or repeated link, one without an
/// inertial, a missing element or attribute, what is no finite number, a mass or moment that is not positive.
ImportedBody read_robot_body(const std::string& path, const std::string& link);

/// The inertial in a file's text, read as by read_robot_body(); `path` is named in errors.
ImportedBody parse_robot_body(std::string_view text, const std::string& path, const std::string& link);

}  // namespace polhode
