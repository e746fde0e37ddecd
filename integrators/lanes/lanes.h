// Several binary64 numbers side by side, and which instructions the processor at hand has for them.
//
// One source serves all: a kernel is [[gnu::always_inline]] inline throughout and is called from thin functions that
// differ only in [[gnu::target(..)]]; the caller picks one of them by instruction_set(). Contraction is off, so that
// every set does the same operations in the same order: the same bits. (GCC 12 still fuses some sums and differences of
// scalar products where AVX-512 has an instruction for them: a kernel computes in whole lanes.)
#pragma once

#include <string_view>

namespace polhode {

/// Four binary64 numbers side by side. The compiler spreads them over as many registers as the instructions in use
/// need. They are passed by reference, because not every processor has a calling convention for them by value.
using Lanes4 = double __attribute__((vector_size(32)));
/// Eight binary64 numbers side by side, with the properties of Lanes4.
using Lanes8 = double __attribute__((vector_size(64)));

/// The vector instructions that a kernel is compiled for.
enum class InstructionSet {
    plain,   ///< those that every processor of the architecture has
    avx2,    ///< AVX2 and FMA: registers of four binary64 numbers
    avx512,  ///< AVX-512 F, DQ and VL and FMA: registers of eight
};

/// The widest instruction set that this processor has, but none wider than the environment variable
/// POLHODE_INSTRUCTION_SET (plain, avx2, avx512) allows. Found once.
InstructionSet instruction_set();

/// The widest instruction set that this processor has, whatever the environment says.
InstructionSet widest_instruction_set();

/// The name as the environment variable spells it: "plain", "avx2" or "avx512".
std::string_view name_of(InstructionSet set);

/// Before a function that computes on lanes: it is always inlined, so that no register is handed over a call.
#define POLHODE_INLINE [[gnu::always_inline]] inline
/// Behind the parameters of a lambda that computes on lanes: it is always inlined.
#define POLHODE_INLINE_LAMBDA __attribute__((always_inline))

#if defined(__x86_64__)
/// Before a function that is compiled for AVX2.
#define POLHODE_TARGET_AVX2 [[gnu::target("avx2")]]
/// Before a function that is compiled for AVX-512.
#define POLHODE_TARGET_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl")]]
#else
/// Nothing: another architecture.
#define POLHODE_TARGET_AVX2
/// Nothing: another architecture.
#define POLHODE_TARGET_AVX512
#endif

}  // namespace polhode
