// Stub for builds without asmjit or for other architectures: no machine code.
#include "integrators/tape/tape_code.h"

namespace polhode {

bool may_compile() { return false; }
std::shared_ptr<const TapeCode> compile_series(const TapeProgram&, const TapeLayout&, bool, InstructionSet) {
    return nullptr;
}
std::shared_ptr<const TapeCode> compile_rates(const TapeProgram&, InstructionSet) { return nullptr; }

}  // namespace polhode
