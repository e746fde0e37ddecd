#include "check/judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <variant>

#include "motion/exact_body.h"

namespace polhode {
namespace {

constexpr std::size_t most_spans = 10;
enum Kind { attitude, norm, omega, energy, momentum, position, velocity, kinds };

// a value of the truth in the arithmetic asked for: binary64 drops the low part
template <class S>
S value(const Pair& pair) {
    return S(pair.high) + S(pair.low);
}
template <class S>
Vector3<S> value(const Vector3<Pair>& v) {
    return {value<S>(v[0]), value<S>(v[1]), value<S>(v[2])};
}
template <class S>
Quaternion<S> value(const Quaternion<Pair>& q) {
    return {value<S>(q.w), value<S>(q.x), value<S>(q.y), value<S>(q.z)};
}
template <class S>
S magnitude(const S& x) {
    return x < 0 ? -x : x;
}
template <class S>
S length(const Vector3<S>& v) {
    return square_root(dot(v, v));
}

// The largest errors so far, not yet relative to anything.
struct Tally {
    ErrorSummary all;
    std::array<double, most_spans> span{};

    void note(double error, double t, std::size_t k) {
        all.final = error;
        // a NaN is the largest of all
        if (!(error <= all.max)) all.max = error, all.max_time = t;
        if (!(error <= span[k])) span[k] = error;
    }
    void append(const Tally& later) {
        all.final = later.all.final;
        if (!(later.all.max <= all.max)) all.max = later.all.max, all.max_time = later.all.max_time;
        for (std::size_t k = 0; k < most_spans; ++k) span[k] = std::max(span[k], later.span[k]);
    }
    void divide_by(double scale) {
        if (!(scale > 0)) return;
        all.max /= scale, all.final /= scale;
        for (double& value : span) value /= scale;
    }
};

}  // namespace

struct Judge::State {
    const Scene* scene;
    const TrajectoryFile* file;
    std::variant<ExactBody<Wide>, ExactBody<double>> body;
    std::array<Tally, kinds> tallies{};
    std::array<double, most_spans> until{};
    double omega_scale = 0, momentum_scale = 0, energy_scale = 0;

    bool has_position() const { return file->has_position || file->has_origin; }

    std::size_t span_of(double t) const {
        const double begin = file->rows.front().t, length = file->rows.back().t - begin;
        if (!(length > 0)) return 0;
        // a span ends with the sample at its end
        const double k = std::ceil(static_cast<double>(most_spans) * ((t - begin) / length)) - 1;
        return std::min(most_spans - 1, static_cast<std::size_t>(std::max(k, 0.0)));
    }

    template <class S>
    void add(const ExactBody<S>& own, const TrajectoryRow& row, const ReferenceSample& truth) {
        if (row.t != truth.t) throw std::invalid_argument("there is no truth at the file's times");
        const std::size_t k = span_of(row.t);
        const auto note = [&](Kind kind, const S& error) { tallies[kind].note(double(error), row.t, k); };
        until[k] = row.t;

        const Quaternion<S> q = cast<S>(row.q), q_true = value<S>(truth.q);
        const Vector3<S> w_true = value<S>(truth.angular_velocity_B), p_true = value<S>(truth.position_W),
                         v_true = value<S>(truth.velocity_W), L_true = value<S>(truth.angular_momentum_W);
        const S square = squared_norm(q), size = square_root(square);
        // |q| - 1 = (|q|^2 - 1) / (|q| + 1), with nothing cancelled in binary64
        note(norm, magnitude(S(square - S(1))) / (size + S(1)));
        const Quaternion<S> between = conjugate(q_true) * q;
        note(attitude, S(2 * std::atan2(double(length(vector_part(between))), double(magnitude(between.w)))));
        const Quaternion<S> unit{q.w / size, q.x / size, q.y / size, q.z / size};
        Vector3<S> p = p_true, v = v_true;  // what the file does not tell is not judged: the truth stands in for it
        if (has_position()) {
            p = cast<S>(row.position_W);
            if (file->has_origin) p = p + rotate(unit, own.center);
            note(position, length(p - p_true));
        }
        if (file->has_velocity) {
            v = cast<S>(row.velocity_W);
            note(velocity, length(v - v_true));
        }
        if (!file->has_angular_velocity) return;
        const Vector3<S> w = rotate_back(unit, cast<S>(row.angular_velocity_W));
        S kinetic = dot(w_true, own.inertia_B * w_true) / S(2);
        if (!own.pivoted) kinetic += own.mass * dot(v_true, v_true) / S(2);
        omega_scale = std::max(omega_scale, double(length(w_true)));
        momentum_scale = std::max(momentum_scale, double(length(L_true)));
        energy_scale = std::max({energy_scale, double(kinetic), std::abs(truth.energy.high)});
        const Invariants<S> kept = invariants(*scene, own, row.t, unit, w, p, v);
        note(omega, length(w - w_true));
        note(momentum, length(kept.angular_momentum_W - L_true));
        note(energy, magnitude(S(kept.energy - value<S>(truth.energy))));
    }
};

Judge::Judge(const Scene& scene, const TrajectoryFile& file, JudgedIn arithmetic)
    : state_(std::make_unique<State>(State{&scene, &file, exact_body<Wide>(scene)})) {
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

void Judge::append(const Judge& later) {
    const State& other = *later.state_;
    for (int kind = 0; kind < kinds; ++kind) state_->tallies[kind].append(other.tallies[kind]);
    for (std::size_t k = 0; k < most_spans; ++k) state_->until[k] = std::max(state_->until[k], other.until[k]);
    state_->omega_scale = std::max(state_->omega_scale, other.omega_scale);
    state_->momentum_scale = std::max(state_->momentum_scale, other.momentum_scale);
    state_->energy_scale = std::max(state_->energy_scale, other.energy_scale);
}

Judgement Judge::result() const {
    const TrajectoryFile& file = *state_->file;
    std::array<Tally, kinds> t = state_->tallies;
    t[omega].divide_by(state_->omega_scale);
    t[momentum].divide_by(state_->momentum_scale);
    t[energy].divide_by(state_->energy_scale);
    Judgement result;
    result.attitude = t[attitude].all, result.norm = t[norm].all;
    if (state_->has_position()) result.position = t[position].all;
    if (file.has_velocity) result.velocity = t[velocity].all;
    const bool knows_energy = state_->scene->pivot || (state_->has_position() && file.has_velocity);
    if (file.has_angular_velocity) {
        result.omega = t[omega].all, result.momentum = t[momentum].all;
        if (knows_energy) result.energy = t[energy].all;
    }
    std::vector<bool> seen(most_spans, false);
    for (const TrajectoryRow& row : file.rows) seen[state_->span_of(row.t)] = true;
    for (std::size_t k = 0; k < most_spans; ++k)
        if (seen[k])
            result.over_time.push_back({state_->until[k], t[attitude].span[k], t[norm].span[k],
                                        result.energy ? t[energy].span[k] : 0,
                                        result.momentum ? t[momentum].span[k] : 0});
    return result;
}

Judgement judge(const Scene& scene, const TrajectoryFile& file, const Reference& truth, JudgedIn arithmetic) {
    if (!truth.available || truth.samples.size() != file.rows.size())
        throw std::invalid_argument("there is no truth at the file's times");
    Judge whole(scene, file, arithmetic);
    whole.add(0, truth.samples);
    return whole.result();
}

}  // namespace polhode
