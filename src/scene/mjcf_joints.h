// Joints of MJCF bodies, with springs and dampers.
#pragma once

#include <string>
#include <vector>

#include "scene/mjcf_parts.h"
#include "scene/mjcf_springs.h"
#include "scene/robot_parts.h"

namespace polhode {

/// Whether the range of a joint or tendon is a limit.
bool has_mjcf_limits(const XMLElement& at);

/// Converts the joints of MJCF bodies and adds them to a robot.
class MjcfJoints {
  public:
    MjcfJoints(const RobotXml& xml, Robot& robot) : xml_(xml), robot_(robot), names_(xml, "joint") {}

    /// Sets whether springs and dampers act (<flag>).
    void set_passive_forces(bool springs, bool dampers) { springs_ = springs, dampers_ = dampers; }

    /// Adds a link for the body, and its joints. Each joint except the last moves a massless link in the body's own
    /// frame. A body without joints is welded to its parent; without joints in the world it is a root. Returns the
    /// link's index.
    std::size_t add_body(const XMLElement& at, const std::string& name, std::size_t parent, const RobotPose& place,
                         const MjcfParts& parts);
    /// Welds a body to the world.
    void hold(const XMLElement& at, const std::string& name, std::size_t link, const RobotPose& place);
    /// Moves the frame of a free link to its centre of mass, where its damping then acts (alignfree).
    void align(std::size_t link);
    /// Call this when all masses are known. Computes the springdampers and makes generated names distinct from given
    /// ones.
    void finish();
    /// The attribute `ref` of each joint, rad or m: MuJoCo's coordinate where that of the scene is zero.
    const std::vector<Wide>& references() const { return references_; }

  private:
    std::size_t add_link(const XMLElement& at, const std::string& name);
    RobotJoint& add(const XMLElement& at, const std::string& name, bool is_given, RobotMotion motion,
                    std::size_t parent, std::size_t child, const RobotPose& place);
    void add_joint(const MjcfParts::Part& part, const std::string& body, std::size_t from, std::size_t to,
                   const RobotPose& place, std::size_t count);
    void read_forces(const XMLElement& at, const MjcfCompiler& compiler, std::size_t index);
    void read_laws(const XMLElement& at, const MjcfCompiler& compiler, std::size_t index);
    void set_forces(const XMLElement& at, const MjcfCompiler& compiler, std::size_t index, const Wide& stiffness,
                    const Wide& damping);
    double leading(const XMLElement& at, const char* name, const std::string& joint);
    void omit(const char* what, const std::string& name) { robot_.omitted[what].push_back(name); }

    const RobotXml& xml_;
    Robot& robot_;
    RobotNames names_;
    bool springs_ = true, dampers_ = true;
    int unnamed_ = 0;
    std::vector<std::size_t> generated_;  ///< indices of joints
    std::vector<double> armature_;        ///< one per joint
    std::vector<Wide> references_;        ///< one per joint
    std::vector<MjcfSpringDamper> springdampers_;
    std::vector<const MjcfCompiler*> compilers_;  ///< one per springdamper
};

}  // namespace polhode
