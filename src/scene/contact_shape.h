// The hull of a body whose mass properties are given as numbers.
#pragma once

#include "scene/body_source.h"

namespace polhode {

/// A body with these mass properties and the hull of this shape, which is placed at the body's origin. Such a body has
/// two parts: the numbers, and the shape with mass 0. All parts of a scene file have a mass, so that no other body has
/// this form.
PartsBody with_contact_shape(NumericBody numbers, Shape shape);

/// The shape of a body made by with_contact_shape(); null for other bodies.
const Shape* contact_shape(const PartsBody& body);

/// The numbers of a body for which contact_shape() is not null.
const NumericBody& numbers_beside_contact_shape(const PartsBody& body);

}  // namespace polhode
