#include "integrators/tape/tape_interpreting.h"

namespace polhode {

void expand_tape_plain(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory) {
    expand(program, layout, careful, memory);
}

}  // namespace polhode
