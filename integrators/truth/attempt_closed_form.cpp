// The attempt by closed form, for runs so long that a series would take hours. Its cost does not depend on the time.
// The first 100 rad of the motion are compared with a Taylor series, because a wrong formula is wrong from the start.
#include <algorithm>
#include <cmath>
#include <optional>

#include "integrators/closed_form/closed_form.h"
#include "integrators/truth/attempt_taylor.h"

namespace polhode::truth {
namespace {

using P = Real<100>;

bool is_diagonal(const Matrix3<P>& m) {
    return m[0][1] == 0 && m[0][2] == 0 && m[1][0] == 0 && m[1][2] == 0 && m[2][0] == 0 && m[2][1] == 0;
}

// the closed form of a scene with one segment, principal body axes, and a centre of mass at a pivot or in free fall
struct SinglePiece {
    ExactBody<P> body;
    Vector3<P> acceleration_W;
    std::optional<ClosedForm<P>> form;

    explicit SinglePiece(const Scene& scene) : body(exact_body<P>(scene)) {
        if (itinerary(scene).size() != 1 || !impulses_at<P>(scene, body, 0, Quaternion<P>{}).empty()) return;
        if (!is_diagonal(body.inertia_B)) return;
        const Forcing<P> forcing = forcing_at<P>(scene, body, 0, Quaternion<P>{});
        if (!body.pivoted && (forcing.has_body_force || forcing.has_translational_drag)) return;
        acceleration_W = forcing.acceleration_W;
        form = find_form(forcing, body.angular_velocity_B, body.q);
    }
    std::optional<ClosedForm<P>> find_form(const Forcing<P>& forcing, const Vector3<P>& w,
                                           const Quaternion<P>& q) const {
        const Vector3<P> moments(body.inertia_B[0][0], body.inertia_B[1][1], body.inertia_B[2][2]);
        return ClosedForm<P>::find(moments, forcing, w, q, P(0));
    }
    Motion<P> motion(const Rotation<P>& rotation, const P& t) const {
        Motion<P> m;
        m.q = rotation.q, m.angular_velocity_B = rotation.w;
        if (body.pivoted) {
            pivoted_center(m.q, m.angular_velocity_B, body.arm, m.position_W, m.velocity_W);
        } else {
            m.velocity_W = body.velocity_W + t * acceleration_W;
            m.position_W = body.position_W + t * (body.velocity_W + (t / 2) * acceleration_W);
        }
        return m;
    }
};

}  // namespace

MpfrConstants::~MpfrConstants() { mpfr_free_cache(); }

bool has_single_closed_form(const Problem& problem) {
    return std::holds_alternative<OneBody>(problem.system) && problem.segments.size() == 1 &&
           problem.needs.translation != Translation::integrated && !problem.needs.user_torque &&
           SinglePiece(problem.scene).form.has_value();
}

Attempt attempt_by_closed_form(const Problem& problem, const std::vector<double>& sample_times, double local_digits) {
    const SinglePiece piece(problem.scene);
    const Forcing<P> forcing = forcing_at<P>(problem.scene, piece.body, 0, Quaternion<P>{});
    // the second run starts from the end of the first one and goes back: different phases, different rounding errors
    const P end(sample_times.back());
    const Rotation<P> last = piece.form->at(end);
    const std::optional<ClosedForm<P>> reverse = piece.find_form(forcing, last.w, last.q);
    Run<P> first, second;
    for (const double t : sample_times) {
        if (Allowance::is_spent()) {
            Attempt interrupted;
            interrupted.fault = Allowance::fault;
            return interrupted;
        }
        first.motions.push_back(piece.motion(piece.form->at(P(t)), P(t)));
        second.motions.push_back(piece.motion(reverse->at(P(P(t) - end)), P(t)));
    }
    Attempt attempt = compare_runs(problem, sample_times, first, second,
                                   "closed form in 100 digits, forward from the start and backward from the end", 100);
    // compare the start with a series
    Scene start_scene = problem.scene;
    const double rate = std::max(problem.scales.angular_velocity, 1e-300);
    start_scene.duration = std::min(problem.scene.duration, 100 / rate);
    const std::vector<double> start_times = polhode::sample_times(start_scene.duration, 4);
    const Run<P> series =
        taylor<P, EulerForm<P>>(start_scene, start_times, problem.scales, problem.body.principal.moments,
                                {static_cast<int>(std::ceil(1.15 * local_digits)) + 2, local_digits, 1, 400'000});
    if (!series.fault.empty()) {
        attempt.fault = series.fault;
        return attempt;
    }
    Run<P> closed_form_run;
    for (const double t : start_times) closed_form_run.motions.push_back(piece.motion(piece.form->at(P(t)), P(t)));
    const double difference = disagreement(closed_form_run, series);
    if (difference > 0) attempt.agreed_digits = std::min(attempt.agreed_digits, -std::log10(difference));
    attempt.truth.reference.bound = std::max(attempt.truth.reference.bound, difference);
    attempt.truth.reference.message += ", its start checked by Taylor series";
    attempt.truth.steps = series.steps;
    return attempt;
}

Attempt attempt_by_series_and_closed_form(const Problem& problem, const std::vector<double>& sample_times,
                                          double local_digits) {
    const SinglePiece piece(problem.scene);
    const TaylorSettings settings{static_cast<int>(std::ceil(1.3 * local_digits)) + 5, local_digits, 1, 400'000};
    auto closed_form_run = in_thread([&] {
        Run<P> run;
        for (const double t : sample_times) {
            if (Allowance::is_spent()) {
                run.fault = Allowance::fault;
                break;
            }
            run.motions.push_back(piece.motion(piece.form->at(P(t)), P(t)));
        }
        return run;
    });
    const Run<P> series =
        taylor<P, EulerForm<P>>(problem.scene, sample_times, problem.scales, problem.body.principal.moments, settings);
    return compare_runs(
        problem, sample_times, series, closed_form_run.get(),
        fmt::format("Taylor series in 100 digits: {} at order {} in {} steps, and closed form in 100 digits",
                    EulerForm<P>::name, settings.order, series.steps),
        100);
}

}  // namespace polhode::truth
