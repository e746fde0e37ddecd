// Draws a polhode on its ellipsoid as a gnuplot script in page coordinates. PolhodeView projects all lines and splits
// them into visible and hidden parts, which are drawn in layers from back to front.
#include "app/polhode_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "app/polhode_view.h"
#include "figure/gnuplot.h"
#include "figure/gnuplot_terminal.h"
#include "text/atomic_file.h"

namespace polhode {
namespace {

using V = Vector3<double>;

// in points (1/72 inch): one column of a paper
constexpr double page_width = 250, largest_plot_height = 230, title_height = 16, line_height = 10;
constexpr double text_size = 7, title_size = 8;
constexpr double azimuth = 52, elevation = 27;  // viewing direction, degrees from axis 1 and from the plane of 1 and 2

struct Style {
    const char* color;
    double width;
    int dash;  // gnuplot's dashtype
};
constexpr Style wire_behind{"#ececec", 0.4, 1}, wire_front{"#c4c4c4", 0.4, 1}, outline_style{"#909090", 0.6, 1},
    axis_line{"#404040", 0.6, 1}, separatrix_behind{"#f5c9a6", 0.5, 1}, separatrix_front{"#d95f02", 0.6, 1},
    curve_behind{"#9fc3e6", 0.9, 1}, curve_front{"#0b5394", 1.4, 1};

constexpr const char* subscripts[] = {"₁", "₂", "₃"};

class Script {
  public:
    Script(const PolhodeCurve& polhode, const std::string& title, const std::string& terminal)
        : polhode_(polhode), terminal_(terminal), view_(polhode, toward(), right()) {
        const std::vector<std::string> notes = remarks();
        fit();
        height_ = title_height + plot_height_ + line_height * static_cast<double>(notes.size() + 1) + 6;
        text = terminal_.opening(page_width, height_, text_size, "");
        text += "unset key\nunset border\nunset tics\n";
        for (const char* margin :
             {"lmargin at screen 0", "rmargin at screen 1", "bmargin at screen 0", "tmargin at screen 1"})
            text += fmt::format("set {}\n", margin);
        text += fmt::format("set xrange [0:{:g}]\nset yrange [0:{:g}]\n", page_width, height_);
        label(title, page_width / 2, height_ - 9, "center", title_size);
        for (std::size_t i = 0; i < notes.size(); ++i)
            label(notes[i], 8, line_height * (static_cast<double>(notes.size() - i) - 0.5) + 3, "left", text_size);
        layers();
        axes();
        legend(line_height * (static_cast<double>(notes.size()) + 0.5) + 3);
        text += data_;
        text += "plot " + elements_ + "\nunset output\n";
    }

    std::string text;

  private:
    static double radians(double degrees) { return degrees * std::numbers::pi / 180; }
    static V toward() {
        const double a = radians(azimuth), e = radians(elevation);
        return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
    }
    static V right() { return {-std::sin(radians(azimuth)), std::cos(radians(azimuth)), 0}; }

    // The pole of an axis on the ellipsoid, and the tip of its arrow.
    V pole(int i) const {
        V w;
        w[i] = polhode_.semi_axes[i];
        return w;
    }
    V tip(int i) const {
        double reach = 1;
        for (const Polyline& line : polhode_.curve)
            for (const V& w : line) reach = std::max(reach, w[i] / polhode_.semi_axes[i]);
        return (reach + 0.3 / view_.drawn()[i]) * pole(i);
    }

    void fit() {
        PagePoint low = view_.at(pole(0)), high = low;
        const auto include = [&](const PagePoint& p) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        };
        for (const PagePoint& p : view_.outline()) include(p);
        for (const Polyline& line : polhode_.curve)
            for (const V& w : line) include(view_.at(w));
        for (int i = 0; i < 3; ++i) include(view_.at(tip(i)));
        // margins for the names of the axes, and above and below
        const double room_x = page_width - 92, air = 24;
        scale_ = std::min(room_x / (high.x - low.x), (largest_plot_height - air) / (high.y - low.y));
        plot_height_ = scale_ * (high.y - low.y) + air;
        middle_ = {(low.x + high.x) / 2, (low.y + high.y) / 2};
    }
    PagePoint on_page(const PagePoint& p) const {
        return {page_width / 2 + scale_ * (p.x - middle_.x),
                height_ - title_height - plot_height_ / 2 + scale_ * (p.y - middle_.y)};
    }

