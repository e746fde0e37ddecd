// The frames of an SDFormat file and their poses: worlds, models, links, joints and frames, including included
// models.
//
// Every frame is an entity; its name is qualified by the surrounding models ("model::link"). A scope is a name space:
// the world, a model, or a model merged into another (it shares the other's names but has its own model frame). A
// pose is resolved in its own scope; a model's frame connects its scope to the surrounding one.
//
// Version rules follow the SDFormat specification and libsdformat's *.convert files. Before 1.7 the attribute `frame`
// of <pose> means `relative_to`, and a link, a joint and a frame of one model may share a name, which then means the
// link.
#pragma once

#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/sdf_values.h"

namespace polhode {

/// The kind of an entity; merged: a model merged into its parent.
enum class SdfKind { world, model, merged, link, joint, frame };

/// A named frame.
struct SdfEntity {
    SdfKind kind = SdfKind::frame;
    const XMLElement* at = nullptr;
    std::string name;                     ///< qualified; empty for the world
    std::size_t scope = 0;                ///< the scope that contains it
    std::size_t own_scope = 0;            ///< models: the scope that the model defines
    const XMLElement* include = nullptr;  ///< included models: the <include>
    enum class State { unknown, sought, known } state = State::unknown;
    RobotPose local;  ///< pose in the frame of its scope, once known
};

/// A name space.
struct SdfScope {
    std::string prefix;     ///< prefix of the names in it
    std::size_t frame = 0;  ///< the entity named "__model__" or "world"
    int version = newest_sdf_version;
    bool is_static = false;
    RobotFiles files;                 ///< relative to the file that defines the scope
    std::vector<std::size_t> links;   ///< in file order, including merged ones
    std::vector<std::size_t> models;  ///< nested models
};

/// Thrown at the first <include> by an SdfTree that was constructed with read_includes = false.
struct SdfNeedsInclude {};

/// All frames of a file.
class SdfTree {
  public:
    static constexpr std::size_t world = 0;  ///< index of the world's entity and of its scope

    /// Throws InputError.
    SdfTree(const RobotXml& xml, const XMLElement& root, bool read_includes = true);

    const std::vector<SdfEntity>& entities() const { return entities_; }
    const SdfScope& scope(std::size_t i) const { return scopes_[i]; }
    const SdfScope& scope_of(const SdfEntity& entity) const { return scopes_[entity.scope]; }
    const XMLElement& top() const { return *top_; }  ///< <world>, or <sdf> for a file without one
    int version() const { return scopes_[0].version; }
    RobotNotes& omitted() { return omitted_; }
    RobotNotes& assumed() { return assumed_; }

    /// The entity with this name in this scope; `at` is the element that uses the name. Throws InputError if there is
    /// none.
    std::size_t find(const XMLElement& at, const std::string& name, std::size_t scope) const;
    /// The pose of a frame relative to a surrounding scope's frame.
    RobotPose pose_in(std::size_t entity, std::size_t scope);
    RobotPose pose_in_world(std::size_t entity);
    /// The link to which a frame is attached; `world` if it does not move.
    std::size_t link_of(std::size_t entity, const XMLElement& at, int depth = 0) const;
    /// Whether the entity is in the model `model` or in a model nested in it.
    bool is_within(std::size_t entity, std::size_t model) const;

  private:
    struct Included {
        const XMLElement* model = nullptr;
        int version = newest_sdf_version;
        RobotFiles files;
    };

    std::size_t add_entity(SdfKind kind, const XMLElement& at, std::size_t scope, bool has_key = true);
    void add_contents(const XMLElement& of, std::size_t scope);
    void add_model(const XMLElement& at, std::size_t scope, SdfKind kind, const Included* from,
                   const XMLElement* include);
    void add_include(const XMLElement& at, std::size_t scope, bool is_merged);
    /// Returns nothing for an included light or actor.
    std::optional<Included> read_include(const XMLElement& at, std::size_t scope);
    void place(SdfEntity& entity);
    RobotPose place_model(const SdfEntity& entity);

    const RobotXml& xml_;
    bool read_includes_;
    const XMLElement* top_ = nullptr;
    std::vector<SdfEntity> entities_;
    std::vector<SdfScope> scopes_;
    std::map<std::string, std::size_t, std::less<>> names_;
    std::list<tinyxml2::XMLDocument> documents_;
    std::deque<RobotOrigin> origins_;
    std::size_t included_bytes_ = 0;
    int include_depth_ = 0, placing_depth_ = 0;
    RobotNotes omitted_, assumed_;
};

/// Resolves the uri of an <include> to a file name relative to `files`: a file, or the model in a folder.
std::string find_sdf_include(const RobotXml& xml, const XMLElement& at, const std::string& uri,
                             const RobotFiles& files);

}  // namespace polhode
