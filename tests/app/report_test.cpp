// polhode report, with its document read by an independent parser.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/program_fixture.h"
#include "report/document_text.h"

namespace polhode {
namespace {

class Report : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        // a minimal front end: the real one is built with Node, which these tests do not require
        front_end = directory.string() + ".html";
        std::ofstream(front_end) << page_template;
    }
    void TearDown() override {
        fs::remove(front_end);
        Program::TearDown();
    }
    Outcome report(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "report");
        return run(arguments, [this] { ::setenv("POLHODE_REPORT_PAGE", front_end.c_str(), 1); });
    }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((directory / name).parent_path());
        std::ofstream(directory / name, std::ios::binary) << text;
    }
    nlohmann::json document(const std::string& name) const {
        return nlohmann::json::parse(document_text(read(directory / name)));
    }
    void run_small(const std::string& folder) const {
        write("small.json", R"({"name": "small", "about": "Two by two", "scenes": ["free_asymmetric", "lagrange_top"],
              "methods": ["taylor", "article_as_written"], "settings": {"tolerances": [1e-5, 1e-8], "steps": [0.05, 0.01]},
              "repeats": 1})");
        ASSERT_EQ(run({"run", "small.json", "--output", folder, "--quiet"}).exit_code, 0);
    }
    std::string front_end;
};

TEST_F(Report, MakesAPageOfOneLesson) {
    const Outcome outcome = report({"--lesson", "spinning_top"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json page = document("spinning_top.html");
    EXPECT_EQ(page["lesson_page"], true);
    EXPECT_EQ(page["lessons"][0]["scene"], "lagrange_top");
    EXPECT_EQ(page["rows"]["count"], 0);
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{},
                                                  {"--lesson", "none"},
                                                  {"here", "--lesson", "poinsot"},
                                                  {"--lesson", "poinsot", "--without-motions"},
                                                  {"--lesson", "poinsot", "--output", "page.txt"}}) {
        const Outcome refused = report(wrong);
        EXPECT_EQ(refused.exit_code, 2);
        EXPECT_EQ(lines(refused.err), 1) << refused.err;
    }
    EXPECT_FALSE(fs::exists(directory / "poinsot.html"));
}

