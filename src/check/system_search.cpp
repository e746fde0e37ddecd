// Search for the faults that explain a file of several bodies.
//
// SystemEvidence chooses some rows and measures how well a cause predicts the next rows. It compares the velocities
// that the joints allow, relative to their typical changes. SystemSearch tests each hypothesis of system_faults()
// with the update rules of SystemRule and fits numbers by least squares. diagnose_system() accepts single faults that
// gain enough and whose effect is_distinct(), and otherwise tests pairs.
#include "check/system_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "body/mass_properties.h"
#include "body/orientation.h"
#include "check/joint_faults.h"
#include "check/search.h"
#include "check/system_faults.h"
#include "motion/mechanism.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;

// number of steps that are tested, and of moments that a file must have
constexpr std::size_t most_system_windows = 24, fewest_windows = 6, most_bodies_of_all_windows = 8, fewest_moments = 5;
// Required gain of a wrong reading of columns, in decades over all questions.
constexpr double gain_of_reading = 3;
// a fault cannot be recognised below this relative prediction error
constexpr double plain_change = 1e-3;
// largest rotation in an accurate step, rad, and largest number of steps from row to row
constexpr double most_turned_in_step = 0.1;
constexpr int most_steps = 12;
// decades: an update equal to the engine's leaves no larger error
constexpr double nearly_exact = -6;
// smallest relative prediction error
constexpr double finest_change = 1e-9;

double decades(double error, double scale, double noise) {
    const double floor = std::max(finest_change, noise);
    if (!std::isfinite(error)) return std::log10(2.0);
    return std::log10(std::clamp(scale > 0 ? error / scale : (error > 0 ? 2.0 : 0.0), floor, 2.0));
}

// Converts the bodies of a scene to numeric mass properties, which faults can change.
Scene with_numeric_bodies(const Scene& scene) {
    Scene plain = scene;
    for (NamedBody& named : plain.bodies) {
        const MassProperties<double> m = mass_properties<double>(named.body);
        named.body.source = nullptr;
        named.body.mass = m.mass, named.body.center_of_mass = m.center, named.body.inertia_B = m.inertia;
    }
    return plain;
}

// Prediction errors under a cause: velocities that the joints allow, attitudes and positions, start.
struct PredictionErrors {
    double total = std::numeric_limits<double>::infinity();
    double velocities = 0;  // mean over the velocities that were tested, decades
    double largest = 0;     // largest error relative to the typical change
    double squares = 0;     // sum of squared errors, relative to the typical changes
    int asked = 0;          // number of velocities that were tested
    double kinematics = 0, start = 0;
};

struct SystemExplanation {
    const SystemHypothesis* hypothesis = nullptr;  // null: no fault
    double x = 1;
    SystemRule rule = SystemRule::accurate;
    int steps = 1;
    PredictionErrors errors;
};

class SystemEvidence {
  public:
    SystemEvidence(const Scene& scene, const TrajectoryFile& file) : file_(file) {
        sound_.scene = with_numeric_bodies(scene);
        sound_.reading.origin = file.has_origin;
        moments_ = file.rows.size() / file.bodies_at_once();
        const SystemEngine model(sound_);
        find_noise();
        determined_ = moments_ >= fewest_moments && complete(model);
        if (determined_) choose_windows(scene), include_predicted_changes(model);
    }

    bool has_enough_rows() const { return determined_ && windows_.size() >= 3; }
    const SystemCause& sound() const { return sound_; }

    // Prediction errors for each window and velocity, relative to the typical changes of that velocity.
    std::vector<double> residuals(const SystemCause& cause, const SystemEngine& model, SystemRule rule,
                                  int steps) const {
        std::vector<double> all;
        for (const std::size_t k : windows_) {
            const SystemState next = state(cause, model, k + 1);
            const std::vector<double> is = model.velocities(next),
                                      predictions = model.predicted(state(cause, model, k), next, time(k),
                                                                    time(k + 1) - time(k), rule, steps);
            for (std::size_t i = 0; i < is.size(); ++i) all.push_back((predictions[i] - is[i]) / scales_[i]);
        }
        return all;
    }

