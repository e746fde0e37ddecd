#include "integrators/own/ensemble.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "body/fast_principal_frame.h"
#include "integrators/method.h"
#include "integrators/own/body_laws.h"
#include "integrators/own/extrapolated_lanes.h"
#include "integrators/own/mechanism_ensemble.h"
#include "integrators/own/octets.h"
#include "integrators/run/stiffness.h"
#include "motion/exact_body.h"
#include "motion/formula_model.h"
#include "motion/itinerary.h"
#include "motion/translation.h"
#include "scene/scene_formulas.h"
#include "text/interruption.h"
#include "text/parallel.h"

namespace polhode {
namespace {

// bodies per block: enough to fill the lanes with bodies of one law; with closed forms only, as many as fit in a core's
// cache
constexpr std::size_t block_size = 512, free_block_size = 128;
// up to the first ratio of the largest to the smallest moment, principal moments are computed in binary64, otherwise in
// 128 bits; above the second ratio, bodies are solved individually
constexpr double binary64_moment_ratio = 1e3, lane_moment_ratio = 1e8;
// the range in which squares and quotients of squares neither overflow nor underflow
constexpr double smallest_magnitude = 1e-60, largest_magnitude = 1e60;
// above this number of decay times, stability limits explicit steps: `auto` solves the body individually
constexpr double max_decay_times = 1e4;
// above this error estimate of the closed form, the body is solved individually
constexpr double rounding_limit = 1e-12;
constexpr double min_ensemble_tolerance = 1e-15;

// The motion between two events.
struct Piece {
    double begin = 0, end = 0;
    bool free = false, has_impulses = false;
    bool is_coupled = false;  // translation and rotation depend on each other
};

struct Plan {
    std::vector<Piece> pieces;
    // bodies are solved individually: planes, user-defined torques, formulas that lanes do not support
    bool is_individual = false;
    bool has_translation = false;  // the centre of mass moves freely
    std::optional<FormulaModel> formulas;
};

// why formulas are not solved in lanes; empty if they are
std::string obstacle_of_formulas(const Problem& problem) {
    const FormulaModel& model = formula_model_of(problem);
    if (model.has_switches()) return "formulas with switching points";
    if (model.body().terms().holds() > 0) return "formulas that hold values";
    return is_stiff(problem) ? "stiff equations with formulas" : "";
}
std::string obstacle_of_loads(const Scene& scene) {
    if (!scene.planes.empty()) return "planes";
    const auto is_user = [](const Load& load) { return std::holds_alternative<UserTorque>(load); };
    return std::ranges::any_of(scene.loads, is_user) ? "user-defined torques" : "";
}

Plan make_plan(const Scene& scene, double tolerance) {
    constexpr double min_formula_tolerance = 1e-13;
    Plan plan;
    plan.has_translation = !scene.pivot;
    plan.is_individual = !obstacle_of_loads(scene).empty();
    if (!plan.is_individual && has_formula_loads(scene)) {
        const Problem problem = pose(scene);
        plan.is_individual = tolerance < min_formula_tolerance || !obstacle_of_formulas(problem).empty();
        if (!plan.is_individual) plan.formulas = formula_model_of(problem);
    }
    const ExactBody<double> body = exact_body<double>(scene);
    for (const Leg& leg : itinerary(scene)) {
        const Forcing<double> f = forcing_at(scene, body, leg.begin, Quaternion<double>{});
        const bool is_coupled = !f.pivoted && (f.has_body_force || !f.world_points.empty());
        const bool has_impulse = !impulses_at(scene, body, leg.begin, Quaternion<double>{}).empty();
        plan.pieces.push_back({leg.begin, leg.end, !f.any_torque() && !is_coupled, has_impulse, is_coupled});
    }
    return plan;
}

// Current state of one body, in principal axes.
struct LaneBody {
    std::size_t row = 0;
    ExactBody<double> body;
    PrincipalFrame frame;
    Vector3<double> w;
    Quaternion<double> q;
    Vector3<double> p, v;
    double steps = 0;
    bool running = true, is_individual = false;
};

bool in_range(double x) { return x == 0 || (std::abs(x) >= smallest_magnitude && std::abs(x) <= largest_magnitude); }

// The scene with this body. It keeps its shape if mass and inertia agree.
Scene make_body_scene(const Scene& scene, const EnsembleBody& body) {
    Scene one = scene;
    if (one.body.mass != body.mass || !(one.body.inertia_B == body.inertia_B)) {
        one.body.source = nullptr;
        one.body.mass = body.mass, one.body.inertia_B = body.inertia_B;
    }
    one.initial.orientation = body.orientation;
    one.initial.angular_velocity = body.angular_velocity;
    one.initial.position_W = body.position_W, one.initial.velocity_W = body.velocity_W;
    return one;
}

EnsembleRow solve_individually(const Scene& scene, const EnsembleBody& body, const EnsembleSettings& settings) {
    EnsembleRow row;
    try {
        const Scene one = make_body_scene(scene, body);
        if (!scene.planes.empty() && scene.body.source && !one.body.source) {
            row.status = Status::unsupported;
            row.message = "impacts on planes require the scene's own shape; remove mass and inertia";
            return row;
        }
        validate(one, scene.name);
        const Problem problem = pose(one);
        const Choice choice = choose_method(problem, settings.tolerance);
        Settings run;
        run.samples = 1, run.max_steps = settings.max_steps, run.seconds_limit = settings.seconds_limit;
        if (takes_tolerance(*choice.method)) run.tolerance = settings.tolerance;
        const Trajectory trajectory = solve(problem, *choice.method, with_defaults(problem, *choice.method, run));
        row.status = trajectory.status;
        if (trajectory.status != Status::ok) row.message = trajectory.message;
        if (!trajectory.samples.empty()) row.moved = true, row.end = trajectory.samples.back();
    } catch (const std::exception& error) {
        row.status = Status::failed, row.message = error.what();
    }
    return row;
}

class Block {
  public:
    Block(const Scene& scene, const Plan& plan, const EnsembleSettings& settings, std::span<const EnsembleBody> bodies,
          std::span<EnsembleRow> rows)
        : scene_(scene), plan_(plan), settings_(settings), bodies_(bodies), rows_(rows) {}

