// Regions of absolute stability and the eigenvalues of scenes in them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <string>

#include "experiment/kinds/stability.h"
#include "experiment/plan/method_style.h"
#include "figure/contour.h"
#include "figure/curve_style.h"
#include "integrators/analysis/linear_stability.h"
#include "integrators/run/eigenvalues.h"

namespace polhode {
namespace {

using Complex = std::complex<double>;

/// Methods whose steps are one and the same as far as linear theory sees.
struct Alike {
    const Method* method;  ///< the first, or the first of a library's or of the splitting methods
    int others = 0;
    std::string label() const {
        return others == 0 ? std::string(method->name) : fmt::format("{} (and {} more)", method->name, others);
    }
};

bool same_region(const Method& a, const Method& b) {
    if (a.growth && b.growth) {
        if (a.growth == b.growth) return true;
        for (const Complex z : {Complex(-0.7, 0.3), Complex(-3, 1), Complex(0.4, 2)})
            if (const double x = a.growth(z); std::abs(x - b.growth(z)) > 1e-9 * (1 + x)) return false;
        return true;
    }
    if (a.growth || b.growth) return false;
    return a.pendulum_growth == b.pendulum_growth;
}

enum class Region { explicit_short, explicit_long, multistep, implicit, second_order };

Region region_of(const Method& method) {
    if (!method.growth) return Region::second_order;
    if (method.growth(-1e6) <= 1) return Region::implicit;
    if (method.family == Family::multistep) return Region::multistep;
    return method.growth(-3) > 1 ? Region::explicit_short : Region::explicit_long;
}

bool is_well_known(const Method& method) {
    return method.library == odeint_library || method.family == Family::splitting;
}

std::vector<Alike> members(Region region) {
    std::vector<Alike> found;
    for (const Method* method : methods()) {
        if ((!method->growth && !method->pendulum_growth) || region_of(*method) != region) continue;
        const auto like =
            std::find_if(found.begin(), found.end(), [&](const Alike& a) { return same_region(*a.method, *method); });
        if (like == found.end())
            found.push_back({method});
        else if (++like->others; !is_well_known(*like->method) && is_well_known(*method))
            like->method = method;
    }
    return found;
}

template <class Growth>
void add_boundary(Panel& panel, const Alike& alike, const Growth& growth) {
    // along the axes of a symmetric method growth is 1 but for rounding
    constexpr double allowed = 1 + 1e-9;
    const auto excess = [&](double x, double y) { return growth(x, y) - allowed; };
    std::vector<ContourLine> lines = contour(excess, *panel.x_limits, *panel.y_limits, 150, 108);
    // specks that a single cell of the grid sees are no part of it that can be drawn
    std::erase_if(lines, [](const ContourLine& line) { return line.x.size() < 8; });
    for (ContourLine& line : lines) {
        Curve curve;
        curve.label = alike.label();
        set_style(curve, method_style(*alike.method));
        curve.x = std::move(line.x), curve.y = std::move(line.y);
        panel.curves.push_back(std::move(curve));
    }
}

/// A scene's eigenvalues, 1/s, and the step that takes the largest to the middle of the panels.
struct Spectrum {
    std::string label;
    std::vector<Complex> lambda;
    double step = 0;
};

std::optional<Spectrum> spectrum_of(const PlannedScene& scene) {
    const Problem problem = pose(scene.scene);
    if (problem.needs.user_torque) return std::nullopt;
    Sample start;
    start.t = 0, start.q = problem.body.q, start.angular_velocity_B = problem.body.angular_velocity_B;
    start.position_W = problem.body.position_W, start.velocity_W = problem.body.velocity_W;
    Spectrum spectrum{scene.label, eigenvalues(problem, start)};
    const double largest = std::abs(largest_in_magnitude(spectrum.lambda));
    if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
    // 1, 2 or 5 times a power of ten
    const double wanted = 2.5 / largest, decade = std::pow(10.0, std::floor(std::log10(wanted)));
    const double digits = wanted / decade;
    spectrum.step = (digits >= 5 ? 5 : digits >= 2 ? 2 : 1) * decade;
    return spectrum;
}

// At most four, as different in the direction of their largest eigenvalue as they come: one in each eighth of the half
// plane.
std::vector<Spectrum> spectra_of(std::span<const PlannedScene> scenes) {
    std::vector<Spectrum> chosen;
    std::vector<int> taken;
    for (const PlannedScene& scene : scenes) {
        if (chosen.size() == 4) break;
        std::optional<Spectrum> spectrum = spectrum_of(scene);
        if (!spectrum) continue;
        const double angle = std::arg(largest_in_magnitude(spectrum->lambda));
        const int sector = static_cast<int>(std::lround(angle / (std::acos(-1.0) / 8)));
        if (std::find(taken.begin(), taken.end(), sector) != taken.end()) continue;
        taken.push_back(sector);
        chosen.push_back(std::move(*spectrum));
    }
    return chosen;
}

// wide enough for the family, as high as makes both axes alike in a panel's frame
Panel panel_of(const char* title, double left, double right) {
    Panel panel{title, "Re hλ", "Im hλ", false, false, {}};
    panel.x_limits = Limits{left, right};
    panel.y_limits = Limits{0, 0.72 * (right - left)};
    return panel;
}

}  // namespace

std::vector<NamedFigure> draw_stability_regions(std::span<const PlannedScene> scenes) {
    const std::vector<Spectrum> spectra = spectra_of(scenes);
    NamedFigure plane{"stability_regions", {"Stable where inside the line: |growth of a step| ≤ 1", 2, {}, ""}};
    const std::pair<Region, Panel> panels[] = {
        {Region::explicit_short, panel_of("explicit, at most 3 on the real axis", -4.5, 1)},
        {Region::explicit_long, panel_of("explicit, more than 3", -7.5, 2)},
        {Region::multistep, panel_of("Adams, predicted and corrected once", -1.6, 0.6)},
        {Region::implicit, panel_of("implicit: stable outside the line", -12, 36)},
    };
    for (const auto& [family, empty] : panels) {
        Panel panel = empty;
        for (const Alike& alike : members(family))
            add_boundary(panel, alike, [&](double x, double y) { return alike.method->growth({x, y}); });
        int marker = 0;
        for (const Spectrum& spectrum : spectra) {
            Curve points;
            points.label = fmt::format("{}, h = {:g} s", spectrum.label, spectrum.step);
            points.color = 1, points.mark = first_stroke_mark + marker++;
            points.line = false;
            for (const Complex& lambda : spectrum.lambda)
                if (lambda.imag() >= 0)
                    points.x.push_back(spectrum.step * lambda.real()),
                        points.y.push_back(spectrum.step * lambda.imag());
            panel.curves.push_back(std::move(points));
        }
        plane.figure.panels.push_back(std::move(panel));
    }
    plane.figure.note =
        "The lower half is its mirror image. Markers: eigenvalues of scenes' Jacobians at t = 0 times the step. "
        "Methods "
        "with the same growth share a line.";

    NamedFigure pendulum{"stability_pendulum", {"A damped pendulum: stable below the line", 1, {}, ""}};
    Panel panel{"", "h γ", "h ω", false, false, {}};
    panel.x_limits = Limits{0, 5}, panel.y_limits = Limits{0, 3.6};
    for (const Alike& alike : members(Region::second_order))
        add_boundary(panel, alike, [&](double x, double y) { return alike.method->pendulum_growth(x, y * y); });
    pendulum.figure.panels.push_back(std::move(panel));
    pendulum.figure.note = "θ'' = −γ θ' − ω² θ. Methods with the same growth share a line.";
    return {std::move(plane), std::move(pendulum)};
}

}  // namespace polhode
