// The command `fit`.
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/program_fixture.h"

namespace polhode {
namespace {

class FitCommand : public Program {
  protected:
    void write(const char* name, const std::string& text) const { std::ofstream(directory / name) << text; }
};

// The moments of a body from the rates that the program prints for other moments than the first guess.
TEST_F(FitCommand, FindsTheNumbersOfASimulatedBody) {
    const std::string text = R"({"name": "satellite", "duration": 20, "body": {"mass": 1, "inertia": [MOMENT, 2, 2.5]},
        "initial": {"angular_velocity": [0.5, 1, 0.2], "angular_velocity_frame": "world"}})";
    const auto with = [&](const char* moment) { return std::string(text).replace(text.find("MOMENT"), 6, moment); };
    write("true.json", with("1.25"));
    write("guess.json", with("1"));
    ASSERT_EQ(run({"solve", "true.json", "--samples", "50", "--output", "data.csv"}).exit_code, 0);
    const Outcome outcome =
        run({"fit", "guess.json", "data.csv", "--parameter", "/body/inertia/0", "--parameter",
             "/initial/angular_velocity/2", "--covariance", "covariance.csv", "--output", "fitted.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("fit       2 numbers, 13 columns at 51 times"), std::string::npos) << outcome.err;
    const auto fitted = nlohmann::json::parse(read(directory / "fitted.json"));
    EXPECT_NEAR(fitted["body"]["inertia"][0].get<double>(), 1.25, 1e-8);
    EXPECT_NEAR(fitted["initial"]["angular_velocity"][2].get<double>(), 0.2, 1e-8);
    const std::string table = read(directory / "covariance.csv");
    EXPECT_EQ(table.substr(0, table.find('\n')), "parameter,value,error,/body/inertia/0,/initial/angular_velocity/2");
    EXPECT_EQ(lines(table), 3);
}

TEST_F(FitCommand, EndsWithOneIfTheDataDoNotDetermineANumber) {
    write("data.csv", "t,wx\n0,1\n1,1\n");
    const Outcome outcome =
        run({"fit", "free_asymmetric", "data.csv", "--parameter", "/body/mass", "--output", "fitted.json"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("failed: the data do not depend on /body/mass"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(directory / "fitted.json"));
}

TEST_F(FitCommand, RefusesBadInput) {
    const std::vector<std::string> command{"fit", "free_asymmetric", "/dev/null", "--parameter", "/body/mass"};
    expect_refused(command, "/dev/null: is empty; give a header");
    auto longer = command;
    longer.insert(longer.end(), {"--deviation", "-1"});
    expect_refused(longer, "--deviation is -1; give a finite number > 0");
    longer = command;
    longer.insert(longer.end(), {"--parameter", "/body/mass"});
    expect_refused(longer, "--parameter /body/mass is given twice; remove one");
    expect_refused({"fit", "free_asymmetric", "missing.csv", "--parameter", "/body/mass"}, "missing.csv");
    expect_refused({"fit", "free_asymmetric", "/dev/null"}, "--parameter");
}

}  // namespace
}  // namespace polhode
