// Masses of MJCF bodies: <inertial>, primitive and mesh geoms, and the rules of <compiler>.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/shapes.h"
#include "scene/mjcf_model.h"

namespace polhode {

/// An element with the pose of its surrounding frames in the body's frame.
struct MjcfPlaced {
    const XMLElement* at = nullptr;
    const MjcfModel* model = nullptr;
    RobotPose pose;
};

/// Volume (or area), mean and spread of mesh assets, each computed once.
class MjcfMeshes {
  public:
    MjcfMeshes(const RobotXml& xml, RobotNotes& assumed) : xml_(xml), assumed_(assumed) {}

    /// The extent of a geom's mesh in the mesh's frame. `shell`: of the surface, whatever the asset specifies. Throws
    /// InputError if the mesh cannot be read or has no volume.
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

/// The extent of a mesh asset by the asset's own inertia rule. Deviations from MuJoCo are noted in `assumed`. Throws
/// InputError.
Extent<Wide> mjcf_mesh_extent(const RobotXml& xml, const MjcfModel& model, const XMLElement& asset, bool shell,
                              RobotNotes& assumed);

/// Area (m^2), mean (m) and spread (m^2) of the surface of a sphere, capsule, cylinder, box or ellipsoid.
Extent<Wide> mjcf_shell(const Shape& shape);

/// Computes the masses of bodies. Assumptions are noted with the bodies' names.
class MjcfMasses {
  public:
    MjcfMasses(const RobotXml& xml, RobotNotes& assumed) : xml_(xml), assumed_(assumed), meshes_(xml, assumed) {}

    struct Body {
        std::string name;                  ///< name in notes
        const XMLElement* at = nullptr;    ///< the <body>
        const MjcfModel* model = nullptr;  ///< the model whose <compiler> applies
        std::optional<MjcfPlaced> inertial;
        std::vector<MjcfPlaced> geoms;
    };
    /// Mass properties in the body's frame. Returns nothing for a body without mass and moments. Throws InputError.
    std::optional<MassProperties<Wide>> of(const Body& body);
    /// The numbers as written in the file, if the body's mass properties are given by them; else nothing.
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
