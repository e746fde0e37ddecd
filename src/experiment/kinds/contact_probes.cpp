// Motions with contact whose result is known in closed form (contact_probes.h).
//
// Each motion is a scene of the catalogue with another start, load or coefficient (make_ball(), make_block()). run()
// solves it with the method and returns an empty list of samples if it does not complete.
#include "experiment/kinds/contact_probes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr double earth_gravity = 9.81;  // m/s^2
constexpr double ball_friction = 0.25, block_friction = 0.5;
constexpr double ball_speed = 4;     // m/s
constexpr double slide_time = 0.25;  // s; the ball rolls from 2 v / (7 mu g) = 0.47 s on
constexpr double hold_time = 2;      // s
constexpr double roll_time = 2;      // s
constexpr double rest_time = 5;      // s
constexpr double slow_speed = 0.05;  // m/s
constexpr double slow_time = 4;      // s
constexpr double bounce_restitution = 0.8;
constexpr double fall_height = 1;  // m
constexpr double radians_per_degree = std::numbers::pi / 180;

// A catalogue scene with gravity as its only load and the coefficients of its planes replaced.
Scene make_scene(const char* name, const Vector3<double>& gravity, double friction, double e) {
    Scene scene = find_scene(name);
    scene.loads = {Gravity{gravity, {}}};
    for (Plane& plane : scene.planes) plane.friction = friction, plane.restitution = e;
    return scene;
}
// A solid ball of radius 0.25 m at rest on a level plane.
Scene make_ball(double friction, double e = 0, const Vector3<double>& gravity = {0, 0, -earth_gravity}) {
    return make_scene("contact/ball_incline_rolls", gravity, friction, e);
}
// A flat block at rest on a plane with the slope's angle.
Scene make_block(double friction, double angle) {
    Scene scene = make_scene("contact/block_on_ramp",
                             {earth_gravity * std::sin(angle), 0, -earth_gravity * std::cos(angle)}, friction, 0);
    scene.initial.velocity_W = {};
    return scene;
}

/// Runs scenes with one method and step.
class Prober {
  public:
    Prober(const Method& method, double step) : method_(&method), step_(step) {}

    // The run of a scene, without samples if it was not completed.
    Trajectory run(Scene scene, double duration, long samples = 1) const {
        scene.duration = duration;
        Settings settings;
        settings.step = step_, settings.samples = samples, settings.seconds_limit = 10;
        Trajectory trajectory = solve(scene, *method_, settings);
        if (trajectory.status != Status::ok) trajectory.samples.clear();
        return trajectory;
    }
    std::optional<Sample> end(const Scene& scene, double duration) const {
        const Trajectory trajectory = run(scene, duration);
        return trajectory.samples.empty() ? std::nullopt : std::optional(trajectory.samples.back());
    }
    long steps_in(double duration) const { return std::lround(duration / step_); }

  private:
    const Method* method_;
    double step_;
};

void probe_sliding(const Prober& prober, ContactProbe& probe) {
    double deviation = 0;
    for (const double angle : probe_angles) {
        Scene scene = make_ball(ball_friction);
        scene.initial.velocity_W =
            ball_speed * Vector3<double>(std::cos(angle * radians_per_degree), std::sin(angle * radians_per_degree), 0);
        const Trajectory trajectory = prober.run(scene, slide_time);
        if (trajectory.samples.empty()) {
            probe.fault = trajectory.message, probe.friction.clear();
            return;
        }
        const Vector3<double> v = trajectory.samples.back().velocity_W;
        probe.friction.push_back((ball_speed - std::hypot(v[0], v[1])) / (ball_friction * earth_gravity * slide_time));
        deviation = std::max(deviation, std::abs(std::atan2(v[1], v[0]) / radians_per_degree - angle));
    }
    probe.deviation = deviation;
}

void probe_static_friction(const Prober& prober, ContactProbe& probe) {
    const auto path = [&](double fraction) -> std::optional<double> {
        const auto end = prober.end(make_block(block_friction, std::atan(fraction * block_friction)), hold_time);
        return end ? std::optional(end->position_W[0]) : std::nullopt;
    };
    probe.held = path(0.99);
    if (probe.held) probe.held = std::abs(*probe.held);
    if (const auto x = path(1.01)) {
        const double a = std::atan(1.01 * block_friction);
        probe.slipped = *x / (earth_gravity * (std::sin(a) - block_friction * std::cos(a)) * hold_time * hold_time / 2);
    }
}

// SimBenchmark pushes 35 kg, of which friction can hold 137 N, by 150 N. The block has the same force per mass.
void probe_push(const Prober& prober, ContactProbe& probe) {
    constexpr double acceleration = 150.0 / 35, friction = 0.4;
    Scene scene = make_block(friction, 0);
    const double force = scene.body.mass * acceleration;
    scene.loads.push_back(Force{
        force * std::numbers::sqrt2 / 2 * Vector3<double>(1, 1, 0), Frame::world, {0, 0, -0.125}, Frame::body, {}});
    if (const auto end = prober.end(scene, 1)) {
        const Vector3<double>& v = end->velocity_W;
        probe.pushed = std::hypot(v[0], v[1]) / (acceleration - friction * earth_gravity);
    }
}

