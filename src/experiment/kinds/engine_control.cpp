// Control in physics engines: loads given by formulas, evaluated by the drivers at each step.
//
// probe_control() runs a method on a spacecraft that is rotated to its target attitude and on a flywheel that is
// rotated by a motor, both with proportional and derivative control, evaluated at each step and sampled. The reference
// is the method taylor with the same controller.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "body/orientation.h"
#include "experiment/kinds/engine_joints.h"
#include "experiment/kinds/engines.h"
#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr double sampling_period = 0.1;                         // s, whole steps at 1/60 s and 1/1000 s
constexpr double spacecraft_duration = 60, wheel_duration = 5;  // s

/// A controlled motion and its reference.
struct ControlledMotion {
    Scene scene;
    Trajectory reference;
};

Trajectory run_controlled(const Method& method, const Scene& scene, std::optional<double> step) {
    Settings settings;
    settings.samples = std::lround(scene.duration / (scene.bodies.empty() ? 1 : sampling_period));
    settings.seconds_limit = 20, settings.step = step;
    return solve(scene, method, settings);
}

ControlledMotion make_controlled(const char* name, double duration, bool is_sampled) {
    ControlledMotion motion{find_scene(name), {}};
    motion.scene.duration = duration;
    if (is_sampled)
        for (Load& load : motion.scene.loads)
            if (FormulaLoad* formula = std::get_if<FormulaLoad>(&load))
                formula->formula = fmt::format("hold({}, {})", formula->formula, sampling_period);
    motion.reference = run_controlled(*find_method("taylor"), motion.scene, {});
    return motion;
}

// The largest attitude error, rad. Empty, with the reason in `fault`, if the run was not completed.
std::optional<double> measure_error(const Method& method, const ControlledMotion& motion, double step,
                                    std::string& fault) {
    const Trajectory run = run_controlled(method, motion.scene, step);
    if (run.status != Status::ok) {
        fault = one_line(run.message, 120);
        return {};
    }
    double error = 0;
    for (std::size_t k = 0; k < std::min(run.samples.size(), motion.reference.samples.size()); ++k)
        error = std::max(error, rotation_angle_between(run.samples[k].q, motion.reference.samples[k].q));
    return error;
}

// The observed order between the usual and the fine step.
std::optional<double> find_order(const std::optional<double>& usual, const std::optional<double>& fine) {
    if (!usual || !fine || !(*fine > 0)) return {};
    return std::log(*usual / *fine) / std::log(default_engine_step / fine_step);
}

}  // namespace

std::vector<ControlErrors> measure_control(const std::vector<const Method*>& methods) {
    const ControlledMotion motions[] = {make_controlled("formulas/saturated_regulator", spacecraft_duration, false),
                                        make_controlled("formulas/saturated_regulator", spacecraft_duration, true),
                                        make_controlled("formulas/flywheel_servo", wheel_duration, false),
                                        make_controlled("formulas/flywheel_servo", wheel_duration, true)};
    std::vector<ControlErrors> all;
    for (const Method* method : methods) {
        ControlErrors errors{method, {}, {}, {}};
        for (std::size_t i = 0; i < errors.usual.size(); ++i) {
            std::string fault;
            errors.usual[i] = measure_error(*method, motions[i], default_engine_step, fault);
            if (errors.usual[i]) errors.fine[i] = measure_error(*method, motions[i], fine_step, fault);
            if (!fault.empty() && errors.fault.find(fault) == std::string::npos)
                errors.fault += (errors.fault.empty() ? "" : "; ") + fault;
        }
        all.push_back(std::move(errors));
    }
    return all;
}

NamedTable control_table(const std::vector<ControlErrors>& errors) {
    std::vector<ColumnChoice> columns{{"method", "method"}};
    for (const auto& [name, heading] : {std::pair{"spacecraft", "spacecraft (rad)"},
                                        {"sampled spacecraft", "spacecraft, sampled (rad)"},
                                        {"wheel", "wheel (rad)"},
                                        {"sampled wheel", "wheel, sampled (rad)"}})
        for (const double step : {default_engine_step, fine_step})
            columns.push_back(
                {fmt::format("{} at {}", name, step_name(step)), fmt::format("{}, {}", heading, step_name(step))});
    columns.push_back({"message", "not measured because"});
    NamedTable named = make_named_table("control", "Control", columns);
    for (const ControlErrors& one : errors) {
        std::vector<Cell> row{std::string(one.method->name)};
        for (std::size_t i = 0; i < one.usual.size(); ++i)
            row.insert(row.end(), {cell_of(one.usual[i]), cell_of(one.fine[i])});
        row.emplace_back(one.fault);
        named.table.rows.push_back(std::move(row));
    }
    return named;
}

std::string describe_control(const std::vector<ControlErrors>& errors) {
    std::size_t measured = 0, within = 0, first_order = 0;
    std::vector<std::string> exact;
    for (const ControlErrors& one : errors) {
        if (!one.usual[0]) continue;
        ++measured;
        within += *one.usual[0] < 0.01;
        const std::optional<double> order = find_order(one.usual[2], one.fine[2]);
        first_order += order && *order > 0.8 && *order < 1.2;
        if (one.usual[3] && *one.usual[3] < 1e-9) exact.push_back(fmt::format("`{}`", one.method->name));
    }
    std::string text = fmt::format(
        "At {}, {} of {} methods keep the attitude of the spacecraft within 0.01 rad. The others damp the rotation, "
        "put "
        "the slowly rotating spacecraft to sleep, or lack the gyroscopic term. The error of the wheel decreases with "
        "order "
        "1 in {} methods.",
        step_name(default_engine_step), within, measured, first_order);
    if (!exact.empty())
        text += fmt::format(
            " A torque that is held is constant during each step: the sampled wheel is exact to rounding in {}.",
            listed_words(exact));
    return text;
}

}  // namespace polhode
