// Reads whole robots from SDFormat: the links and joints of the selected models, gravity, and the import of one link.
//
// SdfTree provides frames and names. Links of static models are part of the world. If a single model moves, names are
// as written in it; if several do, each name is qualified by its model.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scene/robot_parts.h"
#include "scene/sdf_gears.h"
#include "scene/sdf_joints.h"
#include "scene/sdf_tree.h"
#include "text/message.h"

namespace polhode {
namespace {

// The mass properties of a link. Default values are noted in `assumed`.
LinkInertial inertial_of(const RobotXml& xml, SdfTree& tree, std::size_t index, const std::string& name,
                         RobotNotes& assumed) {
    const SdfEntity& entity = tree.entities()[index];
    const XMLElement* inertial = xml.optional_child(*entity.at, "inertial");
    if (inertial && sdf_flag_attribute(xml, *inertial, "auto")) {
        std::vector<SdfSolid> solids;
        for (const XMLElement* at = entity.at->FirstChildElement("collision"); at;
             at = at->NextSiblingElement("collision")) {
            const XMLElement* pose = xml.optional_child(*at, "pose");
            const std::string base = sdf_relative_to(pose, tree.scope_of(entity).version);
            RobotPose outer;
            if (!base.empty())
                outer = inverse(tree.pose_in_world(index)) * tree.pose_in_world(tree.find(*pose, base, entity.scope));
            solids.push_back({at, outer * sdf_pose(xml, pose), tree.scope_of(entity).files});
        }
        return sdf_computed_inertial(xml, *entity.at, name, solids, assumed);
    }
    std::vector<std::string> defaults;
    LinkInertial given = sdf_given_inertial(xml, inertial, defaults);
    if (!inertial)
        assumed["links without <inertial>: 1 kg and moments of 1 kg m^2, SDFormat's default"].push_back(name);
    for (const std::string& part : defaults)
        if (inertial && part == "mass")
            assumed["links without <mass>: 1 kg, SDFormat's default"].push_back(name);
        else if (inertial)
            assumed["links without <inertia> or with moments missing: 1 kg m^2, SDFormat's default"].push_back(name);
    return given;
}

class SdfReader {
  public:
    SdfReader(const RobotXml& xml, const XMLElement& root, const std::string& model)
        : xml_(xml), tree_(xml, root), chosen_(find_model(model)) {
        link_index_.assign(tree_.entities().size(), RobotJoint::world);
        robot_.roots_are_free = true;
        choose_prefix();
        survey_robot(xml, root, sdf_constructs(), robot_.omitted);
    }

    Robot read() {
        for (std::size_t i = 0; i < tree_.entities().size(); ++i) read_link(i);
        if (robot_.links.empty()) fail_without_links();
        for (const SdfEntity& entity : tree_.entities())
            if (entity.kind == SdfKind::joint) read_joint(entity);
        robot_.joints = direct_sdf_joints(xml_, std::move(joints_), robot_);
        for (const auto& [gearbox, ratio] : gearboxes_) add_sdf_gearbox(gearbox, ratio, robot_);
        read_gravity();
        for (const auto& [what, names] : tree_.omitted()) append(robot_.omitted[what], names);
        for (const auto& [what, names] : tree_.assumed()) append(robot_.assumed[what], names);
        return std::move(robot_);
    }

  private:
    static void append(std::vector<std::string>& to, const std::vector<std::string>& names) {
        to.insert(to.end(), names.begin(), names.end());
    }

    std::size_t find_model(const std::string& name) const {
        if (name.empty()) return SdfTree::world;
        std::vector<std::string> names;
        for (std::size_t i = 0; i < tree_.entities().size(); ++i) {
            if (tree_.entities()[i].kind != SdfKind::model) continue;
            if (tree_.entities()[i].name == name) return i;
            names.push_back(tree_.entities()[i].name);
        }
        const std::string meant = did_you_mean(name, names);
        xml_.fail(tree_.top(), fmt::format("has no model \"{}\"", one_line(name, 60)),
                  !meant.empty() ? meant : "give one of " + join_with_commas(names));
    }

    bool is_static(const SdfEntity& entity) const { return tree_.scope_of(entity).is_static; }

