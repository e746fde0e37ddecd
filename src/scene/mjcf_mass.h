// Masses of MJCF bodies: <inertial>, geoms of primitives and meshes, and the rules of <compiler>.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/shapes.h"
#include "scene/mjcf_model.h"

namespace polhode {

/// An element with the pose of the frames around it, in the body's frame.
struct MjcfPlaced {
    const XMLElement* at = nullptr;
    const MjcfModel* model = nullptr;
    RobotPose pose;
};

/// Volume (or area), mean and spread of mesh assets, each computed once.
class MjcfMeshes {
  public:
    MjcfMeshes(const RobotXml& xml, RobotNotes& assumed) : xml_(xml), assumed_(assumed) {}

    /// Of the mesh that a geom names, in the mesh's frame; `shell`: of the surface, whatever the asset says. Throws
    /// InputError where the mesh cannot be read or has no volume.
    const Extent<Wide>& extent(const MjcfModel& model, const XMLElement& geom, bool shell);

  private:
    struct Key {
        const XMLElement* asset;
        bool shell;
        bool operator<(const Key& other) const { return std::pair(asset, shell) < std::pair(other.asset, other.shell); }
    };

    const RobotXml& xml_;
    RobotNotes& assumed_;
    std::map<Key, Extent<Wide>> extents_;
};

/// The volume of a mesh asset by its own rule; what the rule changes against MuJoCo is noted. Throws InputError.
Extent<Wide> mjcf_mesh_extent(const RobotXml& xml, const MjcfModel& model, const XMLElement& asset, bool shell,
                              RobotNotes& assumed);

/// Area (m^2), mean and spread of the surface of a sphere, capsule, cylinder, box or ellipsoid.
Extent<Wide> mjcf_shell(const Shape& shape);

/// Masses of bodies. What was assumed is noted under the names of bodies.
class MjcfMasses {
  public:
    MjcfMasses(const RobotXml& xml, RobotNotes& assumed) : xml_(xml), assumed_(assumed), meshes_(xml, assumed) {}

    struct Body {
        std::string name;                  ///< for notes
        const XMLElement* at = nullptr;    ///< <body>
        const MjcfModel* model = nullptr;  ///< whose <compiler> counts
        std::optional<MjcfPlaced> inertial;
        std::vector<MjcfPlaced> geoms;
    };
    /// In the body's frame; none of a body without mass and moments. Throws InputError.
    std::optional<MassProperties<Wide>> of(const Body& body);
    /// The numbers of the file, where the body has these; else none.
    std::optional<ImportedBody> given(const Body& body);

  private:
    std::optional<MassProperties<Wide>> of_geoms(const Body& body);
    std::optional<MassProperties<Wide>> of_geom(const Body& body, const MjcfPlaced& geom);
    void apply_bounds(const Body& body, std::optional<MassProperties<Wide>>& mass);
    Extent<Wide> extent(const MjcfPlaced& geom, RobotPose& place, const std::string& body);
    Extent<Wide> fitted(const MjcfPlaced& geom, const std::string& type, bool shell);
    void note(const char* what, const std::string& name) {
        std::vector<std::string>& names = assumed_[what];
        if (names.empty() || names.back() != name) names.push_back(name);
    }

    const RobotXml& xml_;
    RobotNotes& assumed_;
    MjcfMeshes meshes_;
};

}  // namespace polhode
