// Search for the faults that explain a file of one body.
//
// 1. find_steps() finds the number of steps per row.
// 2. Each known fault is tested with all updates. Numbers are fitted on a grid and by golden section.
// 3. The best faults are tested in pairs with all others. Both faults of a pair must be needed.
// 4. Refuted explanations are removed. The best one left is reported, with those that are indistinguishable from it.
#include "check/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace polhode {
namespace {

// number of the best single faults that are combined into pairs
constexpr std::size_t beam = 10;
constexpr std::size_t max_alike = 3;
// Pairs are tested if a question is this many decades above its perfect value. A smaller excess is truncation error.
constexpr double pair_threshold = 3.5;

// Rounds x to significant digits.
double round_to_digits(int digits, double x) {
    if (!(std::abs(x) > 0) || !std::isfinite(x)) return x;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - (digits - 1));
    return std::round(x / unit) * unit;
}

double needed_gain(const Hypothesis& h) { return h.values ? fitted_gain : fixed_gain; }

class Searcher {
  public:
    Searcher(const FileEvidence& evidence, bool all) : evidence_(evidence), all_(all) {}

    FaultSearch search();

  private:
    const FileEvidence& evidence_;
    bool all_;
    std::vector<int> steps_{1};
    double one_step_rate_ = 0;  // prediction error of w by the best update with one step per row, decades

    // a rule and the number of its steps per row
    struct Update {
        const UpdateRule* rule;
        int steps;
    };

    Update best_sound_update_{nullptr, 1};  // the best update without a fault

    std::vector<Update> all_updates() const;
    Explanation explain(std::vector<FittedFault> faults, const std::vector<Update>& updates) const;
    std::optional<Explanation> fit_fault(const std::vector<FittedFault>& others, const Hypothesis& h,
                                         const std::vector<Update>& updates, double hopeless) const;
    void refine(const std::vector<FittedFault>& others, double a, double b, double hopeless, Explanation& result) const;
    void find_steps();
    std::vector<Update> common_updates(const Explanation& first) const;
    Explanation without(const Explanation& e, std::size_t fault, const std::vector<Update>& updates) const;
    std::vector<double> by_step(const Explanation& e) const;
    bool is_refuted(const Explanation& e, const Explanation& sound) const;
    std::vector<Explanation> test_singles(const Explanation& sound, const std::vector<Update>& updates) const;
    std::vector<Explanation> test_pairs(const std::vector<Explanation>& singles, const Explanation& best, double sound,
                                        const std::vector<Update>& updates) const;
    void select_explanations(const std::vector<Explanation>& candidates, FaultSearch& found) const;
};

// Returns every rule with each possible number of steps per row.
std::vector<Searcher::Update> Searcher::all_updates() const {
    std::vector<Update> updates;
    for (const UpdateRule& rule : update_rules()) {
        if (rule.rate == RateUpdate::accurate)
            updates.push_back({&rule, 1});
        else
            for (const int steps : steps_) updates.push_back({&rule, steps});
    }
    return updates;
}

bool apply_faults(Cause& cause, const std::vector<FittedFault>& faults) {
    return std::all_of(faults.begin(), faults.end(),
                       [&](const FittedFault& s) { return s.hypothesis->apply(cause, s.x); });
}

Explanation Searcher::explain(std::vector<FittedFault> faults, const std::vector<Update>& updates) const {
    Explanation best;
    best.residual.total = std::numeric_limits<double>::infinity();
    Cause cause = evidence_.sound();
    if (!apply_faults(cause, faults)) return best;
    best.faults = std::move(faults);
    const EngineModel model(cause);
    for (const Update& update : updates) {
        if (!model.supports(*update.rule, update.steps)) continue;
        const Residual r = evidence_.residual(cause, model, *update.rule, update.steps);
        if (!(r.total < best.residual.total)) continue;
        // without substeps, rotating by the row's first rate is the same as explicit Euler
        const std::optional<double>& rate = r[Criterion::rate];
        if (model.uses_row_rate() && rate && *rate > one_step_rate_ - 0.5) continue;
        best.rule = update.rule, best.steps = update.steps, best.residual = r;
    }
    return best;
}

