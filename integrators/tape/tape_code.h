// Machine code for the programs of tapes, made when the tape is known.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "integrators/lanes/lanes.h"
#include "integrators/tape/tape_interpreter.h"

namespace polhode {

/// Code in memory of its own, which nobody may write to.
class TapeCode {
  public:
    /// The memory knows how it is given back.
    TapeCode(std::shared_ptr<void> memory, std::size_t size) : memory_(std::move(memory)), size_(size) {}

    /// What TapeInterpreter::expand does, in memory of the layout that it was made for.
    void expand(double* memory) const { reinterpret_cast<void (*)(double*)>(memory_.get())(memory); }
    /// What TapeInterpreter::add_rates does, with as much room.
    void add_rates(double* memory, const TapeSubstep& substep) const {
        reinterpret_cast<void (*)(double*, const double*, const double*, const double*, double*)>(memory_.get())(
            memory, substep.start, substep.now, substep.scale, substep.change);
    }
    std::size_t size() const { return size_; }

  private:
    std::shared_ptr<void> memory_;
    std::size_t size_;  ///< bytes
};

/// Whether this process makes code: not with POLHODE_CODE=interpreted in its environment.
bool may_compile();

/// The code, or nothing where none can be made: another architecture, no instructions for lanes, no memory for code.
std::shared_ptr<const TapeCode> compiled(const TapeProgram& program, const TapeLayout& layout, bool careful,
                                         InstructionSet instructions);
/// Of a program for rates.
std::shared_ptr<const TapeCode> compiled_rates(const TapeProgram& program, InstructionSet instructions);

}  // namespace polhode
