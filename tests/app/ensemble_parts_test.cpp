// An ensemble solved in parts by the program and merged has the same bytes as one run.
#include "app/ensemble_parts.h"

#include <random>

#include "app/commands.h"
#include "app/program_fixture.h"
#include "scene/scene_file.h"
#include "text/message.h"
#include "text/npy.h"

namespace polhode {
namespace {

class EnsembleParts : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        std::ofstream(directory / "flight.json") << R"({"name": "flight", "duration": 2,
            "body": {"mass": 2, "inertia": [1, 2, 2.5]}, "initial": {"velocity": [1, 0, 0]},
            "loads": [{"type": "gravity", "acceleration": [0, 0, -9.75]}]})";
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> rate(-2, 2);
        std::ofstream csv(directory / "t.csv");
        csv << "id,wx,wy,wz\n";
        std::string npy = write_npy_header({{"wx", "<f8"}, {"wy", "<f8"}, {"wz", "<f8"}}, rows);
        for (std::size_t i = 1; i <= rows; ++i) {
            const double w[3]{rate(random), rate(random), rate(random)};
            csv << 'b' << i << ',' << w[0] << ',' << w[1] << ',' << (i % 50 == 0 ? "x" : std::to_string(w[2])) << '\n';
            npy.append(reinterpret_cast<const char*>(w), sizeof w);
        }
        std::ofstream(directory / "t.npy", std::ios::binary) << npy;
    }

    std::string path(const std::string& name) const { return (directory / name).string(); }
    // Solves parts of a table, out of `of` parts, into out.csv or out.npy in a directory.
    void solve(const std::string& folder, const std::string& ending, std::initializer_list<int> parts, int of,
               const std::vector<std::string>& more = {}) const {
        fs::create_directory(directory / folder);
        for (const int part : parts) {
            std::vector<std::string> arguments{"ensemble",  "flight.json",
                                               "--initial", "t." + ending,
                                               "--output",  folder + "/out." + ending,
                                               "--shard",   std::to_string(part) + "/" + std::to_string(of)};
            arguments.insert(arguments.end(), more.begin(), more.end());
            const Outcome outcome = run(arguments);
            ASSERT_LE(outcome.exit_code, ending == "npy" ? 0 : 1) << outcome.err;
            ASSERT_EQ(outcome.out, "");
        }
    }
    std::string fault_of(const std::vector<std::string>& folders, const std::string& output) const {
        std::vector<std::string> dirs;
        for (const std::string& folder : folders) dirs.push_back(path(folder));
        try {
            merge_ensemble_parts(dirs, path(output));
        } catch (const InputError& error) {
            EXPECT_FALSE(fs::exists(path(output))) << "a file was written";
            return error.what();
        }
        return "none";
    }
    void expect_fault(const std::vector<std::string>& folders, const std::string& output, const char* named) const {
        const std::string fault = fault_of(folders, output);
        EXPECT_NE(fault.find(named), std::string::npos) << named << "\n" << fault;
    }

    static constexpr std::size_t rows = 1003;
};

TEST(Shards, FollowEachOther) {
    for (const std::size_t rows : {std::size_t{1}, std::size_t{5}, std::size_t{1000}, ~std::size_t{0}})
        for (const std::size_t parts : {1u, 2u, 3u, 7u, 1'000'000u}) {
            std::size_t end = 0;
            for (std::size_t part = 1; part <= parts; part += part < 10 ? 1 : parts / 7 + 1) {
                const auto [first, last] = shard_rows(rows, {part, parts});
                if (part <= 10) {
                    ASSERT_EQ(first, end);
                }
                ASSERT_LE(first, last);
                ASSERT_LE(last - first - rows / parts, 1u);
                end = last;
            }
            ASSERT_EQ(shard_rows(rows, {parts, parts}).second, rows);
        }
    EXPECT_EQ(part_path("some/out.npy", {3, 200}), "some/out.part-0003-of-0200.npy");
    EXPECT_EQ(part_path("out", {1, 12345}), "out.part-00001-of-12345");
    for (const char* bad : {"", "1", "0/3", "4/3", "1/0", "1/1000001", "-1/3", "1/3x", "a/b", "1//3"})
        EXPECT_THROW(parse_shard(bad), UsageError) << bad;
    EXPECT_EQ(parse_shard("3/200").part, 3u);
}

