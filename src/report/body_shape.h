// Shapes of bodies for the report page.
#pragma once

#include <string>

#include "report/json_numbers.h"
#include "scene/scene.h"

namespace polhode {

/// The body as BodyShape of src/report/page/source/data.ts: parts, mesh or points relative to the centre of mass in
/// body axes, and the principal moments. The page draws a box with these moments if the body has no shape.
Json body_shape_json(const std::string& name, const Body& body);

/// Principal moments (kg m^2) and axes of the inertia about `point` (m, from the body's origin), or about the centre of
/// mass.
Json principal_json(const Body& body, const std::optional<Vector3<double>>& point);

}  // namespace polhode
