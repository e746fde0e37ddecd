#include "report/body_shape.h"

#include "body/mass_properties.h"
#include "body/rigid_body.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

// A mesh with more triangles is drawn as the box of its moments, to keep the page small.
constexpr std::size_t most_triangles = 4000;

struct Sizes {
    const char* type;
    Json sizes;
};

Json number(double value) { return number_json(value, 6); }

Sizes sizes_of(const Box& s) { return {"box", {{"half_extents", vector_json(s.half_extents)}}}; }
Sizes sizes_of(const SolidSphere& s) { return {"sphere", {{"radius", number(s.radius)}}}; }
Sizes sizes_of(const HollowSphere& s) {
    return {"hollow_sphere", {{"outer_radius", number(s.outer_radius)}, {"inner_radius", number(s.inner_radius)}}};
}
Sizes sizes_of(const Cylinder& s) {
    return {"cylinder", {{"radius", number(s.radius)}, {"half_height", number(s.half_height)}}};
}
Sizes sizes_of(const HollowCylinder& s) {
    return {"hollow_cylinder",
            {{"outer_radius", number(s.outer_radius)},
             {"inner_radius", number(s.inner_radius)},
             {"half_height", number(s.half_height)}}};
}
Sizes sizes_of(const Capsule& s) {
    return {"capsule", {{"radius", number(s.radius)}, {"half_height", number(s.half_height)}}};
}
Sizes sizes_of(const Cone& s) { return {"cone", {{"radius", number(s.radius)}, {"height", number(s.height)}}}; }
Sizes sizes_of(const Ellipsoid& s) { return {"ellipsoid", {{"semi_axes", vector_json(s.semi_axes)}}}; }
Sizes sizes_of(const Torus& s) {
    return {"torus", {{"major_radius", number(s.major_radius)}, {"minor_radius", number(s.minor_radius)}}};
}
Sizes sizes_of(const ThinRod& s) { return {"rod", {{"length", number(s.length)}}}; }
Sizes sizes_of(const ThinDisc& s) { return {"disc", {{"radius", number(s.radius)}}}; }
Sizes sizes_of(const ThinPlate& s) {
    return {"plate", {{"half_extents", {number(s.half_extents[0]), number(s.half_extents[1])}}}};
}
Sizes sizes_of(const Tetrahedron& s) {
    Json vertices = Json::array();
    for (const Vector3<double>& v : s.vertices)
        for (int i = 0; i < 3; ++i) vertices.push_back(number(v[i]));
    return {"tetrahedron", {{"vertices", vertices}}};
}
Sizes sizes_of(const Frustum& s) {
    return {"frustum",
            {{"bottom_radius", number(s.bottom_radius)},
             {"top_radius", number(s.top_radius)},
             {"height", number(s.height)}}};
}

// Placement of a part in its body: r_B = position + R(orientation) r.
struct Place {
    Vector3<double> position;
    Quaternion<double> orientation;

    Vector3<double> at(const Vector3<double>& r) const { return position + rotate(orientation, r); }
};

class ShapeWriter {
  public:
    void add(const BodyDefinition& definition, const Place& place) {
        std::visit([&](const auto& body) { add_body(body, place); }, definition);
    }

    Json parts = Json::array(), vertices = Json::array(), faces = Json::array(), points = Json::array();

  private:
    void add_body(const NumericBody&, const Place&) {}   // no shape: the page draws the box of the moments
    void add_body(const ImportedBody&, const Place&) {}  // no shape: the page draws the box of the moments
    void add_body(const ShapedBody& body, const Place& place) {
        Sizes sizes = std::visit([](const auto& shape) { return sizes_of(shape); }, body.shape);
        parts.push_back({{"type", sizes.type},
                         {"sizes", std::move(sizes.sizes)},
                         {"position", vector_json(place.position)},
                         {"orientation", quaternion_json(place.orientation)},
                         {"hole", body.amount.value < 0}});
    }
    void add_body(const PointsBody& body, const Place& place) {
        for (const PointMass<double>& point : body.points) push(points, place.at(point.position));
    }
    void add_body(const MeshBody& body, const Place& place) {
        if (body.mesh.triangles.size() > most_triangles) return;
        const auto first = vertices.size() / 3;
        for (std::size_t i = 0; i < body.mesh.vertices.size(); ++i)
            push(vertices, place.at(body.mesh.vertex<double>(i)));
        for (const std::array<int, 3>& triangle : body.mesh.triangles)
            for (const int corner : triangle) faces.push_back(first + static_cast<std::size_t>(corner));
    }
    void add_body(const PartsBody& body, const Place& place) {
        for (const PartsBody::Part& part : body.parts)
            add(part.body->definition, {place.at(part.position), place.orientation * normalized(part.orientation)});
    }
    static void push(Json& list, const Vector3<double>& v) {
        for (int i = 0; i < 3; ++i) list.push_back(number(v[i]));
    }
};

}  // namespace

Json principal_json(const Body& body, const std::optional<Vector3<double>>& point) {
    const MassProperties<double> about{body.mass, body.center_of_mass, body.inertia_B};
    const PrincipalFrame frame = principal_frame(cast<Wide>(point ? about_point(about, *point) : body.inertia_B));
    return {{"moments", vector_json(frame.moments)}, {"principal", quaternion_json(frame.q_BP)}};
}

Json body_shape_json(const std::string& name, const Body& body) {
    ShapeWriter writer;
    if (body.source)
        writer.add(body.source->definition, {Vector3<double>() - body.center_of_mass, Quaternion<double>{1, 0, 0, 0}});
    // a point mass without a source
    if (!body.source && body.mass > 0 && body.inertia_B == Matrix3<double>())
        writer.add(PointsBody{{{body.mass, {}}}}, {Vector3<double>(), Quaternion<double>{1, 0, 0, 0}});
    Json shape{{"name", name}, {"mass", number_json(body.mass, 6)}};
    shape.update(principal_json(body, std::nullopt));
    shape["parts"] = std::move(writer.parts);
    shape["vertices"] = writer.vertices.empty() ? Json() : std::move(writer.vertices);
    shape["faces"] = writer.faces.empty() ? Json() : std::move(writer.faces);
    shape["points"] = writer.points.empty() ? Json() : std::move(writer.points);
    return shape;
}

}  // namespace polhode
