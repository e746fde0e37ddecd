// Reader and writer of the member "body" of scene files.
//
// ways() lists the descriptions of a body (numbers, shape, parts, points, mesh, import) by the key that identifies
// each; source() requires exactly one of them, checks the keys against scene_keys.h and builds a BodySource,
// recursively for parts. SourceWriter writes each description back as canonical JSON.

#include "scene/body_file.h"

#include <fmt/format.h>

#include <utility>

#include "scene/contact_shape.h"
#include "scene/json_values.h"
#include "scene/mesh_file.h"
#include "scene/robot_file.h"
#include "scene/robot_files.h"
#include "scene/scene_keys.h"
#include "text/decimal.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

double length(const JsonNode& object, const char* key) {
    return positive(object.require_member(key, "a length in m, > 0"), "a length in m");
}
double not_negative(const JsonNode& object, const char* key) {
    const JsonNode& node = object.require_member(key, "a length in m, >= 0");
    if (!(node.number() >= 0)) node.fail(node.describe(), "a length in m must be >= 0");
    return node.number();
}
template <std::size_t n>
std::array<double, n> lengths(const JsonNode& object, const char* key) {
    const JsonNode& node = object.require_member(key, fmt::format("{} lengths in m, > 0", n));
    const auto& e = node.elements();
    if (e.size() != n) node.fail(node.describe(), fmt::format("give {} lengths in m", n));
    std::array<double, n> values{};
    for (std::size_t i = 0; i < n; ++i) values[i] = positive(*e[i], "a length in m");
    return values;
}
Vector3<double> three_lengths(const JsonNode& object, const char* key) {
    const auto [x, y, z] = lengths<3>(object, key);
    return {x, y, z};
}
double inner_radius(const JsonNode& object, double outer) {
    const double inner = not_negative(object, "inner_radius");
    if (!(inner < outer))
        object.find("inner_radius")
            ->fail(fmt::format("is {}, but the outer radius is {}", shortest_decimal(inner), shortest_decimal(outer)),
                   "the inner radius must be smaller than the outer radius");
    return inner;
}

Shape box(const JsonNode& node) { return Box{three_lengths(node, "half_extents")}; }
Shape sphere(const JsonNode& node) { return SolidSphere{length(node, "radius")}; }
Shape hollow_sphere(const JsonNode& node) {
    const double outer = length(node, "outer_radius");
    return HollowSphere{outer, inner_radius(node, outer)};
}
Shape cylinder(const JsonNode& node) { return Cylinder{length(node, "radius"), length(node, "half_height")}; }
Shape hollow_cylinder(const JsonNode& node) {
    const double outer = length(node, "outer_radius");
    return HollowCylinder{outer, inner_radius(node, outer), length(node, "half_height")};
}
Shape capsule(const JsonNode& node) { return Capsule{length(node, "radius"), length(node, "half_height")}; }
Shape cone(const JsonNode& node) { return Cone{length(node, "radius"), length(node, "height")}; }
Shape ellipsoid(const JsonNode& node) { return Ellipsoid{three_lengths(node, "semi_axes")}; }
Shape torus(const JsonNode& node) {
    const Torus torus{length(node, "major_radius"), length(node, "minor_radius")};
    if (!(torus.minor_radius <= torus.major_radius))
        node.find("minor_radius")
            ->fail(fmt::format("is {}, but the major radius is {}", shortest_decimal(torus.minor_radius),
                               shortest_decimal(torus.major_radius)),
                   "the minor radius must not exceed the major radius");
    return torus;
}
Shape rod(const JsonNode& node) { return ThinRod{length(node, "length")}; }
Shape disc(const JsonNode& node) { return ThinDisc{length(node, "radius")}; }
Shape plate(const JsonNode& node) { return ThinPlate{lengths<2>(node, "half_extents")}; }
Shape tetrahedron(const JsonNode& node) {
    const JsonNode& vertices = node.require_member("vertices", "4 points [x, y, z] in m");
    if (vertices.elements().size() != 4) vertices.fail(vertices.describe(), "give 4 points [x, y, z]");
    Tetrahedron shape;
    for (std::size_t i = 0; i < 4; ++i) shape.vertices[i] = vector3(*vertices.elements()[i]);
    if (six_volumes(shape) == 0)
        vertices.fail("has no volume: the four points lie in a plane", "give 4 points that do not lie in a plane");
    return shape;
}
Shape frustum(const JsonNode& node) {
    const Frustum shape{not_negative(node, "bottom_radius"), not_negative(node, "top_radius"), length(node, "height")};
    if (shape.bottom_radius == 0 && shape.top_radius == 0)
        node.find("top_radius")->fail("is 0, and the bottom radius is 0 too", "give at least one radius > 0");
    return shape;
}

