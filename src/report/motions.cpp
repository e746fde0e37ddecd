// Motions for the page. Scenes that differ only in duration share one motion, of at most 15 revolutions of the fastest
// body. For each, MotionWriter computes the truth at many times, solves the scene with every method of the directory at
// one common setting, computes attitude errors at a few hundred times, and reduces each visibly different motion to
// keyframes (report/keyframes.h). Run time and steps of each run are limited.
#include "report/motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>

#include "body/mass_properties.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/engines/engine_methods.h"
#include "integrators/method.h"
#include "integrators/truth/dense.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "motion/mechanism_motion.h"
#include "motion/problem.h"
#include "report/body_shape.h"
#include "report/keyframes.h"
#include "report/motion_contacts.h"
#include "report/motion_joints.h"
#include "scene/joint_file.h"
#include "scene/scene_file.h"
#include "text/message.h"
#include "text/parallel.h"

namespace polhode {
namespace {

// if contacts or joints have events, which often follow a long motion: twice as much
constexpr double most_revolutions = 15, most_revolutions_with_events = 30;
// rotation of the fastest body between two samples, rad
constexpr double turn_per_sample = 0.1;
constexpr long least_samples = 200, most_samples = 2000;
// if the truth is computed separately for each time
constexpr long slow_truth_samples = 400;
constexpr std::size_t error_samples = 400, error_points = 100, fewer_error_points = 30;
// rad, invisible in a picture of a few hundred pixels, where a degree is one or two pixels
constexpr double visible_angle = 1e-2;
constexpr double truth_limit = 5, truth_limit_with_events = 15, run_limit = 0.5;  // s
constexpr long run_steps = 200'000;
// The setting shown of each method is the one nearest to common use: this tolerance, or a step of this rotation (rad).
constexpr double drawn_tolerance = 1e-6, turn_per_step = 0.1;

// A run of a method, from a row of the directory.
struct DrawnRun {
    int method = 0;
    SettingKind kind = SettingKind::none;
    double setting = absent;
};

// Whether run a is preferred over run b; `step` (s) is the step of common use.
bool precedes(const DrawnRun& a, const DrawnRun& b, double step) {
    if (a.kind != b.kind) return a.kind == SettingKind::step;
    const double wanted = a.kind == SettingKind::step ? step : drawn_tolerance;
    return std::abs(std::log(a.setting / wanted)) < std::abs(std::log(b.setting / wanted));
}

// The truth at arbitrary times, with a cache for scenes without dense output.
class SceneTruth {
  public:
    explicit SceneTruth(const Scene& scene)
        : scene_(scene), limit_(contact::has_events(scene) ? truth_limit_with_events : truth_limit) {
        dense_ = dense_reference(scene, scene.duration);
    }

    // whether new times are inexpensive
    bool is_dense() const { return dense_.available; }

    Reference at(const std::vector<double>& times) {
        if (!dense_.available) {
            if (times != times_) times_ = times, known_ = reference(scene_, times, 17, limit_);
            return known_;
        }
        Reference truth;
        truth.available = true, truth.message = dense_.message, truth.bound = dense_.bound;
        for (const double t : times) truth.samples.push_back(dense_.at(t));
        return truth;
    }

    // like at(), but reuses the cache if `times` are the first of the cached times
    Reference reference_at(const std::vector<double>& times) {
        if (dense_.available || times.size() > times_.size() || !std::equal(times.begin(), times.end(), times_.begin()))
            return at(times);
        Reference truth = known_;
        const std::size_t bodies = static_cast<std::size_t>(truth.bodies);
        truth.samples.resize(std::min(truth.samples.size(), times.size() * bodies));
        if (!truth.system.empty()) truth.system.resize(times.size());
        return truth;
    }

