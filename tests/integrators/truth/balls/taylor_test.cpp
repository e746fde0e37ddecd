// The proven defect of a Taylor polynomial on motions with closed forms. The proof is necessary: without the
// remainder the exact motion is outside the balls.
#include "integrators/truth/balls/taylor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "integrators/scenes.h"
#include "integrators/truth/balls/flow.h"

namespace polhode::truth {
namespace {

// x' = x^2, z' = x z from (1, 1): both are 1 / (1 - t)
struct Riccati {
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = y[0] * y[0];
        dy[1] = y[0] * y[1];
    }
};

TEST(Defect, OfTheGeometricSeriesIsItsTail) {
    const WorkingPrecision precision(128);
    const int N = 8;
    Series<Ball> series(record<Ball>(Riccati{}, 2), N);
    const Ball start[2] = {Ball(1), Ball(1)};
    series.expand(start);
    const double h = 0.125;
    const std::vector<Bound> d = defect(series.recording(), term_bounds(series, Bound(h))).rate;
    // p = 1 + t + .. + t^N: p^2 - p' = sum over k >= N of (2 N + 1 - k) t^k, largest at h
    double tail = 0;
    for (int k = N; k <= 2 * N; ++k) tail += (2 * N + 1 - k) * std::pow(h, k);
    for (int i = 0; i < 2; ++i) {
        EXPECT_GE(d[i].near(), tail * (1 - 1e-8));
        EXPECT_LT(d[i].near(), tail * (1 + 1e-6));
    }
    const Ball true_end = Ball(1) / Ball(1 - h);
    Ball end[2];
    series.evaluate(Ball(h), end);
    EXPECT_FALSE((true_end - end[0]).contains_zero())
        << "the polynomial alone holds the motion: the test proves nothing";
    // |J| <= 2 x <= 2 / (1 - h) during the step
    const Bound error = exponential(Ball(2 * h) / Ball(1 - h)) * (Bound(h) * d[0]);
    EXPECT_TRUE((true_end - widened(end[0], error)).contains_zero());
}

TEST(SweptBoxes, HoldTheMotionOnTheirPart) {
    const WorkingPrecision precision(128);
    Series<Ball> series(record<Ball>(Riccati{}, 2), 40);
    const Ball start[2] = {Ball(1), Ball(1)};
    series.expand(start);
    const double h = 0.25;
    const TermBounds terms = term_bounds(series, Bound(h));
    const std::vector<Bound> margin(2, Bound(1e-6));
    const auto boxes = swept_boxes(series, terms, Ball(h), margin, 4);
    ASSERT_EQ(boxes.size(), 4u);
    for (int part = 0; part < 4; ++part)
        for (const double t : {part * h / 4, (part + 0.5) * h / 4, (part + 1) * h / 4}) {
            const Ball true_x = Ball(1) / Ball(1 - t);
            EXPECT_TRUE((true_x - boxes[part][0]).contains_zero()) << part << ' ' << t;
            EXPECT_LT(Bound::radius_of(boxes[part][0]).near(), 0.1);
        }
}

TEST(Defect, OfFewTermsHoldsTheirProductsAsWell) {
    const WorkingPrecision precision(128);
    Series<Ball> series(record<Ball>(Riccati{}, 2), 2);
    const Ball start[2] = {Ball(1), Ball(1)};
    series.expand(start);
    // p = 1 + t + t^2: p^2 - p' = 3 t^2 + 2 t^3 + t^4
    const double h = 0.5, missed = 3 * 0.25 + 2 * 0.125 + 0.0625;
    const std::vector<Bound> d = defect(series.recording(), term_bounds(series, Bound(h))).rate;
    for (const Bound& rate : d) {
        EXPECT_GE(rate.near(), missed);
        EXPECT_LT(rate.near(), missed * (1 + 1e-6));
    }
}

TEST(SweptBoxes, HoldThePolynomialToItsLastTerm) {
    const WorkingPrecision precision(128);
    for (const int order : {3, 40}) {
        Series<Ball> series(record<Ball>(Riccati{}, 2), order);
        const Ball start[2] = {Ball(1), Ball(1)};
        series.expand(start);
        const double h = 0.75;
        const auto boxes = swept_boxes(series, term_bounds(series, Bound(h)), Ball(h), std::vector<Bound>(2), 4);
        for (int part = 0; part < 4; ++part)
            for (const double t : {part * h / 4, (part + 0.5) * h / 4, (part + 1) * h / 4}) {
                Ball y[2];
                series.evaluate(Ball(t), y);
                EXPECT_TRUE((y[0] - boxes[part][0]).contains_zero()) << order << ' ' << part << ' ' << t;
            }
    }
}

class EncloseByTaylor : public ::testing::TestWithParam<Carry> {};

// a body rotating about a principal axis with drag: w = w0 e^(-c t / I), angle = w0 I / c (1 - e^(-c t / I))
TEST_P(EncloseByTaylor, HoldsADraggedSpin) {
    const WorkingPrecision precision(192);
    Scene scene;
    scene.name = "dragged";
    scene.duration = 3;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    scene.initial.angular_velocity = {0, 0, 4};
    scene.loads.push_back(Drag{{0.25, 0.5, 0.625}, 0, {}});
    EulerForm<Ball> form(scene);
    std::vector<Ball> y(13);
    form.initial(y.data());
    form.enter(0, y.data());
    const Piece piece{form, 0, 3, {0.7, 3}};
    const Enclosure enclosure = enclose_by_taylor(piece, plan_pieces(pose(scene)).front(), y, GetParam());
    ASSERT_EQ(enclosure.fault, "");
    ASSERT_EQ(enclosure.samples.size(), 2u);
    for (int k = 0; k < 2; ++k) {
        Ball decay, half, c, s;
        arb_exp(decay.raw(), (Ball(piece.sample_times[k]) / Ball(-4)).raw(), 400);
        half = Ball(8) * (Ball(1) - decay);
        arb_sin_cos(s.raw(), c.raw(), half.raw(), 400);
        const std::vector<Ball>& state = enclosure.samples[k];
        EXPECT_TRUE((state[2] - Ball(4) * decay).contains_zero());
        EXPECT_TRUE((state[3] - c).contains_zero());
        EXPECT_TRUE((state[6] - s).contains_zero());
        EXPECT_TRUE((state[4]).contains_zero());
        for (int i = 0; i < 7; ++i) EXPECT_LT(Bound::radius_of(state[i]).near(), 1e-45);
    }
}

TEST_P(EncloseByTaylor, GivesUpWhereErrorsOutgrowThePrecision) {
    const WorkingPrecision precision(64);
    Scene scene;
    scene.name = "separatrix";
    scene.duration = 60;
    scene.body.inertia_B = diagonal(Vector3<double>(3, 4, 6));
    scene.initial.angular_velocity = {2, 0, 1};
    EulerForm<Ball> form(scene);
    std::vector<Ball> y(13);
    form.initial(y.data());
    form.enter(0, y.data());
    const PiecePlan plan = plan_pieces(pose(scene)).front();
    const Enclosure enclosure = enclose_by_taylor({form, 0, 60, {60}}, plan, y, GetParam());
    EXPECT_NE(enclosure.fault.find("64 bits"), std::string::npos) << enclosure.fault;
}

INSTANTIATE_TEST_SUITE_P(Carried, EncloseByTaylor, ::testing::Values(Carry::norm, Carry::parallelepiped),
                         [](const auto& way) { return way.param == Carry::norm ? "norm" : "parallelepiped"; });

// Loss of each error propagation, out of 160 bits, on a fast top over 30 s, where kappa reaches about 2^10. The
// logarithmic norm has lost a hundred bits by then.
TEST(EncloseByTaylorFar, ParallelepipedsLoseWhatTheMotionLoses) {
    const WorkingPrecision precision(160);
    const Scene scene = polhode::testing::heavy_top(30);
    EulerForm<Ball> form(scene);
    std::vector<Ball> y(13);
    form.initial(y.data());
    form.enter(0, y.data());
    const PiecePlan plan = plan_pieces(pose(scene)).front();
    const Piece piece{form, 0, 30, {10, 30}};
    const Enclosure sheared = enclose_by_taylor(piece, plan, y, Carry::parallelepiped);
    ASSERT_EQ(sheared.fault, "");
    double widest = 0;
    for (const Ball& component : sheared.samples[1]) widest = std::max(widest, Bound::radius_of(component).near());
    // 2^-160 times the widening of the defect bounds (2^28), kappa and the rotation of the sets
    EXPECT_LT(widest, 0x1p-100);
    EXPECT_GT(widest, 0x1p-160);
    const Enclosure by_norm = enclose_by_taylor(piece, plan, y, Carry::norm);
    ASSERT_EQ(by_norm.fault, "");
    EXPECT_GT(Bound::radius_of(by_norm.samples[1][0]).near(), 0x1p-60);
    // balls by the other propagation with more bits are inside
    const WorkingPrecision finer(400);
    EulerForm<Ball> fine_form(scene);
    fine_form.initial(y.data());
    fine_form.enter(0, y.data());
    const Enclosure fine = enclose_by_taylor({fine_form, 0, 30, {10, 30}}, plan, y, Carry::norm);
    ASSERT_EQ(fine.fault, "");
    for (int k = 0; k < 2; ++k)
        for (int i = 0; i < 7; ++i)
            EXPECT_TRUE(arb_contains(sheared.samples[k][i].raw(), fine.samples[k][i].raw())) << k << ' ' << i;
}

}  // namespace
}  // namespace polhode::truth
