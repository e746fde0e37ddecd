// CVODES for one posed problem together with the derivative of its motion with respect to the initial state.
//
// SensitivitySession extends CvodeSession by one column per direction of the initial state in minimal coordinates
// (attitude as a rotation vector, w, p, v). Rates come from dual numbers, or from central differences for a
// user-defined torque. The staggered method solves the columns after the state; both are under error control (Hindmarsh
// et al. 2005; Feehery, Tolsma & Barton 1997).
#pragma once

#include <cvodes/cvodes.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>

#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/cvode_session.h"
#include "motion/dual.h"

namespace polhode {

/// d state(t) / d state(0) in minimal coordinates, each block in units of its scale: attitude (rotation vector, posed
/// axes), w, and p, v if the system has them.
template <class SystemType>
using Sensitivity = Eigen::Matrix<double, SystemType::dimension - 1, SystemType::dimension - 1>;

/// SystemType: a system with w and q, with or without p and v. Sensitivities are under error control like the state.
template <class SystemType>
class SensitivitySession : public CvodeSession<SystemType> {
    using Base = CvodeSession<SystemType>;
    using CallbackBase = SundialsSession<SystemType>;  // base type of the callbacks' user data
    using Base::check_flag, Base::memory;
    using Base::context_, Base::end_, Base::state_, Base::system_, Base::t_;
    using Vector = FixedVector<SystemType::dimension>;

  public:
    using Base::dimension, Base::y;
    static constexpr int directions = dimension - 1;

    /// R is the relative tolerance of the state and of every column of its derivative, relative to max(1, size of the
    /// column). The problem must outlive the session.
    SensitivitySession(const Problem& problem, Multistep multistep, Iteration iteration, double tolerance)
        : Base(problem, multistep, iteration, tolerance) {
        system_.scales(scale_.data());
        columns_.reset(N_VCloneVectorArray(directions, state_.get()));
        interpolated_columns_.reset(N_VCloneVectorArray(directions, state_.get()));
        if (!columns_ || !interpolated_columns_) throw std::bad_alloc();
        init_columns();
        check_flag(CVodeSetStabLimDet(memory(), SUNFALSE));
        check_flag(CVodeWFtolerances(memory(), compute_weights));
        check_flag(CVodeSensInit(memory(), directions, CV_STAGGERED, sensitivity_rates, columns_.get()));
        // each column uses the weights of the state, from compute_weights()
        check_flag(CVodeSensEEtolerances(memory()));
        check_flag(CVodeSetSensErrCon(memory(), SUNTRUE));
        if (iteration == Iteration::functional) {
            nonlinear_columns_ = make_owner(SUNNonlinSol_FixedPointSens(directions, state_.get(), 0, context_));
            check_flag(CVodeSetSensMaxNonlinIters(memory(), Base::functional_iterations));
        } else {
            nonlinear_columns_ = make_owner(SUNNonlinSol_NewtonSens(directions, state_.get(), context_));
        }
        check_flag(CVodeSetNonlinearSolverSensStg(memory(), nonlinear_columns_.get()));
    }

    /// Processes an event: impulses with their derivative, then the loads of this segment.
    int enter(const Segment& segment) {
        for (const PosedImpulse<double>& impulse : segment.impulses) apply_impulse(impulse);
        if (const int flag = Base::enter(segment); flag != CV_SUCCESS || !(end_ > t_)) return flag;
        return CVodeSensReInit(memory(), CV_STAGGERED, columns_.get());
    }

    /// One internal step, cut at the segment's end. Returns CVODES' flag.
    int step() {
        const int flag = Base::step();
        // no step is taken in a segment as short as a rounding error, where the derivative does not change
        long taken = 0;
        CVodeGetNumSteps(memory(), &taken);
        double at = 0;
        if (flag >= 0 && taken > 0) CVodeGetSens(memory(), &at, columns_.get());
        return flag;
    }

    /// The derivative at time(), or at a time within the last step.
    Sensitivity<SystemType> sensitivity() { return to_minimal_coordinates(y(), columns_.get()); }
    Sensitivity<SystemType> sensitivity_inside(double t) {
        CVodeGetSensDky(memory(), t, 0, interpolated_columns_.get());
        return to_minimal_coordinates(this->interpolated_state(t), interpolated_columns_.get());
    }

    /// Meaning of a flag below zero.
    SolverFailure failure(int flag) {
        return Base::describe_failure("CVODES", Status::tolerance_not_met, CVodeGetReturnFlagName(flag));
    }

  private:
    struct FreeColumns {
        void operator()(N_Vector* columns) const { N_VDestroyVectorArray(columns, directions); }
    };
    using Tangent = Dual<directions>;

    // Index in y of direction i >= 3. In y, w precedes q; here w follows the rotation vector.
    static constexpr int component_of(int i) { return i < 3 + SystemType::rates ? i - 3 : i + 1; }

    // the derivative at t = 0, by columns: dq = 1/2 q (0, e_i), then each scale along its own axis
    void init_columns() {
        this->reset_state();
        const Quaternion<double> q = SystemType::attitude(y());
        for (int j = 0; j < directions; ++j) {
            double* column = Vector::data(columns_.get()[j]);
            std::fill(column, column + dimension, 0.0);
            if (j < 3) {
                Vector3<double> turn;
                turn[j] = 1;
                SystemType::set_rotation(column, Vector3<double>(), attitude_rate(0.5, q, turn));
            } else {
                const int i = component_of(j);
                column[i] = scale_[i];
            }
        }
    }

