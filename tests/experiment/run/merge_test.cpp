#include "experiment/run/merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "experiment/run/case_store.h"
#include "experiment/run/run_experiment.h"
#include "text/content_hash.h"
#include "text/message.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

class Merge : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        directory_ = fs::path(::testing::TempDir()) / ("polhode_merge_" + std::string(test->name()));
        fs::remove_all(directory_);
        fs::create_directories(directory_);
        setenv("POLHODE_CACHE", (directory_ / "cache").c_str(), 1);
    }
    void TearDown() override { fs::remove_all(directory_); }

    static Plan plan(const std::string& more = "") {
        return make_plan(parse_experiment(R"({"name": "t", "scenes": ["free_asymmetric"],
            "methods": ["odeint_rk4", "odeint_dopri5"], "settings": {"steps": [0.1, 0.05], "tolerances": [1e-4]},
            "vary": {"/duration": [1, 2, 3]}, "samples": 5, "repeats": 1)" +
                                              more + "}",
                                          "t.json"),
                         "t.json", false);
    }
    RunOptions options(const std::string& name) const {
        RunOptions options;
        options.directory = (directory_ / name).string(), options.quiet = true;
        return options;
    }
    // runs the shards and returns their directories
    std::vector<std::string> run_shards(int shards, const std::string& more = "") const {
        std::vector<std::string> folders;
        for (int shard = 1; shard <= shards; ++shard) {
            RunOptions each = options(std::to_string(shards) + "_" + std::to_string(shard));
            each.shard = shard, each.shards = shards;
            EXPECT_TRUE(run_experiment(plan(more), each, "test"));
            folders.push_back(each.directory);
        }
        return folders;
    }
    MergeResult merge(const std::vector<std::string>& folders, const std::string& name) const {
        return merge_results(folders, options(name), "test");
    }
    // hashes of all files except the provenance, which has the date
    std::map<std::string, std::string> files(const std::string& name) const {
        std::map<std::string, std::string> found;
        for (const auto& entry : fs::directory_iterator(directory_ / name))
            if (entry.is_regular_file() && entry.path().filename() != "provenance.json")
                found[entry.path().filename()] = content_hash(content(entry.path()));
        return found;
    }
    std::string refusal(const std::vector<std::string>& folders) const {
        try {
            merge(folders, "refused");
        } catch (const InputError& error) {
            EXPECT_FALSE(fs::exists(directory_ / "refused")) << "merge_results() refused but wrote files";
            return error.what();
        }
        return "not refused";
    }
    fs::path a_case(const std::string& folder) const {
        for (const auto& entry : fs::directory_iterator(fs::path(folder) / ".cases"))
            if (entry.path().extension() == ".csv") return entry.path();
        return {};
    }

    fs::path directory_;
};