constexpr std::pair<const char*, Shape (*)(const JsonNode&)> shapes[] = {
    {"box", box},
    {"sphere", sphere},
    {"hollow_sphere", hollow_sphere},
    {"cylinder", cylinder},
    {"hollow_cylinder", hollow_cylinder},
    {"capsule", capsule},
    {"cone", cone},
    {"ellipsoid", ellipsoid},
    {"torus", torus},
    {"rod", rod},
    {"disc", disc},
    {"plate", plate},
    {"tetrahedron", tetrahedron},
    {"frustum", frustum},
};

Shape shape(const JsonNode& node) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"type\": .., ..}");
    std::vector<std::string> names;
    for (const auto& [name, read] : shapes) names.push_back(name);
    const JsonNode& type = node.require_member("type", "one of " + join_with_commas(names));
    for (const auto& [name, read] : shapes)
        if (type.string() == name) {
            node.require_known_keys(keys_of(scene_keys(), fmt::format("shape {}", name)));
            return read(node);
        }
    const std::string meant = did_you_mean(type.string(), names);
    type.fail(type.describe(),
              fmt::format("{}{}give one of {}", meant, meant.empty() ? "" : " ", join_with_commas(names)));
}

Amount amount(const JsonNode& node, bool is_part) {
    const JsonNode *mass = node.find("mass"), *density = node.find("density");
    if (mass && density) density->fail("is given together with a mass", "give the mass or the density, not both");
    if (mass)
        return {positive(*mass, is_part ? "the mass of a part (a hole has a negative density)" : "the mass"), false};
    if (!density) node.require_member("density", "the density in kg/m^3, or \"mass\" in kg");
    const double value = density->number();
    if (value == 0 || (value < 0 && !is_part))
        density->fail(density->describe(),
                      is_part ? "the density of a part must not be 0; a hole has a negative density"
                              : "the density must be > 0; only a part can be a hole (negative density)");
    return {value, true};
}

Matrix3<double> inertia(const JsonNode& node) {
    const char* remedy = "give 3 moments or a 3x3 matrix in kg m^2";
    const auto& e = node.elements();
    if (e.size() != 3) node.fail(node.describe(), remedy);
    if (!e[0]->is_array()) {
        for (const JsonNode* moment : e)
            if (!moment->is_number()) moment->fail(moment->describe(), remedy);
        return diagonal(vector3(node));
    }
    Matrix3<double> m;
    for (int i = 0; i < 3; ++i) {
        if (!e[i]->is_array() || e[i]->elements().size() != 3) e[i]->fail(e[i]->describe(), "give a row of 3 numbers");
        m[i] = vector3(*e[i]);
    }
    return m;
}

