// Debian's libasmjit.a is compiled for programs and accesses `stderr` with a relocation that shared libraries do not
// support. With --wrap=stderr the linker redirects these accesses to this pointer, which is inside the library.
#include <cstdio>

#undef stderr
extern "C" {
extern std::FILE* __real_stderr;  // NOLINT(bugprone-reserved-identifier): names required by the linker
__attribute__((visibility("hidden"))) std::FILE* __wrap_stderr = nullptr;
}

namespace {
__attribute__((constructor(101))) void take_over() { __wrap_stderr = __real_stderr; }
}  // namespace
