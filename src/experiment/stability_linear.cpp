// Linear theory beside what was measured.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiment/stability_tables.h"
#include "integrators/linear_stability.h"

namespace polhode {
namespace {

// The eigenvalue that limits the step: the one of largest magnitude, of a conjugate pair the upper. Empty where linear
// theory does not apply: a motion whose fastest eigenvalue is that of its turning, |lambda| = |w| / 2, or none.
std::optional<std::complex<double>> limiting(const StabilityScene& scene) {
    std::optional<std::complex<double>> found;
    for (const std::complex<double>& lambda : scene.eigenvalues)
        if (!found || std::abs(lambda) > std::abs(*found)) found = lambda;
    if (!found || !scene.is_linear) return {};
    return std::complex<double>(found->real(), std::abs(found->imag()));
}

}  // namespace

Table linear_table(const StabilityFindings& found) {
    Table table{{"scene", "family", "parameter", "method", "eigenvalue_real", "eigenvalue_imaginary", "theory",
                 "measured", "deviation"},
                {}};
    for (const StabilityFinding& f : found.findings) {
        if (f.kind != SettingKind::step || !f.stable) continue;
        const auto lambda = limiting(*f.scene);
        if (!lambda) continue;
        const std::optional<double> theory = stable_length(*f.method, std::arg(*lambda));
        if (!theory) continue;
        const double measured = f.stable->result.setting * std::abs(*lambda);
        // a limit that the longest step of the search does not reach, or at 0, is nothing to compare with
        const bool comparable = f.beyond && std::isfinite(*theory) && *theory > 0;
        table.rows.push_back({f.scene->label, f.scene->member.family, cell_of(f.scene->member.parameter),
                              std::string(f.method->name), lambda->real(), lambda->imag(),
                              std::isfinite(*theory) ? Cell(*theory) : Cell(std::string("no limit")), measured,
                              comparable ? Cell(measured / *theory - 1) : Cell()});
    }
    return table;
}

}  // namespace polhode
