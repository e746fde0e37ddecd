#include "check/file_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <variant>

#include "measure/scene_measure.h"
#include "scene/scene_formulas.h"

namespace polhode {

std::size_t span_of(double t, double begin, double end) {
    const double length = end - begin;
    if (!(length > 0)) return 0;
    const double k = std::ceil(static_cast<double>(most_spans) * ((t - begin) / length)) - 1;
    return std::min(most_spans - 1, static_cast<std::size_t>(std::max(k, 0.0)));
}

bool rotation_is_independent(const Scene& scene) {
    return scene.planes.empty() && !has_formula_loads(scene) && std::ranges::none_of(scene.loads, [](const Load& load) {
               const auto* force = std::get_if<Force>(&load);
               const auto* impulse = std::get_if<Impulse>(&load);
               return (force && force->point_frame == Frame::world) ||
                      (impulse && impulse->point_frame == Frame::world);
           });
}

/// The largest errors so far, before division by a scale.
struct FileErrorAccumulator::Tally {
    ErrorSummary all;
    std::array<double, most_spans> span{};
    bool any = false;  // whether an error was added

    bool is_worst(double error) const { return !any || is_larger(error, all.max); }
    void note(double error, double t, std::size_t k) {
        any = true;
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

struct FileErrorAccumulator::State {
    // The measures in one scalar type, with buffers that are filled at each time.
    template <class S>
    struct Arithmetic {
        explicit Arithmetic(const Scene& scene) : measure(scene) { compared.bodies.resize(measure.bodies()); }

        SceneMeasure<S> measure;
        ComparedMotion<S> compared{};
        std::vector<BodyMotion<S>> motions{}, truth{};  // q of unit length
    };

    const Scene* scene;
    const TrajectoryFile* file;
    std::vector<std::size_t> places;  // indices in the scene of the file's bodies
    std::vector<std::string> joints;
    std::variant<Arithmetic<Wide>, Arithmetic<double>> arithmetic;
    JointCoordinates coordinates, true_coordinates;
    // Whether the rotational energy is compared: without p or v, if the rotation does not depend on the position.
    bool rotational = false;
    PerMeasure<Tally> tallies = {};
    PerMeasure<double> scales = {};
    PerMeasure<double> sizes = {};  // of position and velocity, which are not relative
    std::array<double, most_spans> until{};
    std::optional<std::size_t> row_measure{};
    std::vector<double> row_errors{};
    std::vector<Vector3<double>> starts{};  // positions at the file's first time
    std::string worst_body{}, worst_gap{}, worst_turn{};
    std::size_t place = measure_index("position"), speed = measure_index("velocity"), energy = measure_index("energy"),
                attitude = measure_index("attitude"), gap = measure_index("joint_gap"),
                turn = measure_index("joint_turn"), omega = measure_index("omega");

    bool has_position() const { return file->has_position || file->has_origin; }
    bool has_all_bodies() const { return places.size() == body_count(*scene); }
    bool is_of_several() const {
        return std::visit([](const auto& a) { return a.measure.is_of_several(); }, arithmetic);
    }

    // Whether the file has the columns that a measure needs.
    bool can_compute(const Measure& measure) const {
        const bool center =
            scene->pivot || (has_position() && file->has_velocity) || (rotational && measure.name == "energy");
        const unsigned known = known_truth | known_free_system |
                               (file->has_angular_velocity ? known_angular_velocity : 0U) |
                               (has_position() ? known_position : 0U) | (file->has_velocity ? known_velocity : 0U) |
                               (center ? known_center : 0U);
        // momenta and energy of several bodies need the states of all bodies
        if (measure.whole_error && !has_all_bodies()) return false;
        return std::visit(
            [&](const auto& a) { return a.measure.has(measure) && (a.measure.needs(measure) & ~known) == 0; },
            arithmetic);
    }

    std::size_t span_of(double t) const { return polhode::span_of(t, file->rows.front().t, file->rows.back().t); }

    // Overwrites the true motion by a row of the file. Blocks that the file lacks keep the true values.
    template <class S>
    void read(const TrajectoryRow& row, const Vector3<S>& center, BodyMotion<S>& computed) const {
        computed.q = cast<S>(row.q);
        const Quaternion<S> unit = normalized(computed.q);
        if (has_position()) computed.position_W = cast<S>(row.position_W);
        if (file->has_origin) computed.position_W = computed.position_W + rotate(unit, center);
        if (file->has_velocity) computed.velocity_W = cast<S>(row.velocity_W);
        if (file->has_angular_velocity)
            computed.angular_velocity_B = rotate_back(unit, cast<S>(row.angular_velocity_W));
    }

    // Returns both motions without translation, so that their energy is rotational.
    template <class S>
    ComparedMotion<S> without_translation(const Arithmetic<S>& a, double t) {
        ComparedMotion<S> c = a.compared;
        BodyMotion<S> computed = a.motions[0], right = a.truth[0];
        computed.position_W = computed.velocity_W = right.position_W = right.velocity_W = {};
        c.computed = a.measure.invariants(t, {&computed, 1}, coordinates);
        c.truth = a.measure.invariants(t, {&right, 1}, true_coordinates);
        return c;
    }

    template <class S>
    void add(Arithmetic<S>& a, std::span<const TrajectoryRow> rows, std::span<const ReferenceSample> truth) {
        const double t = rows[0].t;
        if (t != truth[0].t) throw std::invalid_argument("no truth available at the file's times");
        const std::size_t k = span_of(t);
        until[k] = t;
        a.truth.clear();
        for (const ReferenceSample& sample : truth) a.truth.push_back(true_motion<S>(sample));
        for (std::size_t b = 0; b < a.truth.size(); ++b)
            a.compared.bodies[b].truth = a.compared.bodies[b].computed = a.truth[b];
        for (std::size_t i = 0; i < rows.size(); ++i)
            read(rows[i], a.measure.center(places[i]), a.compared.bodies[places[i]].computed);
        a.motions.clear();
        for (const ComparedBody<S>& body : a.compared.bodies) {
            a.motions.push_back(body.computed);
            a.motions.back().q = normalized(body.computed.q);
        }
        a.compared.truth = a.measure.true_invariants(truth, a.truth, true_coordinates);
        if (has_all_bodies()) {
            a.compared.computed = a.measure.invariants(t, a.motions, coordinates);
            a.compared.joints = a.measure.violations(a.motions);
        }
        std::optional<ComparedMotion<S>> alone;
        if (rotational) alone = without_translation(a, t);
        const std::span<const Measure> all = measures();
        for (std::size_t m = 0; m < all.size(); ++m) {
            if (!can_compute(all[m])) continue;
            const ComparedMotion<S>& compared = alone && m == energy ? *alone : a.compared;
            const auto [wide_error, body] = error_in(all[m], compared);
            const auto error = static_cast<double>(wide_error);
            if (tallies[m].is_worst(error)) store_worst(m, body, a.compared.joints);
            tallies[m].note(error, t, k);
            if (row_measure == m) row_errors.push_back(error);
            scales[m] = std::max(scales[m], double(scale_in<S>(all[m], a.truth, compared.truth)));
        }
        if (starts.empty())
            for (const BodyMotion<S>& body : a.truth)
                starts.push_back(cast<double>(a.measure.is_of_several() ? body.position_W : a.measure.start_W()));
        for (std::size_t b = 0; b < a.truth.size(); ++b) {
            sizes[place] = std::max(sizes[place], double(length(a.truth[b].position_W - cast<S>(starts[b]))));
            sizes[speed] = std::max(sizes[speed], double(length(a.truth[b].velocity_W)));
        }
    }

    template <class S>
    void store_worst(std::size_t m, std::size_t body, const JointViolations<S>& violations) {
        const auto joint = [&](std::size_t j) { return j < joints.size() ? joints[j] : std::string(); };
        if (m == attitude) worst_body = scene_body(*scene, body).name;
        if (m == gap) worst_gap = joint(violations.gap_joint);
        if (m == turn) worst_turn = joint(violations.turn_joint);
    }
};

FileErrorAccumulator::FileErrorAccumulator(const Scene& scene, const TrajectoryFile& file, ErrorArithmetic arithmetic) {
    using Arithmetics = decltype(State::arithmetic);
    state_ = std::make_unique<State>(State{&scene, &file, bodies_of_file(scene, file), joint_names(scene),
                                           arithmetic == ErrorArithmetic::binary64
                                               ? Arithmetics(State::Arithmetic<double>(scene))
                                               : Arithmetics(State::Arithmetic<Wide>(scene)),
                                           JointCoordinates(scene), JointCoordinates(scene)});
    state_->rotational = !state_->is_of_several() && !scene.pivot && !(state_->has_position() && file.has_velocity) &&
                         rotation_is_independent(scene);
}
FileErrorAccumulator::~FileErrorAccumulator() = default;
FileErrorAccumulator::FileErrorAccumulator(FileErrorAccumulator&&) noexcept = default;

void FileErrorAccumulator::add(std::size_t first, std::span<const ReferenceSample> truth) {
    const std::span<const TrajectoryRow> rows = state_->file->rows;
    const std::size_t at_once = state_->places.size(), bodies = body_count(*state_->scene),
                      moments = truth.size() / bodies;
    if ((first + moments) * at_once > rows.size())
        throw std::invalid_argument("the truth has more samples than the file");
    std::visit(
        [&](auto& a) {
            for (std::size_t k = 0; k < moments; ++k)
                state_->add(a, rows.subspan((first + k) * at_once, at_once), truth.subspan(k * bodies, bodies));
        },
        state_->arithmetic);
}

void FileErrorAccumulator::keep_row_errors(std::size_t measure) { state_->row_measure = measure; }

std::vector<double> FileErrorAccumulator::row_errors() const {
    std::vector<double> errors = state_->row_errors;
    if (const double scale = state_->scales[*state_->row_measure]; scale > 0)
        for (double& error : errors) error /= scale;
    return errors;
}

void FileErrorAccumulator::append(const FileErrorAccumulator& later) {
    const State& other = *later.state_;
    state_->row_errors.insert(state_->row_errors.end(), other.row_errors.begin(), other.row_errors.end());
    for (std::size_t m = 0; m < measures().size(); ++m) {
        state_->tallies[m].append(other.tallies[m]);
        state_->scales[m] = std::max(state_->scales[m], other.scales[m]);
        state_->sizes[m] = std::max(state_->sizes[m], other.sizes[m]);
    }
    for (std::size_t k = 0; k < most_spans; ++k) state_->until[k] = std::max(state_->until[k], other.until[k]);
}

FileErrors FileErrorAccumulator::result() const {
    std::array<bool, most_spans> seen{};
    for (const TrajectoryRow& row : state_->file->rows) seen[state_->span_of(row.t)] = true;
    PerMeasure<Tally> tallies = state_->tallies;
    PerMeasure<double> scales = state_->scales;
    // the rate of several bodies at rest is only the truth's round-off
    if (double& rate = scales[state_->omega]; state_->is_of_several() && rate * state_->scene->duration < vanishing)
        rate = 0;
    FileErrors result;
    result.worst_body = state_->worst_body, result.worst_gap = state_->worst_gap,
    result.worst_turn = state_->worst_turn;
    for (std::size_t m = 0; m < measures().size(); ++m) {
        tallies[m].divide_by(scales[m]);
        result.size[m] = std::max(scales[m], state_->sizes[m]);
        if (state_->can_compute(measures()[m])) result[m] = tallies[m].all;
    }
    for (std::size_t k = 0; k < most_spans; ++k) {
        if (!seen[k]) continue;
        ErrorSpan& span = result.over_time.emplace_back();
        span.until = state_->until[k];
        for (std::size_t m = 0; m < measures().size(); ++m) span.error[m] = tallies[m].span[k];
    }
    return result;
}

FileErrors compute_file_errors(const Scene& scene, const TrajectoryFile& file, const Reference& truth,
                               ErrorArithmetic arithmetic) {
    if (!truth.available || file.rows.empty() || truth.moments() * file.bodies_at_once() != file.rows.size())
        throw std::invalid_argument("no truth available at the file's times");
    FileErrorAccumulator whole(scene, file, arithmetic);
    whole.add(0, truth.samples);
    return whole.result();
}

}  // namespace polhode