    PredictionErrors prediction_errors(const SystemCause& cause, const SystemEngine& model, SystemRule rule,
                                       int steps) const {
        PredictionErrors a;
        const std::size_t n = scales_.size();
        // for each velocity: squared changes in the file and predicted, largest value; all prediction errors
        std::vector<double> in_file(n, 0), predicted(n, 0), sizes(n, 0), errors;
        for (const std::size_t k : windows_) {
            const SystemState from = state(cause, model, k), next = state(cause, model, k + 1);
            const std::vector<double> was = model.velocities(from), is = model.velocities(next),
                                      predictions =
                                          model.predicted(from, next, time(k), time(k + 1) - time(k), rule, steps);
            for (std::size_t i = 0; i < n; ++i) {
                const std::size_t of = model.vector_of_velocity()[i];
                in_file[of] += (is[i] - was[i]) * (is[i] - was[i]);
                predicted[of] += (predictions[i] - was[i]) * (predictions[i] - was[i]);
                sizes[of] = std::max(sizes[of], std::abs(is[i]));
                errors.push_back(std::abs(predictions[i] - is[i]));
            }
        }
        const double count = static_cast<double>(windows_.size());
        double largest = 0;
        std::vector<double> scales(n);
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t of = model.vector_of_velocity()[i];
            sizes[i] = sizes[of], scales[i] = std::sqrt(std::max(in_file[of], predicted[of]) / count);
            if (std::isfinite(scales[i])) largest = std::max(largest, scales[i]);
        }
        a.total = 0;
        for (std::size_t i = 0; i < n; ++i) {
            // velocities that change only by rounding, in the file and predicted, count as perfect
            if (scales[i] <= 1e-9 * largest || scales[i] <= 30 * noise_ * sizes[i]) {
                a.total += std::log10(finest_change), a.asked += 1;
                continue;
            }
            double sum = 0;
            for (std::size_t k = 0; k < windows_.size(); ++k) {
                const double error = errors[k * n + i];
                a.largest = std::max(a.largest, error / scales[i]);
                a.squares += std::isfinite(error) ? std::min(error / scales[i] * error / scales[i], 4.0) : 4.0;
                sum += decades(error, scales[i], 3 * noise_ * sizes[i] / scales[i]);
            }
            a.total += sum / count, a.asked += 1;
        }
        a.velocities = a.asked > 0 ? a.total / a.asked : 0;
        a.kinematics = kinematics(cause), a.start = start(cause, model);
        a.total += a.kinematics + a.start;
        return a;
    }

    // Number of steps in accurate predictions. No body rotates by more than 0.1 rad in a step.
    int accurate_steps() const { return std::max(2, static_cast<int>(std::ceil(largest_turn_ / most_turned_in_step))); }
    // Whether the scene's motion leads from moment k to k + 2: every velocity changes nearly as in the file.
    bool predicts(std::size_t k) const {
        if (!determined_ || k + 2 >= moments_) return true;
        const SystemEngine model(sound_);
        const SystemState from = state(sound_, model, k), to = state(sound_, model, k + 2);
        const std::vector<double> was = model.velocities(from), is = model.velocities(to),
                                  predictions = model.predicted(from, to, time(k), time(k + 2) - time(k),
                                                                SystemRule::accurate, 2 * accurate_steps());
        for (std::size_t i = 0; i < is.size(); ++i)
            if (std::abs(predictions[i] - is[i]) > 0.3 * std::abs(is[i] - was[i]) &&
                std::abs(is[i] - was[i]) > 5 * scales_[i])
                return false;
        return true;
    }
    // The largest h w^2, 1/s.
    double fastest_turn() const { return largest_turn_ * largest_turn_ / (time(1) - time(0)); }
    double time(std::size_t k) const { return file_.rows[k * file_.bodies_at_once()].t; }
    std::size_t windows() const { return windows_.size(); }
    std::size_t velocities() const { return scales_.size(); }
    double noise() const { return noise_; }

  private:
    const TrajectoryFile& file_;
    SystemCause sound_;
    std::size_t moments_ = 0;
    bool determined_ = false;
    double noise_ = 1e-15, largest_turn_ = 0;  // largest rotation of a body from row to row, rad
    std::vector<std::size_t> windows_;
    std::vector<double> scales_;               // typical change of each velocity from row to row
    std::vector<std::vector<double>> angles_;  // at each moment, angles of joints whose turns are counted

    void find_noise() {
        bool binary32 = true;
        for (std::size_t k = 0; k < file_.rows.size(); k += std::max<std::size_t>(1, file_.rows.size() / 100)) {
            const TrajectoryRow& row = file_.rows[k];
            for (const double x : {row.q.w, row.q.x, row.q.y, row.q.z, row.angular_velocity_W[0], row.position_W[1]})
                binary32 = binary32 && static_cast<double>(static_cast<float>(x)) == x;
        }
        if (binary32) noise_ = 1.2e-7;
    }

    // Reads a body's row as the cause specifies. The caller fills in blocks that the file lacks.
    BodyMotion<double> body(const SystemCause& cause, std::size_t k, std::size_t b) const {
        const Reading& read = cause.reading;
        const TrajectoryRow& row = file_.rows[k * file_.bodies_at_once() + b];
        Quaternion<double> q = row.q;
        if (read.scalar_last) q = {q.z, q.w, q.x, q.y};
        if (read.inverted) q = conjugate(q);
        BodyMotion<double> m;
        m.q = normalized(quaternion_from(read.axes, q));
        const Vector w = read.rate_unit * pseudovector_from(read.axes, row.angular_velocity_W);
        m.angular_velocity_B = read.rate_in_body ? w : rotate_back(m.q, w);
        m.position_W = (read.length_unit * read.position_unit) * vector_from(read.axes, row.position_W);
        m.velocity_W = (read.length_unit * read.velocity_unit) * vector_from(read.axes, row.velocity_W);
        if (read.origin) m.position_W = m.position_W + rotate(m.q, cause.scene.bodies[b].body.center_of_mass);
        return m;
    }
    bool has_place() const { return file_.has_position || file_.has_origin; }

    SystemState state(const SystemCause& cause, const SystemEngine& model, std::size_t k) const {
        SystemState s;
        for (std::size_t b = 0; b < cause.scene.bodies.size(); ++b) s.bodies.push_back(body(cause, k, b));
        if (!file_.has_angular_velocity) {
            // mean rate from the previous row to the next row
            const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, moments_ - 1);
            for (std::size_t b = 0; b < s.bodies.size(); ++b) {
                const Quaternion<double> first = body(cause, before, b).q, last = body(cause, after, b).q;
                s.bodies[b].angular_velocity_B =
                    (1 / (time(after) - time(before))) * rotation_vector_from_quaternion(conjugate(first) * last);
            }
        }
        complete(model, s);
        if (k < angles_.size()) s.angles = angles_[k];
        return s;
    }

    // Computes missing positions and velocities from the joints, starting at the world.
    void complete(const SystemEngine& model, SystemState& s) const {
        if (has_place() && file_.has_velocity) return;
        const maximal::Mechanism<double>& mechanism = model.system().mechanism();
        std::vector<std::size_t> order(mechanism.links.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        const auto depth = [&](std::size_t k) {
            return mechanism.depth[static_cast<std::size_t>(mechanism.links[k].to.body)];
        };
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth(a) < depth(b); });
        for (const std::size_t k : order) {
            const maximal::Link<double>& link = mechanism.links[k];
            if (!link.is_joint() || !mechanism.movable(link.to.body)) continue;
            BodyMotion<double> world;
            world.q = {1, 0, 0, 0};
            const BodyMotion<double>& from =
                link.from.body == mechanism.world() ? world : s.bodies[static_cast<std::size_t>(link.from.body)];
            BodyMotion<double>& to = s.bodies[static_cast<std::size_t>(link.to.body)];
            const Vector arm_from = rotate(from.q, link.from.arm_B), arm_to = rotate(to.q, link.to.arm_B);
            if (!has_place()) to.position_W = from.position_W + arm_from - arm_to;
            if (!file_.has_velocity)
                to.velocity_W = from.velocity_W + rotate(from.q, cross(from.angular_velocity_B, link.from.arm_B)) -
                                rotate(to.q, cross(to.angular_velocity_B, link.to.arm_B));
        }
    }
    // Whether the joints determine all missing blocks. Also computes angles with turns and the scales.
    bool complete(const SystemEngine& model) {
        const maximal::Mechanism<double>& mechanism = model.system().mechanism();
        if (file_.bodies_at_once() != sound_.scene.bodies.size()) return false;
        if (!has_place() || !file_.has_velocity) {
            std::vector<bool> placed(mechanism.bodies.size() + 1, false);
            placed.back() = true;
            for (std::size_t sweep = 0; sweep < mechanism.bodies.size(); ++sweep)
                for (const maximal::Link<double>& link : mechanism.links)
                    if (link.is_joint() && link.kind != maximal::Kind::prismatic &&
                        placed[static_cast<std::size_t>(link.from.body)])
                        placed[static_cast<std::size_t>(link.to.body)] = true;
            if (!std::ranges::all_of(placed, [](bool is) { return is; })) return false;
        }
        for (std::size_t k = 0; k + 1 < moments_; ++k)
            for (std::size_t b = 0; b < sound_.scene.bodies.size(); ++b) {
                const Quaternion<double> turn = conjugate(body(sound_, k, b).q) * body(sound_, k + 1, b).q;
                double turned = length(rotation_vector_from_quaternion(turn));
                if (file_.has_angular_velocity)
                    turned = std::max(turned, (time(k + 1) - time(k)) * length(body(sound_, k, b).angular_velocity_B));
                // rows that are further apart cannot be predicted
                if (turned > most_turned_in_step * most_steps) moments_ = k + 1;
                if (k + 1 < moments_) largest_turn_ = std::max(largest_turn_, turned);
            }
        if (moments_ < fewest_moments) return false;
        follow_angles(model);
        const std::size_t stride = std::max<std::size_t>(1, moments_ / 400);
        std::size_t count = 0;
        for (std::size_t k = 0; k + 1 < moments_; k += stride, ++count) {
            const std::vector<double> u = model.velocities(state(sound_, model, k)),
                                      next = model.velocities(state(sound_, model, k + 1));
            scales_.resize(u.size(), 0);
            for (std::size_t i = 0; i < u.size(); ++i)
                scales_[model.vector_of_velocity()[i]] += (next[i] - u[i]) * (next[i] - u[i]);
        }
        for (std::size_t i = 0; i < scales_.size(); ++i) scales_[i] = scales_[model.vector_of_velocity()[i]];
        double largest = 0;
        for (double& scale : scales_)
            scale = std::sqrt(scale / static_cast<double>(count)), largest = std::max(largest, scale);
        // avoids a scale of zero
        for (double& scale : scales_) scale = std::max(scale, 1e-9 * largest);
        return true;
    }

    // Integrates the angles of joints with springs along the file, from the scene's start.
    void follow_angles(const SystemEngine& model) {
        const maximal::Mechanism<double>& mechanism = model.system().mechanism();
        if (mechanism.turns == 0) return;
        std::vector<double> angle(static_cast<std::size_t>(mechanism.turns), 0), rate = angle;
        const auto body_at = [&](const SystemState& s, int b) {
            BodyMotion<double> world;
            world.q = {1, 0, 0, 0};
            return b == mechanism.world() ? world : s.bodies[static_cast<std::size_t>(b)];
        };
        for (std::size_t k = 0; k < moments_; ++k) {
            const SystemState s = state(sound_, model, k);
            for (const maximal::Link<double>& link : mechanism.links) {
                if (link.angles < 0) continue;
                maximal::Placement<double> from, to;
                const BodyMotion<double> a = body_at(s, link.from.body), b = body_at(s, link.to.body);
                from.q = a.q, from.axes = rotation_matrix(a.q), from.angular_velocity_B = a.angular_velocity_B;
                to.q = b.q, to.axes = rotation_matrix(b.q), to.angular_velocity_B = b.angular_velocity_B;
                const std::array<double, 2> now = maximal::LinkView<double, double>(link, from, to).rates();
                for (int i = 0; i < link.coordinates(); ++i) {
                    const std::size_t place = static_cast<std::size_t>(link.angles) + static_cast<std::size_t>(i);
                    const double h = k > 0 ? time(k) - time(k - 1) : time(0);
                    angle[place] =
                        k > 0 ? angle[place] + h * (rate[place] + now[static_cast<std::size_t>(i)]) / 2
                              : link.coordinate[static_cast<std::size_t>(i)] + h * now[static_cast<std::size_t>(i)];
                    rate[place] = now[static_cast<std::size_t>(i)];
                }
                if (link.kind != maximal::Kind::revolute) continue;
                // the attitudes determine the angle up to whole turns
                const Quaternion<double> turn = conjugate(a.q * link.orientation) * b.q;
                const double diagnoses = 2 * std::atan2(dot(link.axes_to[0], vector_part(turn)), turn.w),
                             whole = 2 * std::acos(-1.0);
                double& value = angle[static_cast<std::size_t>(link.angles)];
                value = diagnoses + whole * std::round((value - diagnoses) / whole);
            }
            angles_.push_back(angle);
        }
    }

    // Includes the predicted changes in the scales, for velocities that should change but do not.
    void include_predicted_changes(const SystemEngine& model) {
        std::vector<double> squares(scales_.size(), 0);
        for (const std::size_t k : windows_) {
            const SystemState from = state(sound_, model, k), next = state(sound_, model, k + 1);
            const std::vector<double> was = model.velocities(from),
                                      predictions = model.predicted(from, next, time(k), time(k + 1) - time(k),
                                                                    SystemRule::accurate, accurate_steps());
            for (std::size_t i = 0; i < was.size(); ++i) {
                const double change = predictions[i] - was[i];
                if (std::isfinite(change)) squares[model.vector_of_velocity()[i]] += change * change;
            }
        }
        for (std::size_t i = 0; i < scales_.size(); ++i)
            scales_[i] =
                std::max(scales_[i], std::sqrt(squares[model.vector_of_velocity()[i]] /
                                               static_cast<double>(std::max<std::size_t>(windows_.size(), 1))));
    }

    // Chooses the rows from which the next row is predicted: no events in between, more of them early.
    void choose_windows(const Scene& scene) {
        std::vector<double> events;
        for (const Load& load : scene.loads) {
            const Window w = window_of(load);
            if (const auto* impulse = std::get_if<Impulse>(&load)) events.push_back(impulse->at);
            events.push_back(w.from), events.push_back(w.until);
        }
        const bool has_w = file_.has_angular_velocity;
        const auto is_quiet = [&](std::size_t k) {
            const double from = time(k > 0 && !has_w ? k - 1 : k),
                         to = time(std::min(k + (has_w ? 1 : 2), moments_ - 1));
            return std::ranges::none_of(events, [&](double t) { return from < t && t <= to; });
        };
        const std::size_t first = has_w ? 0 : 1, last = has_w ? moments_ - 1 : moments_ - 2;
        if (last <= first) return;
        // each span between two events gets a number proportional to its length, and at least a few
        std::ranges::sort(events);
        std::erase_if(events, [&](double t) { return !(t > time(first) && t < time(last)); });
        events.erase(std::unique(events.begin(), events.end()), events.end());
        // the time of the search grows with the square of the number of bodies
        const std::size_t bodies = std::max(scene.bodies.size(), most_bodies_of_all_windows),
                          most = std::max(most_system_windows * most_bodies_of_all_windows / bodies, fewest_windows);
        constexpr std::size_t most_spans = 8;
        const std::size_t few = std::min<std::size_t>(6, most);
        if (events.size() >= most_spans) events.resize(most_spans - 1);
        events.push_back(time(last));
        std::size_t begin = first;
        for (const double until : events) {
            std::size_t end = begin;
            while (end < last && time(end) < until) ++end;
            const std::size_t share = most * (end - begin) / (last - first),
                              count = std::min(std::max(share, few), end - begin);
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t k = begin + std::max(i < few / 2 ? i : 0, i * (end - begin) / count);
                if (is_quiet(k)) windows_.push_back(k);
            }
            begin = end;
        }
        std::ranges::sort(windows_);
        windows_.erase(std::unique(windows_.begin(), windows_.end()), windows_.end());
    }

    // Prediction error of attitudes and positions by the file's velocities: the best of new, old and mean velocities.
    double kinematics(const SystemCause& cause) const {
        if (!file_.has_angular_velocity) return 0;
        std::array<double, 3> turned{}, went{};
        std::size_t count = 0;
        for (const std::size_t k : windows_)
            for (std::size_t b = 0; b < cause.scene.bodies.size(); ++b) {
                const BodyMotion<double> now = body(cause, k, b), next = body(cause, k + 1, b);
                const double h = (time(k + 1) - time(k)) * cause.engine.time;
                const Vector turn = rotation_vector_from_quaternion(conjugate(now.q) * next.q);
                const double size = std::max(length(turn), h * length(next.angular_velocity_B)),
                             way = std::max(length(next.position_W - now.position_W), h * length(next.velocity_W));
                if (!(size > 0)) continue;
                ++count;
                for (std::size_t i = 0; i < 3; ++i) {
                    const double part = 0.5 * static_cast<double>(i);
                    const Vector w = (1 - part) * now.angular_velocity_B + part * next.angular_velocity_B,
                                 v = (1 - part) * now.velocity_W + part * next.velocity_W;
                    turned[i] += decades(length(h * w - turn), size, noise_ / size);
                    if (has_place() && file_.has_velocity)
                        went[i] += decades(length(h * v - (next.position_W - now.position_W)), way,
                                           noise_ * length(now.position_W) / std::max(way, 1e-300));
                }
            }
        if (count == 0) return 0;
        return (*std::ranges::min_element(turned) + *std::ranges::min_element(went)) / static_cast<double>(count);
    }

    // Error of the first row against the scene's start, if the file starts at t = 0.
    double start(const SystemCause& cause, const SystemEngine& model) const {
        if (time(0) != 0 || std::ranges::any_of(cause.scene.loads, [](const Load& load) {
                const auto* impulse = std::get_if<Impulse>(&load);
                return impulse != nullptr && impulse->at == 0;
            }))
            return 0;
        double q = 0, w = 0, p = 0, v = 0;
        for (std::size_t b = 0; b < cause.scene.bodies.size(); ++b) {
            const BodyMotion<double> is = body(cause, 0, b);
            const BodyMotion<double>& was = model.start()[b];
            const auto apart = [](const Vector& x, const Vector& y) {
                const double size = std::max(length(x), length(y));
                return size > 0 ? length(x - y) / size : 0;
            };
            q = std::max(q, length(rotation_vector_from_quaternion(conjugate(was.q) * is.q)));
            if (file_.has_angular_velocity) w = std::max(w, apart(is.angular_velocity_B, was.angular_velocity_B));
            if (has_place()) p = std::max(p, apart(is.position_W, was.position_W));
            if (file_.has_velocity) v = std::max(v, apart(is.velocity_W, was.velocity_W));
        }
        // differences below 1e-6 count as a correct start
        const double noise = std::max(1e-6, 3 * noise_);
        return decades(q, 1, noise) + decades(w, 1, noise) + decades(p, 1, noise) + decades(v, 1, noise);
    }
};

