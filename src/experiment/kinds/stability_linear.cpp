// Linear theory for the kind `stability`: theoretical and measured limits of the step, and regions of absolute
// stability.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "body/elementary.h"
#include "experiment/kinds/stability.h"
#include "experiment/plan/method_style.h"
#include "figure/contour.h"
#include "figure/curve_style.h"
#include "integrators/analysis/linear_stability.h"
#include "integrators/run/eigenvalues.h"
#include "text/parallel.h"

namespace polhode {
namespace {

/// A method on a linear scene whose largest eigenvalue is lambda.
struct LinearCase {
    const StabilityScene* properties;
    const Scene* scene;
    const Method* method;
    std::complex<double> lambda;
    double theory;                     ///< largest h |lambda| without growth, by linear_stability.h
    std::optional<double> measured{};  ///< measured limit; empty if it was not found
    bool grows_early = false;          ///< if theory gives no finite limit: whether the motion grows at probe_value()

    bool has_limit() const { return std::isfinite(theory) && theory > 0; }
};

// Whether at h |lambda| = z the rate over |lambda| or the angle of rotation exceeds ten times the first rate over
// |lambda| within `steps`. A bounded oscillation near the limit of a symplectic step stays below, except in the last
// 0.5 %; growth ends the test before the spring's force becomes nonlinear. The angle is tested too, because two half
// kicks may cancel in the rate.
bool grows(const LinearCase& c, long steps, double z) {
    constexpr double growth = 10;
    const double rate = std::abs(c.lambda), h = z / rate;
    Scene scene = *c.scene;
    scene.duration = static_cast<double>(steps) * h;
    Settings settings;
    settings.step = h * (1 + 1e-12), settings.samples = 200;
    const Trajectory run = solve(scene, *c.method, settings);
    if (run.status != Status::ok) return true;
    const Quaternion<double> from_start = conjugate(run.samples.front().q);
    return std::any_of(run.samples.begin(), run.samples.end(), [&](const Sample& sample) {
        const double turned = 2 * std::asin(std::min(1.0, hypotenuse(vector_part(normalized(from_start * sample.q)))));
        return std::max(hypotenuse(sample.angular_velocity_B) / rate, turned) >
               growth * hypotenuse(run.samples.front().angular_velocity_B) / rate;
    });
}

// the largest h |lambda| without growth, to 0.1 %, searched between 0.5 and 4 times the theoretical limit
std::optional<double> measured_limit(const LinearCase& c, long steps) {
    if (grows(c, steps, c.theory / 2)) return {};
    double stable = c.theory / 2, growing = c.theory * 0.94;
    // small increments, because another stable window may follow the first window of growth
    while (!grows(c, steps, growing)) {
        stable = growing;
        growing *= 1.02;
        if (growing > 4 * c.theory) return {};
    }
    while (growing - stable > 1e-3 * stable) {
        const double middle = (stable + growing) / 2;
        (grows(c, steps, middle) ? growing : stable) = middle;
    }
    return stable;
}

// The eigenvalue that limits the step; empty unless the scene is linear.
std::optional<std::complex<double>> limiting(const StabilityScene& scene) {
    if (!scene.is_linear) return {};
    return largest_in_magnitude(scene.eigenvalues);
}

// the first scene for each direction of the eigenvalue, since its magnitude only scales h
std::vector<std::size_t> directions(const StabilityFindings& found) {
    std::vector<std::size_t> scenes;
    std::vector<double> angles;
    for (std::size_t s = 0; s < found.scenes.size(); ++s) {
        const auto lambda = limiting(found.scenes[s]);
        if (!lambda) continue;
        const double angle = std::arg(*lambda);
        if (std::any_of(angles.begin(), angles.end(), [&](double a) { return std::abs(a - angle) < 1e-3; })) continue;
        scenes.push_back(s), angles.push_back(angle);
    }
    return scenes;
}

std::vector<LinearCase> linear_cases(const Plan& plan, const StabilityFindings& found) {
    std::vector<LinearCase> cases;
    for (const std::size_t s : directions(found))
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::step || curve.method->family == Family::points) continue;
            const std::complex<double> lambda = *limiting(found.scenes[s]);
            if (const auto theory = stable_length(*curve.method, std::arg(lambda)))
                cases.push_back({&found.scenes[s], &plan.scenes[s].scene, curve.method, lambda, *theory});
        }
    return cases;
}

// h |lambda| for the test: large if theory gives no finite limit, small if the limit is 0
double probe_value(const LinearCase& c) { return c.theory == 0 ? 0.1 : 100; }

// growth per step at 1.05 times the theoretical limit; below some 1e-4 the measurement has too few steps to detect it
std::optional<double> growth_beyond(const LinearCase& c) {
    if (!c.has_limit()) return {};
    const auto growth = linear_amplification(*c.method, std::polar(1.05 * c.theory, std::arg(c.lambda)));
    return growth ? std::optional(*growth - 1) : std::nullopt;
}

const char* find_remark(const LinearCase& c) {
    if (c.theory == 0) return c.grows_early ? "grows at h |lambda| = 0.1" : "no growth observed at h |lambda| = 0.1";
    if (!c.has_limit()) return c.grows_early ? "fails or grows at h |lambda| = 100" : "no growth at h |lambda| = 100";
    return c.measured ? "" : "no limit found between 0.5 and 4 times the theoretical one";
}

using Complex = std::complex<double>;

/// Methods with the same growth in linear theory.
struct RegionGroup {
    const Method* method;  ///< the first one, with preference for Odeint's and for splitting methods
    int others = 0;
    std::string label() const {
        return others == 0 ? std::string(method->name) : fmt::format("{} (and {} more)", method->name, others);
    }
};

