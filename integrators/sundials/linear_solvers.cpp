// Matrices and direct linear solvers for the state sizes in use.
#include "integrators/sundials/serial_vector.h"

namespace polhode {

template <int N>
SUNMatrix make_matrix(N_Vector, SUNContext context) {
    return FixedMatrix<N>::make(context);
}
template <>
SUNMatrix make_matrix<run_time>(N_Vector y, SUNContext context) {
    return SUNDenseMatrix(N_VGetLength(y), N_VGetLength(y), context);
}

template <int N>
SUNLinearSolver make_linear_solver(N_Vector, SUNMatrix, SUNContext context) {
    return FixedDenseSolver<N>::make(context);
}
template <>
SUNLinearSolver make_linear_solver<run_time>(N_Vector y, SUNMatrix matrix, SUNContext context) {
    return SUNLinSol_Dense(y, matrix, context);
}

template SUNMatrix make_matrix<3>(N_Vector, SUNContext);
template SUNMatrix make_matrix<7>(N_Vector, SUNContext);
template SUNMatrix make_matrix<13>(N_Vector, SUNContext);
template SUNLinearSolver make_linear_solver<3>(N_Vector, SUNMatrix, SUNContext);
template SUNLinearSolver make_linear_solver<7>(N_Vector, SUNMatrix, SUNContext);
template SUNLinearSolver make_linear_solver<13>(N_Vector, SUNMatrix, SUNContext);

}  // namespace polhode