class SystemSearch {
  public:
    SystemSearch(const SystemEvidence& evidence, const Scene& scene)
        : evidence_(evidence), hypotheses_(system_faults(scene)), has_loops_(!scene.loops.empty()) {}

    SystemExplanation sound() {
        const SystemEngine model(evidence_.sound());
        // find the number of steps per row for each coarse rule
        updates_ = {{SystemRule::accurate, evidence_.accurate_steps()}};
        for (const SystemRule rule :
             {SystemRule::joint_impulses, SystemRule::joint_impulses_implicit, SystemRule::joint_rates}) {
            std::optional<SystemExplanation> nearest;
            for (const int steps : {1, 2, 4, 8, 10}) {
                const SystemExplanation e{nullptr, 1, rule, steps,
                                          evidence_.prediction_errors(evidence_.sound(), model, rule, steps)};
                if (!nearest || e.errors.total < nearest->errors.total - 0.3) nearest = e;
            }
            updates_.push_back({rule, nearest->steps});
            if (nearest->steps > 1) updates_.push_back({rule, 1});
        }
        return explain({});
    }

    // Tests all faults. Returns them, the best first.
    std::vector<SystemExplanation> singles(const SystemExplanation& sound) const {
        std::vector<SystemExplanation> all;
        for (const SystemHypothesis& h : hypotheses_)
            if (std::optional<SystemExplanation> e = fit_fault({}, h, sound)) all.push_back(*e);
        std::stable_sort(all.begin(), all.end(), is_better);
        return all;
    }
    // Returns the best second fault together with `first`.
    std::optional<SystemExplanation> second(const SystemExplanation& first) const {
        std::optional<SystemExplanation> best;
        for (const SystemHypothesis& h : hypotheses_) {
            if (&h == first.hypothesis || (h.fit && first.hypothesis->fit && h.fault == first.hypothesis->fault))
                continue;
            const std::optional<SystemExplanation> e = fit_fault({first}, h, first);
            if (e && (!best || e->errors.total < best->errors.total)) best = e;
        }
        return best;
    }
    // Refits a fault with other rules and numbers of steps: a faulty file does not show the number of steps.
    SystemExplanation refit_update(const SystemExplanation& fault) const {
        SystemExplanation best = fault;
        SystemCause cause = evidence_.sound();
        if (!apply(cause, fault)) return best;
        const std::optional<SystemEngine> model = make_engine(cause);
        for (const SystemRule rule :
             {SystemRule::joint_impulses, SystemRule::joint_impulses_implicit, SystemRule::joint_rates})
            for (const int steps : {2, 3, 4, 5, 6, 8, 10}) {
                PredictionErrors errors = evidence_.prediction_errors(cause, *model, rule, steps);
                if (errors.total < best.errors.total) best.rule = rule, best.steps = steps, best.errors = errors;
            }
        if (!fault.hypothesis->fit || best.errors.velocities < nearly_exact) return best;
        for (const SystemRule rule : {SystemRule::joint_impulses, SystemRule::joint_rates})
            for (const int steps : {2, 3, 4, 5, 6, 8, 10}) {
                const std::optional<double> x = fitted({}, *fault.hypothesis, {rule, steps});
                if (!x || std::abs(*x - fault.hypothesis->fit->neutral) <= fault.hypothesis->fit->plain) continue;
                for (const double number : {*x, rounded(*x)}) {
                    SystemCause again = evidence_.sound();
                    if (!fault.hypothesis->apply(again, number)) continue;
                    const std::optional<SystemEngine> engine = make_engine(again);
                    if (!engine) continue;
                    PredictionErrors errors = evidence_.prediction_errors(again, *engine, rule, steps);
                    // prefer a number of few digits if it is as good
                    if (!(errors.total < best.errors.total + (number == *x ? 0 : 1e-3))) continue;
                    best.x = number, best.rule = rule, best.steps = steps, best.errors = errors;
                }
                if (best.errors.velocities < nearly_exact) return best;
            }
        return best;
    }
    // Refits the number of a fault together with another fault.
    std::optional<SystemExplanation> refit_with(const SystemExplanation& fault, const SystemExplanation& other) const {
        return fit_fault({other}, *fault.hypothesis, other);
    }
    // Whether the effect of the fault is larger than the difference between accurate and coarse steps.
    bool is_distinct(const SystemExplanation& e, const std::vector<SystemExplanation>& others) const {
        SystemCause with = evidence_.sound(), without = with;
        for (const SystemExplanation& other : others) apply(with, other), apply(without, other);
        apply(with, e);
        const SystemEngine faulty(with), plain(without);
        const std::vector<double> left = evidence_.residuals(with, faulty, e.rule, e.steps),
                                  was = evidence_.residuals(without, plain, e.rule, e.steps),
                                  exact = evidence_.residuals(without, plain, SystemRule::accurate,
                                                              evidence_.accurate_steps()),
                                  coarse = evidence_.residuals(without, plain, SystemRule::joint_rates, 1);
        // geometric means over the steps in which the fault has an effect
        double effect = 0, spread = 0, remains = 0, count = 0, most = 0;
        const auto log_of = [&](double x) {
            return std::isfinite(x) ? std::log10(std::clamp(std::abs(x), finest_change, 2.0)) : std::log10(2.0);
        };
        for (std::size_t i = 0; i < left.size(); ++i)
            if (const double change = std::abs(left[i] - was[i]); std::isfinite(change)) most = std::max(most, change);
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (!(std::abs(left[i] - was[i]) > 0.01 * most)) continue;
            effect += log_of(left[i] - was[i]), spread += log_of(exact[i] - coarse[i]), remains += log_of(left[i]),
                ++count;
        }
        if (count == 0) return false;
        effect /= count, spread /= count, remains /= count;
        // coarse steps have numerical damping, at a rate of some hundredths of h w^2
        const Subject about = e.hypothesis->subject;
        constexpr double lost_by_steps = 0.02, as_if_exact = -5;
        if (e.hypothesis->fit && e.hypothesis->fit->neutral == 0 && remains > as_if_exact &&
            (about == Subject::damping || about == Subject::linear_damping) &&
            e.x / e.hypothesis->fit->trial * damping_trial < lost_by_steps * evidence_.fastest_turn())
            return false;
        // how engines correct loop gaps is not modelled, so a fault must explain more in scenes with loops
        if (remains > effect - (has_loops_ ? 1 : 0.5)) return false;
        return effect > spread + 0.5 || (!has_loops_ && remains < std::min(effect, spread) - 1);
    }
    static bool is_better(const SystemExplanation& a, const SystemExplanation& b) {
        return a.errors.total < b.errors.total;
    }

  private:
    struct Update {
        SystemRule rule;
        int steps;
        bool operator==(const Update&) const = default;
    };
    const SystemEvidence& evidence_;
    std::vector<SystemHypothesis> hypotheses_;
    bool has_loops_;
    std::vector<Update> updates_;

    static bool apply(SystemCause& cause, const SystemExplanation& e) {
        return e.hypothesis == nullptr || e.hypothesis->apply(cause, e.x);
    }
    SystemExplanation explain(const std::vector<SystemExplanation>& faults) const {
        SystemExplanation best;
        SystemCause cause = evidence_.sound();
        for (const SystemExplanation& fault : faults)
            if (!apply(cause, fault)) return best;
        const std::optional<SystemEngine> model = make_engine(cause);
        if (!model) return best;
        for (const Update& u : updates_) {
            PredictionErrors errors = evidence_.prediction_errors(cause, *model, u.rule, u.steps);
            if (!(errors.total < best.errors.total)) continue;
            best.rule = u.rule, best.steps = u.steps, best.errors = errors;
        }
        return best;
    }
    // Returns nothing if the bodies are invalid.
    static std::optional<SystemEngine> make_engine(const SystemCause& cause) {
        try {
            return SystemEngine(cause);
        } catch (const InputError&) {
            return std::nullopt;
        }
    }
    std::optional<SystemExplanation> fit_fault(const std::vector<SystemExplanation>& others, const SystemHypothesis& h,
                                               const SystemExplanation& before) const {
        const auto with = [&](double x) {
            std::vector<SystemExplanation> all = others;
            SystemExplanation e;
            e.hypothesis = &h, e.x = x;
            all.push_back(e);
            SystemExplanation result = explain(all);
            result.hypothesis = &h, result.x = x;
            return result;
        };
        const auto is_finite = [](const SystemExplanation& e) { return std::isfinite(e.errors.total); };
        if (!h.fit) {
            SystemExplanation e = with(1);
            return is_finite(e) ? std::optional(e) : std::nullopt;
        }
        // fit with the best update without the fault, then with the best one with it, then with all others
        std::vector<Update> tried, left = updates_;
        std::optional<SystemExplanation> best;
        Update next{before.rule, before.steps};
        while (true) {
            tried.push_back(next);
            const std::optional<double> x = fitted(others, h, next);
            if (x && std::abs(*x - h.fit->neutral) > h.fit->plain) {
                SystemExplanation e = with(rounded(*x));
                if (SystemExplanation exact = with(*x); is_better(exact, e)) e = exact;
                if (is_finite(e) && (!best || is_better(e, *best))) best = e;
            }
            const auto is_tried = [&](const Update& u) { return std::ranges::find(tried, u) != tried.end(); };
            if (best && !is_tried({best->rule, best->steps})) {
                next = {best->rule, best->steps};
                continue;
            }
            // fit with another update only if the fault gains something and is not exact yet
            if (tried.size() > 1 &&
                (!best || best->errors.total > before.errors.total - 0.3 || best->errors.velocities < nearly_exact))
                break;
            std::erase_if(left, is_tried);
            if (left.empty()) break;
            next = left.front();
        }
        return best;
    }
    // Rounds x to four digits, as for a number set by hand.
    static double rounded(double x) {
        if (x == 0) return x;
        const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 3);
        return std::round(x / unit) * unit;
    }
    // Fits the number by least squares: Gauss-Newton steps with secants.
    std::optional<double> fitted(const std::vector<SystemExplanation>& others, const SystemHypothesis& h,
                                 const Update& u) const {
        const auto residuals = [&](double x) -> std::vector<double> {
            SystemCause cause = evidence_.sound();
            for (const SystemExplanation& other : others)
                if (!apply(cause, other)) return {};
            // the neutral number has no effect
            if (x != h.fit->neutral && !h.apply(cause, x)) return {};
            const std::optional<SystemEngine> model = make_engine(cause);
            return model ? evidence_.residuals(cause, *model, u.rule, u.steps) : std::vector<double>();
        };
        double a = h.fit->neutral, b = h.fit->trial;
        std::vector<double> ra = residuals(a), rb = residuals(b);
        for (int round = 0; round < 8; ++round) {
            if (ra.empty() || rb.size() != ra.size()) return {};
            double slope = 0, along = 0;
            for (std::size_t i = 0; i < ra.size(); ++i) {
                const double d = (rb[i] - ra[i]) / (b - a);
                if (!std::isfinite(d)) return {};
                slope += d * d, along += d * rb[i];
            }
            if (!(slope > 0)) return {};
            double x = std::max(b - along / slope, h.fit->least);
            if (!std::isfinite(x)) return {};
            x = std::min({x, h.fit->most, 1e3 * std::max(std::abs(b), std::abs(h.fit->trial))});
            if (std::abs(x - b) <= 1e-9 * std::abs(x) || std::abs(x - h.fit->neutral) <= h.fit->plain) return x;
            a = b, ra = std::move(rb), b = x, rb = residuals(x);
        }
        return b;
    }
};

