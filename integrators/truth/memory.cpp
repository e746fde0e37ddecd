#include "integrators/truth/memory.h"

#include <gmp.h>

#include <cstddef>
#include <cstdlib>

// FLINT's function; present if the program has certified references
extern "C" [[gnu::weak]] void __flint_set_memory_functions(  // NOLINT(bugprone-reserved-identifier)
    void* (*)(std::size_t), void* (*)(std::size_t, std::size_t), void* (*)(void*, std::size_t), void (*)(void*));

namespace polhode::truth {
namespace {

void (*memory_handler)() = nullptr;

// GMP never requests a block of size 0; FLINT does, and accepts any pointer for it
void* check_block(void* block, std::size_t size) {
    if (!block && size > 0) {
        memory_handler();
        std::abort();
    }
    return block;
}

void* allocate(std::size_t size) { return check_block(std::malloc(size), size); }
void* allocate_zeros(std::size_t count, std::size_t size) {
    return check_block(std::calloc(count, size), count * size);
}
void* reallocate(void* block, std::size_t size) { return check_block(std::realloc(block, size), size); }
void* reallocate_sized(void* block, std::size_t, std::size_t size) { return reallocate(block, size); }
void release(void* block) { std::free(block); }
void release_sized(void* block, std::size_t) { std::free(block); }

}  // namespace

void set_out_of_memory_handler(void (*handler)()) {
    memory_handler = handler;
    mp_set_memory_functions(allocate, reallocate_sized, release_sized);
    if (__flint_set_memory_functions) __flint_set_memory_functions(allocate, allocate_zeros, reallocate, release);
}

}  // namespace polhode::truth
