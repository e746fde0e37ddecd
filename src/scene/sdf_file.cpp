// Whole robots of SDFormat.
#include <fmt/format.h>

#include "scene/robot_parts.h"
#include "text/message.h"

namespace polhode {
namespace {

struct SdfJointType {
    const char* name;
    RobotMotion motion;
};
constexpr SdfJointType sdf_joint_types[] = {
    {"revolute", RobotMotion::revolute}, {"continuous", RobotMotion::revolute}, {"prismatic", RobotMotion::prismatic},
    {"ball", RobotMotion::spherical},    {"universal", RobotMotion::universal}, {"fixed", RobotMotion::fixed},
};

// A position and a turn.
struct RobotPlace {
    Vector3<double> position;  // m
    RobotTurn turn;
};

RobotPlace sdf_place(const RobotXml& xml, const XMLElement& pose) {
    RobotPlace place;
    const char* format = pose.Attribute("rotation_format");
    if (format && std::string_view(format) == "quat_xyzw") {
        const std::vector<double> v = xml.content(pose, 7);
        return {three_of(v), xml.turn_by(pose, {v[6], v[3], v[4], v[5]})};
    }
    if (format && std::string_view(format) != "euler_rpy")
        xml.fail(pose, fmt::format("has the rotation_format \"{}\"", one_line(format, 40)),
                 "give euler_rpy or quat_xyzw");
    const std::vector<double> v = xml.content(pose, 6);
    const char* degrees = pose.Attribute("degrees");
    return {three_of(v), roll_pitch_yaw(three_of(v, 3), degrees && (std::string_view(degrees) == "true" ||
                                                                    std::string_view(degrees) == "1"))};
}

ImportedBody sdf_inertial(const RobotXml& xml, const XMLElement& inertial) {
    ImportedBody body;
    if (const XMLElement* pose = xml.optional_child(inertial, "pose")) {
        const char* relative = pose->Attribute("relative_to");
        if (relative && *relative) xml.fail(*pose, "is relative to another frame", "give it relative to the link");
        const RobotPlace place = sdf_place(xml, *pose);
        body.center_of_mass = place.position, body.orientation = place.turn;
    }
    const XMLElement& mass = xml.child(inertial, "mass");
    body.mass = xml.checked_mass(mass, xml.content(mass, 1)[0]);
    const XMLElement& inertia = xml.child(inertial, "inertia");
    std::vector<double> entries;
    for (const char* name : {"ixx", "iyy", "izz"}) entries.push_back(xml.content(xml.child(inertia, name), 1)[0]);
    for (const char* name : {"ixy", "ixz", "iyz"})
        entries.push_back(xml.content_or(xml.optional_child(inertia, name), 0));
    body.inertia = RobotXml::tensor(entries);
    return body;
}

bool is_true(const RobotXml& xml, const XMLElement* at) {
    if (!at) return false;
    const std::string_view text = at->GetText() ? at->GetText() : "";
    if (text != "true" && text != "1" && text != "false" && text != "0")
        xml.fail(*at, fmt::format("is \"{}\"", one_line(text, 40)), "give true or false");
    return text == "true" || text == "1";
}

std::string text_of_child(const RobotXml& xml, const XMLElement& of, const char* name) {
    const XMLElement& at = xml.child(of, name);
    if (!at.GetText()) xml.fail(at, "is empty", "give a link's name");
    return at.GetText();
}

// Where links, joints and frames of a model are in it.
class SdfFrames {
  public:
    SdfFrames(const RobotXml& xml, const XMLElement& model) : xml_(xml) {
        for (const XMLElement* at = model.FirstChildElement(); at; at = at->NextSiblingElement()) {
            const std::string_view tag = at->Name();
            if (tag != "link" && tag != "joint" && tag != "frame") continue;
            const std::string name = xml.name(*at, "name", "its name");
            if (!frames_.emplace(name, Frame_{at, {}, State::unknown}).second)
                xml.fail(*at, fmt::format("is a second \"{}\"", one_line(name, 60)),
                         "give links, joints and frames each a name of their own");
        }
    }

