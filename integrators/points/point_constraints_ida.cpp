// Bodies made of points at fixed distances: a differential-algebraic system for IDA, in the stabilised form of index
// 2 (C. W. Gear, B. Leimkuhler & G. K. Gupta 1985, J. Comput. Appl. Math. 12-13, 77-90):
//   r' = v - G^T mu,   v' = a(t, r, v) - G^T lambda,   0 = g(r),   0 = G(r) v
// with g = (|d|^2 - l^2) / (2 l) for every link, sum c_i r_i for a pivot, and G = dg/dr. Masses are equal, so lambda
// is a force divided by a point's mass (m/s^2). mu (m/s) vanishes except for integration errors. ConstraintSession
// drives IDA.
#include <ida/ida.h>
#include <ida/ida_ls.h>

#include "integrators/points/point_runs.h"
#include "integrators/points/point_session.h"
#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/ida_counts.h"
#include "integrators/sundials/sundials_run.h"

namespace polhode {
namespace {

using ConstraintMatrix = Eigen::MatrixXd;
using ConstraintVector = Eigen::VectorXd;
using ConstConstraintMap = Eigen::Map<const ConstraintVector>;
using ConstraintMap = Eigen::Map<ConstraintVector>;

class Constraints {
  public:
    explicit Constraints(const PointBody& body) : body_(&body), links_(static_cast<int>(body.links.size())) {}

    int count() const { return links_ + (body_->pivoted ? 3 : 0); }

    /// g(r), m.
    ConstraintVector residual(const double* r) const {
        ConstraintVector g = ConstraintVector::Zero(count());
        for (int e = 0; e < links_; ++e) {
            const PointLink& link = body_->links[e];
            const Vector3<double> d = difference(r, link);
            const double length = std::sqrt(dot(d, d));
            g[e] = (length - link.length) * (length + link.length) / (2 * link.length);
        }
        for (int i = 0; body_->pivoted && i < body_->count(); ++i)
            for (int b = 0; b < 3; ++b) g[links_ + b] += body_->pivot_weights[i] * r[3 * i + b];
        return g;
    }
    /// G(r). The rows of links are linear in r, so that gradient(v) r' = gradient(r) v and d(G v)/dr = gradient(v).
    /// The rows of the pivot are constant, and zero if `pivot` is not set.
    ConstraintMatrix gradient(const double* r, bool pivot = true) const {
        ConstraintMatrix G = ConstraintMatrix::Zero(count(), 3 * body_->count());
        for (int e = 0; e < links_; ++e) {
            const PointLink& link = body_->links[e];
            const Vector3<double> d = difference(r, link);
            for (int b = 0; b < 3; ++b) {
                G(e, 3 * link.i + b) = d[b] / link.length;
                G(e, 3 * link.j + b) = -d[b] / link.length;
            }
        }
        for (int i = 0; pivot && body_->pivoted && i < body_->count(); ++i)
            for (int b = 0; b < 3; ++b) G(links_ + b, 3 * i + b) = body_->pivot_weights[i];
        return G;
    }
    /// Adds d(G^T x)/dr to a 3N x 3N block.
    template <class Block>
    void add_curvature(const double* x, Block&& block) const {
        for (int e = 0; e < links_; ++e) {
            const PointLink& link = body_->links[e];
            const double value = x[e] / link.length;
            for (int b = 0; b < 3; ++b) {
                block(3 * link.i + b, 3 * link.i + b) += value;
                block(3 * link.j + b, 3 * link.j + b) += value;
                block(3 * link.i + b, 3 * link.j + b) -= value;
                block(3 * link.j + b, 3 * link.i + b) -= value;
            }
        }
    }

