// The unrolled recurrences against those recorded from the right-hand side, on random bodies under random loads.
#include "integrators/own/rotation_series.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "integrators/series/series.h"
#include "motion/moderate_scene.h"
#include "motion/systems.h"

namespace polhode {
namespace {

constexpr int series_order = 12;
using Narrow = RotationSeries<series_order, LanePair>;
using Wide = RotationSeries<series_order, Lanes8>;

POLHODE_TARGET_AVX2 void expand_avx2(Narrow& series, const PackedRotation& state) { series.expand(state); }
POLHODE_TARGET_AVX512 void expand_avx512(Wide& series, const PackedRotation& state) { series.expand(state); }

struct Form {
    LoadedRotation system;
    void derivative(const truth::Traced<double>* y, truth::Traced<double>* dy) const { system.derivative(0, y, dy); }
};

RC_GTEST_PROP(RotationSeries, HasTheCoefficientsOfTheRightHandSide, ()) {
    Scene scene;
    scene.name = "body", scene.duration = 1;
    scene.body.inertia_B = testing::moderate_inertia();
    scene.body.center_of_mass = testing::moderate_vector();
    scene.initial.angular_velocity = testing::moderate_vector();
    const bool held = *rc::gen::arbitrary<bool>();
    if (held) scene.pivot = Vector3<double>();
    if (*rc::gen::arbitrary<bool>()) scene.loads.push_back(Gravity{testing::moderate_vector(), {}});
    if (*rc::gen::arbitrary<bool>()) scene.loads.push_back(Torque{testing::moderate_vector(), Frame::body, {}});
    if (*rc::gen::arbitrary<bool>()) scene.loads.push_back(Torque{testing::moderate_vector(), Frame::world, {}});
    if (*rc::gen::arbitrary<bool>()) scene.loads.push_back(Drag{{0.1, 0.2, 0.3}, 0, {}});
    if (*rc::gen::arbitrary<bool>()) scene.loads.push_back(Spring{2, {0.6, 0, 0.8, 0}, {}});
    if (*rc::gen::arbitrary<bool>())
        scene.loads.push_back(
            Force{testing::moderate_vector(), Frame::world, testing::moderate_vector(), Frame::body, {}});
    const Problem problem = pose(scene);
    const Segment& segment = problem.segments.front();
    RC_PRE(Narrow::serves(segment.forcing));

    double y[7] = {};
    LoadedRotation(problem).initial(y);
    Narrow series(problem.body.principal_inertia);
    series.set(segment.forcing);
    series.expand(PackedRotation(y));
    const auto same = [&](const auto& other) {
        for (int k = 0; k <= series_order; ++k) {
            for (int i = 0; i < 3; ++i) RC_ASSERT(other.rate(k, i) == series.rate(k, i));
            for (int i = 0; i < 4; ++i) RC_ASSERT(other.attitude(k, i) == series.attitude(k, i));
        }
    };
    if (widest_instruction_set() >= InstructionSet::avx2) {
        Narrow other(problem.body.principal_inertia);
        other.set(segment.forcing);
        expand_avx2(other, PackedRotation(y));
        same(other);
    }
    if (widest_instruction_set() >= InstructionSet::avx512) {
        Wide other(problem.body.principal_inertia);
        other.set(segment.forcing);
        expand_avx512(other, PackedRotation(y));
        same(other);
    }
    truth::Series<double> recorded(truth::record<double>(Form{LoadedRotation(problem, segment)}, 7), series_order);
    recorded.expand(y);
    double growth = 1;  // of the coefficients, and of what rounding makes of them
    for (int k = 0; k <= series_order; ++k) {
        double size = 0;
        for (int i = 0; i < 7; ++i) size = std::max(size, std::abs(recorded.coefficient(i, k)));
        growth = std::max(growth, size);
        for (int i = 0; i < 7; ++i) {
            const double own = i < 3 ? series.rate(k, i) : series.attitude(k, i - 3);
            RC_ASSERT(std::abs(own - recorded.coefficient(i, k)) <= 1e-13 * (k + 1) * growth);
        }
    }
}

}  // namespace
}  // namespace polhode
