#include "integrators/own/mechanism_ensemble.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <stdexcept>
#include <utility>

#include "integrators/contact/joint_events.h"
#include "integrators/method.h"
#include "integrators/own/extrapolated_lanes.h"
#include "integrators/run/stiffness.h"
#include "motion/itinerary.h"
#include "motion/mechanism.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/parallel.h"

namespace polhode {
namespace {

MechanismRow solve_row(const Scene& scene, long samples, const EnsembleSettings& settings) {
    MechanismRow row;
    try {
        const Problem problem = pose(scene);
        const Choice choice = choose_method(problem, settings.tolerance);
        Settings run;
        run.samples = samples, run.max_steps = settings.max_steps, run.seconds_limit = settings.seconds_limit;
        if (takes_tolerance(*choice.method)) run.tolerance = settings.tolerance;
        Trajectory trajectory = solve(problem, *choice.method, with_defaults(problem, *choice.method, run));
        row.status = trajectory.status;
        if (trajectory.status != Status::ok) row.message = std::move(trajectory.message);
        const std::ptrdiff_t start = std::ssize(scene.bodies);
        if (std::ssize(trajectory.samples) > start)
            row.samples.assign(trajectory.samples.begin() + start, trajectory.samples.end());
    } catch (const std::exception& error) {
        row.status = Status::failed, row.message = error.what();
    }
    return row;
}

// what lanes do not support; empty if nothing
std::string obstacle_of(const Scene& scene) {
    if (!scene.loops.empty() || !scene.couplings.empty()) return "loops or couplings";
    if (contact::has_joint_events(scene)) return "limits, friction or prescribed motions of joints";
    if (has_formula_loads(scene)) return "formulas in a scene of several bodies";
    return has_sphere_contacts(scene) ? "contacts" : "";
}

// Motions of one mechanism, a lane each.
class MechanismLanes {
  public:
    MechanismLanes(const Scene& scene, const MechanismModel& model, const MechanismTable& table, std::size_t first,
                   std::span<MechanismRow> rows, const EnsembleSettings& settings)
        : scene_(scene),
          model_(model),
          settings_(settings),
          rows_(rows),
          n_(static_cast<std::size_t>(model.dimension())) {
        const std::vector<double> sizes = model.scales();
        y_.resize(n_ * rows.size());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            sizes_.insert(sizes_.end(), sizes.begin(), sizes.end());
            const Scene row = table.scene_of(scene, first + k);
            try {
                Tree<double>(row, bodies_mass_properties<double>(row)).initial(&y_[n_ * k]);
                row_index_.push_back(k);
            } catch (const InputError& fault) {
                // a singular mass matrix
                rows[k].status = Status::failed, rows[k].message = fault.what();
            }
        }
        for (const std::size_t k : row_index_) motions_.push_back({.y = &y_[n_ * k], .sizes = &sizes_[n_ * k]});
        // components of one kind have the same size
        for (const double size : sizes)
            units_.push_back(static_cast<int>(std::find(sizes.begin(), sizes.end(), size) - sizes.begin()));
    }

    void solve(long count) {
        if (motions_.empty()) return;
        SampleQueue samples(scene_.duration, count);
        samples.pop();
        follow(
            itinerary(scene_), samples, [&](const Leg& leg) { return enter(leg); },
            [&](double t) { return record_samples(t); },
            [&](const Leg& leg) {
                for (; samples.in(leg); samples.pop())
                    if (!advance(samples.front()) || !record_samples(samples.front())) return false;
                return advance(leg.end);
            });
    }

  private:
    bool enter(const Leg& leg) {
        std::vector<double> unused(n_);
        model_.initial(unused.data());
        model_.enter(leg.begin, unused.data());
        for (LaneMotion& motion : motions_) model_.tree().apply_impulses(scene_, leg.begin, motion.y), motion.step = 0;
        struct Form {
            const MechanismModel* model;
            void derivative(const Traced<double>* y, Traced<double>* dy) const { model->derivative(y, dy); }
        };
        lanes_.emplace(record<double>(Form{&model_}, static_cast<int>(n_)), units_, settings_.tolerance,
                       settings_.max_steps, TapeOptions{.instructions = settings_.instructions});
        now_ = leg.begin;
        return true;
    }
    bool record_samples(double t) {
        for (std::size_t k = 0; k < motions_.size(); ++k) {
            std::vector<Sample>& samples = rows_[row_index_[k]].samples;
            for (Sample& sample : model_.motion(motions_[k].y)) sample.t = t, samples.push_back(sample);
        }
        return true;
    }
    bool advance(double until) {
        if (!(until > now_)) return true;
        lanes_->advance(motions_, until - now_);
        std::size_t active = 0;
        for (std::size_t k = 0; k < motions_.size(); ++k) {
            const LaneMotion& motion = motions_[k];
            if (motion.end == LaneMotion::End::reached) {
                motions_[active] = motion, row_index_[active++] = row_index_[k];
                continue;
            }
            MechanismRow& row = rows_[row_index_[k]];
            LaneFailure failure = describe_failure(motion, now_, settings_.max_steps);
            row.status = failure.status, row.message = std::move(failure.message);
        }
        motions_.resize(active), row_index_.resize(active);
        now_ = until;
        return active > 0;
    }

    const Scene& scene_;
    MechanismModel model_;
    const EnsembleSettings& settings_;
    std::span<MechanismRow> rows_;
    std::size_t n_;
    std::vector<double> y_, sizes_;
    std::vector<LaneMotion> motions_;
    std::vector<std::size_t> row_index_;
    std::vector<int> units_;
    std::optional<ExtrapolatedLanes> lanes_;
    double now_ = 0;
};

}  // namespace

MechanismEnsembleSolver::MechanismEnsembleSolver(const Scene& scene, bool only_starts, long samples,
                                                 const EnsembleSettings& settings)
    : scene_(scene), settings_(settings), samples_(samples) {
    require_in_range(settings);
    if (samples < 1) throw std::invalid_argument("samples must be at least 1");
    constexpr double min_lane_tolerance = 1e-13;
    if (!obstacle_of(scene).empty() || !only_starts || settings.tolerance < min_lane_tolerance) return;
    common_problem_ = pose(scene);
    if (is_stiff(*common_problem_)) common_problem_.reset();
}

std::string why_mechanisms_one_by_one(const Problem& problem) {
    const std::string obstacle = obstacle_of(problem.scene);
    return obstacle.empty() && is_stiff(problem) ? "stiff equations" : obstacle;
}

void MechanismEnsembleSolver::solve(const MechanismTable& table, std::span<MechanismRow> rows) const {
    if (rows.size() != table.rows()) throw std::invalid_argument("an ensemble has as many rows as its table");
    const std::size_t size = block();
    parallel_for((rows.size() + size - 1) / size, settings_.threads, [&](std::size_t i) {
        const std::size_t first = i * size;
        const auto some = rows.subspan(first, std::min(size, rows.size() - first));
        if (common_problem_)
            MechanismLanes(scene_, mechanism_of(*common_problem_), table, first, some, settings_).solve(samples_);
        else
            some[0] = solve_row(table.scene_of(scene_, first), samples_, settings_);
    });
}

std::vector<MechanismRow> solve_mechanism_ensemble(const Scene& scene, const MechanismTable& table, long samples,
                                                   const EnsembleSettings& settings) {
    std::vector<MechanismRow> rows(table.rows());
    MechanismEnsembleSolver(scene, table.only_starts(), samples, settings).solve(table, rows);
    return rows;
}

}  // namespace polhode
