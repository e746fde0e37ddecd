// A direct linear solver for SUNDIALS from a factorisation by Eigen.
#pragma once

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

#include <concepts>
#include <new>

namespace polhode {

/// A factorisation of matrices. factorize() returns false if the matrix has none.
template <class F>
concept Factorisation = std::default_initializable<F> && requires(F factors, SUNMatrix a, N_Vector x, N_Vector b) {
    { factors.factorize(a) } -> std::same_as<bool>;
    factors.solve(b, x);  // solves a x = b for the matrix that was factorised last
};

template <Factorisation Factors>
class DirectSolver {
  public:
    /// A new solver, to be freed by SUNLinSolFree; nullptr if there is not enough memory.
    static SUNLinearSolver make(SUNContext context) {
        Storage* s = new (std::nothrow) Storage;
        if (!s) return nullptr;
        s->content = s, s->ops = &operations(), s->sunctx = context;
        return s;
    }

  private:
    struct Storage : _generic_SUNLinearSolver {
        Storage() : _generic_SUNLinearSolver{} {}
        Factors factors;
    };

    static SUNLinearSolver_Type type(SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; }
    static SUNLinearSolver_ID id(SUNLinearSolver) { return SUNLINEARSOLVER_CUSTOM; }
    static int initialize(SUNLinearSolver) { return SUNLS_SUCCESS; }
    // a positive value requests another attempt with a smaller step
    static int setup(SUNLinearSolver s, SUNMatrix a) {
        return static_cast<Storage*>(s)->factors.factorize(a) ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL;
    }
    static int solve(SUNLinearSolver s, SUNMatrix, N_Vector x, N_Vector b, double) {
        static_cast<Storage*>(s)->factors.solve(b, x);
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