  private:
    const Scene& scene_;
    const double limit_;  // s
    DenseTruth dense_;
    std::vector<double> times_;
    Reference known_;
};

Trajectory rounded(const Reference& truth) {
    Trajectory trajectory;
    trajectory.bodies = truth.bodies;
    for (const ReferenceSample& sample : truth.samples) trajectory.samples.push_back(sample.rounded());
    return trajectory;
}

Json joints_json(const Scene& scene) {
    Json joints = Json::array();
    const auto from_center = [&](const std::string& name, const Vector3<double>& point) {
        const int at = body_index(scene, name);
        return vector_json(at < 0 ? point : point - scene.bodies[static_cast<std::size_t>(at)].body.center_of_mass);
    };
    for (const Joint& joint : scene.joints)
        joints.push_back({{"name", joint.name},
                          {"type", name_of(joint.type)},
                          {"parent", body_index(scene, joint.parent)},
                          {"child", body_index(scene, joint.child)},
                          {"parent_point", from_center(joint.parent, joint.parent_point)},
                          {"child_point", from_center(joint.child, joint.child_point)},
                          {"axis", joint.type == JointType::revolute || joint.type == JointType::prismatic
                                       ? vector_json(joint.axes[0])
                                       : Json()}});
    for (const Loop& loop : scene.loops)
        joints.push_back({{"name", loop.name},
                          {"type", loop.type == LoopType::distance ? "distance" : "loop"},
                          {"parent", body_index(scene, loop.first)},
                          {"child", body_index(scene, loop.second)},
                          {"parent_point", from_center(loop.first, loop.first_point)},
                          {"child_point", from_center(loop.second, loop.second_point)},
                          {"axis", nullptr}});
    return joints;
}

// Approximate extent of a body from its centre of mass: half the diagonal of the box of its moments.
double size_of(const Body& body) {
    const Matrix3<double>& I = body.inertia_B;
    if (body.mass == 0) return 0;
    return std::sqrt(std::max(0.0, 1.5 * (I[0][0] + I[1][1] + I[2][2]) / body.mass));
}

class MotionWriter {
  public:
    MotionWriter(const Scene& scene, std::string& fault) : scene_(scene), fault_(fault) {}

    // Returns null and sets fault_ if the truth is not available or not drawable.
    Json motion(int place, const std::vector<DrawnRun>& runs, const ResultFolder& folder,
                const std::vector<const DrawnFile*>& files) {
        const double whole = scene_.duration;
        const Problem problem = pose(scene_);
        std::optional<SceneTruth> truth;
        const Reference reference = windowed_truth(problem, truth);
        if (!reference.available) {
            fault_ = reference.message;
            return nullptr;
        }
        const SampledMotion motion = sampled_motion(rounded(reference));
        if (motion.t.size() < 2) {
            fault_ = "its values are too large to draw";
            return nullptr;
        }
        tolerance_ = {visible_angle, 2e-3 * drawn_size()};
        const Keyframes keyframes = select_keyframes(motion, tolerance_, true);
        worst_ = keyframes.off;
        Json json{{"scene", place},
                  {"duration", number_json(scene_.duration, 7)},
                  {"whole", number_json(whole, 7)},
                  {"thinning", Json::object()},
                  {"bodies", Json::array()},
                  {"joints", joints_json(scene_)}};
        const bool several = is_mechanism(scene_);
        add_scene(several, json);
        json["moving"] = is_moving(motion);
        json["free"] = !several && problem.needs.torque_free && problem.segments.size() == 1 && scene_.planes.empty();
        json["energy"] = number_json(several ? 0 : energy(motion.at(0, 0)), 6);
        json["truth"] = track_json(motion, keyframes);
        json["how"] = fmt::format("{}; error bound {:.1e}", reference.message, reference.bound);
        add_details(reference, json);
        json["methods"] = Json::array();
        for (const DrawnRun& run : runs) json["methods"].push_back(run_json(run, folder.methods[run.method], *truth));
        for (const DrawnFile* file : files) json["methods"].push_back(file_json(*file, *truth));
        json["thinning"] = {{"angle", number_json(worst_.angle, 3)}, {"length", number_json(worst_.length, 3)}};
        return json;
    }

  private:
    // The truth over the window of the page, to which scene_.duration is set: the number of revolutions of the fastest
    // body is limited. If the longer window of motions with events takes too long, the shorter one is used.
    Reference windowed_truth(const Problem& problem, std::optional<SceneTruth>& truth) {
        const double whole = scene_.duration, rate = problem.scales.angular_velocity;
        Reference reference;
        double last = 0;
        for (const double most : {most_revolutions_with_events, most_revolutions}) {
            if (most == most_revolutions_with_events && !contact::has_events(scene_)) continue;
            scene_.duration = rate > 0 ? std::min(whole, most * 2 * std::numbers::pi / rate) : whole;
            if (scene_.duration == last) break;
            last = scene_.duration;
            truth.emplace(scene_);
            dense_ = truth->is_dense();
            samples_ = std::clamp(static_cast<long>(std::ceil(scene_.duration * rate / turn_per_sample)), least_samples,
                                  dense_ ? most_samples : slow_truth_samples) /
                       2 * 2;
            reference = truth->at(sample_times(scene_.duration, samples_));
            if (reference.available) break;
        }
        return reference;
    }

