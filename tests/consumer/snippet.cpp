// Checks the order of the method shown in integrators/README.md, which is compiled as another file of this program.
#include <polhode/polhode.h>

#include <cmath>
#include <cstdio>

namespace polhode {
extern const std::span<const Method> midpoint_methods;
}

int main() {
    polhode::Scene scene = polhode::find_scene("lagrange_top");
    scene.duration = 1;
    double errors[2];
    for (int i = 0; i < 2; ++i) {
        polhode::Settings settings;
        settings.step = i == 0 ? 2e-3 : 1e-3;
        const polhode::Trajectory run = polhode::solve(scene, polhode::midpoint_methods[0], settings);
        if (run.status != polhode::Status::ok) return 1;
        polhode::Settings accurate;
        const polhode::Trajectory truth = polhode::solve(scene, *polhode::find_method("exact"), accurate);
        const polhode::Quaternion<double> a = run.samples.back().q, b = truth.samples.back().q;
        errors[i] = std::acos(std::fmin(1, std::fabs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z) /
                                               std::sqrt(squared_norm(a) * squared_norm(b))));
    }
    const double order = std::log2(errors[0] / errors[1]);
    std::printf("observed order %.3f\n", order);
    return std::fabs(order - 2) < 0.1 ? 0 : 1;
}
