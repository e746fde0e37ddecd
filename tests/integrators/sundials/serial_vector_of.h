// SUNDIALS' own serial vector behind FixedVector's interface: what the fixed-size one is held against.
#pragma once

#include <nvector/nvector_serial.h>

namespace polhode {

template <int N>
struct SerialVectorOf {
    static N_Vector make(SUNContext context) { return N_VNew_Serial(N, context); }
    static double* data(N_Vector v) { return NV_DATA_S(v); }
};

}  // namespace polhode