// Adds a fault to others. A fitted number is the best on a grid, refined between its neighbours by golden section.
std::optional<Explanation> Searcher::fit_fault(const std::vector<FittedFault>& others, const Hypothesis& h,
                                               const std::vector<Update>& updates, double hopeless) const {
    const auto at = [&](double x, const std::vector<Update>& by) {
        std::vector<FittedFault> faults = others;
        faults.push_back({&h, x});
        return explain(std::move(faults), by);
    };
    if (!h.values) {
        Explanation e = at(1, updates);
        return e.rule ? std::optional(std::move(e)) : std::nullopt;
    }
    // evaluate the grid with few updates, then its best value with all updates
    std::vector<Update> few;
    for (const Update& u : updates)
        if (u.rule->rate == RateUpdate::accurate || updates.size() <= 5 ||
            (u.rule == best_sound_update_.rule && u.steps == best_sound_update_.steps) ||
            (u.rule->rate == RateUpdate::after_loads && u.rule->by_new_rate && !u.rule->first_order))
            few.push_back(u);
    const std::vector<double> values = h.values(evidence_.facts());
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < values.size(); ++i)
        if (const Explanation e = at(values[i], few); e.residual.total < least) best = i, least = e.residual.total;
    if (!std::isfinite(least)) return {};
    Explanation result = at(values[best], updates);
    const double below = values[best > 0 ? best - 1 : 0], above = values[std::min(best + 1, values.size() - 1)];
    for (int round = 0; round < 2; ++round) {
        const UpdateRule* const by = result.rule;
        refine(others, below, above, hopeless, result);
        if (result.residual.total > hopeless) break;
        Explanation again = at(result.faults.back().x, updates);
        if (!(again.residual.total < result.residual.total)) break;
        result = std::move(again);
        if (result.rule == by) break;
    }
    return result;
}

// Refines the number of the last fault of `result` in [a, b] by golden section, with the rule of `result`.
void Searcher::refine(const std::vector<FittedFault>& others, double a, double b, double hopeless,
                      Explanation& result) const {
    const double ratio = (std::sqrt(5.0) - 1) / 2;
    const Hypothesis* const h = result.faults.back().hypothesis;
    const std::vector<Update> chosen{{result.rule, result.steps}};
    const auto keep = [&](double x) {
        std::vector<FittedFault> faults = others;
        faults.push_back({h, x});
        Explanation e = explain(std::move(faults), chosen);
        const double total = e.residual.total;
        if (total < result.residual.total) result = std::move(e);
        return total;
    };
    double x = b - ratio * (b - a), y = a + ratio * (b - a), fx = keep(x), fy = keep(y);
    double before = result.residual.total;
    for (int i = 0; i < 36; ++i) {
        // stop early: near the correct number, the error decreases as the bracket narrows
        if (i % 4 == 2 && i > 2) {
            if (result.residual.total > hopeless && result.residual.total > before - 0.5) return;
            before = result.residual.total;
        }
        if (fx < fy)
            b = y, y = x, fy = fx, x = b - ratio * (b - a), fx = keep(x);
        else
            a = x, x = y, fx = fy, y = a + ratio * (b - a), fy = keep(y);
    }
    // use a number of few digits if it fits as well: 0.1 instead of 0.100003
    keep(round_to_digits(4, result.faults.back().x));
}

// Finds the number of steps per row. How the attitude follows the rate shows it, whatever else is wrong.
void Searcher::find_steps() {
    constexpr int candidates[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 20};
    using Change = void (*)(EngineFault&);
    // one step per row is always tested; the best other number only if it improves the score
    constexpr double none = std::numeric_limits<double>::infinity();
    double least_of_all = none, possible = none;
    // prediction errors of the attitude with one step per row, by the row's first rate and by an updated rate
    double by_first_rate = none, by_new_rate = none;
    const auto scan = [&](std::initializer_list<Change> changes, bool first_order) {
        std::vector<std::pair<double, int>> scores;
        for (const int steps : candidates) {
            double least = none;
            for (const Change change : changes) {
                Cause cause = evidence_.sound();
                change(cause.engine);
                const EngineModel model(cause);
                for (const UpdateRule& rule : update_rules())
                    if (rule.rate != RateUpdate::accurate && model.supports(rule, steps) &&
                        (first_order || !rule.first_order)) {
                        const Residual r = evidence_.residual(cause, model, rule, steps);
                        least = std::min(least, r.total), possible = std::min(possible, r.least);
                        if (steps == 1) one_step_rate_ = std::min(one_step_rate_, r[Criterion::rate].value_or(0));
                        if (steps > 1 || rule.rate == RateUpdate::momentum || cause.engine.gyroscopic != 1) continue;
                        double& attitude = rule.by_new_rate ? by_new_rate : by_first_rate;
                        attitude = std::min(attitude, r[Criterion::attitude].value_or(0));
                    }
            }
            scores.emplace_back(least, steps);
        }
        least_of_all = std::min(least_of_all, scores.front().first);
        const auto [score, steps] = *std::min_element(scores.begin() + 1, scores.end());
        if (score < least_of_all - 0.3) steps_ = {1, steps};
        least_of_all = std::min(least_of_all, score);
    };
    scan({[](EngineFault&) {}, [](EngineFault& e) { e.gyroscopic = 0; }}, true);
    // Substeps that rotate by the row's first rate give the attitude of one explicit step per row. Only w shows the
    // substeps.
    const bool shows_rate = evidence_.has_angular_velocity();
    if ((shows_rate && by_first_rate > by_new_rate - 0.3) || least_of_all - possible < fixed_gain) return;
    scan({[](EngineFault& e) { e.rotation_rate = AttitudeRate::first_rate_of_row_w_in_world; },
          [](EngineFault& e) { e.rotation_rate = AttitudeRate::first_rate_of_row_w_in_body; }},
         false);
}