    void solve() {
        lane_bodies_.reserve(bodies_.size());
        for (std::size_t i = 0; i < bodies_.size(); ++i) start_body(i);
        if (plan_.formulas)
            advance_with_formulas();
        else
            advance_pieces();
        for (const LaneBody& t : lane_bodies_) {
            if (t.is_individual)
                rows_[t.row] = solve_individually(scene_, bodies_[t.row], settings_);
            else if (t.running && !plan_.formulas)
                write_row(t, scene_.duration);
        }
    }

  private:
    void advance_pieces() {
        for (const Piece& piece : plan_.pieces) {
            if (piece.has_impulses)
                for (LaneBody& t : lane_bodies_) apply_impulses(piece, t);
            if (!(piece.end > piece.begin)) continue;
            if (piece.free)
                advance_free(piece);
            else
                advance_loaded(piece);
        }
    }
    void start_body(std::size_t i) {
        const EnsembleBody& input = bodies_[i];
        rows_[i] = {};
        if (const auto fault = fault_of(input, scene_.pivot.has_value())) {
            rows_[i].status = Status::failed;
            rows_[i].message = fault->columns + " " + fault->fault + "; " + fault->remedy;
            return;
        }
        LaneBody& t = lane_bodies_.emplace_back();
        t.row = i;
        if (plan_.is_individual) {
            t.running = false, t.is_individual = true;
            return;
        }
        ExactBody<double>& b = t.body;
        b.mass = input.mass;
        b.center = scene_.body.center_of_mass;
        b.pivoted = scene_.pivot.has_value();
        b.origin = b.pivoted ? *scene_.pivot : b.center;
        b.arm = b.center - b.origin;
        b.inertia_B = b.pivoted ? input.inertia_B + parallel_axis(b.mass, b.arm) : input.inertia_B;
        b.q = normalized(input.orientation);
        b.angular_velocity_B = input.angular_velocity;
        if (scene_.initial.angular_velocity_frame == Frame::world)
            b.angular_velocity_B = rotate_back(b.q, b.angular_velocity_B);
        t.p = input.position_W, t.v = input.velocity_W;

        t.frame = fast_principal_frame(b.inertia_B);
        const auto spread = [&] {
            const auto& I = t.frame.moments.component;
            const auto [lowest, highest] = std::minmax_element(I.begin(), I.end());
            return *lowest > smallest_magnitude && *highest < largest_magnitude
                       ? *highest / *lowest
                       : std::numeric_limits<double>::infinity();
        };
        if (!(spread() < binary64_moment_ratio)) t.frame = principal_frame(cast<Wide>(b.inertia_B));
        const bool is_rotated = !(t.frame.q_BP == Quaternion<double>{});
        t.w = is_rotated ? rotate_back(t.frame.q_BP, b.angular_velocity_B) : b.angular_velocity_B;
        t.q = is_rotated ? b.q * t.frame.q_BP : b.q;
        t.is_individual =
            !(spread() < lane_moment_ratio) || !in_range(t.w[0]) || !in_range(t.w[1]) || !in_range(t.w[2]);
        // formulas are compiled for the scene's mass and inertia
        t.is_individual |=
            plan_.formulas && (input.mass != scene_.body.mass || !(input.inertia_B == scene_.body.inertia_B));
        t.running = !t.is_individual;
    }

