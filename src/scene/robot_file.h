// The mass properties of one link of a robot description: URDF, MJCF or SDFormat.
#pragma once

#include <string>
#include <string_view>

#include "scene/body_source.h"
#include "scene/robot_files.h"

namespace polhode {

/// Reads the mass properties of a link (URDF, SDFormat) or body (MJCF) from the text of a file. The root element
/// selects the format; errors name `path`. The link's frame becomes the body's. `link` is a name, qualified by nested
/// model names ("model::link") if ambiguous. An <inertial> gives an ImportedBody, exact in the file's numbers.
/// Properties computed from geoms or collision shapes, and repaired tensors, give a NumericBody rounded to binary64. A
/// tensor that breaks the triangle inequality by less than 1e-3 of its largest moment is repaired; a larger excess is
/// refused unless `balance_inertia`. Throws InputError.
BodyDefinition parse_robot_body(std::string_view text, const std::string& path, const std::string& link,
                                bool balance_inertia = false, const RobotFiles& files = {});

}  // namespace polhode