TEST_F(EnsembleParts, MergedPartsEqualTheWholeRun) {
    for (const std::string ending : {"csv", "npy"}) {
        SCOPED_TRACE(ending);
        const std::string out = "out." + ending;
        const Outcome whole = run({"ensemble", "flight.json", "--initial", "t." + ending, "--output", out});
        EXPECT_EQ(whole.exit_code, ending == "npy" ? 0 : 1) << whole.err;
        // in any order, in several directories, one part twice, with other numbers of threads and rows per piece
        solve("a" + ending, ending, {3, 1}, 3, {"--threads", "3"});
        EXPECT_TRUE(has_ensemble_parts(path("a" + ending)));
        EXPECT_FALSE(has_ensemble_parts(path("none")));
        expect_fault({"a" + ending}, "merged." + ending, "is missing part 2 of 3; solve it: --shard 2/3");
        solve("b" + ending, ending, {2, 3}, 3, {"--rows-at-once", "70"});
        for (int again = 0; again < 2; ++again) {
            const MergedEnsemble merged =
                merge_ensemble_parts({path("a" + ending), path("b" + ending)}, path("merged." + ending));
            EXPECT_EQ(merged.parts, 3u);
            EXPECT_EQ(merged.rows, rows);
            EXPECT_EQ(merged.all_ok(), ending == "npy");
            EXPECT_EQ(merged.refused, ending == "npy" ? 0u : 20u);
            EXPECT_EQ(read(merged.output), read(directory / out));
        }
        // into the directory of the parts
        EXPECT_EQ(read(merge_ensemble_parts({path("b" + ending), path("a" + ending)}, path("b" + ending)).output),
                  read(directory / out));
    }
}

TEST_F(EnsembleParts, MorePartsThanRows) {
    std::ofstream(directory / "t.csv") << "mass\n1\n2\n";
    solve("p", "csv", {1, 2, 3}, 3, {"--samples", "2"});
    const Outcome whole =
        run({"ensemble", "flight.json", "--initial", "t.csv", "--samples", "2", "--output", "out.csv"});
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    EXPECT_EQ(read(merge_ensemble_parts({path("p")}, path("merged.csv")).output), read(directory / "out.csv"));
    std::ofstream(directory / "t.csv") << "mass\n-1\n-2\n";
    solve("q", "csv", {1, 2}, 2);
    expect_fault({"q"}, "none.csv", "has no solved row");
}