std::string describe_system_fault(const SystemExplanation& e) {
    std::string what = e.hypothesis->what;
    if (const std::size_t place = what.find("{}"); place != what.npos)
        what.replace(place, 2, fmt::format("{:.4g}", e.x));
    return what;
}

// A wrong reading of columns must gain more: it also affects start, attitudes and positions.
double required_gain(const SystemExplanation& e) {
    const Subject about = e.hypothesis->subject;
    if (about == Subject::quaternion || about == Subject::axes || about == Subject::rate_columns ||
        about == Subject::lengths)
        return gain_of_reading;
    return e.hypothesis->fit ? fitted_gain : fixed_gain;
}

// Adds a diagnosis with its prediction errors. `before`: without this fault.
void add_diagnosis(std::vector<Diagnosis>& diagnoses, const SystemExplanation& e, const SystemExplanation& before,
                   const std::string& also) {
    const double was = std::pow(10.0, before.errors.velocities), is = std::pow(10.0, e.errors.velocities);
    if (std::ranges::any_of(diagnoses, [&](const Diagnosis& d) {
            return d.fault == e.hypothesis->fault && d.message.starts_with(describe_system_fault(e));
        }))
        return;
    diagnoses.push_back(
        {e.hypothesis->fault,
         fmt::format("{}; {}{} (prediction error of the joint rates per step, relative to their changes: "
                     "{:.2g} with this fault, {:.2g} without)",
                     describe_system_fault(e), e.hypothesis->remedy, also, is, was),
         e.hypothesis->convention, was, is});
}

