// The leaderboard with user-defined engines: correct ones, one that crashes, one that hangs, one that is not
// available.
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/program_fixture.h"
#include "build_kind.h"
#include "experiment/run/findings.h"
#include "places.h"
#include "table/table.h"

namespace polhode {
namespace {

// This program as an engine: a method of the catalogue under another name.
nlohmann::json itself(const std::string& name, const std::string& method) {
    return {{"name", name},
            {"command", {program_path(), "solve", "/dev/stdin", "--method", method, "--samples", "{samples}"}},
            {"by_step", {"--step", "{step}"}}};
}
nlohmann::json script(const std::string& name, const std::string& then) {
    return {{"name", name},
            {"command", {"sh", "-c", R"(echo '{"version": "7", "settings": {"default": "odd"}}' >&3; )" + then}}};
}

class Engines : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        const nlohmann::json engines{
            {"engines",
             {itself("plain", "gyroscopic_none"), itself("implicit", "gyroscopic_implicit"),
              itself("good", "splitting4"), script("killed", "read -r request; kill -9 $$"),
              script("hung", "read -r request; exec sleep 600"),
              nlohmann::json{
                  {"name", "absent"}, {"command", {"/no/such/engine"}}, {"needs", "Debian's libnone-dev"}}}}};
        std::ofstream(directory / "mine.json") << engines;
        const nlohmann::json experiment{
            {"name", "few"},
            {"about", "Six engines"},
            {"kind", "engines"},
            {"scenes", {"t_handle", "thrown_hammer", "bouncing_ball"}},
            {"methods", {"/^(plain|implicit|good|killed|hung|absent):/", "gyroscopic_implicit"}},
            {"settings", {{"steps", {1.0 / 60, 1.0 / 240, 1e-3}}}},
            {"samples", 20},
            {"repeats", 1},
            {"seconds_per_run", optimised_build ? 0.5 : 2.5}};
        std::ofstream(directory / "few.json") << experiment;
    }
    Table table(const std::string& folder, const std::string& name) const {
        return parse_csv(read(directory / folder / (name + ".csv")));
    }
    std::string cell(const Table& table, const std::vector<Cell>& row, const char* column) const {
        return text_of(row[column_index(table, column)]);
    }
};

TEST_F(Engines, DescribeWhetherTheyEvaluateFormulas) {
    const nlohmann::json engines{
        {"engines",
         {script("without", "read -r request"), itself("by_step", "taylor"),
          nlohmann::json{
              {"name", "with"},
              {"command",
               {"sh", "-c", R"(echo '{"settings": {"default": "odd"}, "formulas": true}' >&3; read -r request)"}}}}}};
    std::ofstream(directory / "formulas.json") << engines;
    const auto describe = [&](const char* name) {
        const Outcome outcome = run({"describe", name, "--engines", "formulas.json"});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out;
    };
    EXPECT_NE(describe("with").find("  formulas loads given by formulas are evaluated at the start of each step\n"),
              std::string::npos);
    EXPECT_NE(describe("without").find("  formulas loads given by formulas are not supported\n"), std::string::npos);
    EXPECT_EQ(describe("by_step").find("  formulas "), std::string::npos);
}

