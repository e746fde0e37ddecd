// A SUNDIALS matrix and direct linear solver of a size known at compile time, based on Eigen's fixed-size LU
// factorisation with partial pivoting. For use with FixedVector.
#pragma once

#include <sundials/sundials_matrix.h>

#include <cmath>
#include <new>

#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/direct_solver.h"
#include "integrators/sundials/fixed_vector.h"

namespace polhode {

template <int N>
class FixedMatrix {
  public:
    using Entries = Eigen::Matrix<double, N, N, Eigen::RowMajor>;

    /// A matrix of zeros, to be freed by SUNMatDestroy; nullptr if there is not enough memory.
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
class FixedFactors {
  public:
    bool factorize(SUNMatrix a) {
        factors_.compute(FixedMatrix<N>::entries(a));
        const auto pivots = factors_.matrixLU().diagonal();
        for (int i = 0; i < N; ++i)
            if (pivots[i] == 0 || !std::isfinite(pivots[i])) return false;
        return true;
    }
    void solve(N_Vector b, N_Vector x) const {
        using Column = Eigen::Map<Eigen::Matrix<double, N, 1>>;
        const Eigen::Matrix<double, N, 1> right = Column(FixedVector<N>::data(b));
        Column(FixedVector<N>::data(x)) = factors_.solve(right);
    }

  private:
    Eigen::PartialPivLU<Eigen::Matrix<double, N, N>> factors_;
};

template <int N>
using FixedDenseSolver = DirectSolver<FixedFactors<N>>;

}  // namespace polhode
