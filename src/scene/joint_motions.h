// Prescribed motions of joints: coordinates that are given functions of time.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "formula/expression.h"
#include "scene/scene.h"

namespace polhode {

/// The prescribed motions of a scene as nodes of one expression. Input 0 is the time, constant i is parameter i.
struct JointMotions {
    /// The motion of one joint.
    struct Motion {
        std::size_t joint = 0;                ///< index in scene.joints
        int coordinate = formula::no_node;    ///< rad or m
        int rate = formula::no_node;          ///< its first derivative
        int acceleration = formula::no_node;  ///< its second derivative
    };
    formula::Expression expression;
    std::vector<Motion> motions;
};

/// Whether the motion of a joint of the scene is prescribed.
bool has_joint_motions(const Scene& scene);

/// Compiles the prescribed motions. Throws InputError at the place in `file` of the first fault: in a formula, or of a
/// formula that switches between branches.
JointMotions compile_joint_motions(const Scene& scene, const std::string& file);

/// Sets the initial coordinates and rates of joints with prescribed motions, rounded to binary64.
void start_joint_motions(Scene& scene, const std::string& file);

/// Checks the prescribed motions of a valid scene of several bodies.
void check_joint_motions(const Scene& scene, const std::string& file);

}  // namespace polhode
