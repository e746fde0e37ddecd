// Bodies made of points with stiff springs, integrated by CVODE's backward differentiation formulas.
#include "integrators/points/point_runs.h"
#include "integrators/points/point_session.h"
#include "integrators/points/spring_network.h"
#include "integrators/points/stiffness.h"
#include "integrators/sundials/cvode_session.h"
#include "integrators/sundials/sundials_run.h"

namespace polhode {
namespace {

class SpringSession : public PointSession {
  public:
    SpringSession(const Problem& problem, const PointBody& body, const SpringNetwork& network, double tolerance)
        : PointSession(problem, body, tolerance, 0),
          network_(network),
          matrix_(make_owner(SUNDenseMatrix(dimension_, dimension_, context_))),
          linear_(make_owner(SUNLinSol_Dense(state_.get(), matrix_.get(), context_))),
          memory_(CVodeCreate(CV_BDF, context_)) {
        if (!memory_) throw std::bad_alloc();
        void* memory = memory_.get();
        PointSession* base = this;
        check_flag(CVodeSetErrHandlerFn(memory, store_message, base));
        check_flag(CVodeInit(memory, right_hand_side, 0, state_.get()));
        check_flag(CVodeSVtolerances(memory, 0, absolute_.get()));
        check_flag(CVodeSetUserData(memory, base));
        check_flag(CVodeSetMaxHnilWarns(memory, -1));
        check_flag(CVodeSetLinearSolver(memory, linear_.get(), matrix_.get()));
        check_flag(CVodeSetJacFn(memory, fill_jacobian));
        check_flag(CVodeSetStabLimDet(memory, SUNTRUE));
        // Stiff springs turn iteration errors into forces. With CVODE's default of 0.1, a tumbling box on springs of
        // 10^6 N/m has an error of 3e-4 rad at R = 1e-8 after 2572 steps; with this value it has 7e-6 rad after 1078
        // steps.
        check_flag(CVodeSetNonlinConvCoef(memory, 1e-2));
        check_flag(CVodeSetMaxNonlinIters(memory, 6));
    }

    void restart() {
        network_.apply_rotation_stretch(reset_state(), y());
        steps_ = 0, counts_ = {}, running_ = false;
    }
    int enter(const Segment& segment) {
        collect_counts();
        if (const auto w = apply_event(segment)) network_.apply_rotation_stretch(*w, y());
        if (!(end_ > t_)) return CV_SUCCESS;
        running_ = true;
        if (const int flag = CVodeReInit(memory_.get(), t_, state_.get()); flag != CV_SUCCESS) return flag;
        return CVodeSetStopTime(memory_.get(), end_);
    }
    int step() {
        double reached = t_;
        const int flag = CVode(memory_.get(), end_, state_.get(), &reached, CV_ONE_STEP);
        rethrow();
        if (flag == CV_TOO_CLOSE) {
            take_euler_step();
            ++steps_;
            return CV_TSTOP_RETURN;
        }
        t_ = flag == CV_TSTOP_RETURN ? end_ : reached;
        return flag;
    }
    std::optional<Sample> sample_inside(double t) {
        CVodeGetDky(memory_.get(), t, 0, interpolated_.get());
        return sample_at(t, N_VGetArrayPointer(interpolated_.get()));
    }
    int inside_flag() const { return CV_SUCCESS; }
    SolverFailure failure(int flag) {
        const bool out_of_reach = flag == CV_TOO_MUCH_ACC || flag == CV_ERR_FAILURE || flag == CV_CONV_FAILURE;
        return describe_failure("CVODE", out_of_reach ? Status::tolerance_not_met : Status::failed,
                                CVodeGetReturnFlagName(flag));
    }
    long steps() {
        collect_counts();
        return steps_;
    }
    SolverCounts counts() {
        collect_counts();
        return counts_.to_solver_counts(true);
    }

  private:
    struct FreeMemory {
        void operator()(void* memory) const { CVodeFree(&memory); }
    };

