// The kind `gimbal_lock`: effect of gimbal lock on Euler angles as integrated state, compared with quaternions.
//
// The nose (x axis) of a free body, I = (1, 2, 3), comes within d of the vertical at t = 2 s of 4 s. There roll, pitch
// and yaw are atan2(w_y, w_z), 90 deg - d and 0, so that dpitch/dt = w_y cos(roll) - w_z sin(roll) = 0, and
// w = (0.4, 1, 1.5) rad/s. The initial state is computed by running this motion backwards in closed form.
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "body/orientation.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "figure/curve_style.h"
#include "integrators/game/euler_angles.h"

namespace polhode {
namespace {

constexpr double gimbal_duration = 4;
constexpr long sample_count = 200;

Trajectory solve_exactly(const Scene& scene) {
    Settings settings;
    settings.samples = sample_count;
    return solve(scene, *find_method("exact"), settings);
}

Scene make_passage(double distance) {
    const Vector3<double> w(0.4, 1, 1.5);
    Scene scene;
    scene.name = "passing gimbal lock", scene.duration = gimbal_duration / 2;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.orientation =
        quaternion_from_euler(EulerSequence::zyx, {0, std::numbers::pi / 2 - distance, std::atan2(w[1], w[2])});
    // the reverse of a free motion is the free motion with -w
    scene.initial.angular_velocity = -w;
    const Trajectory back = solve_exactly(scene);
    if (back.status != Status::ok) throw std::runtime_error("the closed form of a free body failed: " + back.message);
    scene.duration = gimbal_duration;
    scene.initial.orientation = back.samples.back().q;
    scene.initial.angular_velocity = -back.samples.back().angular_velocity_B;
    return scene;
}

struct Entry {
    const char* method;
    Trajectory (*solve)(const Problem&, const Settings&, LockPassage*);
    bool by_step;
    double setting;
    int place;
};

Trajectory solve_fleck_quaternion(const Problem& problem, const Settings& settings, LockPassage* passage) {
    Trajectory trajectory = solve(problem, *find_method("fleck_quaternion"), settings);
    passage->smallest_step = trajectory.step;
    return trajectory;
}

// the largest and the last attitude error, relative to the closed form
std::pair<double, double> attitude_errors(const Trajectory& trajectory, const Trajectory& truth) {
    double most = 0, last = 0;
    for (std::size_t k = 0; k < trajectory.samples.size(); ++k) {
        last = rotation_angle_between(trajectory.samples[k].q, truth.samples[k].q);
        most = std::max(most, last);
    }
    return {most, last};
}

const Entry lock_entries[] = {{"euler_angles", solve_euler_angles, true, 1e-3, 0},
                              {"euler_angles", solve_euler_angles, true, 1e-5, 1},
                              {"fleck_quaternion", solve_fleck_quaternion, true, 1e-3, 2},
                              {"fleck_quaternion", solve_fleck_quaternion, true, 1e-5, 3},
                              {"euler_angles_cvode", solve_euler_angles_cvode, false, 1e-6, 4},
                              {"euler_angles_cvode", solve_euler_angles_cvode, false, 1e-10, 5},
                              {"cvode_adams", solve_quaternion_cvode, false, 1e-6, 6},
                              {"cvode_adams", solve_quaternion_cvode, false, 1e-10, 7}};

// Runs one entry at all distances. Appends a row for each, and the points of successful runs to the curves.
void run_entry(const Entry& entry, bool quick, Table& table, Curve& error_curve, Curve& cost_curve) {
    error_curve.label = std::string(entry.method) + (entry.by_step ? ", h = " : ", R = ") + text_of(entry.setting);
    cost_curve.label = error_curve.label;
    for (Curve* curve : {&error_curve, &cost_curve}) set_style(*curve, plain_style(entry.place));
    for (int decade = 0; decade <= 8; decade += quick ? 2 : 1) {
        const double distance = std::pow(10.0, -decade);
        const Scene scene = make_passage(distance);
        const Trajectory truth = solve_exactly(scene);
        Settings settings;
        settings.samples = sample_count;
        (entry.by_step ? settings.step : settings.tolerance) = entry.setting;
        LockPassage passage;
        const Trajectory run = entry.solve(pose(scene, Formulation::full), settings, &passage);
        const bool ok = run.status == Status::ok, angles = passage.largest_angle_rate > 0;
        const auto [most, last] = attitude_errors(run, truth);
        std::vector<Cell> row{
            distance,      std::string(entry.method),        std::string(entry.by_step ? "step" : "tolerance"),
            entry.setting, std::string(name_of(run.status)), run.steps};
        const auto add = [&](bool exists, double value) {
            row.push_back(cell_of(exists ? std::optional<double>(value) : std::nullopt));
        };
        add(std::isfinite(passage.smallest_step), passage.smallest_step);
        add(angles, passage.largest_angle_rate);
        add(angles, passage.nearest);
        add(ok, last);
        add(ok, most);
        row.emplace_back(run.message);
        table.rows.push_back(std::move(row));
        if (!ok) continue;
        error_curve.x.push_back(distance), error_curve.y.push_back(most);
        cost_curve.x.push_back(distance), cost_curve.y.push_back(static_cast<double>(run.steps));
    }
}

}  // namespace

Findings run_gimbal_lock(const Plan&, const RunOptions& options) {
    NamedTable table = make_named_table("", "",
                                        {{"distance", "distance (rad)"},
                                         {"method", "method"},
                                         {"setting_kind", "setting kind"},
                                         {"setting", "setting"},
                                         {"status", "status"},
                                         {"steps", "steps"},
                                         {"smallest_step", "smallest step (s)"},
                                         {"largest_angle_rate", "largest angle rate (rad/s)"},
                                         {"nearest", ""},
                                         {"attitude_error_final", ""},
                                         {"attitude_error_max", "largest attitude error (rad)"},
                                         {"message", "message"}});
    NamedFigure figure{"gimbal_lock", {"Motion past gimbal lock at a distance", 2, {}, ""}};
    Panel error{"largest attitude error", "distance (rad)", "attitude error (rad)", true, true, {}};
    Panel cost{"steps", "distance (rad)", "steps", true, true, {}};
    for (const Entry& entry : lock_entries) {
        Curve error_curve, cost_curve;
        run_entry(entry, options.quick, table.table, error_curve, cost_curve);
        if (error_curve.x.empty()) continue;
        error.curves.push_back(std::move(error_curve));
        if (!entry.by_step) cost.curves.push_back(std::move(cost_curve));
    }
    figure.figure.panels = {std::move(error), std::move(cost)};
    figure.figure.note = "Failed runs are omitted.";
    return {{std::move(table)}, {std::move(figure)}};
}

}  // namespace polhode