    void apply_impulses(const Piece& piece, LaneBody& t) const {
        if (!t.running) return;
        const PrincipalInertia<double> inertia{t.frame.gyroscopic, t.frame.inverse_moments, false};
        for (const auto& impulse : impulses_at(scene_, t.body, piece.begin, t.frame.q_BP))
            apply(impulse, inertia, t.body.mass, t.body.pivoted, t.w, t.q, t.p, t.v);
    }

    // Advances the bodies under formula loads from event to event.
    void advance_with_formulas() {
        FormulaModel model = *plan_.formulas;
        const std::size_t n = static_cast<std::size_t>(model.dimension());
        std::vector<LaneBody*> bodies;
        for (LaneBody& t : lane_bodies_)
            if (t.running) bodies.push_back(&t);
        std::vector<double> y(n * bodies.size()), sizes(n * bodies.size());
        std::vector<LaneMotion> motions;
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            BodyState::set_rotation(&y[n * k], bodies[k]->body.angular_velocity_B, bodies[k]->body.q);
            if (plan_.has_translation) BodyState::set_translation(&y[n * k], bodies[k]->p, bodies[k]->v);
            motions.push_back({.y = &y[n * k], .sizes = &sizes[n * k]});
        }
        for (const Leg& leg : itinerary(scene_)) {
            if (motions.empty()) return;
            const double span = leg.end - leg.begin;
            model.enter(leg.begin, motions[0].y);
            for (std::size_t k = 1; k < motions.size(); ++k) model.enter_other(leg.begin, motions[k].y);
            for (LaneMotion& motion : motions) {
                set_formula_sizes(model, motion.y, span, sizes.data() + (motion.y - y.data()));
                motion.step = 0;
            }
            if (!(span > 0)) continue;
            ExtrapolatedLanes(record<double>(FormulaRates{&model}, static_cast<int>(n)), formula_units(n),
                              settings_.tolerance, settings_.max_steps, {.instructions = settings_.instructions})
                .advance(motions, span);
            std::size_t active = 0;
            for (std::size_t k = 0; k < motions.size(); ++k) {
                if (motions[k].end == LaneMotion::End::reached) {
                    motions[active] = motions[k], bodies[active++] = bodies[k];
                    continue;
                }
                LaneFailure failure = describe_failure(motions[k], leg.begin, settings_.max_steps);
                write_formula_row(model, motions[k], leg.begin + motions[k].reached, *bodies[k]);
                EnsembleRow& row = rows_[bodies[k]->row];
                row.status = failure.status, row.message = std::move(failure.message);
            }
            motions.resize(active), bodies.resize(active);
        }
        for (std::size_t k = 0; k < motions.size(); ++k)
            write_formula_row(model, motions[k], scene_.duration, *bodies[k]);
    }
    struct FormulaRates {
        const FormulaModel* model;
        void derivative(const Traced<double>* y, Traced<double>* dy) const { model->derivative(y, dy); }
    };
    // w, q, p, v; the time and each auxiliary on their own
    std::vector<int> formula_units(std::size_t n) const {
        std::vector<int> units{0, 0, 0, 3, 3, 3, 3};
        if (plan_.has_translation) units.insert(units.end(), {7, 7, 7, 10, 10, 10});
        while (units.size() < n) units.push_back(static_cast<int>(units.size()));
        return units;
    }
    void set_formula_sizes(const FormulaModel& model, const double* y, double span, double* sizes) const {
        const std::vector<double> common = model.scales();
        std::vector<double> rate(common.size());
        model.derivative(y, rate.data());
        const std::size_t time = static_cast<std::size_t>(model.body().time_index());
        set_body_sizes(y, rate.data(), span, plan_.has_translation, sizes);
        for (std::size_t i = time; i < common.size(); ++i) sizes[i] = std::max(common[i], std::abs(y[i]));
    }
    void write_formula_row(const FormulaModel& model, const LaneMotion& motion, double at, LaneBody& t) {
        EnsembleRow& row = rows_[t.row];
        row.moved = true, row.end = model.motion(motion.y)[0], row.end.t = at;
        t.running = false;
    }

