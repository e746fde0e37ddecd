// A ball of mass m, radius r and moment I on a plane with the unit normal n. Between two rows at a distance h in time,
//   J = m (dv - g h),    I dw = -r n x J,
// whatever the engine's steps are. J_n is the impulse of the normal force; its tangential part J_t is that of friction.
// The slip is u = v_t - r w x n. While the ball slides, J_t = -mu J_n u/|u|. While it rolls on a slope,
// dv = g_t h / (1 + I/(m r^2)).

#include "check/contact_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "motion/contact.h"
#include "motion/exact_body.h"
#include "scene/plane_file.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;

constexpr std::size_t least_pairs = 6;         // pairs of rows that a diagnosis needs
constexpr double hollow_ratio = 2.0 / 3;       // I / (m r^2) of a thin hollow ball
constexpr double least_share = 0.02;           // smallest relative error that is reported as a fault
constexpr double least_rolling_share = 0.005;  // for the acceleration of rolling

// A ball and the constant acceleration of gravity.
struct Ball {
    double mass = 1, radius = 1, moment = 1;  // kg, m, kg m^2
    Vector gravity_W;                         // m/s^2

    double inertia_ratio() const { return moment / (mass * radius * radius); }
};

// Returns the ball if the scene has one, its contacts depend on its centre only, and only gravity acts.
std::optional<Ball> ball_of(const Scene& scene, const ContactGeometry<double>& geometry) {
    if (geometry.pieces.empty() || geometry.pieces.front().extended) return {};
    const double radius = geometry.pieces.front().radius;
    // further pieces must lie inside the first one
    for (const SupportPiece<double>& piece : geometry.pieces)
        if (!(piece.reach() <= radius * (1 + 1e-12))) return {};
    const Matrix3<double>& I = scene.body.inertia_B;
    const double moment = I[0][0];
    if (!(radius > 0) || length(geometry.pieces.front().center) > 1e-9 * radius) return {};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (std::abs(I[i][j] - (i == j ? moment : 0)) > 1e-9 * moment) return {};
    Ball ball{scene.body.mass, radius, moment, {}};
    for (const Load& load : scene.loads) {
        const auto* g = std::get_if<Gravity>(&load);
        if (!g || g->window.from > 0 || std::isfinite(g->window.until)) return {};
        ball.gravity_W = ball.gravity_W + g->acceleration_W;
    }
    return ball;
}

// What happens at the contact between two rows.
struct Pair {
    double t = 0, h = 0;         // time of the first row and distance in time, s
    Vector slip, next_slip;      // u in both rows, m/s
    Vector velocity, next;       // tangential velocity of the centre in both rows, m/s
    double normal = 0;           // J_n, N s
    Vector friction;             // J_t, N s
    Vector turn;                 // tangential part of dw, rad/s
    double spin = 0, twist = 0;  // w.n in the first row, and its change, rad/s
    bool rests = false;          // nothing moves in the second row
};

class BallRows {
  public:
    BallRows(const Ball& ball, const ContactPlane<double>& plane, const TrajectoryFile& file)
        : ball_(ball), n_(plane.normal_W) {
        for (std::size_t k = 0; k + 1 < file.rows.size(); ++k)
            if (is_on(plane, file.rows[k], file.rows[k + 1].t - file.rows[k].t) &&
                is_on(plane, file.rows[k + 1], file.rows[k + 1].t - file.rows[k].t))
                add(file.rows[k], file.rows[k + 1]);
    }
    const std::vector<Pair>& pairs() const { return pairs_; }
    double pressing() const { return -dot(ball_.gravity_W, n_); }  // m/s^2
    Vector tangential(const Vector& v) const { return v - dot(v, n_) * n_; }

  private:
    Ball ball_;
    Vector n_;
    std::vector<Pair> pairs_;

