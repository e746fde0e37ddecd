// Gnuplot scripts, page layout and the drawing of figures by a real gnuplot, including its failures.
#include "figure/figure.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "figure/curve_style.h"
#include "figure/figure_layout.h"

namespace polhode {
namespace {

namespace fs = std::filesystem;

const double infinity = std::numeric_limits<double>::infinity();

Curve curve(const std::string& label, int color) {
    return {.label = label, .color = color, .x = {1e-3, 1e-2, 1e-1}, .y = {1e-2, 1e-5, 1e-8}};
}

Figure small_figure() {
    Figure figure{"Work and precision", 2, {}, "a note"};
    for (const char* title : {"free_asymmetric", "lagrange-top", "damped-spin"}) {
        figure.panels.push_back({title, "run time (s)", "attitude error (rad)", true, true, {}});
        figure.panels.back().curves = {curve("odeint_rk4", 0), curve("cvode_adams", 1)};
    }
    figure.panels[1].curves[1].cut = true;
    return figure;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t i = text.find(part); i != std::string::npos; i = text.find(part, i + 1)) ++n;
    return n;
}

std::string content(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// The text that an SVG displays, one text element per line.
std::string shown_text(const std::string& svg) {
    std::string shown;
    for (std::size_t i = svg.find("<text>"); i != std::string::npos; i = svg.find("<text>", i + 1)) {
        const std::string piece = svg.substr(i, svg.find("</text>", i) - i);
        std::string words = std::regex_replace(piece, std::regex("<[^>]*>"), "");
        words = std::regex_replace(words, std::regex("&quot;"), "\"");
        shown += words + '\n';
    }
    return shown;
}

class Draw : public ::testing::Test {
  protected:
    Draw() {
        std::string pattern = (fs::temp_directory_path() / "polhode_figure_XXXXXX").string();
        directory_ = mkdtemp(pattern.data());
        old_path_ = std::getenv("PATH");
    }
    ~Draw() override {
        setenv("PATH", old_path_.c_str(), 1);
        fs::remove_all(directory_);
    }

    std::string path(const std::string& name) const { return (directory_ / name).string(); }

    /// Puts a fake gnuplot script first in PATH.
    void install_gnuplot(const std::string& script) {
        std::ofstream(path("gnuplot")) << "#!/bin/sh\n" << script;
        fs::permissions(path("gnuplot"), fs::perms::owner_all);
        setenv("PATH", (directory_.string() + ":" + old_path_).c_str(), 1);
    }

    std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
    }

    fs::path directory_;
    std::string old_path_;
};

TEST(GnuplotScript, HasNoNumberThatIsNotFinite) {
    Figure figure = small_figure();
    figure.panels[0].curves[0].y = {std::nan(""), -infinity, infinity};
    figure.panels[1].curves[0] = {
        .label = "bad", .color = 2, .cut = true, .x = {0, -1, 1e-3, 5e-324}, .y = {1, 1, 1e-3, 1}};
    figure.panels[2].curves.clear();
    figure.panels[2].log_y = false;
    figure.panels[2].curves = {{.label = "huge", .x = {1, 2}, .y = {-1.7e308, 1.7e308}}};
    for (const char* terminal : {"svg", "pdf"}) {
        const std::string script = gnuplot_script(figure, terminal, "out");
        EXPECT_FALSE(std::regex_search(script, std::regex("[^a-z](nan|inf)[^a-z]", std::regex::icase))) << script;
        EXPECT_EQ(count(script, "no data to plot"), 1u);
        EXPECT_EQ(count(script, "\n0.001 0.001\n"), 1u);  // the one good point of the bad curve
    }
}

TEST(GnuplotScript, HasOneLegendEntryALabel) {
    const std::string script = gnuplot_script(small_figure(), "svg", "");
    EXPECT_EQ(count(script, "\"odeint_rk4\""), 1u);
    EXPECT_EQ(count(script, "\"cvode_adams\""), 1u);
    EXPECT_EQ(count(script, "\"truncated curve\""), 1u);
    EXPECT_EQ(script.find("set output \""), std::string::npos);
    EXPECT_THROW(gnuplot_script(small_figure(), "png", ""), std::invalid_argument);
}

TEST(GnuplotScript, LeavesTextAndPathsWithoutPower) {
    Figure figure = small_figure();
    figure.title = "a\"b`touch x`\\n\nset output";
    const std::string script = gnuplot_script(figure, "svg", "|touch y");
    EXPECT_NE(script.find("\"a\\042b\\140touch x\\140\\134n set output\""), std::string::npos) << script;
    EXPECT_NE(script.find("set output \"./|touch y\""), std::string::npos);
}

TEST(GnuplotScript, DrawsGuidesWithinTheAxesOnly) {
    Figure figure = small_figure();
    const auto ranges = [](const std::string& script) {
        std::string found;
        const std::regex range("set [xy]range .*");
        for (std::sregex_iterator i(script.begin(), script.end(), range), end; i != end; ++i) found += i->str() + '\n';
        return found;
    };
    const std::string before = ranges(gnuplot_script(figure, "svg", ""));
    figure.panels[0].guides = {{"seen", {}, {1e-4}}, {"below", {}, {1e-30}}, {"nowhere", {}, {std::nan("")}}};
    figure.panels[1].guides = {{"rising", {1e-4, 1e-3, 1e-2, 1}, {1e-12, 1e-7, 1e-6, 1e3}}};
    figure.panels[2].guides = {{"aside", {10, 100}, {1e-4, 1e-4}}};
    const std::string script = gnuplot_script(figure, "svg", "");
    EXPECT_EQ(ranges(script), before);
    EXPECT_EQ(count(script, "\"seen\""), 1u);
    EXPECT_EQ(count(script, "\"rising\""), 1u);
    for (const char* unseen : {"below", "nowhere", "aside"}) EXPECT_EQ(count(script, unseen), 0u) << unseen;
    EXPECT_EQ(count(script, "$guide"), 4u);  // one data block and one plot line for each guide
    for (const Curve& curve : figure.panels[0].curves) EXPECT_EQ(count(script, '"' + curve.label + '"'), 1u);
}

// small_figure() falls from the upper left to the lower right: a level's label fits above the curves on the right or
// below them on the left.
TEST(GnuplotScript, NamesAGuideWhereTheCurvesLeaveRoom) {
    Figure figure = small_figure();
    figure.panels.resize(1);
    for (const auto& [level, place] : {std::pair(1e-3, "right"), std::pair(3e-8, "left")}) {
        figure.panels[0].guides = {{"level of some length", {}, {level}}};
        const std::string script = gnuplot_script(figure, "svg", "");
        std::smatch found;
        ASSERT_TRUE(std::regex_search(script, found,
                                      std::regex("set label \"level of some length\" at screen [^ ]* (right|left)")));
        EXPECT_EQ(found[1].str(), place) << level;
    }
}

OutcomeMap small_map() {
    // a hole, an island, a diagonal band and two empty cells
    return {{1e-3, 1e-2, 1e-1, 1},
            {1, 10, 100},
            {0, 0, 0, 1,   //
             0, 1, 0, -1,  //
             0, 0, 0, -1},
            {{"good", 0}, {"bad", 7}, {"absent", 3}}};
}

Figure map_figure() {
    Figure figure{"Maps", 2, {}, ""};
    for (const char* title : {"first", "second", "third"}) {
        figure.panels.push_back({title, "step (s)", "rate (1/s)", true, true, {curve("theory", 3)}});
        figure.panels.back().map = small_map();
    }
    figure.shared_axes = true;
    return figure;
}

/// All data blocks of this name: points, with an empty line between polygons.
std::vector<std::string> blocks(const std::string& script, const std::string& name) {
    std::vector<std::string> found;
    const std::string head = "\n$" + name + " << END\n";
    for (std::size_t i = script.find(head); i != std::string::npos; i = script.find(head, i + 1)) {
        const std::size_t begin = i + head.size();
        found.push_back(script.substr(begin, script.find("END", begin) - begin));
    }
    return found;
}

// area in square decades, by the shoelace formula
double area(const std::string& polygons) {
    double sum = 0;
    std::istringstream lines(polygons);
    std::vector<std::pair<double, double>> points;
    const auto close = [&] {
        double twice = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto &a = points[i], &b = points[(i + 1) % points.size()];
            twice += a.first * b.second - b.first * a.second;
        }
        sum += std::abs(twice) / 2;
        points.clear();
    };
    for (std::string line; std::getline(lines, line);) {
        double x = 0, y = 0;
        if (std::istringstream(line) >> x >> y)
            points.emplace_back(std::log10(x), std::log10(y));
        else
            close();
    }
    close();
    return sum;
}

