// The kind `event_truth`: the truth of scenes with contacts or with limits and friction of joints. Digits to which its
// two formulations agree, their events, and closed forms compared with the truth.
#include <algorithm>
#include <cmath>

#include "experiment/kinds/closed_forms.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/published_figures.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "integrators/truth/attempt.h"
#include "text/parallel.h"

namespace polhode {
namespace {

constexpr int event_truth_digits = 25;
constexpr double working_precision = 1e-50;  // equal runs agree to this
constexpr int quick_digits = 10;             // requested with --quick
constexpr double quick_seconds_limit = 5;    // time limit with --quick

/// The truth of a scene and its comparisons.
struct EventTruth {
    std::vector<Cell> row;
    std::vector<FormComparison> forms;
};

// The form with the largest difference; a form without a computed value counts as larger than all others.
const FormComparison* find_worst(const std::vector<FormComparison>& forms) {
    const auto worse = [](const FormComparison& a, const FormComparison& b) {
        return a.difference && (!b.difference || *a.difference < *b.difference);
    };
    return forms.empty() ? nullptr : &*std::ranges::max_element(forms, worse);
}

EventTruth compute_event_truth(const PlannedScene& planned, long samples, int digits, double seconds_limit) {
    const truth::Truth truth = truth::find_truth(planned.scene, samples, digits, seconds_limit);
    EventTruth result{{planned.label, planned.scene.duration}, compare_closed_forms(planned.scene, truth)};
    const auto where_available = [&](const Cell& cell) { return truth.reference.available ? cell : Cell(); };
    const double bound = truth.reference.bound;
    const bool any = !truth.contact_events.empty();
    const FormComparison* worst = find_worst(result.forms);
    const auto add = [&](const std::vector<Cell>& cells) {
        result.row.insert(result.row.end(), cells.begin(), cells.end());
    };
    add({where_available(static_cast<long>(truth.contact_events.size())),
         any ? Cell(format_wide(parse_wide(truth.contact_events.back().t), event_truth_digits)) : Cell(),
         // the bound covers times relative to the duration, or in s
         any ? Cell(bound * std::max(planned.scene.duration, 1.0)) : Cell(), static_cast<long>(digits),
         where_available(static_cast<long>(std::floor(-std::log10(std::max(bound, working_precision))))),
         where_available(bound), where_available(truth.seconds)});
    add({worst ? Cell(worst->quantity) : Cell(), worst ? cell_of(worst->difference) : Cell(),
         static_cast<long>(result.forms.size()), truth.reference.message});
    return result;
}

}  // namespace

Findings run_event_truth(const Plan& plan, const RunOptions& options) {
    NamedTable truths = make_named_table("", "",
                                         {{"scene", "scene"},
                                          {"duration", "T (s)"},
                                          {"events", "events"},
                                          {"last_event_time", "last event (s)"},
                                          {"last_event_bound", "bound (s)"},
                                          {"digits_asked", ""},
                                          {"digits_agreed", "digits agreed"},
                                          {"bound", "bound"},
                                          {"seconds", "time (s)"},
                                          {"closed_form", "closed form"},
                                          {"closed_form_difference", "difference"},
                                          {"closed_forms", ""},
                                          {"message", ""}});
    NamedTable forms = make_named_table("closed_forms", "Closed forms and first integrals compared with the truth",
                                        {{"scene", "scene"},
                                         {"source", "source"},
                                         {"quantity", "quantity"},
                                         {"form", "closed form"},
                                         {"expected", "its value"},
                                         {"ours", "polhode"},
                                         {"difference", "difference"}});
    std::vector<EventTruth> all(plan.scenes.size());
    const int digits = options.quick ? quick_digits : event_truth_digits;
    const double limit = options.quick ? quick_seconds_limit : plan.experiment.seconds_per_run;
    // each truth uses two threads most of the time
    parallel_for(plan.scenes.size(), std::max(1, options.jobs / 2), [&](std::size_t i) {
        all[i] = compute_event_truth(plan.scenes[i], plan.experiment.samples, digits, limit);
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
        truths.table.rows.push_back(std::move(all[i].row));
        for (const FormComparison& form : all[i].forms)
            forms.table.rows.push_back({plan.scenes[i].label, form.source, form.quantity, form.form, form.expected,
                                        form.computed, cell_of(form.difference)});
    }
    return {{std::move(truths), std::move(forms)}};
}

}  // namespace polhode