    Vector slip(const TrajectoryRow& row) const {
        return tangential(row.velocity_W) - ball_.radius * cross(row.angular_velocity_W, n_);
    }
    bool is_on(const ContactPlane<double>& plane, const TrajectoryRow& row, double h) const {
        const double gap = dot(n_, row.position_W) - ball_.radius - plane.offset;
        return std::abs(gap) < 0.02 * ball_.radius && std::abs(dot(n_, row.velocity_W)) < 1.01 * pressing() * h;
    }
    void add(const TrajectoryRow& a, const TrajectoryRow& b) {
        Pair p;
        p.t = a.t, p.h = b.t - a.t;
        const Vector J = ball_.mass * (b.velocity_W - a.velocity_W - p.h * ball_.gravity_W);
        p.normal = dot(J, n_);
        const double expected = ball_.mass * pressing() * p.h;
        if (!(std::abs(p.normal - expected) < 0.1 * expected)) return;
        p.friction = tangential(J);
        p.slip = slip(a), p.next_slip = slip(b);
        p.velocity = tangential(a.velocity_W), p.next = tangential(b.velocity_W);
        const Vector dw = b.angular_velocity_W - a.angular_velocity_W;
        p.turn = tangential(dw);
        p.spin = dot(a.angular_velocity_W, n_), p.twist = dot(dw, n_);
        p.rests = length(b.velocity_W) == 0 && length(b.angular_velocity_W) == 0;
        pairs_.push_back(p);
    }
};

