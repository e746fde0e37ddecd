// An enclosure of strongly damped motion, compared with its closed form.
#include <gtest/gtest.h>

#include "integrators/truth/balls/flow.h"

namespace polhode::truth {
namespace {

// w about z tends to torque / drag = 1/2 at the rate 10^6 / 2: w = (1 + e) / 2 with e = exp(-t 10^6 / 2), and the
// angle is t / 2 + 10^-6 (1 - e)
TEST(EncloseByCollocation, HoldsAStiffSpin) {
    const WorkingPrecision precision(136);
    Scene scene;
    scene.name = "stiff";
    scene.duration = 100;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1.5, 2));
    scene.initial.angular_velocity = {0, 0, 1};
    scene.loads.push_back(Drag{{1e6, 1e6, 1e6}, 0, {}});
    scene.loads.push_back(Torque{{0, 0, 5e5}, Frame::body, {}});
    EulerForm<Ball> form(scene);
    std::vector<Ball> y(13);
    form.initial(y.data());
    form.enter(0, y.data());
    const Piece piece{form, 0, 100, {0x1p-20, 50, 100}};
    const PiecePlan plan = plan_pieces(pose(scene)).front();
    EXPECT_GT(plan.damping_number, 1e7);
    const Enclosure enclosure = enclose_by_collocation(scene, piece, plan, y);
    ASSERT_EQ(enclosure.fault, "");
    EXPECT_LT(enclosure.steps, 2000);
    ASSERT_EQ(enclosure.samples.size(), 3u);
    for (int k = 0; k < 3; ++k) {
        const Ball t(piece.sample_times[k]);
        Ball e, s, c;
        arb_exp(e.raw(), (t * Ball(-5e5)).raw(), 400);
        const Ball half = (t / Ball(2) + (Ball(1) - e) / Ball(1'000'000)) / Ball(2);
        arb_sin_cos(s.raw(), c.raw(), half.raw(), 400);
        const std::vector<Ball>& state = enclosure.samples[k];
        EXPECT_TRUE((state[2] - (Ball(1) + e) / Ball(2)).contains_zero()) << k;
        EXPECT_TRUE((state[3] - c).contains_zero()) << k;
        EXPECT_TRUE((state[6] - s).contains_zero()) << k;
        for (int i = 0; i < 7; ++i) EXPECT_LT(Bound::radius_of(state[i]).near(), 1e-25) << k << ' ' << i;
    }
}

}  // namespace
}  // namespace polhode::truth
