#include "integrators/engines/engine_json.h"

#include <cmath>
#include <stdexcept>

#include "text/message.h"

namespace polhode {
namespace {

Status parse_status(const std::string& word) {
    for (const Status status : {Status::ok, Status::unsupported, Status::diverged})
        if (word == name_of(status)) return status;
    return Status::failed;
}

}  // namespace

bool is_diagonal(const Matrix3<double>& A) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (i != j && A[i][j] != 0) return false;
    return true;
}

PrincipalFrame engine_frame(const Matrix3<double>& inertia) {
    if (!is_diagonal(inertia)) return principal_frame(cast<Wide>(inertia));
    PrincipalFrame frame;
    frame.moments = {inertia[0][0], inertia[1][1], inertia[2][2]};
    return frame;
}

namespace engine_json {

double number(const json& value) { return value.is_null() ? std::nan("") : value.get<double>(); }

Vector3<double> vector_at(const json& row, std::size_t first) {
    return {number(row.at(first)), number(row.at(first + 1)), number(row.at(first + 2))};
}

Quaternion<double> quaternion_at(const json& row, std::size_t first) {
    return {number(row.at(first)), number(row.at(first + 1)), number(row.at(first + 2)), number(row.at(first + 3))};
}

json write_planes(const std::vector<Plane>& planes) {
    json all = json::array();
    for (const Plane& plane : planes)
        all.push_back({{"normal", array(plane.normal_W)},
                       {"offset", plane.offset},
                       {"restitution", plane.restitution},
                       {"friction", plane.friction}});
    return all;
}

bool read_outcome(const json& answer, Trajectory& trajectory) {
    trajectory.status = parse_status(answer.at("status"));
    trajectory.message = one_line(answer.value("message", ""), 300);
    if (trajectory.status == Status::failed && trajectory.message.empty())
        trajectory.message = "failed without a message";
    if (trajectory.status != Status::ok) return false;
    const double steps = answer.at("steps");
    trajectory.seconds = answer.at("seconds");
    if (!(steps >= 0 && steps < 1e15 && trajectory.seconds >= 0 && trajectory.seconds < 1e15))
        throw std::invalid_argument("steps and seconds must be >= 0 and < 1e15");
    trajectory.steps = static_cast<long>(steps);
    trajectory.rhs_evaluations = trajectory.steps;
    return true;
}

Trajectory make_failed_trajectory(const std::exception& error) {
    Trajectory trajectory;
    trajectory.status = Status::failed;
    trajectory.message = "the answer cannot be read: " + one_line(error.what(), 200);
    return trajectory;
}

}  // namespace engine_json
}  // namespace polhode
