#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "places.h"

namespace {

namespace fs = std::filesystem;

struct Report {
    int status = -1;
    std::string text;
};

Report look(const std::string& script, const fs::path& tree) {
    Report report;
    const std::string command = "'" + polhode::source_dir() + "/tests/" + script + "' '" + tree.string() + "' 2>&1";
    FILE* pipe = ::popen(command.c_str(), "r");  // NOLINT(cert-env33-c)
    if (pipe == nullptr) return report;
    for (char buffer[4096]; const std::size_t read = std::fread(buffer, 1, sizeof buffer, pipe);)
        report.text.append(buffer, read);
    const int status = ::pclose(pipe);
    report.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return report;
}

// A source tree of a few files, each of which includes one other file.
class SmallTree : public ::testing::Test {
  protected:
    SmallTree() {
        std::string pattern = (fs::temp_directory_path() / "polhode-tree-XXXXXX").string();
        top_ = ::mkdtemp(pattern.data());
        file("src/body/shape.h", "text/message.h");
        file("integrators/run/march.h", "integrators/method.h");
    }
    ~SmallTree() override { fs::remove_all(top_); }

    void file(const std::string& path, const std::string& included) const {
        fs::create_directories((top_ / path).parent_path());
        std::ofstream(top_ / path) << "#pragma once\n#include <cmath>\n#include \"" << included << "\"\n";
    }
    void expect_fault(const std::string& fault) const {
        const Report report = look("include_graph", top_);
        EXPECT_EQ(report.status, 1);
        EXPECT_NE(report.text.find(fault), std::string::npos) << report.text;
    }
    fs::path top_;
};

TEST(IncludeGraph, GoesOneWayThroughTheHouse) {
    const Report report = look("include_graph", polhode::source_dir());
    EXPECT_EQ(report.status, 0) << report.text;
}

TEST_F(SmallTree, PrintsItsArrows) {
    const Report report = look("include_graph", top_);
    EXPECT_EQ(report.status, 0);
    EXPECT_EQ(report.text, "body -> text\nintegrators/run -> integrators\n");
}

TEST_F(SmallTree, FailsOnAnUpwardInclude) {
    file("src/motion/problem.h", "integrators/method.h");
    expect_fault("src/motion/problem.h:3: motion includes integrators/method.h, which is in a higher layer");
}

TEST_F(SmallTree, FailsOnACircleOnOneFloor) {
    file("integrators/odeint/odeint.h", "integrators/geometric/projection.h");
    file("integrators/geometric/projection.h", "integrators/sundials/cvode.h");
    file("integrators/sundials/cvode.h", "integrators/odeint/odeint.h");
    expect_fault(
        "integrators/geometric/projection.h:3: integrators/geometric includes integrators/sundials, which is part of a "
        "cycle");
}

TEST_F(SmallTree, FailsWhereIntegratorsAndMeasureKnowEachOther) {
    file("integrators/own/exact.cpp", "measure/errors.h");
    expect_fault("integrators and measure must not include each other");
}

TEST_F(SmallTree, FailsOnADirectoryWithoutALayer) {
    file("src/attic/rope.h", "body/shape.h");
    expect_fault("attic belongs to no layer");
}

TEST_F(SmallTree, FailsWhereEigenSeesTheProcessor) {
    std::ofstream(top_ / "src/body/shape.h") << "#pragma once\n#include <Eigen/Dense>\n";
    expect_fault("src/body/shape.h:2: includes Eigen directly; include integrators/series/linear_algebra.h instead");
}

TEST(OneDefinition, OfEachType) {
    const Report report = look("one_definition", polhode::source_dir());
    EXPECT_EQ(report.status, 0) << report.text;
}

TEST_F(SmallTree, FailsOnTwoTypesOfOneName) {
    const auto define = [&](const std::string& path, const std::string& text) {
        std::ofstream(top_ / path, std::ios::app) << text;
    };
    define("src/body/shape.h", "namespace polhode {\nstruct Found {\n    int count;\n};\n}  // namespace polhode\n");
    // allowed: an anonymous namespace, another namespace, a declaration only, a specialisation
    define("integrators/run/march.h",
           "namespace polhode {\nstruct Found;\nnamespace {\nstruct Found {};\n}  // namespace\n"
           "template <>\nstruct Found<int> {};\nnamespace truth {\nclass Found final {};\n}  // namespace truth\n"
           "}  // namespace polhode\n");
    EXPECT_EQ(look("one_definition", top_).status, 0);
    define("integrators/run/march.h",
           "namespace polhode {\nclass Found : public Base {\n};\n}  // namespace polhode\n");
    const Report report = look("one_definition", top_);
    EXPECT_EQ(report.status, 1);
    EXPECT_EQ(report.text, "polhode::Found is defined in src/body/shape.h:5 and integrators/run/march.h:16\n");
}

}  // namespace
