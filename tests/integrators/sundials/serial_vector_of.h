// SUNDIALS' serial vector with FixedVector's interface, for comparison with the fixed-size vector.
#pragma once

#include <nvector/nvector_serial.h>

namespace polhode {

template <int N>
struct SerialVectorOf {
    static N_Vector make(SUNContext context) { return N_VNew_Serial(N, context); }
    static double* data(N_Vector v) { return NV_DATA_S(v); }
};

}  // namespace polhode
