#include "experiment/kinds/kinds.h"

#include <algorithm>

#include "experiment/kinds/engine_joints.h"
#include "experiment/plan/kind.h"

namespace polhode {

std::span<const ExperimentKind> kinds() {
    static const std::vector<std::string_view> all_keys = {"scenes",         "methods", "settings",        "vary",
                                                           "samples",        "repeats", "seconds_per_run", "max_steps",
                                                           "max_evaluations"};
    // the list of all kinds; a new kind is one entry and its function
    static const ExperimentKind list[] = {
        // error against run time, and the fastest at each accuracy
        {.name = "sweep", .reads = all_keys, .conclude = conclude_sweep},
        // observed orders; error against step and against tolerance
        {.name = "convergence", .reads = all_keys, .conclude = conclude_convergence},
        // errors over time
        {.name = "drift", .reads = all_keys, .conclude = conclude_drift, .keeps_series = true},
        // error against the requested tolerance
        {.name = "tolerance", .reads = all_keys, .conclude = conclude_tolerance},
        // each curve with all formulations: gain of the reduced formulation
        {.name = "leave_out",
         .reads = all_keys,
         .conclude = conclude_leave_out,
         .all_formulations = true,
         .one_body = true},
        // growth of errors over a long run, at equal evaluations per revolution
        {.name = "conservation",
         .reads = all_keys,
         .conclude = conclude_conservation,
         .keeps_series = true,
         .calibrated = true,
         .one_body = true},
        // run time of polhode's methods against the libraries at equal error, and long runs
        {.name = "speed",
         .reads = {"scenes", "methods", "settings", "samples", "repeats", "seconds_per_run", "max_evaluations"},
         .conclude = conclude_speed,
         .follow_up = long_runs},
        // physics engines, compared with textbook updates and accurate methods
        {.name = "engines", .reads = all_keys, .conclude = conclude_engines},
        // joints of physics engines, on mechanisms
        {.name = "engine_joints",
         .reads = all_keys,
         .conclude = conclude_engine_joints,
         .follow_up = joint_sweeps,
         .keeps_series = true},
        // limits, friction and gears of joints of physics engines
        {.name = "engine_joint_laws", .reads = all_keys, .conclude = conclude_engine_joint_laws},
        // contact of physics engines, on planes with friction
        {.name = "engine_contact", .reads = all_keys, .conclude = conclude_engine_contact},
        // joint solvers of games and robotics: attitude, gaps and energy at each step
        {.name = "joints", .reads = all_keys, .conclude = conclude_joints},
        // one body on planes with friction, by time stepping: position, order, penetration, slip and energy gain
        {.name = "contact", .reads = all_keys, .conclude = conclude_contact, .one_body = true},
        // penalty methods against the rigid reference as their stiffness grows
        {.name = "contact_stiffness", .reads = all_keys, .conclude = conclude_contact_stiffness, .one_body = true},
        // friction of a block by direction: pyramids against cones
        {.name = "contact_anisotropy", .reads = {"methods", "settings"}, .make = run_contact_anisotropy},
        {.name = "mechanism_truth", .reads = {"scenes", "samples", "seconds_per_run"}, .make = run_mechanism_truth},
        {.name = "event_truth", .reads = {"scenes", "samples", "seconds_per_run"}, .make = run_event_truth},
        {.name = "mechanism_cost", .reads = {"repeats"}, .make = run_mechanism_cost},
        {.name = "ensembles", .reads = {"repeats"}, .make = run_ensembles},
        {.name = "gimbal_lock", .reads = {}, .make = run_gimbal_lock},
        {.name = "collisions",
         .reads = {"scenes", "vary", "methods", "settings", "seconds_per_run"},
         .make = run_collisions,
         .one_body = true},
        {.name = "inertia", .reads = {"repeats"}, .make = run_inertia},
        {.name = "inertia_shortcuts", .reads = {"scenes"}, .make = run_inertia_shortcuts, .one_body = true},
        {.name = "orientation", .reads = {"repeats"}, .make = run_orientation},
        {.name = "point_bodies", .reads = {"scenes"}, .make = run_point_bodies, .one_body = true},
        {.name = "stability",
         .reads = {"scenes", "vary", "methods", "settings", "samples", "seconds_per_run", "max_steps",
                   "max_evaluations"},
         .make = run_stability,
         .chooses_steps = true,
         .resumable = true,
         .one_body = true},
    };
    return list;
}

const ExperimentKind* find_kind(std::string_view name) {
    const std::span<const ExperimentKind> all = kinds();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const ExperimentKind& kind) { return kind.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace polhode
