#include "scene/sdf_gears.h"

#include <cmath>
#include <optional>
#include <string_view>

#include "scene/sdf_values.h"

namespace polhode {
namespace {

struct Hinge {
    const RobotJoint* joint;
    double sign;  // -1 if the link rotates backward about the axis for positive rates
};

// The revolute joint between the reference and a link about an axis.
std::optional<Hinge> find_hinge(const Robot& robot, std::size_t reference, std::size_t link,
                                const Vector3<Wide>& axis_W) {
    for (const RobotJoint& joint : robot.joints) {
        const bool is_forward = joint.parent == reference && joint.child == link,
                   is_backward = joint.parent == link && joint.child == reference;
        if ((!is_forward && !is_backward) || joint.motion != RobotMotion::revolute) continue;
        const Vector3<Wide> own_W = rotate(robot.places[joint.child].turn, joint.axes[0]),
                            across = cross(own_W, axis_W);
        const Wide along = dot(own_W, axis_W);
        if (!(dot(across, across) <= Wide(1e-18) * along * along)) return {};
        return Hinge{&joint, (along > Wide(0)) == is_forward ? 1.0 : -1.0};
    }
    return {};
}

double child_number(const RobotXml& xml, const XMLElement& at, const char* name, double fallback) {
    return xml.content_or(xml.optional_child(at, name), fallback);
}

}  // namespace

double sdf_gearbox_ratio(const RobotXml& xml, const XMLElement& at) {
    const double ratio = child_number(xml, at, "gearbox_ratio", 1);
    if (ratio == 0) xml.fail(at, "has the gearbox_ratio 0", "give a number other than 0");
    return ratio;
}

void add_sdf_gearbox(const SdfGearbox& gearbox, double ratio, Robot& robot) {
    const std::optional<Hinge> first = find_hinge(robot, gearbox.reference, gearbox.parent, gearbox.axes_W[0]),
                               second = find_hinge(robot, gearbox.reference, gearbox.child, gearbox.axes_W[1]);
    if (!first || !second) {
        robot.omitted["gearbox joints that do not connect two hinges of their reference body"].push_back(gearbox.name);
        return;
    }
    robot.couplings.push_back({first->joint->name, second->joint->name, -ratio * first->sign * second->sign, 0});
}

void add_sdf_mimic(const RobotXml& xml, const XMLElement& joint, const std::string& name, RobotMotion motion,
                   Robot& robot) {
    for (const char* tag : {"axis", "axis2"}) {
        const XMLElement* axis = joint.FirstChildElement(tag);
        const XMLElement* mimic = axis ? xml.optional_child(*axis, "mimic") : nullptr;
        if (!mimic) continue;
        const char* of = mimic->Attribute("axis");
        const bool has_coordinate = motion == RobotMotion::revolute || motion == RobotMotion::prismatic;
        if (!has_coordinate || std::string_view(tag) != "axis" || (of && std::string_view(of) != "axis") ||
            !mimic->Attribute("joint")) {
            robot.omitted["mimic joints of joints with several axes"].push_back(name);
            continue;
        }
        // x = multiplier (x_leader - reference) + offset
        const double ratio = child_number(xml, *mimic, "multiplier", 1);
        const double offset =
            child_number(xml, *mimic, "offset", 0) - ratio * child_number(xml, *mimic, "reference", 0);
        robot.couplings.push_back({mimic->Attribute("joint"), name, ratio, offset});
    }
}

}  // namespace polhode
