// Linear theory beside what was measured.
#include <algorithm>
#include <cmath>

#include "body/elementary.h"
#include "experiment/kinds/stability_tables.h"
#include "integrators/analysis/linear_stability.h"
#include "integrators/run/eigenvalues.h"
#include "text/parallel.h"

namespace polhode {
namespace {

/// h |lambda| on the stiff axis at which a method's numbers begin to grow.
class GrowthSearch {
  public:
    GrowthSearch(const Scene& scene, const Method& method, double rate, long steps)
        : scene_(scene), method_(method), rate_(rate), steps_(steps) {}

    // the largest without growth, bracketed about the one expected and halved to a thousandth
    std::optional<double> limit(double expected) const {
        if (grows(expected / 2)) return {};
        double stable = expected * 0.94, growing = stable;
        if (grows(stable)) {
            growing = stable, stable = expected / 2;
        } else {
            // by small strides: beyond the first window of growth there may be rest again
            while (!grows(growing)) {
                stable = growing;
                growing *= 1.02;
                if (growing > 4 * expected) return {};
            }
        }
        while (growing - stable > 1e-3 * stable) {
            const double middle = (stable + growing) / 2;
            (grows(middle) ? growing : stable) = middle;
        }
        return stable;
    }

    // Over so many steps: whether the rate over |lambda| or the angle turned ever reaches ten times the first rate over
    // |lambda|. What only swells and falls again, as an oscillation near the limit of a symplectic step does, stays
    // below but for the last half per cent; what grows is not followed to where the spring's force bends and bounds it.
    // The angle, because two half kicks may cancel in the rate.
    bool grows(double z) const {
        constexpr long samples = 200;
        constexpr double growth = 10;
        const double h = z / rate_;
        Scene scene = scene_;
        scene.duration = static_cast<double>(steps_) * h;
        Settings settings;
        settings.step = h * (1 + 1e-12), settings.samples = samples;
        const Trajectory run = solve(scene, method_, settings);
        if (run.status != Status::ok) return true;
        const Quaternion<double> from_start = conjugate(run.samples.front().q);
        double largest = 0;
        for (const Sample& sample : run.samples) {
            const Vector3<double> turned = vector_part(normalized(from_start * sample.q));
            largest = std::max({largest, hypotenuse(sample.angular_velocity_B) / rate_,
                                2 * std::asin(std::min(1.0, hypotenuse(turned)))});
        }
        return largest > growth * hypotenuse(run.samples.front().angular_velocity_B) / rate_;
    }

  private:
    const Scene& scene_;
    const Method& method_;
    double rate_;
    long steps_;
};

// Of the eigenvalues the one that limits the step; empty unless the scene is linear.
std::optional<std::complex<double>> limiting(const StabilityScene& scene) {
    if (!scene.is_linear) return {};
    return largest_in_magnitude(scene.eigenvalues);
}

// one scene of each direction, the first: eigenvalues scale out
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

bool turns_as_a_body(const Method& method) { return method.family != Family::points; }

}  // namespace

Table measure_linear_limits(const Plan& plan, const StabilityFindings& found, int jobs, bool quick) {
    Table table{{"scene", "method", "eigenvalue_real", "eigenvalue_imaginary", "theory", "measured", "deviation",
                 "growth_beyond", "remark"},
                {}};
    struct Comparison {
        std::size_t scene;
        const Method* method;
        std::complex<double> lambda;
        double theory;
        std::optional<double> measured;
        bool grows_early = false;
    };
    std::vector<Comparison> lines;
    for (const std::size_t s : directions(found))
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.kind != SettingKind::step || !turns_as_a_body(*curve.method)) continue;
            const std::complex<double> lambda = *limiting(found.scenes[s]);
            if (const auto theory = stable_length(*curve.method, std::arg(lambda)))
                lines.push_back({s, curve.method, lambda, *theory, {}});
        }
    parallel_for(lines.size(), jobs, [&](std::size_t i) {
        Comparison& line = lines[i];
        if (sweep_interrupted()) return;
        const GrowthSearch search(plan.scenes[line.scene].scene, *line.method, std::abs(line.lambda),
                                  quick ? 5'000 : 50'000);
        // a theory without a limit is tried far out, one that allows no step at a small one
        if (line.theory == 0 || !std::isfinite(line.theory))
            line.grows_early = search.grows(line.theory == 0 ? 0.1 : 100.0);
        else
            line.measured = search.limit(line.theory);
    });
    for (const Comparison& line : lines) {
        const bool bounded = std::isfinite(line.theory) && line.theory > 0;
        // what a step adds 5 % beyond the theory's limit: below some 1e-4 it takes more steps than these to show
        const auto growth_beyond = [&](double theory) {
            if (!bounded) return Cell();
            const auto growth = linear_growth(*line.method, std::polar(1.05 * theory, std::arg(line.lambda)));
            return growth ? Cell(*growth - 1) : Cell();
        };
        std::string remark;
        if (line.theory == 0) remark = line.grows_early ? "grows at 0.1" : "no growth seen at 0.1";
        if (!std::isfinite(line.theory)) remark = line.grows_early ? "fails or grows at 100" : "no growth at 100";
        if (bounded && !line.measured) remark = "no limit found between a half and four times the theory's";
        table.rows.push_back(
            {found.scenes[line.scene].label, std::string(line.method->name), line.lambda.real(), line.lambda.imag(),
             std::isfinite(line.theory) ? Cell(line.theory) : Cell(std::string("no limit")), cell_of(line.measured),
             line.measured ? Cell(*line.measured / line.theory - 1) : Cell(), growth_beyond(line.theory), remark});
    }
    return table;
}

}  // namespace polhode
