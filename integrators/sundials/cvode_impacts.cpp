// CVODE with impacts on planes.
#include "integrators/sundials/cvode_session.h"
#include "integrators/sundials/sundials_run.h"
#include "motion/contact.h"

namespace polhode {
namespace {

/// Adams' formulas on the full motion. Each impact is located within the step in which it occurs. SystemType: a system
/// with 13 state variables.
template <class SystemType>
class ImpactSession : public CvodeSession<SystemType> {
    using Base = CvodeSession<SystemType>;

  public:
    ImpactSession(const Problem& problem, double tolerance)
        : Base(problem, Multistep::adams, Iteration::functional, tolerance),
          plane_count_(static_cast<int>(problem.body.geometry->planes.size())),
          contact_tolerance_(std::max(tolerance, 1e-14) * problem.body.geometry->reach),
          speed_scale_(problem.scales.velocity + problem.body.geometry->reach * problem.scales.angular_velocity) {
        if (plane_count_ == 0) return;
        this->check_flag(CVodeRootInit(this->memory(), plane_count_, compute_distances));
        std::vector<int> falling(plane_count_, -1);
        this->check_flag(CVodeSetRootDirection(this->memory(), falling.data()));
        this->check_flag(CVodeSetNoInactiveRootWarn(this->memory()));
    }

    void restart() {
        Base::restart();
        impact_times_.clear(), failure_message_.clear();
        impact_pending_ = false;
    }
    int enter(const Segment& segment) {
        if (impact_pending_ && !apply_impact()) return impact_failure;
        return Base::enter(segment);
    }

    /// One internal step, cut at the first impact in it. The state is then the one before the impact, and the step can
    /// still be sampled. The next call applies the impact and continues.
    int step() {
        if (impact_pending_) {
            if (!apply_impact()) return impact_failure;
            if (const int flag = this->resume(); flag < 0) return flag;
        }
        const double before = this->time();
        const Placement<double> start = placement_of(this->y());
        const int flag = Base::step();
        if (flag < 0 || plane_count_ == 0) return flag;
        const double reached = this->time();
        const Placement<double> end = placement_of(this->y());
        const auto at = [&](double t) { return placement_of(t < reached ? this->interpolated_state(t) : this->y()); };
        const ContactGeometry<double>& geometry = *this->problem_->body.geometry;
        std::optional<double> impact =
            first_contact(geometry, at, before, reached, 1.5 * std::max(max_point_speed(start), max_point_speed(end)));
        // use the solver's own root if rounding put it just before the gap closes
        if (!impact && flag == CV_ROOT_RETURN && reached > before) impact = reached;
        if (!impact) return flag;
        if (*impact < reached) this->rewind(*impact);
        impact_pending_ = true;
        return CV_SUCCESS;
    }

    SolverFailure failure(int flag) {
        if (flag == impact_failure) return {Status::failed, failure_message_};
        return Base::failure(flag);
    }
    const std::vector<double>& impact_times() const { return impact_times_; }

  private:
    static constexpr int impact_failure = -1000;  // not a flag of CVODE
    static constexpr std::size_t max_impacts = 1'000'000;

    double max_point_speed(const Placement<double>& at) const {
        return length(at.velocity_W) + this->problem_->body.geometry->reach * length(at.angular_velocity_W);
    }

    // returns false if the motion cannot be followed beyond the impact
    bool apply_impact() {
        impact_pending_ = false;
        impact_times_.push_back(this->time());
        const ImpactOutcome outcome = resolve_plane_impacts(*this->problem_, contact_tolerance_, this->y());
        const char* why = nullptr;
        if (!outcome.resolved)
            why = "no impulses were found for simultaneous contacts";
        else if (!outcome.has_impact || outcome.separation <= resting_speed(speed_scale_))
            why = "the body comes to rest on a plane, and resting contact is not supported";
        else if (impact_times_.size() > max_impacts)
            why = "too many impacts";
        if (why)
            failure_message_ = fmt::format("{} impact{} up to t = {:.10g} s: {}", impact_times_.size(),
                                           impact_times_.size() == 1 ? "" : "s", this->time(), why);
        return !why;
    }

    static int compute_distances(double, N_Vector y, double* distance, void* user_data) {
        auto* session = static_cast<ImpactSession*>(static_cast<SundialsSession<SystemType>*>(user_data));
        const Placement<double> at = placement_of(N_VGetArrayPointer(y));
        for (int i = 0; i < session->plane_count_; ++i) {
            distance[i] = session->problem_->body.geometry->distance(static_cast<std::size_t>(i), at);
            if (!std::isfinite(distance[i])) return -1;  // CVODE's root search would not end with a NaN
        }
        return 0;
    }

    int plane_count_;
    double contact_tolerance_;  // m; contacts with smaller gaps close together
    double speed_scale_;
    bool impact_pending_ = false;
    std::vector<double> impact_times_;
    std::string failure_message_;
};

template <class SystemType>
Trajectory run_with_impacts(const Problem& problem, const Settings& settings) {
    ImpactSession<SystemType> session(problem, *settings.tolerance);
    Trajectory trajectory = run_sundials(problem, settings, session);
    trajectory.impact_times = session.impact_times();
    if (const std::size_t n = trajectory.impact_times.size(); n > 0 && trajectory.status == Status::ok) {
        const std::string remark =
            fmt::format("{} impact{}, the last at t = {:.10g} s", n, n == 1 ? "" : "s", trajectory.impact_times.back());
        trajectory.message = trajectory.message.empty() ? remark : remark + "; " + trajectory.message;
    }
    return trajectory;
}

Trajectory solve_impacts(const Problem& problem, const Settings& settings) {
    if (problem.formulation == Formulation::full) return run_with_impacts<FullMotion>(problem, settings);
    return run_with_impacts<LoadedMotion>(problem, settings);
}

constexpr Method cvode_impacts_variants[] = {{
    .name = "cvode_impacts",
    .documentation =
        "CVODE's Adams-Moulton formulas on the full motion, with the impacts on the scene's planes as events. The "
        "distances to the planes are CVODE's root functions. Dips below a plane within one step, which cause no sign "
        "change at its ends, are found in the step's interpolating polynomial. The impact is located to rounding of "
        "this polynomial, the impulse is applied, and the solver is restarted. Contacts with gaps below the tolerance "
        "times the body's size are treated as simultaneous: by Moreau's law without friction, one contact after the "
        "other with friction. A body that comes to rest, or whose impacts accumulate at a time (Zeno), ends as "
        "`failed` with the time and number of the impacts. Without planes it is `cvode_adams` on all 13 variables.",
    .source = "Hindmarsh, Brown, Grant, Lee, Serban, Shumaker & Woodward 2005, ACM Trans. Math. Softw. 31, 363-396; "
              "K. L. Hiebert and L. F. Shampine 1980, Sandia report SAND80-0180 (root finding); J. J. Moreau 1988",
    .conserves = "nothing; at an impact, the invariants of the impulse",
    .control = Control::tolerance,
    .planes = true,
    .solve = solve_impacts,
}};

constexpr auto cvode_impacts_family =
    apply_defaults({.family = Family::multistep, .library = sundials_library}, cvode_impacts_variants);

}  // namespace

extern const std::span<const Method> cvode_impacts_methods{cvode_impacts_family};

}  // namespace polhode
