// polhode ensemble: one body per row, from table to table.
#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <cstring>

#include "app/program_fixture.h"
#include "integrators/scenes.h"
#include "motion/trajectory_csv.h"
#include "text/npy.h"

namespace polhode {
namespace {

class EnsembleCommand : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        inputs = directory.string() + ".in";
        fs::create_directory(inputs);
        write("flight.json", R"({"name": "flight", "duration": 2, "body": {"mass": 2, "inertia": [1, 2, 2.5]},
            "initial": {"angular_velocity": [0.3, 1, 2], "velocity": [1, 0, 0]},
            "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})");
    }
    void TearDown() override {
        fs::remove_all(inputs);
        Program::TearDown();
    }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(inputs / name) << text;
        return (inputs / name).string();
    }
    std::string scene() const { return (inputs / "flight.json").string(); }

    fs::path inputs;
};

// Splits a text into lines and cells.
std::vector<std::vector<std::string>> cells_of(const std::string& text) {
    std::vector<std::vector<std::string>> all;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = text.find('\n', begin);
        const std::string line = text.substr(begin, end - begin);
        std::vector<std::string> cells;
        for (std::size_t at = 0;;) {
            const std::size_t comma = line.find(',', at);
            cells.push_back(line.substr(at, comma - at));
            if (comma == line.npos) break;
            at = comma + 1;
        }
        all.push_back(cells);
        begin = end + 1;
    }
    return all;
}

TEST_F(EnsembleCommand, WritesOneRowPerBody) {
    const std::string table = write("t.csv", "id,wx,wy,wz,mass\na,0.3,1,2,2\nb,0,0,0,1\n");
    const Outcome outcome = run({"ensemble", scene(), "--initial", table});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto rows = cells_of(outcome.out);
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0], (std::vector<std::string>{"row", "id", "status", "t", "qw", "qx", "qy", "qz", "wx", "wy", "wz",
                                                 "px", "py", "pz", "vx", "vy", "vz", "message"}));
    ASSERT_EQ(rows[1].size(), rows[0].size());
    EXPECT_EQ(rows[1][0] + rows[1][1] + rows[1][2] + rows[1][3], "1aok2");
    EXPECT_EQ(rows[2][1], "b");
    EXPECT_EQ(rows[1].back(), "");
    // the first row is the scene itself
    const Outcome alone = run({"solve", scene(), "--samples", "1"});
    const Sample last = samples_of(parse_trajectory(alone.out, "solve"), Vector3<double>()).back();
    const auto& row = rows[1];
    const auto number = [&](std::size_t i) { return std::stod(row[i]); };
    EXPECT_LT(testing::attitude_error({number(4), number(5), number(6), number(7)}, last.q), 1e-13);
    const TrajectoryRow world = parse_trajectory(alone.out, "solve").rows.back();
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(number(8 + i), world.angular_velocity_W[i], 1e-13);
        EXPECT_NEAR(number(11 + i), world.position_W[i], 1e-13);
        EXPECT_NEAR(number(14 + i), world.velocity_W[i], 1e-13);
    }
    // a body at rest keeps its attitude and falls: z = -9.75 t^2 / 2
    EXPECT_EQ(rows[2][4], "1");
    EXPECT_EQ(rows[2][13], "-19.5");
    EXPECT_NE(outcome.err.find("2 ok"), std::string::npos) << outcome.err;
}

TEST_F(EnsembleCommand, OptionsAndFile) {
    const std::string table = write("t.csv", "mass\n1\n2\n");
    const Outcome outcome = run({"ensemble", scene(), "--initial", table, "--duration", "0.5", "--threads", "2",
                                 "--tolerance", "1e-6", "--output", "out.csv"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    const auto rows = cells_of(read(directory / "out.csv"));
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[1][2], "0.5");
}

TEST_F(EnsembleCommand, AFailedMotionHasARow) {
    const std::string table = write("t.csv", "wx,wy,wz\n0.1,0,1\n1e5,1e6,0\n0.2,0,1\n");
    const std::string top = write("top.json", R"({"name": "top", "duration": 1,
        "body": {"mass": 1, "inertia": [0.75, 0.7, 0.5], "center_of_mass": [0, 0, 0.5]}, "pivot": [0, 0, 0],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})");
    const Outcome outcome = run({"ensemble", top, "--initial", table, "--max-steps", "1000"});
    EXPECT_EQ(outcome.exit_code, 1);
    const auto rows = cells_of(outcome.out);
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[1][1], "ok");
    EXPECT_EQ(rows[2][1], "failed");
    EXPECT_EQ(rows[3][1], "ok");
    EXPECT_NE(rows[2].back().find("1000 steps"), std::string::npos) << rows[2].back();
    EXPECT_NE(outcome.err.find("row 2"), std::string::npos) << outcome.err;
}

