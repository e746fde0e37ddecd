#include "check/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <variant>

#include "motion/exact_body.h"

namespace polhode {

std::size_t span_of(double t, double begin, double end) {
    const double length = end - begin;
    if (!(length > 0)) return 0;
    const double k = std::ceil(static_cast<double>(most_spans) * ((t - begin) / length)) - 1;
    return std::min(most_spans - 1, static_cast<std::size_t>(std::max(k, 0.0)));
}

bool is_larger(double error, double largest) { return !std::isnan(largest) && !(error <= largest); }

bool rotates_alone(const Scene& scene) {
    return scene.planes.empty() && std::ranges::none_of(scene.loads, [](const Load& load) {
               const auto* force = std::get_if<Force>(&load);
               const auto* impulse = std::get_if<Impulse>(&load);
               return (force && force->point_frame == Frame::world) ||
                      (impulse && impulse->point_frame == Frame::world);
           });
}

/// The largest errors so far, not yet relative to anything.
struct Judge::Tally {
    ErrorSummary all;
    std::array<double, most_spans> span{};

    void note(double error, double t, std::size_t k) {
        all.final = error;
        if (is_larger(error, all.max)) all.max = error, all.max_time = t;
        if (is_larger(error, span[k])) span[k] = error;
    }
    void append(const Tally& later) {
        all.final = later.all.final;
        if (is_larger(later.all.max, all.max)) all.max = later.all.max, all.max_time = later.all.max_time;
        for (std::size_t k = 0; k < most_spans; ++k)
            if (is_larger(later.span[k], span[k])) span[k] = later.span[k];
    }
    void divide_by(double scale) {
        if (!(scale > 0)) return;
        all.max /= scale, all.final /= scale;
        for (double& value : span) value /= scale;
    }
};

struct Judge::State {
    const Scene* scene;
    const TrajectoryFile* file;
    std::variant<ExactBody<Wide>, ExactBody<double>> body;
    // Whether the energy is that of rotation: of a body that flies, whose rotation does not hang on where it is, in a
    // file without all of the translation.
    bool rotational = false;
    PerMeasure<Tally> tallies = {};
    PerMeasure<double> scales = {};
    PerMeasure<double> sizes = {};  // of what is not relative
    std::array<double, most_spans> until{};
    std::optional<std::size_t> kept_measure{};
    std::vector<double> kept{};
    std::size_t place = measure_index("position"), speed = measure_index("velocity"), energy = measure_index("energy");

    // where the centre of mass starts
    template <class S>
    static Vector3<S> own_start(const ExactBody<S>& own) {
        return own.pivoted ? rotate(own.q, own.arm) : own.position_W;
    }
    bool has_position() const { return file->has_position || file->has_origin; }

    // whether the file's columns tell what a measure needs
    bool knows(const Measure& measure) const {
        const bool center =
            scene->pivot || (has_position() && file->has_velocity) || (rotational && measure.name == "energy");
        const unsigned known = known_truth | (file->has_angular_velocity ? known_angular_velocity : 0U) |
                               (has_position() ? known_position : 0U) | (file->has_velocity ? known_velocity : 0U) |
                               (center ? known_center : 0U);
        return measure.of_one_body() && (measure.needs & ~known) == 0;
    }

    std::size_t span_of(double t) const { return polhode::span_of(t, file->rows.front().t, file->rows.back().t); }

    // both without their translation: what remains is the energy of rotation
    template <class S>
    ComparedSample<S> at_rest_in_place(ComparedSample<S> c, const ExactBody<S>& own, double t,
                                       const Quaternion<S>& unit) const {
        c.position_W = c.velocity_W = c.truth.position_W = c.truth.velocity_W = {};
        set_invariants(c, *scene, own, t, unit);
        const Invariants<S> right =
            invariants(*scene, own, t, c.truth.q, c.truth.angular_velocity_B, c.truth.position_W, c.truth.velocity_W);
        c.truth.kinetic = right.kinetic, c.truth.energy = right.energy;
        return c;
    }