    void label(const std::string& words, double x, double y, const char* alignment, double size) {
        text += fmt::format("set label {} at {:.1f},{:.1f} {} noenhanced front font {}\n", gnuplot_quoted_line(words),
                            x, y, alignment, terminal_.font(size));
    }
    void element(const std::string& what) { elements_ += (elements_.empty() ? "" : ", \\\n  ") + what; }
    std::string pen(const Style& style) const {
        return fmt::format("linewidth {:g} dashtype {} linecolor \"{}\"", terminal_.line_width(style.width), style.dash,
                           style.color);
    }
    // Adds lines, each followed by an empty line, as gnuplot requires.
    void lines(const std::vector<std::vector<PagePoint>>& parts, const Style& style) {
        if (parts.empty()) return;
        data_ += fmt::format("$data{} << END\n", count_);
        for (const auto& part : parts) {
            for (const PagePoint& p : part) data_ += fmt::format("{:.2f} {:.2f}\n", on_page(p).x, on_page(p).y);
            data_ += '\n';
        }
        data_ += "END\n";
        element(fmt::format("$data{} using 1:2 with lines {}", count_++, pen(style)));
    }
    VisibleLine seen(const std::vector<Polyline>& polylines) const {
        VisibleLine all;
        for (const Polyline& line : polylines) {
            VisibleLine one = view_.seen(simplify(line, polhode_.semi_axes, 2e-3));
            std::move(one.front.begin(), one.front.end(), std::back_inserter(all.front));
            std::move(one.behind.begin(), one.behind.end(), std::back_inserter(all.behind));
        }
        return all;
    }

    // Draws from back to front.
    void layers() {
        const VisibleLine wires = seen(view_.wires()), separatrix = seen(polhode_.separatrix),
                          curve = seen(polhode_.curve);
        lines(wires.behind, wire_behind);
        lines(separatrix.behind, separatrix_behind);
        lines(curve.behind, curve_behind);
        lines(wires.front, wire_front);
        lines({view_.outline()}, outline_style);
        lines(separatrix.front, separatrix_front);
        lines(curve.front, curve_front);
        const PagePoint start = on_page(view_.at(polhode_.curve.front().front()));
        dot(start, view_.hidden(polhode_.curve.front().front()) ? "#808080" : "#000000");
    }
    void dot(const PagePoint& p, const char* color) {
        data_ += fmt::format("$data{} << END\n{:.2f} {:.2f}\nEND\n", count_, p.x, p.y);
        element(fmt::format("$data{} using 1:2 with points pointtype 7 pointsize {} linecolor \"{}\"", count_++,
                            terminal_.svg() ? 0.5 : 0.38, color));
    }

    void axes() {
        for (int i = 0; i < 3; ++i) {
            const PagePoint from = on_page(view_.at(pole(i))), to = on_page(view_.at(tip(i)));
            text += fmt::format("set arrow from {:.2f},{:.2f} to {:.2f},{:.2f} head filled size {:g},18 front {}\n",
                                from.x, from.y, to.x, to.y, 5.0, pen(axis_line));
            const double along = std::hypot(to.x - from.x, to.y - from.y);
            const PagePoint way{(to.x - from.x) / along, (to.y - from.y) / along};
            const bool up = std::abs(way.y) > std::abs(way.x);
            text += fmt::format("set label \"{{/:Italic ω}}_{} (rad/s)\" at {:.2f},{:.2f} {} enhanced front font {}\n",
                                i + 1, to.x + (up ? 4 : 5 * way.x), to.y + (up ? 2 : 5 * way.y - 1),
                                up          ? "left"
                                : way.x > 0 ? "left"
                                            : "right",
                                terminal_.font(text_size));
            // the tick at the pole, and its value beside the axis
            const PagePoint tick{-2 * way.y, 2 * way.x};
            text += fmt::format("set arrow from {:.2f},{:.2f} to {:.2f},{:.2f} nohead front {}\n", from.x - tick.x,
                                from.y - tick.y, from.x + tick.x, from.y + tick.y, pen(axis_line));
            const bool left = !up && way.x < 0;
            label(fmt::format("{:.3g}", polhode_.semi_axes[i]),
                  from.x + (up     ? 5
                            : left ? 4
                                   : 2),
                  from.y + (up     ? 5
                            : left ? -5
                                   : 7),
                  "left", text_size);
        }
    }

