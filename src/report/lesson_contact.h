// The contact of a lesson's body with a plane, as numbers for the page (page/source/lesson/contact.ts).
#pragma once

#include "report/json_numbers.h"
#include "scene/scene.h"
#include "text/json_document.h"

namespace polhode {

/// The shape that touches, the plane, and the start of a scene with a plane; null for a scene without planes. Fails at
/// `node` if the page cannot compute the scene: it follows a body that touches one plane from the start, without
/// approaching it, with a sphere or an ellipsoid that contains the rest of the body.
Json lesson_contact_json(const JsonNode& node, const Scene& scene);

}  // namespace polhode