// Returns a few representative updates: those of common engines, and the one that fits best with one fault.
std::vector<Searcher::Update> Searcher::common_updates(const Explanation& first) const {
    std::vector<Update> few{{first.rule, first.steps}};
    for (const UpdateRule& rule : update_rules())
        if (&rule != first.rule && !rule.first_order && rule.by_new_rate &&
            (rule.rate == RateUpdate::accurate || rule.rate == RateUpdate::after_loads ||
             rule.rate == RateUpdate::midpoint || rule.rate == RateUpdate::momentum))
            few.push_back({&rule, rule.rate == RateUpdate::accurate ? 1 : first.steps});
    return few;
}

Explanation Searcher::without(const Explanation& e, std::size_t fault, const std::vector<Update>& updates) const {
    std::vector<FittedFault> rest = e.faults;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(fault));
    return explain(std::move(rest), updates);
}

std::vector<double> Searcher::by_step(const Explanation& e) const {
    Cause cause = evidence_.sound();
    apply_faults(cause, e.faults);
    return evidence_.by_step(cause, EngineModel(cause), *e.rule, e.steps);
}

// A fault of the engine, the body or a load acts in every step. It is refuted if it predicts some steps well, but
// many others no better than no fault.
bool Searcher::is_refuted(const Explanation& e, const Explanation& sound) const {
    // faults of the start do not affect steps
    if (std::ranges::any_of(e.faults, [](const FittedFault& s) {
            const Subject about = s.hypothesis->subject;
            return about == Subject::start_rate || about == Subject::start_attitude ||
                   about == Subject::start_position || about == Subject::rows;
        }))
        return false;
    constexpr double well = 1, no_better = 0.3;
    const std::vector<double> with = by_step(e), plain = by_step(sound);
    if (with.size() < 8 || with.size() != plain.size()) return false;
    std::vector<double> sorted = with;
    std::ranges::sort(sorted);
    const double predicted = sorted[sorted.size() / 4];
    std::size_t against = 0;
    for (std::size_t k = 0; k < with.size(); ++k)
        if (plain[k] > predicted + well && with[k] > plain[k] - no_better) ++against;
    return 4 * against > with.size();
}

bool is_of_load(const Explanation& e) {
    return std::all_of(e.faults.begin(), e.faults.end(), [](const FittedFault& s) {
        const Subject about = s.hypothesis->subject;
        return about >= Subject::gravity && about <= Subject::drag;
    });
}

// Whether all fitted numbers have two digits. Numbers set by hand often do, fitted ones rarely.
bool is_round(const Explanation& e) {
    return std::all_of(e.faults.begin(), e.faults.end(), [](const FittedFault& s) {
        return !s.hypothesis->values || std::abs(s.x - round_to_digits(2, s.x)) < 1e-3 * std::abs(s.x);
    });
}

bool is_better(const Explanation& a, const Explanation& b) { return a.residual.total < b.residual.total; }

bool has_fitted_number(const Explanation& e) {
    return std::any_of(e.faults.begin(), e.faults.end(), [](const FittedFault& s) { return !!s.hypothesis->values; });
}

// Tests all known faults singly. Returns the explanations, the best first.
std::vector<Explanation> Searcher::test_singles(const Explanation& sound, const std::vector<Update>& updates) const {
    std::vector<Explanation> singles;
    for (const Hypothesis& h : known_faults())
        if (std::optional<Explanation> e = fit_fault({}, h, updates, sound.residual.total - 0.2))
            singles.push_back(std::move(*e));
    std::stable_sort(singles.begin(), singles.end(), is_better);
    return singles;
}