TEST_F(Engines, EveryEngineHasARow) {
    const Outcome outcome = run({"run", "few.json", "--engines", "mine.json", "--output", "one"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

    // an engine that runs a method of the catalogue has exactly its errors
    const Table rows = table("one", "few");
    int compared = 0;
    for (const auto& row : rows.rows) {
        if (cell(rows, row, "method") != "implicit:default" || cell(rows, row, "status") != "ok") continue;
        for (const auto& other : rows.rows)
            if (cell(rows, other, "method") == "gyroscopic_implicit" &&
                cell(rows, other, "scene") == cell(rows, row, "scene") &&
                cell(rows, other, "setting") == cell(rows, row, "setting")) {
                EXPECT_EQ(cell(rows, row, "attitude_error_max"), cell(rows, other, "attitude_error_max"));
                ++compared;
            }
    }
    EXPECT_EQ(compared, 6);
    // a crash fails one row; a hang fails one row and ends the curve after two timeouts; planes are refused
    const auto message = [&](const std::string& method, const std::string& scene, std::size_t nth) {
        for (const auto& row : rows.rows)
            if (cell(rows, row, "method") == method && cell(rows, row, "scene") == scene && nth-- == 0)
                return cell(rows, row, "status") + ": " + cell(rows, row, "message");
        return std::string();
    };
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(message("killed:default", "t_handle", i), "failed: sh was terminated by signal 9");
    EXPECT_EQ(message("hung:default", "t_handle", 0).find("failed: sh was stopped: it did not answer within "), 0u);
    EXPECT_NE(message("hung:default", "t_handle", 1).find("the curve was cut"), std::string::npos);
    EXPECT_EQ(message("absent:default", "t_handle", 0),
              "unsupported: absent is not available: it needs Debian's libnone-dev");
    EXPECT_EQ(message("good:default", "bouncing_ball", 0),
              "unsupported: good:default does not support impacts on planes");

    // order: better updates first; engines that were not measured come last, without a place
    const Table leaders = table("one", "few_leaderboard");
    ASSERT_EQ(leaders.rows.size(), 6u);
    const auto leader = [&](std::size_t i, const char* column) { return cell(leaders, leaders.rows[i], column); };
    const char* const order[] = {"good", "implicit", "plain"};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(leader(i, "engine"), order[i]);
        EXPECT_EQ(leader(i, "place"), std::to_string(i + 1));
    }
    for (std::size_t i = 3; i < 6; ++i) EXPECT_EQ(leader(i, "place"), "");
    EXPECT_EQ(leader(5, "message"), "it needs Debian's libnone-dev");
    EXPECT_NEAR(std::atof(leader(0, "order").c_str()), 4, 0.3);
    EXPECT_NEAR(std::atof(leader(1, "order").c_str()), 1, 0.3);
    EXPECT_EQ(leader(0, "within_0.001"), "1/60 s");
    EXPECT_EQ(leader(2, "within_0.1"), "");

    // identity: the update that the engine matches, and whether the gyroscopic term acts
    const Table identity = table("one", "few_identity");
    EXPECT_EQ(cell(identity, identity.rows[0], "follows"), "gyroscopic_none");
    EXPECT_EQ(cell(identity, identity.rows[0], "gyroscopic_term"), "does not act");
    EXPECT_EQ(cell(identity, identity.rows[1], "follows"), "gyroscopic_implicit");
    EXPECT_EQ(cell(identity, identity.rows[1], "gyroscopic_term"), "acts");
    EXPECT_EQ(cell(identity, identity.rows[1], "repeats"), "yes");
    EXPECT_EQ(cell(identity, identity.rows[3], "version"), "7");

    const std::string page = read(directory / "one" / "few.md");
    for (const char* part :
         {"Six engines.", "no single scene decides it", "### plain", "The gyroscopic term does not act",
          "The motion matches `gyroscopic_implicit` to ", "The observed order of the attitude error is 4",
          "0.001 rad at steps up to 1/60 s", "### killed 7\n\nNot compared: sh was terminated by signal 9.",
          "Not compared: it needs Debian's libnone-dev.", "(few_default.svg)", "(few_scenes.md)"})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    EXPECT_TRUE(fs::exists(directory / "one" / "few_default.svg"));
}

// A second run gives the same numbers, except for times.
TEST_F(Engines, RepeatTheirRows) {
    for (const char* folder : {"one", "two"}) {
        const Outcome outcome = run(
            {"run", "few.json", "--engines", "mine.json", "--output", folder, "--filter", "/(plain|implicit|good):"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    const Table one = table("one", "few"), two = table("two", "few");
    ASSERT_EQ(one.rows.size(), two.rows.size());
    ASSERT_GT(one.rows.size(), 20u);
    for (std::size_t i = 0; i < one.rows.size(); ++i)
        for (std::size_t j = 0; j < one.columns.size(); ++j) {
            if (one.columns[j].find("seconds") != std::string::npos) continue;
            EXPECT_EQ(text_of(one.rows[i][j]), text_of(two.rows[i][j])) << one.columns[j] << " of row " << i;
        }
}

}  // namespace
}  // namespace polhode
