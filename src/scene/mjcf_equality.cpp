// Reads <equality> of MJCF.
//
// MuJoCo defines each constraint by the model's reference configuration, where all joint coordinates are zero here:
//
//   joint     x1 = a0 + a1 x2: a coupling. Without the second joint x1 = a0: a fixed joint at that coordinate.
//   connect   a point of the first body coincides with the point of the second where it is in the reference
//             configuration: a spherical loop.
//   weld      the relative pose of two bodies is constant: a fixed joint in place of a free one.
//
// Constraints of polynomials of higher order, of sites, of tendons and of flexible bodies, and welds of two bodies that
// are both carried by joints are omitted.
#include "scene/mjcf_equality.h"

#include <algorithm>
#include <optional>
#include <string_view>

namespace polhode {
namespace {

constexpr const char* equality_heading = "equality constraints";

bool is_in_force(const XMLElement& at) {
    const char* text = at.Attribute("active");
    return !text || std::string_view(text) != "false";
}

// Others are reported as omitted by the table of constructs.
bool is_of_bodies(const XMLElement& at) {
    const std::string_view kind = at.Name();
    return kind == "joint" || kind == "connect" || kind == "weld";
}

bool has_value(const XMLElement& at, const char* attribute) {
    const char* text = at.Attribute(attribute);
    return text && *text;
}

// Calls act(element) for each active constraint of joints and bodies.
template <class Do>
void for_active(const XMLElement& root, Do&& act) {
    for (const XMLElement* list = root.FirstChildElement("equality"); list; list = list->NextSiblingElement("equality"))
        for (const XMLElement* one = list->FirstChildElement(); one; one = one->NextSiblingElement())
            if (is_in_force(*one) && is_of_bodies(*one)) act(*one);
}

class EqualityReader {
  public:
    EqualityReader(const RobotXml& xml, Robot& robot) : xml_(xml), robot_(robot) {}

    /// Whether the constraint became part of the robot.
    bool add(const XMLElement& at) {
        const std::string_view kind = at.Name();
        return kind == "joint" ? add_joint(at) : kind == "connect" ? add_connect(at) : add_weld(at);
    }

  private:
    const RobotXml& xml_;
    Robot& robot_;

    RobotJoint* joint_named(const XMLElement& at, const char* attribute) {
        if (!has_value(at, attribute)) return nullptr;
        for (RobotJoint& joint : robot_.joints)
            if (joint.name == at.Attribute(attribute) &&
                (joint.motion == RobotMotion::revolute || joint.motion == RobotMotion::prismatic))
                return &joint;
        return nullptr;
    }
    // The named link, or the world.
    std::optional<std::size_t> link_named(const XMLElement& at, const char* attribute) const {
        if (!has_value(at, attribute) || std::string_view(at.Attribute(attribute)) == "world") return RobotJoint::world;
        for (std::size_t i = 0; i < robot_.links.size(); ++i)
            if (robot_.links[i].name == at.Attribute(attribute)) return i;
        return {};
    }
    RobotJoint* carrier_of(std::size_t link) {
        for (RobotJoint& joint : robot_.joints)
            if (joint.child == link) return &joint;
        return nullptr;
    }
    // The pose of a link in the world if all joint coordinates are zero, and its root.
    struct Reference {
        RobotPose pose;
        std::size_t root = RobotJoint::world;
    };
    Reference reference_of(std::size_t link) {
        Reference result;
        while (link != RobotJoint::world) {
            result.root = link;
            const RobotJoint* const joint = carrier_of(link);
            if (!joint) {
                if (link < robot_.places.size()) result.pose = robot_.places[link] * result.pose;
                break;
            }
            result.pose = joint->placement * result.pose, link = joint->parent;
        }
        return result;
    }