    // Applies the forces that act on the translation only.
    void translate_free(const Piece& piece, LaneBody& t) const {
        if (!plan_.has_translation) return;
        Vector3<double> a;
        double drag = 0;
        for (const Load& load : scene_.loads) {
            if (!acts(window_of(load), piece.begin)) continue;
            if (const auto* gravity = std::get_if<Gravity>(&load)) a = a + gravity->acceleration_W;
            if (const auto* force = std::get_if<Force>(&load)) a = a + (1 / t.body.mass) * force->vector;
            if (const auto* friction = std::get_if<Drag>(&load)) drag += friction->translational / t.body.mass;
        }
        translate(a, drag, piece.end - piece.begin, t.p, t.v);
    }

    void advance_free(const Piece& piece) {
        const std::size_t count = (lane_bodies_.size() + 7) / 8;
        octets_.resize(count);
        for (std::size_t i = 0; i < 8 * count; ++i) {
            // lanes without a body compute a body at rest
            static const LaneBody idle_lane = [] {
                LaneBody t;
                t.frame.moments = {1, 1, 1};
                return t;
            }();
            const bool is_active = i < lane_bodies_.size() && lane_bodies_[i].running;
            const LaneBody& t = is_active ? lane_bodies_[i] : idle_lane;
            FreeOctet& octet = octets_[i / 8];
            const std::size_t lane = i % 8;
            for (std::size_t k = 0; k < 3; ++k)
                octet.moments[k].v[lane] = t.frame.moments[k], octet.w[k].v[lane] = t.w[k];
            const double q[4] = {t.q.w, t.q.x, t.q.y, t.q.z};
            for (int k = 0; k < 4; ++k) octet.q[k].v[lane] = q[k];
        }
        advance_free_octets(octets_.data(), count, piece.end - piece.begin, settings_.instructions);
        const double limit = std::max(settings_.tolerance, rounding_limit);
        for (std::size_t i = 0; i < lane_bodies_.size(); ++i) {
            LaneBody& t = lane_bodies_[i];
            if (!t.running) continue;
            const FreeOctet& octet = octets_[i / 8];
            const std::size_t lane = i % 8;
            for (std::size_t k = 0; k < 3; ++k) t.w[k] = octet.w[k].v[lane];
            t.q = {octet.q[0].v[lane], octet.q[1].v[lane], octet.q[2].v[lane], octet.q[3].v[lane]};
            if (!(octet.error.v[lane] <= limit) || !(t.q.w * 0 == 0)) t.running = false, t.is_individual = true;
            translate_free(piece, t);
        }
    }

