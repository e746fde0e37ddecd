// Builds the entities and scopes of an SDFormat file and resolves names, poses and attachments.
//
// add_contents() adds entities recursively, including those of included files. place() resolves poses on demand; the
// state `sought` detects poses that are relative to themselves. link_of() follows attachments to a link, with a depth
// limit.

#include "scene/sdf_tree.h"

#include <fmt/format.h>

#include <algorithm>

#include "text/message.h"

namespace polhode {
namespace {

constexpr int deepest_frames = 1000;
constexpr std::size_t most_entities = 50'000;

bool is_joint_of_another_format(std::string_view tag) {
    const std::size_t colon = tag.rfind(':');
    return colon != std::string_view::npos && tag.substr(colon + 1) == "joint";
}

bool ends_with_scope(const std::string& name, std::string_view last) {
    return name.size() > last.size() && std::string_view(name).substr(name.size() - last.size()) == last;
}

}  // namespace

SdfTree::SdfTree(const RobotXml& xml, const XMLElement& root, bool read_includes)
    : xml_(xml), read_includes_(read_includes) {
    top_ = root.FirstChildElement("world") ? &xml.child(root, "world") : &root;
    SdfScope scope;
    scope.version = sdf_version(xml, root, assumed_), scope.files = xml.files();
    scopes_.push_back(scope);
    SdfEntity all;
    all.kind = SdfKind::world, all.at = top_, all.state = SdfEntity::State::known;
    entities_.push_back(all);
    add_contents(*top_, world);
    if (top_ == &root) return;
    for (const XMLElement* at = root.FirstChildElement("model"); at; at = at->NextSiblingElement("model"))
        omitted_["models outside the world"].push_back(name_or(*at, ""));
}

std::size_t SdfTree::add_entity(SdfKind kind, const XMLElement& at, std::size_t scope, bool has_key) {
    if (entities_.size() >= most_entities)
        xml_.fail(at, fmt::format("exceeds the limit of {} links, joints and frames", most_entities),
                  "give a smaller file");
    SdfEntity entity;
    entity.kind = kind, entity.at = &at, entity.scope = scope;
    const std::string name = xml_.name(at, "name", "its name");
    if (name == "world" || name == "__model__")
        xml_.fail(at, fmt::format("has the reserved name \"{}\"", name), "give it another name");
    entity.name = scopes_[scope].prefix + name;
    if (has_key && !names_.emplace(entity.name, entities_.size()).second) {
        const SdfEntity& other = entities_[names_.at(entity.name)];
        if (scopes_[scope].version >= 7 || other.kind == kind)
            xml_.fail(at, fmt::format("is a second \"{}\"", one_line(entity.name, 60)),
                      fmt::format("the first is at {}; give links, joints, frames and models unique names",
                                  xml_.place_of(*other.at)));
    }
    entities_.push_back(entity);
    return entities_.size() - 1;
}

// Adds links first, then models, joints and frames: a shared name refers to the first of these.
void SdfTree::add_contents(const XMLElement& of, std::size_t scope) {
    const auto each = [&](const char* tag, auto&& visit) {
        for (const XMLElement* at = of.FirstChildElement(tag); at; at = at->NextSiblingElement(tag)) visit(*at);
    };
    for (const XMLElement* at = of.FirstChildElement(); at; at = at->NextSiblingElement()) {
        if (is_joint_of_another_format(at->Name()))
            xml_.fail(*at, fmt::format("\"{}\" is a joint type that is not part of SDFormat", name_or(*at, "")),
                      "use a joint type of SDFormat, or remove it and add the joint to the scene");
        const std::string_view tag = at->Name();
        if (tag == "link" && scope == world) continue;  // not allowed in a world; the table of constructs reports it
        if (tag == "link") scopes_[scope].links.push_back(add_entity(SdfKind::link, *at, scope));
        if (tag == "include" && sdf_flag_attribute(xml_, *at, "merge")) add_include(*at, scope, true);
    }
    each("model", [&](const XMLElement& at) { add_model(at, scope, SdfKind::model, nullptr, nullptr); });
    each("include", [&](const XMLElement& at) {
        if (!sdf_flag_attribute(xml_, at, "merge")) add_include(at, scope, false);
    });
    each("joint", [&](const XMLElement& at) { add_entity(SdfKind::joint, at, scope); });
    each("frame", [&](const XMLElement& at) { add_entity(SdfKind::frame, at, scope); });
}

void SdfTree::add_model(const XMLElement& at, std::size_t scope, SdfKind kind, const Included* from,
                        const XMLElement* include) {
    const XMLElement* name_at = include ? include->FirstChildElement("name") : nullptr;
    const std::string new_name = name_at ? sdf_text(*name_at) : "";
    std::size_t index = entities_.size();
    if (new_name.empty() && kind == SdfKind::model) {
        index = add_entity(kind, at, scope);
    } else {
        SdfEntity entity;
        entity.kind = kind, entity.at = &at, entity.scope = scope;
        entity.name = scopes_[scope].prefix + new_name;
        if (kind == SdfKind::model && !names_.emplace(entity.name, index).second)
            xml_.fail(*name_at, fmt::format("is a second \"{}\"", one_line(entity.name, 60)),
                      "give each included model a unique name");
        entities_.push_back(entity);
    }
    SdfScope own;
    own.prefix = kind == SdfKind::model ? entities_[index].name + "::" : scopes_[scope].prefix;
    own.frame = index;
    own.version = from ? from->version : scopes_[scope].version;
    own.files = from ? from->files : scopes_[scope].files;
    const XMLElement* still = at.FirstChildElement("static");
    if (include && include->FirstChildElement("static")) still = include->FirstChildElement("static");
    own.is_static = scopes_[scope].is_static || (kind == SdfKind::model && sdf_flag(xml_, still));
    entities_[index].own_scope = scopes_.size(), entities_[index].include = include;
    if (kind == SdfKind::model) scopes_[scope].models.push_back(index);
    scopes_.push_back(own);
    const std::size_t scope_index = scopes_.size() - 1;
    add_contents(at, scope_index);
    if (kind != SdfKind::merged) return;
    const SdfScope merged = scopes_[scope_index];
    SdfScope& outer = scopes_[scope];
    outer.links.insert(outer.links.end(), merged.links.begin(), merged.links.end());
    outer.models.insert(outer.models.end(), merged.models.begin(), merged.models.end());
}

void SdfTree::add_include(const XMLElement& at, std::size_t scope, bool is_merged) {
    if (!read_includes_) throw SdfNeedsInclude();
    if (is_merged && scope == world)
        xml_.fail(at, "merges an included file into the world", "include its models one by one, without \"merge\"");
    constexpr int deepest = 16;
    if (include_depth_ >= deepest)
        xml_.fail(at, fmt::format("is nested more than {} files deep", deepest),
                  "check whether a file includes itself");
    ++include_depth_;
    if (const std::optional<Included> from = read_include(at, scope))
        add_model(*from->model, scope, is_merged ? SdfKind::merged : SdfKind::model, &*from, &at);
    --include_depth_;
}

bool SdfTree::is_within(std::size_t entity, std::size_t model) const {
    for (std::size_t e = entity; e != model; e = scopes_[entities_[e].scope].frame)
        if (e == world) return false;
    return true;
}

std::size_t SdfTree::find(const XMLElement& at, const std::string& name, std::size_t scope) const {
    const SdfScope& here = scopes_[scope];
    if (name.empty() || name == (scope == world ? "world" : "__model__")) return here.frame;
    auto found = names_.find(here.prefix + name);
    constexpr std::string_view model = "::__model__";
    if (found == names_.end() && ends_with_scope(name, model))
        found = names_.find(here.prefix + name.substr(0, name.size() - model.size()));
    if (found != names_.end() && is_within(found->second, here.frame)) return found->second;
    std::vector<std::string> known;
    for (auto one = names_.lower_bound(here.prefix); one != names_.end() && one->first.starts_with(here.prefix); ++one)
        known.push_back(one->first.substr(here.prefix.size()));
    const std::string meant = did_you_mean(name, known);
    const std::string where =
        scope == world ? "the world" : fmt::format("the model \"{}\"", name_or(*entities_[here.frame].at, ""));
    xml_.fail(at, fmt::format("refers to \"{}\", which does not exist in {}", one_line(name, 60), one_line(where, 80)),
              meant.empty() ? "give a link, a joint, a frame or a model" : meant);
}

RobotPose SdfTree::pose_in(std::size_t entity, std::size_t scope) {
    RobotPose pose;
    for (std::size_t e = entity; e != scopes_[scope].frame; e = scopes_[entities_[e].scope].frame) {
        place(entities_[e]);
        pose = entities_[e].local * pose;
    }
    return pose;
}

RobotPose SdfTree::pose_in_world(std::size_t entity) { return pose_in(entity, world); }

void SdfTree::place(SdfEntity& entity) {
    if (entity.state == SdfEntity::State::known) return;
    if (entity.state == SdfEntity::State::sought || ++placing_depth_ > deepest_frames)
        xml_.fail(*entity.at, fmt::format("\"{}\" is placed relative to itself", one_line(entity.name, 60)),
                  "give a pose relative to a frame that does not depend on it");
    entity.state = SdfEntity::State::sought;
    const int version = scopes_[entity.scope].version;
    if (entity.kind == SdfKind::model || entity.kind == SdfKind::merged) {
        entity.local = place_model(entity);
    } else {
        const XMLElement* pose = xml_.optional_child(*entity.at, "pose");
        std::string base = sdf_relative_to(pose, version);
        if (pose && version >= 7 && pose->Attribute("frame"))
            omitted_["attribute frame of <pose>, which SDFormat 1.7 replaced by relative_to"].push_back(
                robot_note_name(xml_, *pose));
        if (base.empty() && entity.kind == SdfKind::joint)
            base = sdf_child_text(xml_, *entity.at, "child", "the name of a link or frame");
        if (base.empty() && entity.kind == SdfKind::frame && entity.at->Attribute("attached_to"))
            base = entity.at->Attribute("attached_to");
        const std::size_t outer = find(pose ? *pose : *entity.at, base, entity.scope);
        entity.local = pose_in(outer, entity.scope) * sdf_pose(xml_, pose);
    }
    --placing_depth_;
    entity.state = SdfEntity::State::known;
}

// The <pose> places the model's frame, or the frame named by placement_frame.
RobotPose SdfTree::place_model(const SdfEntity& entity) {
    const XMLElement* pose = xml_.optional_child(*entity.at, "pose");
    int version = scopes_[entity.own_scope].version;
    std::string frame = entity.at->Attribute("placement_frame") ? entity.at->Attribute("placement_frame") : "";
    if (entity.include) {
        const XMLElement* other = xml_.optional_child(*entity.include, "pose");
        if (const XMLElement* placed = xml_.optional_child(*entity.include, "placement_frame")) {
            if (!other)
                xml_.fail(*placed, "is given in an <include> without a <pose>", "give the pose of the placement frame");
            frame = sdf_text(*placed);
        }
        if (other) {
            pose = other, version = scopes_[entity.scope].version;
        } else if (pose && !sdf_relative_to(pose, version).empty()) {
            xml_.fail(*pose, "of an included model is relative to another frame", "give the <include> a <pose>");
        }
    }
    const std::size_t base = find(pose ? *pose : *entity.at, sdf_relative_to(pose, version), entity.scope);
    RobotPose local = pose_in(base, entity.scope) * sdf_pose(xml_, pose);
    if (frame.empty()) return local;
    return local * inverse(pose_in(find(*entity.at, frame, entity.own_scope), entity.own_scope));
}

std::size_t SdfTree::link_of(std::size_t index, const XMLElement& at, int depth) const {
    const SdfEntity& entity = entities_[index];
    if (depth > deepest_frames)
        xml_.fail(*entity.at, fmt::format("\"{}\" is attached to itself", one_line(entity.name, 60)),
                  "attach it to a link");
    if (entity.kind == SdfKind::world) return world;
    const bool is_model = entity.kind == SdfKind::model || entity.kind == SdfKind::merged;
    const SdfScope& own = scopes_[is_model ? entity.own_scope : entity.scope];
    if (own.is_static) return world;
    if (entity.kind == SdfKind::link) return index;
    if (entity.kind == SdfKind::joint) {
        const std::string child = sdf_child_text(xml_, *entity.at, "child", "the name of a link or frame");
        return link_of(find(*entity.at, child, entity.scope), at, depth + 1);
    }
    if (entity.kind == SdfKind::frame) {
        const char* name = entity.at->Attribute("attached_to");
        return link_of(find(*entity.at, name ? name : "", entity.scope), at, depth + 1);
    }
    const char* canonical = entity.at->Attribute("canonical_link");
    if (canonical && *canonical) {
        const std::size_t link = find(*entity.at, canonical, entity.own_scope);
        if (entities_[link].kind != SdfKind::link)
            xml_.fail(*entity.at, fmt::format("has the canonical_link \"{}\", which is not a link", canonical),
                      "give a link of the model");
        return link_of(link, at, depth + 1);
    }
    if (!own.links.empty()) return own.links.front();
    if (!own.models.empty()) return link_of(own.models.front(), at, depth + 1);
    xml_.fail(at, fmt::format("refers to the model \"{}\", which has no link", one_line(entity.name, 60)),
              "give a model with a link");
}

}  // namespace polhode