  private:
    static Vector3<double> difference(const double* r, const PointLink& link) {
        return vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j);
    }
    const PointBody* body_;
    int links_;
};

class ConstraintSession : public PointSession {
  public:
    ConstraintSession(const Problem& problem, const PointBody& body, double tolerance)
        : PointSession(problem, body, tolerance, 2 * Constraints(body).count()),
          constraints_(body),
          m_(constraints_.count()),
          state_rate_(make_owner(N_VNew_Serial(dimension_, context_))),
          variable_ids_(make_owner(N_VNew_Serial(dimension_, context_))),
          matrix_(make_owner(SUNDenseMatrix(dimension_, dimension_, context_))),
          linear_(make_owner(SUNLinSol_Dense(state_.get(), matrix_.get(), context_))),
          memory_(IDACreate(context_)) {
        if (!memory_) throw std::bad_alloc();
        void* memory = memory_.get();
        PointSession* base = this;
        N_VConst(0, state_rate_.get());
        // The differential variables determine the multipliers, which are excluded from the error test.
        N_VConst(1, variable_ids_.get());
        double* ids = N_VGetArrayPointer(variable_ids_.get());
        std::fill(ids + 2 * n_, ids + dimension_, 0.0);
        double* absolute = N_VGetArrayPointer(absolute_.get());
        std::fill(absolute + 2 * n_, absolute + 2 * n_ + m_, multiplier_tolerance * body.extent * rate_ * rate_);
        std::fill(absolute + 2 * n_ + m_, absolute + dimension_, multiplier_tolerance * body.extent * rate_);
        check_flag(IDASetErrHandlerFn(memory, store_message, base));
        check_flag(IDAInit(memory, residual, 0, state_.get(), state_rate_.get()));
        check_flag(IDASVtolerances(memory, 0, absolute_.get()));
        check_flag(IDASetUserData(memory, base));
        check_flag(IDASetId(memory, variable_ids_.get()));
        check_flag(IDASetSuppressAlg(memory, SUNTRUE));
        check_flag(IDASetLinearSolver(memory, linear_.get(), matrix_.get()));
        check_flag(IDASetJacFn(memory, fill_jacobian));
    }

    void restart() {
        reset_state();
        N_VConst(0, state_rate_.get());
        counts_ = {}, running_ = false;
    }
    int enter(const Segment& segment) {
        collect_counts();
        apply_event(segment);
        if (!(end_ > t_)) return IDA_SUCCESS;
        make_consistent();
        running_ = true;
        if (const int flag = IDAReInit(memory_.get(), t_, state_.get(), state_rate_.get()); flag != IDA_SUCCESS)
            return flag;
        return IDASetStopTime(memory_.get(), end_);
    }
    int step() {
        double reached = t_;
        const int flag = IDASolve(memory_.get(), end_, &reached, state_.get(), state_rate_.get(), IDA_ONE_STEP);
        rethrow();
        if (flag == IDA_ILL_INPUT && end_ - t_ < 1e-13 * std::abs(end_)) {
            take_euler_step();
            ++counts_.steps;
            return IDA_TSTOP_RETURN;
        }
        t_ = flag == IDA_TSTOP_RETURN ? end_ : reached;
        return flag;
    }
    std::optional<Sample> sample_inside(double t) {
        IDAGetDky(memory_.get(), t, 0, interpolated_.get());
        return sample_at(t, N_VGetArrayPointer(interpolated_.get()));
    }
    int inside_flag() const { return IDA_SUCCESS; }
    SolverFailure failure(int flag) {
        const bool out_of_reach = flag == IDA_TOO_MUCH_ACC || flag == IDA_ERR_FAIL || flag == IDA_CONV_FAIL;
        return describe_failure("IDA", out_of_reach ? Status::tolerance_not_met : Status::failed,
                                IDAGetReturnFlagName(flag));
    }
    long steps() {
        collect_counts();
        return counts_.steps;
    }
    SolverCounts counts() {
        collect_counts();
        return {counts_.rejected_steps, counts_.newton_failures, {}};
    }

  private:
    static constexpr double multiplier_tolerance = 1e-3;

    struct FreeMemory {
        void operator()(void* memory) const { IDAFree(&memory); }
    };

    // lambda from d2g/dt2 = 0:  G G^T lambda = G a + dG/dt v;  mu = 0.
    void make_consistent() {
        double *r = y(), *v = r + n_;
        ConstraintVector a = ConstraintVector::Zero(n_);
        motion_.add_loads(t_, r, a.data());
        ++evaluations_;
        const ConstraintMatrix G = constraints_.gradient(r);
        const ConstraintVector right = G * a + constraints_.gradient(v, false) * ConstConstraintMap(v, n_);
        const ConstraintVector lambda = (G * G.transpose()).ldlt().solve(right);
        ConstraintMap(r + 2 * n_, m_) = lambda;
        ConstraintMap(r + 2 * n_ + m_, m_).setZero();
        double* rate = N_VGetArrayPointer(state_rate_.get());
        ConstraintMap(rate, n_) = ConstConstraintMap(v, n_);
        ConstraintMap(rate + n_, n_) = a - G.transpose() * lambda;
        ConstraintMap(rate + 2 * n_, 2 * m_).setZero();
    }

