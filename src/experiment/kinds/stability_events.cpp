// Cost of stepping over a discontinuity, for the kind `stability`.
//
// A body with I = (1, 2, 3) rotates freely. At T/3 a torque about its second axis starts: as a jump, as a ramp, or as a
// pulse shorter than any step. Steps are T/n with n = 10 4^k, so that T/3 is at a third of a step in every run, and
// errors decrease by 4^p for the remaining order p.
#include <cmath>
#include <optional>
#include <stdexcept>

#include "body/orientation.h"
#include "experiment/kinds/stability.h"
#include "integrators/method.h"
#include "integrators/truth/reference.h"
#include "measure/observed_order.h"

namespace polhode {
namespace {

constexpr double discontinuity_duration = 6, event_start = discontinuity_duration / 3;

Scene free_body() {
    Scene scene;
    scene.name = "discontinuity", scene.duration = discontinuity_duration;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 3));
    scene.initial.angular_velocity = {0.3, 0.8, 0.5};
    return scene;
}

/// The torque about the second axis, N m, from `event_start` until `event_end`.
struct Discontinuity {
    const char* name;
    double event_end;
    double (*torque)(double after);  ///< function of the time after `event_start`
    bool constant;                   ///< a scene file can represent the torque, so a truth exists
};

Scene make_torque_scene(const Discontinuity& d, bool onto) {
    Scene scene = free_body();
    const Window window{event_start, d.event_end};
    if (onto && d.constant) {
        scene.loads = {Torque{{0, d.torque(0), 0}, Frame::body, window}};
        return scene;
    }
    const auto torque = [d](const LoadState& s) {
        return Vector3<double>(0, s.t >= event_start && s.t < d.event_end ? d.torque(s.t - event_start) : 0, 0);
    };
    scene.loads = {UserTorque{d.name, torque, onto ? window : Window{}}};
    return scene;
}

Quaternion<double> compute_end(const Discontinuity& d) {
    const Scene scene = make_torque_scene(d, true);
    if (d.constant) {
        const Reference truth = reference(scene, 1);
        if (!truth.available) throw std::runtime_error(truth.message);
        return truth.samples.back().rounded().q;
    }
    // a user-defined torque has no truth: integrate its smooth pieces at the tightest tolerance
    Settings settings;
    settings.samples = 1, settings.tolerance = 1e-15;
    const Trajectory fine = solve(scene, *find_method("extrapolation"), settings);
    if (fine.status != Status::ok) throw std::runtime_error(fine.message);
    return fine.samples.back().q;
}

constexpr const char* fixed_step_methods[] = {"odeint_euler", "odeint_rk4", "munthe_kaas4", "odeint_fehlberg78"};
constexpr const char* step_control_methods[] = {"dop853", "extrapolation", "cvode_adams"};

std::vector<double> make_settings(bool by_step, bool quick) {
    std::vector<double> settings;
    for (int k = 0; k < (quick ? 4 : 5); ++k)
        settings.push_back(by_step ? discontinuity_duration / (10 * std::pow(4.0, k)) : std::pow(10.0, -4 - 2 * k));
    return settings;
}

std::vector<Cell> discontinuity_row(const Discontinuity& d, const char* name, bool by_step, bool onto,
                                    const Quaternion<double>& truth, bool quick) {
    const Problem problem = pose(make_torque_scene(d, onto));
    const Method& method = *find_method(name);
    constexpr double round_off = 1e-12;  // errors near it show no order
    std::vector<double> settings, errors;
    double finest = 0, error = 0;
    bool ok = false;
    std::optional<double> order;
    Trajectory last;
    for (const double setting : make_settings(by_step, quick)) {
        Settings s;
        s.samples = 1;
        (by_step ? s.step : s.tolerance) = setting;
        last = solve(problem, method, s);
        finest = setting, ok = false;
        if (last.status != Status::ok) break;
        ok = true, error = rotation_angle_between(last.samples.back().q, truth);
        if (error > round_off) settings.push_back(setting), errors.push_back(error);
    }
    if (ok && by_step)
        if (const auto found = observed_order(settings, errors, 1)) order = found->order;
    return {std::string(d.name),
            std::string(name),
            std::string(by_step ? "step" : "tolerance"),
            std::string(onto ? "onto" : "over"),
            by_step ? Cell(static_cast<long>(method.order)) : Cell(),
            cell_of(order),
            finest,
            ok ? Cell(error) : Cell(),
            last.steps,
            last.rhs_evaluations,
            cell_of(last.counts.rejected_steps),
            std::string(name_of(last.status)),
            last.message};
}

}  // namespace

NamedTable measure_discontinuities(bool quick) {
    const Discontinuity cases[] = {
        {"torque jumps", 2 * event_start, [](double) { return 0.7; }, true},
        {"torque derivative jumps", discontinuity_duration, [](double after) { return 0.7 * after; }, false},
        {"pulse shorter than a step", event_start + 0x1p-10, [](double) { return 700.0; }, true},
    };
    NamedTable table = make_named_table("discontinuities", "Cost of stepping over a discontinuity",
                                        {{"case", "case"},
                                         {"method", "method"},
                                         {"setting_kind", ""},
                                         {"stepped", "stepped"},
                                         {"claimed_order", "claimed order"},
                                         {"observed_order", "observed order"},
                                         {"finest_setting", "finest step (s) or tolerance"},
                                         {"error_at_finest", "attitude error at the finest (rad)"},
                                         {"steps", "steps"},
                                         {"rhs_evaluations", ""},
                                         {"rejected_steps", "rejected"},
                                         {"status", "status"},
                                         {"message", ""}});
    for (const Discontinuity& d : cases) {
        const Quaternion<double> truth = compute_end(d);
        for (const char* method : fixed_step_methods)
            for (const bool onto : {true, false})
                table.table.rows.push_back(discontinuity_row(d, method, true, onto, truth, quick));
        for (const char* method : step_control_methods)
            for (const bool onto : {true, false})
                table.table.rows.push_back(discontinuity_row(d, method, false, onto, truth, quick));
    }
    return table;
}

}  // namespace polhode