TEST_F(Merge, GivesTheFilesOfAnyOrderAndNumberOfFolders) {
    std::vector<std::string> folders = run_shards(3);
    const MergeResult merged = merge(folders, "all");
    ASSERT_EQ(merged.experiments.size(), 1U);
    EXPECT_EQ(merged.experiments[0].missing, 0);
    EXPECT_EQ(merged.repeated, 0);
    // one process in one directory with the same cases writes the same bytes
    fs::copy(folders[0], directory_ / "one", fs::copy_options::recursive);
    for (const std::string& other : {folders[1], folders[2]})
        fs::copy(fs::path(other) / ".cases", directory_ / "one" / ".cases",
                 fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    EXPECT_TRUE(run_experiment(plan(), options("one"), "test"));
    EXPECT_EQ(files("one"), files("all"));
    std::reverse(folders.begin(), folders.end());
    merge(folders, "reversed");
    EXPECT_EQ(files("reversed"), files("all"));
    merge({folders[0]}, "in_turn");
    merge({folders[1], folders[0]}, "in_turn");
    merge({folders[2]}, "in_turn");
    EXPECT_EQ(files("in_turn"), files("all"));
    const MergeResult again = merge(folders, "all");
    EXPECT_EQ(again.taken, 0);
    EXPECT_EQ(files("reversed"), files("all"));
    // the merged directory is a normal result directory
    EXPECT_TRUE(pending_work(plan(), options("all")).empty());
}

TEST_F(Merge, CountsWhatIsMissing) {
    const std::vector<std::string> folders = run_shards(3);
    const MergeResult merged = merge({folders[0], folders[2]}, "part");
    EXPECT_EQ(merged.experiments[0].missing, 5);  // the five cases of one scene
    EXPECT_NE(merged.experiments[0].first_missing.find("duration=2"), std::string::npos);
}

TEST_F(Merge, KeepsTheFastestTimeInAnyOrder) {
    const std::vector<std::string> folders = run_shards(1);
    fs::copy(folders[0], directory_ / "slower", fs::copy_options::recursive);
    const fs::path changed = directory_ / "slower" / ".cases" / a_case(folders[0]).filename();
    Result result = *load_case((directory_ / "slower").string(), changed.stem());
    const double fast = *result.seconds_min;
    result.seconds_min = fast * 2, result.machine = "another";
    save_case((directory_ / "slower").string(), changed.stem(), "t", result);
    const std::string slower = (directory_ / "slower").string();
    EXPECT_GT(merge({folders[0], slower}, "a").repeated, 0);
    merge({slower, folders[0]}, "b");
    EXPECT_EQ(files("a"), files("b"));
    EXPECT_EQ(*load_case((directory_ / "a").string(), changed.stem())->seconds_min, fast);
}

TEST_F(Merge, TimesKeepTheirMachines) {
    const std::vector<std::string> folders = run_shards(2);
    EXPECT_EQ(content(directory_ / "2_1" / "t.csv").find("machine"), std::string::npos);
    const std::string key = a_case(folders[1]).stem();
    Result result = *load_case(folders[1], key);
    result.machine = "another, with a comma";
    save_case(folders[1], key, "t", result);
    merge(folders, "all");
    const Table table = parse_csv(content(directory_ / "all" / "t.csv"));
    EXPECT_EQ(table.columns.back(), "machine");
    EXPECT_EQ(std::count_if(table.rows.begin(), table.rows.end(),
                            [](const auto& row) { return text_of(row.back()) == "another, with a comma"; }),
              1);
    EXPECT_NE(content(directory_ / "all" / "provenance.json").find("another, with a comma"), std::string::npos);
}

TEST_F(Merge, RefusesRowsOfOneCaseThatDifferAndShowsBoth) {
    const std::vector<std::string> folders = run_shards(1);
    // a long path, which alone would fill the message
    const fs::path deep = directory_ / std::string(120, 'a') / std::string(120, 'b');
    fs::create_directories(deep.parent_path());
    fs::copy(folders[0], deep, fs::copy_options::recursive);
    const std::string other = deep.string();
    const std::string key = a_case(folders[0]).stem();
    Result result = *load_case(other, key);
    result.errors["attitude"].max = 0.125;
    save_case(other, key, "t", result);
    const std::string told = refusal({folders[0], other});
    EXPECT_NE(told.find(key), std::string::npos) << told;
    EXPECT_NE(told.find("attitude_error_max is "), std::string::npos) << told;
    EXPECT_NE(told.find("0.125"), std::string::npos) << told;
}

TEST_F(Merge, RefusesWhatIsNotOfOneExperiment) {
    const std::vector<std::string> folders = run_shards(1);
    EXPECT_NE(refusal({folders[0], "/nowhere"}).find("is not a directory"), std::string::npos);
    fs::create_directories(directory_ / "empty");
    EXPECT_NE(refusal({(directory_ / "empty").string()}).find("contains no results"), std::string::npos);
    RunOptions other = options("other");
    run_experiment(plan(R"(, "about": "another")"), other, "test");
    EXPECT_NE(refusal({folders[0], other.directory}).find("does not record the same experiment"), std::string::npos);
    const fs::path record = fs::path(other.directory) / ".cases" / "t.experiment.json";
    std::string text = content(record);
    text.replace(text.find(running_program_key()), 4, "beef");
    std::ofstream(record) << text;
    EXPECT_NE(refusal({other.directory}).find("another build"), std::string::npos);
    std::ofstream(record) << "{";
    EXPECT_NE(refusal({other.directory}).find("t.experiment.json"), std::string::npos);
    // an empty directory beside others is a shard that has not started
    EXPECT_EQ(merge({folders[0], (directory_ / "empty").string()}, "fine").remarks.size(), 1U);
}

TEST_F(Merge, CopiesAStudyOfOneShard) {
    const Plan whole = make_plan(find_experiment("gimbal_lock"), "gimbal_lock", true);
    for (const int shard : {1, 2}) {
        RunOptions each = options("whole_" + std::to_string(shard));
        each.shard = shard, each.shards = 2, each.quick = true;
        run_experiment(whole, each, "test");
    }
    const MergeResult none = merge({(directory_ / "whole_2").string()}, "none");
    EXPECT_EQ(none.experiments[0].missing, 1);
    const MergeResult all = merge({(directory_ / "whole_2").string(), (directory_ / "whole_1").string()}, "all");
    EXPECT_EQ(all.experiments[0].missing, 0);
    EXPECT_EQ(files("all"), files("whole_1"));
    EXPECT_TRUE(pending_work(whole,
                             [&] {
                                 RunOptions done = options("all");
                                 done.quick = true;
                                 return done;
                             }())
                    .empty());
}

}  // namespace
}  // namespace polhode
