// A fault is a change of the scene. Its motion is computed by Taylor series with located events and compared with the
// file: the root mean square over rows and bodies of the angle between the attitudes and of the distance in units of
// the motion's size.

#include "check/joint_event_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "body/golden_section.h"
#include "integrators/method.h"
#include "motion/problem.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double most_explained = 0.2;  // a fault leaves at most this part of the difference
constexpr double least_difference = 1e-7;
constexpr double same_quality = 1.3;  // faults whose differences have at most this ratio are not distinguished
constexpr double plain_share = 0.02;  // smallest relative change that is reported as a fault
constexpr double seconds_per_motion = 2;
constexpr int golden_sections = 36;

// A change of the scene. `numbers`: trial values, increasing; empty if no number is fitted.
struct SceneFault {
    std::string fault, what, remedy;
    std::function<void(Scene&, double)> apply;
    std::vector<double> numbers;
    double neutral = 1;  // the number without effect
};

class FileComparison {
  public:
    FileComparison(const Scene& scene, const TrajectoryFile& file)
        : scene_(scene), file_(file), method_(find_method("taylor")) {
        const std::size_t bodies = file.bodies_at_once();
        for (std::size_t k = 0; k < file.rows.size(); k += bodies) settings_.times.push_back(file.rows[k].t);
        settings_.tolerance = 1e-9, settings_.seconds_limit = seconds_per_motion;
        for (const TrajectoryRow& row : file.rows) size_ = std::max(size_, length(row.position_W));
    }
    bool possible() const { return method_ != nullptr && file_.bodies.size() == scene_.bodies.size(); }
    // Infinite if the changed scene has no motion.
    double difference(const SceneFault* fault, double number) const {
        Scene changed = scene_;
        if (fault != nullptr) fault->apply(changed, number);
        const Trajectory motion = solve(changed, *method_, settings_);
        if (motion.status != Status::ok || motion.samples.size() != file_.rows.size()) return infinite;
        double sum = 0;
        for (std::size_t i = 0; i < file_.rows.size(); ++i) {
            const TrajectoryRow& row = file_.rows[i];
            const Sample& sample = motion.samples[i];
            const double inner =
                std::abs(row.q.w * sample.q.w + row.q.x * sample.q.x + row.q.y * sample.q.y + row.q.z * sample.q.z);
            const double lengths = std::sqrt(squared_norm(row.q) * squared_norm(sample.q));
            const Quaternion<double> turn = conjugate(row.q) * sample.q;
            const double angle = 2 * std::atan2(length(vector_part(turn)), inner);
            sum += lengths > 0 ? angle * angle : 0;
            if (file_.has_position && size_ > 0) {
                const double distance = length(row.position_W - sample.position_W) / size_;
                sum += distance * distance;
            }
        }
        return std::sqrt(sum / static_cast<double>(file_.rows.size()));
    }

  private:
    const Scene& scene_;
    const TrajectoryFile& file_;
    const Method* method_;
    Settings settings_;
    double size_ = 0;  // m
};

std::vector<double> factors() { return {0, 0.2, 0.5, 0.8, 1.25, 2, 5, 10}; }

void add_friction_faults(std::vector<SceneFault>& all, const Scene& scene, std::size_t j) {
    const Joint& joint = scene.joints[j];
    if (joint.friction == 0) return;
    const std::string of = fmt::format("the friction of joint {}", one_line(joint.name, 80));
    all.push_back({"joint_friction_missing",
                   of + " is missing",
                   "give the engine the joint's friction",
                   [j](Scene& s, double) { s.joints[j].friction = 0; },
                   {}});
    all.push_back({"joint_friction_scaled", of + " is {} times the scene's", "give the engine the joint's friction",
                   [j](Scene& s, double x) { s.joints[j].friction *= x; }, factors()});
    std::vector<double> coefficients;
    // the damping whose force equals the friction at a speed between 0.01 and 100 rad/s or m/s
    for (const double x : {0.01, 0.04, 0.16, 0.64, 2.5, 10.0, 40.0, 160.0}) coefficients.push_back(x * joint.friction);
    all.push_back({"joint_friction_viscous",
                   of + " is viscous: {} " + (joint.type == JointType::prismatic ? "N s/m" : "N m s"),
                   "use dry friction, whose force does not depend on the speed",
                   [j](Scene& s, double x) { s.joints[j].friction = 0, s.joints[j].damping[0] += x; },
                   std::move(coefficients), 0});
}

