// A sparse SUNDIALS matrix and its direct linear solver, based on Eigen's SparseLU with column ordering and partial
// pivoting. For use with the library's serial vector.
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_matrix.h>

#include <new>

#include "integrators/series/linear_algebra.h"
#include "integrators/sundials/direct_solver.h"

namespace polhode {

class SparseMatrix {
  public:
    using Entries = Eigen::SparseMatrix<double>;

    /// An empty square matrix, to be freed by SUNMatDestroy; nullptr if there is not enough memory.
    static SUNMatrix make(int size, SUNContext context) {
        Storage* m = new (std::nothrow) Storage;
        if (!m) return nullptr;
        m->value.resize(size, size);
        m->content = &m->value, m->ops = &operations(), m->sunctx = context;
        return m;
    }

    static Entries& entries(SUNMatrix m) { return static_cast<Storage*>(m)->value; }

  private:
    struct Storage : _generic_SUNMatrix {
        Storage() : _generic_SUNMatrix{} {}
        Entries value;
    };

    static SUNMatrix_ID id(SUNMatrix) { return SUNMATRIX_CUSTOM; }
    static SUNMatrix clone(SUNMatrix m) { return make(static_cast<int>(entries(m).rows()), m->sunctx); }
    static void destroy(SUNMatrix m) { delete static_cast<Storage*>(m); }
    // nothing to do: the function that fills the matrix writes every entry
    static int zero(SUNMatrix) { return SUNMAT_SUCCESS; }
    static int copy(SUNMatrix from, SUNMatrix to) {
        entries(to) = entries(from);
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
            return o;
        }();
        return table;
    }
};

/// All matrices must have the sparsity pattern of the first one.
class SparseFactors {
  public:
    bool factorize(SUNMatrix a) {
        if (!analyzed_) factors_.analyzePattern(SparseMatrix::entries(a)), analyzed_ = true;
        factors_.factorize(SparseMatrix::entries(a));
        return factors_.info() == Eigen::Success;
    }
    void solve(N_Vector b, N_Vector x) const {
        const Eigen::Index n = factors_.rows();
        const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(b), n);
        Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(x), n) = factors_.solve(right);
    }

  private:
    Eigen::SparseLU<SparseMatrix::Entries> factors_;
    bool analyzed_ = false;
};

using SparseSolver = DirectSolver<SparseFactors>;

}  // namespace polhode
