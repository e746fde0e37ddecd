#include "figure/character_plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "figure/thinned.h"

namespace polhode {
namespace {

Curve line_of(const std::string& label, const std::vector<double>& x, const std::vector<double>& y) {
    Curve curve;
    curve.label = label, curve.x = x, curve.y = y;
    return curve;
}

Figure straight() {
    Panel panel{"attitude", "time (s)", "error (rad)", false, true, {}};
    panel.curves = {line_of("rising.csv", {0, 10}, {1e-9, 1e-3}), line_of("level.csv", {0, 10}, {1e-6, 1e-6})};
    return {"errors", 1, {panel}, "", false};
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::size_t characters(const std::string& line) {
    return static_cast<std::size_t>(
        std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

TEST(CharacterPlot, DrawsAxesCurvesAndALegend) {
    EXPECT_EQ(character_plot(straight(), {60, 8, false}), R"(errors
attitude: error (rad)
0.001┤                                                ⢀⣀⡠⠤⠒⠒
     │                                         ⢀⣀⠤⠤⠒⠊⠉⠁
     │                                  ⣀⣀⠤⠤o⠊⠉⠁
     │                           ⣀⣀⠤⠔⠒⠊⠉
1e-06┤⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉x⠉⠉⠉⠉⠉⠉⠉⠉o⡩⠭⠝⠛⠉⠉⠉⠉x⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉x⠉⠉⠉⠉⠉⠉
     │            ⢀⣀⡠⠤⠒⠒⠉⠉
     │     ⢀⣀⡠⠤⠒⠒⠉⠁
1e-09┤⠤⠤o⠊⠉⠁
     └┬──────────────────────────┬─────────────────────────┬
      0                          5                        10
                            time (s)
⠤o⠤ rising.csv   ⠤x⠤ level.csv
)");
}

TEST(CharacterPlot, KeepsToItsWidth) {
    Figure figure = straight();
    figure.title = std::string(300, 'a');
    figure.panels[0].curves[0].label = std::string(300, 'b');
    figure.panels.push_back(figure.panels[0]);
    figure.panels[1].log_y = false;
    for (const int width : {1, 40, 63, 100, 250})
        for (const std::string& line : lines_of(character_plot(figure, {width, 6, false})))
            EXPECT_LE(characters(line), static_cast<std::size_t>(std::max(40, width))) << line;
}

TEST(CharacterPlot, HasColorsOnlyWhereAsked) {
    const std::string plain = character_plot(straight(), {60, 6, false}),
                      colored = character_plot(straight(), {60, 6, true});
    EXPECT_EQ(plain.find('\x1b'), std::string::npos);
    EXPECT_NE(colored.find("\x1b[36m"), std::string::npos);
    EXPECT_NE(colored.find("\x1b[33m"), std::string::npos);
    // every escape sequence that starts on a line is reset on that line
    for (const std::string& line : lines_of(colored)) {
        const std::size_t last = line.rfind("\x1b[");
        if (last == std::string::npos) continue;
        EXPECT_EQ(line.substr(last, 4), "\x1b[0m") << line;
    }
}

TEST(CharacterPlot, DrawsWhatCanBeDrawn) {
    const double infinity = std::numeric_limits<double>::infinity();
    Figure figure = straight();
    figure.panels[0].curves = {line_of("bad", {0, 1, 2, 3}, {-1, infinity, std::nan(""), 0})};
    EXPECT_NE(character_plot(figure, {}).find("no data to plot"), std::string::npos);
    figure.panels[0].curves[0].y[1] = 1;
    EXPECT_EQ(character_plot(figure, {}).find("no data to plot"), std::string::npos);
    figure.panels[0].log_y = false;
    figure.panels[0].curves = {line_of("huge", {0, 1}, {-1e300, 1e300}), line_of("still", {1, 1}, {0, 0})};
    EXPECT_FALSE(character_plot(figure, {}).empty());
    EXPECT_EQ(character_plot({"nothing", 1, {}, "", false}, {}), "nothing\n");
}

TEST(Thin, KeepsTheExtremesOfEachColumn) {
    Curve curve;
    for (int i = 0; i < 100'000; ++i) {
        curve.x.push_back(i);
        curve.y.push_back(i == 31'415 ? 7 : i == 77'777 ? -7 : std::sin(0.7 * i));
    }
    const Curve whole = curve;
    thin(curve, 100);
    EXPECT_LE(curve.x.size(), 400U);
    EXPECT_GE(curve.x.size(), 200U);
    EXPECT_TRUE(std::ranges::is_sorted(curve.x));
    EXPECT_EQ(std::ranges::count(curve.y, 7), 1);
    EXPECT_EQ(std::ranges::count(curve.y, -7), 1);
    EXPECT_EQ(curve.x.front(), 0);
    EXPECT_EQ(curve.x.back(), 99'999);
    for (std::size_t i = 0; i < curve.x.size(); ++i)
        EXPECT_EQ(curve.y[i], whole.y[static_cast<std::size_t>(curve.x[i])]);
}

TEST(Thin, LeavesShortCurvesAndThoseWithoutLength) {
    Curve curve = line_of("", {1, 2, 3}, {4, 5, 6});
    thin(curve, 1);
    EXPECT_EQ(curve.x.size(), 3U);
    curve.x.assign(1000, 5), curve.y.assign(1000, 1);
    thin(curve, 10);
    EXPECT_EQ(curve.x.size(), 1000U);
}

}  // namespace
}  // namespace polhode
