// The frames of an SDFormat file: worlds, models, links, joints and frames, with included models, and where they are.
//
// Every frame is an entity with a name that the names of the models around it precede ("model::link"). A scope is what
// names are looked up in: the world, a model, or a model that is merged into another (the names of the other, a model
// frame of its own). A pose is resolved in its own scope; a model's scope frame leads on to the scope around it.
//
// Rules by version: SDFormat specification and libsdformat's *.convert files. Below 1.7 the attribute `frame` of <pose>
// means `relative_to`, and a link, a joint and a frame of one model may share a name, which then means the link.
#pragma once

#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/sdf_values.h"

namespace polhode {

enum class SdfKind { world, model, merged, link, joint, frame };

struct SdfEntity {
    SdfKind kind = SdfKind::frame;
    const XMLElement* at = nullptr;
    std::string name;                     ///< qualified; "" of the world
    std::size_t scope = 0;                ///< that it is in
    std::size_t own = 0;                  ///< of models: the scope that it makes
    const XMLElement* include = nullptr;  ///< of included models: the <include>
    enum class State { unknown, sought, known } state = State::unknown;
    RobotPose local;  ///< in the frame of its scope, once known
};

struct SdfScope {
    std::string prefix;     ///< of the names in it
    std::size_t frame = 0;  ///< the entity that "__model__" or "world" means
    int version = newest_sdf_version;
    bool is_static = false;
    RobotFiles files;                 ///< relative to the file that it is written in
    std::vector<std::size_t> links;   ///< in the order of the file, merged ones included
    std::vector<std::size_t> models;  ///< nested models
};

/// Thrown by an SdfTree that was made without reading includes, at the first one.
struct SdfNeedsInclude {};

class SdfTree {
  public:
    static constexpr std::size_t world = 0;  ///< the entity and the scope of the world

    /// Throws InputError. `omitted` and `assumed` take notes on included files.
    SdfTree(const RobotXml& xml, const XMLElement& root, bool read_includes = true);

    const std::vector<SdfEntity>& entities() const { return entities_; }
    const SdfScope& scope(std::size_t i) const { return scopes_[i]; }
    const SdfScope& scope_of(const SdfEntity& entity) const { return scopes_[entity.scope]; }
    const XMLElement& top() const { return *top_; }  ///< <world>, or <sdf> of a file without one
    int version() const { return scopes_[0].version; }
    RobotNotes& omitted() { return omitted_; }
    RobotNotes& assumed() { return assumed_; }

    /// The entity that a name in that scope means; `at` is the element that names it.
    std::size_t find(const XMLElement& at, const std::string& name, std::size_t scope) const;
    /// The frame in the frame of a scope around it.
    RobotPose pose_in(std::size_t entity, std::size_t scope);
    RobotPose pose_in_world(std::size_t entity);
    /// The link that a frame is attached to; `world` if it does not move.
    std::size_t link_of(std::size_t entity, const XMLElement& at, int depth = 0) const;
    /// Whether the entity is in the model `model` or in one nested in it.
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
    /// Nothing of an included light or actor.
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

/// The file, relative to `files`, that the uri of an <include> means: a file, or the model of a folder.
std::string find_sdf_include(const RobotXml& xml, const XMLElement& at, const std::string& uri,
                             const RobotFiles& files);

}  // namespace polhode