    void legend(double y) {
        double x = 8;
        const auto sample = [&](const char* words, const Style& style, double taken) {
            lines_on_page({x, y}, {x + 16, y}, style);
            label(words, x + 20, y, "left", text_size);
            x += taken;
        };
        sample(polhode_.free ? "polhode" : "angular velocity", curve_front, polhode_.free ? 62 : 92);
        if (!polhode_.separatrix.empty()) sample("separatrix", separatrix_front, 70);
        dot({x + 4, y}, "#000000");
        label("start", x + 10, y, "left", text_size);
    }
    void lines_on_page(const PagePoint& a, const PagePoint& b, const Style& style) {
        data_ += fmt::format("$data{} << END\n{:.2f} {:.2f}\n{:.2f} {:.2f}\nEND\n", count_, a.x, a.y, b.x, b.y);
        element(fmt::format("$data{} using 1:2 with lines {}", count_++, pen(style)));
    }

    std::vector<std::string> remarks() const {
        const V &I = polhode_.moments, &a = polhode_.semi_axes;
        std::string ellipsoid = "2E = ";
        for (int i = 0; i < 3; ++i)
            ellipsoid += fmt::format("{}I{}ω{}²", i > 0 ? " + " : "", subscripts[i], subscripts[i]);
        std::vector<std::string> notes{fmt::format("Ellipsoid {}, E = {:.4g} J {}", ellipsoid, polhode_.energy,
                                                   polhode_.energy_of_start ? "at the start" : "(largest)"),
                                       fmt::format("{} axes: I = ({:.4g}, {:.4g}, {:.4g}) kg m²",
                                                   polhode_.body_axes ? "Body" : "Principal", I[0], I[1], I[2]),
                                       fmt::format("0 to {:.4g} s{}. Pale: behind or inside.", polhode_.until,
                                                   polhode_.closed ? ", one period" : "")};
        if (!polhode_.free) notes.emplace_back("A torque or an impulse moves it off the ellipsoid.");
        const double ratio = std::max({a[0], a[1], a[2]}) / std::min({a[0], a[1], a[2]});
        const V& d = view_.drawn();
        if (ratio > 1.001 * std::max({d[0], d[1], d[2]}) / std::min({d[0], d[1], d[2]}))
            notes.push_back("The three axes are drawn to different scales.");
        return notes;
    }

    const PolhodeCurve& polhode_;
    const GnuplotTerminal terminal_;
    const PolhodeView view_;
    double height_ = 0, plot_height_ = 0, scale_ = 1;
    PagePoint middle_;
    std::string data_, elements_;
    int count_ = 0;
};

}  // namespace

std::string polhode_script(const PolhodeCurve& polhode, const std::string& title, const std::string& terminal) {
    return Script(polhode, title, terminal).text;
}

std::string draw_polhode(const PolhodeCurve& polhode, const std::string& title, const std::string& path,
                         std::chrono::milliseconds time_limit) {
    const std::string terminal = path.substr(path.size() - 3);
    const GnuplotRun run = gnuplot_picture(polhode_script(polhode, title, terminal), terminal, time_limit);
    if (!run.fault.empty()) return run.fault;
    write_atomically(path, run.output);
    return "";
}

}  // namespace polhode