    static int residual(double t, N_Vector state, N_Vector rate, N_Vector result, void* session) {
        ConstraintSession* self = static_cast<ConstraintSession*>(static_cast<PointSession*>(session));
        if (self->has_failed()) return -1;
        const int n = self->n_, m = self->m_;
        const double *y = N_VGetArrayPointer(state), *dy = N_VGetArrayPointer(rate);
        double* F = N_VGetArrayPointer(result);
        ++self->evaluations_;
        ConstraintVector a = ConstraintVector::Zero(n);
        try {
            self->motion_.add_loads(t, y, a.data());
        } catch (...) {  // exceptions must not cross the C library
            self->exception_ = std::current_exception();
            return -1;
        }
        const ConstraintMatrix G = self->constraints_.gradient(y);
        const ConstConstraintMap v(y + n, n), lambda(y + 2 * n, m), mu(y + 2 * n + m, m);
        ConstraintMap(F, n) = ConstConstraintMap(dy, n) - v + G.transpose() * mu;
        ConstraintMap(F + n, n) = ConstConstraintMap(dy + n, n) - a + G.transpose() * lambda;
        ConstraintMap(F + 2 * n, m) = self->constraints_.residual(y);
        ConstraintMap(F + 2 * n + m, m) = G * v;
        return self->check_finite(t, F, self->dimension_);
    }
    // dF/dy + c dF/dy'. The loads' dependence on the state is slow and omitted.
    static int fill_jacobian(double t, double c, N_Vector state, N_Vector, N_Vector, SUNMatrix J, void* session,
                             N_Vector, N_Vector, N_Vector) {
        ConstraintSession* self = static_cast<ConstraintSession*>(static_cast<PointSession*>(session));
        const int n = self->n_, m = self->m_;
        const double* y = N_VGetArrayPointer(state);
        Eigen::Map<ConstraintMatrix> entries(SUNDenseMatrix_Data(J), self->dimension_, self->dimension_);
        entries.setZero();
        const ConstraintMatrix G = self->constraints_.gradient(y);
        entries.topLeftCorner(2 * n, 2 * n).diagonal().setConstant(c);
        entries.block(0, n, n, n).diagonal().setConstant(-1);
        self->constraints_.add_curvature(y + 2 * n + m, entries.block(0, 0, n, n));
        self->constraints_.add_curvature(y + 2 * n, entries.block(n, 0, n, n));
        entries.block(0, 2 * n + m, n, m) = G.transpose();
        entries.block(n, 2 * n, n, m) = G.transpose();
        entries.block(2 * n, 0, m, n) = G;
        entries.block(2 * n + m, 0, m, n) = self->constraints_.gradient(y + n, false);
        entries.block(2 * n + m, n, m, n) = G;
        return self->check_finite(t, entries.data(), self->dimension_ * self->dimension_);
    }
    void collect_counts() {
        if (!running_) return;
        running_ = false;
        counts_.add(memory_.get());
    }

    Constraints constraints_;
    int m_;
    SundialsOwner<N_Vector> state_rate_, variable_ids_;
    SundialsOwner<SUNMatrix> matrix_;
    SundialsOwner<SUNLinearSolver> linear_;
    std::unique_ptr<void, FreeMemory> memory_;
    IdaCounts counts_;
    bool running_ = false;
};

constexpr Method point_constraints_variants[] = {
    {.name = "point_constraints_ida",
     .documentation =
         "A body made of four points (three if it is flat) with its mass, centre of mass and tensor, at fixed "
         "distances: a differential-algebraic system in the stabilised form of index 2, which enforces the distances "
         "and zero rates of change, by IDA's backward differentiation formulas of order 1 to 5. Tolerance R times the "
         "extent of the points, and for velocities also times the scene's largest rate. The multipliers are excluded "
         "from the error test.",
     .source = "C. W. Gear, B. Leimkuhler & G. K. Gupta 1985, J. Comput. Appl. Math. 12-13, 77-90; IDA: Hindmarsh et "
               "al. 2005, ACM Trans. Math. Softw. 31, 363-396",
     .origin = "article: point masses at fixed distances, by constraints",
     .conserves = "distances, to the tolerance",
     .control = Control::tolerance,
     .solve = [](const Problem& p, const Settings& s) { return point_constraints_ida(p, s, {}).trajectory; }},
};

constexpr auto point_constraints_family = apply_defaults(
    {.family = Family::points, .library = sundials_library, .refusal = point_body_refusal}, point_constraints_variants);

}  // namespace

PointRun point_constraints_ida(const Problem& problem, const Settings& settings, const PointOptions&) {
    const PointBody body = point_body(problem, {Arrangement::Kind::simplex});
    if (!body.refusal.empty()) return {unsupported(body.refusal)};
    ConstraintSession session(problem, body, *settings.tolerance);
    PointRun run;
    run.trajectory = run_sundials(problem, settings, session);
    run.largest_stretch = session.largest_stretch();
    return run;
}

extern const std::span<const Method> point_constraints_ida_methods{point_constraints_family};

}  // namespace polhode
