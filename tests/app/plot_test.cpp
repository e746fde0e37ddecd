// `polhode plot`: plots of files, and refused input.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "app/program_fixture.h"

namespace polhode {
namespace {

class Plot : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_to("a.csv", {"solve", "free_asymmetric", "--method", "odeint_rk4", "--steps", "400"});
        run_to("b.csv", {"solve", "free_asymmetric", "--method", "cvode_adams", "--tolerance", "1e-8"});
    }

    void run_to(const std::string& name, std::vector<std::string> arguments) const {
        arguments.insert(arguments.end(), {"--output", name});
        ASSERT_EQ(run(arguments).exit_code, 0);
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(directory / name) << text; }

    // one line on stderr, no plot
    void refused(const std::vector<std::string>& arguments, const std::string& named) const {
        const Outcome outcome = run(arguments);
        SCOPED_TRACE(testing::PrintToString(arguments) + "\n" + outcome.err);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(lines(outcome.err), 1);
        EXPECT_NE(outcome.err.find(named), std::string::npos) << "wanted: " << named;
        EXPECT_FALSE(fs::exists(directory / "f.svg"));
    }
};

TEST_F(Plot, DrawsErrorsOfSeveralFilesInCharacters) {
    const Outcome outcome = run({"plot", "a.csv", "b.csv", "--scene", "free_asymmetric"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos) << "colour codes in a file";
    for (const char* part : {"trajectories on free_asymmetric", "error (rad)", "time (s)", "a.csv", "b.csv", "0.001"})
        EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;
    EXPECT_EQ(lines(outcome.out), 26) << outcome.out;
    for (const char* quantity : {"omega", "energy", "momentum"})
        EXPECT_EQ(run({"plot", "a.csv", "--scene", "free_asymmetric", "--of", quantity}).exit_code, 0) << quantity;
}

TEST_F(Plot, DrawsFilesWithoutAScene) {
    const Outcome attitude = run({"plot", "a.csv", "--width", "60"});
    ASSERT_EQ(attitude.exit_code, 0) << attitude.err;
    for (const char* part : {"qw", "qx", "qy", "qz"}) EXPECT_NE(attitude.out.find(part), std::string::npos) << part;
    const Outcome omega = run({"plot", "a.csv", "--of", "omega"}), polhode = run({"plot", "a.csv", "--of", "polhode"});
    EXPECT_NE(omega.out.find("angular velocity, world axes"), std::string::npos);
    EXPECT_NE(polhode.out.find("angular velocity, body axes"), std::string::npos);
    EXPECT_NE(omega.out, polhode.out);
    // rates given in body axes are plotted in body axes
    EXPECT_NE(run({"plot", "a.csv", "--of", "omega", "--convention", "body-rates"}).out.find("body axes"),
              std::string::npos);
    const Outcome ellipsoid = run({"plot", "a.csv", "--of", "polhode", "--scene", "free_asymmetric"});
    EXPECT_EQ(ellipsoid.exit_code, 0);
    EXPECT_NE(ellipsoid.out.find("along w3"), std::string::npos) << ellipsoid.out;
}

TEST_F(Plot, WritesPictures) {
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"plot", "a.csv", "b.csv", "--scene", "free_asymmetric"},
                                               {"plot", "a.csv", "b.csv", "--of", "omega"},
                                               {"plot", "a.csv", "--of", "polhode", "--scene", "free_asymmetric"}})
        for (const std::string& name : {std::string("f.svg"), std::string("f.pdf")}) {
            std::vector<std::string> all = arguments;
            all.insert(all.end(), {"--output", name});
            const Outcome outcome = run(all);
            EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
            EXPECT_EQ(outcome.out, "");
            const std::string picture = read(directory / name);
            EXPECT_NE(picture.find(name == "f.svg" ? "</svg>" : "%PDF-"), std::string::npos) << name;
            fs::remove(directory / name);
        }
}

