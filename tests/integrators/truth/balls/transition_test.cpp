// The transition matrix, compared with differences of motions in 400 bits.
#include "integrators/truth/balls/transition.h"

#include <gtest/gtest.h>

#include <vector>

#include "integrators/truth/balls/flow.h"
#include "integrators/truth/loaded_scene.h"
#include "motion/problem.h"

namespace polhode::truth {
namespace {

// the state after `h` by a high-order series, without a proof
std::vector<Ball> flowed(Series<Ball>& series, const std::vector<Ball>& y, const Ball& h) {
    std::vector<Ball> end(y.size());
    series.expand(y.data());
    series.evaluate(h, end.data());
    return end;
}

const Bound anywhere(0x1p40);

// a scene and its initial state as a point
struct Start {
    Scene scene;
    EulerForm<Ball> form;
    std::vector<Ball> point;
    PiecePlan plan;

    explicit Start(const Scene& from)
        : scene(from), form(scene), point(form.dimension()), plan(plan_pieces(pose(scene)).front()) {
        form.initial(point.data());
        form.enter(0, point.data());
        for (Ball& y : point) y = y.midpoint();
    }
    // the norm of initial differences of this size in each variable
    Bound length(const WeightedNorm& norm, double each) const {
        return norm.length(std::vector<Bound>(point.size(), Bound(each)));
    }
};

// y + 2^-60 e_j moves as W(h) 2^-60 e_j predicts, to second order in 2^-60, for every column and load.
TEST(Transition, HoldsWhatNeighbouringMotionsDo) {
    for (const bool pivoted : {true, false}) {
        const WorkingPrecision precision(400);
        const Start start(loaded_scene(3, pivoted));
        const EulerForm<Ball>& form = start.form;
        const std::vector<Ball>& point = start.point;
        const int n = form.dimension();
        const WeightedNorm norm(start.plan);
        Transition transition(record<Ball>(form, n), 40);
        const Ball h(0x1p-5);
        const Bound growth(16.0), nearby = start.length(norm, 0x1p-58);
        transition.expand(point, Bound(h), growth * nearby, growth, anywhere, norm);
        const std::vector<Ball> W = transition.at(h);
        Series<Ball> series(record<Ball>(form, n), 60);
        const std::vector<Ball> end = flowed(series, point, h);
        bool turned = false;
        for (int j = 0; j < n; ++j) {
            const Ball small(0x1p-60);
            std::vector<Ball> moved(point);
            moved[j] += small;
            const std::vector<Ball> there = flowed(series, moved, h);
            for (int i = 0; i < n; ++i) {
                const Ball slope = (there[i] - end[i]) / small;
                const Ball& entry = W[i * n + j];
                // the mean of W along the line between the two starts is inside the entry
                EXPECT_TRUE((slope - entry).contains_zero()) << pivoted << ' ' << i << ' ' << j;
                EXPECT_LT(Bound::radius_of(entry).near(), 1e-9) << i << ' ' << j;
                turned = turned || (i != j && std::abs(entry.near()) > 1e-3);
            }
        }
        EXPECT_TRUE(turned) << "nothing happened";
    }
}

// If the growth is known only for a smaller distance than that of the motions, the entries are not finite.
TEST(Transition, KnowsNothingBeyondWhatIsAllowed) {
    const WorkingPrecision precision(200);
    const Start start(loaded_scene(1, true));
    const WeightedNorm norm(start.plan);
    Transition transition(record<Ball>(start.form, start.form.dimension()), 40);
    const Bound growth(4.0), distance(0x1p-30);
    transition.expand(start.point, Bound(0x1p-6), distance, growth, Bound(0x1p-29), norm);
    EXPECT_TRUE(transition.at(Ball(0x1p-6))[0].is_finite());
    transition.expand(start.point, Bound(0x1p-6), distance, growth, Bound(0x1p-31), norm);
    for (const Ball& entry : transition.at(Ball(0x1p-6))) EXPECT_FALSE(entry.is_finite());
}

// Starts 2^-10 apart: the matrix contains the motion of each and is as wide as their motions differ.
TEST(Transition, WidensWithTheBeginnings) {
    const WorkingPrecision precision(200);
    const Start start(loaded_scene(1, true));
    const EulerForm<Ball>& form = start.form;
    const std::vector<Ball>& point = start.point;
    const WeightedNorm norm(start.plan);
    const Ball h(0x1p-6);
    const double apart = 0x1p-10;
    const Bound growth(4.0);
    const Recording<Ball> equations = record<Ball>(form, form.dimension());
    Transition near(equations, 40), far(equations, 40);
    near.expand(point, Bound(h), growth * start.length(norm, 0x1p-60), growth, anywhere, norm);
    far.expand(point, Bound(h), growth * start.length(norm, apart), growth, anywhere, norm);
    const std::vector<Ball> W = far.at(h);
    std::vector<Ball> elsewhere(point);
    for (Ball& y : elsewhere) y += Ball(apart / 2);
    Transition there(equations, 40);
    there.expand(elsewhere, Bound(h), growth * start.length(norm, 0x1p-60), growth, anywhere, norm);
    const std::vector<Ball> W_near = near.at(h), W_there = there.at(h);
    double widest = 0;
    bool differs = false;
    for (std::size_t i = 0; i < W.size(); ++i) {
        EXPECT_TRUE(arb_contains(W[i].raw(), W_near[i].midpoint().raw()));
        EXPECT_TRUE(arb_contains(W[i].raw(), W_there[i].midpoint().raw()));
        differs = differs || !(W_near[i] - W_there[i]).contains_zero();
        widest = std::max(widest, Bound::radius_of(W[i]).near());
    }
    EXPECT_TRUE(differs) << "the motions near both points are the same: the test proves nothing";
    EXPECT_GT(widest, apart * 1e-3);
    EXPECT_LT(widest, 1);
}

}  // namespace
}  // namespace polhode::truth