// Tests pairs of faults and diagnoses the first pair in which both faults are needed.
void diagnose_pair(const SystemSearch& search, const std::vector<SystemExplanation>& singles,
                   const SystemExplanation& sound, std::vector<Diagnosis>& diagnoses) {
    constexpr std::size_t tested_firsts = 4;
    std::vector<SystemExplanation> firsts = singles;
    std::ranges::stable_sort(firsts, {}, [](const SystemExplanation& e) { return e.errors.squares; });
    for (std::size_t i = 0; i < std::min(tested_firsts, firsts.size()); ++i) {
        const SystemExplanation& first = firsts[i];
        if (!(first.errors.squares < sound.errors.squares)) break;
        const std::optional<SystemExplanation> second = search.second(first);
        if (!second || first.errors.total - second->errors.total < fitted_gain) continue;
        // refit the first fault together with the second
        const std::optional<SystemExplanation> again = search.refit_with(first, *second);
        if (!again || sound.errors.total - again->errors.total < required_gain(*again) + required_gain(*second) ||
            !search.is_distinct(*again, {*second}) || !search.is_distinct(*second, {*again}))
            continue;
        add_diagnosis(diagnoses, *again, sound, ""), add_diagnosis(diagnoses, *second, first, "");
        return;
    }
}

// Selects the accepted faults that are nearly as good as the best one, in the order of preference.
std::vector<SystemExplanation> select_near(const std::vector<SystemExplanation>& accepted) {
    // a fixed number is preferred to an equally good fitted one
    const double limit = accepted.front().errors.total + alike_within;
    std::vector<SystemExplanation> near;
    for (const SystemExplanation& e : accepted)
        if (e.errors.total <= limit || (!e.hypothesis->fit && e.errors.total <= limit + 0.5)) near.push_back(e);
    // a wrong size of something in the scene is preferred to something that the scene does not have
    std::ranges::stable_sort(near, {}, [](const SystemExplanation& e) {
        return e.hypothesis->fit ? e.hypothesis->fit->neutral == 0 ? 2 : 1 : 0;
    });
    // gravity on all bodies includes gravity on the one body whose weight matters
    const auto is_gravity = [](const SystemExplanation& e, bool of_body) {
        return e.hypothesis->subject == Subject::gravity &&
               e.hypothesis->fault.starts_with("gravity_on_body") == of_body;
    };
    if (std::ranges::any_of(near, [&](const SystemExplanation& e) { return is_gravity(e, false); }))
        std::erase_if(near, [&](const SystemExplanation& e) { return is_gravity(e, true); });
    return near;
}