    // The extent of the largest body, m.
    double drawn_size() const {
        double size = 0;
        for (std::size_t b = 0; b < body_count(scene_); ++b) size = std::max(size, size_of(scene_body(scene_, b).body));
        // bodies without extent: use the distances from their joints
        if (size == 0)
            for (const double arm : MechanismMeasure<double>(scene_).arms()) size = std::max(size, arm);
        if (size == 0) size = 1;
        return size;
    }

    // Adds the shapes of the bodies, the pivot, the planes and gravity.
    void add_scene(bool several, Json& json) const {
        for (std::size_t b = 0; b < body_count(scene_); ++b) {
            const SceneBody body = scene_body(scene_, b);
            json["bodies"].push_back(body_shape_json(several ? std::string(body.name) : scene_.name, body.body));
        }
        json["pivot"] = scene_.pivot ? vector_json(*scene_.pivot - scene_.body.center_of_mass) : Json();
        json["about"] = several ? Json() : principal_json(scene_.body, scene_.pivot);
        json["planes"] = Json::array();
        for (const Plane& plane : scene_.planes)
            json["planes"].push_back(
                {{"normal", vector_json(plane.normal_W)}, {"offset", number_json(plane.offset, 6)}});
        json["gravity"] = nullptr;
        for (const Load& load : scene_.loads)
            if (const Gravity* gravity = std::get_if<Gravity>(&load))
                json["gravity"] = vector_json(gravity->acceleration_W);
    }

    // Adds contacts and joint coordinates.
    void add_details(const Reference& reference, Json& json) const {
        MotionDetails details;
        if (!scene_.planes.empty() || !scene_.contacts.empty())
            details = contacts_of_motion(scene_, reference, tolerance_);
        else if (!scene_.joints.empty())
            details = joints_of_motion(scene_, reference, tolerance_);
        json["timeline"] = std::move(details.timeline), json["contacts"] = std::move(details.contacts);
        json["coordinates"] = std::move(details.coordinates), json["remark"] = std::move(details.remark);
    }

    static bool is_moving(const SampledMotion& motion) {
        bool moving = false;
        for (std::size_t k = 0; k < motion.t.size(); ++k)
            for (int b = 0; b < motion.bodies; ++b)
                moving = moving || !(motion.at(k, b).position_W == motion.at(0, b).position_W);
        return moving;
    }

    double energy(const Sample& sample) const {
        const Matrix3<double> inertia =
            scene_.pivot ? about_point(MassProperties<double>{scene_.body.mass, scene_.body.center_of_mass,
                                                              scene_.body.inertia_B},
                                       *scene_.pivot)
                         : scene_.body.inertia_B;
        return 0.5 * dot(sample.angular_velocity_B, inertia * sample.angular_velocity_B);
    }

    // Settings of a run. Fixed-step runs are sampled at their steps, so that sampling does not change the step.
    Settings settings_of(const DrawnRun& run, bool dense) const {
        Settings settings;
        settings.seconds_limit = run_limit, settings.max_steps = run_steps;
        settings.samples = dense || !dense_ ? samples_ : std::min(samples_, 100L);
        if (run.kind == SettingKind::tolerance) settings.tolerance = run.setting;
        if (run.kind == SettingKind::step) {
            const double steps = std::ceil(scene_.duration / run.setting * (1 - 1e-9));
            const double between = std::ceil(steps / static_cast<double>(most_samples));
            if (dense_) settings.samples = std::max(1L, static_cast<long>(std::ceil(steps / between)));
            settings.step = dense_ ? scene_.duration / static_cast<double>(settings.samples) / between : run.setting;
        }
        return settings;
    }

