// Whole robots of MJCF.
#include <fmt/format.h>

#include <set>

#include "scene/mjcf_values.h"
#include "scene/robot_parts.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr const char* whole_remedy = "write the model out whole (MuJoCo's mj_saveLastXML) and give that file";

// What <default> says of <joint> and <geom> in each class.
using MjcfAttributes = std::map<std::string, std::string>;
struct MjcfClass {
    MjcfAttributes joint, geom;
};
using MjcfClasses = std::map<std::string, MjcfClass>;

bool is_turn(const std::string& name) {
    return name == "quat" || name == "euler" || name == "axisangle" || name == "xyaxes" || name == "zaxis";
}

void read_defaults(const RobotXml& xml, const XMLElement& at, MjcfClass inherited, bool top, MjcfClasses& classes) {
    std::string name = top ? "main" : "";
    if (const char* given = at.Attribute("class")) name = given;
    if (name.empty()) xml.fail(at, "has no \"class\"", "give the class's name");
    for (const XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement()) {
        const std::string_view tag = one->Name();
        if (tag != "joint" && tag != "geom") continue;
        MjcfAttributes& attributes = tag == "joint" ? inherited.joint : inherited.geom;
        for (const tinyxml2::XMLAttribute* a = one->FirstAttribute(); a; a = a->Next())
            attributes[a->Name()] = a->Value();
    }
    classes[name] = inherited;
    if (top) classes["main"] = inherited;
    for (const XMLElement* one = at.FirstChildElement("default"); one; one = one->NextSiblingElement("default"))
        read_defaults(xml, *one, inherited, false, classes);
}

// An attribute that is missing is its class's; of ways to say one thing the element's own.
void complete(const RobotXml& xml, XMLElement& at, const MjcfClasses& classes, const std::string& child_class) {
    const char* own = at.Attribute("class");
    const std::string name = own ? own : child_class;
    const auto found = classes.find(name);
    if (found == classes.end()) {
        if (name == "main") return;
        xml.fail(at, fmt::format("has the class \"{}\", which no <default> has", one_line(name, 40)), "give the class");
    }
    bool turned = false;
    for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next()) turned = turned || is_turn(a->Name());
    const bool spans = at.Attribute("fromto");
    const bool is_joint = std::string_view(at.Name()) == "joint";
    for (const auto& [key, value] : is_joint ? found->second.joint : found->second.geom) {
        if (at.Attribute(key.c_str()) || (is_turn(key) && (turned || spans))) continue;
        if (key != "class" && key != "name") at.SetAttribute(key.c_str(), value.c_str());
    }
}

void complete_bodies(const RobotXml& xml, XMLElement& body, const MjcfClasses& classes, std::string child_class) {
    if (const char* given = body.Attribute("childclass")) child_class = given;
    for (XMLElement* one = body.FirstChildElement(); one; one = one->NextSiblingElement()) {
        const std::string_view tag = one->Name();
        if (tag == "joint" || tag == "geom") complete(xml, *one, classes, child_class);
        if (tag == "body") complete_bodies(xml, *one, classes, child_class);
    }
}

// Body by body.
class MjcfReader {
  public:
    MjcfReader(const RobotXml& xml, const XMLElement& root)
        : xml_(xml), compiler_(mjcf_compiler(xml, root)), names_(xml, "body"), joint_names_(xml, "joint") {
        for (const XMLElement* c = root.FirstChildElement("compiler"); c; c = c->NextSiblingElement("compiler"))
            read_compiler(*c);
    }

    Robot read(const XMLElement& root) {
        for (const XMLElement* at = root.FirstChildElement(); at; at = at->NextSiblingElement()) {
            const std::string_view tag = at->Name();
            if (tag == "worldbody")
                read_children(*at, RobotJoint::world, "world");
            else if (tag == "include")
                xml_.fail(*at, "brings in another file", whole_remedy);
            else
                leave_out(*at, tag);
        }
        return std::move(robot_);
    }

  private:
    void read_compiler(const XMLElement& at) {
        if (const char* coordinate = at.Attribute("coordinate"); coordinate && std::string_view(coordinate) != "local")
            xml_.fail(at, "has coordinates that are not local", whole_remedy);
        if (xml_.attribute_or(at, "settotalmass", -1) > 0) xml_.fail(at, "scales all masses", whole_remedy);
        if (at.Attribute("inertiagrouprange")) groups_ = &at;
        if (const char* geoms = at.Attribute("inertiafromgeom")) inertia_from_geom_ = geoms;
        for (const char* bound : {"boundmass", "boundinertia", "balanceinertia"})
            if (at.Attribute(bound)) note("<compiler>", bound);
    }

