// The kind `mechanism_truth`: the truth of scenes of several bodies, with the digits to which its two formulations
// agree and the proven digits; and published numbers of mechanisms compared with the truth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiment/kinds/kinds.h"
#include "experiment/kinds/published_figures.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "integrators/truth/attempt.h"
#include "integrators/truth/balls/certified.h"
#include "measure/measures.h"
#include "motion/mechanism.h"
#include "motion/mechanism_motion.h"
#include "text/parallel.h"

namespace polhode {
namespace {

constexpr int requested_digits = 25;
// fraction of the duration with --quick, and if the whole motion exceeds the time limit
constexpr double part = 1.0 / 64;
constexpr double quick_seconds = 1;    // time limit with --quick
constexpr double part_of_proof = 0.2;  // time limit of the proof, relative to that of the truth

struct Freedoms {
    long freedoms = 0, rows = 0, redundant = 0;
};

Freedoms count_freedoms(const Scene& scene) {
    const Tree<Wide> tree(scene, bodies_mass_properties<Wide>(scene));
    const long rows = static_cast<long>(tree.loop_rows()),
               independent = static_cast<long>(tree.independent_loop_rows());
    return {tree.links().rates - independent, rows, rows - independent};
}

// The largest gap and turn of all joints and loops over the samples of the truth.
JointViolations<Wide> largest_violations(const Scene& scene, const Reference& truth) {
    const MechanismMeasure<Wide> measure(scene);
    JointViolations<Wide> largest;
    std::vector<BodyMotion<Wide>> motions(measure.bodies());
    for (std::size_t k = 0; k < truth.moments(); ++k) {
        for (std::size_t b = 0; b < motions.size(); ++b)
            motions[b] = true_motion<Wide>(truth.samples[k * motions.size() + b]);
        const JointViolations<Wide> now = measure.violations(motions);
        largest.gap = std::max(largest.gap, now.gap), largest.turn = std::max(largest.turn, now.turn);
    }
    return largest;
}

std::vector<Cell> truth_row(const PlannedScene& planned, long samples, bool quick, double seconds_limit) {
    Scene scene = planned.scene;
    if (quick) scene.duration *= part, seconds_limit = quick_seconds;
    truth::Truth truth = truth::find_truth(scene, samples, requested_digits, seconds_limit);
    if (truth.limit_reached && !quick) {
        scene.duration *= part;
        truth = truth::find_truth(scene, samples, requested_digits, seconds_limit);
    }
    const Freedoms count = count_freedoms(scene);
    std::vector<Cell> row{
        planned.label,  static_cast<long>(scene.bodies.size()), count.freedoms, count.rows, count.redundant,
        scene.duration, static_cast<long>(requested_digits)};
    if (!truth.reference.available) {
        row.insert(row.end(),
                   {Cell(), Cell(), Cell(), Cell(), Cell(), Cell(), Cell(), Cell(), truth.reference.message});
        return row;
    }
    const double bound = truth.reference.bound;
    const JointViolations<Wide> open = largest_violations(scene, truth.reference);
    const CertifiedReference proof =
        certified_reference(scene, samples, requested_digits, part_of_proof * seconds_limit);
    const auto where_proven = [&](const Cell& cell) { return proof.available ? cell : Cell(); };
    row.insert(row.end(), {static_cast<long>(std::floor(-std::log10(std::max(bound, 1e-99)))), bound,
                           where_proven(static_cast<long>(proof.digits)), static_cast<double>(open.gap),
                           static_cast<double>(open.turn), truth.seconds, where_proven(proof.seconds), proof.message,
                           truth.reference.message});
    return row;
}

}  // namespace

Findings run_mechanism_truth(const Plan& plan, const RunOptions& options) {
    NamedTable truths = make_named_table("", "",
                                         {{"scene", "scene"},
                                          {"bodies", "bodies"},
                                          {"degrees_of_freedom", "degrees of freedom"},
                                          {"loop_rows", "loop equations"},
                                          {"redundant_rows", "redundant"},
                                          {"duration", "T (s)"},
                                          {"digits_asked", "digits requested"},
                                          {"digits_agreed", "digits agreed"},
                                          {"bound", "bound"},
                                          {"digits_proven", "digits proven"},
                                          {"joint_gap_max", "largest gap (m)"},
                                          {"joint_turn_max", ""},
                                          {"seconds", "time (s)"},
                                          {"proof_seconds", "time of the proof (s)"},
                                          {"proof", ""},
                                          {"message", "remark"}});
    truths.table.rows.resize(plan.scenes.size());
    // each truth uses two threads most of the time
    parallel_for(plan.scenes.size(), std::max(1, options.jobs / 2), [&](std::size_t i) {
        truths.table.rows[i] =
            truth_row(plan.scenes[i], plan.experiment.samples, options.quick, plan.experiment.seconds_per_run);
    });
    NamedTable published = make_named_table("figures", "Published numbers compared with the truth",
                                            {{"mechanism", "mechanism"},
                                             {"source", "source"},
                                             {"quantity", "quantity"},
                                             {"published", "published"},
                                             {"ours", "polhode"},
                                             {"difference", "relative difference"},
                                             {"digits_printed", "digits printed"},
                                             {"digits_right", "correct digits"}});
    for (const PublishedFigure& figure : compare_figures(options.quick, plan.experiment.samples))
        published.table.rows.push_back({figure.mechanism, figure.source, figure.quantity, figure.published,
                                        figure.computed, cell_of(figure.difference), cell_of(figure.digits_printed),
                                        cell_of(figure.correct_digits)});
    return {{std::move(truths), std::move(published)}};
}

}  // namespace polhode