void add_limit_faults(std::vector<SceneFault>& all, const Scene& scene, std::size_t j) {
    const Joint& joint = scene.joints[j];
    if (!joint.limits.any()) return;
    const std::string name = one_line(joint.name, 80), unit = joint.type == JointType::prismatic ? "m" : "rad";
    all.push_back({"joint_limit_missing",
                   fmt::format("the limits of joint {} do not act", name),
                   "give the engine the joint's limits",
                   [j](Scene& s, double) { s.joints[j].limits = {}; },
                   {}});
    const auto add_shift = [&](const char* which, double JointLimits::*limit) {
        if (!std::isfinite(joint.limits.*limit)) return;
        std::vector<double> shifts;
        for (const double x : {-0.5, -0.2, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.2, 0.5})
            shifts.push_back(x * std::max(std::abs(joint.limits.*limit), 0.1));
        all.push_back({"joint_limit_shifted",
                       fmt::format("the {} limit of joint {} acts {{}} {} from the scene's", which, name, unit),
                       "give the engine the limit with the scene's zero and unit",
                       [j, limit](Scene& s, double x) { s.joints[j].limits.*limit += x; }, std::move(shifts), 0});
    };
    add_shift("lower", &JointLimits::lower);
    add_shift("upper", &JointLimits::upper);
    all.push_back({"joint_limit_restitution",
                   fmt::format("the coefficient of restitution at the limits of joint {} is {{}}, not {}", name,
                               joint.limits.restitution),
                   "give the engine the limit's restitution",
                   [j](Scene& s, double x) { s.joints[j].limits.restitution = std::clamp(x, 0.0, 1.0); },
                   {0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1},
                   joint.limits.restitution});
}

void add_armature_faults(std::vector<SceneFault>& all, const Scene& scene, std::size_t j) {
    const Joint& joint = scene.joints[j];
    if (joint.armature[0] == 0 && joint.armature[1] == 0) return;
    const std::string of = fmt::format("the armature of joint {}", one_line(joint.name, 80));
    const auto scale = [j](Scene& s, double x) {
        for (double& armature : s.joints[j].armature) armature *= x;
    };
    all.push_back({"armature_missing",
                   of + " is missing",
                   "add it to the joint's entry of the mass matrix",
                   [scale](Scene& s, double) { scale(s, 0); },
                   {}});
    all.push_back({"armature_scaled", of + " is {} times the scene's",
                   "give the rotor's inertia times the squared gear ratio", scale, factors()});
}

// Sets the ratio of a coupling; the second joint starts as the ratio demands.
void set_ratio(Scene& scene, std::size_t c, double ratio) {
    Coupling& coupling = scene.couplings[c];
    const auto joint = [&](const std::string& name) -> Joint& {
        return *std::ranges::find_if(scene.joints, [&](const Joint& one) { return one.name == name; });
    };
    const Joint& first = joint(coupling.first);
    Joint& second = joint(coupling.second);
    coupling.ratio = ratio;
    coupling.offset = second.coordinate[0] - ratio * first.coordinate[0];
    second.rate[0] = ratio * first.rate[0];
}

void add_coupling_faults(std::vector<SceneFault>& all, const Scene& scene, std::size_t c) {
    const Coupling& coupling = scene.couplings[c];
    const std::string of =
        fmt::format("the ratio of joints {} and {}", one_line(coupling.first, 80), one_line(coupling.second, 80));
    const double ratio = coupling.ratio;
    all.push_back(
        {"gear_missing",
         fmt::format("joints {} and {} are not coupled", one_line(coupling.first, 80), one_line(coupling.second, 80)),
         "add the gear or mimic constraint",
         [c](Scene& s, double) { s.couplings.erase(s.couplings.begin() + static_cast<std::ptrdiff_t>(c)); },
         {}});
    if (std::abs(std::abs(ratio) - 1) > plain_share)
        all.push_back({"gear_inverted",
                       of + " is inverted",
                       "use the ratio of the second to the first",
                       [c, ratio](Scene& s, double) { set_ratio(s, c, 1 / ratio); },
                       {}});
    all.push_back({"gear_reversed",
                   of + " has the opposite sign",
                   "reverse the sign of the ratio",
                   [c, ratio](Scene& s, double) { set_ratio(s, c, -ratio); },
                   {}});
    all.push_back({"gear_scaled",
                   of + " is {} times the scene's",
                   "give the engine the scene's ratio",
                   [c, ratio](Scene& s, double x) { set_ratio(s, c, x * ratio); },
                   {0.2, 0.5, 0.8, 0.9, 1.1, 1.25, 2, 5}});
}