    template <class S>
    void add(const ExactBody<S>& own, const TrajectoryRow& row, const ReferenceSample& reference) {
        if (row.t != reference.t) throw std::invalid_argument("there is no truth at the file's times");
        const std::size_t k = span_of(row.t);
        until[k] = row.t;
        ComparedSample<S> c;
        c.truth = true_state(own, reference);
        c.q = cast<S>(row.q);
        const Quaternion<S> unit = normalized(c.q);
        // what the file does not tell is not judged: the truth stands in for it
        c.position_W = has_position() ? cast<S>(row.position_W) : c.truth.position_W;
        if (file->has_origin) c.position_W = c.position_W + rotate(unit, own.center);
        c.velocity_W = file->has_velocity ? cast<S>(row.velocity_W) : c.truth.velocity_W;
        c.angular_velocity_B = file->has_angular_velocity ? rotate_back(unit, cast<S>(row.angular_velocity_W))
                                                          : c.truth.angular_velocity_B;
        set_invariants(c, *scene, own, row.t, unit);
        std::optional<ComparedSample<S>> alone;
        if (rotational) alone = at_rest_in_place(c, own, row.t, unit);
        const std::span<const Measure> all = measures();
        for (std::size_t m = 0; m < all.size(); ++m) {
            if (!knows(all[m])) continue;
            const ComparedSample<S>& compared = alone && m == energy ? *alone : c;
            const auto error = static_cast<double>(all[m].error(compared));
            tallies[m].note(error, row.t, k);
            if (kept_measure == m) kept.push_back(error);
            if (all[m].scale) scales[m] = std::max(scales[m], double(all[m].scale(compared.truth)));
        }
        sizes[place] = std::max(sizes[place], double(length(c.truth.position_W - own_start(own))));
        sizes[speed] = std::max(sizes[speed], double(length(c.truth.velocity_W)));
    }
};

Judge::Judge(const Scene& scene, const TrajectoryFile& file, JudgedIn arithmetic)
    : state_(std::make_unique<State>(State{&scene, &file, exact_body<Wide>(scene)})) {
    state_->rotational = !scene.pivot && !(state_->has_position() && file.has_velocity) && rotates_alone(scene);
    if (arithmetic == JudgedIn::binary64) state_->body = exact_body<double>(scene);
}
Judge::~Judge() = default;
Judge::Judge(Judge&&) noexcept = default;

void Judge::add(std::size_t first, std::span<const ReferenceSample> truth) {
    if (first + truth.size() > state_->file->rows.size())
        throw std::invalid_argument("the truth has more samples than the file");
    std::visit(
        [&](const auto& body) {
            for (std::size_t k = 0; k < truth.size(); ++k) state_->add(body, state_->file->rows[first + k], truth[k]);
        },
        state_->body);
}

void Judge::keep(std::size_t measure) { state_->kept_measure = measure; }

std::vector<double> Judge::kept() const {
    std::vector<double> errors = state_->kept;
    if (const double scale = state_->scales[*state_->kept_measure]; scale > 0)
        for (double& error : errors) error /= scale;
    return errors;
}

void Judge::append(const Judge& later) {
    const State& other = *later.state_;
    state_->kept.insert(state_->kept.end(), other.kept.begin(), other.kept.end());
    for (std::size_t m = 0; m < measures().size(); ++m) {
        state_->tallies[m].append(other.tallies[m]);
        state_->scales[m] = std::max(state_->scales[m], other.scales[m]);
        state_->sizes[m] = std::max(state_->sizes[m], other.sizes[m]);
    }
    for (std::size_t k = 0; k < most_spans; ++k) state_->until[k] = std::max(state_->until[k], other.until[k]);
}

Judgement Judge::result() const {
    std::array<bool, most_spans> seen{};
    for (const TrajectoryRow& row : state_->file->rows) seen[state_->span_of(row.t)] = true;
    PerMeasure<Tally> tallies = state_->tallies;
    Judgement result;
    for (std::size_t m = 0; m < measures().size(); ++m) {
        tallies[m].divide_by(state_->scales[m]);
        result.size[m] = std::max(state_->scales[m], state_->sizes[m]);
        if (state_->knows(measures()[m])) result[m] = tallies[m].all;
    }
    for (std::size_t k = 0; k < most_spans; ++k) {
        if (!seen[k]) continue;
        ErrorSpan& span = result.over_time.emplace_back();
        span.until = state_->until[k];
        for (std::size_t m = 0; m < measures().size(); ++m) span.error[m] = tallies[m].span[k];
    }
    return result;
}

Judgement judge(const Scene& scene, const TrajectoryFile& file, const Reference& truth, JudgedIn arithmetic) {
    if (is_mechanism(scene)) return judge_system(scene, file, truth);
    if (!truth.available || truth.samples.size() != file.rows.size())
        throw std::invalid_argument("there is no truth at the file's times");
    Judge whole(scene, file, arithmetic);
    whole.add(0, truth.samples);
    return whole.result();
}

}  // namespace polhode