// Tests pairs of the best single faults with any other. Returns those in which both faults are needed, the best first.
// `best`: the best accepted single fault, or the explanation without a fault if none is accepted.
std::vector<Explanation> Searcher::test_pairs(const std::vector<Explanation>& singles, const Explanation& best,
                                              double sound, const std::vector<Update>& updates) const {
    std::vector<Explanation> pairs;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < singles.size() && taken < beam && best.residual.worst > pair_threshold; ++i) {
        const Explanation& first = singles[i];
        // engines without a gyroscopic term usually have another fault
        const bool usual = first.faults.front().hypothesis->subject == Subject::gyroscopic;
        if (first.residual.total > sound - 0.3 && !usual) continue;
        ++taken;
        const std::vector<Update> few = common_updates(first);
        for (const Hypothesis& h : known_faults()) {
            if (h.subject == first.faults.front().hypothesis->subject) continue;
            // two fitted numbers can explain any file
            if (h.values && first.faults.front().hypothesis->values) continue;
            std::optional<Explanation> e = fit_fault(first.faults, h, few, first.residual.total - 0.2);
            if (!e || best.residual.total - e->residual.total < fitted_gain) continue;
            const double total = e->residual.total;
            const bool needs_first =
                           without(*e, 0, updates).residual.total - total >= needed_gain(*e->faults[0].hypothesis),
                       needs_second = first.residual.total - total >= needed_gain(h);
            if (needs_first && needs_second) pairs.push_back(explain(e->faults, updates));
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), is_better);
    return pairs;
}

// Selects the explanations that are as good as the best candidate. Prefers loads and fixed numbers.
void Searcher::select_explanations(const std::vector<Explanation>& candidates, FaultSearch& found) const {
    // among equally good explanations, those without a fitted number come first
    const double limit = found.best.residual.total + alike_within;
    std::vector<Explanation> near;
    for (const Explanation& e : candidates)
        if (e.residual.total <= limit && !is_refuted(e, found.sound)) near.push_back(e);
    // a load of the wrong size is more frequent than a wrong mass
    std::stable_partition(near.begin(), near.end(), is_of_load);
    // fitting alone gains about half a decade: also accept explanations with fixed numbers within this margin
    if (!near.empty() && has_fitted_number(near.front()))
        for (const Explanation& e : candidates)
            if (!has_fitted_number(e) && e.residual.total > limit && e.residual.total <= limit + 0.5 &&
                e.faults.size() == near.front().faults.size() &&
                e.faults.back().hypothesis->subject == near.front().faults.back().hypothesis->subject)
                near.push_back(e);
    bool first = true;
    for (const Explanation& e : near) {
        const auto needs_no_fit = [&](const Explanation& other) {
            return !has_fitted_number(other) && other.faults.size() == e.faults.size() &&
                   (!is_round(e) || other.faults.back().hypothesis->subject == e.faults.back().hypothesis->subject);
        };
        if (has_fitted_number(e) && std::any_of(near.begin(), near.end(), needs_no_fit)) continue;
        if (first)
            found.best = e, first = false;
        else if (found.alike.size() < max_alike)
            found.alike.push_back(e);
    }
}

FaultSearch Searcher::search() {
    FaultSearch found;
    find_steps();
    const std::vector<Update> updates = all_updates();
    found.sound = found.best = explain({}, updates);
    best_sound_update_ = {found.sound.rule, found.sound.steps};
    // no fault can gain enough
    if (!all_ && found.sound.residual.total - found.sound.residual.least < fixed_gain) return found;
    found.singles = test_singles(found.sound, updates);
    const double sound = found.sound.residual.total;
    std::vector<Explanation> accepted;
    for (const Explanation& e : found.singles)
        if (sound - e.residual.total >= needed_gain(*e.faults.front().hypothesis)) accepted.push_back(e);
    std::vector<Explanation> pairs =
        test_pairs(found.singles, accepted.empty() ? found.sound : accepted.front(), sound, updates);
    std::vector<Explanation>& candidates = pairs.empty() ? accepted : pairs;
    // test one candidate after the other: only the best ones are reported
    while (!candidates.empty() && is_refuted(candidates.front(), found.sound)) candidates.erase(candidates.begin());
    if (candidates.empty()) return found;
    found.best = candidates.front();
    select_explanations(candidates, found);
    return found;
}

}  // namespace

FaultSearch search_faults(const FileEvidence& evidence, bool all) { return Searcher(evidence, all).search(); }

}  // namespace polhode
