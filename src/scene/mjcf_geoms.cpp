// Masses of MJCF geoms: primitives, meshes, and primitives fitted to meshes.
#include <fmt/format.h>

#include <algorithm>

#include "scene/mjcf_mass.h"
#include "scene/robot_parts.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr const char* inertial_remedy = "give the body an <inertial>";

// `size` has half sizes in the order of MuJoCo's "size". Lengths computed from fromto are rounded to binary64, the
// type of shapes.
Shape primitive(const std::string& type, const std::array<double, 3>& size) {
    if (type == "sphere") return SolidSphere{size[0]};
    if (type == "capsule") return Capsule{size[0], size[1]};
    if (type == "cylinder") return Cylinder{size[0], size[1]};
    const Vector3<double> three{size[0], size[1], size[2]};
    if (type == "box") return Box{three};
    return Ellipsoid{three};
}

std::size_t sizes_of(const std::string& type) {
    return type == "sphere" ? 1 : type == "capsule" || type == "cylinder" ? 2 : 3;
}

Extent<Wide> primitive_extent(const std::string& type, const std::array<double, 3>& size, bool shell) {
    const Shape shape = primitive(type, size);
    return shell ? mjcf_shell(shape) : extent<Wide>(shape);
}

bool is_primitive(const std::string& type) {
    return type == "sphere" || type == "capsule" || type == "cylinder" || type == "box" || type == "ellipsoid";
}

// The axes of an extent in order of increasing spread, and the half sizes of the box with the same spread.
struct InertiaBox {
    std::array<Vector3<Wide>, 3> axes;
    std::array<Wide, 3> half{};
};
InertiaBox inertia_box(const Extent<Wide>& e) {
    const MassProperties<Wide> body = uniform_body(e, Wide(1));
    const WidePrincipalFrame frame = wide_principal_frame(body.inertia);
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return frame.moments[a] > frame.moments[b]; });
    const Wide trace = frame.moments[0] + frame.moments[1] + frame.moments[2];
    InertiaBox box;
    for (std::size_t k = 0; k < 3; ++k) {
        Vector3<Wide> axis;
        axis[order[k]] = Wide(1);
        box.axes[k] = rotate(frame.q_BP, axis);
        // the spread along an axis is half the trace minus the moment, and one third of the box's squared half size
        const Wide square = Wide(3) * (trace / Wide(2) - frame.moments[order[k]]);
        box.half[k] = square > Wide(0) ? square_root(square) : Wide(0);
    }
    return box;
}

std::vector<double> given_sizes(const RobotXml& xml, const XMLElement& at) {
    const char* text = at.Attribute("size");
    return text ? xml.numbers(at, "size", text, 1, 3) : std::vector<double>{};
}

// Half sizes and pose of a primitive given by two end points (fromto).
std::array<double, 3> spanned(const RobotXml& xml, const XMLElement& at, const std::string& type, RobotPose& place) {
    if (type == "sphere")
        xml.fail(at, "is a sphere and has fromto", "use fromto only for capsule, cylinder, box and ellipsoid");
    if (at.Attribute("pos") && three_of(xml.attribute(at, "pos", 3)) != Vector3<double>())
        xml.fail(at, "has both pos and fromto", "remove one of them");
    const std::vector<double> v = xml.attribute(at, "fromto", 6), size = given_sizes(xml, at);
    const Vector3<Wide> a = cast<Wide>(three_of(v)), b = cast<Wide>(three_of(v, 3));
    place = {Wide(0.5) * (a + b), rotation_from_z(xml, at, "fromto", a - b)};
    const double half = double(square_root(dot(b - a, b - a)) / Wide(2));
    if (size.empty()) xml.fail(at, "has no size", "give the radius or half width in m");
    if (type == "capsule" || type == "cylinder") return {size[0], half, 0};
    return {size[0], size[0], half};
}

}  // namespace

// `place`: pose of the geom in its surrounding frame; on entry that of its attributes
Extent<Wide> MjcfMasses::extent(const MjcfPlaced& geom, RobotPose& place, const std::string& body) {
    const XMLElement& at = *geom.at;
    const std::string type = at.Attribute("type") ? at.Attribute("type") : "sphere";
    const bool shell = xml_.flag(at, "shellinertia");
    if (type == "mesh" || type == "sdf") return meshes_.extent(*geom.model, at, shell);
    if (type == "hfield") {
        const std::string name = xml_.name(at, "hfield", "the height field's name");
        const auto field = geom.model->height_fields.find(name);
        if (field == geom.model->height_fields.end())
            xml_.fail(at, fmt::format("has the height field \"{}\", which no <asset> defines", one_line(name, 60)),
                      "define it by <asset><hfield>");
        const std::vector<double> v = xml_.attribute(*field->second, "size", 4);
        return primitive_extent("box", {v[0], v[1], 0.25 * v[2] + 0.5 * v[3]}, shell);
    }
    if (!is_primitive(type))
        xml_.fail(at, fmt::format("has the type \"{}\"", one_line(type, 40)),
                  "give plane, hfield, sphere, capsule, ellipsoid, cylinder, box, mesh or sdf");
    if (shell && type == "ellipsoid") note("ellipsoid shells, computed by MuJoCo's approximations", body);
    if (at.Attribute("mesh")) return fitted(geom, type, shell);
    std::array<double, 3> size{};
    if (at.Attribute("fromto")) {
        size = spanned(xml_, at, type, place);
    } else {
        const std::vector<double> v = given_sizes(xml_, at);
        if (v.size() < sizes_of(type))
            xml_.fail(at, fmt::format("has {} numbers in size", v.size()), fmt::format("give {}", sizes_of(type)));
        std::copy(v.begin(), v.end(), size.begin());
    }
    for (std::size_t i = 0; i < sizes_of(type); ++i)
        if (!(size[i] > 0)) xml_.fail(at, "has no volume", "give half lengths in m, > 0, or mass=\"0\"");
    return primitive_extent(type, size, shell);
}