// Diagnoses the first fault of `near`, with a second fault or with the faults that are indistinguishable from it: those
// with a prediction error of at most `limit` decades.
void diagnose_single(const SystemSearch& search, const std::vector<SystemExplanation>& near,
                     const SystemExplanation& sound, double limit, std::vector<Diagnosis>& diagnoses) {
    const SystemExplanation& best = near.front();
    const std::optional<SystemExplanation> second = search.second(best);
    if (second && best.errors.total - second->errors.total >= fitted_gain && search.is_distinct(*second, {best})) {
        add_diagnosis(diagnoses, best, sound, ""), add_diagnosis(diagnoses, *second, best, "");
        return;
    }
    std::string also;
    std::vector<const SystemExplanation*> others;
    for (const SystemExplanation& e : near)
        if (&e != &best && e.errors.total <= limit &&
            e.hypothesis->fit.has_value() == best.hypothesis->fit.has_value() && others.size() < 3)
            others.push_back(&e), also += (also.empty() ? "" : "; or ") + describe_system_fault(e);
    add_diagnosis(diagnoses, best, sound, also.empty() ? "" : "; in this file indistinguishable from: " + also);
    for (const SystemExplanation* e : others)
        add_diagnosis(diagnoses, *e, sound, "; in this file indistinguishable from the previous diagnosis");
}

}  // namespace

