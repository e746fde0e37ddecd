// What MuJoCo works out of geoms: the mass of primitives.
#include <fmt/format.h>

#include "body/shapes.h"
#include "scene/mjcf_values.h"
#include "scene/robot_parts.h"
#include "text/message.h"

namespace polhode {
namespace {

// half the height of a capsule or cylinder may have more digits than binary64, which shapes are given in
MassProperties<Wide> geom_at_origin(const std::string& type, const std::vector<double>& size, const Wide& half_height,
                                    const Wide& amount, bool by_mass) {
    const Shape shape = type == "sphere"     ? Shape(SolidSphere{size[0]})
                        : type == "capsule"  ? Shape(Capsule{size[0], double(half_height)})
                        : type == "cylinder" ? Shape(Cylinder{size[0], double(half_height)})
                        : type == "box"      ? Shape(Box{three_of(size)})
                                             : Shape(Ellipsoid{three_of(size)});
    return by_mass ? of_mass<Wide>(shape, amount) : of_density<Wide>(shape, amount);
}

}  // namespace

RobotPose mjcf_pose(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler) {
    RobotPose pose;
    if (at.Attribute("pos")) pose.position = cast<Wide>(three_of(xml.attribute(at, "pos", 3)));
    pose.turn = mjcf_turn(xml, at, compiler);
    return pose;
}

std::optional<MassProperties<Wide>> mjcf_geom_mass(const RobotXml& xml, const XMLElement& at,
                                                   const MjcfCompiler& compiler) {
    const bool by_mass = at.Attribute("mass");
    const double amount = by_mass ? xml.attribute_or(at, "mass", 0) : xml.attribute_or(at, "density", 1000);
    const std::string type = at.Attribute("type") ? at.Attribute("type") : "sphere";
    if (amount == 0 || type == "plane") return {};
    if (!(amount > 0)) xml.fail(at, "has less than no mass", "give a mass or a density >= 0");
    const char* remedy = "give the body an <inertial>";
    if (at.Attribute("shellinertia") || at.Attribute("mesh"))
        xml.fail(at, "has a mass that is not a primitive's", remedy);
    RobotPose place = mjcf_pose(xml, at, compiler);
    std::vector<double> size;
    if (const char* text = at.Attribute("size")) size = xml.numbers(at, "size", text, 1, 3);
    for (const double length : size)
        if (!(length >= 0)) xml.fail(at, "has a negative size", "give half lengths in m, > 0");
    Wide half_height = size.size() > 1 ? Wide(size[1]) : Wide(0);
    const bool spans = at.Attribute("fromto");
    if (spans) {
        if (type != "capsule" && type != "cylinder") xml.fail(at, "is no capsule or cylinder and has fromto", remedy);
        const std::vector<double> v = xml.attribute(at, "fromto", 6);
        const Vector3<Wide> a = cast<Wide>(three_of(v)), b = cast<Wide>(three_of(v, 3));
        place = {Wide(0.5) * (a + b), turn_from_z(xml, at, "fromto", a - b)};
        half_height = square_root(dot(b - a, b - a)) / Wide(2);
    }
    const std::size_t needed = type == "sphere" || spans ? 1 : type == "capsule" || type == "cylinder" ? 2 : 3;
    const bool known =
        type == "sphere" || type == "capsule" || type == "cylinder" || type == "box" || type == "ellipsoid";
    if (!known) xml.fail(at, fmt::format("is a {}, whose inertia is not worked out", one_line(type, 40)), remedy);
    if (size.size() < needed)
        xml.fail(at, fmt::format("has {} numbers in size", size.size()), fmt::format("give {}", needed));
    for (std::size_t i = 0; i < needed; ++i)
        if (!(size[i] > 0)) xml.fail(at, "has no volume", "give half lengths in m, > 0, or mass=\"0\"");
    return placed(geom_at_origin(type, size, half_height, Wide(amount), by_mass), place.position, place.turn);
}

}  // namespace polhode
