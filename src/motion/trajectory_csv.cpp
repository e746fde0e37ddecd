#include "motion/trajectory_csv.h"

#include "body/wide.h"
#include "text/decimal.h"

namespace polhode {
namespace {

void put(std::string& text, const Vector3<double>& v) {
    for (int i = 0; i < 3; ++i) text.append(",").append(shortest_decimal(v[i]));
}

void put(std::string& text, double t, const Quaternion<double>& q) {
    text += shortest_decimal(t);
    for (const double value : {q.w, q.x, q.y, q.z}) text.append(",").append(shortest_decimal(value));
}

}  // namespace

std::string trajectory_csv(const Trajectory& trajectory) {
    std::string text = "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n";
    for (const Sample& s : trajectory.samples) {
        put(text, s.t, s.q);
        put(text, angular_velocity_W(s));
        put(text, s.position_W);
        put(text, s.velocity_W);
        text += '\n';
    }
    if (trajectory.status != Status::ok) {
        text += std::string("# ") + name_of(trajectory.status);
        // a message is one line; a comment must be
        for (const char c : ": " + trajectory.message) text += c == '\n' || c == '\r' ? ' ' : c;
        text += '\n';
    }
    return text;
}

std::string write_trajectory(const TrajectoryFile& file) {
    std::string text = "t,qw,qx,qy,qz";
    if (file.has_angular_velocity) text += ",wx,wy,wz";
    if (file.has_position) text += ",px,py,pz";
    if (file.has_origin) text += ",ox,oy,oz";
    if (file.has_velocity) text += ",vx,vy,vz";
    text += '\n';
    for (const TrajectoryRow& row : file.rows) {
        put(text, row.t, row.q);
        if (file.has_angular_velocity) put(text, row.angular_velocity_W);
        if (file.has_position || file.has_origin) put(text, row.position_W);
        if (file.has_velocity) put(text, row.velocity_W);
        text += '\n';
    }
    return text;
}

std::vector<Sample> samples_of(const TrajectoryFile& file, const Vector3<double>& center_of_mass) {
    // (1/|q|^2) times a vector turned by q
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
            s.position_W = scaled(q, origin + rotate(q, cast<Wide>(center_of_mass)));
        }
        samples.push_back(s);
    }
    return samples;
}

}  // namespace polhode
