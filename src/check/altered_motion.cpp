#include "check/altered_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "motion/systems.h"

namespace polhode {
namespace {

constexpr int n = FullMotion::dimension;
using State = std::array<double, n>;

// The tensor as written, with the gyroscopic term times a factor and a damping of the engine's own.
struct AlteredInertia {
    FullInertia<double> inertia;
    double gyroscopic, damping;

    Vector3<double> angular_acceleration(const Vector3<double>& w, const Vector3<double>& tau) const {
        return inertia.inverse * (tau + gyroscopic * cross(inertia.tensor * w, w)) - damping * w;
    }
};

class Run {
  public:
    Run(const Scene& scene, const Alteration& alteration)
        : problem_(pose(scene, Formulation::full)),
          alteration_(alteration),
          inertia_{problem_.full_inertia, alteration.gyroscopic, alteration.damping},
          system_(problem_) {
        system_.initial(y_.data());
        system_.scales(scales_.data());
    }

    std::vector<Sample> samples_at(const std::vector<double>& times) {
        std::vector<Sample> samples;
        SampleQueue queue(times);
        const auto begin = [&](const Segment& segment) {
            system_.enter(segment, y_.data());
            limit();
            return true;
        };
        const auto show = [&](double t) {
            samples.push_back(system_.motion(t, y_.data()));
            return true;
        };
        const auto go = [&](const Segment& segment) {
            double t = segment.begin;
            for (; queue.in(segment); queue.pop())
                if (!march(t, queue.front()) || !show(queue.front())) return false;
            return !queue.empty() && march(t, segment.end);
        };
        follow(problem_.segments, queue, begin, show, go);
        return samples;
    }

  private:
    Problem problem_;
    Alteration alteration_;
    AlteredInertia inertia_;
    FullMotion system_;
    State y_{}, scales_{};
    double step_ = 0;
    long steps_ = 0;

    State rate(double t, const State& y) const {
        State dy{};
        LoadedEquations<double, AlteredInertia, true>{inertia_, system_.forcing}.derivative(t, y.data(), dy.data());
        if (!system_.forcing->pivoted)
            FullMotion::set_translation(
                dy.data(), FullMotion::position(dy.data()),
                FullMotion::velocity(dy.data()) - alteration_.linear_damping * FullMotion::velocity(y.data()));
        return dy;
    }

    void limit() {
        const Vector3<double> w = FullMotion::angular_velocity(y_.data());
        const double speed = std::sqrt(dot(w, w));
        if (speed > alteration_.speed_limit)
            FullMotion::set_rotation(y_.data(), (alteration_.speed_limit / speed) * w, FullMotion::attitude(y_.data()));
    }

    // y at `end`; false where that takes too many steps or is not finite
    bool march(double& t, double end) {
        constexpr double tolerance = 1e-9;
        constexpr long most_steps = 20'000;
        const Scales& scales = problem_.scales;
        if (step_ == 0) step_ = 1e-3 / std::max(scales.angular_velocity, 1e-3);
        while (t < end) {
            if (++steps_ > most_steps) return false;
            const bool to_end = end - t <= step_;
            const double h = to_end ? end - t : step_;
            State next{};
            const double error = attempt(t, h, next) / tolerance;
            if (!std::isfinite(error) && !(h > 1e-12 * end)) return false;
            const double factor = std::isfinite(error) ? 0.9 * std::pow(std::max(error, 1e-10), -0.2) : 0.1;
            const double proposed = h * std::clamp(factor, 0.2, 4.0);
            if (!(error <= 1)) {
                step_ = proposed;
                continue;
            }
            // a step cut short by a sample says little of the one that could be taken
            step_ = to_end ? std::max(step_, proposed) : proposed;
            // a limit is felt at the ends of steps only
            if (std::isfinite(alteration_.speed_limit)) step_ = std::min(step_, 0.02 / alteration_.speed_limit);
            y_ = next;
            limit();
            const Quaternion<double> q = FullMotion::attitude(y_.data());
            if (const double norm = std::sqrt(squared_norm(q)); norm > 0)
                FullMotion::set_rotation(y_.data(), FullMotion::angular_velocity(y_.data()),
                                         {q.w / norm, q.x / norm, q.y / norm, q.z / norm});
            t = to_end ? end : t + h;
        }
        return true;
    }

    // one step of the pair; returns the largest difference of the two over its scale
    double attempt(double t, double h, State& next) const {
        constexpr int stages = 7;
        constexpr double c[stages] = {0, 0.2, 0.3, 0.8, 8.0 / 9, 1, 1};
        constexpr double a[stages][6] = {{},
                                         {1.0 / 5},
                                         {3.0 / 40, 9.0 / 40},
                                         {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                         {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                         {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                         {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
        constexpr double e[stages] = {71.0 / 57600,        0,          -71.0 / 16695, 71.0 / 1920,
                                      -17253.0 / 339200.0, 22.0 / 525, -1.0 / 40};
        State k[stages];
        for (int s = 0; s < stages; ++s) {
            State y = y_;
            for (int j = 0; j < s; ++j)
                for (int i = 0; i < n; ++i) y[i] += h * a[s][j] * k[j][i];
            k[s] = rate(t + c[s] * h, y);
            next = y;  // the last stage stands at the step's end
        }
        double largest = 0;
        for (int i = 0; i < n; ++i) {
            double difference = 0;
            for (int s = 0; s < stages; ++s) difference += h * e[s] * k[s][i];
            // a NaN is the largest of all
            if (const double ratio = std::abs(difference) / std::max(scales_[i], 1e-300); !(ratio <= largest))
                largest = ratio;
        }
        return largest;
    }
};

}  // namespace

std::vector<Sample> altered_motion(const Scene& scene, const Alteration& alteration, const std::vector<double>& times) {
    Scene timed = scene;
    if (!times.empty() && times.back() > 0) timed.duration = times.back();
    validate(timed, timed.name);
    return Run(timed, alteration).samples_at(times);
}

}  // namespace polhode
