// Tests the sentences of findings against numbers counted by hand.
#include "report/findings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace polhode {
namespace {

class FolderFindings : public ::testing::Test {
  protected:
    // Adds a successful run of the only experiment.
    FolderRow& add(const std::string& scene, const std::string& method, double attitude, double seconds) {
        if (folder.experiments.empty()) folder.experiments.push_back({"t", "", "sweep", "", false, {}});
        FolderRow row;
        row.scene = folder.scenes.place(scene), row.method = folder.methods.place(method);
        row.formulation = folder.formulations.place("reduced");
        row.kind = SettingKind::step, row["setting"] = 0.1;
        row["attitude_error_max"] = row["attitude_error_final"] = attitude, row["seconds_median"] = seconds,
        row["energy_error_max"] = 1;
        folder.rows.push_back(row);
        return folder.rows.back();
    }
    // The first finding whose title contains these words.
    Finding with(const std::string& words) const {
        std::string titles;
        for (const Finding& one : make_findings(folder)) {
            if (one.title.find(words) != std::string::npos) return one;
            titles += one.title + "\n";
        }
        ADD_FAILURE() << "no finding " << words << " among:\n" << titles;
        return {};
    }

    ResultFolder folder;
};

TEST_F(FolderFindings, ReportTheFastestMethodOnMostScenes) {
    // at 1e-9 rad, one scene has two methods to compare; at 1e-6 rad, all four scenes have
    for (const char* scene : {"a", "b b", "c", "d"}) {
        add(scene, "taylor", 1e-7, scene[0] == 'c' ? 5e-6 : 1e-6);
        add(scene, "cvode_adams", 1e-7, scene[0] == 'a' ? 4e-6 : scene[0] == 'b' ? 8e-6 : 2e-6);
    }
    add("d", "taylor", 1e-10, 3e-6), add("d", "extrapolation", 1e-10, 6e-6);
    const Finding fastest = with("is the fastest");
    EXPECT_EQ(fastest.title, "taylor is the fastest to 1e-6 rad on 3 of 4 scenes");
    // fastest time of the other library over the fastest time: 4, 8, 5/2 and 2
    EXPECT_EQ(fastest.text,
              "Elsewhere: cvode_adams on 1. The fastest method of another library takes 3.2 times as long (median of 4 "
              "scenes; at most 8 times, on b b).");
    EXPECT_EQ(fastest.link, "#section=work-precision&scene=a");
}

TEST_F(FolderFindings, ReportOneLibraryAndSeveralWinners) {
    const char* const winners[] = {"taylor", "taylor", "extrapolation", "dop853", "radau", "exact", "splitting4"};
    for (std::size_t i = 0; i < 7; ++i) {
        const std::string scene = "s" + std::to_string(i);
        add(scene, winners[i], 1e-10, 1e-6), add(scene, "moser_veselov2", 1e-10, 2e-6);
    }
    const Finding fastest = with("is the fastest");
    EXPECT_EQ(fastest.title, "taylor is the fastest to 1e-9 rad on 2 of 7 scenes");
    EXPECT_EQ(fastest.text,
              "Elsewhere: dop853 on 1, exact on 1, extrapolation on 1, radau on 1, ... All compared methods are from "
              "one library.");
}

TEST_F(FolderFindings, NameThePlainestOfTheLostAttitudes) {
    add("folder/scene", "article_as_written", 2, 1e-6)["energy_error_max"] = 1e-3;
    add("lagrange_top", "odeint_euler", 2, 1e-6)["energy_error_max"] = 1e-3;
    FolderRow& plain = add("lagrange top%", "article_as_written", 3, 1e-6);
    plain["energy_error_max"] = 2.5e-3, plain["momentum_error_max"] = 0.5, plain["setting"] = 0.02;
    add("lagrange_top", "article_as_written", 3, 1e-6).status = Status::unsupported;
    const Finding hidden = with("Energy hides");
    EXPECT_EQ(hidden.title, "Energy hides a lost attitude in 3 runs");
    EXPECT_EQ(hidden.text,
              "2 methods: attitude error above 1 rad, energy error below 1 %. article_as_written on lagrange top% with "
              "a step of 0.02 s: attitude 3 rad, momentum 0.5, energy 0.0025.");
    EXPECT_EQ(hidden.link, "#section=motion&scene=lagrange%20top%25&motion_methods=article_as_written");
}

TEST_F(FolderFindings, DistinguishBoundedAndGrowingErrors) {
    const auto series = [&](const std::string& method, const auto& energy) {
        add("free_asymmetric", method, 1e-3, 1e-6);
        FolderSeries one;
        one.scene = folder.scenes.place("free_asymmetric"), one.method = folder.methods.place(method);
        for (int k = 1; k <= 400; ++k) {
            one.t.push_back(k);
            for (auto& errors : one.errors) errors.push_back(energy(k));
        }
        folder.series.push_back(one);
    };
    series("splitting4", [](double t) { return 1e-6 * std::abs(std::sin(t)); });
    series("implicit_midpoint", [](double t) { return 1e-5 * std::abs(std::sin(2 * t)); });
    series("odeint_rk4", [](double t) { return 1e-9 * t; });
    const Finding growth = with("drift");
    EXPECT_EQ(growth.title, "2 methods without energy drift, 1 with energy errors that grow in proportion to time");
    EXPECT_EQ(growth.text, "Without drift: implicit_midpoint, splitting4. The longest run lasts 400 s.");
    // the fit itself: attitude errors are fitted up to 1 rad
    const auto exponents = fit_growth(folder.series.back());
    ASSERT_TRUE(exponents[0] && exponents[2]);
    EXPECT_NEAR(exponents[2]->first, 1, 0.02);
    folder.series.back().errors[1].back() = absent;
    EXPECT_FALSE(fit_growth(folder.series.back())[1]);
    // there is no finding without a growing error
    folder.series.pop_back();
    for (const Finding& one : make_findings(folder)) EXPECT_EQ(one.title.find("drift"), std::string::npos) << one.title;
}

TEST_F(FolderFindings, CountOrdersThatAreNotThoseClaimed) {
    const auto curve = [&](const std::string& method, double order) {
        for (const double h : {0.1, 0.05, 0.025, 0.0125})
            add("free_asymmetric", method, 0.5 * std::pow(h, order), absent)["setting"] = h;
    };
    curve("odeint_rk4", 4), curve("splitting4", 4), curve("odeint_euler", 1);
    EXPECT_EQ(with("orders").title, "All 3 observed orders match the claimed orders");
    curve("implicit_midpoint", 1.5);
    const Finding off = with("orders");
    EXPECT_EQ(off.title, "3 of 4 observed orders match the claimed orders");
    EXPECT_EQ(off.text,
              "Matches are within 0.2. Largest difference: implicit_midpoint on free_asymmetric, 1.50 observed, 2 "
              "claimed.");
    EXPECT_EQ(off.link, "#section=convergence&scene=free_asymmetric");
}

TEST_F(FolderFindings, CountWhatFailedAndWhatReachesTheFloor) {
    add("a", "taylor", 2e-14, absent)["float64_floor"] = 1e-14;
    add("a", "cvode_adams", 5e-12, absent)["float64_floor"] = 1e-14;
    for (const Status status : {Status::diverged, Status::diverged, Status::failed, Status::unsupported})
        add("b", "odeint_euler", absent, absent).status = status;
    add("b", "odeint_rk4", absent, absent).status = Status::tolerance_not_met;
    const Finding failures = with("did not succeed");
    EXPECT_EQ(failures.title, "4 of 7 runs did not succeed");
    EXPECT_EQ(failures.text,
              "2 diverged, 1 did not meet the tolerance, 1 failed. The method with most of them is odeint_euler (3).");
    EXPECT_EQ(failures.link, "#section=work-precision&scene=b");
    const Finding floor = with("floor");
    EXPECT_EQ(floor.title, "1 of 2 methods reach the binary64 rounding floor");
    EXPECT_EQ(floor.text,
              "Their errors are at most 10 times the floor. The closest is taylor on a: error 2e-14 rad, floor 1e-14 "
              "rad.");
}

TEST_F(FolderFindings, ReportTheGainOfTheReducedFormulation) {
    FolderTable torn{"x_gain", "x", "", {{"scene", "method"}, {{std::string("a"), std::string("m")}}}, 1};
    FolderTable table{"y_gain", "y", "", {{"scene", "method", "gain"}, {}}, 4};
    for (const auto& [scene, gain] :
         {std::pair{"a", "1.5"}, std::pair{"b", "3"}, std::pair{"c", "2"}, std::pair{"d", ""}})
        table.table.rows.push_back({std::string(scene), std::string("cvode_adams"), std::string(gain)});
    folder.tables = {torn, table};
    const Finding gain = with("reduced formulation");
    EXPECT_EQ(gain.title, "The reduced formulation is 2 times as fast as the full one");
    EXPECT_EQ(gain.text, "Median of 3 pairs. The largest factor is 3, on b with cvode_adams.");
    folder.tables = {torn};
    EXPECT_TRUE(make_findings(folder).empty());
}

TEST_F(FolderFindings, AreThreeAtMost) {
    for (const char* scene : {"a", "b"}) add(scene, "taylor", 1e-10, 1e-6), add(scene, "cvode_adams", 1e-10, 2e-6);
    add("a", "odeint_euler", 2, 1e-6)["energy_error_max"] = 1e-3;
    add("a", "odeint_euler", 2, 1e-6).status = Status::failed;
    folder.rows.front()["float64_floor"] = 1e-12;
    const std::vector<Finding> all = make_findings(folder);
    ASSERT_EQ(all.size(), 3u);
    EXPECT_NE(all[0].title.find("fastest"), std::string::npos);
    EXPECT_NE(all[1].title.find("Energy"), std::string::npos);
    EXPECT_NE(all[2].title.find("did not succeed"), std::string::npos);
}

}  // namespace
}  // namespace polhode
