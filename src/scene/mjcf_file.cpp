// Reads robots from MJCF (MuJoCo XML, versions 2 and 3).
//
// The reader walks the tree of bodies of a model whose included files and class defaults are already resolved
// (mjcf_model.h). Each <body> becomes a link. MjcfCollector expands <frame>, <replicate> and <attach>; MjcfMasses
// computes masses; MjcfJoints creates the joints, with massless links between several joints of one body. Coordinate
// zero of a joint is the pose as written, which is MuJoCo's qpos = ref. Keyframes are ignored. Bodies without joints
// are welded to their parents.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scene/mjcf_actuators.h"
#include "scene/mjcf_equality.h"
#include "scene/mjcf_joints.h"
#include "scene/mjcf_parts.h"
#include "scene/robot_parts.h"
#include "scene/scene_limits.h"
#include "text/message.h"

namespace polhode {
namespace {

// The <option> element, or its child `tag`, that last sets an attribute.
const XMLElement* option_with(const XMLElement& root, const char* attribute, const char* tag = nullptr) {
    const XMLElement* found = nullptr;
    for (const XMLElement* o = root.FirstChildElement("option"); o; o = o->NextSiblingElement("option")) {
        const XMLElement* at = tag ? o->FirstChildElement(tag) : o;
        if (at && at->Attribute(attribute)) found = at;
    }
    return found;
}

bool is_enabled(const RobotXml& xml, const XMLElement& root, const char* flag) {
    const XMLElement* at = option_with(root, flag, "flag");
    if (!at) return true;
    const std::string_view value = at->Attribute(flag);
    if (value != "enable" && value != "disable")
        xml.fail(*at, fmt::format("has \"{}\" in {}", one_line(value, 40), flag), "give enable or disable");
    return value == "enable";
}

class MjcfReader {
  public:
    MjcfReader(const RobotXml& xml, MjcfLibrary& library, const MjcfModel& model)
        : xml_(xml),
          library_(library),
          model_(model),
          collector_(xml, library),
          masses_(xml, robot_.assumed),
          names_(xml, "body"),
          joints_(xml, robot_) {
        const bool passive = is_enabled(xml, *model.root, "passive");
        joints_.set_passive_forces(passive && is_enabled(xml, *model.root, "spring"),
                                   passive && is_enabled(xml, *model.root, "damper"));
    }

    Robot read() {
        MjcfScope scope;
        scope.model = &model_;
        for (const XMLElement* world = model_.root->FirstChildElement("worldbody"); world;
             world = world->NextSiblingElement("worldbody")) {
            const MjcfParts parts = collector_.collect(*world, scope);
            if (parts.inertial) xml_.fail(*parts.inertial->at, "is an <inertial> of the world", "move it into a body");
            if (!parts.joints.empty()) xml_.fail(*parts.joints[0].at, "is a joint of the world", "move it into a body");
            if (parts.can_collide) note_shapes("world");
            read_bodies(parts, RobotJoint::world, false);
        }
        scale_masses();
        name_bodies();
        joints_.finish();
        const bool constrains =
            is_enabled(xml_, *model_.root, "constraint") && is_enabled(xml_, *model_.root, "equality");
        if (constrains) add_mjcf_equalities(xml_, *model_.root, robot_);
        read_gravity();
        survey_robot(xml_, *model_.root, mjcf_constructs(), robot_.omitted);
        for (const auto& [path, attached] : library_.attached_models()) {
            survey_robot(xml_, *attached->root, mjcf_constructs(), robot_.omitted);
            if (constrains) omit_mjcf_equalities(xml_, *attached->root, robot_);
        }
        if (is_enabled(xml_, *model_.root, "actuation"))
            add_mjcf_actuators(xml_, *model_.root, joints_.references(), robot_);
        else
            robot_.omitted.erase("actuators");
        return std::move(robot_);
    }

    // The mass properties of the body at this element.
    LinkInertial inertial_of(const XMLElement& at) {
        MjcfScope scope;
        scope.model = &model_;
        const MjcfMasses::Body body = body_of(at, name_or(at, ""), collector_.collect(at, scope), scope);
        if (!library_.has_other_files())
            if (const std::optional<ImportedBody> given = masses_.given(body)) return *given;
        const std::optional<MassProperties<Wide>> mass = masses_.of(body);
        if (!mass) xml_.fail(at, "has no mass", "give it an <inertial> or geoms with a mass");
        return *mass;
    }

  private:
    static MjcfMasses::Body body_of(const XMLElement& at, const std::string& name, const MjcfParts& parts,
                                    const MjcfScope& scope) {
        return {name, &at, scope.model, parts.inertial, parts.geoms};
    }

    void note_shapes(const std::string& name) { robot_.omitted["contact shapes of bodies"].push_back(name); }

    void read_bodies(const MjcfParts& parts, std::size_t parent, bool moves) {
        for (const MjcfParts::Part& body : parts.bodies) read_body(*body.at, body.scope, parent, moves);
    }

