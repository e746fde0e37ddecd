// Several binary64 numbers side by side, and the vector instructions that the processor supports.
//
// One source serves all instruction sets. A kernel is [[gnu::always_inline]] inline throughout and is called from
// thin functions that differ only in [[gnu::target(..)]]; the caller selects one by instruction_set(). Contraction is
// off, so all sets perform the same operations in the same order and give the same bits. (GCC 12 still fuses some
// sums and differences of scalar products where AVX-512 has an instruction for them, so kernels must compute in whole
// lanes.)
#pragma once

#include <string_view>

namespace polhode {

/// Four binary64 numbers side by side. The compiler uses as many registers as the instruction set needs. Pass them by
/// reference, because not every processor has a calling convention for them by value.
using Lanes4 = double __attribute__((vector_size(32)));
/// Eight binary64 numbers side by side, with the properties of Lanes4.
using Lanes8 = double __attribute__((vector_size(64)));

/// The vector instructions that a kernel is compiled for.
enum class InstructionSet {
    plain,   ///< baseline of the architecture
    avx2,    ///< AVX2 and FMA: registers of four binary64 numbers
    avx512,  ///< AVX-512 F, DQ and VL and FMA: registers of eight
};

/// Returns the widest instruction set that this processor supports, limited by the environment variable
/// POLHODE_INSTRUCTION_SET (plain, avx2, avx512). Determined once.
InstructionSet instruction_set();

/// Returns the widest instruction set that this processor supports, ignoring the environment.
InstructionSet widest_instruction_set();

/// Returns the name as in the environment variable: "plain", "avx2" or "avx512".
std::string_view name_of(InstructionSet set);

/// Precedes a function that computes on lanes. It is always inlined, so that no vector is passed through a call.
#define POLHODE_INLINE [[gnu::always_inline]] inline
/// Follows the parameters of a lambda that computes on lanes. It is always inlined.
#define POLHODE_INLINE_LAMBDA __attribute__((always_inline))

#if defined(__x86_64__)
/// Precedes a function that is compiled for AVX2.
#define POLHODE_TARGET_AVX2 [[gnu::target("avx2")]]
/// Precedes a function that is compiled for AVX-512.
#define POLHODE_TARGET_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl")]]
#else
/// Empty on other architectures.
#define POLHODE_TARGET_AVX2
/// Empty on other architectures.
#define POLHODE_TARGET_AVX512
#endif

}  // namespace polhode
