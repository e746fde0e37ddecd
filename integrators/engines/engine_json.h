// What both kinds of request and answer are written and read with.
#pragma once

#include <nlohmann/json.hpp>

#include "body/algebra.h"
#include "body/rigid_body.h"
#include "motion/trajectory.h"

namespace polhode {

/// Whether nothing but the diagonal is there.
bool is_diagonal(const Matrix3<double>& A);
/// The principal frame of a tensor in its body's axes; one that is diagonal as it is written keeps its axes.
PrincipalFrame engine_frame(const Matrix3<double>& inertia);

namespace engine_json {

using nlohmann::json;

inline json array(const Vector3<double>& v) { return json::array({v[0], v[1], v[2]}); }
inline json array(const Quaternion<double>& q) { return json::array({q.w, q.x, q.y, q.z}); }

/// Null is how JSON writes what is not finite.
double number(const json& value);
Vector3<double> vector_at(const json& row, std::size_t first);
Quaternion<double> quaternion_at(const json& row, std::size_t first);

/// Status, message, steps and seconds of an answer; whether samples follow. Throws where they make no sense.
bool read_outcome(const json& answer, Trajectory& trajectory);
/// What an answer that cannot be read makes of a trajectory.
Trajectory unreadable(const std::exception& error);

}  // namespace engine_json
}  // namespace polhode
