// polhode truth: output, limits, and --certified.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/program_fixture.h"
#include "build_kind.h"
#include "integrators/truth/balls/certified.h"

namespace polhode {
namespace {

class Truth : public Program {};

TEST_F(Truth, CertifiedWithoutArbNamesThePackage) {
    if (!ball_arithmetic_version().empty()) GTEST_SKIP() << "built with Arb";
    const Outcome outcome = run({"truth", "free_asymmetric", "--certified"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines(outcome.err), 1);
    EXPECT_NE(outcome.err.find("libflint-arb-dev"), std::string::npos) << outcome.err;
}

TEST_F(Truth, CertifiedTableHasTheUsualColumnsAndItsBound) {
    if (ball_arithmetic_version().empty()) GTEST_SKIP() << "built without Arb";
    const Outcome outcome = run({"truth", "every_load", "--certified", "--digits", "30", "--samples", "2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find("# every_load: Taylor series with a proven defect"), 0u) << outcome.out;
    EXPECT_NE(outcome.out.find("\nt,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,bound\n"), std::string::npos);
    EXPECT_EQ(lines(outcome.out), 5);
    EXPECT_NE(outcome.err.find("proven"), std::string::npos) << outcome.err;
}

TEST_F(Truth, CertifiedJsonDescribesTheProof) {
    if (ball_arithmetic_version().empty()) GTEST_SKIP() << "built without Arb";
    const Outcome outcome = run({"truth", "free_asymmetric", "--certified", "--digits", "40", "--samples", "3",
                                 "--format", "json", "--output", "truth.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    const nlohmann::json truth = nlohmann::json::parse(read(directory / "truth.json"));
    EXPECT_EQ(truth["scene"], "free_asymmetric");
    EXPECT_EQ(truth["scene_hash"].get<std::string>().size(), 32u);
    EXPECT_EQ(truth["certified"], true);
    EXPECT_EQ(truth["method"], "closed form");
    EXPECT_EQ(truth["requested_digits"], 40);
    EXPECT_GE(truth["digits"], 40);
    EXPECT_GE(truth["working_bits"], 133);
    EXPECT_GE(truth["seconds"], 0);
    EXPECT_LE(std::stod(truth["radius"].get<std::string>()), 1e-40);
    ASSERT_EQ(truth["columns"].size(), 14u);
    EXPECT_EQ(truth["columns"][0], "t");
    EXPECT_EQ(truth["columns"][13], "vz");
    ASSERT_EQ(truth["samples"].size(), 4u);
    for (const nlohmann::json& sample : truth["samples"]) {
        ASSERT_EQ(sample.size(), 14u);
        EXPECT_TRUE(sample[0].is_string());
        for (std::size_t c = 1; c < 14; ++c) {
            EXPECT_EQ(sample[c].size(), 3u);
            EXPECT_LE(std::stod(sample[c]["radius"].get<std::string>()), 1e-40);
            EXPECT_GE(sample[c]["digits"], 40);
            EXPECT_TRUE(sample[c]["value"].is_string());
        }
    }
    EXPECT_EQ(truth["samples"][0][1]["value"], "1e0");
    EXPECT_EQ(truth["samples"][0][1]["radius"], "0");
}

// A ball dropped from 1 m above the floor: flight k lasts 2 e^k v / g, with v the speed of the first impact.
TEST_F(Truth, PrintsTheTimesOfImpacts) {
    const Outcome outcome = run({"truth", "bouncing_ball", "--samples", "2", "--format", "json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json truth = nlohmann::json::parse(outcome.out);
    const Outcome table = run({"truth", "bouncing_ball", "--samples", "2"});
    ASSERT_EQ(table.exit_code, 0) << table.err;
    ASSERT_EQ(truth["impact_times"].size(), 6u);
    EXPECT_LE(truth["impact_time_error"].get<double>(), 1e-16);
    constexpr double g = 9.80665, restitution = 0.8;
    double time = std::sqrt(2 / g), flight = 2 * time;
    for (std::size_t k = 0; k < 6; ++k) {
        const std::string told = truth["impact_times"][k];
        EXPECT_NEAR(std::stod(told), time, 1e-14) << k;
        EXPECT_NE(table.out.find("\n# impact " + std::to_string(k + 1) + " at t = " + told + " s\n"), std::string::npos)
            << table.out;
        flight *= restitution, time += flight;
    }
}

TEST_F(Truth, ProvenMotionsOfBodiesAreRowsOfTheirNames) {
    if (ball_arithmetic_version().empty()) GTEST_SKIP() << "built without Arb";
    const std::vector<std::string> asked{
        "truth",      "mechanisms/physical_pendulum", "--samples", "2", "--digits", "20", "--duration", "0.1",
        "--certified"};
    std::vector<std::string> as_json = asked;
    as_json.insert(as_json.end(), {"--format", "json"});
    const Outcome table = run(asked), outcome = run(as_json);
    ASSERT_EQ(table.exit_code, 0) << table.err;
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(table.out.find("\nt,body,qw,qx,qy,qz,wx,wy,wz,px,py,pz,vx,vy,vz,bound\n0,pendulum,"), std::string::npos);
    const nlohmann::json truth = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(truth["columns"][1], "body");
    ASSERT_EQ(truth["samples"].size(), 3u);
    // the same numbers in both formats, and |q| = 1
    for (const nlohmann::json& sample : truth["samples"]) {
        EXPECT_EQ(sample[1], "pendulum");
        std::string row = sample[0].get<std::string>() + ",pendulum";
        double square = 0;
        for (std::size_t c = 2; c < 15; ++c) {
            row.append(",").append(sample[c]["value"].get<std::string>());
            if (c < 6) square += std::pow(std::stod(sample[c]["value"].get<std::string>()), 2);
        }
        EXPECT_NEAR(square, 1, 1e-15);
        EXPECT_NE(table.out.find(row + ","), std::string::npos) << row;
    }
}

TEST_F(Truth, MoreDigitsThanCanBeHadAreRefused) {
    if (ball_arithmetic_version().empty()) GTEST_SKIP() << "built without Arb";
    const Outcome outcome = run({"truth", "lagrange_top", "--certified", "--digits", "5000", "--output", "truth.csv"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines(outcome.err), 1);
    EXPECT_NE(outcome.err.find("are available"), std::string::npos) << outcome.err;
    EXPECT_TRUE(fs::is_empty(directory));
}

TEST_F(Truth, ThatTakesTooLongIsGivenUp) {
    // an unusual duration, so that no cached truth exists
    std::vector<std::string> arguments{"truth", "every_load", "--duration", "987.654321", "--max-seconds", "0.01"};
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "polhode: no truth within the limit of 0.01 s\n");
    EXPECT_LT(outcome.seconds, optimised_build ? 2 : 60);
    if (ball_arithmetic_version().empty()) return;
    arguments.emplace_back("--certified");
    const Outcome certified = run(arguments);
    EXPECT_EQ(certified.exit_code, 1);
    EXPECT_EQ(certified.err, "polhode: no certified truth within the limit of 0.01 s\n");
    EXPECT_LT(certified.seconds, optimised_build ? 2 : 60);
}

}  // namespace
}  // namespace polhode
