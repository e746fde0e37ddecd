// Mass properties of SDFormat links: from <inertial>, from SDFormat's defaults, or computed from the collisions.
//
// Computed: each collision is a uniform solid with its own <density>, else that of <inertial>, else 1000 kg/m^3. A
// <mass> with `auto` scales the sum to that mass, as libsdformat does since 14.7; <pose> and <inertia> are replaced.
#include <fmt/format.h>

#include "scene/sdf_values.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

double positive(const RobotXml& xml, const XMLElement& of, const char* name) {
    const XMLElement& at = xml.child(of, name);
    const double value = xml.content(at, 1)[0];
    if (!(value > 0)) xml.fail(at, fmt::format("is {}", shortest_decimal(value)), "give a number > 0");
    return value;
}

Vector3<double> three_positive(const RobotXml& xml, const XMLElement& of, const char* name) {
    const XMLElement& at = xml.child(of, name);
    const Vector3<double> v = three_of(xml.content(at, 3));
    for (int i = 0; i < 3; ++i)
        if (!(v[i] > 0)) xml.fail(at, fmt::format("has {}", shortest_decimal(v[i])), "give numbers > 0");
    return v;
}

// Applies diag(s) to all points: scales means and spreads, and the volume by |s_x s_y s_z|.
Extent<Wide> scaled(const Extent<Wide>& e, const Vector3<double>& by) {
    const Vector3<Wide> s = cast<Wide>(by);
    const Wide volume = s[0] * s[1] * s[2];
    Extent<Wide> result;
    result.size = e.size * (volume < 0 ? -volume : volume);
    for (int i = 0; i < 3; ++i) {
        result.mean[i] = s[i] * e.mean[i];
        for (int j = 0; j < 3; ++j) result.spread[i][j] = s[i] * s[j] * e.spread[i][j];
    }
    return result;
}

Extent<Wide> mesh_solid(const RobotXml& xml, const XMLElement& mesh, const RobotFiles& files) {
    if (const XMLElement* submesh = mesh.FirstChildElement("submesh"))
        xml.fail(*submesh, "takes a part of a mesh, whose inertia is not computed",
                 "give the part as a file of its own, or the numbers in <inertial>");
    Vector3<double> scale(1, 1, 1);
    if (const XMLElement* at = xml.optional_child(mesh, "scale")) {
        scale = three_of(xml.content(*at, 3));
        if (scale[0] * scale[1] * scale[2] == 0) xml.fail(*at, "is zero", "give factors other than 0");
    }
    std::string uri = sdf_child_text(xml, mesh, "uri", "the path of an OBJ or STL file");
    const std::size_t scheme = uri.find("://");
    if (scheme != std::string::npos) {
        // model://NAME/path: in the folder of that name around the file
        if (uri.compare(0, scheme, "model") != 0 && uri.compare(0, scheme, "file") != 0)
            xml.fail(xml.child(mesh, "uri"), fmt::format("is \"{}\"", one_line(uri, 60)),
                     "give a path relative to this file, or model://");
        uri = uri.substr(scheme + 3);
        for (const char* around : {"", "../", "../../", "models/", "../models/"})
            if (files.has(around + uri)) return scaled(mesh_extent<Wide>(files.mesh(around + uri)), scale);
    }
    try {
        return scaled(mesh_extent<Wide>(files.mesh(uri)), scale);
    } catch (const InputError& error) {
        xml.fail(mesh, fmt::format("has a mesh that cannot be read: {}", error.what()),
                 "give a mesh that can be read, or the numbers in <inertial>");
    }
}

