// How much a scene may hold, so that memory and time are bounded before any work begins. What a scene file's text may
// hold stands in text/json_document.h.
#pragma once

#include <cstddef>

namespace polhode {

inline constexpr std::size_t most_triangles = 1'000'000;     ///< of a mesh
inline constexpr std::size_t most_vertices = 3'000'000;      ///< of a mesh
inline constexpr std::size_t most_corners = 1000;            ///< of a face of a mesh, and words of a line
inline constexpr std::size_t largest_mesh_file = 256 << 20;  ///< bytes
inline constexpr std::size_t largest_robot_file = 16 << 20;  ///< bytes, of URDF, MJCF, SDFormat
inline constexpr std::size_t most_bodies = 10'000;           ///< of a scene or a robot; as many joints, as many loops
inline constexpr std::size_t most_loads = 10'000;            ///< of a scene
inline constexpr std::size_t most_planes = 1000;             ///< of a scene
inline constexpr std::size_t longest_scene_name = 200;       ///< bytes, of a scene, a body, a joint or a loop
inline constexpr std::size_t longest_about = 10'000;         ///< bytes, of a scene's about and source
/// Samples times bodies of a solution or a truth that is held in memory.
inline constexpr long most_states = 10'000'000;

}  // namespace polhode
