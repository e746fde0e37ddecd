// Writers for trajectory files and ensemble tables, used to test that readers and writers are inverse to each other.
#pragma once

#include <initializer_list>
#include <string>

#include "motion/ensemble_table.h"
#include "motion/trajectory_csv.h"
#include "text/decimal.h"

namespace polhode {

inline void put_cells(std::string& text, std::initializer_list<double> values) {
    for (const double value : values)
        text += (text.empty() || text.back() == '\n' ? "" : ",") + shortest_decimal(value);
}
inline void put_cells(std::string& text, const Vector3<double>& v) { put_cells(text, {v[0], v[1], v[2]}); }
inline void put_cells(std::string& text, const Quaternion<double>& q) { put_cells(text, {q.w, q.x, q.y, q.z}); }

/// The file as CSV with its columns in the usual order; parse_trajectory() reads back the same rows.
inline std::string write_trajectory(const TrajectoryFile& file) {
    std::string text = file.bodies.empty() ? "t,qw,qx,qy,qz" : "t,body,qw,qx,qy,qz";
    if (file.has_angular_velocity) text += ",wx,wy,wz";
    if (file.has_position) text += ",px,py,pz";
    if (file.has_origin) text += ",ox,oy,oz";
    if (file.has_velocity) text += ",vx,vy,vz";
    text += '\n';
    std::size_t k = 0;
    for (const TrajectoryRow& row : file.rows) {
        put_cells(text, {row.t});
        if (!file.bodies.empty()) text += "," + file.bodies[k++ % file.bodies.size()];
        put_cells(text, row.q);
        if (file.has_angular_velocity) put_cells(text, row.angular_velocity_W);
        if (file.has_position || file.has_origin) put_cells(text, row.position_W);
        if (file.has_velocity) put_cells(text, row.velocity_W);
        text += '\n';
    }
    return text;
}

/// The table as CSV with all columns; parse_ensemble() reads back the same bodies. `pivoted` omits p and v.
inline std::string write_ensemble(const EnsembleTable& table, bool pivoted) {
    std::string text = "qw,qx,qy,qz,wx,wy,wz,";
    text += pivoted ? "" : "px,py,pz,vx,vy,vz,";
    text += table.ids.empty() ? "ixx,iyy,izz,ixy,ixz,iyz,mass\n" : "ixx,iyy,izz,ixy,ixz,iyz,mass,id\n";
    for (std::size_t i = 0; i < table.bodies.size(); ++i) {
        const EnsembleBody& b = table.bodies[i];
        const Matrix3<double>& J = b.inertia_B;
        put_cells(text, b.orientation), put_cells(text, b.angular_velocity);
        if (!pivoted) put_cells(text, b.position_W), put_cells(text, b.velocity_W);
        put_cells(text, {J[0][0], J[1][1], J[2][2], J[0][1], J[0][2], J[1][2], b.mass});
        text += (table.ids.empty() ? "" : "," + table.ids[i]) + "\n";
    }
    return text;
}

}  // namespace polhode