// cells are one decade wide and high: the area of a class is its number of cells
TEST(GnuplotScript, FillsEachCellOfAMapOnce) {
    const std::string script = gnuplot_script(map_figure(), "svg", "");
    for (const auto& [name, cells] : {std::pair("cells0", 8), std::pair("cells1", 2)}) {
        const std::vector<std::string> found = blocks(script, name);
        ASSERT_EQ(found.size(), 3u);
        EXPECT_NEAR(area(found[0]), cells, 1e-12) << found[0];
        EXPECT_EQ(found[0], found[2]);
    }
    EXPECT_EQ(count(script, "$cells2"), 0u);
    for (const char* label : {"\"good\"", "\"bad\"", "\"absent\"", "\"theory\""}) EXPECT_EQ(count(script, label), 1u);
}

TEST(GnuplotScript, LeavesOutAMapThatCannotBe) {
    for (const double edge : {0.0, -1.0, 1e-3, std::nan(""), infinity}) {
        Figure figure = map_figure();
        figure.panels.resize(1);
        figure.panels[0].map->x[1] = edge;
        EXPECT_EQ(count(gnuplot_script(figure, "pdf", ""), "$cells"), 0u) << edge;
    }
    Figure figure = map_figure();
    figure.panels[0].map->cells.pop_back();
    EXPECT_EQ(blocks(gnuplot_script(figure, "pdf", ""), "cells0").size(), 2u);
}

