// Where no machine code is made: without asmjit, or for another architecture.
#include "integrators/tape/tape_code.h"

namespace polhode {

bool may_compile() { return false; }
std::shared_ptr<const TapeCode> compiled(const TapeProgram&, const TapeLayout&, bool, InstructionSet) {
    return nullptr;
}
std::shared_ptr<const TapeCode> compiled_rates(const TapeProgram&, InstructionSet) { return nullptr; }

}  // namespace polhode