    // `at` names it
    RobotPose pose(const XMLElement& at, const std::string& name) {
        if (name.empty() || name == "__model__") return {};
        const auto found = frames_.find(name);
        if (found == frames_.end()) {
            std::vector<std::string> known;
            for (const auto& [one, frame] : frames_) known.push_back(one);
            const std::string meant = did_you_mean(name, known);
            xml_.fail(at, fmt::format("names \"{}\", which is nothing in the model", one_line(name, 60)),
                      meant.empty() ? "give a link, a joint or a frame" : meant);
        }
        Frame_& frame = found->second;
        if (frame.state == State::known) return frame.pose;
        if (frame.state == State::sought || ++depth_ > 1000)
            xml_.fail(*frame.at, "is placed relative to itself", "give a pose relative to what is placed");
        frame.state = State::sought;
        const XMLElement* given = xml_.optional_child(*frame.at, "pose");
        const char* relative = given ? given->Attribute("relative_to") : nullptr;
        std::string base = relative ? relative : "";
        if (base.empty() && std::string_view(frame.at->Name()) == "joint")
            base = text_of_child(xml_, *frame.at, "child");
        if (base.empty() && frame.at->Attribute("attached_to")) base = frame.at->Attribute("attached_to");
        const RobotPose outer = pose(*frame.at, base);
        --depth_;
        frame.pose = given ? outer * pose_in(*given) : outer;
        frame.state = State::known;
        return frame.pose;
    }

    RobotPose pose_in(const XMLElement& given) const {
        const RobotPlace place = sdf_place(xml_, given);
        return {cast<Wide>(place.position), unit_quaternion<Wide>(place.turn)};
    }

  private:
    enum class State { unknown, sought, known };
    struct Frame_ {
        const XMLElement* at;
        RobotPose pose;  // in the model
        State state;
    };
    const RobotXml& xml_;
    std::map<std::string, Frame_, std::less<>> frames_;
    int depth_ = 0;
};

class SdfReader {
  public:
    SdfReader(const RobotXml& xml, const XMLElement& model)
        : xml_(xml), model_(model), frames_(xml, model), names_(xml, "link") {
        if (const XMLElement* pose = xml.optional_child(model, "pose")) {
            const char* relative = pose->Attribute("relative_to");
            if (relative && *relative && std::string_view(relative) != "world")
                xml.fail(*pose, "is relative to another frame", "give it relative to the world");
            place_ = frames_.pose_in(*pose);
        }
        if (model.Attribute("placement_frame"))
            xml.fail(model, "is placed by a frame of its own", "give the pose of the model itself");
    }

    Robot read() {
        robot_.roots_are_free = true;
        for (const XMLElement* at = model_.FirstChildElement(); at; at = at->NextSiblingElement()) {
            const std::string_view tag = at->Name();
            if (tag == "link") read_link(*at);
            if (tag == "model" || tag == "include")
                xml_.fail(*at, "is a model in the model", "give its links and joints themselves");
            if (tag == "plugin" || tag == "gripper" || tag == "sensor")
                note(fmt::format("<{}>", tag), name_or(*at, ""));
        }
        carried_.resize(robot_.links.size());
        for (const XMLElement* at = model_.FirstChildElement("joint"); at; at = at->NextSiblingElement("joint"))
            read_joint(*at);
        return std::move(robot_);
    }

  private:
    void note(const std::string& what, const std::string& name) { robot_.omitted[what].push_back(name); }

    void read_link(const XMLElement& at) {
        RobotLink link;
        link.name = xml_.name(at, "name", "the link's name"), link.place = xml_.place_of(at);
        names_.add(at, link.name, robot_.links.size());
        const XMLElement* inertial = xml_.optional_child(at, "inertial");
        if (!inertial) xml_.fail(at, "has no <inertial>", "give it: the format's default of 1 kg is no body's");
        if (inertial->FirstChildElement("fluid_added_mass")) note("added mass of links", link.name);
        link.mass = mass_of(sdf_inertial(xml_, *inertial));
        if (at.FirstChildElement("collision")) note("shapes for contact of links", link.name);
        if (at.FirstChildElement("gravity") && !is_true(xml_, at.FirstChildElement("gravity")))
            note("absence of gravity of links", link.name);
        if (is_true(xml_, at.FirstChildElement("kinematic"))) note("kinematic links", link.name);
        if (at.FirstChildElement("velocity_decay")) note("decay of velocity of links", link.name);
        robot_.places.push_back(place_ * frames_.pose(at, link.name));
        robot_.links.push_back(std::move(link));
    }

    RobotMotion motion_of(const XMLElement& at) const {
        const std::string type = xml_.name(at, "type", "revolute, continuous, prismatic, ball, universal or fixed");
        for (const SdfJointType& one : sdf_joint_types)
            if (type == one.name) return one.motion;
        xml_.fail(at, fmt::format("has the type \"{}\"", one_line(type, 40)),
                  "give revolute, continuous, prismatic, ball, universal or fixed");
    }

