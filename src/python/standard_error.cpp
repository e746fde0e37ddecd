// Debian's libasmjit.a is compiled for programs, and reaches for `stderr` in a way that a shared library cannot. The
// linker has every such reach go to this pointer in its place (--wrap=stderr), which lies within the library.
#include <cstdio>

#undef stderr
extern "C" {
extern std::FILE* __real_stderr;  // NOLINT(bugprone-reserved-identifier): the linker's names
__attribute__((visibility("hidden"))) std::FILE* __wrap_stderr = nullptr;
}

namespace {
__attribute__((constructor(101))) void take_over() { __wrap_stderr = __real_stderr; }
}  // namespace
