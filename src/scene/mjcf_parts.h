// Collects the parts of one MJCF body, with <frame>, <replicate> and <attach> expanded.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/mjcf_mass.h"

namespace polhode {

/// The context in which an element is read: its model, the pose of the frames between it and its body, and the prefix
/// and suffix of names.
struct MjcfScope {
    const MjcfModel* model = nullptr;
    RobotPose pose;
    std::string prefix, suffix;
    int depth = 0;  ///< nesting depth of bodies, frames, replicates and attached models

    std::string name(const std::string& own) const { return prefix + own + suffix; }
};

/// The parts of one body.
struct MjcfParts {
    struct Part {
        const XMLElement* at = nullptr;
        MjcfScope scope;
    };
    std::optional<MjcfPlaced> inertial;
    std::vector<MjcfPlaced> geoms;
    std::vector<Part> joints, bodies;  ///< <joint> and <freejoint>; child bodies
    bool can_collide = false;          ///< whether a geom takes part in contact
};

/// Collects the parts of bodies. Inputs are untrusted: the depth and number of expanded elements are limited.
class MjcfCollector {
  public:
    MjcfCollector(const RobotXml& xml, MjcfLibrary& library) : xml_(xml), library_(library) {}

    /// The parts below a <body>, <worldbody> or <frame>. Throws InputError.
    MjcfParts collect(const XMLElement& of, const MjcfScope& scope);

  private:
    void collect(const XMLElement& of, const MjcfScope& scope, MjcfParts& parts);
    void collect_one(const XMLElement& at, const MjcfScope& scope, MjcfParts& parts);
    void replicate(const XMLElement& at, const MjcfScope& scope, MjcfParts& parts);
    void attach(const XMLElement& at, const MjcfScope& scope, MjcfParts& parts);
    void count(const XMLElement& at, const MjcfScope& scope);

    const RobotXml& xml_;
    MjcfLibrary& library_;
    std::size_t visited_ = 0;
};

}  // namespace polhode
