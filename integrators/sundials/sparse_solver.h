// A sparse SUNDIALS matrix and a direct linear solver for it, on Eigen's SparseLU with column ordering and partial
// pivoting. They go with the library's serial vector.
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <Eigen/Sparse>
#include <new>

namespace polhode {

class SparseMatrix {
  public:
    using Entries = Eigen::SparseMatrix<double>;

    /// An empty square matrix, to be freed by SUNMatDestroy; nullptr where there is no memory.
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
    // whoever fills it in writes every entry
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

/// The pattern of all matrices that it is given is the first one's.
class SparseSolver {
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
        Storage() : _generic_SUNLinearSolver{} {}
        Eigen::SparseLU<SparseMatrix::Entries> factors;
        bool analyzed = false;
    };

    static SUNLinearSolver_Type type(SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; }
    static SUNLinearSolver_ID id(SUNLinearSolver) { return SUNLINEARSOLVER_CUSTOM; }
    static int initialize(SUNLinearSolver) { return SUNLS_SUCCESS; }
    // a positive value asks for another try with a smaller step
    static int setup(SUNLinearSolver s, SUNMatrix a) {
        Storage* self = static_cast<Storage*>(s);
        if (!self->analyzed) self->factors.analyzePattern(SparseMatrix::entries(a)), self->analyzed = true;
        self->factors.factorize(SparseMatrix::entries(a));
        return self->factors.info() == Eigen::Success ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL;
    }
    static int solve(SUNLinearSolver s, SUNMatrix a, N_Vector x, N_Vector b, double) {
        const Eigen::Index n = SparseMatrix::entries(a).rows();
        const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(b), n);
        Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(x), n) = static_cast<Storage*>(s)->factors.solve(right);
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
