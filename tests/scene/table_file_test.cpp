// Tables of formulas that are read from CSV files.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/scene_file.h"
#include "text/message.h"

namespace polhode {
namespace {

class TableFile : public ::testing::Test {
  protected:
    void SetUp() override {
        directory_ = ::testing::TempDir() + "polhode_table_file";
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

    void write(const std::string& content) const { std::ofstream(directory_ + "/thrust.csv") << content; }
    Scene read(const std::string& table) const {
        return parse_scene(
            R"({"name": "rocket", "duration": 1, "body": {"mass": 1, "inertia": [1, 2, 3]}, "tables": {"thrust": )" +
                table + R"(}, "loads": [{"type": "torque", "frame": "body", "formula": "[table(thrust, t), 0, 0]"}]})",
            "rocket.json", directory_);
    }
    std::string fault(const std::string& table) const {
        try {
            read(table);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }

    std::string directory_;
};

TEST_F(TableFile, HasTheNumbersOfTheFile) {
    const std::vector<double> x{0, 0.5, 2}, y{0, 90, 80};
    write("0, 0\n0.5, 90\n2, 80\n");
    EXPECT_EQ(read(R"({"file": "thrust.csv"})").tables.at(0).x, x);
    EXPECT_EQ(read(R"({"file": "thrust.csv"})").tables.at(0).y, y);
    write("# measured\nF,note,t\n0,a,0\n90,b,0.5\n80,c,2\n");
    const Scene named = read(R"({"file": "thrust.csv", "columns": ["t", "F"], "between": "cubic"})");
    EXPECT_EQ(named.tables.at(0).x, x);
    EXPECT_EQ(named.tables.at(0).y, y);
    EXPECT_EQ(named.tables.at(0).between, TableInterpolation::cubic);
    // a written scene contains the numbers
    EXPECT_EQ(parse_scene(write_scene(named), "copy.json").tables.at(0).y, y);
}

TEST_F(TableFile, NamesWhatIsWrong) {
    const auto expect = [&](const std::string& table, const std::string& place, const std::string& what) {
        const std::string found = fault(table);
        EXPECT_NE(found.find(place), std::string::npos) << found;
        EXPECT_NE(found.find(what), std::string::npos) << found;
    };
    const std::string file = R"({"file": "thrust.csv"})";
    expect(file, "thrust.csv", "");
    write("t,F\n0,0\n1,x\n");
    expect(file, "line 3, column 2", "is not a number");
    write("t,F\n0,0\n1\n");
    expect(file, "line 3, column 2", "is missing");
    write("t\n0\n1\n");
    expect(file, "line 1", "has 1 cell");
    write("t,F\n0,0\n1,1\n");
    expect(R"({"file": "thrust.csv", "columns": ["t", "force"]})", "/tables/thrust/columns/1",
           "is not a column of thrust.csv");
    expect(R"({"file": "thrust.csv", "columns": ["t"]})", "/tables/thrust/columns", "two names");
    expect(R"({"file": "thrust.csv", "x": [0, 1]})", "/tables/thrust/x", "together with");
    expect(R"({"x": [0, 1], "y": [0, 1], "columns": ["t", "F"]})", "/tables/thrust/columns", "without");
    write("0,0\n1,1\n");
    expect(R"({"file": "thrust.csv", "columns": ["t", "F"]})", "/tables/thrust/columns", "consists of numbers");
    write("1,0\n0,1\n");
    expect(file, "/tables/thrust/x/1", "not above");
    write("");
    expect(file, "/tables/thrust/x", "has 0 numbers");
    expect(R"({"file": "../thrust.csv"})", "thrust.csv", "");
}

}  // namespace
}  // namespace polhode
