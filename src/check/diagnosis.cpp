#include "check/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>

#include "check/compared_rows.h"
#include "check/hypotheses.h"

namespace polhode {
namespace {

// a hypothesis this many times worse than the best says nothing more
constexpr double dominated = 5;
// A w that is further than this from the one predicted, and so many times further than from another, speaks against the
// prediction. Steps, grids and a first row from before the fault leave less.
constexpr double plain_rates = 0.05, rates_factor = 3;

struct Found {
    const Hypothesis* hypothesis;
    Diagnosis diagnosis;
    std::optional<double> rates_left;  // how far the file's w is from the one predicted, relative
};

const char* unit_of(About about) {
    return about == About::attitude ? " rad" : about == About::position ? " m" : " of the largest rate";
}

std::optional<Found> tried(const Hypothesis& hypothesis, const ComparedRows& rows) {
    if (hypothesis.about == About::attitude && !(rows.error() > plain_error)) return {};
    const std::optional<Explanation> e = hypothesis.explain(rows);
    if (!e || !(hypothesis.factor * e->explained <= e->error)) return {};
    const char* unit = unit_of(hypothesis.about);
    const std::string compared =
        e->compared.empty() ? fmt::format(" (root mean square up to t = {:.4g} s)", rows.times().back()) : e->compared;
    return Found{&hypothesis,
                 {hypothesis.fault,
                  fmt::format("{}: {:.2g}{} is left of {:.2g}{}{}; {}", e->what, e->explained, unit, e->error, unit,
                              compared, e->remedy),
                  e->convention, e->error, e->explained},
                 e->rates_left ? e->rates_left() : std::nullopt};
}

// The best first, without what is much worse than the best or told already.
std::vector<Diagnosis> ranked(std::vector<Found> found) {
    const auto left = [](const Found& f) {
        return std::max(explained_wholly, f.diagnosis.explained / f.diagnosis.error);
    };
    std::stable_sort(found.begin(), found.end(), [&](const Found& a, const Found& b) { return left(a) < left(b); });
    std::vector<const Found*> told;
    for (const Found& f : found) {
        const auto better = [&](const Found& g) {
            if (g.hypothesis->about != f.hypothesis->about) return false;
            if (dominated * left(g) < left(f)) return true;
            // as good by the attitude: the file's own w, or that nothing had to be fitted, speaks for one of them
            if (!(left(g) <= dominated * left(f))) return false;
            const bool contradicted = f.rates_left && g.rates_left && *f.rates_left > plain_rates &&
                                      *f.rates_left > rates_factor * *g.rates_left;
            const bool supported = !f.rates_left || !g.rates_left || *g.rates_left <= rates_factor * *f.rates_left ||
                                   *g.rates_left <= plain_rates;
            return contradicted || (f.hypothesis->fitted && !g.hypothesis->fitted && supported);
        };
        // of two ways to the same fault the nearer
        const auto is_told = [&](const Found* g) {
            return g->hypothesis->about == f.hypothesis->about && g->diagnosis.fault == f.diagnosis.fault;
        };
        if (std::none_of(found.begin(), found.end(), better) && std::none_of(told.begin(), told.end(), is_told))
            told.push_back(&f);
    }
    std::vector<Diagnosis> result;
    for (const Found* f : told) result.push_back(f->diagnosis);
    return result;
}

}  // namespace

std::vector<Diagnosis> diagnose(const Scene& scene, const TrajectoryFile& file, const AlteredMotion& motion) {
    const ComparedRows rows(scene, file, motion);
    if (rows.size() < 3) return {};
    std::vector<Found> found;
    for (const Hypothesis& hypothesis : hypotheses())
        if (std::optional<Found> one = tried(hypothesis, rows)) found.push_back(std::move(*one));
    return ranked(std::move(found));
}

}  // namespace polhode
