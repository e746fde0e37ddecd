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
#include "scene/scene.h"

namespace polhode {

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
    int line = 0;                              ///< in the file
    std::optional<MassProperties<Wide>> mass;  ///< in the link's frame
};

enum class RobotMotion { revolute, prismatic, spherical, universal, fixed, free };

struct RobotJoint {
    static constexpr std::size_t world = static_cast<std::size_t>(-1);

    std::string name;
    int line = 0;  ///< in the file
    RobotMotion motion = RobotMotion::fixed;
    std::size_t parent = world;         ///< a link, or the world
    std::size_t child = 0;              ///< a link; each is the child of one joint at most
    RobotPose placement;                ///< of the child in the parent, at coordinate zero
    Vector3<Wide> point;                ///< that the joint holds, in the child's frame
    std::array<Vector3<Wide>, 2> axes;  ///< in the child's frame, at coordinate zero
    std::array<Wide, 2> stiffness{}, rest{}, damping{};
};

/// What a file has and a scene has no place for: "limits" -> the names of the joints that have them, ..
using RobotLeftOut = std::map<std::string, std::vector<std::string>>;

struct Robot {
    std::vector<RobotLink> links;
    std::vector<RobotJoint> joints;  ///< trees; a link without one is a root
    bool roots_are_free = false;     ///< where nobody says: free bodies or held where they are
    std::vector<RobotPose> places;   ///< of each link in the world, where the file says; of roots alone
    RobotLeftOut left_out;
};

/// The robot in a file's text, the format told by the root element; `path` is named in errors. Throws InputError.
Robot parse_robot(std::string_view text, const std::string& path);

/// How a robot is held, where its file leaves that open: as is usual for its format, or as said.
enum class RobotBase { as_usual, fixed, free };

/// Its bodies and joints go into the scene, and what is left out. Links without mass are merged with those that fixed
/// joints tie them to, or dropped at the ends of the tree; one between two turns makes these a universal joint. Throws
/// InputError where one without mass is left, or where a scene cannot express the tree.
void add_robot(const Robot& robot, RobotBase base, const std::string& path, Scene& scene);

}  // namespace polhode