TEST_F(EnsembleParts, ReportsFaults) {
    expect_fault({"none"}, "m.csv", "none: cannot be read: No such file or directory");
    fs::create_directory(directory / "empty");
    expect_fault({"empty"}, "m.csv", "contains no part of an ensemble");
    solve("a", "csv", {1}, 2);
    expect_fault({"a"}, "m.npy", "differs in format from the parts of out.csv");
    solve("options", "csv", {2}, 2, {"--duration", "1"});
    expect_fault({"a", "options"}, "m.csv", "has scene hash");
    solve("tolerance", "csv", {2}, 2, {"--tolerance", "1e-6"});
    expect_fault({"a", "tolerance"}, "m.csv", "has options tolerance");
    solve("number", "csv", {2}, 3);
    expect_fault({"a", "number"}, "m.csv", "has number of parts 3");
    solve("b", "csv", {2}, 2);
    EXPECT_EQ(fault_of({"a", "b"}, "m.csv"), "none");
    fs::remove(directory / "m.csv");
    // a changed byte, and two different copies of a part
    const fs::path part = directory / "b/out.part-0002-of-0002.csv";
    const std::string text = read(part);
    std::string other = text;
    other[300] = other[300] == '1' ? '2' : '1';
    std::ofstream(part) << other;
    expect_fault({"a", "b"}, "m.csv", "does not match its .json file; solve it again: --shard 2/2");
    std::ofstream(part) << text.substr(0, 200);
    expect_fault({"a", "b"}, "m.csv", "does not match its .json file");
    fs::remove(part);
    expect_fault({"a", "b"}, "m.csv", "cannot be opened");
    std::ofstream(part) << text;
    std::string json = read(part.string() + ".json");
    for (const auto& [from, to, named] :
         {std::tuple{"\"part\": 2", "\"part\": 3", "/part: is out of range"},
          std::tuple{"\"kind\": \"part", "\"kind\": \"a part", "/kind: is a different kind"},
          std::tuple{"\"output\": \"out.csv\"", "\"output\": \"../out.csv\"", "contains parts of "},
          std::tuple{"\"rows\": 501", "\"rows\": -501", "/rows: is -501"},
          std::tuple{"\"hash\"", "\"hush\"", "hash"}}) {
        std::string changed = json;
        ASSERT_NE(changed.find(from), std::string::npos) << from << json;
        changed.replace(changed.find(from), std::string(from).size(), to);
        std::ofstream(part.string() + ".json") << changed;
        expect_fault({"a", "b"}, "m.csv", named);
    }
    // a name outside the directory is refused
    expect_fault({"a"}, "m.csv", "is missing part 2 of 2");
    fs::create_directory(directory / "c");
    std::string changed = read(directory / "a/out.part-0001-of-0002.csv.json");
    changed.replace(changed.find("out.csv"), 7, "../x.csv");
    std::ofstream(directory / "c/out.part-0001-of-0002.csv.json") << changed;
    expect_fault({"c"}, "m.csv", "/output: is not a file name");
    // a different table with the same number of rows
    std::ofstream(directory / "t.csv", std::ios::app) << "\n";
    solve("table", "csv", {2}, 2);
    expect_fault({"a", "table"}, "m.csv", "has table hash");
}

TEST_F(EnsembleParts, DistinguishesLongTablesByBlocks) {
    // 70 MiB of zeros in a sparse file
    constexpr std::uint64_t many = 3'000'000;
    const std::string header = write_npy_header({{"wx", "<f8"}, {"wy", "<f8"}, {"wz", "<f8"}}, many);
    const std::string table = path("long.npy");
    std::ofstream(table, std::ios::binary) << header;
    const std::uint64_t bytes = header.size() + 24 * many;
    fs::resize_file(table, bytes);
    const Scene scene = read_scene(path("flight.json"));
    const TableIdentity identity = compute_identity(table, scene);
    EXPECT_EQ(identity.rows, many);
    EXPECT_EQ(identity.bytes, bytes);
    EXPECT_EQ(compute_identity(table, scene).hash, identity.hash);
    // the blocks that are read include the first rows, the last rows and rows throughout the table
    for (const std::uint64_t at : {std::uint64_t{header.size()}, bytes / 1023 * 500, bytes - 8}) {
        std::fstream file(table, std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(static_cast<std::streamoff>(at));
        file.put('\1').flush();
        EXPECT_NE(compute_identity(table, scene).hash, identity.hash) << at;
        file.seekp(static_cast<std::streamoff>(at));
        file.put('\0').flush();
        EXPECT_EQ(compute_identity(table, scene).hash, identity.hash) << at;
    }
}

TEST_F(EnsembleParts, RefusesBadUsage) {
    const auto refused = [&](const std::vector<std::string>& arguments, const std::string& named) {
        std::vector<std::string> all{"ensemble", "flight.json", "--initial", "t.csv"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const Outcome outcome = run(all);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
        EXPECT_NE(outcome.err.find(named), std::string::npos) << outcome.err;
    };
    refused({"--shard", "1/2"}, "--shard writes a file; give --output");
    refused({"--shard", "3/2", "--output", "o.csv"}, "--shard is 3/2; give I/N");
    refused({"--shard", "1/2", "--output", "o.csv", "--initial", "/dev/stdin"}, "--initial");
    refused({"--output", "o.npy"}, "t.csv: column id: has ids of variable length, which .npy output does not support");
    EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 3);
}

}  // namespace
}  // namespace polhode
