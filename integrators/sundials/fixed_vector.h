// A SUNDIALS vector of a length known at compile time. Header and numbers share one allocation, every operation is a
// short loop that the compiler unrolls, and the sums over the history of a multistep method are fused. It provides the
// operations that CVODE and ARKODE call with the nonlinear and linear solvers used here.
//
// The array is padded to whole registers. Element-wise operations include the padding, which always holds zeros;
// operations that do not map zero to zero (quotients, constants) exclude it. Sums use the order of N_VNew_Serial, so
// that both agree to the last bit unless the serial vector has a special case.
#pragma once

#include <sundials/sundials_nvector.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace polhode {

template <int N>
class FixedVector {
  public:
    static constexpr int length = N;
    static constexpr int padded = (N + 3) / 4 * 4;

    /// A vector of zeros, to be freed by N_VDestroy; nullptr if there is not enough memory.
    static N_Vector make(SUNContext context) {
        Storage* v = new (std::nothrow) Storage;
        if (!v) return nullptr;
        v->content = v->value, v->ops = &operations(), v->sunctx = context;
        std::fill(v->value, v->value + padded, 0.0);
        return v;
    }

    /// The numbers of a vector created by make() or by cloning such a vector.
    static double* data(N_Vector v) { return static_cast<Storage*>(v)->value; }

  private:
    struct Storage : _generic_N_Vector {
        alignas(32) double value[padded];
    };

    template <class F>
    static void fill_padded(N_Vector z, F f) {
        double* out = data(z);
        for (int i = 0; i < padded; ++i) out[i] = f(i);
    }
    template <class F>
    static void fill_components(N_Vector z, F f) {
        double* out = data(z);
        for (int i = 0; i < N; ++i) out[i] = f(i);
    }

    static N_Vector clone(N_Vector v) { return make(v->sunctx); }
    static void destroy(N_Vector v) { delete static_cast<Storage*>(v); }
    static N_Vector_ID id(N_Vector) { return SUNDIALS_NVEC_CUSTOM; }
    static sunindextype count(N_Vector) { return N; }

    static void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
        const double *p = data(x), *q = data(y);
        fill_padded(z, [&](int i) { return a * p[i] + b * q[i]; });
    }
    static void constant(double c, N_Vector z) {
        fill_components(z, [&](int) { return c; });
    }
    static void product(N_Vector x, N_Vector y, N_Vector z) {
        const double *p = data(x), *q = data(y);
        fill_padded(z, [&](int i) { return p[i] * q[i]; });
    }
    static void quotient(N_Vector x, N_Vector y, N_Vector z) {
        const double *p = data(x), *q = data(y);
        fill_components(z, [&](int i) { return p[i] / q[i]; });
    }
    static void scale(double c, N_Vector x, N_Vector z) {
        const double* p = data(x);
        fill_padded(z, [&](int i) { return c * p[i]; });
    }
    static void magnitude(N_Vector x, N_Vector z) {
        const double* p = data(x);
        fill_padded(z, [&](int i) { return std::abs(p[i]); });
    }
    static void inverse(N_Vector x, N_Vector z) {
        const double* p = data(x);
        fill_components(z, [&](int i) { return 1 / p[i]; });
    }
    static void add_constant(N_Vector x, double b, N_Vector z) {
        const double* p = data(x);
        fill_components(z, [&](int i) { return p[i] + b; });
    }

    static double dot_product(N_Vector x, N_Vector y) {
        const double *p = data(x), *q = data(y);
        double sum = 0;
        for (int i = 0; i < N; ++i) sum += p[i] * q[i];
        return sum;
    }
    static double max_norm(N_Vector x) {
        const double* p = data(x);
        double most = 0;
        for (int i = 0; i < N; ++i) most = std::max(most, std::abs(p[i]));
        return most;
    }
    static double smallest(N_Vector x) {
        const double* p = data(x);
        double least = p[0];
        for (int i = 1; i < N; ++i) least = std::min(least, p[i]);
        return least;
    }
    static double weighted_rms_norm(N_Vector x, N_Vector w) {
        const double *p = data(x), *q = data(w);
        double sum = 0;
        for (int i = 0; i < N; ++i) sum += (p[i] * q[i]) * (p[i] * q[i]);
        return std::sqrt(sum / N);
    }

    // z = sum of c_k x_k; z may be any of the x
    static int linear_combination(int n, double* c, N_Vector* x, N_Vector z) {
        alignas(32) double sum[padded];
        const double* first = data(x[0]);
        for (int i = 0; i < padded; ++i) sum[i] = c[0] * first[i];
        for (int k = 1; k < n; ++k) {
            const double* p = data(x[k]);
            for (int i = 0; i < padded; ++i) sum[i] += c[k] * p[i];
        }
        std::copy(sum, sum + padded, data(z));
        return 0;
    }
    // z_k = a_k x + y_k; z may be y
    static int scale_add_multi(int n, double* a, N_Vector x, N_Vector* y, N_Vector* z) {
        alignas(32) double common[padded];
        std::copy(data(x), data(x) + padded, common);
        for (int k = 0; k < n; ++k) {
            const double* p = data(y[k]);
            double* out = data(z[k]);
            for (int i = 0; i < padded; ++i) out[i] = a[k] * common[i] + p[i];
        }
        return 0;
    }
    static int scale_vector_array(int n, double* c, N_Vector* x, N_Vector* z) {
        for (int k = 0; k < n; ++k) scale(c[k], x[k], z[k]);
        return 0;
    }

    // one table for all vectors of this length; SUNDIALS does not modify it
    static _generic_N_Vector_Ops& operations() {
        static _generic_N_Vector_Ops table = [] {
            _generic_N_Vector_Ops o{};
            o.nvgetvectorid = id;
            o.nvclone = clone;
            o.nvdestroy = destroy;
            o.nvgetarraypointer = data;
            o.nvgetlength = count;
            o.nvlinearsum = linear_sum;
            o.nvconst = constant;
            o.nvprod = product;
            o.nvdiv = quotient;
            o.nvscale = scale;
            o.nvabs = magnitude;
            o.nvinv = inverse;
            o.nvaddconst = add_constant;
            o.nvdotprod = dot_product;
            o.nvmaxnorm = max_norm;
            o.nvwrmsnorm = weighted_rms_norm;
            o.nvmin = smallest;
            o.nvlinearcombination = linear_combination;
            o.nvscaleaddmulti = scale_add_multi;
            o.nvscalevectorarray = scale_vector_array;
            return o;
        }();
        return table;
    }
};

}  // namespace polhode