double median_of(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

Diagnosis diagnosis(const char* fault, const std::string& message, double error) {
    return {fault, message, "", error, 0};
}

// Tests the friction of one plane. Diagnoses are added to `found`.
class FrictionTest {
  public:
    FrictionTest(const Ball& ball, const ContactPlane<double>& plane, std::string name, const TrajectoryFile& file)
        : ball_(ball), mu_(plane.friction), name_(std::move(name)), rows_(ball, plane, file) {}

    std::vector<Diagnosis> run() {
        if (rows_.pairs().size() < least_pairs || !(rows_.pressing() > 0)) return {};
        const bool wrong_friction = test_sliding();
        if (!wrong_friction) test_rolling();
        test_spin();
        return std::move(found_);
    }

  private:
    Ball ball_;
    double mu_;
    std::string name_;
    BallRows rows_;
    std::vector<Diagnosis> found_;

    // Pairs in which the scene's ball slides all the time: the slip exceeds what friction removes within the rows.
    std::vector<Pair> sliding() const {
        std::vector<Pair> all;
        for (const Pair& p : rows_.pairs()) {
            const double most = mu_ * rows_.pressing() * p.h * (1 + 1 / ball_.inertia_ratio());
            // with a larger coefficient the slip may end in the second row; skip the last pair of each slip
            if (length(p.slip) > 3 * most + 1e-9 && length(p.next_slip) > 1e-3 * length(p.slip)) all.push_back(p);
        }
        return all;
    }
    bool test_sliding() {
        const std::vector<Pair> all = sliding();
        if (all.size() < least_pairs || !(mu_ > 0)) return false;
        std::vector<double> ratios, angles, turns;
        for (const Pair& p : all) {
            const double friction = length(p.friction);
            ratios.push_back(friction / p.normal);
            const Vector mean = p.slip + p.next_slip;
            if (friction > 1e-3 * mu_ * p.normal) {
                angles.push_back(length(cross(p.friction, mean)) / (friction * length(mean)));
                turns.push_back(ball_.moment * length(p.turn) / (ball_.radius * friction));
            }
        }
        const double ratio = median_of(ratios);
        if (ratio < 1e-3 * mu_) {
            found_.push_back(diagnosis(
                "friction_missing",
                fmt::format("no friction acts while the ball slides on {} ({} pairs of rows), but its coefficient is "
                            "{:.4g}; give the engine's contact this coefficient",
                            name_, all.size(), mu_),
                1));
            return true;
        }
        bool wrong = test_turns(turns);
        // a pyramid differs from the cone until the slip along one of its axes has ended
        std::ranges::sort(angles);
        const double angle = angles[angles.size() - 1 - angles.size() / 10];
        if (angle > least_share) {
            found_.push_back(diagnosis(
                "friction_pyramid",
                fmt::format("friction on {} acts {:.2g} rad away from the direction against the slip, as of a pyramid "
                            "in place of the cone; use an elliptic or circular friction cone",
                            name_, std::asin(std::min(1.0, angle))),
                angle));
            return true;
        }
        if (std::abs(ratio / mu_ - 1) > least_share) {
            found_.push_back(diagnosis(
                "friction_scaled",
                fmt::format("friction on {} is {:.4g} of the normal force while the ball slides (median of {} pairs of "
                            "rows), but its coefficient is {:.4g}; check how the engine combines the coefficients of "
                            "two bodies",
                            name_, ratio, all.size(), mu_),
                std::abs(ratio / mu_ - 1)));
            wrong = true;
        }
        return wrong;
    }
    // `turns`: I dw / (r J_t), which is 1
    bool test_turns(const std::vector<double>& turns) {
        const double turn = median_of(turns);
        if (turn < 0.01) {
            found_.push_back(
                diagnosis("friction_at_center",
                          fmt::format("friction on {} changes the velocity, but not the angular velocity: it acts at "
                                      "the centre of mass; apply it at the contact point",
                                      name_),
                          1));
            return true;
        }
        if (std::abs(turn - 1) < least_share) return false;
        if (std::abs(turn * hollow_ratio / ball_.inertia_ratio() - 1) < least_share) {
            add_hollow("friction changes the angular velocity");
            return true;
        }
        return false;
    }
    void add_hollow(const std::string& evidence) {
        found_.push_back(diagnosis(
            "hollow_inertia",
            fmt::format("{} on {} as that of a hollow ball with I = 2/3 m r^2, but the scene's ball has {:.3g} m r^2; "
                        "give the engine the scene's inertia",
                        evidence, name_, ball_.inertia_ratio()),
            std::abs(hollow_ratio / ball_.inertia_ratio() - 1)));
    }

    // Whether the scene's ball rolls on this plane once it has no slip: the friction that it needs is available.
    bool may_roll() const {
        const Vector g = rows_.tangential(ball_.gravity_W);
        const double needed = length(g) * ball_.inertia_ratio() / (1 + ball_.inertia_ratio());
        return needed < 0.98 * mu_ * rows_.pressing();
    }
    void test_rolling() {
        if (!may_roll() || test_sleep()) return;
        std::vector<double> slips, gains, speeds;
        const Vector g = rows_.tangential(ball_.gravity_W);
        const double slope = length(g);
        double from = 0, until = 0;
        for (const Pair& p : rows_.pairs()) {
            // neither sliding with Coulomb's force nor at the end of it
            const double speed = length(p.velocity);
            if (!(speed > 0) || length(p.slip) > 0.2 * speed || length(p.friction) > 0.9 * mu_ * p.normal) continue;
            if (slips.empty()) from = p.t;
            until = p.t + p.h;
            slips.push_back(length(p.slip) / speed), speeds.push_back(speed);
            const Vector change = p.next - p.velocity;
            gains.push_back(slope > 1e-6 * rows_.pressing() ? dot(change, g) / (slope * slope * p.h)
                                                            : dot(change, p.velocity) / (speed * speed * p.h));
        }
        if (slips.size() < least_pairs) return;
        const double slip = median_of(slips), gain = median_of(gains);
        if (slip > least_share) {
            found_.push_back(diagnosis(
                "rolling_slips",
                fmt::format("the contact point of the rolling ball on {} slips at {:.3g} of its speed (median of {} "
                            "pairs of rows), although friction suffices to stop it; enforce zero slip up to the limit "
                            "of the cone",
                            name_, slip, slips.size()),
                slip));
            return;
        }
        if (slope > 1e-6 * rows_.pressing())
            test_acceleration(gain, slips.size());
        else if (-gain * (until - from) > least_rolling_share)
            found_.push_back(diagnosis(
                "rolling_slowed",
                fmt::format("the ball that rolls on {} loses {:.3g} of its speed per second on level ground, but the "
                            "scene has no rolling friction; remove rolling friction and damping from the engine",
                            name_, -gain),
                -gain * (until - from)));
    }
    void test_acceleration(double gain, std::size_t pairs) {
        const double expected = 1 / (1 + ball_.inertia_ratio()), hollow = 1 / (1 + hollow_ratio);
        if (std::abs(gain / expected - 1) < least_rolling_share) return;
        if (std::abs(gain / hollow - 1) < least_rolling_share) return add_hollow("gravity changes the velocity");
        found_.push_back(diagnosis(
            "rolling_slowed",
            fmt::format("the ball rolls down {} with {:.4g} g sin a (median of {} pairs of rows) in place of {:.4g} g "
                        "sin a, {:+.2g} %; check rolling friction, damping and the convergence of the contact solver",
                        name_, gain, pairs, expected, 100 * (gain / expected - 1)),
            std::abs(gain / expected - 1)));
    }
    // A rolling ball has no force that could stop it between two rows.
    bool test_sleep() {
        const Vector g = rows_.tangential(ball_.gravity_W);
        for (const Pair& p : rows_.pairs()) {
            const double removed = (mu_ * rows_.pressing() + length(g)) * p.h;
            if (!p.rests || !(length(p.velocity) > 0) || length(p.slip) > 0.2 * length(p.velocity)) continue;
            if (length(p.velocity) < 1e-12 * removed) continue;
            found_.push_back(diagnosis("rolling_sleeps",
                                       fmt::format("the ball rolls on {} at {:.3g} m/s at t = {:.6g} s and is at rest "
                                                   "in the next row: the engine put it to sleep; disable sleeping",
                                                   name_, length(p.velocity), p.t),
                                       1));
            return true;
        }
        return false;
    }
    void test_spin() {
        std::vector<double> rates;
        double time = 0, largest = 0;
        for (const Pair& p : rows_.pairs()) largest = std::max(largest, std::abs(p.spin));
        if (!(largest > 0)) return;
        for (const Pair& p : rows_.pairs())
            if (std::abs(p.spin) > 0.01 * largest && !p.rests) rates.push_back(p.twist / (p.spin * p.h)), time += p.h;
        if (rates.size() < least_pairs) return;
        const double loss = -median_of(rates) * time;
        if (std::abs(loss) > least_share)
            found_.push_back(diagnosis(
                "spin_friction",
                fmt::format("the spin of the ball about the normal of {} decreases by {:.3g} of its value per second, "
                            "but the plane has no torsional friction; remove torsional friction and damping from the "
                            "engine",
                            name_, -median_of(rates)),
                std::abs(loss)));
    }
};

}  // namespace

std::vector<Diagnosis> contact_faults(const Scene& scene, const TrajectoryFile& file) {
    if (scene.planes.empty() || !scene.body.source || !file.has_velocity || !file.has_angular_velocity ||
        !file.has_position || !file.bodies.empty())
        return {};
    const ContactGeometry<double> geometry = contact_geometry<double>(scene, exact_body<double>(scene).center, {});
    const std::optional<Ball> ball = ball_of(scene, geometry);
    if (!ball) return {};
    std::vector<Diagnosis> all;
    for (std::size_t i = 0; i < geometry.planes.size(); ++i) {
        const Plane& plane = scene.planes[i];
        if (plane.torsional_friction > 0 || plane.rolling_friction > 0) continue;
        const std::vector<Diagnosis> more = FrictionTest(*ball, geometry.planes[i], plane_name(scene, i), file).run();
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

}  // namespace polhode
