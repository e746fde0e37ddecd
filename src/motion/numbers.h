// Storage of a state: an array if its size is known at compile time, allocated memory otherwise.
#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

#include "motion/user_system.h"

namespace polhode {

/// Allocates memory aligned to cache lines. The alignment that GCC assumes for a vector of eight doubles depends on
/// the instruction set of the current function: 16 bytes where memory is allocated, 64 bytes where AVX-512 code uses
/// it.
template <class T>
struct LineAllocator {
    using value_type = T;
    static constexpr std::align_val_t line{64};

    LineAllocator() = default;
    template <class Other>
    LineAllocator(const LineAllocator<Other>&) {}
    T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), line)); }
    void deallocate(T* memory, std::size_t) { ::operator delete(memory, line); }
    friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

/// n numbers, initially zero.
template <int N, class T = double>
struct Numbers : std::array<T, static_cast<std::size_t>(N)> {
    explicit Numbers(int = N) : std::array<T, static_cast<std::size_t>(N)>{} {}
};
template <class T>
struct Numbers<run_time, T> : std::vector<T, LineAllocator<T>> {
    explicit Numbers(int n) : std::vector<T, LineAllocator<T>>(static_cast<std::size_t>(n)) {}
};

/// `count` copies of `value`.
template <std::size_t count, class Value>
std::array<Value, count> copies_of(const Value& value) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) { return std::array<Value, count>{((void)i, value)...}; }
    (std::make_index_sequence<count>());
}

}  // namespace polhode
