// The conditioning of a scene as printed by `describe`.
#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "app/program_fixture.h"
#include "build_kind.h"
#include "integrators/analysis/conditioning.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

class Describe : public Program {
  protected:
    /// Returns the section on conditioning of a scene's description.
    std::string described(const std::string& scene) const {
        const Outcome outcome = run({"describe", scene});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_LT(outcome.seconds, optimised_build ? 5 : 60);
        const std::size_t begin = outcome.out.find("\nConditioning\n") + 1;
        return outcome.out.substr(begin, outcome.out.find("\nPolhode", begin) - begin);
    }
    /// Returns the value in the first line that begins with `name`.
    static std::string said(const std::string& description, const std::string& name) {
        std::istringstream text(description);
        std::string line;
        while (std::getline(text, line))
            if (line.starts_with("  " + name)) return line.substr(30);
        return "";
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(directory / name) << text; }
};

TEST_F(Describe, PrintsKappaAndTheFloors) {
    const Conditioning c = conditioning(find_scene("near_separatrix"), {60});
    const std::string text = described("near_separatrix");
    EXPECT_NEAR(std::stod(said(text, "kappa(T)")) / c.state[0], 1, 1e-3);
    EXPECT_NEAR(std::stod(said(text, "floor in binary64")) / c.floor(0, float64_roundoff), 1, 0.05);
    EXPECT_NEAR(std::stod(said(text, "floor in binary32")) / c.floor(0, float32_roundoff), 1, 0.05);
    // the peak occurs during the flip at 45 s
    EXPECT_NE(said(text, "largest kappa").find("at t = 45"), std::string::npos);
}

// The floor of a sphere at binary32 is 2^-24 sqrt(1 + (w t)^2): beyond 10^-5 rad at t = 167.8 s for w = 1.
TEST_F(Describe, PrintsUntilWhenFloatErrorsAreMeaningful) {
    const std::string sphere =
        R"("body": {"mass": 1, "inertia": [2, 2, 2]}, "initial": {"angular_velocity": [0, 0, 1]})";
    write("tight.json", R"({"name": "s", "duration": 400, "tolerated": {"attitude": 1e-5}, )" + sphere + "}");
    write("loose.json", R"({"name": "s", "duration": 400, "tolerated": {"attitude": 1e-4}, )" + sphere + "}");
    write("silent.json", R"({"name": "s", "duration": 400, )" + sphere + "}");
    const std::string tight_text = described("tight.json");
    const std::string tight = said(tight_text, "binary32 engine"), before = "can be evaluated until t = ";
    ASSERT_TRUE(tight.starts_with(before)) << tight;
    EXPECT_NEAR(std::stod(tight.substr(before.size())), 1e-5 * 0x1p24, 0.3);
    EXPECT_NE(tight.find("tolerated by the scene"), std::string::npos) << tight;
    const std::string loose_text = described("loose.json");
    EXPECT_TRUE(said(loose_text, "binary32 engine").starts_with("can be evaluated for the whole run"));
    const std::string silent_text = described("silent.json");
    const std::string silent = said(silent_text, "binary32 engine");
    EXPECT_NE(silent.find("0.05 rad (by default)"), std::string::npos) << silent;
}

// A chain of 24 links: the output appears at once, for a fixed number of steps, and states how to compute the rest.
TEST_F(Describe, OfManyJointsComputesTheWholeConditioningOnRequest) {
    std::string bodies, joints;
    for (int i = 0; i < 24; ++i) {
        bodies += fmt::format(R"({}{{"name": "b{}", "body": {{"mass": 0.02, "inertia": [1e-6, 1e-6, 5e-7],
                                 "center_of_mass": [0, 0, -0.01]}}}})",
                              i > 0 ? ", " : "", i);
        joints += fmt::format(R"({}{{"name": "j{}", "type": "revolute", "parent": "{}", "child": "b{}", "damping": 0.01,
                                 "parent_point": [0, 0, {}], "axis": [{}, {}, 0], "initial": {{"rate": 0.25}}}})",
                              i > 0 ? ", " : "", i, i > 0 ? fmt::format("b{}", i - 1) : "world", i, i > 0 ? -0.025 : 0,
                              i % 2, 1 - i % 2);
    }
    write("hand.json", fmt::format(R"({{"name": "hand", "duration": 0.5, "bodies": [{}], "joints": [{}],
                                        "loads": [{{"type": "gravity", "acceleration": [0, 0, -9.81]}}]}})",
                                   bodies, joints));
    const Outcome brief = run({"describe", "hand.json"});
    ASSERT_EQ(brief.exit_code, 0) << brief.err;
    EXPECT_NE(brief.out.find("only until t = "), std::string::npos) << brief.out;
    EXPECT_NE(brief.out.find("`polhode describe --conditioning` computes it for the whole run"), std::string::npos);
    const Outcome whole = run({"describe", "hand.json", "--conditioning"});
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
    // 0.2 of it on an idle machine
    EXPECT_LT(brief.seconds, 0.6 * whole.seconds);
    EXPECT_EQ(whole.out.find("only until t = "), std::string::npos) << whole.out;
    EXPECT_NE(whole.out.find("kappa(T)"), std::string::npos) << whole.out;
    EXPECT_EQ(whole.out.find("--conditioning"), std::string::npos);
    // both outputs agree up to the section on conditioning
    EXPECT_EQ(brief.out.substr(0, brief.out.find("\nConditioning")),
              whole.out.substr(0, whole.out.find("\nConditioning")));
}