void probe_rolling(const Prober& prober, ContactProbe& probe) {
    const double angle = std::atan(0.5);
    const Scene incline = make_ball(1, 0, {earth_gravity * std::sin(angle), 0, -earth_gravity * std::cos(angle)});
    if (const auto end = prober.end(incline, roll_time))
        probe.rolling = end->velocity_W[0] / (5.0 / 7 * earth_gravity * std::sin(angle) * roll_time);
    Scene slow = make_ball(block_friction);
    slow.initial.velocity_W = {slow_speed, 0, 0}, slow.initial.angular_velocity = {0, slow_speed / 0.25, 0};
    if (const auto end = prober.end(slow, slow_time)) probe.slow_path = end->position_W[0] / (slow_speed * slow_time);
}

// Heights between impacts, over the height of the fall.
std::vector<double> measure_bounces(const std::vector<Sample>& samples, double radius) {
    std::vector<double> heights;
    double speed_before = -1;
    for (const Sample& s : samples) {
        const double speed = s.velocity_W[2];
        if (speed_before <= 0 && speed > 0) heights.push_back(0);
        if (!heights.empty()) heights.back() = std::max(heights.back(), (s.position_W[2] - radius) / fall_height);
        speed_before = speed;
    }
    return heights;
}

void probe_bounces(const Prober& prober, ContactProbe& probe) {
    Scene scene = make_ball(block_friction, bounce_restitution);
    const double radius = scene.initial.position_W[2];
    scene.initial.position_W[2] = radius + fall_height;
    const double duration = 3.5;  // s; the sixth impact of the exact motion is at 2.98 s
    const Trajectory trajectory = prober.run(scene, duration, prober.steps_in(duration));
    if (trajectory.samples.empty()) return;
    const std::vector<double> heights = measure_bounces(trajectory.samples, radius);
    probe.first_bounce = heights.empty() ? 0 : heights[0];
    probe.fifth_bounce = heights.size() < 5 ? 0 : heights[4];
}

// On a slope, because a scene without any motion has no scale of energy, which the detection of divergence needs.
void probe_rest(const Prober& prober, ContactProbe& probe) {
    const Scene scene = make_block(block_friction, std::atan(block_friction / 2));
    const auto end = prober.end(scene, rest_time);
    if (!end) return;
    probe.drift = std::hypot(end->position_W[0], end->position_W[1]);
    probe.depth = scene.initial.position_W[2] - end->position_W[2];
}

void probe_disc(const Prober& prober, ContactProbe& probe) {
    const Scene scene = find_scene("contact/eulers_disc");
    if (const auto end = prober.end(scene, scene.duration))
        probe.disc_height = end->position_W[2] / scene.initial.position_W[2];
}

// The first time at which the spin about the vertical changes its sign.
std::optional<double> reversal_time(const std::vector<Sample>& samples) {
    const auto spin = [](const Sample& s) { return rotate(normalized(s.q), s.angular_velocity_B)[2]; };
    for (std::size_t k = 1; k < samples.size(); ++k) {
        const double before = spin(samples[k - 1]), after = spin(samples[k]);
        if (before > 0 && after <= 0)
            return samples[k - 1].t + (samples[k].t - samples[k - 1].t) * before / (before - after);
    }
    return {};
}

void probe_rattleback(const Prober& prober, ContactProbe& probe) {
    const Scene scene = find_scene("contact/rattleback");
    const Trajectory trajectory = prober.run(scene, scene.duration, prober.steps_in(scene.duration));
    if (trajectory.samples.empty()) return;
    probe.reversal = reversal_time(trajectory.samples);
    probe.keeps_spin = !probe.reversal;
}

// Solved by `taylor`, which follows contact from event to event.
Trajectory solve_with_taylor(const Scene& scene, long samples) {
    Settings settings;
    settings.tolerance = 1e-12, settings.samples = samples;
    return solve(scene, *find_method("taylor"), settings);
}

// The direction of the object ball's velocity, degrees.
std::optional<double> object_direction(const Trajectory& trajectory) {
    if (trajectory.samples.empty() || trajectory.bodies != 2) return {};
    const Vector3<double>& v = trajectory.samples.back().velocity_W;
    if (v[0] == 0 && v[1] == 0) return {};
    return std::atan2(v[1], v[0]) / radians_per_degree;
}

void probe_throw(const Prober& prober, ContactProbe& probe) {
    Scene scene = find_scene("contact/billiard_throw");
    scene.duration = 0.1;
    static const std::optional<double> exact = object_direction(solve_with_taylor(scene, 1));
    const std::optional<double> direction = object_direction(prober.run(scene, scene.duration));
    if (exact && direction) probe.throw_error = *direction - *exact;
}

