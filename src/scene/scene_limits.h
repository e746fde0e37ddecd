// Limits on the size of a scene, so that memory and time are bounded before any work begins. Limits on a scene file's
// JSON text are in text/json_limits.h.
#pragma once

#include <cstddef>

namespace polhode {

inline constexpr std::size_t most_triangles = 1'000'000;     ///< per mesh
inline constexpr std::size_t most_vertices = 3'000'000;      ///< per mesh
inline constexpr std::size_t most_corners = 1000;            ///< per face of a mesh, and words per line
inline constexpr std::size_t largest_mesh_file = 256 << 20;  ///< bytes
inline constexpr std::size_t largest_robot_file = 16 << 20;  ///< bytes; URDF, MJCF, SDFormat
inline constexpr std::size_t most_bodies = 10'000;           ///< bodies, joints or loops of a scene or robot
inline constexpr std::size_t most_loads = 10'000;            ///< per scene
inline constexpr std::size_t most_planes = 1000;             ///< per scene
inline constexpr std::size_t most_contacts = 1000;           ///< per scene
inline constexpr std::size_t longest_scene_name = 200;       ///< bytes; name of a scene, body, joint or loop
inline constexpr std::size_t longest_about = 10'000;         ///< bytes; "about" and "source" of a scene
/// Samples times bodies of a solution or reference held in memory.
inline constexpr long most_states = 10'000'000;

}  // namespace polhode
