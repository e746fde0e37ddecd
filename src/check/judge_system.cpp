// Files of several bodies, judged.
#include <algorithm>
#include <stdexcept>

#include "check/judge.h"
#include "measure/errors.h"

namespace polhode {
namespace {

bool is_told(const Measure& measure, const Scene& scene, const TrajectoryFile& file) {
    // what bodies have together needs all of them
    if (measure.system_error && file.bodies_at_once() < scene.bodies.size()) return false;
    const bool position = file.has_position || file.has_origin;
    const unsigned known = known_truth | known_free_system | (file.has_angular_velocity ? known_angular_velocity : 0U) |
                           (position ? known_position : 0U) | (file.has_velocity ? known_velocity : 0U) |
                           (position && file.has_velocity ? known_center : 0U);
    // what all have together hangs on where they are and how they move
    const bool whole = measure.system_error && (measure.needs & known_angular_velocity) != 0;
    return (measure.needs & ~known) == 0 && (!whole || (known & known_center) != 0);
}

// The joints of the largest gap and turn of all bodies at one time.
JointViolations<Wide> violations_at(const MechanismMeasure<Wide>& measure, const Bodies& bodies) {
    std::vector<BodyMotion<Wide>> motions;
    for (const Sample& s : bodies) motions.push_back({normalized(cast<Wide>(s.q)), {}, cast<Wide>(s.position_W), {}});
    return measure.violations(motions);
}

}  // namespace

std::vector<std::size_t> bodies_of_file(const Scene& scene, const TrajectoryFile& file) {
    std::vector<std::size_t> places;
    for (const std::string& name : file.bodies) places.push_back(static_cast<std::size_t>(body_index(scene, name)));
    // a file without a column `body` is of the only one
    if (places.empty()) places.push_back(0);
    return places;
}

std::vector<std::string> missing_bodies(const Scene& scene, const TrajectoryFile& file) {
    std::vector<std::string> missing = body_names(scene);
    for (const std::size_t b : bodies_of_file(scene, file)) missing[b].clear();
    std::erase(missing, std::string());
    return missing;
}

Trajectory completed_by(const Reference& truth, const Scene& scene, const TrajectoryFile& file) {
    const std::vector<std::size_t> places = bodies_of_file(scene, file);
    std::vector<Vector3<double>> centers;
    for (const std::size_t b : places) centers.push_back(scene.bodies[b].body.center_of_mass);
    const std::vector<Sample> told = samples_of(file, centers);
    const std::size_t n = scene.bodies.size();
    Trajectory trajectory;
    trajectory.bodies = static_cast<int>(n);
    for (const ReferenceSample& sample : truth.samples) trajectory.samples.push_back(sample.rounded());
    for (std::size_t i = 0; i < told.size(); ++i) {
        Sample& own = trajectory.samples[i / places.size() * n + places[i % places.size()]];
        const Sample right = own;
        own = told[i];
        if (!file.has_angular_velocity) own.angular_velocity_B = right.angular_velocity_B;
        if (!file.has_position && !file.has_origin) own.position_W = right.position_W;
        if (!file.has_velocity) own.velocity_W = right.velocity_W;
    }
    return trajectory;
}

Judgement judge_system(const Scene& scene, const TrajectoryFile& file, const Reference& truth) {
    if (!truth.available || truth.moments() * file.bodies_at_once() != file.rows.size() || file.rows.empty())
        throw std::invalid_argument("there is no truth at the file's times");
    const Trajectory trajectory = completed_by(truth, scene, file);
    const ErrorSeries series = error_series(scene, trajectory, truth);
    const double begin = series.t.front(), end = series.t.back();
    Judgement result;
    result.worst_body = series.worst_body;
    const MechanismMeasure<Wide> measure(scene);
    const std::vector<std::string> joints = joint_names(scene);
    const std::size_t gap = measure_index("joint_gap"), turn = measure_index("joint_turn");

    std::array<bool, most_spans> seen{};
    std::array<ErrorSpan, most_spans> spans;
    for (std::size_t k = 0; k < series.t.size(); ++k) {
        const std::size_t span = span_of(series.t[k], begin, end);
        seen[span] = true, spans[span].until = series.t[k];
    }
    for (std::size_t m = 0; m < measures().size(); ++m) {
        const std::vector<double>& errors = series[m];
        if (errors.empty() || !is_told(measures()[m], scene, file)) continue;
        ErrorSummary& summary = result[m].emplace();
        std::size_t worst = 0;
        for (std::size_t k = 0; k < errors.size(); ++k) {
            if (is_larger(errors[k], errors[worst])) worst = k;
            double& largest = spans[span_of(series.t[k], begin, end)].error[m];
            if (is_larger(errors[k], largest)) largest = errors[k];
        }
        summary = {errors[worst], series.t[worst], errors.back()};
        const bool of_gap = m == gap;
        if (!of_gap && m != turn) continue;
        const JointViolations<Wide> there = violations_at(measure, trajectory.at(worst));
        const std::size_t joint = of_gap ? there.gap_joint : there.turn_joint;
        if (joint < joints.size()) (of_gap ? result.worst_gap : result.worst_turn) = joints[joint];
    }
    for (std::size_t span = 0; span < most_spans; ++span)
        if (seen[span]) result.over_time.push_back(spans[span]);

    const std::size_t n = scene.bodies.size();
    double &rate = result.size[measure_index("omega")], &way = result.size[measure_index("position")],
           &speed = result.size[measure_index("velocity")];
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const Sample now = truth.samples[i].rounded(), first = truth.samples[i % n].rounded();
        rate = std::max(rate, length(now.angular_velocity_B));
        way = std::max(way, length(now.position_W - first.position_W));
        speed = std::max(speed, length(now.velocity_W));
    }
    if (rate * scene.duration < vanishing) rate = 0;  // as in error_series()
    return result;
}

}  // namespace polhode
