// Machine code compiled at run time for a tape program.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "integrators/lanes/lanes.h"
#include "integrators/tape/tape_interpreter.h"

namespace polhode {

/// Compiled code in its own executable, read-only memory.
class TapeCode {
  public:
    /// The deleter of `memory` releases it. `size` is in bytes.
    TapeCode(std::shared_ptr<void> memory, std::size_t size) : memory_(std::move(memory)), size_(size) {}

    /// Same as TapeInterpreter::expand. `memory` must have the layout that the code was compiled for.
    void expand(double* memory) const { reinterpret_cast<void (*)(double*)>(memory_.get())(memory); }
    /// Same as TapeInterpreter::add_rates, with the same memory requirements.
    void add_rates(double* memory, const TapeSubstep& substep) const {
        reinterpret_cast<void (*)(double*, const double*, const double*, const double*, double*)>(memory_.get())(
            memory, substep.start, substep.now, substep.scale, substep.change);
    }
    std::size_t size() const { return size_; }

  private:
    std::shared_ptr<void> memory_;
    std::size_t size_;  ///< bytes
};

/// Returns whether this process may compile code. Setting POLHODE_CODE=interpreted in the environment disables it.
bool may_compile();

/// Compiles the series expansion. Returns nullptr if that is not possible: another architecture, an instruction set
/// without vector registers, or no executable memory.
std::shared_ptr<const TapeCode> compile_series(const TapeProgram& program, const TapeLayout& layout, bool careful,
                                               InstructionSet instructions);
/// Compiles the evaluation of rates. Returns nullptr in the same cases as compile_series().
std::shared_ptr<const TapeCode> compile_rates(const TapeProgram& program, InstructionSet instructions);

}  // namespace polhode
