// What FixedVector, FixedMatrix and FixedDenseSolver are for a state of a size that only the running program knows: the
// library's own serial vector, dense matrix and dense solver.
#pragma once

#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <type_traits>

#include "integrators/sundials/fixed_dense_solver.h"
#include "integrators/sundials/fixed_vector.h"
#include "motion/own_system.h"

namespace polhode {

struct SerialVector {
    static N_Vector make(SUNContext context, int size) {
        N_Vector v = N_VNew_Serial(size, context);
        if (v) N_VConst(0, v);
        return v;
    }
    static double* data(N_Vector v) { return N_VGetArrayPointer(v); }
};

/// The vector for a state of N components, or of run_time.
template <int N>
struct VectorFor {
    using type = FixedVector<N>;
};
template <>
struct VectorFor<run_time> {
    using type = SerialVector;
};

/// A vector of zeros, nullptr where there is no memory.
template <class Vector>
N_Vector made(SUNContext context, int size) {
    if constexpr (std::is_same_v<Vector, SerialVector>)
        return Vector::make(context, size);
    else
        return Vector::make(context);
}

/// A square matrix that goes with the vector y of N components, and its solver; nullptr where there is no memory. N is
/// 3, 7, 13 or run_time: linear_solvers.cpp compiles these, for Eigen's factorisations of a fixed size take long to
/// compile.
template <int N>
SUNMatrix matrix_for(N_Vector y, SUNContext context);
template <int N>
SUNLinearSolver solver_for(N_Vector y, SUNMatrix matrix, SUNContext context);

}  // namespace polhode