bool same_region(const Method& a, const Method& b) {
    if (a.amplification && b.amplification) {
        if (a.amplification == b.amplification) return true;
        for (const Complex z : {Complex(-0.7, 0.3), Complex(-3, 1), Complex(0.4, 2)})
            if (const double x = a.amplification(z); std::abs(x - b.amplification(z)) > 1e-9 * (1 + x)) return false;
        return true;
    }
    if (a.amplification || b.amplification) return false;
    return a.pendulum_amplification == b.pendulum_amplification;
}

enum class Region { explicit_short, explicit_long, multistep, implicit, second_order };

Region region_of(const Method& method) {
    if (!method.amplification) return Region::second_order;
    if (method.amplification(-1e6) <= 1) return Region::implicit;
    if (method.family == Family::multistep) return Region::multistep;
    return method.amplification(-3) > 1 ? Region::explicit_short : Region::explicit_long;
}

bool is_well_known(const Method& method) {
    return method.library == odeint_library || method.family == Family::splitting;
}

std::vector<RegionGroup> members(Region region) {
    std::vector<RegionGroup> found;
    for (const Method* method : methods()) {
        if ((!method->amplification && !method->pendulum_amplification) || region_of(*method) != region) continue;
        const auto like = std::find_if(found.begin(), found.end(),
                                       [&](const RegionGroup& a) { return same_region(*a.method, *method); });
        if (like == found.end())
            found.push_back({method});
        else if (++like->others; !is_well_known(*like->method) && is_well_known(*method))
            like->method = method;
    }
    return found;
}

template <class Growth>
void add_boundary(Panel& panel, const RegionGroup& group, const Growth& growth) {
    // on the axes the growth of a symmetric method is 1 up to rounding
    constexpr double allowed = 1 + 1e-9;
    const auto excess = [&](double x, double y) { return growth(x, y) - allowed; };
    std::vector<ContourLine> lines = contour(excess, *panel.x_limits, *panel.y_limits, 150, 108);
    // remove specks of a single grid cell, which cannot be drawn correctly
    std::erase_if(lines, [](const ContourLine& line) { return line.x.size() < 8; });
    for (ContourLine& line : lines) {
        Curve curve;
        curve.label = group.label();
        set_style(curve, method_style(*group.method));
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

// The spectra of at most four scenes whose largest eigenvalues differ in direction: one per eighth of the half plane.
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

// a panel of this width whose height gives both axes the same scale
Panel panel_of(const char* title, double left, double right) {
    Panel panel{title, "Re hλ", "Im hλ", false, false, {}};
    panel.x_limits = Limits{left, right};
    panel.y_limits = Limits{0, 0.72 * (right - left)};
    return panel;
}

}  // namespace

Table measure_linear_limits(const Plan& plan, const StabilityFindings& found, int jobs, bool quick) {
    const long steps = quick ? 5'000 : 50'000;
    std::vector<LinearCase> cases = linear_cases(plan, found);
    parallel_for(cases.size(), jobs, [&](std::size_t i) {
        LinearCase& c = cases[i];
        if (sweep_interrupted()) return;
        if (c.has_limit())
            c.measured = measured_limit(c, steps);
        else
            c.grows_early = grows(c, steps, probe_value(c));
    });
    Table table{{"scene", "method", "eigenvalue_real", "eigenvalue_imaginary", "theory", "measured", "deviation",
                 "growth_beyond", "remark"},
                {}};
    for (const LinearCase& c : cases)
        table.rows.push_back({c.properties->label, std::string(c.method->name), c.lambda.real(), c.lambda.imag(),
                              std::isfinite(c.theory) ? Cell(c.theory) : Cell(std::string("no limit")),
                              cell_of(c.measured), c.measured ? Cell(*c.measured / c.theory - 1) : Cell(),
                              cell_of(growth_beyond(c)), std::string(find_remark(c))});
    return table;
}

std::vector<NamedFigure> draw_stability_regions(std::span<const PlannedScene> scenes) {
    const std::vector<Spectrum> spectra = spectra_of(scenes);
    NamedFigure plane{"stability_regions", {"Stability regions: |growth per step| ≤ 1 inside the line", 2, {}, ""}};
    const std::pair<Region, Panel> panels[] = {
        {Region::explicit_short, panel_of("explicit, at most 3 on the real axis", -4.5, 1)},
        {Region::explicit_long, panel_of("explicit, more than 3 on the real axis", -7.5, 2)},
        {Region::multistep, panel_of("Adams predictor-corrector, one correction", -1.6, 0.6)},
        {Region::implicit, panel_of("implicit: stable outside the line", -12, 36)},
    };
    for (const auto& [family, empty] : panels) {
        Panel panel = empty;
        for (const RegionGroup& group : members(family))
            add_boundary(panel, group, [&](double x, double y) { return group.method->amplification({x, y}); });
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
        "The lower half plane is symmetric. Markers: eigenvalues of the scenes' Jacobians at t = 0, times the step. "
        "Methods with the same growth share a line.";

    NamedFigure pendulum{"stability_pendulum", {"A damped pendulum: stable below the line", 1, {}, ""}};
    Panel panel{"", "h γ", "h ω", false, false, {}};
    panel.x_limits = Limits{0, 5}, panel.y_limits = Limits{0, 3.6};
    for (const RegionGroup& group : members(Region::second_order))
        add_boundary(panel, group, [&](double x, double y) { return group.method->pendulum_amplification(x, y * y); });
    pendulum.figure.panels.push_back(std::move(panel));
    pendulum.figure.note = "θ'' = −γ θ' − ω² θ. Methods with the same growth share a line.";
    return {std::move(plane), std::move(pendulum)};
}

}  // namespace polhode