    // omits a prefix that all names share
    void choose_prefix() {
        if (chosen_ != SdfTree::world) prefix_ = tree_.entities()[chosen_].name + "::";
        std::set<std::size_t> moving;
        for (std::size_t i = 0; i < tree_.entities().size(); ++i) {
            const SdfEntity& link = tree_.entities()[i];
            if (link.kind != SdfKind::link) continue;
            std::size_t model = i;
            while (tree_.entities()[model].scope != SdfTree::world)
                model = tree_.scope_of(tree_.entities()[model]).frame;
            if (is_static(link)) {
                const std::size_t owner = tree_.scope_of(link).frame;
                static_models_.insert(tree_.entities()[owner].name);
            } else {
                moving.insert(model);
            }
        }
        if (prefix_.empty() && moving.size() == 1) prefix_ = tree_.entities()[*moving.begin()].name + "::";
        for (const std::string& name : static_models_)
            robot_.assumed["static models, treated as part of the world"].push_back(name);
    }

    std::string short_name(const std::string& name) const {
        return name.starts_with(prefix_) ? name.substr(prefix_.size()) : name;
    }

    void read_link(std::size_t index) {
        const SdfEntity& entity = tree_.entities()[index];
        if (entity.kind != SdfKind::link) return;
        if (entity.at->FirstChildElement("collision"))
            robot_.omitted["contact shapes of links"].push_back(short_name(entity.name));
        if (is_static(entity) || !tree_.is_within(index, chosen_)) return;
        RobotLink link;
        link.name = short_name(entity.name), link.place = xml_.place_of(*entity.at);
        link.mass = mass_of(inertial_of(xml_, tree_, index, link.name, robot_.assumed));
        if (link.mass->mass == 0) {
            robot_.assumed["links of mass 0, whose inertia tensors are ignored"].push_back(link.name);
            link.mass.reset();
        }
        if (const XMLElement* gravity = xml_.optional_child(*entity.at, "gravity");
            gravity && !sdf_text(*gravity).empty() && !sdf_flag(xml_, gravity))
            link.gravity_compensation = 1;
        link_index_[index] = robot_.links.size();
        robot_.places.push_back(tree_.pose_in_world(index));
        robot_.links.push_back(std::move(link));
    }

    [[noreturn]] void fail_without_links() const {
        const bool has_static = !static_models_.empty();
        xml_.fail(tree_.top(), has_static ? "has no movable <model>: all are static" : "has no <model> with a link",
                  has_static ? "remove <static> from one of them" : "give a model with a link");
    }

    // The link that a joint's <parent> or <child> names, directly or by a frame or a model; or the world.
    std::size_t end_of(const SdfEntity& joint, const char* tag) {
        const std::string name = sdf_child_text(xml_, *joint.at, tag, "the name of a link or frame");
        const XMLElement& at = xml_.child(*joint.at, tag);
        if (name == "world") {
            if (std::string_view(tag) == "child")
                xml_.fail(at, fmt::format("of joint \"{}\" is the world", name_or(*joint.at, "")),
                          "swap parent and child");
            return SdfTree::world;
        }
        return tree_.link_of(tree_.find(at, name, joint.scope), at);
    }

    bool is_imported(std::size_t link) const {
        return link == SdfTree::world || link_index_[link] != RobotJoint::world;
    }

    void read_joint(const SdfEntity& entity) {
        const std::size_t parent = end_of(entity, "parent"), child = end_of(entity, "child");
        const std::string name = unique_name(short_name(entity.name));
        if (parent == child && parent == SdfTree::world) return;  // inside a static model
        if (parent == child)
            xml_.fail(*entity.at, fmt::format("joint \"{}\" has the same link as parent and child", one_line(name, 60)),
                      "give two different links");
        if (!is_imported(parent) || !is_imported(child)) {
            const bool touches =
                (parent != SdfTree::world && is_imported(parent)) || (child != SdfTree::world && is_imported(child));
            if (touches) robot_.omitted["joints to models that are not imported"].push_back(name);
            return;
        }
        if (const char* type = entity.at->Attribute("type"); type && std::string_view(type) == "gearbox")
            return read_gearbox(entity, name, parent, child);
        SdfJoint one{entity.at, read_sdf_joint(xml_, tree_, entity, name, parent, child, robot_)};
        if (parent != SdfTree::world) one.joint.parent = link_index_[parent];
        one.joint.child = child == SdfTree::world ? RobotJoint::world : link_index_[child];
        joint_names_.insert(name);
        joints_.push_back(std::move(one));
    }

    std::size_t robot_index(std::size_t link) const {
        return link == SdfTree::world ? RobotJoint::world : link_index_[link];
    }