std::vector<SceneFault> scene_faults(const Scene& scene) {
    std::vector<SceneFault> all;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        add_friction_faults(all, scene, j);
        add_limit_faults(all, scene, j);
        add_armature_faults(all, scene, j);
    }
    for (std::size_t c = 0; c < scene.couplings.size(); ++c) add_coupling_faults(all, scene, c);
    return all;
}

struct Explanation {
    const SceneFault* fault = nullptr;
    double number = 0, difference = infinite;
};

// Fits the number by golden sections around the best trial value, if that is better than no fault.
Explanation explain(const FileComparison& comparison, const SceneFault& fault, double sound) {
    if (fault.numbers.empty()) return {&fault, 0, comparison.difference(&fault, 0)};
    const auto at = [&](double x) { return comparison.difference(&fault, x); };
    std::vector<double> numbers = fault.numbers;
    numbers.push_back(fault.neutral);
    std::ranges::sort(numbers);
    std::size_t best = 0;
    std::vector<double> found;
    for (const double x : numbers) found.push_back(x == fault.neutral ? sound : at(x));
    for (std::size_t i = 0; i < found.size(); ++i)
        if (found[i] < found[best]) best = i;
    // the effect of a number near the neutral one shows in the neighbours
    const double a = numbers[best > 0 ? best - 1 : 0], b = numbers[std::min(best + 1, numbers.size() - 1)];
    const auto refined = golden_section(at, a, b, golden_sections);
    Explanation fitted{&fault, numbers[best], found[best]};
    if (refined.value < fitted.difference) fitted.number = refined.x, fitted.difference = refined.value;
    return fitted;
}

// Whether a fitted number differs from the neutral one by enough to be a fault, and from a fault without a number.
bool is_plain(const Explanation& e) {
    if (e.fault->numbers.empty()) return true;
    const double size = std::max(std::abs(e.fault->neutral), std::abs(e.fault->numbers.back()));
    return std::abs(e.number - e.fault->neutral) > plain_share * size * (e.fault->neutral == 0 ? 0.1 : 1) &&
           !(e.fault->neutral == 1 && std::abs(e.number) < plain_share);
}

}  // namespace

std::vector<Diagnosis> joint_event_faults(const Scene& scene, const TrajectoryFile& file) {
    const FileComparison comparison(scene, file);
    if (!comparison.possible()) return {};
    const double sound = comparison.difference(nullptr, 0);
    if (!(sound > least_difference) || sound == infinite) return {};
    const std::vector<SceneFault> faults = scene_faults(scene);
    std::vector<Explanation> explanations;
    for (const SceneFault& fault : faults) {
        const Explanation e = explain(comparison, fault, sound);
        if (e.difference <= most_explained * sound && is_plain(e)) explanations.push_back(e);
    }
    // at equal quality a fault without a number comes first
    std::ranges::stable_sort(explanations, {}, [](const Explanation& e) {
        return e.difference * (e.fault->numbers.empty() ? 1 : same_quality);
    });
    std::vector<Diagnosis> diagnoses;
    for (const Explanation& e : explanations) {
        if (e.difference > same_quality * explanations.front().difference) break;
        if (!diagnoses.empty() && !e.fault->numbers.empty()) continue;
        diagnoses.push_back({e.fault->fault,
                             fmt::format("{}; {} (difference from the file: {:.2g} with this fault, {:.2g} without)",
                                         fmt::format(fmt::runtime(e.fault->what), fmt::format("{:.3g}", e.number)),
                                         e.fault->remedy, e.difference, sound),
                             "", sound, e.difference});
    }
    return diagnoses;
}

}  // namespace polhode