TEST_F(EnsembleCommand, ReportsBadRowsAndSolvesTheOthers) {
    const std::string table = write("t.csv", "id,mass\na,-1\nb,2\nc,x\nd,1\ne,1,1\n");
    const Outcome outcome = run({"ensemble", scene(), "--initial", table});
    EXPECT_EQ(outcome.exit_code, 1);
    const auto rows = cells_of(outcome.out);
    ASSERT_EQ(rows.size(), 6u);
    for (const std::size_t bad : {1u, 3u, 5u}) {
        EXPECT_EQ(rows[bad][0], std::to_string(bad));
        EXPECT_EQ(rows[bad][2], "failed");
        // line 1 of the table is the header
        const std::string told = "row " + std::to_string(bad) + ": " + table + ": line " + std::to_string(bad + 1);
        EXPECT_NE(outcome.err.find(told), std::string::npos) << told << "\n" << outcome.err;
    }
    EXPECT_EQ(rows[2][0] + rows[2][1] + rows[2][2], "2bok");
    EXPECT_EQ(rows[4][0] + rows[4][1] + rows[4][2], "4dok");
}

TEST_F(EnsembleCommand, SamplesOverTime) {
    const std::string table = write("t.csv", "wx,wy,wz\n0.3,1,2\n0,0,1\n");
    const auto rows = cells_of(run({"ensemble", scene(), "--initial", table, "--samples", "4"}).out);
    ASSERT_EQ(rows.size(), 9u);
    const auto alone = parse_trajectory(run({"solve", scene(), "--samples", "4"}).out, "solve").rows;
    for (std::size_t k = 1; k <= 4; ++k) {
        EXPECT_EQ(std::stod(rows[k][2]), alone[k].t);
        const Quaternion<double> q{std::stod(rows[k][3]), std::stod(rows[k][4]), std::stod(rows[k][5]),
                                   std::stod(rows[k][6])};
        EXPECT_LT(testing::attitude_error({q.w, q.x, q.y, q.z}, alone[k].q), 1e-13);
        EXPECT_EQ(rows[4 + k][0], "2");
    }
}

// 1200 rows; every eleventh row is invalid.
std::string many_rows() {
    std::string text = "id,wx,wy,wz,ixx,iyy,izz\n";
    for (int i = 1; i <= 1200; ++i) {
        const int a = i * 7919 % 1000, b = i * 104729 % 1000;
        text += fmt::format("b{},{},{},{},1,{},{}\n", i, a / 500.0 - 1, b / 500.0 - 1, i / 1200.0, 1 + a / 1000.0,
                            i % 11 == 0 ? 4.0 : 1.5);
    }
    return text;
}

TEST_F(EnsembleCommand, TheSameBytesInPiecesOfAnySizeByAnyThreads) {
    const std::string table = write("many.csv", many_rows());
    const auto written = [&](const char* rows, const char* threads, const char* samples) {
        const Outcome outcome = run({"ensemble", scene(), "--initial", table, "--rows-at-once", rows, "--threads",
                                     threads, "--samples", samples, "--output", "out.csv"});
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_NE(outcome.err.find("refused  9 more rows"), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find("refused  row 11: "), std::string::npos) << outcome.err;
        return read(directory / "out.csv");
    };
    const std::string whole = written("100000", "1", "2");
    EXPECT_EQ(lines(whole), 1 + 2 * (1200 - 109) + 109);
    for (const auto& [rows, threads] : {std::pair("1", "1"), std::pair("600", "3"), std::pair("999", "2")})
        EXPECT_EQ(written(rows, threads, "2"), whole) << rows << " rows, " << threads << " threads";
    // stdout and a pipe give the same output
    const Outcome piped =
        run({"ensemble", scene(), "--initial", "/dev/stdin", "--samples", "2", "--rows-at-once", "500"},
            [&] { ::dup2(::open(table.c_str(), O_RDONLY), 0); });
    EXPECT_EQ(piped.exit_code, 1) << piped.err;
    const auto without_faults = [](std::string text) {
        for (std::size_t at; (at = text.find('"')) != text.npos;) text.erase(at, text.find('"', at + 1) + 1 - at);
        return text;
    };
    EXPECT_EQ(without_faults(piped.out), without_faults(whole));
}