    Json run_json(const DrawnRun& run, const std::string& name, SceneTruth& truth) {
        Json json{{"method", run.method},
                  {"label", name},
                  {"setting_kind", static_cast<int>(run.kind)},
                  {"setting", number_json(run.setting, 4)},
                  {"status", static_cast<int>(Status::failed)},
                  {"message", ""},
                  {"track", nullptr},
                  {"difference", nullptr},
                  {"t", Json::array()},
                  {"attitude", Json::array()}};
        const Method* const method = find_method(name);
        if (!method) {
            json["message"] = find_engine(name) ? "`polhode report` does not start physics engines in other processes"
                                                : "this version of polhode has no method of this name";
            return json;
        }
        for (const bool dense : {false, true}) {
            const Settings settings = settings_of(run, dense);
            const Trajectory trajectory = solve(scene_, *method, settings);
            if (run.kind == SettingKind::step && trajectory.step > 0) json["setting"] = number_json(trajectory.step, 4);
            const std::string message = trajectory.status == Status::unsupported && trajectory.message.empty()
                                            ? refusal(*method, pose(scene_))
                                            : trajectory.message;
            const bool is_visible = add(json, trajectory, message, truth);
            // tolerance-driven runs that are visibly different are solved again with dense samples
            if (!is_visible || run.kind == SettingKind::step || dense || !dense_) break;
        }
        return json;
    }

    Json file_json(const DrawnFile& file, SceneTruth& truth) {
        Trajectory trajectory;
        trajectory.bodies = file.bodies;
        const std::size_t bodies = static_cast<std::size_t>(file.bodies);
        for (std::size_t k = 0; k * bodies < file.samples.size(); ++k)
            if (file.samples[k * bodies].t <= scene_.duration)
                trajectory.append(Bodies(std::span(file.samples).subspan(k * bodies, bodies)));
        Json json{{"method", -1}, {"label", file.label}, {"setting_kind", 0}, {"setting", nullptr}};
        add(json, trajectory, "", truth);
        return json;
    }

    // Adds status, errors and, if visibly different from the truth, keyframes. Returns whether keyframes were added.
    bool add(Json& json, const Trajectory& trajectory, const std::string& message, SceneTruth& truth) {
        json["status"] = static_cast<int>(trajectory.status);
        json["message"] = message;
        json["track"] = json["difference"] = nullptr;
        json["t"] = json["attitude"] = Json::array();
        if (trajectory.moments() == 0) return false;
        // differences from the truth are computed in 128 bits, which is slow: only at a few hundred times
        const std::size_t bodies = static_cast<std::size_t>(trajectory.bodies);
        Trajectory error_run = trajectory;
        error_run.samples.clear(), error_run.orthogonality_defect.clear(), error_run.reactions.clear();
        std::vector<double> times;
        for (const std::size_t k :
             spread_indices(trajectory.moments(), dense_ ? error_samples : trajectory.moments())) {
            const auto first = trajectory.samples.begin() + static_cast<std::ptrdiff_t>(k * bodies);
            if (!std::all_of(first, first + static_cast<std::ptrdiff_t>(bodies), is_drawable)) break;
            times.push_back(first->t);
            error_run.samples.insert(error_run.samples.end(), first, first + static_cast<std::ptrdiff_t>(bodies));
        }
        if (times.empty() || times.back() == 0) return false;
        const Reference reference = truth.reference_at(times);
        if (!reference.available) return false;
        const std::vector<double> errors = error_series(scene_, error_run, reference)["attitude"];
        const double largest = std::ranges::max(errors, {}, [](double e) { return std::isfinite(e) ? e : -1; });
        json["difference"] = number_json(largest, 3);
        const bool as_truth =
            trajectory.status == Status::ok && largest <= visible_angle && moves_alike(error_run, reference);
        for (const std::size_t k : spread_indices(errors.size(), as_truth ? fewer_error_points : error_points)) {
            json["t"].push_back(number_json(times[k], 5));
            json["attitude"].push_back(number_json(errors[k], 3));
        }
        if (as_truth) return false;
        const SampledMotion motion = sampled_motion(trajectory);
        if (motion.t.size() < 2) return false;
        const Keyframes keyframes = select_keyframes(motion, tolerance_, false);
        worst_.angle = std::max(worst_.angle, keyframes.off.angle);
        worst_.length = std::max(worst_.length, keyframes.off.length);
        json["track"] = track_json(motion, keyframes);
        return true;
    }

