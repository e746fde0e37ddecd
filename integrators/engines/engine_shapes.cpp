// Shapes of a body's hull in the terms of engines.
//
// ShapeConverter visits the body's description: a shape is placed in the principal frame about the centre of mass, the
// shapes of parts are placed in their order. Points of plates, tetrahedra and meshes are collected to a polyhedron.
#include "integrators/engines/engine_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "body/support.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

constexpr double centering_tolerance = 1e-12;  // relative to the radius

/// Converts one shape about its own origin.
struct ShapeConverter {
    EngineShape operator()(const SolidSphere& s) const { return {.type = "ball", .radius = s.radius}; }
    EngineShape operator()(const HollowSphere& s) const { return {.type = "ball", .radius = s.outer_radius}; }
    EngineShape operator()(const Cylinder& s) const {
        return {.type = "cylinder", .radius = s.radius, .half_height = s.half_height};
    }
    EngineShape operator()(const HollowCylinder& s) const {
        return {.type = "cylinder", .radius = s.outer_radius, .half_height = s.half_height};
    }
    EngineShape operator()(const ThinDisc& s) const { return {.type = "disc", .radius = s.radius}; }
    EngineShape operator()(const Capsule& s) const {
        return {.type = "capsule", .radius = s.radius, .half_height = s.half_height};
    }
    EngineShape operator()(const Ellipsoid& s) const { return {.type = "ellipsoid", .half = s.semi_axes}; }
    EngineShape operator()(const Box& s) const {
        EngineShape box = with_corners("box", s);
        box.half = s.half_extents;
        return box;
    }
    EngineShape operator()(const ThinPlate& s) const { return with_corners("polyhedron", s); }
    EngineShape operator()(const Tetrahedron& s) const { return with_corners("polyhedron", s); }
    EngineShape operator()(const ThinRod& s) const { return with_corners("polyhedron", s); }
    EngineShape operator()(const Cone&) const { return refuse("cones"); }
    EngineShape operator()(const Torus&) const { return refuse("tori"); }
    EngineShape operator()(const Frustum&) const { return refuse("frusta"); }

  private:
    [[noreturn]] static EngineShape refuse(const char* shapes) {
        throw std::invalid_argument(fmt::format("engines do not support {} on planes", shapes));
    }
    template <class Corners>
    static EngineShape with_corners(const char* type, const Corners& shape) {
        EngineShape result{.type = type};
        for (const SupportPiece<double>& corner : SupportOf<double>{}(shape)) result.corners.push_back(corner.center);
        return result;
    }
};

/// Visits a body's description. Holes and masses without a shape have no hull, as in scene/body_hull.h.
struct BodyShapes {
    std::vector<EngineShape> operator()(const ShapedBody& body) const {
        if (body.amount.value < 0) return {};
        return {std::visit(ShapeConverter{}, body.shape)};
    }
    std::vector<EngineShape> operator()(const MeshBody& body) const {
        if (body.amount.value < 0) return {};
        EngineShape hull{.type = "polyhedron"};
        for (const SupportPiece<double>& corner : support<double>(body.mesh)) hull.corners.push_back(corner.center);
        return {hull};
    }
    std::vector<EngineShape> operator()(const PartsBody& body) const {
        std::vector<EngineShape> all;
        for (const PartsBody::Part& part : body.parts)
            for (EngineShape& shape : std::visit(*this, part.body->definition)) {
                place(shape, part.position, normalized(part.orientation));
                all.push_back(std::move(shape));
            }
        return all;
    }
    template <class Other>
    std::vector<EngineShape> operator()(const Other&) const {
        return {};
    }

    static void place(EngineShape& shape, const Vector3<double>& position, const Quaternion<double>& q) {
        shape.position = position + rotate(q, shape.position), shape.q = q * shape.q;
        for (Vector3<double>& corner : shape.corners) corner = position + rotate(q, corner);
    }
};

bool is_inside(const EngineShape& ball, const EngineShape& other) {
    return ball.type == "ball" && other.type == "ball" &&
           hypotenuse(ball.position - other.position) + ball.radius <= other.radius;
}

void omit_inner_balls(std::vector<EngineShape>& shapes) {
    for (std::size_t i = shapes.size(); i-- > 0;) {
        const auto covers = [&](const EngineShape& other) {
            return &other != &shapes[i] && is_inside(shapes[i], other);
        };
        if (std::ranges::any_of(shapes, covers)) shapes.erase(shapes.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

bool lists(const std::vector<std::string>& types, const std::string& type) {
    return std::ranges::find(types, type) != types.end();
}

std::string plural(const std::string& type) {
    return type == "box" ? "boxes" : type == "polyhedron" ? "polyhedra" : type + "s";
}

}  // namespace

bool EngineShape::is_centered_ball() const {
    return type == "ball" && hypotenuse(position) <= centering_tolerance * radius;
}

std::vector<EngineShape> engine_shapes(const Body& body, const Vector3<double>& center,
                                       const Quaternion<double>& q_BP) {
    if (!body.source) return {};
    std::vector<EngineShape> shapes = std::visit(BodyShapes{}, body.source->definition);
    const Quaternion<double> q_PB = conjugate(q_BP);
    for (EngineShape& shape : shapes) BodyShapes::place(shape, -rotate(q_PB, center), q_PB);
    omit_inner_balls(shapes);
    return shapes;
}

std::string shapes_refusal(const std::vector<EngineShape>& shapes, const std::vector<std::string>& types) {
    const bool is_polyhedron = !polyhedron_corners(shapes).empty();
    if (types.empty()) {
        if (is_polyhedron || (shapes.size() == 1 && shapes.front().is_centered_ball())) return "";
        return "its driver supports only polyhedra and balls about the centre of mass on planes";
    }
    if (is_polyhedron && lists(types, "polyhedron")) return "";
    for (const EngineShape& shape : shapes)
        if (!lists(types, shape.type)) return fmt::format("it does not support {} on planes", plural(shape.type));
    if (shapes.size() > 1 && !lists(types, "several")) return "it does not support bodies of several shapes on planes";
    return "";
}

std::vector<Vector3<double>> polyhedron_corners(const std::vector<EngineShape>& shapes) {
    std::vector<Vector3<double>> corners;
    for (const EngineShape& shape : shapes) {
        if (shape.corners.empty()) return {};
        corners.insert(corners.end(), shape.corners.begin(), shape.corners.end());
    }
    return corners;
}

}  // namespace polhode
