// A whole robot: links and joints as read from URDF, MJCF or SDFormat, and their conversion to bodies and joints.
//
// Numbers are carried to 113 bits, so that results are rounded once.
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

/// Whether root links are fixed or free if the file does not specify it.
enum class RobotBase { format_default, fixed, free };

/// The pose of one frame in another: v_outer = rotate(turn, v_inner) + position.
struct RobotPose {
    Vector3<Wide> position;  ///< m
    Quaternion<Wide> turn;   ///< unit quaternion
};
/// The product of poses, the inverse pose, and a pose applied to a point (m).
RobotPose operator*(const RobotPose& outer, const RobotPose& inner);
RobotPose inverse(const RobotPose& pose);
Vector3<Wide> operator*(const RobotPose& pose, const Vector3<Wide>& point);

/// A link as read from a file.
struct RobotLink {
    std::string name;
    std::string place;                         ///< in the file, for messages: "line 12"
    std::optional<MassProperties<Wide>> mass;  ///< in the link's frame
    double gravity_compensation = 0;           ///< fraction of its weight that an upward force carries
};

/// How a joint lets its child move.
enum class RobotMotion {
    revolute,
    prismatic,
    spherical,
    universal,
    fixed,
    free,
    screw,   ///< rotation about an axis and displacement along it
    planar,  ///< displacements perpendicular to an axis and rotation about it
};

/// A joint as read from a file.
struct RobotJoint {
    static constexpr std::size_t world = static_cast<std::size_t>(-1);

    std::string name;
    std::string place;  ///< in the file, for messages
    RobotMotion motion = RobotMotion::fixed;
    std::size_t parent = world;         ///< index of a link, or the world
    std::size_t child = 0;              ///< index of a link; each is the child of at most one joint
    RobotPose placement;                ///< pose of the child in the parent at coordinate zero
    Vector3<Wide> point;                ///< the joint's point, in the child's frame
    std::array<Vector3<Wide>, 2> axes;  ///< in the child's frame at coordinate zero
    std::array<Wide, 2> stiffness{}, rest{}, damping{}, armature{};
    /// By axis; used with RobotOptions::limits_and_friction.
    std::array<double, 2> friction{};
    std::array<JointLimits, 2> limits;
    std::array<double, 2> start{};  ///< coordinate at t = 0, rad or m
    Wide pitch = 0;                 ///< screw: displacement per rotation, m/rad

    /// Whether an axis has limits or friction.
    bool has_law() const;
    /// Fixes a revolute or prismatic joint at a coordinate, rad or m.
    void lock(const Wide& x);
};

/// Constructs of a file: heading -> names, such as "limits of joints" -> the joints that have limits.
using RobotNotes = std::map<std::string, std::vector<std::string>>;

/// A robot as read from a file.
struct Robot {
    std::vector<RobotLink> links;
    std::vector<RobotJoint> joints;  ///< form trees; a link without a joint is a root
    bool roots_are_free = false;     ///< the format's rule for roots without a joint: free, or fixed to the world
    std::vector<RobotPose> places;   ///< per link: pose in the world, if given; used for roots only
    RobotNotes omitted;              ///< constructs that may change the motion but are not modelled
    RobotNotes assumed;              ///< values that the file does not state, or that were repaired
    /// Gravity given by the file or its format (m/s^2, world axes). Empty if the file does not state it (URDF,
    /// SDFormat models).
    std::optional<Vector3<double>> gravity_W;
    std::string gravity_source;  ///< "MuJoCo's default", "<option gravity>", ..
    /// Linear drag of free links: c of the torque -c w (N m s) and of the force -c v at the link's origin (N s/m).
    struct FreeDamping {
        std::size_t link = 0;
        double rotational = 0, translational = 0;
    };
    std::vector<FreeDamping> free_damping;
    /// Gears and mimic joints: coordinate of `second` = ratio * coordinate of `first` + offset.
    struct Coupling {
        std::string first, second;
        double ratio = 1, offset = 0;
    };
    std::vector<Coupling> couplings;
    /// A drive of a revolute or prismatic joint with the coordinate x, by a control c within `control`. With
    /// l = gear (x + reference) it exerts gear f, f = (gain . (1, l, l')) c + bias . (1, l, l') within `force`.
    struct Actuator {
        std::string name, joint;
        double gear = 1, reference = 0;
        std::array<double, 3> gain{1, 0, 0}, bias{};
        JointLimits control, force;
    };
    std::vector<Actuator> actuators;
    /// A spherical loop: a point of each of two links, in their frames; `second` may be the world.
    struct Loop {
        std::string name;
        std::size_t first = 0, second = 0;
        Vector3<Wide> first_point, second_point;
    };
    std::vector<Loop> loops;
};

/// Removes names from the notes under one heading of `omitted`, and the heading if none is left.
void remove_notes(Robot& robot, const std::string& heading, const std::vector<std::string>& names);

/// Which robot to read from a file, and how.
struct RobotOptions {
    std::string model;  ///< SDFormat: the model to read, "outer::inner" if nested; empty: all models
    RobotBase base = RobotBase::format_default;
    bool balance_inertia = false;                 ///< accept tensors that break the triangle inequality by any amount
    bool limits_and_friction = true;              ///< model limits and friction of joints; otherwise they are omitted
    bool scene_has_gravity = false;               ///< the scene has its own gravity load, which takes precedence
    std::map<std::string, double> controls = {};  ///< of actuators, by name; others have the control 0
};

/// Reads the robot from the text of a file. The root element selects the format; errors name `path`. Throws
/// InputError.
Robot parse_robot(std::string_view text, const std::string& path, const RobotOptions& options = {},
                  const RobotFiles& files = {});

/// Adds the robot's bodies, joints and loads to the scene, with notes on what was omitted or assumed. A massless link
/// is merged with a link that a fixed joint connects to it, or dropped at the end of the tree. A massless link
/// between two hinges whose axes intersect turns them into a universal joint. Throws InputError if a scene cannot
/// represent the tree.
void add_robot(const Robot& robot, const RobotOptions& options, const std::string& path, Scene& scene);

}  // namespace polhode
