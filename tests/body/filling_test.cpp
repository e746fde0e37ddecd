// Sums over the points that fill a shape, compared with the closed forms of its volume, centre of mass and inertia.
#include "body/filling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace polhode {
namespace {

const Shape solids[] = {Box{{0.5, 1.25, 2}},
                        SolidSphere{1.5},
                        HollowSphere{1.5, 1},
                        Cylinder{0.75, 2},
                        HollowCylinder{1.5, 0.5, 0.75},
                        Capsule{0.5, 0.75},
                        Cone{1, 2},
                        Ellipsoid{{0.5, 1, 1.5}},
                        Torus{1.5, 0.5},
                        Tetrahedron{{{{0, 0, 0}, {2, 0.25, 0}, {0.25, 1.5, 0}, {0.5, 0.25, 1.75}}}},
                        Frustum{1.25, 0.5, 1.5},
                        Frustum{0.25, 1, 2}};

// The error comes from cells cut by the surface: at most 2 % of the size and of the largest moment as measured.
void expect_fills(const std::vector<PointMass<double>>& points, const Shape& shape, double tolerance) {
    const MassProperties<double> sum = body_from_points(points), whole = body_from_mass<double>(shape, 3);
    EXPECT_NEAR(sum.mass, 3, 1e-11);
    const double size = std::max({whole.inertia[0][0], whole.inertia[1][1], whole.inertia[2][2]});
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(sum.center[i], whole.center[i], tolerance * std::sqrt(size / 3)) << shape.index();
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(sum.inertia[i][j], whole.inertia[i][j], tolerance * size) << shape.index() << ' ' << i << j;
    }
}

TEST(Filling, OfAGridHasTheVolumeAndTheMomentsOfTheShape) {
    constexpr int n = 32;
    for (const Shape& shape : solids) {
        const auto points = grid_points(shape, 3, n);
        const Bounds box = bounds(shape);
        double cell = 1;
        for (int i = 0; i < 3; ++i) {
            const double width = (box.high[i] - box.low[i]) / n;
            cell *= width;
            // the box is tight: the shape touches every face, possibly only at a corner
            double low = box.high[i], high = box.low[i];
            for (const PointMass<double>& point : points)
                low = std::min(low, point.position[i]), high = std::max(high, point.position[i]);
            EXPECT_LE(low, box.low[i] + 4 * width) << shape.index() << ' ' << i;
            EXPECT_GE(high, box.high[i] - 4 * width) << shape.index() << ' ' << i;
        }
        const double volume = extent<double>(shape).size;
        EXPECT_NEAR(cell * static_cast<double>(points.size()), volume, 0.03 * volume) << shape.index();
        expect_fills(points, shape, 0.03);
    }
}

// The tolerance is five standard deviations of a mean over 5000 points: 5 / sqrt(5000) = 0.07.
TEST(Filling, AtRandomHasTheMomentsOfTheShapeAndRepeatsItself) {
    for (const Shape& shape : solids) {
        const auto points = random_points(shape, 3, 5000, 7);
        ASSERT_EQ(points.size(), 5000u);
        expect_fills(points, shape, 0.07);
        const auto again = random_points(shape, 3, 10, 7), other = random_points(shape, 3, 10, 8);
        EXPECT_EQ(again.back().position, points[9].position);
        EXPECT_NE(other.back().position, points[9].position);
        for (const PointMass<double>& point : points) ASSERT_TRUE(contains(shape, point.position));
    }
}

TEST(Filling, WhatHasNoVolumeHoldsNoPoint) {
    for (const Shape& shape : {Shape(ThinRod{2}), Shape(ThinDisc{1.5}), Shape(ThinPlate{{0.5, 1}})}) {
        EXPECT_FALSE(contains(shape, {0, 0, 0}));
        EXPECT_TRUE(grid_points(shape, 1, 5).empty());
        EXPECT_THROW(random_points(shape, 1, 1, 1), std::invalid_argument);
    }
    const Bounds rod = bounds(ThinRod{2}), disc = bounds(ThinDisc{1.5}), plate = bounds(ThinPlate{{0.5, 1}});
    EXPECT_EQ(rod.high, Vector3<double>(0, 0, 1));
    EXPECT_EQ(disc.low, Vector3<double>(-1.5, -1.5, 0));
    EXPECT_EQ(plate.high, Vector3<double>(0.5, 1, 0));
}

}  // namespace
}  // namespace polhode