BodyDefinition parse_numeric_body(const JsonNode& node, const std::string&, bool is_part) {
    NumericBody b;
    const JsonNode& mass = node.require_member("mass", "the mass in kg");
    b.mass = mass.number();
    // a massless body of a mechanism has no moments
    const JsonNode* moments = node.find("inertia");
    if (!moments && (is_part || b.mass != 0 || node.find("contact_shape")))
        moments = &node.require_member("inertia", "3 moments or a 3x3 matrix about the centre of mass in kg m^2");
    if (moments) b.inertia = inertia(*moments);
    if (const JsonNode* center = node.find("center_of_mass")) b.center_of_mass = vector3(*center);
    const JsonNode* hull = node.find("contact_shape");
    if (is_part || hull) {
        positive(mass, is_part ? "the mass of a part (a hole has a negative density)" : "the mass");
        if (const std::string fault = tensor_fault(b.inertia); !fault.empty())
            moments->fail(fault, is_part ? "give a physically possible inertia tensor; a part's moments may be 0"
                                         : "give a physically possible inertia tensor");
    }
    if (hull) return with_contact_shape(b, shape(*hull));
    return b;
}

BodyDefinition parse_shaped_body(const JsonNode& node, const std::string&, bool is_part) {
    return ShapedBody{shape(*node.find("shape")), amount(node, is_part)};
}

BodyDefinition parse_points_body(const JsonNode& node, const std::string&, bool) {
    const JsonNode& list = *node.find("points");
    PointsBody body;
    if (list.elements().empty()) list.fail("has no points", "give at least one [mass, x, y, z]");
    for (const JsonNode* one : list.elements()) {
        const auto& e = one->elements();
        if (e.size() != 4) one->fail(one->describe(), "give [mass in kg, x, y, z in m]");
        body.points.push_back({positive(*e[0], "a point's mass"), {e[1]->number(), e[2]->number(), e[3]->number()}});
    }
    return body;
}

// One factor for all axes, or one per axis.
Vector3<double> mesh_scale(const JsonNode& node) {
    const Vector3<double> scale =
        node.is_number() ? Vector3<double>(node.number(), node.number(), node.number()) : vector3(node);
    for (int i = 0; i < 3; ++i)
        if (scale[i] == 0) node.fail(node.describe(), "give factors in m per unit of the file, not 0");
    return scale;
}

BodyDefinition parse_mesh_body(const JsonNode& node, const std::string& directory, bool is_part) {
    const JsonNode& file = *node.find("mesh");
    const JsonNode* scale = node.find("scale");
    const Amount how_much = amount(node, is_part);
    try {
        auto [mesh, hash] = read_mesh(directory, file.string());
        if (scale) mesh.scale = mesh_scale(*scale);
        return MeshBody{file.string(), std::move(hash), std::move(mesh), how_much};
    } catch (const InputError& error) {
        file.fail(error);
    }
}

BodyDefinition parse_imported_body(const JsonNode& node, const std::string& directory, bool) {
    const JsonNode& import = *node.find("import");
    import.require_known_keys(keys_of(scene_keys(), "import"));
    const JsonNode& file = import.require_member("file", "the path of a URDF, MJCF or SDFormat file");
    const JsonNode& link = import.require_member("link", "the name of the link or body");
    const JsonNode* balance = import.find("balance_inertia");
    try {
        BodyDefinition body =
            parse_robot_body(robot_text(directory, file.string()), path_in(directory, file.string()), link.string(),
                             balance && balance->boolean(), {directory, file.string()});
        if (auto* parse_imported_body = std::get_if<ImportedBody>(&body))
            parse_imported_body->file = file.string(), parse_imported_body->link = link.string();
        return body;
    } catch (const InputError& error) {
        import.fail(error);
    }
}

std::shared_ptr<const BodySource> parse_source(const JsonNode& node, const std::string& directory, bool is_part);

BodyDefinition parse_parts_body(const JsonNode& node, const std::string& directory, bool) {
    const JsonNode& list = *node.find("parts");
    if (list.elements().empty()) list.fail("has no parts", "give at least one body");
    PartsBody body;
    for (const JsonNode* one : list.elements()) {
        PartsBody::Part part;
        part.body = parse_source(*one, directory, true);
        if (const JsonNode* position = one->find("position")) part.position = vector3(*position);
        if (const JsonNode* orientation = one->find("orientation")) {
            part.orientation = quaternion(*orientation);
            if (const std::string fault = norm_fault(part.orientation); !fault.empty())
                orientation->fail(fault, norm_remedy);
        }
        body.parts.push_back(std::move(part));
    }
    return body;
}

