// JSON helpers shared by both kinds of request and answer.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "body/algebra.h"
#include "body/rigid_body.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// True if all off-diagonal entries are zero.
bool is_diagonal(const Matrix3<double>& A);
/// The principal frame of a tensor in its body axes; a tensor that is already diagonal keeps its axes.
PrincipalFrame engine_frame(const Matrix3<double>& inertia);

namespace engine_json {

using nlohmann::json;

inline json array(const Vector3<double>& v) { return json::array({v[0], v[1], v[2]}); }
inline json array(const Quaternion<double>& q) { return json::array({q.w, q.x, q.y, q.z}); }

/// The planes of a request.
json write_planes(const std::vector<Plane>& planes);

/// Reads a number; null stands for a value that is not finite and becomes NaN.
double number(const json& value);
Vector3<double> vector_at(const json& row, std::size_t first);
Quaternion<double> quaternion_at(const json& row, std::size_t first);

/// Reads status, message, steps and seconds of an answer. Returns whether samples follow. Throws if values are invalid.
bool read_outcome(const json& answer, Trajectory& trajectory);
/// The failed trajectory for an answer that cannot be read.
Trajectory make_failed_trajectory(const std::exception& error);

}  // namespace engine_json
}  // namespace polhode