TEST(GnuplotScript, LabelsSharedAxesOnceARowAndColumn) {
    const std::string script = gnuplot_script(map_figure(), "svg", "");
    EXPECT_EQ(count(script, "\"step (s)\""), 2u);    // the third panel is below the first, so two columns show it
    EXPECT_EQ(count(script, "\"rate (1/s)\""), 2u);  // two rows
    Figure figure = small_figure();
    figure.shared_axes = true;
    figure.panels[2].curves[0].x.push_back(1e3), figure.panels[2].curves[0].y.push_back(1e3);
    std::set<std::string> ranges;
    const std::string other = gnuplot_script(figure, "svg", "");
    const std::regex range("set xrange (.*)");
    for (std::sregex_iterator i(other.begin(), other.end(), range), end; i != end; ++i) ranges.insert((*i)[1]);
    ranges.erase("[0:1]");  // the range of the whole page
    EXPECT_EQ(ranges.size(), 1u);
}

TEST(GnuplotScript, KeepsToTheLimitsOfAPanel) {
    Figure figure = small_figure();
    figure.panels.resize(1);
    figure.panels[0].log_x = false;
    figure.panels[0].x_limits = Limits{-3, 0.05};
    figure.panels[0].curves[1].line = false;
    const std::string script = gnuplot_script(figure, "svg", "");
    EXPECT_EQ(count(script, "set xrange [-3:0.05]"), 1u) << script;
    EXPECT_EQ(count(script, "$curve1 using 1:2 with lines"), 0u);
    EXPECT_EQ(count(script, "$curve1 using 1:2 every 1::0::2 with points"), 1u);
    EXPECT_EQ(count(script, "$legend0"), 2u);  // for the curve drawn as a line only
    EXPECT_EQ(count(script, "$legend1"), 0u);
}

TEST(FigureLayout, KeepsEverythingApart) {
    for (const int panels : {1, 3, 8}) {
        for (const int columns : {1, 2, 3, -4}) {
            Figure figure{"title", std::abs(columns), std::vector<Panel>(static_cast<std::size_t>(panels)),
                          "some words of note", columns < 0};
            for (int i = 0; i < 12; ++i) figure.panels[0].curves.push_back(curve("method_" + std::to_string(i), i));
            const FigureLayout layout = layout_of(figure);
            double lowest = 0;
            for (std::size_t i = 0; i < layout.plots.size(); ++i) {
                const Rectangle& a = layout.plots[i];
                EXPECT_TRUE(0 < a.left && a.left < a.right && a.right < layout.width);
                lowest = std::max(lowest, a.bottom);
                for (std::size_t j = 0; j < i; ++j) {
                    const Rectangle& b = layout.plots[j];
                    EXPECT_TRUE(b.right < a.left || a.right < b.left || b.bottom < a.top || a.bottom < b.top);
                }
            }
            ASSERT_EQ(layout.legend.size(), 12u);
            std::set<std::pair<double, double>> places;
            for (const LegendEntry& entry : layout.legend) {
                EXPECT_GT(entry.y, lowest + 25);  // below the tic labels of the lowest axis
                EXPECT_LT(entry.y, layout.first_note_line);
                places.insert({entry.x, entry.y});
            }
            EXPECT_EQ(places.size(), 12u);
            EXPECT_LT(layout.first_note_line, layout.height);
        }
    }
}

TEST_F(Draw, WritesTheSameBytesTwice) {
    EXPECT_EQ(draw(small_figure(), path("a")), "");
    usleep(1'100'000);  // the date in a PDF has a resolution of one second
    EXPECT_EQ(draw(small_figure(), path("b")), "");
    EXPECT_EQ(entries(), 4u);
    EXPECT_EQ(content(path("a.svg")), content(path("b.svg")));
    EXPECT_EQ(content(path("a.pdf")), content(path("b.pdf")));
    EXPECT_EQ(content(path("a.pdf")).substr(0, 5), "%PDF-");
    EXPECT_EQ(draw(map_figure(), path("c")), "");
    EXPECT_EQ(draw(map_figure(), path("d")), "");
    EXPECT_EQ(content(path("c.svg")), content(path("d.svg")));
    EXPECT_EQ(content(path("c.pdf")), content(path("d.pdf")));
}