TEST_F(Report, ShowsTheContentOfTheTables) {
    run_small("here");
    const Outcome outcome = report({"here"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    const nlohmann::json page = document("here/report.html");
    EXPECT_EQ(page["format"], 1);
    EXPECT_EQ(page["folder"], "here");
    EXPECT_EQ(page["experiments"][0]["about"], "Two by two");
    EXPECT_EQ(page["scenes"].size(), 2u);
    // the rows of the table, to five digits
    const std::string table = read(directory / "here/small.csv");
    EXPECT_EQ(page["rows"]["count"], lines(table) - 1);
    EXPECT_EQ(page["rows"]["attitude"].size(), static_cast<std::size_t>(lines(table) - 1));
    const auto& methods = page["methods"];
    for (const auto& method : methods) {
        EXPECT_NE(method["documentation"], "");
        EXPECT_GT(method["family"], 0);
    }
    // motions of both scenes: taylor is drawn as the truth, the article's update has a separate motion
    ASSERT_EQ(page["motions"].size(), 2u);
    for (const auto& motion : page["motions"])
        for (const auto& method : motion["methods"]) {
            const bool article = method["label"] == "article_as_written";
            if (method["status"] == 1) continue;
            EXPECT_EQ(method["track"].is_null(), !article) << method["label"];
            EXPECT_LE(motion["thinning"]["angle"], 1e-2);
            if (!article) {
                EXPECT_LT(method["difference"], 1e-3);
            }
        }
    EXPECT_FALSE(page["findings"].empty());
    EXPECT_TRUE(page["comparison"].is_null());
}

TEST_F(Report, ShowsContactsAndJoints) {
    write("events.json", R"({"name": "events", "about": "Contacts and joints",
          "scenes": ["contact/bowling_ball", "joints/pendulum_with_stops", "mechanisms/double_pendulum"], "methods": ["taylor"],
          "settings": {"tolerances": [1e-8]}, "repeats": 1})");
    ASSERT_EQ(run({"run", "events.json", "--output", "here", "--quiet"}).exit_code, 0);
    ASSERT_EQ(report({"here"}).exit_code, 0);
    const nlohmann::json page = document("here/report.html");
    const auto motion_of = [&](const std::string& name) {
        for (const auto& scene : page["scenes"])
            if (scene["name"] == name) return page["motions"][scene["motion"].get<std::size_t>()];
        return nlohmann::json();
    };
    // Hopkins and Patterson 1977: the ball slides on a parabola until t = 2 |u| / (7 mu g)
    const nlohmann::json ball = motion_of("contact/bowling_ball");
    const double u = std::hypot(8 - 10 * 0.109, -0.5 - 30 * 0.109), rolls = 2 * u / (7 * 0.12 * 9.8);
    EXPECT_EQ(ball["timeline"]["rows"][0]["name"], "lane");
    EXPECT_EQ(ball["timeline"]["events"][0]["kind"], "rolls");
    EXPECT_NEAR(ball["timeline"]["events"][0]["t"].get<double>(), rolls, 1e-6);
    EXPECT_EQ(ball["contacts"].size(), 1u);
    EXPECT_TRUE(ball["coordinates"].is_null());
    const nlohmann::json stops = motion_of("joints/pendulum_with_stops");
    EXPECT_GE(stops["timeline"]["events"].size(), 3u);
    EXPECT_EQ(stops["coordinates"]["curves"][0]["upper"], 0.5);
    for (const auto& angle : stops["coordinates"]["curves"][0]["x"]) {
        EXPECT_GE(angle.get<double>(), -0.25001);
        EXPECT_LE(angle.get<double>(), 0.50001);
    }
    const nlohmann::json pendulum = motion_of("mechanisms/double_pendulum");
    EXPECT_TRUE(pendulum["timeline"].is_null());
    EXPECT_EQ(pendulum["coordinates"]["curves"].size(), 2u);
    for (const auto& motion : page["motions"]) EXPECT_EQ(motion["remark"], "");
}

TEST_F(Report, ComparesAFolderWithItself) {
    run_small("here");
    ASSERT_EQ(report({"here", "--against", "here", "--output", "mine.html", "--without-motions"}).exit_code, 0);
    const nlohmann::json page = document("mine.html");
    EXPECT_FALSE(fs::exists(directory / "here/report.html"));
    EXPECT_TRUE(page["motions"].empty());
    EXPECT_EQ(page["comparison"]["matched"], page["rows"]["total"]);
    EXPECT_EQ(page["comparison"]["same_bits"], page["rows"]["total"]);
    EXPECT_EQ(page["comparison"]["all"]["ratio"], 1);
}

TEST_F(Report, ComparesAndDrawsUserTrajectories) {
    run_small("here");
    ASSERT_EQ(run({"solve", "free_asymmetric", "--method", "article_as_written", "--step", "0.01", "--samples", "500",
                   "--output", "free_asymmetric.csv"})
                  .exit_code,
              0);
    ASSERT_EQ(report({"here", "--trajectory", "free_asymmetric.csv"}).exit_code, 0);
    const nlohmann::json page = document("here/report.html");
    ASSERT_EQ(page["checks"].size(), 1u);
    const auto& check = page["checks"][0];
    EXPECT_EQ(check["passed"], false);
    EXPECT_EQ(check["file"], "free_asymmetric.csv");
    EXPECT_FALSE(check["diagnoses"].empty());
    EXPECT_EQ(check["errors"][0]["values"].size(), check["t"].size());
    const auto& scene = page["scenes"][check["scene"].get<std::size_t>()];
    const auto& motion = page["motions"][scene["motion"].get<std::size_t>()];
    const auto& drawn = motion["methods"][check["motion_method"].get<std::size_t>()];
    EXPECT_EQ(drawn["label"], "free_asymmetric.csv");
    EXPECT_EQ(drawn["method"], -1);
    EXPECT_FALSE(drawn["track"].is_null());
    // the error is the one that check reports
    EXPECT_NEAR(check["blocks"][0]["error"].get<double>(), drawn["difference"].get<double>(), 0.05);
}

TEST_F(Report, ShowsHostileNamesLiterally) {
    const std::string name = "</script><script>alert(1)</script>'\"`\n";
    std::string field = "\"";
    for (const char c : name) field += c == '"' ? "\"\"" : std::string(1, c);
    field += '"';
    const std::string big(10'000, 'x');
    write(
        "here/t.csv",
        "experiment,scene,method,setting_kind,setting,status,seconds_min,seconds_median,repeats,steps,rhs_evaluations,"
        "attitude_error_final,attitude_error_max,omega_error_max,energy_error_max,momentum_error_max,norm_error_max,"
        "message\nt," +
            field + "," + big + ",step,0.1,ok,1,1,1,1,1,nan,NaN,inf,-inf,,0,\n");
    ASSERT_EQ(report({"here"}).exit_code, 0);
    const std::string text = read(directory / "here/report.html");
    EXPECT_EQ(text.find("alert(1)"), std::string::npos);
    const nlohmann::json page = document("here/report.html");
    EXPECT_EQ(page["scenes"][0]["name"], name);
    EXPECT_EQ(page["methods"][0]["name"], big);
    EXPECT_TRUE(page["rows"]["attitude"][0].is_null());
    EXPECT_TRUE(page["rows"]["omega"][0].is_null());
}

TEST_F(Report, FitsManyRowsIntoAPage) {
    const int rows = 120'000;
    std::string text =
        "experiment,scene,method,setting_kind,setting,status,seconds_min,seconds_median,repeats,steps,rhs_evaluations,"
        "attitude_error_final,attitude_error_max,omega_error_max,energy_error_max,momentum_error_max,norm_error_max,"
        "message\n";
    unsigned random = 1;
    for (int i = 0; i < rows; ++i) {
        char line[300];
        const auto number = [&] { return std::pow(10.0, -(random = random * 1664525u + 1013904223u) / 4.3e8); };
        std::snprintf(line, sizeof line,
                      "t,scene_%d,method_%d,step,%.6g,ok,%.17g,%.17g,3,%d,%d,%.17g,%.17g,%.17g,%.17g,"
                      "%.17g,%.17g,\n",
                      i / 1200, i / 30 % 40, std::pow(0.8, i % 30), number(), number(), i % 5000, i % 5000, number(),
                      number(), number(), number(), number(), number());
        text += line;
    }
    write("here/t.csv", text);
    const Outcome outcome = report({"here"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_LT(fs::file_size(directory / "here/report.html"), 5'000'000u);
    const nlohmann::json page = document("here/report.html");
    EXPECT_EQ(page["rows"]["total"], rows);
    EXPECT_GE(page["rows"]["count"], 60'000);
    EXPECT_NE(page["remarks"][0].get<std::string>().find("of 120000 result rows"), std::string::npos);
    // all curves are there
    EXPECT_EQ(page["methods"].size(), 40u);
}

TEST_F(Report, AnEmptyTableIsNoFault) {
    write("here/t.csv", "experiment,scene,method,setting_kind,setting,status,attitude_error_max,message\n");
    ASSERT_EQ(report({"here"}).exit_code, 0);
    EXPECT_EQ(document("here/report.html")["rows"]["count"], 0);
}

TEST_F(Report, RefusesBadInputAndWritesNothing) {
    expect_refused({"report"}, "DIR");
    expect_refused({"report", "none"}, "none: does not exist; give a directory");
    expect_refused({"report", "/dev/null"}, "is not a directory");
    expect_refused({"report", "."}, "contains no table (.csv)");
    expect_refused({"report", ".", "--output", "a.pdf"}, "give NAME.html");
    expect_refused({"report", ".", "--output", "none/a.html"}, "none");
    expect_refused({"report", ".", "--scene", "t_handle"}, "--trajectory");
    expect_refused({"report", ".", "--jobs", "-1"}, "give 1 to 4096");
    write("here/t.csv", "experiment,scene,method,setting_kind,setting,status,attitude_error_max,message\n");
    const auto refused = [&](const std::vector<std::string>& arguments, const std::string& words) {
        const Outcome outcome = report(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
        EXPECT_FALSE(fs::exists(directory / "here/report.html"));
    };
    refused({"here", "--against", "there"}, "there: does not exist");
    refused({"here", "--trajectory", "mine.csv"}, "give --scene SCENE");
    refused({"here", "--trajectory", "mine.csv", "--scene", "t_handle"}, "mine.csv");
    refused({"here", "--trajectory", "mine.csv", "--scene", "t_handl"}, "t_handle");
    refused({"here", "--trajectory", "mine.csv", "--scene", "t_handle", "--convention", "y-upp"}, "y-up");
}

TEST_F(Report, ReportsHowToBuildAMissingFrontEnd) {
    write("here/t.csv", "experiment,scene,method,setting_kind,setting,status,attitude_error_max,message\n");
    const Outcome outcome = run({"report", "here"}, [] { ::setenv("POLHODE_REPORT_PAGE", "/nowhere/page.html", 1); });
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err, "polhode: POLHODE_REPORT_PAGE is /nowhere/page.html, which is not a file; unset it\n");
    EXPECT_FALSE(fs::exists(directory / "here/report.html"));
}

}  // namespace
}  // namespace polhode