    void note(const std::string& what, const std::string& name) { robot_.omitted[what].push_back(name); }

    // sections that say nothing of how bodies and joints are made
    void leave_out(const XMLElement& at, std::string_view tag) {
        for (const char* known : {"compiler", "default", "asset", "visual", "statistic", "size", "custom", "keyframe"})
            if (tag == known) return;
        const std::string what = fmt::format("<{}>", one_line(tag, 40));
        if (tag == "option")
            for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next()) note(what, a->Name());
        for (const XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement())
            note(what, name_or(*one, one->Name()));
    }

    void read_children(const XMLElement& of, std::size_t link, const std::string& name) {
        for (const XMLElement* one = of.FirstChildElement(); one; one = one->NextSiblingElement()) {
            const std::string_view tag = one->Name();
            if (tag == "body") {
                read_body(*one, link);
            } else if (tag == "geom") {
                auto& geoms = robot_.omitted["shapes for contact of bodies"];
                if (geoms.empty() || geoms.back() != name) geoms.push_back(name);
            } else if (tag == "frame" || tag == "replicate" || tag == "composite" || tag == "flexcomp" ||
                       tag == "attach" || tag == "include") {
                xml_.fail(*one, "makes bodies in a way that is not read", whole_remedy);
            } else if (tag == "plugin") {
                note("<plugin>", name);
            } else if (link == RobotJoint::world && (tag == "joint" || tag == "freejoint")) {
                xml_.fail(*one, "is a joint of the world", "give it to a body");
            }
        }
    }

    void read_body(const XMLElement& at, std::size_t parent) {
        const std::string name = name_or(at, fmt::format("body{}", ++unnamed_bodies_).c_str());
        if (xml_.flag(at, "mocap")) xml_.fail(at, "is moved by hand (mocap)", "leave it out, or hold it by a joint");
        if (xml_.attribute_or(at, "gravcomp", 0) != 0) note("compensation of gravity of bodies", name);
        const RobotPose place = mjcf_pose(xml_, at, compiler_);
        const std::size_t body = add_link(at, name);
        names_.add(at, name, body);
        robot_.links[body].mass = mass_of_body(at);
        std::vector<const XMLElement*> joints;
        for (const XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement())
            if (std::string_view(one->Name()) == "joint" || std::string_view(one->Name()) == "freejoint")
                joints.push_back(one);
        if (joints.empty() && parent != RobotJoint::world)
            add_joint(at, name + "_weld", RobotMotion::fixed, parent, body, place);
        if (joints.empty() && parent == RobotJoint::world) {
            robot_.places.resize(robot_.links.size());
            robot_.places[body] = place;
        }
        // each but the last moves a link without mass, in the body's own frame
        std::size_t from = parent;
        for (std::size_t k = 0; k < joints.size(); ++k) {
            const bool last = k + 1 == joints.size();
            const std::size_t to = last ? body : add_link(*joints[k], fmt::format("{} (joint {})", name, k + 1));
            read_joint(*joints[k], name, from, to, k == 0 ? place : RobotPose{}, joints.size());
            from = to;
        }
        read_children(at, body, name);
    }

    std::size_t add_link(const XMLElement& at, const std::string& name) {
        robot_.links.push_back({name, xml_.place_of(at), {}});
        return robot_.links.size() - 1;
    }
    RobotJoint& add_joint(const XMLElement& at, const std::string& name, RobotMotion motion, std::size_t parent,
                          std::size_t child, const RobotPose& placement) {
        joint_names_.add(at, name, robot_.joints.size());
        RobotJoint joint;
        joint.name = name, joint.place = xml_.place_of(at), joint.motion = motion;
        joint.parent = parent, joint.child = child, joint.placement = placement;
        robot_.joints.push_back(std::move(joint));
        return robot_.joints.back();
    }

    void read_joint(const XMLElement& at, const std::string& body, std::size_t from, std::size_t to,
                    const RobotPose& place, std::size_t count) {
        const bool free_joint = std::string_view(at.Name()) == "freejoint";
        const char* type = free_joint ? "free" : at.Attribute("type") ? at.Attribute("type") : "hinge";
        const std::string_view kind = type;
        const std::string name = name_or(
            at, count == 1 ? (body + "_joint").c_str() : fmt::format("{}_joint{}", body, ++unnamed_joints_).c_str());
        if (kind == "free") {
            if (from != RobotJoint::world || count != 1)
                xml_.fail(at, "is free, but not the only joint of a body in the world", "free joints hold nothing");
            add_joint(at, name, RobotMotion::free, from, to, place);
            return;
        }
        if (kind != "hinge" && kind != "slide" && kind != "ball")
            xml_.fail(at, fmt::format("has the type \"{}\"", one_line(kind, 40)), "give hinge, slide, ball or free");
        RobotJoint& joint = add_joint(at, name,
                                      kind == "hinge"   ? RobotMotion::revolute
                                      : kind == "slide" ? RobotMotion::prismatic
                                                        : RobotMotion::spherical,
                                      from, to, place);
        if (at.Attribute("pos")) joint.point = cast<Wide>(three_of(xml_.attribute(at, "pos", 3)));
        joint.axes[0] = {Wide(0), Wide(0), Wide(1)};
        if (at.Attribute("axis")) joint.axes[0] = cast<Wide>(three_of(xml_.attribute(at, "axis", 3)));
        if (joint.axes[0] == Vector3<Wide>()) xml_.fail(at, "has the axis zero", "give a direction");
        read_forces(at, joint);
    }

    // its spring, its damper, and what acts on it that a scene has no place for
    void read_forces(const XMLElement& at, RobotJoint& joint) {
        if (at.Attribute("springdamper")) xml_.fail(at, "has a springdamper", "give stiffness and damping as numbers");
        joint.damping[0] = Wide(xml_.attribute_or(at, "damping", 0));
        const double stiffness = xml_.attribute_or(at, "stiffness", 0);
        if (joint.motion == RobotMotion::spherical) {
            // MuJoCo's pulls with the angle, a scene's with its sine
            if (stiffness != 0) note("springs of ball joints", joint.name);
        } else if (stiffness != 0) {
            const bool in_degrees = compiler_.in_degrees && joint.motion == RobotMotion::revolute;
            joint.stiffness[0] = Wide(stiffness);
            joint.rest[0] = in_radians(xml_.attribute_or(at, "springref", 0), in_degrees) -
                            in_radians(xml_.attribute_or(at, "ref", 0), in_degrees);
        }
        const char* limited = at.Attribute("limited");
        if (at.Attribute("range") && !(limited && std::string_view(limited) == "false"))
            note("limits of joints", joint.name);
        if (xml_.attribute_or(at, "frictionloss", 0) != 0) note("friction of joints", joint.name);
        if (xml_.attribute_or(at, "armature", 0) != 0) note("armature of joints", joint.name);
    }

    std::optional<MassProperties<Wide>> mass_of_body(const XMLElement& at) const {
        const XMLElement* inertial = xml_.optional_child(at, "inertial");
        if (inertial && inertia_from_geom_ != "true") return mass_of(mjcf_inertial(xml_, *inertial, compiler_));
        if (inertia_from_geom_ == "false") return {};
        if (groups_) xml_.fail(*groups_, "chooses the geoms that have mass", "give the bodies an <inertial>");
        std::vector<MassProperties<Wide>> parts;
        for (const XMLElement* one = at.FirstChildElement("geom"); one; one = one->NextSiblingElement("geom"))
            if (const std::optional<MassProperties<Wide>> part = mjcf_geom_mass(xml_, *one, compiler_))
                parts.push_back(*part);
        if (parts.empty()) return {};
        return composite(parts);
    }

    const RobotXml& xml_;
    MjcfCompiler compiler_;
    RobotNames names_, joint_names_;
    std::string inertia_from_geom_ = "auto";
    const XMLElement* groups_ = nullptr;
    int unnamed_bodies_ = 0, unnamed_joints_ = 0;
    Robot robot_;
};

}  // namespace

LinkInertial mjcf_body_inertial(const RobotXml& xml, XMLElement& root, const std::string& body) {
    return mjcf_inertial(xml, xml.child(named_element(xml, root, "body", body), "inertial"), mjcf_compiler(xml, root));
}

Robot mjcf_robot(const RobotXml& xml, XMLElement& root) {
    MjcfClasses classes;
    for (const XMLElement* at = root.FirstChildElement("default"); at; at = at->NextSiblingElement("default"))
        read_defaults(xml, *at, {}, true, classes);
    for (XMLElement* at = root.FirstChildElement("worldbody"); at; at = at->NextSiblingElement("worldbody"))
        complete_bodies(xml, *at, classes, "main");
    return MjcfReader(xml, root).read(root);
}

}  // namespace polhode