    bool add_joint(const XMLElement& at) {
        RobotJoint* const first = joint_named(at, "joint1");
        std::vector<double> a{0, 1, 0, 0, 0};
        if (at.Attribute("polycoef")) {
            const std::vector<double> given = xml_.numbers(at, "polycoef", at.Attribute("polycoef"), 1, 5);
            std::copy(given.begin(), given.end(), a.begin());
        }
        if (!first) return false;
        if (!has_value(at, "joint2")) return lock(*first, Wide(a[0]));
        const RobotJoint* const second = joint_named(at, "joint2");
        if (!second || second == first || a[1] == 0 || a[2] != 0 || a[3] != 0 || a[4] != 0) return false;
        robot_.couplings.push_back({second->name, first->name, a[1], a[0]});
        return true;
    }
    // Fixes a joint at a coordinate.
    bool lock(RobotJoint& joint, const Wide& x) {
        joint.lock(x);
        robot_.assumed["joints locked by equality constraints"].push_back(joint.name);
        return true;
    }

    bool add_connect(const XMLElement& at) {
        if (has_value(at, "site1") || has_value(at, "site2") || !has_value(at, "body1") || !has_value(at, "anchor"))
            return false;
        const std::optional<std::size_t> first = link_named(at, "body1"), second = link_named(at, "body2");
        if (!first || !second || first == second) return false;
        Robot::Loop loop;
        loop.name = has_value(at, "name") ? at.Attribute("name") : "connect";
        loop.first = *first, loop.second = *second;
        loop.first_point = cast<Wide>(three_of(xml_.attribute(at, "anchor", 3)));
        loop.second_point = inverse(reference_of(*second).pose) * (reference_of(*first).pose * loop.first_point);
        robot_.loops.push_back(std::move(loop));
        return true;
    }

    bool add_weld(const XMLElement& at) {
        if (has_value(at, "site1") || has_value(at, "site2") || !has_value(at, "body1")) return false;
        const std::optional<std::size_t> first = link_named(at, "body1"), second = link_named(at, "body2");
        if (!first || !second) return false;
        const Reference one = reference_of(*first), other = reference_of(*second);
        if (one.root == other.root) return false;
        // the pose of the second body in the first
        RobotPose relative = inverse(one.pose) * other.pose;
        if (has_value(at, "relpose")) {
            const std::vector<double> v = xml_.attribute(at, "relpose", 7);
            const Quaternion<Wide> turn = cast<Wide>(Quaternion<double>{v[3], v[4], v[5], v[6]});
            if (!(v[3] == 0 && v[4] == 0 && v[5] == 0 && v[6] == 0))
                relative = {cast<Wide>(three_of(v)), normalized(turn)};
        }
        return carry(*first, *second, inverse(relative)) || carry(*second, *first, relative);
    }
    // Replaces the free joint of a link by a fixed joint to a parent.
    bool carry(std::size_t link, std::size_t parent, const RobotPose& placement) {
        RobotJoint* const joint = link == RobotJoint::world ? nullptr : carrier_of(link);
        if (!joint || joint->motion != RobotMotion::free) return false;
        joint->motion = RobotMotion::fixed, joint->parent = parent, joint->placement = placement;
        joint->damping = {};
        std::erase_if(robot_.free_damping, [&](const Robot::FreeDamping& one) { return one.link == link; });
        robot_.assumed["free bodies that are welded"].push_back(robot_.links[link].name);
        return true;
    }
};

}  // namespace

void add_mjcf_equalities(const RobotXml& xml, const XMLElement& root, Robot& robot) {
    EqualityReader reader(xml, robot);
    for_active(root, [&](const XMLElement& at) {
        if (!reader.add(at)) robot.omitted[equality_heading].push_back(robot_note_name(xml, at));
    });
}

void omit_mjcf_equalities(const RobotXml& xml, const XMLElement& root, Robot& robot) {
    for_active(root,
               [&](const XMLElement& at) { robot.omitted[equality_heading].push_back(robot_note_name(xml, at)); });
}

}  // namespace polhode
