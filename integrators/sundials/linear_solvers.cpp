// Matrices and direct linear solvers for the state sizes in use.
#include "integrators/sundials/serial_vector.h"

namespace polhode {

template <int N>
SUNMatrix matrix_for(N_Vector, SUNContext context) {
    return FixedMatrix<N>::make(context);
}
template <>
SUNMatrix matrix_for<run_time>(N_Vector y, SUNContext context) {
    return SUNDenseMatrix(N_VGetLength(y), N_VGetLength(y), context);
}

template <int N>
SUNLinearSolver solver_for(N_Vector, SUNMatrix, SUNContext context) {
    return FixedDenseSolver<N>::make(context);
}
template <>
SUNLinearSolver solver_for<run_time>(N_Vector y, SUNMatrix matrix, SUNContext context) {
    return SUNLinSol_Dense(y, matrix, context);
}

template SUNMatrix matrix_for<3>(N_Vector, SUNContext);
template SUNMatrix matrix_for<7>(N_Vector, SUNContext);
template SUNMatrix matrix_for<13>(N_Vector, SUNContext);
template SUNLinearSolver solver_for<3>(N_Vector, SUNMatrix, SUNContext);
template SUNLinearSolver solver_for<7>(N_Vector, SUNMatrix, SUNContext);
template SUNLinearSolver solver_for<13>(N_Vector, SUNMatrix, SUNContext);

}  // namespace polhode