    bool moves_alike(const Trajectory& trajectory, const Reference& reference) const {
        const std::size_t count = std::min(trajectory.samples.size(), reference.samples.size());
        for (std::size_t i = 0; i < count; ++i) {
            const Vector3<double> d = trajectory.samples[i].position_W - reference.samples[i].rounded().position_W;
            if (!(length(d) <= tolerance_.length)) return false;
        }
        return true;
    }

    Scene scene_;
    std::string& fault_;
    long samples_ = least_samples;
    bool dense_ = false;
    Tolerance tolerance_, worst_;
};

// One motion to compute. Scenes that differ only in duration share the motion of the longest one.
struct MotionTask {  // NOLINT(bugprone-exception-escape): the JSON library's destructor takes memory
    const Scene* scene = nullptr;
    std::vector<int> places;
    std::map<int, DrawnRun> runs;
    double step = 0;  // s, step of common use
    std::string fault;
    Json json;
};

std::map<std::string, MotionTask> motion_tasks(const ResultFolder& folder, const std::map<std::string, Scene>& scenes) {
    std::map<std::string, MotionTask> tasks;
    for (const auto& [name, scene] : scenes) {
        Scene timeless = scene;
        timeless.duration = 1, timeless.name = "-", timeless.about.clear(), timeless.source.clear();
        MotionTask& task = tasks[write_scene(timeless)];
        if (!task.scene || scene.duration > task.scene->duration) task.scene = &scene;
        task.places.push_back(folder.scenes.find(name));
    }
    for (auto& [key, task] : tasks) {
        const double rate = pose(*task.scene).scales.angular_velocity;
        task.step = rate > 0 ? turn_per_step / rate : task.scene->duration / 1000;
    }
    return tasks;
}

// Selects one run of each method: the one nearest to common use.
void select_runs(const ResultFolder& folder, std::map<std::string, MotionTask>& tasks) {
    std::map<int, MotionTask*> of_place;
    for (auto& [key, task] : tasks)
        for (const int place : task.places) of_place[place] = &task;
    for (const FolderRow& row : folder.rows) {
        const auto found = of_place.find(row.scene);
        if (found == of_place.end() || row.status == Status::unsupported) continue;
        const double setting = row.kind == SettingKind::none ? absent : row["setting"];
        if (row.kind != SettingKind::none && !(setting > 0)) continue;
        const DrawnRun run{row.method, row.kind, setting};
        const auto [at, is_new] = found->second->runs.try_emplace(row.method, run);
        if (!is_new && precedes(run, at->second, found->second->step)) at->second = run;
    }
}

}  // namespace

Motions make_motions(const ResultFolder& folder, const std::map<std::string, Scene>& scenes,
                     const std::vector<DrawnFile>& files, int jobs) {
    std::map<std::string, MotionTask> tasks = motion_tasks(folder, scenes);
    select_runs(folder, tasks);
    std::vector<MotionTask*> order;
    for (auto& [key, task] : tasks) order.push_back(&task);
    std::ranges::sort(order, {}, [](const MotionTask* task) { return std::ranges::min(task->places); });

    parallel_for(order.size(), jobs, [&](std::size_t i) {
        MotionTask& task = *order[i];
        std::vector<DrawnRun> runs;
        for (const auto& [method, run] : task.runs) runs.push_back(run);
        std::vector<const DrawnFile*> own;
        for (const DrawnFile& file : files)
            if (std::ranges::find(task.places, file.scene) != task.places.end()) own.push_back(&file);
        try {
            task.json = MotionWriter(*task.scene, task.fault).motion(std::ranges::min(task.places), runs, folder, own);
        } catch (const InputError& fault) {
            task.fault = fault.what();
        }
    });

    Motions motions;
    motions.of_file.assign(files.size(), -1);
    for (MotionTask* task : order) {
        if (task->json.is_null()) {
            motions.omissions.push_back(fmt::format("{} is not drawn: {}.",
                                                    one_line(folder.scenes[std::ranges::min(task->places)], 100),
                                                    one_line(task->fault, 300)));
            continue;
        }
        const int place = static_cast<int>(motions.list.size());
        for (const int scene : task->places) motions.of_scene[scene] = place;
        std::size_t next = task->runs.size();
        for (std::size_t i = 0; i < files.size(); ++i)
            if (std::ranges::find(task->places, files[i].scene) != task->places.end())
                motions.of_file[i] = static_cast<int>(next++);
        motions.list.push_back(std::move(task->json));
    }
    return motions;
}

}  // namespace polhode