    BodyLaw<double> body_law(const Piece& piece, const LaneBody& t) const {
        return {{t.frame.gyroscopic, t.frame.inverse_moments, false},
                forcing_at(scene_, t.body, piece.begin, t.frame.q_BP),
                piece.is_coupled};
    }
    static bool has_stiff_damping(const BodyLaw<double>& law, double span) {
        double decay = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& row = law.forcing.damping[i];
            const double rate = std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]);
            decay = std::max(decay, law.inertia.inverse_moments[i] * rate);
        }
        return !(decay * span <= max_decay_times);
    }

    // Bodies with one law. `y` holds the variables and parameters of each, `sizes` their error scales.
    struct Batch {
        BodyLaw<double> law;
        std::vector<LaneBody*> bodies;
        std::vector<double> y, sizes;
    };

    static double largest(const double* x) { return std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}); }

    // Error scales of w, q and, with translation, p and v.
    static void set_body_sizes(const double* y, const double* rate, double span, bool has_translation, double* sizes) {
        // the larger of w and the rate that w reaches in the time of a rotation by one radian
        std::fill_n(sizes, 3, std::max({largest(y), std::sqrt(largest(rate)), 1e-100}));
        std::fill_n(sizes + 3, 4, 1.0);
        if (!has_translation) return;
        const double speed = std::max({largest(y + 10), largest(rate + 10) * span, 1e-100});
        std::fill_n(sizes + 7, 3, std::max({largest(y + 7), speed * span, 1e-100}));
        std::fill_n(sizes + 10, 3, speed);
    }
    static void append_body(Batch& batch, BodyLaw<double>& law, double span, const LaneBody& t) {
        double y[BodyState::motion], rate[BodyState::motion]{};
        BodyState::set_rotation(y, t.w, t.q), BodyState::set_translation(y, t.p, t.v);
        law.derivative(y, rate);
        const int n = law.variables();
        batch.y.insert(batch.y.end(), y, y + n);
        double sizes[BodyState::motion];
        set_body_sizes(y, rate, span, law.has_translation, sizes);
        batch.sizes.insert(batch.sizes.end(), sizes, sizes + n);
        for (const double number : law.parameters())
            if (number != 0) batch.y.push_back(number), batch.sizes.push_back(1);
    }
    static void append_symmetric_body(int s, Batch& batch, const BodyLaw<double>& law, const LaneBody& t) {
        const int i = (s + 1) % 3, j = (s + 2) % 3;
        const double inverse = law.inertia.inverse_moments[i], c = t.frame.moments[s] * t.w[s] * inverse;
        double mu[3], largest_mu = 0;
        for (int b = 0; b < 3; ++b) {
            mu[b] = law.forcing.field.moment[(s + 1 + b) % 3][s] * inverse;
            largest_mu = std::max(largest_mu, std::abs(mu[b]));
        }
        const double q[4] = {t.q.w, t.q.x, t.q.y, t.q.z};
        for (const double number : {t.w[i], t.w[j], q[0], q[1 + i], q[1 + j], q[1 + s], c, mu[0], mu[1], mu[2]})
            batch.y.push_back(number);
        const double rotation_rate =
            std::max({std::abs(t.w[i]), std::abs(t.w[j]), std::abs(c), std::sqrt(largest_mu), 1e-100});
        batch.sizes.insert(batch.sizes.end(), {rotation_rate, rotation_rate, 1, 1, 1, 1, 1, 1, 1, 1});
    }
    static void store_symmetric_rotation(int s, const LaneMotion& motion, LaneBody& t) {
        const int i = (s + 1) % 3, j = (s + 2) % 3;
        const double *const y = motion.y, angle = t.w[s] * motion.reached, sine = std::sin(angle);
        const double cosine = std::cos(angle);
        const Quaternion<double> q =
            quaternion_at(y, 2) * Quaternion<double>{std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
        t.w[i] = cosine * y[0] + sine * y[1], t.w[j] = cosine * y[1] - sine * y[0];
        double principal[4] = {q.w, 0, 0, 0};
        principal[1 + i] = q.x, principal[1 + j] = q.y, principal[1 + s] = q.z;
        t.q = quaternion_at(principal, 0);
    }

    void advance_loaded(const Piece& piece) {
        const double span = piece.end - piece.begin;
        // key: the axis of symmetry, and the parameters that are not zero
        std::map<std::pair<int, std::vector<bool>>, Batch> batches;
        for (LaneBody& t : lane_bodies_) {
            if (!t.running) continue;
            BodyLaw<double> law = body_law(piece, t);
            if (has_stiff_damping(law, span)) {
                t.running = false, t.is_individual = true;
                continue;
            }
            const int s = SymmetricBody::axis(law, t.frame.moments);
            const auto& present = law.forcing.field.present;
            std::vector<bool> kind{law.forcing.has_torque, law.forcing.has_world_torque, present[0], present[1],
                                   present[2]};
            for (const double number : law.parameters())
                if (s < 0) kind.push_back(number != 0);
            Batch& batch = batches[{s, kind}];
            if (batch.bodies.empty()) batch.law = law;
            batch.bodies.push_back(&t);
            if (s < 0)
                append_body(batch, law, span, t);
            else
                append_symmetric_body(s, batch, law, t);
        }
        for (auto& [kind, batch] : batches) advance(piece, kind.first, batch);
    }

    void advance(const Piece& piece, int s, Batch& batch) {
        const auto& present = batch.law.forcing.field.present;
        const int n = static_cast<int>(batch.y.size() / batch.bodies.size());
        std::vector<int> units{0, 0, 0, 3, 3, 3, 3};
        if (s >= 0) units = {0, 0, 2, 2, 2, 2};
        if (batch.law.has_translation) units.insert(units.end(), {7, 7, 7, 10, 10, 10});
        for (int i = static_cast<int>(units.size()); i < n; ++i) units.push_back(i);
        const auto recording = s < 0 ? record<double>(ParametrizedBody{batch.law}, n)
                                     : record<double>(SymmetricBody{{present[(s + 1) % 3], present[(s + 2) % 3],
                                                                     present[static_cast<std::size_t>(s)]}},
                                                      n);
        ExtrapolatedLanes lanes(recording, std::move(units), std::max(settings_.tolerance, min_ensemble_tolerance),
                                settings_.max_steps, {.instructions = settings_.instructions});
        std::vector<LaneMotion> motions(batch.bodies.size());
        for (std::size_t k = 0; k < motions.size(); ++k) {
            const std::size_t first = k * static_cast<std::size_t>(n);
            motions[k].y = &batch.y[first], motions[k].sizes = &batch.sizes[first];
        }
        lanes.advance(motions, piece.end - piece.begin);
        for (std::size_t k = 0; k < motions.size(); ++k) {
            LaneBody& t = *batch.bodies[k];
            if (s < 0)
                t.w = BodyState::angular_velocity(motions[k].y), t.q = BodyState::attitude(motions[k].y);
            else
                store_symmetric_rotation(s, motions[k], t);
            store_result(piece, motions[k], t);
        }
    }

    void store_result(const Piece& piece, const LaneMotion& motion, LaneBody& t) {
        if (piece.is_coupled) t.p = BodyState::position(motion.y), t.v = BodyState::velocity(motion.y);
        if (motion.end != LaneMotion::End::reached) {
            LaneFailure failure = describe_failure(motion, piece.begin, settings_.max_steps);
            t.running = false;
            write_row(t, piece.begin + motion.reached);
            rows_[t.row].status = failure.status, rows_[t.row].message = std::move(failure.message);
            return;
        }
        if (!piece.is_coupled) translate_free(piece, t);
        if (settings_.tolerance < min_ensemble_tolerance) {
            rows_[t.row].status = Status::tolerance_not_met;
            rows_[t.row].message = "a tolerance below 1e-15 cannot be met in binary64";
        }
    }

    void write_row(const LaneBody& t, double at) {
        Sample& s = rows_[t.row].end;
        const bool is_rotated = !(t.frame.q_BP == Quaternion<double>{});
        rows_[t.row].moved = true;
        s.t = at;
        s.q = is_rotated ? t.q * conjugate(t.frame.q_BP) : t.q;
        s.angular_velocity_B = is_rotated ? rotate(t.frame.q_BP, t.w) : t.w;
        s.position_W = t.p, s.velocity_W = t.v;
        if (t.body.pivoted) pivoted_center(s.q, s.angular_velocity_B, t.body.arm, s.position_W, s.velocity_W);
    }

    const Scene& scene_;
    const Plan& plan_;
    const EnsembleSettings& settings_;
    std::span<const EnsembleBody> bodies_;
    std::span<EnsembleRow> rows_;
    std::vector<LaneBody> lane_bodies_;
    std::vector<FreeOctet> octets_;
};

}  // namespace