TEST_F(Draw, FillsAMapWithItsShades) {
    ASSERT_EQ(draw(map_figure(), path("a")), "");
    const std::string svg = content(path("a.svg"));
    const auto filled = [&](const char* rgb) {
        return std::regex_search(svg, std::regex(std::string("fill ?= ?'") + rgb));
    };
    EXPECT_TRUE(filled("rgb\\(244, *244, *220\\)"));
    EXPECT_TRUE(filled("rgb\\( *29, *26, *51\\)"));
}

TEST_F(Draw, ShowsTextLiterally) {
    Figure figure = small_figure();
    figure.title = "x_1^2 {y} `date` \\alpha";
    figure.panels[0].y_label = "|ω|_{max} \"1\"";
    ASSERT_EQ(draw(figure, path("a")), "");
    const std::string text = shown_text(content(path("a.svg")));
    for (const char* words : {"x_1^2 {y} `date` \\alpha", "|ω|_{max}", "odeint_rk4", "free_asymmetric", "a note"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words << " is not in\n" << text;
    }
}

TEST_F(Draw, DrawsPanelsWithoutAnyPoint) {
    const Panel empty{"empty", "x (s)", "y (1)", true, true, {}};
    Panel zero = empty;
    zero.curves = {{.label = "exact", .cut = true, .x = {1, 2}, .y = {0, 0}}};
    for (const Figure& figure : {Figure{"none", 1, {}, ""}, Figure{"", 2, {empty, zero}, ""}}) {
        ASSERT_EQ(draw(figure, path("a")), "");
        EXPECT_EQ(count(shown_text(content(path("a.svg"))), "no data to plot"), figure.panels.size());
    }
}

TEST_F(Draw, DrawsExtremeData) {
    Figure figure = small_figure();
    figure.panels[0].curves[0] = {.label = "one point", .cut = true, .x = {1}, .y = {1}};
    figure.panels[0].curves[1] = {.label = "range",
                                  .color = 1,
                                  .dash = 3,
                                  .points = false,
                                  .cut = true,
                                  .x = {1e-300, 1e300},
                                  .y = {1e300, 1e-300}};
    figure.panels[1].log_x = figure.panels[1].log_y = false;
    figure.panels[1].curves = {{.label = "linear", .dash = 1, .cut = true, .x = {-1e300, 1e300}, .y = {1e300, -1e300}}};
    figure.panels[2].log_x = false;
    figure.panels[2].curves = {{.label = "still", .dash = 1, .cut = true, .x = {1, 1, 1}, .y = {2, 2, 2}}};
    EXPECT_EQ(draw(figure, path("a")), "");
}

TEST_F(Draw, ReportsAMissingGnuplot) {
    setenv("PATH", directory_.c_str(), 1);
    EXPECT_EQ(draw(small_figure(), path("a")), "gnuplot was not found on the PATH");
    EXPECT_EQ(entries(), 0u);
}

TEST_F(Draw, ReportsWhatGnuplotSays) {
    install_gnuplot("echo 'no such terminal' >&2; exit 3\n");
    EXPECT_EQ(draw(small_figure(), path("a")), "gnuplot exited with code 3: no such terminal");
    install_gnuplot("kill -11 $$\n");
    EXPECT_EQ(draw(small_figure(), path("a")).substr(0, 35), "gnuplot was terminated by signal 11");
    install_gnuplot("exit 0\n");
    EXPECT_EQ(draw(small_figure(), path("a")), "gnuplot wrote an incomplete SVG");
    EXPECT_EQ(entries(), 1u);  // the false gnuplot alone
}

TEST_F(Draw, StopsAGnuplotThatHangs) {
    install_gnuplot("exec sleep 100\n");
    EXPECT_EQ(draw(small_figure(), path("a"), {"svg", "pdf"}, std::chrono::milliseconds(200)),
              "gnuplot was stopped after 0.2 s");
}

TEST_F(Draw, FailsWhereADirectoryIsNotThere) {
    try {
        draw(small_figure(), path("missing/a"));
        FAIL() << "nothing is thrown";
    } catch (const std::runtime_error& fault) {
        EXPECT_NE(std::string(fault.what()).find("missing/a.svg"), std::string::npos) << fault.what();
    }
}

}  // namespace
}  // namespace polhode
