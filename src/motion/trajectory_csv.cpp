#include "motion/trajectory_csv.h"

#include "table/decimal.h"

namespace polhode {

std::string trajectory_csv(const Trajectory& trajectory) {
    std::string text = "t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz\n";
    for (const Sample& s : trajectory.samples) {
        const Vector3<double> w = angular_velocity_W(s), p = s.position_W, v = s.velocity_W;
        text += shortest_decimal(s.t);
        for (const double value : {s.q.w, s.q.x, s.q.y, s.q.z, w[0], w[1], w[2], p[0], p[1], p[2], v[0], v[1], v[2]}) {
            text += ',';
            text += shortest_decimal(value);
        }
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

}  // namespace polhode
