// Stub for builds without asmjit or for other architectures: no machine code.
#include "integrators/tape/tape_code.h"

namespace polhode {

bool may_compile() { return false; }
std::shared_ptr<const TapeCode> compiled(const TapeProgram&, const TapeLayout&, bool, InstructionSet) {
    return nullptr;
}
std::shared_ptr<const TapeCode> compiled_rates(const TapeProgram&, InstructionSet) { return nullptr; }

}  // namespace polhode
