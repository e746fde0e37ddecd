// The storage of a state: an array where the compiler knows its size, memory of its own where only the program does.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "motion/own_system.h"

namespace polhode {

/// n numbers, zero at first.
template <int N, class T = double>
struct Numbers : std::array<T, static_cast<std::size_t>(N)> {
    explicit Numbers(int = N) : std::array<T, static_cast<std::size_t>(N)>{} {}
};
template <class T>
struct Numbers<run_time, T> : std::vector<T> {
    explicit Numbers(int n) : std::vector<T>(static_cast<std::size_t>(n)) {}
};

/// As many copies of `value`.
template <std::size_t count, class Value>
std::array<Value, count> copies_of(const Value& value) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) { return std::array<Value, count>{((void)i, value)...}; }
    (std::make_index_sequence<count>());
}

}  // namespace polhode
