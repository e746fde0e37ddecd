// Reading of trajectory files: files of polhode and of other programs, several bodies, refusals.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <clocale>
#include <cmath>
#include <limits>

#include "bad_files.h"
#include "motion/moderate_scene.h"
#include "motion/trajectory_csv.h"
#include "motion/written_tables.h"
#include "places.h"
#include "scene/random_scene.h"

namespace polhode {
namespace {

std::string fault_of(const std::string& text) {
    try {
        parse_trajectory(text, "run.csv");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TrajectoryFile random_file() {
    TrajectoryFile file;
    const int bodies = *rc::gen::inRange(0, 4);
    for (int i = 0; i < bodies; ++i) file.bodies.push_back(std::string(1, static_cast<char>('z' - i)) + " arm");
    file.has_angular_velocity = *rc::gen::arbitrary<bool>();
    file.has_velocity = *rc::gen::arbitrary<bool>();
    const int position = *rc::gen::inRange(0, 3);
    file.has_position = position == 1, file.has_origin = position == 2;
    const int rows = *rc::gen::inRange(1, 6) * static_cast<int>(file.bodies_at_once());
    double t = 0;
    for (int i = 0; i < rows; ++i) {
        TrajectoryRow row;
        row.t = t;
        if ((i + 1) % static_cast<int>(file.bodies_at_once()) == 0) t += positive_number();
        const double length = std::exp2(*rc::gen::inRange(-300, 300));
        const Quaternion<double> q = random_orientation();
        row.q = {length * q.w, length * q.x, length * q.y, length * q.z};
        if (file.has_angular_velocity) row.angular_velocity_W = random_vector();
        if (position > 0) row.position_W = random_vector();
        if (file.has_velocity) row.velocity_W = random_vector();
        file.rows.push_back(row);
    }
    return file;
}

RC_GTEST_PROP(TrajectoryFile, ReadsBackTheSameBits, ()) {
    const TrajectoryFile file = random_file();
    RC_ASSERT(parse_trajectory(write_trajectory(file), "written") == file);
}

TEST(TrajectoryFile, ReadsWhatSolveWrites) {
    Trajectory trajectory;
    for (int k = 0; k < 3; ++k) {
        Sample s;
        s.t = k * 0.1, s.q = {std::cos(0.3 * k), std::sin(0.3 * k), 0, 0};
        s.angular_velocity_B = {0.6 / 0.1, 1.0 / 3, 0}, s.position_W = {k / 7.0, 1e-300, 1e22};
        s.velocity_W = {5e-324, -0.0, 0.1};
        trajectory.samples.push_back(s);
    }
    trajectory.status = Status::failed, trajectory.message = "stopped";
    const TrajectoryFile file = parse_trajectory(trajectory_csv(trajectory), "solved");
    ASSERT_EQ(file.rows.size(), 3u);
    EXPECT_TRUE(file.has_angular_velocity && file.has_position && file.has_velocity && !file.has_origin);
    for (std::size_t k = 0; k < 3; ++k) {
        const Sample& s = trajectory.samples[k];
        EXPECT_EQ(file.rows[k], (TrajectoryRow{s.t, s.q, angular_velocity_W(s), s.position_W, s.velocity_W}));
    }
    EXPECT_TRUE(std::signbit(file.rows[0].velocity_W[1]));
}

constexpr const char* two_bodies =
    "qw,body,t,qx,qy,qz\n1,arm,0,0,0,0\n0,leg,0,1,0,0\n0,leg,0.5,0,1,0\n# between\n0,arm,0.5,0,0,1\n";

TEST(TrajectoryFile, BodiesStandInAnyOrderAtEachTime) {
    TrajectoryFile file = parse_trajectory(two_bodies, "f");
    EXPECT_EQ(file.bodies, (std::vector<std::string>{"arm", "leg"}));
    ASSERT_EQ(file.rows.size(), 4u);
    EXPECT_EQ(file.rows[0].q, (Quaternion<double>{1, 0, 0, 0}));
    EXPECT_EQ(file.rows[1].q, (Quaternion<double>{0, 1, 0, 0}));
    EXPECT_EQ(file.rows[2].q, (Quaternion<double>{0, 0, 0, 1}));
    EXPECT_EQ(file.rows[3].q, (Quaternion<double>{0, 0, 1, 0}));
    EXPECT_EQ(file.rows[2].t, 0.5);
    // bodies in the order of the scene
    const std::vector<std::string> names{"leg", "arm"};
    file = parse_trajectory(two_bodies, "f", QuaternionColumns::by_name, names);
    EXPECT_EQ(file.bodies, names);
    EXPECT_EQ(file.rows[0].q, (Quaternion<double>{0, 1, 0, 0}));
    EXPECT_EQ(file.rows[3].q, (Quaternion<double>{0, 0, 0, 1}));
}

TEST(TrajectoryFile, AColumnIsNotNeededWhereThereIsOneBody) {
    const std::vector<std::string> name{"arm"};
    const TrajectoryFile file =
        parse_trajectory("t,qw,qx,qy,qz\n0,1,0,0,0\n1,0,1,0,0\n", "f", QuaternionColumns::by_name, name);
    EXPECT_EQ(file.bodies, name);
    EXPECT_EQ(file.rows.size(), 2u);
}

TEST(TrajectoryFile, MessagesNameMissingAndExtraBodies) {
    const std::string arm = ",arm,1,0,0,0\n", leg = ",leg,1,0,0,0\n", header = "t,body,qw,qx,qy,qz\n";
    EXPECT_EQ(fault_of(header + "0" + arm + "0" + leg + "1" + leg + "2" + leg + "2" + arm),
              "run.csv: line 4, column body: body \"arm\" has no line at 1 s; give one line per body at each time");
    EXPECT_EQ(fault_of(header + "0" + arm + "0" + leg + "1" + leg),
              "run.csv: line 4, column body: body \"arm\" has no line at 1 s; give one line per body at each time");
    EXPECT_EQ(fault_of(header + "0" + arm + "0" + leg + "0" + arm),
              "run.csv: line 4, column body: body \"arm\" has two lines at 0 s; give one line per body at each "
              "time");
    EXPECT_EQ(fault_of(header + "0" + arm + "1" + leg),
              "run.csv: line 3, column body: body \"leg\" has no line at the first time; give one line per body at "
              "each time");
    EXPECT_EQ(fault_of(header + "1" + arm + "0" + arm),
              "run.csv: line 3, column t: 0 s is not after the 1 s of the previous sample; give each time once, in "
              "ascending order");
    EXPECT_EQ(fault_of(header + "0,,1,0,0,0\n"), "run.csv: line 2, column body: is empty; give the body's name");
    const std::vector<std::string> names{"arm", "leg"};
    const auto fault_of_scene = [&](const std::string& text) -> std::string {
        try {
            parse_trajectory(text, "run.csv", QuaternionColumns::by_name, names);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(fault_of_scene(header + "0" + arm + "0,lag,1,0,0,0\n"),
              "run.csv: line 3, column body: \"lag\" is not a body of the scene; did you mean leg?");
    EXPECT_EQ(
        fault_of_scene("t,qw,qx,qy,qz\n0,1,0,0,0\n"),
        "run.csv: line 1: column body is missing; give t,body,qw,.. with one line at each time for each of arm, leg, "
        "or for some of "
        "them");
    EXPECT_EQ(fault_of_scene(header + "0" + arm + "0" + leg), "");
    // a file with some of the scene's bodies, the same ones at each time
    EXPECT_EQ(fault_of_scene(header + "0" + leg + "1" + leg), "");
    EXPECT_EQ(fault_of_scene(header + "0" + leg + "1" + leg + "1" + arm),
              "run.csv: line 4, column body: body \"arm\" has no line at the first time; give one line per "
              "body at each time");
    EXPECT_EQ(fault_of_scene(header + "0" + leg + "0" + arm + "1" + arm),
              "run.csv: line 4, column body: body \"leg\" has no line at 1 s; give one line per body at each "
              "time");
}

TEST(TrajectoryFile, EachBodysOriginIsExchangedForItsOwnCenterOfMass) {
    const TrajectoryFile file =
        parse_trajectory("t,body,qw,qx,qy,qz,ox,oy,oz\n0,a,1,0,0,0,1,2,3\n0,b,0,2,0,0,1,2,3\n", "f");
    const std::vector<Vector3<double>> centers{{0.5, 0, 0}, {0, 0.25, 0}};
    const std::vector<Sample> samples = samples_of(file, centers);
    EXPECT_EQ(samples[0].position_W, Vector3<double>(1.5, 2, 3));
    EXPECT_EQ(samples[1].position_W, Vector3<double>(1, 1.75, 3));
}

TEST(TrajectoryFile, TakesColumnsByNameInAnyOrder) {
    const TrajectoryFile file = parse_trajectory("qz,ox,t,oy,qw,oz,qx,qy,bound\n4,5,0.5,6,1,7,2,3,1e-17\n", "f");
    ASSERT_EQ(file.rows.size(), 1u);
    EXPECT_TRUE(file.has_origin && !file.has_position && !file.has_velocity && !file.has_angular_velocity);
    EXPECT_EQ(file.rows[0], (TrajectoryRow{0.5, {1, 2, 3, 4}, {}, {5, 6, 7}, {}}));
}

TEST(TrajectoryFile, TakesWhatOtherProgramsWrite) {
    const TrajectoryFile plain = parse_trajectory("t,qw,qx,qy,qz\n0,1,0,0,0\n1,0,1,0,0\n", "f");
    for (const char* text : {
             "\xef\xbb\xbft,qw,qx,qy,qz\r\n0,1,0,0,0\r\n1,0,1,0,0\r\n",                // as written by spreadsheets
             "# by hand\nt, qw, qx,\tqy , qz\n 0, 1, 0, 0, 0\n# half-way\n1,0,1,0,0",  // spaces, comments, no final \n
             "t,qw,qx,qy,qz\n0,1,0,0,0\n1,0,1,0,0\n\n \r\n",                           // blank lines at the end
             "t,qw,qx,qy,qz\n+0.0,1.,0e5,.0,00\n1e0,0,10E-1,0,0\n",                    // unusual spellings of decimals
             "t,qw,qx,qy,qz\n1e-999,1,-1e-99999999999999999999,0,0\n1,0,1,0,0\n",      // underflow to zero
         }) {
        TrajectoryFile file = parse_trajectory(text, "f");
        const std::string skipped_content = file.skipped_content;
        file.skipped_content.clear();
        EXPECT_EQ(file, plain) << text;
        const bool spreadsheet = text[0] == '\xef';
        EXPECT_EQ(skipped_content,
                  spreadsheet ? "line 1 begins with a byte order mark, line 1 ends in a carriage return" : "");
    }
}

TEST(TrajectoryFile, NumbersAreTheNearestBinary64) {
    const auto time = [](const std::string& decimal) {
        return parse_trajectory("t,qw,qx,qy,qz\n" + decimal + ",1,0,0,0\n", "f").rows[0].t;
    };
    EXPECT_EQ(time("0.1"), 0x1.999999999999ap-4);
    EXPECT_EQ(time("0.1000000000000000055511151231257827021181583404541015625"), 0.1);
    EXPECT_EQ(time("9007199254740993.0000000000000000000001"), 0x1p53 + 2);
    EXPECT_EQ(time("3e-324"), 5e-324);
    EXPECT_EQ(time("1.7976931348623158e308"), std::numeric_limits<double>::max());
    EXPECT_EQ(time("0.0000000000000000000000000000001e31"), 1);
    // a locale with a decimal comma has no effect
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE"})
        if (std::setlocale(LC_ALL, name) != nullptr) {
            EXPECT_EQ(time("0.5"), 0.5);
        }
    std::setlocale(LC_ALL, "C");
}

TEST(TrajectoryFile, MessagesNamePlaceAndFault) {
    EXPECT_EQ(fault_of("t,qw,qx,qy,qz\n0,1,0,0,0\n1,1,nan,0,0\n"),
              "run.csv: line 3, column qx: nan is not finite; give a finite number");
    EXPECT_EQ(fault_of("t,qw,qx,qy,qs\n"),
              "run.csv: line 1, column 5: is named qs; known columns: t, qw, qx, qy, qz, "
              "wx, wy, wz, px, py, pz, ox, oy, oz, vx, vy, vz, bound, body");
    EXPECT_EQ(fault_of("t,qw,qx,qy,qz\n# c\n0.5,1,0,0,0\n0.5,1,0,0,0\n"),
              "run.csv: line 4, column t: 0.5 s is not after the 0.5 s of the previous sample; give each time "
              "once, in ascending order");
    EXPECT_EQ(fault_of("t,qw,qx,qy,qz,wx\n"), "run.csv: line 1: column wy is missing; give all of wx,wy,wz or none");
}

TEST(BadTrajectories, EachIsRefusedInOneLineThatNamesFilePlaceAndRemedy) {
    for (const BadFile& bad : bad_files("motion", ".csv")) {
        std::string message;
        try {
            read_trajectory(bad.path);
        } catch (const InputError& error) {
            message = error.what();
        }
        expect_one_line(bad, message);
    }
    EXPECT_GE(bad_files("motion", ".csv").size(), 50u);
    expect_whole_catalogue("motion", ".csv");
}

TEST(BadTrajectories, FilesThatCannotBeReadAreNamed) {
    for (const std::string& path : {std::string("/nowhere/run.csv"), source_dir()}) {
        try {
            read_trajectory(path);
            FAIL() << path;
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find(path), 0u);
            EXPECT_NE(std::string(error.what()).find("give the path of a readable CSV file"), std::string::npos);
        }
    }
}

/// Rates are written in world axes and read back in body axes: two roundings per rotation, a few ulp of their length.
RC_GTEST_PROP(SamplesOf, GivesTheRatesBackThatWereWritten, ()) {
    Trajectory trajectory;
    Sample s;
    s.q = testing::moderate_orientation(), s.angular_velocity_B = testing::moderate_vector();
    s.position_W = testing::moderate_vector(), s.velocity_W = testing::moderate_vector();
    // q of any length: the length cancels
    const double length = std::exp2(*rc::gen::inRange(-300, 300));
    s.q = {length * s.q.w, length * s.q.x, length * s.q.y, length * s.q.z};
    trajectory.samples = {s};
    const Vector3<double> center = testing::moderate_vector();
    TrajectoryFile file = parse_trajectory(trajectory_csv(trajectory), "written");
    const std::vector<Sample> back = samples_of(file, center);
    RC_ASSERT(back.size() == 1u);
    RC_ASSERT(back[0].q == s.q);
    RC_ASSERT(back[0].position_W == s.position_W);
    RC_ASSERT(back[0].velocity_W == s.velocity_W);
    RC_ASSERT(testing::distance(back[0].angular_velocity_B, s.angular_velocity_B) < 1e-14);
    // p is recovered from the position of the origin, p - R c
    const Vector3<double> arm_W = (1 / squared_norm(s.q)) * rotate(s.q, center);
    file.has_position = false, file.has_origin = true;
    file.rows[0].position_W = s.position_W - arm_W;
    RC_ASSERT(testing::distance(samples_of(file, center)[0].position_W, s.position_W) < 1e-14);
}

// a quarter rotation about z: the body's x axis is the world's y axis
TEST(SamplesOf, TurnsRatesAndMovesTheOrigin) {
    TrajectoryFile file;
    file.has_angular_velocity = file.has_origin = true;
    file.rows = {{0, {3, 0, 0, 3}, {0, 2, 5}, {10, 20, 30}, {}}};
    const std::vector<Sample> samples = samples_of(file, {1, 0, 0.5});
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_EQ(samples[0].angular_velocity_B, Vector3<double>(2, 0, 5));
    EXPECT_EQ(samples[0].position_W, Vector3<double>(10, 21, 30.5));
    EXPECT_EQ(samples[0].q, (Quaternion<double>{3, 0, 0, 3}));
}

}  // namespace
}  // namespace polhode