// A primitive with a mesh takes the pose and size of the mesh's equivalent inertia box (MuJoCo's mjCMesh::FitGeom).
Extent<Wide> MjcfMasses::fitted(const MjcfPlaced& geom, const std::string& type, bool shell) {
    const XMLElement& at = *geom.at;
    if (geom.model->compiler.fits_box)
        xml_.fail(at, "is fitted to the bounding box of a mesh (fitaabb), which is not supported", inertial_remedy);
    if (at.Attribute("fromto")) xml_.fail(at, "has both a mesh and fromto", "remove one of them");
    const Extent<Wide>& mesh = meshes_.extent(*geom.model, at, false);
    const InertiaBox box = inertia_box(mesh);
    const bool has_axis = type == "capsule" || type == "cylinder";
    if (has_axis && !(box.half[2] - box.half[1] > Wide(1e-9) * box.half[2]))
        xml_.fail(at, fmt::format("is a {} fitted to a mesh that has no longest axis", type), inertial_remedy);
    const auto& b = box.half;
    const Wide radius = type == "sphere" ? (b[0] + b[1] + b[2]) / Wide(3) : (b[0] + b[1]) / Wide(2);
    const Wide tube = type == "capsule" ? std::max(Wide(0), b[2] - radius / Wide(2)) : b[2];
    const Wide scale(xml_.attribute_or(at, "fitscale", 1));
    const std::array<Wide, 3> size = type == "sphere" ? std::array<Wide, 3>{radius, Wide(0), Wide(0)}
                                     : has_axis       ? std::array<Wide, 3>{radius, tube, Wide(0)}
                                                      : b;
    std::array<double, 3> rounded{};
    for (std::size_t i = 0; i < 3; ++i) rounded[i] = double(scale * size[i]);
    for (std::size_t i = 0; i < sizes_of(type); ++i)
        if (!(rounded[i] > 0)) xml_.fail(at, "has no volume", inertial_remedy);
    Extent<Wide> e = primitive_extent(type, rounded, shell);
    Matrix3<Wide> spread;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                spread[i][j] = spread[i][j] + e.spread[k][k] * box.axes[static_cast<std::size_t>(k)][i] *
                                                  box.axes[static_cast<std::size_t>(k)][j];
    return {e.size, mesh.mean, spread};
}

std::optional<MassProperties<Wide>> MjcfMasses::of_geom(const Body& body, const MjcfPlaced& geom) {
    constexpr double no_mass = 1e-14;    // kg, MuJoCo's bound
    constexpr double no_volume = 1e-14;  // m^3
    const XMLElement& at = *geom.at;
    const MjcfCompiler& compiler = body.model->compiler;
    const double group = xml_.attribute_or(at, "group", 0);
    const bool is_plane = at.Attribute("type") && std::string_view(at.Attribute("type")) == "plane";
    if (is_plane || group < compiler.first_group || group > compiler.last_group) return {};
    const bool by_mass = at.Attribute("mass");
    const double amount = by_mass ? xml_.attribute_or(at, "mass", 0) : xml_.attribute_or(at, "density", 1000);
    if (amount == 0) return {};
    if (!(amount > 0)) xml_.fail(at, "has a negative mass or density", "give a number >= 0");
    RobotPose place;
    if (!at.Attribute("fromto")) place = mjcf_pose(xml_, at, geom.model->compiler);
    const Extent<Wide> e = extent(geom, place, body.name);
    const MassProperties<Wide> mass = uniform_body(e, by_mass ? Wide(amount) : Wide(amount) * e.size);
    if (!(mass.mass > Wide(no_mass))) return {};
    if (by_mass && !(e.size > Wide(no_volume)))
        note("shapes below 1e-14 m^3, included with the given mass (MuJoCo 3 ignores them)", body.name);
    if (!by_mass && !at.Attribute("density")) note("shapes with MuJoCo's default density of 1000 kg/m^3", body.name);
    if (compiler.drops_visual && xml_.attribute_or(at, "contype", 1) == 0 &&
        xml_.attribute_or(at, "conaffinity", 1) == 0)
        note("bodies with the mass of visual shapes, as in MuJoCo 3 (MuJoCo 2 discards it)", body.name);
    const RobotPose pose = geom.pose * place;
    return placed(mass, pose.position, pose.turn);
}

}  // namespace polhode
