#include "experiment/run/study.h"

#include <fmt/format.h>

#include "experiment/run/case_store.h"
#include "text/content_hash.h"

namespace polhode {

StudyResult run_gimbal_lock(const Plan& plan, const RunOptions& options);
StudyResult run_collisions(const Plan& plan, const RunOptions& options);
StudyResult run_inertia(const Plan& plan, const RunOptions& options);
StudyResult run_inertia_shortcuts(const Plan& plan, const RunOptions& options);
StudyResult run_orientation(const Plan& plan, const RunOptions& options);
StudyResult run_point_bodies(const Plan& plan, const RunOptions& options);
StudyResult run_speed(const Plan& plan, const RunOptions& options);
StudyResult run_stability(const Plan& plan, const RunOptions& options);

double relative_error(const Matrix3<double>& inertia, const Matrix3<Wide>& truth) {
    Wide difference = 0, size = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Wide d = Wide(inertia[i][j]) - truth[i][j];
            difference += d * d, size += truth[i][j] * truth[i][j];
        }
    return double(square_root(difference / size));
}

std::span<const Study> studies() {
    // the only list
    static const Study list[] = {
        {"gimbal_lock", {}, run_gimbal_lock},
        {"collisions", {"scenes", "vary", "methods", "settings", "seconds_per_run"}, run_collisions},
        {"inertia", {"repeats"}, run_inertia},
        {"inertia_shortcuts", {"scenes"}, run_inertia_shortcuts},
        {"orientation", {"repeats"}, run_orientation},
        {"point_bodies", {"scenes"}, run_point_bodies},
        {"speed",
         {"scenes", "methods", "settings", "samples", "repeats", "seconds_per_run", "max_evaluations"},
         run_speed},
        {"stability",
         {"scenes", "vary", "methods", "settings", "samples", "seconds_per_run", "max_steps", "max_evaluations"},
         run_stability,
         true,
         true},
    };
    return list;
}

const Study* find_study(std::string_view name) {
    for (const Study& study : studies())
        if (study.name == name) return &study;
    return nullptr;
}

std::string study_key(const Plan& plan, bool quick) {
    const Experiment& e = plan.experiment;
    std::string text = fmt::format("{}\n{}\n{}\n{}\n{} {} {} {} {}\n", program_key(), e.name, e.about, e.study, quick,
                                   e.repeats, e.samples, e.seconds_per_run, e.max_evaluations);
    for (const PlannedScene& scene : plan.scenes) text += scene.label + "\n" + scene.canonical + "\n";
    for (const PlannedCurve& curve : plan.curves) {
        text += fmt::format("{} {}", curve.method->name, name_of(curve.kind));
        for (const double setting : curve.settings) text += fmt::format(" {}", setting);
        text += "\n";
    }
    return content_hash(text);
}

}  // namespace polhode