TEST_F(Plot, LeavesAGapWhereAFileHasNoNumbers) {
    std::string text = "t,qw,qx,qy,qz\n";
    for (int i = 0; i <= 100; ++i)
        text += i > 30 && i < 70 ? fmt::format("{},nan,nan,nan,nan\n", i) : fmt::format("{},1,0,0,0\n", i);
    write("gap.csv", text);
    const Outcome outcome = run({"plot", "gap.csv", "--width", "80"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    // qx is zero: a horizontal line with a gap of blanks
    EXPECT_TRUE(std::regex_search(outcome.out, std::regex("(⠉|⠤|⠒|⣀)+ {20,}(⠉|⠤|⠒|⣀)+"))) << outcome.out;
    EXPECT_EQ(run({"check", "free_asymmetric", "gap.csv"}).exit_code, 2) << "check requires numbers";
    const Outcome drawn = run({"plot", "gap.csv", "--output", "f.svg"});
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
}

TEST_F(Plot, DrawsSeveralBodies) {
    run_to("arm.csv", {"solve", "mechanisms/double_pendulum", "--method", "odeint_rk4", "--steps", "2000"});
    const Outcome each = run({"plot", "arm.csv"});
    ASSERT_EQ(each.exit_code, 0) << each.err;
    EXPECT_NE(each.out.find("arm.csv, "), std::string::npos) << each.out;
    const Outcome worst = run({"plot", "arm.csv", "--scene", "mechanisms/double_pendulum"});
    ASSERT_EQ(worst.exit_code, 0) << worst.err;
    EXPECT_NE(worst.out.find("worst body's error (rad)"), std::string::npos) << worst.out;
}

TEST_F(Plot, DrawsAMillionRows) {
    std::string text = "t,qw,qx,qy,qz,wx,wy,wz\n";
    for (int i = 0; i < 1'000'000; ++i) text += fmt::format("{},1,0,0,0,{},0,1\n", 1e-3 * i, i == 654'321 ? 100 : 1);
    write("many.csv", text);
    const Outcome outcome = run({"plot", "many.csv", "--of", "omega", "--output", "f.svg"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string svg = read(directory / "f.svg");
    EXPECT_LT(svg.size(), 2'000'000U);
    // the single outlier row is shown
    const Outcome shown = run({"plot", "many.csv", "--of", "omega"});
    EXPECT_NE(shown.out.find("100┤"), std::string::npos) << shown.out;
}

TEST_F(Plot, RefusesWhatItCannotDraw) {
    refused({"plot", "a.csv", "--of", "energy"}, "give --scene");
    refused({"plot", "a.csv", "--of", "momentum"}, "give --scene");
    refused({"plot", "a.csv", "--of", "speed"}, "--of");
    refused({"plot", "a.csv", "--width", "10"}, "give 40 to 1000");
    refused({"plot", "a.csv", "--width", "80", "--output", "f.svg"}, "remove --width or --output");
    refused({"plot", "a.csv", "--output", "f.png"}, ".svg");
    refused({"plot", "a.csv", "--output", "missing/f.svg"}, "missing");
    refused({"plot", "missing.csv"}, "missing.csv");
    refused({"plot", "a.csv", "--scene", "no_such_scene"}, "no_such_scene");
    refused({"plot", "a.csv", "b.csv", "--of", "polhode", "--scene", "free_asymmetric"}, "one file");
    refused({"plot", "a.csv", "--of", "polhode", "--scene", "mechanisms/double_pendulum"}, "one body");
    refused({"plot", "a.csv", "--convention", "sideways"}, "--convention");
    refused({"plot", "a.csv", "--columns", "t=x"}, "--columns");
    refused({"plot"}, "TRAJECTORY");
    write("late.csv", "t,qw,qx,qy,qz\n0,1,0,0,0\n1e6,1,0,0,0\n");
    refused({"plot", "late.csv", "--scene", "free_asymmetric", "--output", "f.svg"}, "late.csv: column t");
    write("bad.csv", "t,qw,qx,qy,qz\n0,1,0,0,0\n1,one,0,0,0\n");
    refused({"plot", "a.csv", "bad.csv", "--output", "f.svg"}, "bad.csv: line 3, column qw");
    write("empty.csv", "t,qw,qx,qy,qz\n0,nan,0,0,0\n");
    refused({"plot", "empty.csv", "--output", "f.svg"}, "empty.csv");
    write("still.csv", "t,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n");
    refused({"plot", "still.csv", "--of", "omega"}, "has no wx,wy,wz");
    refused({"plot", "still.csv", "--of", "omega", "--scene", "free_asymmetric"}, "has no wx,wy,wz");
}

}  // namespace
}  // namespace polhode