// 10^7 s on a spring take too long for a description: it reports the time reached and the results up to it.
TEST_F(Describe, ReportsThatConditioningStoppedEarly) {
    write("long.json", R"({"name": "long", "duration": 1e7, "tolerated": {"attitude": 1e-5},
                           "loads": [{"type": "spring", "stiffness": 1}],
                           "body": {"mass": 1, "inertia": [2, 2, 2]}, "initial": {"angular_velocity": [0, 0, 1]}})");
    const std::string text = described("long.json");
    const std::string limit = said(text, "only until t = ");
    EXPECT_NE(limit.find("stopped at the limit of"), std::string::npos) << limit;
    EXPECT_EQ(said(text, "kappa(T)"), "");
    EXPECT_GT(std::stod(said(text, "kappa(")), 1000);
    EXPECT_TRUE(said(text, "binary32 engine").starts_with("can be evaluated until t = "));
}

// The closed form of a free body covers all of 10^7 s: the phase drifts by t times the derivative of its rate by w.
TEST_F(Describe, CoversALongFreeMotion) {
    write("long.json", R"({"name": "long", "duration": 1e7,
                           "body": {"mass": 1, "inertia": [2, 2, 2]}, "initial": {"angular_velocity": [0, 0, 1]}})");
    // d attitude = t dw, dw in units of w = 1
    const std::string text = described("long.json");
    EXPECT_NEAR(std::stod(said(text, "kappa(T)")), 1e7, 1e4);
    EXPECT_NE(said(text, "computed by").find("closed form"), std::string::npos);
}

TEST_F(Describe, ReportsAFaultyFileLikeSolve) {
    write("radau.json", "{\"name\": \"a\", }");
    write("exact.json", R"({"name": "a", "duration": -1, "body": {"mass": 1, "inertia": [1, 1, 1]}})");
    for (const char* file : {"radau.json", "exact.json", "none.json"}) {
        const Outcome told = run({"describe", file});
        EXPECT_EQ(told.exit_code, 2);
        EXPECT_EQ(told.err, run({"solve", file}).err) << file;
    }
}

TEST_F(Describe, PrintsWhatAnExperimentRuns) {
    write("mine.json", R"({"name": "mine", "about": "Two by two", "scenes": ["lagrange_top", "t_handle"],
        "methods": ["exact", "cvode_adams", "gyroscopic_explicit"],
        "settings": {"steps": [0.1, 0.01, 0.001], "tolerances": [1e-4, 1e-8]}})");
    const Outcome told = run({"describe", "mine.json"});
    EXPECT_EQ(told.exit_code, 0) << told.err;
    // as many cases as `run --dry-run` lists
    const long cases = lines(run({"run", "mine.json", "--dry-run", "--quiet"}).out);
    for (const std::string& part : {"  cases    " + std::to_string(cases) + ",", std::string("Two by two"),
                                    std::string("gyroscopic_explicit, steps 0.1 to 0.001 (3)"),
                                    std::string("cvode_adams, tolerances 0.0001 to 1e-08 (2)")})
        EXPECT_NE(told.out.find(part), std::string::npos) << part << "\n" << told.out;
    EXPECT_EQ(run({"describe", "convergence"}).exit_code, 0);
}

}  // namespace
}  // namespace polhode
