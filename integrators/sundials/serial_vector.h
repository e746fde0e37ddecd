// Vector, matrix and solver for a state whose size is known only at run time: the library's serial vector, dense matrix
// and dense solver. Counterparts of FixedVector, FixedMatrix and FixedDenseSolver.
#pragma once

#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <type_traits>

#include "integrators/sundials/fixed_dense_solver.h"
#include "integrators/sundials/fixed_vector.h"
#include "motion/user_system.h"

namespace polhode {

struct SerialVector {
    static N_Vector make(SUNContext context, int size) {
        N_Vector v = N_VNew_Serial(size, context);
        if (v) N_VConst(0, v);
        return v;
    }
    static double* data(N_Vector v) { return N_VGetArrayPointer(v); }
};

/// The vector type for a state of N components, or of run_time components.
template <int N>
struct VectorFor {
    using type = FixedVector<N>;
};
template <>
struct VectorFor<run_time> {
    using type = SerialVector;
};

/// A vector of zeros; nullptr if there is not enough memory.
template <class Vector>
N_Vector make_vector(SUNContext context, int size) {
    if constexpr (std::is_same_v<Vector, SerialVector>)
        return Vector::make(context, size);
    else
        return Vector::make(context);
}

/// A square matrix for the vector y of N components, and its solver; nullptr if there is not enough memory. N is 3, 7,
/// 13 or run_time. Compiled in linear_solvers.cpp, because Eigen's fixed-size factorisations compile slowly.
template <int N>
SUNMatrix make_matrix(N_Vector y, SUNContext context);
template <int N>
SUNLinearSolver make_linear_solver(N_Vector y, SUNMatrix matrix, SUNContext context);

}  // namespace polhode
