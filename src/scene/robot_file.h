// The mass properties of one link of a robot description: URDF, MJCF and SDFormat.
#pragma once

#include <string>
#include <string_view>

#include "scene/body_source.h"
#include "scene/robot_files.h"

namespace polhode {

/// Reads the mass properties of a link (URDF, SDFormat) or body (MJCF) from a file's text. The root element tells the
/// format, errors name `path`. The link's frame is the body's own. `link` is a name, qualified by the names of nested
/// models ("model::link") where the name alone is ambiguous. An <inertial> gives an ImportedBody, exact in the file's
/// numbers; properties computed from geoms or collision shapes, and repaired tensors, give a GivenBody rounded to
/// binary64. A tensor that breaks the triangle inequality by less than 1e-3 of its largest moment is repaired; beyond
/// that it is refused unless `balance_inertia`. Throws InputError.
MadeOf parse_robot_body(std::string_view text, const std::string& path, const std::string& link,
                        bool balance_inertia = false, const RobotFiles& files = {});

}  // namespace polhode