    static int right_hand_side(double t, N_Vector state, N_Vector rate, void* session) {
        SpringSession* self = static_cast<SpringSession*>(static_cast<PointSession*>(session));
        if (self->has_failed()) return -1;
        const double* y = N_VGetArrayPointer(state);
        double* dy = N_VGetArrayPointer(rate);
        ++self->evaluations_;
        std::copy(y + self->n_, y + 2 * self->n_, dy);
        self->network_.accelerations(y, dy + self->n_);
        try {
            self->motion_.add_loads(t, y, dy + self->n_);
        } catch (...) {  // exceptions must not cross the C library
            self->exception_ = std::current_exception();
            return -1;
        }
        return self->check_finite(t, dy, self->dimension_);
    }
    // Jacobian of the springs. The loads' dependence on the state is slow and omitted.
    static int fill_jacobian(double t, N_Vector state, N_Vector, SUNMatrix J, void* session, N_Vector, N_Vector,
                             N_Vector) {
        SpringSession* self = static_cast<SpringSession*>(static_cast<PointSession*>(session));
        const int n = self->n_;
        Eigen::Map<Eigen::MatrixXd> entries(SUNDenseMatrix_Data(J), 2 * n, 2 * n);
        entries.setZero();
        entries.topRightCorner(n, n).setIdentity();
        entries.bottomLeftCorner(n, n) = self->network_.jacobian(N_VGetArrayPointer(state));
        if (self->network_.is_damped())
            entries.bottomRightCorner(n, n) = self->network_.velocity_jacobian(N_VGetArrayPointer(state));
        return self->check_finite(t, entries.data(), 4 * n * n);
    }
    void collect_counts() {
        if (!running_) return;
        running_ = false;
        long steps = 0;
        CVodeGetNumSteps(memory_.get(), &steps);
        steps_ += steps;
        counts_.add(memory_.get());
    }

    SpringNetwork network_;
    SundialsOwner<SUNMatrix> matrix_;
    SundialsOwner<SUNLinearSolver> linear_;
    std::unique_ptr<void, FreeMemory> memory_;
    long steps_ = 0;
    CvodeCounts counts_;
    bool running_ = false;
};

constexpr Method point_springs_cvode_variants[] = {
    {.name = "point_springs_cvode_bdf",
     .documentation =
         "The points and springs of `point_springs_rk4` by CVODE's backward differentiation formulas, with the exact "
         "Jacobian and a dense LU factorisation. Dampers along the springs, critical for the slowest vibration, allow "
         "steps longer than the vibrations. Undamped vibrations would hold the higher orders to steps as short as "
         "those of an explicit scheme. Tolerance R times the extent of the points, and for velocities also times the "
         "scene's largest rate.",
     .source = "Hindmarsh et al. 2005, SUNDIALS, ACM Trans. Math. Softw. 31, 363-396; the body as in the article on "
               "rotational dynamics",
     .origin = "article: point masses at fixed distances, by stiff springs",
     .conserves = "nothing",
     .control = Control::tolerance,
     .solve = [](const Problem& p, const Settings& s) { return point_springs_cvode_bdf(p, s, {}).trajectory; }},
};

constexpr auto point_springs_cvode_family =
    apply_defaults({.family = Family::points, .library = sundials_library, .refusal = point_body_refusal},
                   point_springs_cvode_variants);

}  // namespace

PointRun point_springs_cvode_bdf(const Problem& problem, const Settings& settings, const PointOptions& options) {
    const PointBody body = point_body(problem, options.arrangement);
    if (!body.refusal.empty()) return {unsupported(body.refusal)};
    const double stiffness = options.stiffness ? *options.stiffness : default_stiffness(problem, body);
    const double damping = damping_from_ratio(body, stiffness, options.damping_ratio.value_or(1));
    SpringSession session(problem, body, SpringNetwork(body, stiffness, damping), *settings.tolerance);
    PointRun run;
    run.trajectory = run_sundials(problem, settings, session);
    run.largest_stretch = session.largest_stretch();
    return run;
}

extern const std::span<const Method> point_springs_cvode_methods{point_springs_cvode_family};

}  // namespace polhode
