// Integrates a user-defined first-order system: two masses connected by a spring, free to move along x.
//
//   m1 x1'' = k d,   m2 x2'' = -k d,   d = x2 - x1 - rest
//
// The centre of mass moves uniformly, and d oscillates with w^2 = k (1/m1 + 1/m2). The results are compared with this
// closed form.
#include <polhode/polhode.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "expect.h"
#include "parts.h"

using namespace polhode;

namespace {

constexpr double duration = 10;  // s

/// y = (x1, x2, v1, v2), m and m/s.
struct TwoMasses {
    double k = 7, m1 = 2, m2 = 3, rest = 0.5;  ///< N/m, kg, kg, m
    double stretch = 0.25, speed = 0.125;      ///< at t = 0: d, m, and the speed of the first mass, m/s

    int dimension() const { return 4; }
    void initial(double* y) const { y[0] = 0, y[1] = rest + stretch, y[2] = speed, y[3] = 0; }
    template <class S>
    void derivative(const S* y, S* dy) const {
        const S pull = k * (y[1] - y[0] - rest);
        dy[0] = y[2], dy[1] = y[3], dy[2] = (1 / m1) * pull, dy[3] = (-1 / m2) * pull;
    }
    std::vector<double> scales() const { return {1, 1, 1, 1}; }
    /// Each mass is a body that does not rotate.
    std::vector<Sample> motion(const double* y) const {
        std::vector<Sample> bodies(2);
        for (int i = 0; i < 2; ++i)
            bodies[i].position_W = Vector3<double>(y[i], 0, 0), bodies[i].velocity_W = Vector3<double>(y[2 + i], 0, 0);
        return bodies;
    }

    /// x1 and x2 at time t in closed form, m.
    std::pair<double, double> positions(double t) const {
        const double w = std::sqrt(k * (1 / m1 + 1 / m2)), mass = m1 + m2;
        const double center = (m2 * (rest + stretch) + m1 * speed * t) / mass;
        const double length = rest + stretch * std::cos(w * t) - speed / w * std::sin(w * t);
        return {center - m2 / mass * length, center + m1 / mass * length};
    }
};

}  // namespace

void add_a_system() {
    const TwoMasses model;
    const Problem problem = pose(model, duration);
    for (const char* name : {"cvode_adams", "taylor", "radau"}) {
        Settings settings;
        settings.tolerance = 1e-9;
        const Trajectory trajectory = solve(problem, *find_method(name), settings);
        expect_ok(name, trajectory);
        double worst = trajectory.moments() == static_cast<std::size_t>(settings.samples) + 1 ? 0 : 1;
        for (std::size_t i = 0; i < trajectory.moments(); ++i) {
            const auto bodies = trajectory.at(i);
            const auto [x1, x2] = model.positions(bodies[0].t);
            worst = std::max({worst, std::fabs(bodies[0].position_W[0] - x1), std::fabs(bodies[1].position_W[0] - x2)});
        }
        // The error of a step is at most R in the root mean square of the four components, so 2 R in one component.
        // The oscillation propagates an error unchanged. An error of the speed moves the centre of mass by at most T
        // times this error.
        const double limit = 2 * (1 + duration) * *settings.tolerance * static_cast<double>(trajectory.steps);
        expect_below((std::string("two masses on a spring, m, ") + name).c_str(), worst, limit);
    }
    // `exact` has closed forms only for rigid bodies
    const Trajectory refused = solve(problem, *find_method("exact"));
    expect("two masses on a spring: `exact` is unsupported", refused.status == Status::unsupported);
}