// The extent of the solid in the frame of the collision.
Extent<Wide> solid_extent(const RobotXml& xml, const SdfSolid& solid) {
    const XMLElement& geometry = xml.child(*solid.collision, "geometry");
    const XMLElement* at = geometry.FirstChildElement();
    if (!at) xml.fail(geometry, "is empty", "give a shape with a volume");
    const std::string_view kind = at->Name();
    const auto number = [&](const char* name) { return positive(xml, *at, name); };
    if (kind == "box") return extent<Wide>(Box{0.5 * three_positive(xml, *at, "size")});
    if (kind == "sphere") return extent<Wide>(SolidSphere{number("radius")});
    if (kind == "cylinder") return extent<Wide>(Cylinder{number("radius"), 0.5 * number("length")});
    if (kind == "capsule") return extent<Wide>(Capsule{number("radius"), 0.5 * number("length")});
    if (kind == "ellipsoid") return extent<Wide>(Ellipsoid{three_positive(xml, *at, "radii")});
    if (kind == "mesh") return mesh_solid(xml, *at, solid.meshes);
    if (kind == "cone") {
        // the origin is at half height, the centre of mass a quarter of the height above the base
        Extent<Wide> cone = extent<Wide>(Cone{number("radius"), number("length")});
        cone.mean[2] = cone.mean[2] - Wide(number("length")) / Wide(4);
        return cone;
    }
    xml.fail(*at, "is a shape whose inertia SDFormat does not compute",
             "give a box, sphere, cylinder, capsule, ellipsoid, cone or mesh, or the numbers in <inertial>");
}

}  // namespace

LinkInertial sdf_given_inertial(const RobotXml& xml, const XMLElement* inertial, std::vector<std::string>& defaults) {
    ImportedBody body;
    body.mass = 1, body.inertia = diagonal(Vector3<double>(1, 1, 1));
    const XMLElement* mass = inertial ? xml.optional_child(*inertial, "mass") : nullptr;
    const XMLElement* inertia = inertial ? xml.optional_child(*inertial, "inertia") : nullptr;
    if (const XMLElement* pose = inertial ? xml.optional_child(*inertial, "pose") : nullptr) {
        if (const char* relative = pose->Attribute("relative_to"); relative && *relative)
            xml.fail(*pose, "is relative to another frame", "give it relative to the link");
        const SdfPlace place = sdf_place(xml, *pose);
        body.center_of_mass = place.position, body.orientation = place.turn;
    }
    if (mass) body.mass = xml.checked_mass(*mass, xml.content(*mass, 1)[0]);
    if (!mass) defaults.push_back("mass");
    std::vector<double> entries;
    bool all_moments = inertia;
    for (const char* name : {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"}) {
        const XMLElement* at = inertia ? xml.optional_child(*inertia, name) : nullptr;
        const bool is_moment = name[1] == name[2];
        all_moments = all_moments && (at || !is_moment);
        entries.push_back(xml.content_or(at, is_moment ? 1 : 0));
    }
    body.inertia = RobotXml::tensor(entries);
    if (!all_moments) defaults.push_back("inertia");
    if (defaults.empty()) return body;
    return MassPropertiesOf<Wide>{}(body);
}

MassProperties<Wide> sdf_computed_inertial(const RobotXml& xml, const XMLElement& link, const std::string& name,
                                           const std::vector<SdfSolid>& solids, RobotNotes& assumed) {
    const XMLElement& inertial = xml.child(link, "inertial");
    if (solids.empty())
        xml.fail(inertial, fmt::format("is automatic, and link \"{}\" has no <collision>", one_line(name, 60)),
                 "give the link a collision, or the numbers in <inertial>");
    const XMLElement* mass = xml.optional_child(inertial, "mass");
    const bool has_density = inertial.FirstChildElement("density");
    const double density = has_density ? positive(xml, inertial, "density") : 1000;
    bool by_default = false;
    std::vector<MassProperties<Wide>> parts;
    for (const SdfSolid& solid : solids) {
        const bool own = solid.collision->FirstChildElement("density");
        by_default = by_default || (!own && !has_density);
        const Extent<Wide> e = solid_extent(xml, solid);
        const Wide amount = Wide(own ? positive(xml, *solid.collision, "density") : density) * e.size;
        parts.push_back(placed(uniform_body(e, amount), solid.pose.position, solid.pose.turn));
    }
    MassProperties<Wide> whole = composite(parts);
    if (by_default && !mass) assumed["collisions of 1000 kg/m^3, SDFormat's default density"].push_back(name);
    if (mass) {
        const Wide factor = Wide(positive(xml, inertial, "mass")) / whole.mass;
        whole.mass = whole.mass * factor;
        for (int i = 0; i < 3; ++i) whole.inertia[i] = factor * whole.inertia[i];
        assumed["computed inertias scaled to the given mass, as libsdformat does since 14.7"].push_back(name);
    }
    return whole;
}

}  // namespace polhode
