// A SUNDIALS matrix and direct linear solver of a size known at compile time, on Eigen's fixed-size LU factorisation
// with partial pivoting. They go with FixedVector.
#pragma once

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <Eigen/Dense>
#include <cmath>
#include <new>

#include "integrators/sundials/fixed_vector.h"

namespace polhode {

template <int N>
class FixedMatrix {
  public:
    using Entries = Eigen::Matrix<double, N, N, Eigen::RowMajor>;

    /// A matrix of zeros, to be freed by SUNMatDestroy; nullptr where there is no memory.
    static SUNMatrix make(SUNContext context) {
        Storage* m = new (std::nothrow) Storage;
        if (!m) return nullptr;
        m->content = &m->value, m->ops = &operations(), m->sunctx = context;
        return m;
    }

    static Entries& entries(SUNMatrix m) { return static_cast<Storage*>(m)->value; }

  private:
    struct Storage : _generic_SUNMatrix {
        Storage() : _generic_SUNMatrix{}, value(Entries::Zero()) {}
        Entries value;
    };

    static SUNMatrix_ID id(SUNMatrix) { return SUNMATRIX_CUSTOM; }
    static SUNMatrix clone(SUNMatrix m) { return make(m->sunctx); }
    static void destroy(SUNMatrix m) { delete static_cast<Storage*>(m); }
    static int zero(SUNMatrix m) {
        entries(m).setZero();
        return SUNMAT_SUCCESS;
    }
    static int copy(SUNMatrix from, SUNMatrix to) {
        entries(to) = entries(from);
        return SUNMAT_SUCCESS;
    }
    // A = c A + 1
    static int scale_add_identity(double c, SUNMatrix a) {
        entries(a) = c * entries(a) + Entries::Identity();
        return SUNMAT_SUCCESS;
    }

    static _generic_SUNMatrix_Ops& operations() {
        static _generic_SUNMatrix_Ops table = [] {
            _generic_SUNMatrix_Ops o{};
            o.getid = id;
            o.clone = clone;
            o.destroy = destroy;
            o.zero = zero;
            o.copy = copy;
            o.scaleaddi = scale_add_identity;
            return o;
        }();
        return table;
    }
};

template <int N>
class FixedDenseSolver {
  public:
    /// To be freed by SUNLinSolFree; nullptr where there is no memory.
    static SUNLinearSolver make(SUNContext context) {
        Storage* s = new (std::nothrow) Storage;
        if (!s) return nullptr;
        s->content = s, s->ops = &operations(), s->sunctx = context;
        return s;
    }

  private:
    struct Storage : _generic_SUNLinearSolver {
        Eigen::PartialPivLU<Eigen::Matrix<double, N, N>> factors;
    };

    static SUNLinearSolver_Type type(SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; }
    static SUNLinearSolver_ID id(SUNLinearSolver) { return SUNLINEARSOLVER_CUSTOM; }
    static int initialize(SUNLinearSolver) { return SUNLS_SUCCESS; }
    // a positive value asks CVODE to try again with a smaller step
    static int setup(SUNLinearSolver s, SUNMatrix a) {
        auto& factors = static_cast<Storage*>(s)->factors;
        factors.compute(FixedMatrix<N>::entries(a));
        const auto pivots = factors.matrixLU().diagonal();
        for (int i = 0; i < N; ++i)
            if (pivots[i] == 0 || !std::isfinite(pivots[i])) return SUNLS_LUFACT_FAIL;
        return SUNLS_SUCCESS;
    }
    static int solve(SUNLinearSolver s, SUNMatrix, N_Vector x, N_Vector b, double) {
        using Column = Eigen::Map<Eigen::Matrix<double, N, 1>>;
        const Eigen::Matrix<double, N, 1> right = Column(FixedVector<N>::data(b));
        Column(FixedVector<N>::data(x)) = static_cast<Storage*>(s)->factors.solve(right);
        return SUNLS_SUCCESS;
    }
    static sunindextype last_flag(SUNLinearSolver) { return SUNLS_SUCCESS; }
    static int destroy(SUNLinearSolver s) {
        delete static_cast<Storage*>(s);
        return SUNLS_SUCCESS;
    }

    static _generic_SUNLinearSolver_Ops& operations() {
        static _generic_SUNLinearSolver_Ops table = [] {
            _generic_SUNLinearSolver_Ops o{};
            o.gettype = type;
            o.getid = id;
            o.initialize = initialize;
            o.setup = setup;
            o.solve = solve;
            o.lastflag = last_flag;
            o.free = destroy;
            return o;
        }();
        return table;
    }
};

}  // namespace polhode