TEST_F(EnsembleCommand, ALateErrorLeavesNoOutput) {
    const std::string table = write("t.csv", many_rows() + "\nb1,0,0,1,1,1,1\n");
    for (const char* rows : {"100", "100000"})
        expect_refused({"ensemble", scene(), "--initial", table, "--output", "out.csv", "--rows-at-once", rows},
                       "t.csv: line 1202: is blank; remove the line");
    expect_refused({"ensemble", scene(), "--initial", table}, "t.csv: line 1202: is blank; remove the line");
    expect_refused({"ensemble", scene(), "--initial", table, "--rows-at-once", "0"}, "--rows-at-once");
    // a full disk
    const Outcome full = run({"ensemble", scene(), "--initial", write("good.csv", many_rows()), "--output", "out.csv",
                              "--rows-at-once", "500"},
                             [] {
                                 const rlimit small{100'000, 100'000};
                                 ::setrlimit(RLIMIT_FSIZE, &small);
                                 std::signal(SIGXFSZ, SIG_IGN);
                             });
    EXPECT_EQ(full.exit_code, 1);
    EXPECT_EQ(full.err, "polhode: out.csv: cannot be written: File too large\n");
    EXPECT_TRUE(fs::is_empty(directory));
}

TEST_F(EnsembleCommand, NumpysFormat) {
    const std::string header = write_npy_header({{"id", "|S3"}, {"wx", "<f8"}, {"wy", "<f8"}, {"wz", "<f8"}}, 3);
    std::string content = header;
    for (const auto& [id, wz] : {std::pair("a\0\0", 2.0), std::pair("bcd", HUGE_VAL), std::pair("e\0\0", -1.0)}) {
        const double w[3]{0.3, 1, wz};
        content.append(id, 3).append(reinterpret_cast<const char*>(w), sizeof w);
    }
    const std::string table = write("t.npy", content);
    const auto csv = cells_of(run({"ensemble", scene(), "--initial", table, "--samples", "2"}).out);
    ASSERT_EQ(csv.size(), 6u);
    const Outcome outcome = run({"ensemble", scene(), "--initial", table, "--samples", "2", "--output", "out.npy"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("row 2: " + table + ": row 2, column wz: inf is not finite"), std::string::npos)
        << outcome.err;
    const std::string out = read(directory / "out.npy");
    const NpyHeader read = parse_npy_header(out, out.size(), "out.npy");
    ASSERT_EQ(read.rows, 5u);
    ASSERT_EQ(read.record_size, 131u);
    std::vector<std::string> names;
    for (const NpyField& field : read.fields) names.push_back(field.name);
    EXPECT_EQ(fmt::format("{}", fmt::join(names, ",")), "row,status,t,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,id");
    for (std::size_t i = 0; i < read.rows; ++i) {
        const char* record = out.data() + read.data_offset + i * read.record_size;
        const std::vector<std::string>& cells = csv[i + 1];
        std::int64_t whole[2];
        double numbers[14];
        std::memcpy(whole, record, sizeof whole), std::memcpy(numbers, record + 16, sizeof numbers);
        EXPECT_EQ(std::to_string(whole[0]), cells[0]);
        EXPECT_EQ(name_of(static_cast<Status>(whole[1])), cells[2]);
        EXPECT_EQ(std::string(record + 128, ::strnlen(record + 128, 3)), cells[1]);
        for (std::size_t k = 0; k < 14; ++k)
            if (cells[3 + k].empty())
                EXPECT_TRUE(std::isnan(numbers[k]));
            else
                EXPECT_EQ(numbers[k], std::stod(cells[3 + k]));
    }
}

TEST_F(EnsembleCommand, RefusesBadUsage) {
    const std::string table = write("t.csv", "mass\n1\n"), bad = write("bad.csv", "mass\n0\n-1\n");
    expect_refused({"ensemble", scene(), "--initial", table, "--samples", "0"}, "--samples");
    expect_refused({"ensemble", scene()}, "--initial");
    expect_refused({"ensemble", scene(), "--initial", "none.csv"}, "none.csv");
    expect_refused({"ensemble", "none.json", "--initial", table}, "none.json");
    expect_refused({"ensemble", scene(), "--initial", bad}, "bad.csv: line 2, column mass: ");
    expect_refused({"ensemble", scene(), "--initial", bad, "--output", "out.csv"}, "line 2");
    for (const char* value : {"0", "-1", "nan", "inf"}) {
        expect_refused({"ensemble", scene(), "--initial", table, "--tolerance", value}, "--tolerance");
        expect_refused({"ensemble", scene(), "--initial", table, "--duration", value}, "--duration");
    }
    expect_refused({"ensemble", scene(), "--initial", table, "--threads", "0"}, "--threads");
    expect_refused({"ensemble", scene(), "--initial", table, "--max-steps", "0"}, "--max-steps");
    expect_refused({"ensemble", scene(), "--initial", table, "--output", "no/such/place.csv"}, "no/such/place.csv");
}

}  // namespace
}  // namespace polhode
