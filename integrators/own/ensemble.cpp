#include "integrators/own/ensemble.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "body/fast_principal_frame.h"
#include "integrators/method.h"
#include "integrators/own/octets.h"
#include "motion/exact_body.h"
#include "motion/itinerary.h"
#include "motion/translation.h"
#include "text/decimal.h"
#include "text/parallel.h"

namespace polhode {
namespace {

constexpr std::size_t block_size = 512;
// principal moments nearer than this are found in binary64; beyond, in 128 bits; beyond the second, one by one
constexpr double near_moments = 1e3, far_moments = 1e8;
// the range in which squares and quotients of squares neither overflow nor underflow
constexpr double least = 1e-60, most = 1e60;
// beyond this many decay times explicit steps are bound by stability, and the body goes to `auto` alone
constexpr double stiff_decays = 1e4;
// what the closed form's own estimate may come to before it is set up in 128 bits
constexpr double rounding_limit = 1e-12;
constexpr double least_tolerance = 1e-15;

// The motion between two events.
struct Piece {
    double begin = 0, end = 0;
    bool free = false, impulses = false;
    LoadTerms terms;
};

struct Plan {
    std::vector<Piece> pieces;
    bool one_by_one = false;  // loads that the kernels do not know
    bool drifts = false;      // p and v move by themselves
};

// Which terms there are: those of the scene's loads, for all bodies alike.
LoadTerms terms_of(const Forcing<double>& f) {
    LoadTerms terms;
    terms.torque = f.has_torque, terms.damping = f.has_damping, terms.spring = !f.springs.empty();
    for (int b = 0; b < 3; ++b)
        if (f.field.present[b] || (f.has_world_torque && f.torque_W[b] != 0)) terms.axis[terms.axes++] = b;
    return terms;
}

bool translation_couples(const Forcing<double>& f, const std::vector<PosedImpulse<double>>& impulses) {
    if (f.pivoted) return false;
    return f.has_body_force || std::any_of(impulses.begin(), impulses.end(), [](const PosedImpulse<double>& impulse) {
               return impulse.frame == Frame::body || impulse.point_frame == Frame::world;
           });
}

Plan plan_of(const Scene& scene) {
    Plan plan;
    plan.one_by_one = !scene.planes.empty();
    plan.drifts = !scene.pivot;
    for (const Load& load : scene.loads) plan.one_by_one |= std::holds_alternative<UserTorque>(load);
    const ExactBody<double> body = exact_body<double>(scene);
    for (const Leg& leg : itinerary(scene)) {
        const Forcing<double> f = forcing_at(scene, body, leg.begin, Quaternion<double>{});
        const auto impulses = impulses_at(scene, body, leg.begin, Quaternion<double>{});
        plan.one_by_one |= !f.world_points.empty() || f.springs.size() > 1 || translation_couples(f, impulses);
        plan.pieces.push_back({leg.begin, leg.end, !f.any_torque(), !impulses.empty(), terms_of(f)});
    }
    return plan;
}

// One body on its way, in principal axes.
struct Traveller {
    std::size_t row = 0;
    ExactBody<double> body;
    PrincipalFrame frame;
    Vector3<double> w;
    Quaternion<double> q;
    Vector3<double> p, v;
    double steps = 0;
    bool running = true, one_by_one = false;
};

bool in_range(double x) { return x == 0 || (std::abs(x) >= least && std::abs(x) <= most); }

// A scene of one body; its own where they agree, so that a shape is kept.
Scene scene_with(const Scene& scene, const EnsembleBody& body) {
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

EnsembleRow solve_one(const Scene& scene, const EnsembleBody& body, const EnsembleSettings& settings) {
    EnsembleRow row;
    try {
        const Scene one = scene_with(scene, body);
        if (!scene.planes.empty() && scene.body.source && !one.body.source) {
            row.status = Status::unsupported;
            row.message = "impacts on planes are those of the scene's own shape: leave out mass and inertia";
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
        travellers_.reserve(bodies_.size());
        for (std::size_t i = 0; i < bodies_.size(); ++i) begin(i);
        for (const Piece& piece : plan_.pieces) {
            if (piece.impulses)
                for (Traveller& t : travellers_) strike(piece, t);
            if (!(piece.end > piece.begin)) continue;
            if (piece.free)
                advance_free(piece);
            else
                advance_loaded(piece);
        }
        for (const Traveller& t : travellers_) {
            if (t.one_by_one)
                rows_[t.row] = solve_one(scene_, bodies_[t.row], settings_);
            else if (t.running)
                end(t, scene_.duration);
        }
    }

  private:
    void begin(std::size_t i) {
        const EnsembleBody& given = bodies_[i];
        rows_[i] = {};
        if (const auto fault = fault_of(given, scene_.pivot.has_value())) {
            rows_[i].status = Status::failed;
            rows_[i].message = fault->columns + " " + fault->fault + "; " + fault->remedy;
            return;
        }
        Traveller t;
        t.row = i;
        if (plan_.one_by_one) {
            t.running = false, t.one_by_one = true;
            travellers_.push_back(t);
            return;
        }
        ExactBody<double>& b = t.body;
        b.mass = given.mass;
        b.center = scene_.body.center_of_mass;
        b.pivoted = scene_.pivot.has_value();
        b.origin = b.pivoted ? *scene_.pivot : b.center;
        b.arm = b.center - b.origin;
        b.inertia_B = b.pivoted ? given.inertia_B + parallel_axis(b.mass, b.arm) : given.inertia_B;
        b.q = normalized(given.orientation);
        b.angular_velocity_B = given.angular_velocity;
        if (scene_.initial.angular_velocity_frame == Frame::world)
            b.angular_velocity_B = rotate_back(b.q, b.angular_velocity_B);
        t.p = given.position_W, t.v = given.velocity_W;

        t.frame = fast_principal_frame(b.inertia_B);
        const auto spread = [&] {
            const auto& I = t.frame.moments.component;
            const auto [lowest, highest] = std::minmax_element(I.begin(), I.end());
            return *lowest > least && *highest < most ? *highest / *lowest : std::numeric_limits<double>::infinity();
        };
        if (!(spread() < near_moments)) t.frame = principal_frame(cast<Wide>(b.inertia_B));
        const bool turned = !(t.frame.q_BP == Quaternion<double>{});
        t.w = turned ? rotate_back(t.frame.q_BP, b.angular_velocity_B) : b.angular_velocity_B;
        t.q = turned ? b.q * t.frame.q_BP : b.q;
        t.one_by_one = !(spread() < far_moments) || !in_range(t.w[0]) || !in_range(t.w[1]) || !in_range(t.w[2]);
        t.running = !t.one_by_one;
        travellers_.push_back(t);
    }

    void strike(const Piece& piece, Traveller& t) const {
        if (!t.running) return;
        const PrincipalInertia<double> inertia{t.frame.gyroscopic, t.frame.inverse_moments, false};
        for (const auto& impulse : impulses_at(scene_, t.body, piece.begin, t.frame.q_BP))
            apply(impulse, inertia, t.body.mass, t.body.pivoted, t.w, t.q, t.p, t.v);
    }

    // The forces that move the centre of mass alone.
    void translate_free(const Piece& piece, Traveller& t) const {
        if (!plan_.drifts) return;
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
        const std::size_t count = (travellers_.size() + 7) / 8;
        octets_.resize(count);
        for (std::size_t i = 0; i < 8 * count; ++i) {
            // a lane without a body holds one at rest
            static const Traveller nobody = [] {
                Traveller t;
                t.frame.moments = {1, 1, 1};
                return t;
            }();
            const bool held = i < travellers_.size() && travellers_[i].running;
            const Traveller& t = held ? travellers_[i] : nobody;
            FreeOctet& octet = octets_[i / 8];
            const std::size_t lane = i % 8;
            for (std::size_t k = 0; k < 3; ++k)
                octet.moments[k].v[lane] = t.frame.moments[k], octet.w[k].v[lane] = t.w[k];
            const double q[4] = {t.q.w, t.q.x, t.q.y, t.q.z};
            for (int k = 0; k < 4; ++k) octet.q[k].v[lane] = q[k];
        }
        advance_free_octets(octets_.data(), count, piece.end - piece.begin, settings_.instructions);
        const double limit = std::max(settings_.tolerance, rounding_limit);
        for (std::size_t i = 0; i < travellers_.size(); ++i) {
            Traveller& t = travellers_[i];
            if (!t.running) continue;
            const FreeOctet& octet = octets_[i / 8];
            const std::size_t lane = i % 8;
            for (std::size_t k = 0; k < 3; ++k) t.w[k] = octet.w[k].v[lane];
            t.q = {octet.q[0].v[lane], octet.q[1].v[lane], octet.q[2].v[lane], octet.q[3].v[lane]};
            if (!(octet.error.v[lane] <= limit) || !(t.q.w * 0 == 0)) t.running = false, t.one_by_one = true;
            translate_free(piece, t);
        }
    }

    // The lane of one body; false where its damping is stiff.
    bool load(const Piece& piece, const Traveller& t, LoadedLane& lane) const {
        const Forcing<double> f = forcing_at(scene_, t.body, piece.begin, t.frame.q_BP);
        const Vector3<double>& inverse = t.frame.inverse_moments;
        double decay = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            lane.w[i] = t.w[i];
            lane.gyroscopic[i] = t.frame.gyroscopic[i];
            lane.torque[i] = inverse[i] * f.torque[i];
            for (std::size_t j = 0; j < 3; ++j) lane.damping[i][j] = inverse[i] * f.damping[i][j];
            const auto& row = lane.damping[i];
            decay = std::max(decay, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
            if (!f.springs.empty()) lane.stiffness[i] = inverse[i] * (2 * f.springs[0].stiffness);
        }
        for (int n = 0; n < piece.terms.axes; ++n) {
            const auto b = static_cast<std::size_t>(piece.terms.axis[n]);
            const Vector3<double>& m = f.field.moment[b];
            const double tau = f.has_world_torque ? f.torque_W[b] : 0;
            const double rows[3][3] = {{tau, -m[2], m[1]}, {m[2], tau, -m[0]}, {-m[1], m[0], tau}};
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j) lane.field[n][i][j] = inverse[i] * rows[i][j];
        }
        const double q[4] = {t.q.w, t.q.x, t.q.y, t.q.z};
        std::copy_n(q, 4, lane.q);
        if (!f.springs.empty()) {
            const Quaternion<double>& r = f.springs[0].rest;
            const double rest[4] = {r.w, r.x, r.y, r.z};
            std::copy_n(rest, 4, lane.rest);
        }
        return decay * (piece.end - piece.begin) <= stiff_decays;
    }

    // The axis of two equal moments that all fields' moments lie along, where nothing else acts; -1 if there is none.
    static int symmetry_axis(const Piece& piece, const Traveller& t, const LoadedLane& lane) {
        const LoadTerms& terms = piece.terms;
        if (terms.torque || terms.damping || terms.spring || terms.axes == 0) return -1;
        for (int s = 0; s < 3; ++s) {
            const int i = (s + 1) % 3, j = (s + 2) % 3;
            bool along = t.frame.moments[i] == t.frame.moments[j];
            for (int n = 0; n < terms.axes; ++n) {
                const auto& M = lane.field[n];
                along = along && M[s][i] == 0 && M[s][j] == 0 && M[0][0] == 0 && M[1][1] == 0 && M[2][2] == 0;
            }
            if (along) return s;
        }
        return -1;
    }

    // From principal axes to those of SymmetricSeries, both they and the world's relabelled (i, j, s) -> (1, 2, 3).
    static LoadedLane symmetric_lane(int s, const Piece& piece, const Traveller& t, const LoadedLane& lane) {
        const int i = (s + 1) % 3, j = (s + 2) % 3;
        LoadedLane relabelled;
        relabelled.w[0] = lane.w[i], relabelled.w[1] = lane.w[j], relabelled.w[2] = lane.w[s];
        const double q[4] = {lane.q[0], lane.q[1 + i], lane.q[1 + j], lane.q[1 + s]};
        std::copy_n(q, 4, relabelled.q);
        relabelled.gyroscopic[0] = t.frame.moments[s] * lane.w[s] * t.frame.inverse_moments[i];
        relabelled.least_rate = std::abs(relabelled.gyroscopic[0]);
        for (int n = 0; n < piece.terms.axes; ++n) relabelled.field[n][0][0] = lane.field[n][j][i];
        return relabelled;
    }

    static void leave_symmetric_axes(int s, LoadedLane& lane) {
        const int i = (s + 1) % 3, j = (s + 2) % 3;
        const double angle = lane.w[2] * lane.reached, sine = std::sin(angle), cosine = std::cos(angle);
        const Quaternion<double> spin{std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
        const Quaternion<double> q = Quaternion<double>{lane.q[0], lane.q[1], lane.q[2], lane.q[3]} * spin;
        double w[3], principal[4] = {q.w, 0, 0, 0};
        w[i] = cosine * lane.w[0] + sine * lane.w[1];
        w[j] = cosine * lane.w[1] - sine * lane.w[0];
        w[s] = lane.w[2];
        principal[1 + i] = q.x, principal[1 + j] = q.y, principal[1 + s] = q.z;
        std::copy_n(w, 3, lane.w);
        std::copy_n(principal, 4, lane.q);
    }

    void advance_loaded(const Piece& piece) {
        // [3]: any body; [s]: symmetric about axis s
        for (auto& queue : queues_) queue.lanes.clear(), queue.travellers.clear();
        for (Traveller& t : travellers_) {
            if (!t.running) continue;
            LoadedLane lane;
            if (!load(piece, t, lane)) {
                t.running = false, t.one_by_one = true;
                continue;
            }
            const int s = symmetry_axis(piece, t, lane);
            Queue& queue = queues_[s < 0 ? 3 : static_cast<std::size_t>(s)];
            queue.lanes.push_back(s < 0 ? lane : symmetric_lane(s, piece, t, lane));
            queue.travellers.push_back(&t);
        }
        const LaneSteps steps{piece.end - piece.begin, std::max(settings_.tolerance, least_tolerance) / 10,
                              static_cast<double>(settings_.max_steps)};
        for (int s = 0; s < 4; ++s) {
            Queue& queue = queues_[static_cast<std::size_t>(s)];
            if (queue.lanes.empty()) continue;
            LoadTerms terms = piece.terms;
            if (s < 3)
                for (int& axis : terms.axis) axis = (axis - s + 2) % 3;
            advance_loaded_lanes(queue.lanes.data(), queue.lanes.size(), terms, s < 3, steps, settings_.instructions);
            for (std::size_t i = 0; i < queue.lanes.size(); ++i) {
                if (s < 3) leave_symmetric_axes(s, queue.lanes[i]);
                arrive(piece, queue.lanes[i], *queue.travellers[i]);
            }
        }
    }

    void arrive(const Piece& piece, const LoadedLane& lane, Traveller& t) {
        t.w = {lane.w[0], lane.w[1], lane.w[2]};
        t.q = {lane.q[0], lane.q[1], lane.q[2], lane.q[3]};
        if (lane.end != LoadedLane::End::reached) {
            const double at = piece.begin + lane.reached;
            const bool finite = lane.end != LoadedLane::End::not_finite;
            fail(t, finite ? Status::failed : Status::diverged, at,
                 finite ? "more than " + std::to_string(settings_.max_steps) + " steps are needed"
                        : "the motion is not finite after t = " + shortest_decimal(at));
            return;
        }
        translate_free(piece, t);
        if (settings_.tolerance < least_tolerance) {
            rows_[t.row].status = Status::tolerance_not_met;
            rows_[t.row].message = "a tolerance below 1e-15 is less than binary64 can meet";
        }
    }

    void fail(Traveller& t, Status status, double at, std::string message) {
        t.running = false;
        end(t, at);
        rows_[t.row].status = status, rows_[t.row].message = std::move(message);
    }

    void end(const Traveller& t, double at) {
        Sample& s = rows_[t.row].end;
        const bool turned = !(t.frame.q_BP == Quaternion<double>{});
        rows_[t.row].moved = true;
        s.t = at;
        s.q = turned ? t.q * conjugate(t.frame.q_BP) : t.q;
        s.angular_velocity_B = turned ? rotate(t.frame.q_BP, t.w) : t.w;
        s.position_W = t.p, s.velocity_W = t.v;
        if (t.body.pivoted) pivoted_center(s.q, s.angular_velocity_B, t.body.arm, s.position_W, s.velocity_W);
    }

    const Scene& scene_;
    const Plan& plan_;
    const EnsembleSettings& settings_;
    std::span<const EnsembleBody> bodies_;
    std::span<EnsembleRow> rows_;
    std::vector<Traveller> travellers_;
    std::vector<FreeOctet> octets_;
    struct Queue {
        std::vector<LoadedLane> lanes;
        std::vector<Traveller*> travellers;
    };
    std::array<Queue, 4> queues_;
};

}  // namespace

void solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies, const EnsembleSettings& settings,
                    std::span<EnsembleRow> rows) {
    if (!(settings.tolerance > 0) || !std::isfinite(settings.tolerance))
        throw std::invalid_argument("an ensemble's tolerance is finite and > 0");
    if (settings.threads < 1 || settings.max_steps < 1 || !(settings.seconds_limit > 0))
        throw std::invalid_argument("an ensemble has at least one thread, one step and some time");
    if (settings.instructions > widest_instruction_set())
        throw std::invalid_argument("this processor has no such instructions");
    if (is_mechanism(scene)) throw std::invalid_argument("an ensemble of bodies is of a scene of one body");
    if (rows.size() != bodies.size()) throw std::invalid_argument("an ensemble has as many rows as bodies");
    validate(scene, scene.name);
    const Plan plan = plan_of(scene);
    // bodies that are posed one by one take long: fewer a block, so that all threads have some
    const std::size_t size = plan.one_by_one ? 8 : block_size, blocks = (bodies.size() + size - 1) / size;
    parallel_for(blocks, settings.threads, [&](std::size_t i) {
        const std::size_t first = i * size, count = std::min(size, bodies.size() - first);
        Block(scene, plan, settings, bodies.subspan(first, count), rows.subspan(first, count)).solve();
    });
}

std::vector<EnsembleRow> solve_ensemble(const Scene& scene, std::span<const EnsembleBody> bodies,
                                        const EnsembleSettings& settings) {
    std::vector<EnsembleRow> rows(bodies.size());
    solve_ensemble(scene, bodies, settings, rows);
    return rows;
}

}  // namespace polhode