    void read_gearbox(const SdfEntity& entity, const std::string& name, std::size_t parent, std::size_t child) {
        const std::size_t reference = end_of(entity, "gearbox_reference_body");
        if (!is_imported(reference)) {
            robot_.omitted["joints to models that are not imported"].push_back(name);
            return;
        }
        SdfGearbox gearbox{name, robot_index(parent), robot_index(child), robot_index(reference), {}};
        gearbox.axes_W = {sdf_axis_in_world(xml_, tree_, entity, "axis", robot_),
                          sdf_axis_in_world(xml_, tree_, entity, "axis2", robot_)};
        gearboxes_.emplace_back(std::move(gearbox), sdf_gearbox_ratio(xml_, *entity.at));
        joint_names_.insert(name);
    }
    // a joint of the world may have the same name as one of a model
    std::string unique_name(std::string name) const {
        while (joint_names_.contains(name)) name.insert(0, "world::");
        return name;
    }

    // from <world>; up to SDFormat 1.5 from its <physics>
    void read_gravity() {
        const XMLElement& world = tree_.top();
        if (std::string_view(world.Name()) != "world") return;
        const XMLElement* physics = world.FirstChildElement("physics");
        for (const XMLElement* at = physics; at; at = at->NextSiblingElement("physics"))
            if (sdf_flag_attribute(xml_, *at, "default")) physics = at;
        const XMLElement* at = xml_.optional_child(world, "gravity");
        robot_.gravity_source = "<world><gravity>";
        const XMLElement* old = physics ? xml_.optional_child(*physics, "gravity") : nullptr;
        if (old && tree_.version() >= 6) {
            robot_.omitted["<gravity> of <physics>, which SDFormat 1.6 moved to <world>"].push_back(
                robot_note_name(xml_, *old));
        } else if (old && !at) {
            at = old, robot_.gravity_source = "<physics><gravity>";
        }
        if (at && sdf_text(*at).empty()) at = nullptr;
        if (!at) robot_.gravity_source = "SDFormat's default";
        robot_.gravity_W = at ? three_of(xml_.content(*at, 3)) : Vector3<double>(0, 0, -9.8);
    }

    const RobotXml& xml_;
    SdfTree tree_;
    std::size_t chosen_;                   // the selected model, or the world for all
    std::string prefix_;                   // omitted from names
    std::set<std::string> static_models_;  // static models
    std::vector<std::size_t> link_index_;  // index in the robot of each entity
    std::set<std::string> joint_names_;
    std::vector<SdfJoint> joints_;
    std::vector<std::pair<SdfGearbox, double>> gearboxes_;  // with their ratios
    Robot robot_;
};

// All links with this name, alone or qualified by models.
std::vector<std::size_t> find_links(const SdfTree& tree, const std::string& name, std::vector<std::string>& names) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < tree.entities().size(); ++i) {
        const SdfEntity& one = tree.entities()[i];
        if (one.kind != SdfKind::link) continue;
        names.push_back(one.name);
        if (one.name == name || ("::" + one.name).ends_with("::" + name)) found.push_back(i);
    }
    return found;
}

LinkInertial find_inertial(const RobotXml& xml, SdfTree& tree, const std::string& link) {
    std::vector<std::string> names;
    const std::vector<std::size_t> found = find_links(tree, link, names);
    if (found.empty()) {
        const std::string meant = did_you_mean(link, names);
        throw InputError(xml.path(), "", fmt::format("has no link \"{}\"", one_line(link, 60)),
                         !meant.empty()  ? meant
                         : names.empty() ? "give a file with a named link"
                                         : "give one of " + join_with_commas(names));
    }
    if (found.size() > 1)
        xml.fail(*tree.entities()[found[1]].at, fmt::format("is a second link \"{}\"", one_line(link, 60)),
                 "give \"model::link\", or rename one of them");
    RobotNotes assumed;
    LinkInertial inertial = inertial_of(xml, tree, found[0], link, assumed);
    // the link is from an included file, so its numbers are not those of the file that the scene names
    if (tree.entities()[found[0]].at->GetUserData()) return mass_of(inertial);
    return inertial;
}

}  // namespace

LinkInertial sdf_link_inertial(const RobotXml& xml, const XMLElement& root, const std::string& link) {
    try {
        SdfTree tree(xml, root, false);
        return find_inertial(xml, tree, link);
    } catch (const SdfNeedsInclude&) {
        SdfTree tree(xml, root);
        return find_inertial(xml, tree, link);
    }
}

Robot sdf_robot(const RobotXml& xml, const XMLElement& root, const std::string& model) {
    return SdfReader(xml, root, model).read();
}

}  // namespace polhode
