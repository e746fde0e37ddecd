// Several binary64 numbers side by side, and which instructions the processor at hand has for them.
//
// One source serves all: a kernel is [[gnu::always_inline]] inline throughout and is called from thin functions that
// differ only in [[gnu::target(..)]]; the caller picks one of them by instruction_set(). Contraction is off, so that
// every set does the same operations in the same order: the same bits. (GCC 12 still fuses some sums and differences of
// scalar products where AVX-512 has an instruction for them: a kernel computes in whole lanes.)
#pragma once

#include <string_view>

namespace polhode {

/// Lowered to as many registers as the instructions in use need. Passed by reference: by value they would have no
/// calling convention of their own where there are no such registers.
using Lanes4 = double __attribute__((vector_size(32)));
using Lanes8 = double __attribute__((vector_size(64)));

enum class InstructionSet {
    plain,  ///< what every processor of the architecture has
    avx2,
    avx512,  ///< F, DQ and VL
};

/// The widest that this processor has, but none wider than the environment variable POLHODE_INSTRUCTION_SET (plain,
/// avx2, avx512) allows. Found once.
InstructionSet instruction_set();

/// The widest that this processor has.
InstructionSet widest_instruction_set();

/// "plain", "avx2", "avx512"
std::string_view name_of(InstructionSet set);

// A register is never handed over a call: all that computes on lanes is inlined into the functions above.
#define POLHODE_INLINE [[gnu::always_inline]] inline
#define POLHODE_INLINE_LAMBDA __attribute__((always_inline))

#if defined(__x86_64__)
#define POLHODE_TARGET_AVX2 [[gnu::target("avx2")]]
#define POLHODE_TARGET_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl")]]
#else
#define POLHODE_TARGET_AVX2
#define POLHODE_TARGET_AVX512
#endif

}  // namespace polhode