FileDiagnosis diagnose_system(const Scene& scene, const TrajectoryFile& file, bool all) {
    FileDiagnosis result;
    const SystemEvidence evidence(scene, file);
    const std::vector<Diagnosis> of_joints =
        joint_faults(scene, file, [&](std::size_t k) { return evidence.predicts(k); });
    result.faults = of_joints;
    if (!evidence.has_enough_rows()) return result;
    SystemSearch search(evidence, evidence.sound().scene);
    const SystemExplanation sound = search.sound();
    result.sound = sound.errors.total;
    result.rule = name_of(sound.rule);
    if (!all && sound.errors.largest < plain_change && sound.errors.start < -11 && sound.errors.kinematics < -2)
        return result;
    std::vector<SystemExplanation> singles = search.singles(sound);
    constexpr std::size_t refit_count = 4;
    for (std::size_t i = 0; i < std::min(refit_count, singles.size()); ++i)
        if (sound.errors.total - singles[i].errors.total > 0.3) singles[i] = search.refit_update(singles[i]);
    std::stable_sort(singles.begin(), singles.end(), SystemSearch::is_better);
    for (const SystemExplanation& e : singles)
        result.hypotheses.push_back({e.hypothesis->fault, describe_system_fault(e), e.errors.total});
    // a displaced joint explains the motion of its bodies
    if (std::ranges::any_of(of_joints, [](const Diagnosis& d) {
            return d.fault != "joint_drifts" && d.fault != "joint_limit_where_none";
        }))
        return result;
    std::vector<SystemExplanation> accepted;
    for (const SystemExplanation& e : singles)
        if (sound.errors.total - e.errors.total >= required_gain(e) && search.is_distinct(e, {})) accepted.push_back(e);
    if (accepted.empty())
        diagnose_pair(search, singles, sound, result.faults);
    else
        diagnose_single(search, select_near(accepted), sound, accepted.front().errors.total + alike_within,
                        result.faults);
    return result;
}

}  // namespace polhode