void require_in_range(const EnsembleSettings& settings) {
    if (!(settings.tolerance > 0) || !std::isfinite(settings.tolerance))
        throw std::invalid_argument("the tolerance must be finite and > 0");
    if (settings.threads < 1 || settings.max_steps < 1 || !(settings.seconds_limit > 0))
        throw std::invalid_argument("threads and max_steps must be at least 1, seconds_limit must be > 0");
    if (settings.instructions > widest_instruction_set())
        throw std::invalid_argument("this processor does not support the requested instruction set");
}

struct EnsembleSolver::Prepared {
    Scene scene;
    EnsembleSettings settings;
    Plan plan;
};

EnsembleSolver::EnsembleSolver(const Scene& scene, const EnsembleSettings& settings) {
    require_in_range(settings);
    if (is_mechanism(scene)) throw std::invalid_argument("EnsembleSolver supports only scenes of one body");
    validate(scene, scene.name);
    prepared_.reset(new Prepared{scene, settings, make_plan(scene, settings.tolerance)});
}

std::string why_one_by_one(const Problem& problem) {
    if (is_mechanism(problem.scene)) return why_mechanisms_one_by_one(problem);
    const std::string obstacle = obstacle_of_loads(problem.scene);
    return obstacle.empty() && has_formula_loads(problem.scene) ? obstacle_of_formulas(problem) : obstacle;
}

