#include "motion/trajectory_csv.h"

#include <cmath>

#include "body/wide.h"
#include "motion/trajectory_columns.h"
#include "text/decimal.h"

namespace polhode {

std::string trajectory_csv(const Trajectory& trajectory, std::span<const std::string> bodies) {
    std::string text = bodies.empty() ? "t," : "t,body,";
    text += "qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n";
    std::size_t k = 0;
    for (const Sample& s : trajectory.samples) {
        const auto numbers = motion_numbers(s);
        text += shortest_decimal(s.t);
        if (!bodies.empty()) text.append(",").append(bodies[k++ % bodies.size()]);
        for (std::size_t i = 1; i < numbers.size(); ++i) text.append(",").append(shortest_decimal(numbers[i]));
        text += '\n';
    }
    if (trajectory.status != Status::ok) {
        text += std::string("# ") + name_of(trajectory.status);
        // a comment must be one line
        for (const char c : ": " + trajectory.message) text += c == '\n' || c == '\r' ? ' ' : c;
        text += '\n';
    }
    return text;
}

std::string reactions_csv(const Trajectory& trajectory, std::span<const std::string> joints) {
    std::string text = "t,joint,fx,fy,fz,tx,ty,tz\n";
    for (std::size_t k = 0; k < trajectory.reactions.size(); ++k) {
        const std::string time = shortest_decimal(trajectory.at(k / joints.size())[0].t);
        text.append(time).append(",").append(joints[k % joints.size()]);
        for (const Vector3<double>& v : {trajectory.reactions[k].force_W, trajectory.reactions[k].torque_W})
            for (const double value : v.component)
                text.append(",").append(std::isnan(value) ? "" : shortest_decimal(value));
        text += '\n';
    }
    return text;
}

std::vector<Sample> samples_of(const TrajectoryFile& file, const Vector3<double>& center_of_mass) {
    return samples_of(file, std::span(&center_of_mass, 1));
}

std::vector<Sample> samples_of(const TrajectoryFile& file, std::span<const Vector3<double>> centers_of_mass) {
    // (1/|q|^2) times a vector rotated by q
    const auto scaled = [](const Quaternion<Wide>& q, const Vector3<Wide>& turned) {
        return cast<double>((Wide(1) / squared_norm(q)) * turned);
    };
    std::vector<Sample> samples;
    samples.reserve(file.rows.size());
    for (const TrajectoryRow& row : file.rows) {
        const Quaternion<Wide> q = cast<Wide>(row.q);
        Sample s;
        s.t = row.t, s.q = row.q, s.position_W = row.position_W, s.velocity_W = row.velocity_W;
        s.angular_velocity_B = scaled(q, rotate_back(q, cast<Wide>(row.angular_velocity_W)));
        if (file.has_origin) {
            const Wide size = squared_norm(q);
            const Vector3<Wide> origin = size * cast<Wide>(row.position_W);
            const Vector3<double>& center = centers_of_mass[samples.size() % centers_of_mass.size()];
            s.position_W = scaled(q, origin + rotate(q, cast<Wide>(center)));
        }
        samples.push_back(s);
    }
    return samples;
}

}  // namespace polhode
