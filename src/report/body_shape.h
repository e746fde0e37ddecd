// What a body looks like, for the page.
#pragma once

#include <string>

#include "report/json_numbers.h"
#include "scene/scene.h"

namespace polhode {

/// The body as the page draws it (BodyShape of src/report/page/source/data.ts): its parts with their own sizes and
/// places from the centre of mass in body axes, a mesh, points, or neither, and the moments that a box is drawn from.
Json body_shape_json(const std::string& name, const Body& body);

/// Moments (kg m^2) and axes of the tensor about a point of the body (m, from its origin), or about the centre of mass.
Json principal_json(const Body& body, const std::optional<Vector3<double>>& point);

}  // namespace polhode
