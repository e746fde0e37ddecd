// Handling of allocation failures in the multiprecision libraries.
#pragma once

namespace polhode::truth {

/// Sets the function that GMP, MPFR and FLINT call when an allocation fails. These libraries can neither throw nor
/// return an error there: by default they print a message and abort. `handler` must not return. Call this before any of
/// them is used, from a program; a library within another program must not call it.
void set_out_of_memory_handler(void (*handler)());

}  // namespace polhode::truth
