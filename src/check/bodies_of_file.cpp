// The bodies of a file. Blocks and bodies that a file lacks are filled in from the truth.
#include "check/file_errors.h"

namespace polhode {

std::vector<std::size_t> bodies_of_file(const Scene& scene, const TrajectoryFile& file) {
    std::vector<std::size_t> places;
    for (const std::string& name : file.bodies) places.push_back(static_cast<std::size_t>(body_index(scene, name)));
    // without a column `body`, the file describes the only body
    if (places.empty()) places.push_back(0);
    return places;
}

std::vector<std::string> missing_bodies(const Scene& scene, const TrajectoryFile& file) {
    std::vector<bool> is_missing(body_count(scene), true);
    for (const std::size_t b : bodies_of_file(scene, file)) is_missing[b] = false;
    std::vector<std::string> missing;
    for (std::size_t b = 0; b < is_missing.size(); ++b)
        if (is_missing[b]) missing.emplace_back(scene_body(scene, b).name);
    return missing;
}

Trajectory complete_from_truth(const Reference& truth, const Scene& scene, const TrajectoryFile& file) {
    const std::vector<std::size_t> places = bodies_of_file(scene, file);
    std::vector<Vector3<double>> centers;
    for (const std::size_t b : places) centers.push_back(scene_body(scene, b).body.center_of_mass);
    const std::vector<Sample> file_samples = samples_of(file, centers);
    const std::size_t n = body_count(scene);
    Trajectory trajectory;
    trajectory.bodies = static_cast<int>(n);
    for (const ReferenceSample& sample : truth.samples) trajectory.samples.push_back(sample.rounded());
    for (std::size_t i = 0; i < file_samples.size(); ++i) {
        Sample& completed = trajectory.samples[i / places.size() * n + places[i % places.size()]];
        const Sample true_sample = completed;
        completed = file_samples[i];
        if (!file.has_angular_velocity) completed.angular_velocity_B = true_sample.angular_velocity_B;
        if (!file.has_position && !file.has_origin) completed.position_W = true_sample.position_W;
        if (!file.has_velocity) completed.velocity_W = true_sample.velocity_W;
    }
    return trajectory;
}

}  // namespace polhode
