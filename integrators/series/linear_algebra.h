// Eigen with the same bits whatever a processor's instructions: to be included instead of Eigen's own headers.
//
// Where the compiler may use AVX or fused multiply-adds (-march=native), Eigen sums in wider vectors and rounds once
// where it otherwise rounds twice, by intrinsics that -ffp-contract=off does not reach. It looks for them by the
// compiler's macros, which it therefore does not get to see: it keeps to the baseline's vectors of two doubles, as in a
// build without -march.
#pragma once

#pragma push_macro("__AVX__")
#pragma push_macro("__AVX2__")
#pragma push_macro("__AVX512F__")
#pragma push_macro("__FMA__")
#pragma push_macro("__ARM_FEATURE_FMA")
#undef __AVX__
#undef __AVX2__
#undef __AVX512F__
#undef __FMA__
#undef __ARM_FEATURE_FMA

#include <Eigen/Dense>
#include <Eigen/Sparse>

#pragma pop_macro("__AVX__")
#pragma pop_macro("__AVX2__")
#pragma pop_macro("__AVX512F__")
#pragma pop_macro("__FMA__")
#pragma pop_macro("__ARM_FEATURE_FMA")