// The path of a block over the time T, and its velocity at the end.
struct BlockMotion {
    Vector3<double> path_W, velocity_W;
    std::string fault;
};
BlockMotion move_block(Scene scene, const Method& method, Settings settings) {
    scene.duration = 1;
    settings.samples = 1, settings.seconds_limit = 20;
    const Trajectory run = solve(scene, method, settings);
    if (run.status != Status::ok) return {{}, {}, run.message.empty() ? "not followed" : run.message};
    return {run.samples.back().position_W - scene.initial.position_W, run.samples.back().velocity_W, ""};
}
// The angle between a vector in the plane and its direction without error, degrees.
double direction_error(const Vector3<double>& v, const Vector3<double>& exact) {
    return std::atan2(exact[0] * v[1] - exact[1] * v[0], exact[0] * v[0] + exact[1] * v[1]) / radians_per_degree;
}

DirectionProbe probe_direction(const Method& method, const Settings& settings, double angle) {
    constexpr double speed = 2, ratio = 1.25, least_path = 1e-3;  // m/s, of mu m g, m
    const double weight = block_friction * earth_gravity;         // mu g, m/s^2
    const Vector3<double> direction(std::cos(angle * radians_per_degree), std::sin(angle * radians_per_degree), 0);
    DirectionProbe probe;
    Scene scene = make_block(block_friction, 0);
    const Vector3<double> bottom(0, 0, -scene.initial.position_W[2]);
    scene.initial.velocity_W = speed * direction;
    const BlockMotion slid = move_block(scene, method, settings);
    probe.fault = slid.fault;
    if (slid.fault.empty()) {
        probe.distance = std::hypot(slid.path_W[0], slid.path_W[1]) / (speed * speed / (2 * weight));
        probe.distance_direction = direction_error(slid.path_W, direction);
    }
    scene.initial.velocity_W = {};
    scene.loads.push_back(Force{scene.body.mass * ratio * weight * direction, Frame::world, bottom, Frame::body, {}});
    const BlockMotion pushed = move_block(scene, method, settings);
    if (probe.fault.empty()) probe.fault = pushed.fault;
    if (pushed.fault.empty()) {
        probe.pushed = std::hypot(pushed.velocity_W[0], pushed.velocity_W[1]) / ((ratio - 1) * weight);
        if (std::hypot(pushed.path_W[0], pushed.path_W[1]) > least_path)
            probe.pushed_direction = direction_error(pushed.path_W, direction);
    }
    return probe;
}

}  // namespace

std::vector<DirectionProbe> probe_directions(const Method& method, const Settings& settings) {
    std::vector<DirectionProbe> probes;
    for (const double angle : direction_angles) probes.push_back(probe_direction(method, settings, angle));
    return probes;
}

ContactProbe probe_contact(const Method& method, double step) {
    ContactProbe probe;
    const Prober prober(method, step);
    probe_sliding(prober, probe);
    if (probe.friction.empty()) return probe;
    probe_static_friction(prober, probe);
    probe_push(prober, probe);
    probe_rolling(prober, probe);
    probe_bounces(prober, probe);
    probe_rest(prober, probe);
    probe_disc(prober, probe);
    probe_rattleback(prober, probe);
    probe_throw(prober, probe);
    return probe;
}

double exact_bounce(int impacts) { return std::pow(bounce_restitution, 2 * impacts); }

std::optional<double> exact_reversal() {
    static const std::optional<double> time =
        reversal_time(solve_with_taylor(find_scene("contact/rattleback"), 1000).samples);
    return time;
}

std::string describe_cone(const ContactProbe& probe) {
    if (probe.friction.empty()) return "";
    // a ball that rolls from the start lost 2/7 of its speed
    const double rolls = 2.0 / 7 * ball_speed / (ball_friction * earth_gravity * slide_time);
    const auto [least, most] = std::ranges::minmax(probe.friction);
    if (least > 0.9 * rolls) return "no limit: rolls at once";
    const double diagonal = probe.friction[3] / ((probe.friction.front() + probe.friction.back()) / 2);
    if (most < 1.05 * least && probe.deviation && *probe.deviation < 1) return "cone";
    return fmt::format("pyramid, {:.2f} at 45 degrees", diagonal);
}

std::string describe_hold(const ContactProbe& probe) {
    if (!probe.held || !probe.slipped) return "";
    // at 1.01 the exact path is 0.088 m
    constexpr double creep = 0.02;  // m in 2 s
    const char* held = *probe.held < 1e-3 ? "holds" : *probe.held < creep ? "creeps" : "slips";
    const char* slipped = *probe.slipped < 0.1 ? "holds" : *probe.slipped < 0.5 ? "creeps" : "slips";
    return fmt::format("{}, {}", held, slipped);
}

}  // namespace polhode