// The ways to describe a body, each identified by its key. The first also applies if no key is present.
struct BodyFormat {
    const char* key;
    BodyDefinition (*read)(const JsonNode&, const std::string& directory, bool is_part);
    const char* object;  // object name in the table of keys
};
const std::vector<BodyFormat>& body_formats() {
    static const std::vector<BodyFormat> all{
        {"inertia", parse_numeric_body, "body"},      {"shape", parse_shaped_body, "body of a shape"},
        {"parts", parse_parts_body, "body of parts"}, {"points", parse_points_body, "body of points"},
        {"mesh", parse_mesh_body, "body of a mesh"},  {"import", parse_imported_body, "body imported"},
    };
    return all;
}

std::shared_ptr<const BodySource> parse_source(const JsonNode& node, const std::string& directory, bool is_part) {
    if (!node.is_object()) node.fail(node.describe(), "give an object {\"mass\": .., \"inertia\": ..}");
    const BodyFormat* chosen = nullptr;
    for (const BodyFormat& candidate : body_formats()) {
        const JsonNode* member = node.find(candidate.key);
        if (!member) continue;
        if (chosen)
            member->fail(fmt::format("\"{}\" is given together with \"{}\"", candidate.key, chosen->key),
                         "give the mass properties in exactly one way");
        chosen = &candidate;
    }
    if (!chosen) chosen = &body_formats().front();
    std::vector<std::string_view> keys = keys_of(scene_keys(), chosen->object);
    if (is_part) {
        const std::vector<std::string_view> more = keys_of(scene_keys(), "part");
        keys.insert(keys.end(), more.begin(), more.end());
    }
    node.require_known_keys(keys);
    return body_source(chosen->read(node, directory, is_part));
}

// Writes three moments if all off-diagonal entries are zero, else the matrix.
std::string json_tensor(const Matrix3<double>& m) {
    const bool is_diagonal = m == diagonal(Vector3<double>(m[0][0], m[1][1], m[2][2]));
    if (is_diagonal) return write_json(Vector3<double>(m[0][0], m[1][1], m[2][2]));
    return fmt::format("[{}, {}, {}]", write_json(m[0]), write_json(m[1]), write_json(m[2]));
}

struct ShapeWriter {
    using Member = std::pair<const char*, double>;
    static std::string object(const char* type, std::initializer_list<Member> members) {
        std::string text = fmt::format("{{\"type\": \"{}\"", type);
        for (const auto& [key, value] : members) text += fmt::format(", \"{}\": {}", key, shortest_decimal(value));
        return text + "}";
    }
    std::string operator()(const Box& s) const {
        return fmt::format(R"({{"type": "box", "half_extents": {}}})", write_json(s.half_extents));
    }
    std::string operator()(const SolidSphere& s) const { return object("sphere", {{"radius", s.radius}}); }
    std::string operator()(const HollowSphere& s) const {
        return object("hollow_sphere", {{"outer_radius", s.outer_radius}, {"inner_radius", s.inner_radius}});
    }
    std::string operator()(const Cylinder& s) const {
        return object("cylinder", {{"radius", s.radius}, {"half_height", s.half_height}});
    }
    std::string operator()(const HollowCylinder& s) const {
        return object(
            "hollow_cylinder",
            {{"outer_radius", s.outer_radius}, {"inner_radius", s.inner_radius}, {"half_height", s.half_height}});
    }
    std::string operator()(const Capsule& s) const {
        return object("capsule", {{"radius", s.radius}, {"half_height", s.half_height}});
    }
    std::string operator()(const Cone& s) const { return object("cone", {{"radius", s.radius}, {"height", s.height}}); }
    std::string operator()(const Ellipsoid& s) const {
        return fmt::format(R"({{"type": "ellipsoid", "semi_axes": {}}})", write_json(s.semi_axes));
    }
    std::string operator()(const Torus& s) const {
        return object("torus", {{"major_radius", s.major_radius}, {"minor_radius", s.minor_radius}});
    }
    std::string operator()(const ThinRod& s) const { return object("rod", {{"length", s.length}}); }
    std::string operator()(const ThinDisc& s) const { return object("disc", {{"radius", s.radius}}); }
    std::string operator()(const ThinPlate& s) const {
        return fmt::format(R"({{"type": "plate", "half_extents": [{}, {}]}})", shortest_decimal(s.half_extents[0]),
                           shortest_decimal(s.half_extents[1]));
    }
    std::string operator()(const Tetrahedron& s) const {
        return fmt::format(R"({{"type": "tetrahedron", "vertices": [{}, {}, {}, {}]}})", write_json(s.vertices[0]),
                           write_json(s.vertices[1]), write_json(s.vertices[2]), write_json(s.vertices[3]));
    }
    std::string operator()(const Frustum& s) const {
        return object("frustum",
                      {{"bottom_radius", s.bottom_radius}, {"top_radius", s.top_radius}, {"height", s.height}});
    }
};

