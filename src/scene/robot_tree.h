// A whole robot: what URDF, MJCF and SDFormat files say of links and joints, and the bodies and joints that it makes.
//
// Numbers are carried to 113 bits, so that what comes out is rounded once.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/body_source.h"
#include "scene/robot_files.h"
#include "scene/scene.h"

namespace polhode {

/// How a robot is held where its file leaves that open.
enum class RobotBase { as_usual, fixed, free };

/// Where one frame is in another: v_there = rotate(turn, v_here) + position.
struct RobotPose {
    Vector3<Wide> position;  ///< m
    Quaternion<Wide> turn;   ///< of unit length
};
RobotPose operator*(const RobotPose& outer, const RobotPose& inner);
RobotPose inverse(const RobotPose& pose);
Vector3<Wide> operator*(const RobotPose& pose, const Vector3<Wide>& point);

struct RobotLink {
    std::string name;
    std::string place;                         ///< in the file, for messages: "line 12"
    std::optional<MassProperties<Wide>> mass;  ///< in the link's frame
};

enum class RobotMotion { revolute, prismatic, spherical, universal, fixed, free };

struct RobotJoint {
    static constexpr std::size_t world = static_cast<std::size_t>(-1);

    std::string name;
    std::string place;  ///< in the file, for messages
    RobotMotion motion = RobotMotion::fixed;
    std::size_t parent = world;         ///< a link, or the world
    std::size_t child = 0;              ///< a link; each is the child of one joint at most
    RobotPose placement;                ///< of the child in the parent, at coordinate zero
    Vector3<Wide> point;                ///< that the joint holds, in the child's frame
    std::array<Vector3<Wide>, 2> axes;  ///< in the child's frame, at coordinate zero
    std::array<Wide, 2> stiffness{}, rest{}, damping{};
};

/// Constructs of a file under headings, each with names: "limits of joints" -> the joints that have them.
using RobotNotes = std::map<std::string, std::vector<std::string>>;

struct Robot {
    std::vector<RobotLink> links;
    std::vector<RobotJoint> joints;  ///< trees; a link without one is a root
    bool roots_are_free = false;     ///< the format's rule for roots that no joint holds: free bodies, or held in place
    std::vector<RobotPose> places;   ///< of each link in the world, where the file says; of roots alone
    RobotNotes omitted;              ///< what may change the motion and is not modelled
    RobotNotes assumed;              ///< values that the file does not state, or that were repaired
    /// Gravity by the file or its format (m/s^2, world axes); none: the file says nothing (URDF, SDFormat models).
    std::optional<Vector3<double>> gravity_W;
    std::string gravity_source;  ///< "MuJoCo's default", "<option gravity>", ..
    /// Linear drag of free links: link, c of the torque -c w (N m s) and of the force -c v (N s/m) at its origin.
    struct FreeDamping {
        std::size_t link = 0;
        double rotational = 0, translational = 0;
    };
    std::vector<FreeDamping> free_damping;
};

/// Which robot to read from a file, and how.
struct RobotOptions {
    std::string model;  ///< SDFormat: the model to take, "outer::inner" if nested; empty: all together
    RobotBase base = RobotBase::as_usual;
    bool balance_inertia = false;    ///< accept tensors that break the triangle inequality by any amount
    bool scene_has_gravity = false;  ///< the scene has a gravity load of its own, which takes precedence
};

/// The robot in a file's text; the root element tells the format. Errors name `path`. Throws InputError.
Robot parse_robot(std::string_view text, const std::string& path, const RobotOptions& options = {},
                  const RobotFiles& files = {});

/// Adds the robot's bodies, joints and loads to the scene, and the notes on what was omitted or assumed. Links without
/// mass are merged with the links that fixed joints tie them to, or dropped at the ends of the tree; one between two
/// hinges that meet makes these a universal joint. Throws InputError where a scene cannot express the tree.
void add_robot(const Robot& robot, const RobotOptions& options, const std::string& path, Scene& scene);

}  // namespace polhode
