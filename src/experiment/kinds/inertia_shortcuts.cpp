// The kind `inertia_shortcuts`: effect of simplified inertia tensors of game engines on a free body's motion. Three
// floats: the products of inertia are dropped. One float: a third of the trace.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "body/elementary.h"
#include "body/orientation.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "figure/curve_style.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "motion/problem.h"

namespace polhode {
namespace {

struct Shortcut {
    const char* name;
    Matrix3<double> (*inertia)(const Matrix3<double>&);
};
const Shortcut shortcuts[] = {
    {"three_floats", [](const Matrix3<double>& I) { return diagonal(Vector3<double>(I[0][0], I[1][1], I[2][2])); }},
    {"one_float",
     [](const Matrix3<double>& I) {
         const double mean = (I[0][0] + I[1][1] + I[2][2]) / 3;
         return diagonal(Vector3<double>(mean, mean, mean));
     }},
};

// errors are evaluated over the first 0.1, 1, 10 and 100 rad of rotation
constexpr std::array<double, 4> evaluated_angles = {0.1, 1, 10, 100};

Vector3<double> high(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }
Quaternion<double> high(const Quaternion<Pair>& q) { return {q.w.high, q.x.high, q.y.high, q.z.high}; }

// Errors of the motion with a simplified tensor, by rotation angle.
struct ShortcutErrors {
    std::vector<double> angle;  // rad
    std::vector<double> attitude, momentum, energy;

    // the largest error up to a rotation angle
    double largest(const std::vector<double>& errors, double until) const {
        double most = 0;
        for (std::size_t k = 0; k < errors.size() && angle[k] <= until * (1 + 1e-12); ++k)
            most = std::max(most, errors[k]);
        return most;
    }
    // the rotation angle at which the attitude error first exceeds a bound
    Cell first_beyond(double bound) const {
        for (std::size_t k = 0; k < attitude.size(); ++k)
            if (attitude[k] > bound) return angle[k];
        return {};
    }
};

ShortcutErrors measure_shortcut(const Problem& problem, double rate, const Reference& truth, const Reference& other) {
    ShortcutErrors errors;
    const double L = length(high(truth.samples[0].angular_momentum_W)), E = truth.samples[0].energy.high;
    for (std::size_t k = 0; k < truth.samples.size(); ++k) {
        const ReferenceSample &right = truth.samples[k], &wrong = other.samples[k];
        // momentum and energy use the true tensor; with the simplified one an engine would report other values
        const Vector3<double> w = high(wrong.angular_velocity_B);
        const Vector3<double> L_B = problem.body.inertia_B * w;
        errors.attitude.push_back(rotation_angle_between(high(right.q), high(wrong.q)));
        errors.momentum.push_back(length(rotate(high(wrong.q), L_B) - high(right.angular_momentum_W)) / L);
        errors.energy.push_back(
            std::abs(dot(w, L_B) / 2 -
                     dot(high(right.angular_velocity_B), problem.body.inertia_B * high(right.angular_velocity_B)) / 2) /
            std::abs(E));
        errors.angle.push_back(right.t * rate);
    }
    return errors;
}

// Computes the motion with the simplified tensor. Returns why the errors cannot be measured, or an empty string.
std::string solve_shortcut(const Scene& scene, const std::string& label, const Shortcut& shortcut, long samples,
                           const Reference& truth, Reference& other) {
    Scene simplified = scene;
    simplified.body.source = nullptr;
    simplified.body.inertia_B = shortcut.inertia(scene.body.inertia_B);
    try {
        validate(simplified, label);
        other = reference(simplified, samples);
        if (!truth.available || !other.available) return truth.available ? other.message : truth.message;
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

void add_shortcut_rows(Table& table, const std::vector<Cell>& row, const ShortcutErrors& errors) {
    for (const double until : evaluated_angles) {
        std::vector<Cell> one = row;
        one.insert(one.end(), {until, errors.largest(errors.attitude, until), errors.largest(errors.momentum, until),
                               errors.largest(errors.energy, until), errors.first_beyond(0.01),
                               errors.first_beyond(0.1), errors.first_beyond(1), std::string("ok"), std::string()});
        table.rows.push_back(std::move(one));
    }
}

Curve make_shortcut_curve(const char* name, int place, const ShortcutErrors& errors) {
    Curve curve;
    curve.label = name, curve.points = false;
    set_style(curve, plain_style(place));
    // the largest error so far, at logarithmically spaced points
    double most = 0, next = 0;
    for (std::size_t k = 1; k < errors.angle.size(); ++k) {
        most = std::max(most, errors.attitude[k]);
        if (errors.angle[k] < next) continue;
        next = errors.angle[k] * 1.02;
        curve.x.push_back(errors.angle[k]), curve.y.push_back(most);
    }
    return curve;
}

// Adds the rows of all shortcuts on a scene. Returns their curves.
std::vector<Curve> compare_shortcuts(const PlannedScene& planned, long samples, Table& table) {
    Scene scene = planned.scene;
    const Problem problem = pose(scene);
    const double rate = length(problem.body.angular_velocity_B);
    if (rate == 0 || !scene.loads.empty() || scene.pivot) {
        std::vector<Cell> row{planned.label, std::string("all")};
        row.resize(10),
            row.insert(row.end(), {std::string("unsupported"), std::string("only free, rotating bodies are compared")});
        table.rows.push_back(std::move(row));
        return {};
    }
    scene.duration = evaluated_angles.back() / rate;
    const Reference truth = reference(scene, samples);
    std::vector<Curve> curves;
    for (const Shortcut& shortcut : shortcuts) {
        std::vector<Cell> row{
            planned.label, std::string(shortcut.name),
            angle_between(problem.body.inertia_B * problem.body.angular_velocity_B, problem.body.angular_velocity_B)};
        Reference other;
        const std::string fault = solve_shortcut(scene, planned.label, shortcut, samples, truth, other);
        if (!fault.empty()) {
            row.resize(10), row.insert(row.end(), {std::string("failed"), fault});
            table.rows.push_back(std::move(row));
            continue;
        }
        const ShortcutErrors errors = measure_shortcut(problem, rate, truth, other);
        add_shortcut_rows(table, row, errors);
        curves.push_back(make_shortcut_curve(shortcut.name, static_cast<int>(curves.size()), errors));
    }
    return curves;
}

}  // namespace

Findings run_inertia_shortcuts(const Plan& plan, const RunOptions& options) {
    const long samples = options.quick ? 500 : 4000;
    Findings result;
    NamedTable table{
        "",
        "",
        {{"scene", "shortcut", "angle_of_momentum_to_rate", "turned", "attitude_error_max", "momentum_error_max",
          "energy_error_max", "turned_at_0.01", "turned_at_0.1", "turned_at_1", "status", "message"},
         {}}};
    NamedFigure figure{"inertia_shortcuts", {"Attitude error of simplified inertia tensors", 2, {}, ""}};
    for (const PlannedScene& planned : plan.scenes) {
        Panel panel{planned.label, "rotation (rad)", "attitude error (rad)", true, true, {}};
        panel.curves = compare_shortcuts(planned, samples, table.table);
        if (!panel.curves.empty()) figure.figure.panels.push_back(std::move(panel));
    }
    result.tables.push_back(std::move(table));
    if (!figure.figure.panels.empty()) result.figures.push_back(std::move(figure));
    return result;
}

}  // namespace polhode
