#include <gtest/gtest.h>

#include <cmath>

#include "check/file_errors.h"
#include "check/foreign_table.h"
#include "check/limits.h"
#include "check/report.h"
#include "text/message.h"

namespace polhode {
namespace {

// Two bodies 1 m apart along x, with a hinge about z half-way. They rotate about it as one body, at 2 rad/s.
struct Hinged {
    Scene scene;
    Reference truth;
    TrajectoryFile file;

    Hinged() {
        scene.name = "hinged", scene.duration = 4;
        scene.bodies.resize(2);
        scene.bodies[0].name = "left", scene.bodies[1].name = "right";
        scene.bodies[0].body.center_of_mass = {0.25, 0, 0};
        scene.joints.resize(1);
        Joint& hinge = scene.joints.front();
        hinge.name = "hinge", hinge.parent = "left", hinge.child = "right";
        hinge.axes[0] = {0, 0, 1};
        hinge.parent_point = {0.75, 0, 0}, hinge.child_point = {-0.5, 0, 0};
        truth.available = true, truth.bodies = 2;
        file.bodies = {"left", "right"};
        file.has_angular_velocity = file.has_position = file.has_velocity = true;
        for (int k = 0; k <= 40; ++k)
            for (const double side : {-0.5, 0.5}) {
                const double t = 0.1 * k, c = std::cos(2 * t), s = std::sin(2 * t);
                const TrajectoryRow row{t,
                                        {std::cos(t), 0, 0, std::sin(t)},
                                        {0, 0, 2},
                                        {side * c + t, side * s, 0},
                                        {-2 * side * s + 1, 2 * side * c, 0}};
                file.rows.push_back(row);
                ReferenceSample sample;
                sample.t = t, sample.q = {row.q.w, 0.0, 0.0, row.q.z}, sample.angular_velocity_B[2] = 2.0;
                for (std::size_t i = 0; i < 3; ++i)
                    sample.position_W[i] = row.position_W[i], sample.velocity_W[i] = row.velocity_W[i];
                truth.samples.push_back(sample);
            }
    }
};

TEST(SystemFileErrors, FindsTheTruthRightToRounding) {
    const Hinged h;
    const FileErrors found = compute_file_errors(h.scene, h.file, h.truth);
    for (std::size_t m = 0; m < measures().size(); ++m) {
        if (measures()[m].name == "reaction") {
            EXPECT_FALSE(found[m]);
            continue;
        }
        EXPECT_LT(found[m]->max, 1e-15) << measures()[m].name;
    }
    EXPECT_EQ(found.over_time.size(), 10u);
    EXPECT_EQ(found.size["omega"], 2);
    EXPECT_NEAR(found.size["velocity"], 2, 0.01);  // 1 m/s of the whole, 1 m/s about the hinge
    EXPECT_FALSE(ErrorLimits(h.scene).refuses(found));
}

TEST(SystemFileErrors, NamesTheWorstBodyAndTheWorstJoint) {
    Hinged h;
    TrajectoryRow& row = h.file.rows[2 * 30 + 1];
    const double t = row.t, ahead = 0.125;
    row.q = {std::cos(t + ahead / 2), 0, 0, std::sin(t + ahead / 2)};
    h.file.rows[2 * 10].position_W[2] = 0.25;
    h.file.rows[2 * 20].q = {std::cos(0.1), std::sin(0.1), 0, 0};  // a wrong attitude, rotated about x
    h.file.rows[2 * 20].position_W = h.truth.samples[2 * 20].rounded().position_W;
    const FileErrors found = compute_file_errors(h.scene, h.file, h.truth);
    EXPECT_EQ(found.worst_body, "left");
    EXPECT_EQ(found["attitude"]->max_time, 2);
    EXPECT_EQ(found["position"]->max, 0.25);
    EXPECT_EQ(found["position"]->max_time, 1);
    EXPECT_NEAR(found["joint_turn"]->max, 0.2, 1e-15);  // the hinge's axis is rotated from z about x
    EXPECT_EQ(found["joint_turn"]->max_time, 2);
    EXPECT_EQ(found.worst_turn, "hinge");
    EXPECT_EQ(found.worst_gap, "hinge");
    CheckedFile checked;
    checked.path = "run.csv", checked.file_errors = found;
    const ErrorLimits limits(h.scene);
    EXPECT_TRUE(limits.refuses(found));
    const std::string text = check_text(limits, {checked});
    for (const char* message_part :
         {"joint gap", "at joint hinge", "worst body        left", "run.csv: failed: attitude error "})
        EXPECT_NE(text.find(message_part), std::string::npos) << message_part << "\n" << text;
    const std::string json = check_json(h.scene, limits, {checked});
    for (const char* key : {"\"joint_gap_max\"", "\"worst_body\": \"left\"", "\"joint_turn_worst\": \"hinge\""})
        EXPECT_NE(json.find(key), std::string::npos) << key << "\n" << json;
}

TEST(SystemFileErrors, JointsHaveLimits) {
    Hinged h;
    h.file.rows[2 * 10].position_W[2] = 0.005;
    const FileErrors found = compute_file_errors(h.scene, h.file, h.truth);
    EXPECT_NEAR(found["joint_gap"]->max, 0.005, 1e-12);
    const auto fails = [&](const ErrorLimits& limits) {
        std::vector<std::string> all;
        for (const BlockVerdict& v : limits.verdicts(found))
            if (v.failed) all.emplace_back(v.block->name);
        return all;
    };
    EXPECT_EQ(fails(ErrorLimits(h.scene)), std::vector<std::string>());
    ErrorLimits strict(h.scene);
    strict.set("joint_gap", "1e-3");
    EXPECT_EQ(fails(strict), std::vector<std::string>{"joint_gap"});
    h.scene.tolerated["joint_gap"] = 0.004;
    EXPECT_EQ(fails(ErrorLimits(h.scene)), std::vector<std::string>{"joint_gap"});
    EXPECT_THROW(strict.set("joint_gap", "5%"), std::invalid_argument);
    // one body has no joint limits
    Scene one;
    one.name = "one", one.duration = 1;
    EXPECT_NO_THROW(validate(one, "one"));
    one.tolerated["joint_turn"] = 0.1;
    EXPECT_THROW(validate(one, "one"), InputError);
}

TEST(SystemFileErrors, JudgesOnlyWhatTheColumnsTell) {
    Hinged h;
    h.file.has_velocity = false;
    for (TrajectoryRow& row : h.file.rows) row.velocity_W = {};
    FileErrors found = compute_file_errors(h.scene, h.file, h.truth);
    EXPECT_FALSE(found["velocity"] || found["energy"] || found["momentum"] || found["linear_momentum"]);
    EXPECT_LT(found["omega"]->max, 1e-15);
    EXPECT_LT(found["joint_gap"]->max, 1e-15);
    h.file.has_angular_velocity = h.file.has_position = false;
    found = compute_file_errors(h.scene, h.file, h.truth);
    EXPECT_FALSE(found["omega"] || found["position"] || found["joint_gap"]);
    EXPECT_LT(found["attitude"]->max, 1e-15);
    EXPECT_LT(found["joint_turn"]->max, 1e-15);
    // origins instead of centres of mass
    h.file.has_origin = true;
    for (std::size_t i = 0; i < h.file.rows.size(); i += 2) {
        const double t = h.file.rows[i].t;
        h.file.rows[i].position_W =
            h.file.rows[i].position_W - 0.25 * Vector3<double>(std::cos(2 * t), std::sin(2 * t), 0);
    }
    EXPECT_LT(compute_file_errors(h.scene, h.file, h.truth)["position"]->max, 1e-15);
}

TEST(ForeignTable, ABodysNameIsTakenWhereThereAreSeveral) {
    const std::string text = "time,link,quat_w,quat_x,quat_y,quat_z\n0,a,1,0,0,0\n0,b,1,0,0,0\n";
    const auto bodies = [](const std::string& table, const ColumnNames& names) {
        return parse_foreign_trajectory(table, "f", find_foreign_columns(table, "f", names, true).columns).bodies;
    };
    EXPECT_EQ(bodies(text, {}), (std::vector<std::string>{"a", "b"}));
    EXPECT_FALSE(find_foreign_columns(text, "f", {}).columns.places.contains("body"));
    const std::string odd = "time,who,a,b,c,d\n0,a,1,0,0,0\n0,b,1,0,0,0\n";
    EXPECT_EQ(bodies(odd, parse_columns("time=time,body=who,rotation=b:c:d:a")).size(), 2u);
}

}  // namespace
}  // namespace polhode
