#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "experiment/kinds/findings_read.h"
#include "experiment/kinds/stability.h"
#include "integrators/analysis/linear_stability.h"

namespace polhode {
namespace {

// The eigenvalue of drag is real: h lambda below the method's real interval is stable, beyond it all runs diverge.
// Unsupported methods have no rows.
TEST(StepMaps, GrowBeyondTheLinearLimitAlone) {
    const Method* const chosen[] = {find_method("odeint_euler"), find_method("gyroscopic_explicit"),
                                    find_method("exact")};
    const Findings result = run_step_maps(chosen, 2, true);
    const Table& maps = table_of(result, "maps");
    int below = 0, beyond = 0;
    std::set<std::string> seen;
    for (const std::vector<Cell>& row : maps.rows) {
        const std::string name = word(maps, row, "method"), outcome = word(maps, row, "outcome");
        seen.insert(name);
        if (word(maps, row, "map") != "stiffness") continue;
        const double limit = *real_interval(*find_method(name)), x = number(maps, row, "x");
        if (x * number(maps, row, "step_largest") < 0.95 * limit) {
            EXPECT_TRUE(outcome == "accurate" || outcome == "close" || outcome == "wrong but bounded") << name << x;
            ++below;
        }
        // for h lambda >= 10 the motion diverges within the first two steps
        if (x * number(maps, row, "step_least") >= 10) {
            EXPECT_EQ(outcome, "diverged") << name << x;
            ++beyond;
        }
    }
    EXPECT_EQ(seen, (std::set<std::string>{"odeint_euler", "gyroscopic_explicit"}));
    EXPECT_GT(below, 3);
    EXPECT_GT(beyond, 10);

    // the explicit update adds the energy h^2/2 (dw/dt . I dw/dt) per step and never removes any
    const Table& gyroscopic = table_of(result, "gyroscopic");
    ASSERT_EQ(gyroscopic.rows.size(), 1u);
    EXPECT_TRUE(std::holds_alternative<std::monostate>(gyroscopic.rows[0][column_index(gyroscopic, "damps_from")]));
    EXPECT_GT(number(gyroscopic, gyroscopic.rows[0], "gains_from"), 0);

    ASSERT_EQ(result.figures.size(), 2u);
    for (const NamedFigure& named : result.figures) {
        EXPECT_TRUE(named.figure.shared_axes);
        ASSERT_EQ(named.figure.panels.size(), 2u);
        for (const Panel& panel : named.figure.panels)
            EXPECT_EQ(panel.map->cells.size(), panel.map->x.size() * panel.map->y.size());
    }
}

// the boundary of Euler's stability region is the circle |z + 1| = 1; the upper half is drawn
TEST(StabilityRegions, DrawEulersCircle) {
    const std::vector<NamedFigure> figures = draw_stability_regions({});
    ASSERT_EQ(figures.size(), 2u);
    std::size_t points = 0;
    for (const Panel& panel : figures[0].figure.panels)
        for (const Curve& curve : panel.curves) {
            if (!curve.label.starts_with("odeint_euler")) continue;
            for (std::size_t i = 0; i < curve.x.size(); ++i, ++points)
                EXPECT_NEAR(std::hypot(curve.x[i] + 1, curve.y[i]), 1, 1e-8);
        }
    EXPECT_GT(points, 50u);
}

TEST(StabilityRegions, MarkTheEigenvaluesOfScenes) {
    PlannedScene scene;
    scene.label = "slowed";
    scene.scene.duration = 1;
    scene.scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 2));
    scene.scene.initial.angular_velocity = {0, 0, 1};
    Drag drag;
    drag.rotational = {0, 0, 200};
    scene.scene.loads.emplace_back(drag);
    // eigenvalues: -c/I = -100/s, and +-i/2 1/s from the attitude
    const std::vector<NamedFigure> figures = draw_stability_regions({&scene, 1});
    for (const Panel& panel : figures[0].figure.panels) {
        const Curve& points = panel.curves.back();
        EXPECT_EQ(points.label, "slowed, h = 0.02 s");
        EXPECT_FALSE(points.line);
        ASSERT_FALSE(points.x.empty());
        double least = 0, highest = 0;
        for (std::size_t i = 0; i < points.x.size(); ++i)
            least = std::min(least, points.x[i]), highest = std::max(highest, points.y[i]);
        EXPECT_NEAR(least, -2, 1e-9);
        EXPECT_NEAR(highest, 0.01, 1e-6);
    }
}

}  // namespace
}  // namespace polhode
