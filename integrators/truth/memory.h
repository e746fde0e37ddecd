// What becomes of the process when the libraries of long numbers get no memory.
#pragma once

namespace polhode::truth {

/// GMP, MPFR and FLINT can neither throw nor return where an allocation fails: they say so in words of their own and
/// abort. With this they call `ends` instead, which must not return. To be called before any of them is used; for a
/// program, not for a library within another one's.
void when_out_of_memory(void (*ends)());

}  // namespace polhode::truth
