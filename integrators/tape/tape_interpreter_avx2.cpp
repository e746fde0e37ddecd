#include "integrators/tape/tape_interpreting.h"

namespace polhode {

void expand_tape_avx2(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory) {
    expand(program, layout, careful, memory);
}

}  // namespace polhode