EnsembleSolver::~EnsembleSolver() = default;
EnsembleSolver::EnsembleSolver(EnsembleSolver&&) noexcept = default;
EnsembleSolver& EnsembleSolver::operator=(EnsembleSolver&&) noexcept = default;

std::size_t EnsembleSolver::block() const {
    const Plan& plan = prepared_->plan;
    // individual solves are slow: small blocks distribute them over all threads
    if (plan.is_individual) return 8;
    const bool free = std::ranges::all_of(plan.pieces, [](const Piece& piece) { return piece.free; });
    return free ? free_block_size : block_size;
}

void EnsembleSolver::solve(std::span<const EnsembleBody> bodies, std::span<EnsembleRow> rows) const {
    if (rows.size() != bodies.size()) throw std::invalid_argument("the number of rows must equal the number of bodies");
    const std::size_t size = block(), blocks = (bodies.size() + size - 1) / size;
    const auto solve_block = [&](std::size_t i) {
        const std::size_t first = i * size, count = std::min(size, bodies.size() - first);
        if (Interruption::is_requested()) {
            for (EnsembleRow& row : rows.subspan(first, count))
                row.status = Status::failed, row.message = "interrupted";
            return;
        }
        Block(prepared_->scene, prepared_->plan, prepared_->settings, bodies.subspan(first, count),
              rows.subspan(first, count))
            .solve();
    };
    parallel_for(blocks, prepared_->settings.threads, solve_block);
}

void solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies, const EnsembleSettings& settings,
                    std::span<EnsembleRow> rows) {
    EnsembleSolver(scene, settings).solve(bodies, rows);
}

std::vector<EnsembleRow> solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies,
                                        const EnsembleSettings& settings) {
    std::vector<EnsembleRow> rows(bodies.size());
    solve_ensemble(scene, bodies, settings, rows);
    return rows;
}

}  // namespace polhode
