// FixedVector against SUNDIALS' serial vector, operation by operation.
#include "integrators/sundials/fixed_vector.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <random>

#include "integrators/sundials/serial_vector_of.h"
#include "integrators/sundials/sundials_handles.h"

namespace polhode {
namespace {

template <class T>
class FixedVectorOf : public ::testing::Test {};
using Lengths =
    ::testing::Types<std::integral_constant<int, 3>, std::integral_constant<int, 7>, std::integral_constant<int, 13>>;
TYPED_TEST_SUITE(FixedVectorOf, Lengths);

/// Three vectors of random non-zero numbers, the same for both types; the third receives the result.
template <class Vector, int N>
struct Three {
    explicit Three(SUNContext context)
        : x(make_owner(Vector::make(context))),
          y(make_owner(Vector::make(context))),
          z(make_owner(Vector::make(context))) {
        std::mt19937 bits(5);
        std::uniform_real_distribution<double> positive(0.5, 2);
        for (const N_Vector v : {x.get(), y.get(), z.get()})
            for (int i = 0; i < N; ++i) Vector::data(v)[i] = (bits() % 2 ? 1 : -1) * positive(bits);
    }
    SundialsOwner<N_Vector> x, y, z;
};

TYPED_TEST(FixedVectorOf, ComputesWhatTheSerialVectorComputes) {
    constexpr int N = TypeParam::value;
    using Operation = std::function<double(N_Vector, N_Vector, N_Vector)>;
    const auto in_place = [](auto f) {
        return Operation([f](N_Vector x, N_Vector y, N_Vector z) { return f(x, y, z), 0.0; });
    };
    const std::vector<std::pair<const char*, Operation>> operations = {
        {"LinearSum", in_place([](N_Vector x, N_Vector y, N_Vector z) { N_VLinearSum(0.3, x, -1.7, y, z); })},
        {"LinearSum onto x", in_place([](N_Vector, N_Vector y, N_Vector z) { N_VLinearSum(0.3, z, 1, y, z); })},
        {"Const", in_place([](N_Vector, N_Vector, N_Vector z) { N_VConst(2.5, z); })},
        {"Prod", in_place([](N_Vector x, N_Vector y, N_Vector z) { N_VProd(x, y, z); })},
        {"Div", in_place([](N_Vector x, N_Vector y, N_Vector z) { N_VDiv(x, y, z); })},
        {"Scale", in_place([](N_Vector x, N_Vector, N_Vector z) { N_VScale(-0.7, x, z); })},
        {"Abs", in_place([](N_Vector x, N_Vector, N_Vector z) { N_VAbs(x, z); })},
        {"Inv", in_place([](N_Vector x, N_Vector, N_Vector z) { N_VInv(x, z); })},
        {"AddConst", in_place([](N_Vector x, N_Vector, N_Vector z) { N_VAddConst(x, 0.1, z); })},
        {"DotProd", [](N_Vector x, N_Vector y, N_Vector) { return N_VDotProd(x, y); }},
        {"MaxNorm", [](N_Vector x, N_Vector, N_Vector) { return N_VMaxNorm(x); }},
        {"WrmsNorm", [](N_Vector x, N_Vector y, N_Vector) { return N_VWrmsNorm(x, y); }},
        {"Min", [](N_Vector x, N_Vector, N_Vector) { return N_VMin(x); }},
        {"LinearCombination onto the first",
         [](N_Vector x, N_Vector y, N_Vector z) {
             double c[] = {0.2, -1.1, 3};
             N_Vector all[] = {x, y, z};
             return double(N_VLinearCombination(3, c, all, x));
         }},
        {"ScaleAddMulti onto themselves",
         [](N_Vector x, N_Vector y, N_Vector z) {
             double a[] = {0.2, -1.1};
             N_Vector all[] = {y, z};
             return double(N_VScaleAddMulti(2, a, x, all, all));
         }},
        {"ScaleVectorArray",
         [](N_Vector x, N_Vector y, N_Vector) {
             double c[] = {0.2, -1.1};
             N_Vector all[] = {x, y};
             return double(N_VScaleVectorArray(2, c, all, all));
         }},
    };
    SundialsContext context;
    for (const auto& [name, operation] : operations) {
        Three<FixedVector<N>, N> fixed(context);
        Three<SerialVectorOf<N>, N> serial(context);
        EXPECT_EQ(operation(fixed.x.get(), fixed.y.get(), fixed.z.get()),
                  operation(serial.x.get(), serial.y.get(), serial.z.get()))
            << name;
        const std::array pairs{std::pair(fixed.x.get(), serial.x.get()), std::pair(fixed.y.get(), serial.y.get()),
                               std::pair(fixed.z.get(), serial.z.get())};
        for (const auto& [f, s] : pairs) {
            for (int i = 0; i < N; ++i)
                EXPECT_EQ(FixedVector<N>::data(f)[i], SerialVectorOf<N>::data(s)[i]) << name << ", component " << i;
            for (int i = N; i < FixedVector<N>::padded; ++i)
                EXPECT_EQ(FixedVector<N>::data(f)[i], 0) << name << " leaves a number in the padding";
        }
    }
}

TYPED_TEST(FixedVectorOf, ClonesToZeros) {
    constexpr int N = TypeParam::value;
    SundialsContext context;
    const auto v = make_owner(FixedVector<N>::make(context));
    N_VConst(3, v.get());
    const auto copy = make_owner(N_VClone(v.get()));
    EXPECT_EQ(N_VGetLength(copy.get()), N);
    EXPECT_EQ(N_VMaxNorm(copy.get()), 0);
    EXPECT_EQ(N_VMin(v.get()), 3);
}

}  // namespace
}  // namespace polhode