    Sensitivity<SystemType> to_minimal_coordinates(const double* state, N_Vector* columns) const {
        const Quaternion<double> q = SystemType::attitude(state);
        const double twice = 2 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        Sensitivity<SystemType> S;
        for (int j = 0; j < directions; ++j) {
            const double* column = Vector::data(columns[j]);
            const Quaternion<double> turn = conjugate(q) * SystemType::attitude(column);
            S(0, j) = twice * turn.x, S(1, j) = twice * turn.y, S(2, j) = twice * turn.z;
            for (int i = 3; i < directions; ++i) {
                const int from = component_of(i);
                S(i, j) = column[from] / scale_[from];
            }
        }
        return S;
    }

    std::array<Tangent, dimension> tangents(const double* state, N_Vector* columns) const {
        std::array<Tangent, dimension> moved;
        for (int i = 0; i < dimension; ++i) moved[i].value = state[i];
        for (int j = 0; j < directions; ++j) {
            const double* column = Vector::data(columns[j]);
            for (int i = 0; i < dimension; ++i) moved[i].slope[j] = column[i];
        }
        return moved;
    }

    // applies the derivative of apply(), which changes w and v
    void apply_impulse(const PosedImpulse<double>& impulse) {
        const std::array<Tangent, dimension> state = tangents(y(), columns_.get());
        Vector3<Tangent> w = SystemType::angular_velocity(state.data()), p, v;
        const Quaternion<Tangent> q = SystemType::attitude(state.data());
        if constexpr (SystemType::has_translation)
            p = SystemType::position(state.data()), v = SystemType::velocity(state.data());
        const Problem& problem = *this->problem_;
        const PrincipalInertia<Tangent> inertia{cast<Tangent>(problem.body.principal_inertia.gyroscopic),
                                                cast<Tangent>(problem.body.principal_inertia.inverse_moments), false};
        apply<Tangent>(
            {cast<Tangent>(impulse.vector), impulse.frame, cast<Tangent>(impulse.point), impulse.point_frame}, inertia,
            Tangent(problem.body.mass), problem.body.pivoted, w, q, p, v);
        for (int j = 0; j < directions; ++j) {
            double* column = Vector::data(columns_.get()[j]);
            const auto slope = [j](const Vector3<Tangent>& x) {
                return Vector3<double>(x[0].slope[j], x[1].slope[j], x[2].slope[j]);
            };
            SystemType::set_rotation(column, slope(w), SystemType::attitude(column));
            if constexpr (SystemType::has_translation)
                SystemType::set_translation(column, SystemType::position(column), slope(v));
        }
    }

    // Weights of the state or of a column of its derivative: the tolerated error of a component is its scale, times the
    // length of the whole if that exceeds 1, times R. A growing column is thus controlled relative to its size, and
    // components near zero are not over-resolved.
    static int compute_weights(N_Vector vector, N_Vector weight, void* session) {
        const SensitivitySession* self = static_cast<SensitivitySession*>(static_cast<CallbackBase*>(session));
        const double* value = Vector::data(vector);
        double squares = 0;
        for (int i = 0; i < dimension; ++i) squares += (value[i] / self->scale_[i]) * (value[i] / self->scale_[i]);
        const double allowed = self->tolerance_ * std::sqrt(std::max(1.0, squares));
        if (!std::isfinite(allowed)) return -1;
        for (int i = 0; i < dimension; ++i) Vector::data(weight)[i] = 1 / (allowed * self->scale_[i]);
        return 0;
    }

    static int sensitivity_rates(int, double t, N_Vector y, N_Vector, N_Vector* columns, N_Vector* rates, void* session,
                                 N_Vector, N_Vector) {
        SensitivitySession* self = static_cast<SensitivitySession*>(static_cast<CallbackBase*>(session));
        if (self->exception_) return -1;
        if (self->problem_->needs.user_torque)
            return self->compute_difference_rates(t, Vector::data(y), columns, rates);
        const std::array<Tangent, dimension> state = self->tangents(Vector::data(y), columns);
        std::array<Tangent, dimension> rate;
        self->system_.derivative(t, state.data(), rate.data());
        for (int j = 0; j < directions; ++j)
            for (int i = 0; i < dimension; ++i) Vector::data(rates[j])[i] = rate[i].slope[j];
        return 0;
    }

    // df/dy s by central differences, for torques that do not accept dual numbers: moves y by e s of length 1e-5
    int compute_difference_rates(double t, const double* state, N_Vector* columns, N_Vector* rates) {
        constexpr double size = 1e-5;
        for (int j = 0; j < directions; ++j) {
            const double* column = Vector::data(columns[j]);
            double squares = 0;
            for (int i = 0; i < dimension; ++i) squares += (column[i] / scale_[i]) * (column[i] / scale_[i]);
            const double e = squares > 0 ? size / std::sqrt(squares) : size;
            double moved[dimension], above[dimension], below[dimension];
            try {
                for (int i = 0; i < dimension; ++i) moved[i] = state[i] + e * column[i];
                system_.derivative(t, moved, above);
                for (int i = 0; i < dimension; ++i) moved[i] = state[i] - e * column[i];
                system_.derivative(t, moved, below);
            } catch (...) {  // must not propagate through C code
                this->exception_ = std::current_exception();
                return -1;
            }
            for (int i = 0; i < dimension; ++i) Vector::data(rates[j])[i] = (above[i] - below[i]) / (2 * e);
        }
        return 0;
    }

    std::array<double, dimension> scale_{};
    std::unique_ptr<N_Vector, FreeColumns> columns_, interpolated_columns_;
    SundialsOwner<SUNNonlinearSolver> nonlinear_columns_;
};

}  // namespace polhode