    void read_joint(const XMLElement& at) {
        RobotJoint joint;
        joint.name = xml_.name(at, "name", "the joint's name"), joint.place = xml_.place_of(at);
        joint.motion = motion_of(at);
        const XMLElement &parent = xml_.child(at, "parent"), &child = xml_.child(at, "child");
        const std::string parent_name = text_of_child(xml_, at, "parent");
        if (parent_name != "world") joint.parent = names_.find(parent, parent_name);
        joint.child = names_.find(child, text_of_child(xml_, at, "child"));
        if (carried_[joint.child])
            xml_.fail(
                child,
                fmt::format("is a second joint's that carries \"{}\"", one_line(robot_.links[joint.child].name, 60)),
                "a robot is a tree: give each link one joint, and close chains by \"loops\" in the scene");
        carried_[joint.child] = true;
        const RobotPose& there = robot_.places[joint.child];
        joint.placement = parent_name == "world" ? there : inverse(robot_.places[joint.parent]) * there;
        // in the model, like the poses of frames
        const RobotPose child_here = frames_.pose(child, robot_.links[joint.child].name);
        const RobotPose joint_here = frames_.pose(at, joint.name);
        joint.point = inverse(child_here) * joint_here.position;
        const std::size_t axes = joint.motion == RobotMotion::universal                                            ? 2
                                 : joint.motion == RobotMotion::revolute || joint.motion == RobotMotion::prismatic ? 1
                                                                                                                   : 0;
        for (std::size_t i = 0; i < axes; ++i)
            read_axis(xml_.child(at, i == 0 ? "axis" : "axis2"), i, child_here, joint_here, joint);
        robot_.joints.push_back(std::move(joint));
    }

    void read_axis(const XMLElement& at, std::size_t i, const RobotPose& child_here, const RobotPose& joint_here,
                   RobotJoint& joint) {
        Vector3<Wide> axis(Wide(0), Wide(0), Wide(1));
        Quaternion<Wide> turn = joint_here.turn;
        if (const XMLElement* xyz = xml_.optional_child(at, "xyz")) {
            axis = cast<Wide>(three_of(xml_.content(*xyz, 3)));
            if (axis == Vector3<Wide>()) xml_.fail(*xyz, "is zero", "give a direction");
            if (const char* frame = xyz->Attribute("expressed_in"); frame && *frame)
                turn = frames_.pose(*xyz, frame).turn;
        }
        if (is_true(xml_, xml_.optional_child(at, "use_parent_model_frame")))
            xml_.fail(at, "is in the model's frame by an old switch", "give <xyz expressed_in=\"__model__\">");
        joint.axes[i] = rotate_back(child_here.turn, rotate(turn, axis));
        if (at.FirstChildElement("limit")) note("limits of joints", joint.name);
        if (at.FirstChildElement("mimic")) note("mimicry of joints", joint.name);
        if (at.FirstChildElement("initial_position")) note("initial_position of joints", joint.name);
        const XMLElement* dynamics = xml_.optional_child(at, "dynamics");
        if (!dynamics) return;
        const auto number = [&](const char* name) { return xml_.content_or(xml_.optional_child(*dynamics, name), 0); };
        joint.damping[i] = Wide(number("damping")), joint.stiffness[i] = Wide(number("spring_stiffness"));
        if (joint.stiffness[i] != 0) joint.rest[i] = Wide(number("spring_reference"));
        if (number("friction") != 0) note("friction of joints", joint.name);
    }

    const RobotXml& xml_;
    const XMLElement& model_;
    SdfFrames frames_;
    RobotNames names_;
    RobotPose place_;  // of the model in the world
    std::vector<bool> carried_;
    Robot robot_;
};

}  // namespace

LinkInertial sdf_link_inertial(const RobotXml& xml, const XMLElement& root, const std::string& link) {
    return sdf_inertial(xml, xml.child(named_element(xml, root, "link", link), "inertial"));
}

Robot sdf_robot(const RobotXml& xml, const XMLElement& root, const std::string&) {
    // the one that moves, in a world or alone
    const XMLElement* within = root.FirstChildElement("world") ? &xml.child(root, "world") : &root;
    const XMLElement* chosen = nullptr;
    std::vector<std::string> still;
    for (const XMLElement* at = within->FirstChildElement("model"); at; at = at->NextSiblingElement("model")) {
        if (is_true(xml, at->FirstChildElement("static"))) {
            still.push_back(name_or(*at, ""));
            continue;
        }
        if (chosen) xml.fail(*at, "is a second model", "give a file with one model that moves");
        chosen = at;
    }
    if (!chosen) xml.fail(*within, "has no <model> that moves", "give one");
    Robot robot = SdfReader(xml, *chosen).read();
    for (const std::string& name : still) robot.omitted["static models"].push_back(name);
    if (within->FirstChildElement("include")) robot.omitted["<include>"].emplace_back("of the world");
    return robot;
}

}  // namespace polhode
