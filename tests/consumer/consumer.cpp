// What a user does from outside the tree: builds a scene in code and solves it by a method of the library, adds a
// torque and a method of their own. Every result is held against a closed form; exit 1 where one is off.
#include <polhode/polhode.h>

#include <cmath>
#include <cstdio>

using namespace polhode;

namespace {

int faults = 0;

void expect_below(const char* what, double value, double limit) {
    const bool fine = value < limit;
    std::printf("%-58s %.3e %s %.3e\n", what, value, fine ? "<" : "NOT <", limit);
    if (!fine) ++faults;
}

void expect_ok(const char* what, const Trajectory& trajectory) {
    if (trajectory.status == Status::ok) return;
    std::printf("%s: %s: %s\n", what, name_of(trajectory.status), trajectory.message.c_str());
    ++faults;
}

Quaternion<double> rotation(const Vector3<double>& axis, double angle) {
    const double length = std::sqrt(dot(axis, axis)), s = std::sin(angle / 2) / length;
    return {std::cos(angle / 2), s * axis[0], s * axis[1], s * axis[2]};
}

double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
    const Quaternion<double> d = conjugate(a) * b;
    return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::fabs(d.w));
}

// A free symmetric body, I = (A, A, C): L is constant and w_B = L_B / A - n e_z with n = (C - A) w_z / A, so that
// q(t) = exp(L t / A) q(0) exp(-n t e_z) (Landau & Lifshitz, Mechanics, section 33).
constexpr double A = 2, C = 3, duration = 10;
const Vector3<double> initial_rate{0.5, 0, 1};

Scene symmetric_body() {
    Scene scene;
    scene.name = "symmetric";
    scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(A, A, C));
    scene.initial.angular_velocity = initial_rate;
    return scene;
}

Quaternion<double> symmetric_attitude(double t) {
    const Vector3<double> L{A * initial_rate[0], A * initial_rate[1], C * initial_rate[2]};
    const double n = (C - A) * initial_rate[2] / A;
    return rotation(L, std::sqrt(dot(L, L)) / A * t) * rotation(Vector3<double>(0, 0, 1), -n * t);
}

double worst_attitude_error(const Trajectory& trajectory) {
    double worst = trajectory.samples.empty() ? 4 : 0;
    for (const Sample& sample : trajectory.samples)
        worst = std::fmax(worst, angle_between(symmetric_attitude(sample.t), sample.q));
    return worst;
}

// Heun's second-order method, by the library's fixed-step driver: all that a scheme must have.
template <class SystemType>
struct Heun {
    static constexpr int evaluations = 2;
    void step(const SystemType& system, double t, double* y, double h) {
        double k1[SystemType::dimension], k2[SystemType::dimension], middle[SystemType::dimension];
        system.derivative(t, y, k1);
        for (int i = 0; i < SystemType::dimension; ++i) middle[i] = y[i] + h * k1[i];
        system.derivative(t + h, middle, k2);
        for (int i = 0; i < SystemType::dimension; ++i) y[i] += h / 2 * (k1[i] + k2[i]);
    }
};

const Method heun{.name = "heun",
                  .documentation = "Heun's second-order method.",
                  .source = "K. Heun, Z. Math. Phys. 45 (1900) 23",
                  .conserves = "nothing",
                  .control = Control::fixed_step,
                  .order = 2,
                  .solve = march_system<Heun>};

void solve_by_the_library(const char* name) {
    const Method* method = find_method(name);
    if (!method) {
        std::printf("no method %s\n", name);
        ++faults;
        return;
    }
    Settings settings;
    settings.tolerance = 1e-12;
    const Trajectory trajectory = solve(symmetric_body(), *method, settings);
    expect_ok(name, trajectory);
    // at most 1000 steps, each with a local error of up to 1e-12 of each component, adding up linearly
    expect_below(name, worst_attitude_error(trajectory), 1e-9);
}

void add_a_torque() {
    // about a principal axis: I w' = a sin(b t), so w = w0 + a/(b I) (1 - cos b t), and the angle is its integral
    constexpr double a = 0.75, b = 2, w0 = 0.25;
    Scene scene = symmetric_body();
    scene.initial.angular_velocity = {0, 0, w0};
    scene.loads.push_back(
        UserTorque{.name = "motor",
                   .torque_B = [=](const LoadState& state) { return Vector3<double>(0, 0, a * std::sin(b * state.t)); },
                   .window = {}});
    Settings settings;
    settings.step = 1e-3;
    const Trajectory trajectory = solve(scene, heun, settings);
    expect_ok("a torque of one's own", trajectory);
    const Sample& end = trajectory.samples.back();
    const double w = w0 + a / (b * C) * (1 - std::cos(b * duration));
    const double angle = w0 * duration + a / (b * C) * (duration - std::sin(b * duration) / b);
    // the trapezoidal rule's error: T h^2 / 12 max |w''| = 10 * 1e-6 / 12 * a b / C = 4.2e-7 for w, and for the angle
    // at most T times that, plus as much again from |q| and w held linear inside a step
    expect_below("a torque of one's own: rate", std::fabs(end.angular_velocity_B[2] - w), 4.2e-7);
    expect_below("a torque of one's own: angle", angle_between(rotation(Vector3<double>(0, 0, 1), angle), end.q),
                 8.4e-6);
}

void add_a_method() {
    double errors[2];
    for (int i = 0; i < 2; ++i) {
        Settings settings;
        settings.step = i == 0 ? 2e-3 : 1e-3;
        const Trajectory trajectory = solve(symmetric_body(), heun, settings);
        expect_ok("a method of one's own", trajectory);
        errors[i] = worst_attitude_error(trajectory);
    }
    // the next term of the error is h times smaller: a few 1e-3 of the order
    expect_below("a method of one's own: |observed order - 2|", std::fabs(std::log2(errors[0] / errors[1]) - 2), 0.02);
    expect_below("a method of one's own: error at h = 1e-3", errors[1], 1e-4);
}

}  // namespace

int main() {
    solve_by_the_library("odeint_fehlberg78");
    solve_by_the_library("cvode_adams");
    add_a_torque();
    add_a_method();
    return faults == 0 ? 0 : 1;
}
