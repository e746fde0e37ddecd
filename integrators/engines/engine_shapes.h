// Shapes of a body's hull in the terms of engines: the members `shapes`, `hull` and `ball` of a request.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "scene/scene.h"

namespace polhode {

/// A convex shape of a body's hull, centred on its position and symmetric about its z axis, except polyhedra.
struct EngineShape {
    std::string type{};                      ///< ball, capsule, cylinder, disc, ellipsoid, box or polyhedron
    Vector3<double> position{};              ///< in the axes of the engine's body, from its centre of mass, m
    Quaternion<double> q{};                  ///< axes of the shape to those of the engine's body
    double radius = 0;                       ///< ball, capsule, cylinder and disc, m
    double half_height = 0;                  ///< cylinder, and the cylindrical part of a capsule, m
    Vector3<double> half{};                  ///< half extents of a box, semi-axes of an ellipsoid, m
    std::vector<Vector3<double>> corners{};  ///< polyhedron, and those of a box; in the axes of the engine's body, m

    /// Whether it is a ball about the centre of mass, which every engine with planes supports.
    bool is_centered_ball() const;
};

/// The shapes of a body that may touch planes: the contact with a plane is that of their convex hull. A ball inside
/// another ball is omitted. `center`: the body's centre of mass in its own axes, m; q_BP: axes of the engine's body to
/// the body's. Throws std::invalid_argument with a short reason for a shape that engines do not support.
std::vector<EngineShape> engine_shapes(const Body& body, const Vector3<double>& center, const Quaternion<double>& q_BP);

/// Why an engine whose hello lists `types` does not support the shapes; empty if it does. Without any types it supports
/// a ball about the centre of mass and a polyhedron.
std::string shapes_refusal(const std::vector<EngineShape>& shapes, const std::vector<std::string>& types);

/// The corners of all shapes if they are boxes or polyhedra; else empty.
std::vector<Vector3<double>> polyhedron_corners(const std::vector<EngineShape>& shapes);

}  // namespace polhode
