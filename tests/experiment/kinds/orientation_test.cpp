// Results of the kinds `orientation` and `gimbal_lock` that do not depend on the last digits.
#include <gtest/gtest.h>

#include "experiment/kinds/findings_read.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"

namespace polhode {
namespace {

double real(const Table& table, const std::vector<Cell>& row, const char* column) {
    const Cell& cell = row[column_index(table, column)];
    if (const long* count = std::get_if<long>(&cell)) return static_cast<double>(*count);
    return std::get<double>(cell);
}

class OrientationStudy : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        Plan plan;
        plan.experiment.repeats = 1;
        result = new Findings(find_kind("orientation")->make(plan, quickly()));
    }
    static void TearDownTestSuite() { delete result; }
    static inline Findings* result = nullptr;
};

TEST_F(OrientationStudy, WritesCompleteTables) {
    for (const NamedTable& table : result->tables) {
        EXPECT_NO_THROW(require_rectangular(table.table)) << table.name;
        EXPECT_GT(table.table.rows.size(), 2U) << table.name;
        if (!table.page_columns.empty()) {
            EXPECT_NO_THROW(select(table.table, table.page_columns)) << table.name;
        }
    }
}

TEST_F(OrientationStudy, SlerpIsTheShortestWayAtOneSpeed) {
    const Table& t = table_of(*result, "");
    double longest = 0;
    for (const auto& row : t.rows) {
        if (word(t, row, "interpolation") == "slerp") {
            EXPECT_NEAR(real(t, row, "length_ratio"), 1, 1e-9) << word(t, row, "pair");
            EXPECT_NEAR(real(t, row, "speed_ratio"), 1, 1e-9) << word(t, row, "pair");
        } else {
            EXPECT_GT(real(t, row, "length_ratio"), 1 - 1e-9) << word(t, row, "pair");
            longest = std::max(longest, real(t, row, "length_ratio"));
        }
    }
    EXPECT_NEAR(longest, 17, 1e-6);  // 340 degrees instead of 20
}

TEST_F(OrientationStudy, AnglesBetweenKeysAreWorseTheNearerToLock) {
    const Table& t = table_of(*result, "keys");
    double before = 0;
    for (const auto& row : t.rows) {
        const std::string way = word(t, row, "interpolation");
        const double error = real(t, row, "attitude_error");
        if (way == "slerp") {
            EXPECT_LT(error, 1e-14);
        } else if (way == "euler_angles, unwrapped") {
            EXPECT_GT(error, before);
            before = error;
        } else {
            EXPECT_GT(error, 1);  // wrapped angles take the long way at 180 degrees
        }
    }
}

TEST_F(OrientationStudy, OnlyBAIsFirstAThenB) {
    const Table& t = table_of(*result, "matrix_order");
    ASSERT_EQ(t.rows.size(), 3U);
    EXPECT_GT(real(t, t.rows[0], "angle"), 0.05);
    EXPECT_LT(real(t, t.rows[1], "angle"), 1e-15);
    EXPECT_LT(real(t, t.rows[2], "angle"), 1e-15);
    const Table& order = table_of(*result, "angle_order");
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) {
            const double angle = std::get<double>(order.rows[i][j + 2]);
            if (i == j) {
                EXPECT_LT(angle, 1e-15);
            } else {
                EXPECT_GT(angle, 0.02);
            }
        }
}

TEST_F(OrientationStudy, TakesRotationsOnly) {
    const Table& t = table_of(*result, "reflection");
    for (const auto& row : t.rows) {
        const bool accepted = word(t, row, "accepted") == "yes";
        EXPECT_EQ(accepted, real(t, row, "determinant") > 0 && real(t, row, "defect") < 1e-9);
        EXPECT_EQ(accepted, word(t, row, "message").empty());
    }
}

/// Vertices that are rotated incrementally drift in every step. Vertices computed from the originals with a normalised
/// quaternion do not.
TEST_F(OrientationStudy, VerticesFromTheOriginalsStay) {
    const Table& t = table_of(*result, "vertices");
    for (const char* scalar : {"binary32", "binary64"}) {
        const double ulp = scalar == std::string("binary32") ? 0x1p-23 : 0x1p-52;
        double first = 0, last = 0;
        for (const auto& row : t.rows) {
            if (word(t, row, "scalar") != scalar) continue;
            const double defect = real(t, row, "defect");
            const std::string way = word(t, row, "way");
            if (way == "V <- R V") {
                if (first == 0) first = defect;
                last = defect;
            } else if (way.find("normalised") != std::string::npos) {
                EXPECT_LT(defect, 10 * ulp);
            }
        }
        EXPECT_GT(last, 100 * first) << scalar;
    }
}

TEST_F(OrientationStudy, SummedInertiaIsTheTransformedOne) {
    const Table& t = table_of(*result, "inertia");
    for (const auto& row : t.rows) {
        const bool single = word(t, row, "scalar") == "binary32";
        // worst case: all n terms of the sum are rounded in the same direction
        const double terms = word(t, row, "points").empty() ? 8 : real(t, row, "points");
        EXPECT_LT(real(t, row, "inertia_error"), (single ? 0x1p-23 : 0x1p-52) * (8 + terms));
        EXPECT_GT(real(t, row, "seconds_min"), 0);
    }
}

TEST(GimbalLockStudy, CostsAnglesStepsAndQuaternionsNothing) {
    const Findings result = find_kind("gimbal_lock")->make({}, quickly());
    const Table& t = table_of(result, "");
    require_rectangular(t);
    double steps = 0, smallest = 1;
    int quaternions = 0;
    std::optional<double> quaternion_steps;
    for (const auto& row : t.rows) {
        const double setting = real(t, row, "setting");
        EXPECT_EQ(word(t, row, "status") == "ok",
                  word(t, row, "message").empty() || word(t, row, "message").find("SUNDIALS") == 0);
        if (setting != 1e-10) continue;
        const double error = real(t, row, "attitude_error_max");
        EXPECT_LT(error, 1e-6);
        if (word(t, row, "method") == "euler_angles_cvode") {
            const double d = real(t, row, "distance");
            EXPECT_GT(real(t, row, "steps"), steps) << d;
            EXPECT_LT(real(t, row, "smallest_step"), smallest) << d;
            steps = real(t, row, "steps"), smallest = real(t, row, "smallest_step");
            if (d < 0.05) {
                // the rates of roll and yaw are proportional to 1/d when the nose is nearest to the vertical
                EXPECT_GT(real(t, row, "largest_angle_rate") * d, 1) << d;
                EXPECT_LT(real(t, row, "largest_angle_rate") * d, 4) << d;
            }
        } else {
            ++quaternions;
            if (quaternion_steps && real(t, row, "distance") < 0.5) {
                EXPECT_NEAR(real(t, row, "steps"), *quaternion_steps, 0.1 * *quaternion_steps);
            }
            quaternion_steps = real(t, row, "steps");
        }
    }
    EXPECT_EQ(quaternions, 5);
}

}  // namespace
}  // namespace polhode