struct SourceWriter {
    static std::string json_amount(const Amount& amount) {
        return fmt::format("\"{}\": {}", amount.is_density ? "density" : "mass", shortest_decimal(amount.value));
    }
    std::string operator()(const NumericBody& b) const {
        return fmt::format("\"mass\": {},\n    \"inertia\": {},\n    \"center_of_mass\": {}", shortest_decimal(b.mass),
                           json_tensor(b.inertia), write_json(b.center_of_mass));
    }
    std::string operator()(const ShapedBody& b) const {
        return fmt::format("\"shape\": {}, {}", std::visit(ShapeWriter{}, b.shape), json_amount(b.amount));
    }
    std::string operator()(const PointsBody& b) const {
        std::string text = "\"points\": [";
        for (const PointMass<double>& point : b.points)
            text += fmt::format("{}[{}, {}, {}, {}]", &point == &b.points.front() ? "" : ", ",
                                shortest_decimal(point.mass), shortest_decimal(point.position[0]),
                                shortest_decimal(point.position[1]), shortest_decimal(point.position[2]));
        return text + "]";
    }
    // the file's hash is part of the scene's identity, like its name
    std::string operator()(const MeshBody& b) const {
        const Vector3<double>& s = b.mesh.scale;
        const std::string scale = s == Vector3<double>(1, 1, 1) ? ""
                                  : s[0] == s[1] && s[1] == s[2]
                                      ? fmt::format("\"scale\": {}, ", shortest_decimal(s[0]))
                                      : fmt::format("\"scale\": {}, ", write_json(s));
        return fmt::format("\"mesh\": {} /* {} */, {}{}", json_string(b.file), b.hash, scale, json_amount(b.amount));
    }
    std::string operator()(const ImportedBody& b) const {
        return fmt::format("\"import\": {{\"file\": {} /* {} */, \"link\": {}}}", json_string(b.file), b.hash,
                           json_string(b.link));
    }
    std::string operator()(const PartsBody& b) const {
        if (const Shape* hull = contact_shape(b))
            return fmt::format("{},\n    \"contact_shape\": {}", (*this)(numbers_beside_contact_shape(b)),
                               std::visit(ShapeWriter{}, *hull));
        std::string text = "\"parts\": [";
        for (const PartsBody::Part& part : b.parts) {
            text += fmt::format("{}\n      {{{}, \"position\": {}, \"orientation\": {}}}",
                                &part == &b.parts.front() ? "" : ",", std::visit(*this, part.body->definition),
                                write_json(part.position), write_json(part.orientation));
        }
        return text + "\n    ]";
    }
};

}  // namespace

Body parse_body(const JsonNode& node, const std::string& directory) {
    return body_of(parse_source(node, directory, false));
}

std::string write_body(const Body& body) {
    if (body.source) return std::visit(SourceWriter{}, body.source->definition);
    return SourceWriter{}(NumericBody{body.mass, body.inertia_B, body.center_of_mass});
}

}  // namespace polhode
