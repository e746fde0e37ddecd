// Eigen with the same bits for every instruction set. Include this instead of Eigen's own headers.
//
// Where the compiler may use AVX or fused multiply-adds (-march=native), Eigen uses wider vectors and fused
// operations via intrinsics, which -ffp-contract=off does not affect. Eigen detects these instruction sets by
// compiler macros. The macros are hidden here, so that Eigen uses the baseline's vectors of two doubles, as in a
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
#ifdef __aarch64__
// Eigen's matrix products call fused multiply-adds by name, regardless of the macros.
#include <arm_neon.h>
#pragma push_macro("vfmaq_n_f64")
#pragma push_macro("vfmaq_laneq_f64")
#undef vfmaq_n_f64
#undef vfmaq_laneq_f64
#define vfmaq_n_f64(sum, a, b) vaddq_f64(sum, vmulq_n_f64(a, b))
#define vfmaq_laneq_f64(sum, a, b, lane) vaddq_f64(sum, vmulq_laneq_f64(a, b, lane))
#endif

#include <Eigen/Dense>
#include <Eigen/Sparse>

#ifdef __aarch64__
#pragma pop_macro("vfmaq_n_f64")
#pragma pop_macro("vfmaq_laneq_f64")
#endif

#pragma pop_macro("__AVX__")
#pragma pop_macro("__AVX2__")
#pragma pop_macro("__AVX512F__")
#pragma pop_macro("__FMA__")
#pragma pop_macro("__ARM_FEATURE_FMA")