    // `moves`: whether the parent moves
    void read_body(const XMLElement& at, const MjcfScope& scope, std::size_t parent, bool moves) {
        const char* given = at.Attribute("name");
        const std::string name = given && *given ? scope.name(given) : fmt::format("body{}", ++unnamed_);
        if (robot_.links.size() >= most_bodies)
            xml_.fail(at, fmt::format("is more than the {}th body", most_bodies), "give a robot with fewer bodies");
        MjcfScope inner = scope;
        inner.pose = {}, inner.depth = scope.depth + 1;
        const MjcfParts parts = collector_.collect(at, inner);
        const bool is_mocap = xml_.flag(at, "mocap");
        if (is_mocap && (parent != RobotJoint::world || !parts.joints.empty()))
            xml_.fail(at, "is a mocap body with joints or inside another body",
                      "make it a child of the world without joints");
        moves = moves || !parts.joints.empty();
        const RobotPose place = scope.pose * mjcf_pose(xml_, at, scope.model->compiler);
        const std::size_t link = joints_.add_body(at, name, parent, place, parts);
        if (given && *given) {
            names_.add(at, name, link);
        } else {
            generated_.push_back(link);
        }
        robot_.links[link].gravity_compensation = xml_.attribute_or(at, "gravcomp", 0);
        robot_.links[link].mass = mass_of(body_of(at, name, parts, scope), moves);
        if (!moves) static_.push_back({link, is_mocap});
        if (is_mocap) robot_.assumed["mocap bodies, fixed in place"].push_back(name);
        if (is_mocap) joints_.hold(at, name, link, place);
        if (scope.model->compiler.aligns_free && parts.bodies.empty()) joints_.align(link);
        if (parts.can_collide) note_shapes(name);
        read_bodies(parts, link, moves);
    }

    // The mass of a static body matters only for settotalmass.
    std::optional<MassProperties<Wide>> mass_of(const MjcfMasses::Body& body, bool moves) {
        if (moves || model_.compiler.total_mass > 0) return masses_.of(body);
        try {
            return masses_.of(body);
        } catch (const InputError&) {
            robot_.assumed["fixed bodies whose mass cannot be computed, treated as bodies without mass"].push_back(
                body.name);
            return {};
        }
    }

    void scale_masses() {
        const MjcfCompiler& compiler = model_.compiler;
        if (!(compiler.total_mass > 0)) return;
        std::set<std::size_t> left_out;  // fusestatic removes static bodies before the scaling
        for (const auto& [link, is_mocap] : static_)
            if (compiler.fuses_static && !is_mocap) left_out.insert(link);
        Wide total = 0;
        for (std::size_t i = 0; i < robot_.links.size(); ++i)
            if (robot_.links[i].mass && !left_out.contains(i)) total = total + robot_.links[i].mass->mass;
        if (!(total > Wide(0))) return;
        const Wide scale = Wide(compiler.total_mass) / total;
        for (RobotLink& link : robot_.links) {
            if (!link.mass) continue;
            link.mass->mass = scale * link.mass->mass;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) link.mass->inertia[i][j] = scale * link.mass->inertia[i][j];
        }
        robot_.assumed["masses scaled to settotalmass"].push_back(
            fmt::format("{} kg in total, factor {:.9g}", compiler.total_mass, double(scale)));
    }

    // Gives unnamed bodies names that differ from the given ones.
    void name_bodies() {
        std::set<std::string> taken;
        for (const RobotLink& link : robot_.links) taken.insert(link.name);
        for (const std::size_t i : generated_) {
            std::string& name = robot_.links[i].name;
            if (names_.has(name)) {
                while (taken.contains(name)) name += "_";
                taken.insert(name);
            }
            robot_.assumed["generated names of bodies"].push_back(name);
        }
    }

    void read_gravity() {
        robot_.gravity_W = Vector3<double>(0, 0, -9.81), robot_.gravity_source = "MuJoCo's default";
        if (const XMLElement* option = option_with(*model_.root, "gravity")) {
            robot_.gravity_W = three_of(xml_.attribute(*option, "gravity", 3));
            robot_.gravity_source = "<option gravity>";
        }
        if (is_enabled(xml_, *model_.root, "gravity")) return;
        robot_.gravity_W = Vector3<double>(), robot_.gravity_source = "<flag gravity=\"disable\">";
    }

    const RobotXml& xml_;
    MjcfLibrary& library_;
    const MjcfModel& model_;
    Robot robot_;
    MjcfCollector collector_;
    MjcfMasses masses_;
    RobotNames names_;
    MjcfJoints joints_;
    struct StaticLink {
        std::size_t link;
        bool is_mocap;
    };
    std::vector<StaticLink> static_;
    std::vector<std::size_t> generated_;
    int unnamed_ = 0;
};

}  // namespace

LinkInertial mjcf_body_inertial(const RobotXml& xml, XMLElement& root, const std::string& body) {
    MjcfLibrary library(xml);
    const MjcfModel& model = library.main(root);
    MjcfReader reader(xml, library, model);
    try {
        const XMLElement& at = named_element(xml, root, "body", body);
        if (!(model.compiler.total_mass > 0)) return reader.inertial_of(at);
    } catch (const InputError&) {
        // the body may get its name from <replicate> or <attach>
        if (!root.FirstChildElement("worldbody")) throw;
        const Robot robot = MjcfReader(xml, library, model).read();
        for (const RobotLink& link : robot.links)
            if (link.name == body && link.mass) return *link.mass;
        throw;
    }
    const Robot robot = reader.read();
    for (const RobotLink& link : robot.links)
        if (link.name == body && link.mass) return *link.mass;
    xml.fail(root, fmt::format("has no mass for the body \"{}\"", one_line(body, 60)), "give it one");
}

Robot mjcf_robot(const RobotXml& xml, XMLElement& root) {
    MjcfLibrary library(xml);
    const MjcfModel& model = library.main(root);
    return MjcfReader(xml, library, model).read();
}

}  // namespace polhode
