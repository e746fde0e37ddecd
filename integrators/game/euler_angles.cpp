// Roll phi, pitch theta and yaw psi (sequence z-y-x, as in D. Fleck's slides) as integrated state, with w = (p, q, r)
// in body axes:
//   dphi/dt   = p + (q sin phi + r cos phi) tan theta
//   dtheta/dt = q cos phi - r sin phi
//   dpsi/dt   = (q sin phi + r cos phi) / cos theta
//   I dw/dt   = tau - w x I w
// The closer the motion passes gimbal lock at theta = +-90 deg, the faster roll and yaw change. The angles are not
// wrapped: beyond a right angle the same equations hold. EulerAnglesStepper takes fixed steps, RecordedSession uses
// CVODE; LockRecorder records how a run passes gimbal lock.
#include "integrators/game/euler_angles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "body/orientation.h"
#include "integrators/game/charted_motion.h"
#include "integrators/game/explicit_step.h"
#include "integrators/run/amplification.h"
#include "integrators/sundials/cvode_session.h"
#include "integrators/sundials/sundials_run.h"

namespace polhode {
namespace {

/// Three angles in the order of the state: roll, pitch, yaw.
struct RollPitchYaw {
    static Vector3<double> start(const Quaternion<double>& q) {
        const EulerAngles angles = euler_from_quaternion(EulerSequence::zyx, q);
        return {angles[2], angles[1], angles[0]};
    }
    Quaternion<double> quaternion(const Vector3<double>& c) const {
        return quaternion_from_euler(EulerSequence::zyx, {c[2], c[1], c[0]});
    }
    Vector3<double> rate(const Vector3<double>& c, const Vector3<double>& w) const {
        const double sine = std::sin(c[0]), cosine = std::cos(c[0]);
        const double yaw = (w[1] * sine + w[2] * cosine) / std::cos(c[1]);
        return {w[0] + yaw * std::sin(c[1]), w[1] * cosine - w[2] * sine, yaw};
    }
};
using AngleMotion = ChartedMotion<RollPitchYaw>;
using AngleState = std::array<double, AngleMotion::dimension>;

double pitch(const double* y) { return AngleMotion::coordinates(y)[1]; }

constexpr double lock_distance = 1e-6;  // rad; failures closer to gimbal lock are attributed to it

/// Distance of the pitch from the nearest right angle, rad.
double distance_from_lock(double pitch_angle) { return std::asin(std::min(std::abs(std::cos(pitch_angle)), 1.0)); }

double largest_component(const Vector3<double>& v) {
    return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

/// Records step sizes, angle rates and distances from gimbal lock.
class LockRecorder {
  public:
    LockRecorder(const Problem& problem, LockPassage* passage)
        : passage_(passage), start_time_(problem.scene.duration / 10) {}

    void record_step(double end, double h) {
        if (passage_ && end > start_time_) passage_->smallest_step = std::min(passage_->smallest_step, h);
    }
    void record_angles(double pitch_angle, const Vector3<double>& rate) {
        if (!passage_) return;
        passage_->nearest = std::min(passage_->nearest, distance_from_lock(pitch_angle));
        passage_->largest_angle_rate = std::max(passage_->largest_angle_rate, largest_component(rate));
    }
    bool is_recording() const { return passage_ != nullptr; }

  private:
    LockPassage* passage_;
    double start_time_;
};

/// Explicit Euler steps. A step that would change an angle by more than half a revolution fails and ends the run.
class EulerAnglesStepper {
  public:
    EulerAnglesStepper(const Problem& problem, LockPassage* const& passage)
        : motion_(problem), recorder_(problem, passage) {
        restart();
    }
    void restart() {
        motion_.initial(y_.data());
        steps_ = 0, failed_ = false;
    }
    void enter(const Segment& segment) { motion_.enter(segment, y_.data()); }
    void step(double t, double h) {
        if (failed_) return;
        AngleState rate{};
        motion_.derivative(t, y_.data(), rate.data());
        const Vector3<double> angle_rate = AngleMotion::coordinates(rate.data());
        recorder_.record_angles(pitch(y_.data()), angle_rate);
        ++steps_;
        angle_change_ = h * largest_component(angle_rate);
        if (angle_change_ > std::numbers::pi) {
            failed_ = true, failed_at_ = t;
            return;
        }
        ExplicitEuler::step([&](double, const AngleState&) { return rate; }, t, y_, h);
        recorder_.record_step(t + h, h);
    }
    Sample sample(double t) const { return motion_.motion(t, y_.data()); }
    bool finite() const { return all_finite(y_); }
    long rhs_evaluations() const { return steps_; }

    bool failed() const { return failed_; }
    void explain(Trajectory& trajectory) const {
        trajectory.status = Status::failed;
        trajectory.message = fmt::format(
            "at t = {:g} s an angle would change by {:.3g} rad in one step; the pitch is {:.3g} rad from gimbal lock",
            failed_at_, angle_change_, distance_from_lock(pitch(y_.data())));
    }

  private:
    AngleMotion motion_;
    LockRecorder recorder_;
    AngleState y_{};
    long steps_ = 0;
    bool failed_ = false;
    double failed_at_ = 0, angle_change_ = 0;
};

// Not FixedVector itself, because a session on that would require a Jacobian for Newton's method.
struct AngleVector : FixedVector<AngleMotion::dimension> {};

template <class SystemType, class Vector>
class RecordedSession : public CvodeSession<SystemType, Vector> {
    using Base = CvodeSession<SystemType, Vector>;

  public:
    RecordedSession(const Problem& problem, double tolerance, LockPassage* passage)
        : Base(problem, Multistep::adams, Iteration::functional, tolerance), recorder_(problem, passage) {}

    int step() {
        const double start = this->time();
        const int flag = Base::step();
        if (flag < 0 || !recorder_.is_recording()) return flag;
        if (flag != CV_TSTOP_RETURN) recorder_.record_step(this->time(), this->time() - start);
        if constexpr (std::is_same_v<SystemType, AngleMotion>) {
            const double* y = this->y();
            recorder_.record_angles(pitch(y), this->system_.coordinate_rate(y));
        }
        return flag;
    }

  private:
    LockRecorder recorder_;
};

template <class SystemType, class Vector>
Trajectory solve_recorded(const Problem& problem, const Settings& settings, LockPassage* passage) {
    RecordedSession<SystemType, Vector> session(problem, *settings.tolerance, passage);
    return run_sundials(problem, settings, session);
}

Trajectory euler_angles(const Problem& problem, const Settings& settings) {
    return solve_euler_angles(problem, settings, nullptr);
}
Trajectory euler_angles_cvode(const Problem& problem, const Settings& settings) {
    return solve_euler_angles_cvode(problem, settings, nullptr);
}

constexpr std::string_view euler_angles_source =
    "D. Fleck, Game Physics, part IV: Moving to 3D (slides: roll, pitch, yaw); the rates as in B. Etkin, Dynamics of "
    "Atmospheric Flight, 1972, section 5.2";

constexpr Method euler_angles_variants[] = {
    {.name = "euler_angles",
     .documentation =
         "Roll, pitch and yaw (z-y-x) and w in body axes by explicit Euler steps, I dw/dt = tau - w x Iw. Near "
         "gimbal lock, pitch +-90 degrees, roll and yaw change like 1/cos(pitch). Steps of h normally stay about h "
         "w away from it and pass it with an error of the usual size. A step that would change an angle by more "
         "than half a revolution ends the run as `failed`, with the distance from gimbal lock. Rotation and "
         "translation are both integrated, in body axes. Order 1.",
     .origin = "slides: Euler angles, roll, pitch, yaw",
     .control = Control::fixed_step,
     .order = 1,
     .solve = euler_angles,
     .amplification = explicit_euler_amplification},
    {.name = "euler_angles_cvode",
     .documentation =
         "Roll, pitch and yaw and w in body axes by CVODE's Adams-Moulton formulas, with the settings of "
         "`cvode_adams`. Passing gimbal lock at a distance d requires steps of a hundredth of d / w or less, until "
         "d is below the tolerance. At gimbal lock itself the run stops. Rotation and translation are both "
         "integrated, in body axes.",
     .origin = "slides: Euler angles, by an adaptive solver",
     .control = Control::tolerance,
     .solve = euler_angles_cvode,
     .library = sundials_library},
};

constexpr auto euler_angles_family = apply_defaults({.source = euler_angles_source,
                                                     .conserves = "nothing; |q| = 1 by construction",
                                                     .family = Family::published_update,
                                                     .formulation = Formulation::full},
                                                    euler_angles_variants);

}  // namespace

Trajectory solve_euler_angles(const Problem& problem, const Settings& settings, LockPassage* passage) {
    return march<EulerAnglesStepper>(problem, settings, passage);
}

Trajectory solve_euler_angles_cvode(const Problem& problem, const Settings& settings, LockPassage* passage) {
    LockPassage unused;
    if (!passage) passage = &unused;
    passage->nearest = distance_from_lock(euler_from_quaternion(EulerSequence::zyx, problem.body.q)[1]);
    Trajectory trajectory = solve_recorded<AngleMotion, AngleVector>(problem, settings, passage);
    // CVODE reports only that its steps become too small, not why.
    if (trajectory.status != Status::ok && passage->nearest < lock_distance)
        trajectory.message =
            fmt::format("the pitch came within {:.3g} rad of gimbal lock; {}", passage->nearest, trajectory.message);
    return trajectory;
}

Trajectory solve_quaternion_cvode(const Problem& problem, const Settings& settings, LockPassage* passage) {
    using Vector = FixedVector<FullMotion::dimension>;
    return solve_recorded<FullMotion, Vector>(problem, settings, passage);
}

extern const std::span<const Method> euler_angles_methods{euler_angles_family};

}  // namespace polhode
