// Taylor coefficients of a recorded system in binary64. They are computed by compiled machine code if the process may
// compile code, otherwise by an interpreter with the same bits.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "integrators/tape/tape_code.h"
#include "integrators/tape/tape_interpreter.h"
#include "motion/numbers.h"

namespace polhode {

/// How series are computed. The implementation options do not change the bits.
struct TapeOptions {
    InstructionSet instructions = instruction_set();
    bool compiled = may_compile();  ///< compile to machine code if the processor is supported
    bool careful = false;           ///< see TapeInterpreter::expand
    int order = 0;                  ///< 2 to TapeLayout::most_order; 0: the order of least work at the tolerance
    double tolerance = 1e-12;
    TapeProgram::Purpose purpose = TapeProgram::Purpose::series;

    bool operator==(const TapeOptions&) const = default;
};

/// A tape prepared for evaluation. Series of the same system share it.
struct PreparedTape {
    TapeProgram program;
    TapeLayout layout;
    TapeOptions options;
    std::shared_ptr<const TapeCode> code;  ///< null: interpreted

    PreparedTape(const Recording<double>& recording, const TapeOptions& options_);
};

/// Returns the process-wide tape for an equal recording and equal options, built on the first call. Thread-safe.
std::shared_ptr<const PreparedTape> prepare_tape(const Recording<double>& recording, const TapeOptions& options);

/// Returns the order of least work per unit of time, with steps as long as the tolerance allows. If the work per step
/// grew as the square of the order, this would be 1 - log(tolerance) / 2 (Jorba & Zou 2005, 3.1).
int best_order(const TapeProgram& program, double tolerance);

/// Taylor coefficients of a recorded system's solution, up to a given order.
class TapeSeries {
  public:
    explicit TapeSeries(const Recording<double>& recording, const TapeOptions& options = {});

    int order() const { return tape_->layout.order; }
    int dimension() const { return tape_->program.states; }
    const PreparedTape& tape() const { return *tape_; }

    /// Expands the solution that starts at y.
    void expand(const double* y) {
        double* const memory = memory_.data();
        const int* const values = tape_->program.values.data();
        for (int i = 0, n = dimension(); i < n; ++i) memory[values[i]] = y[i];
        if (tape_->code)
            tape_->code->expand(memory);
        else
            interpreter_->expand(tape_->program, tape_->layout, tape_->options.careful, memory);
    }
    /// The k-th coefficients of all state variables, padded with zeros to a multiple of TapeLayout::line.
    const double* coefficients(int k) const {
        return memory_.data() + tape_->layout.coefficients +
               static_cast<std::size_t>(k) * static_cast<std::size_t>(tape_->layout.states);
    }
    /// Sums y_k h^(k - from) over k = from .. order(), from < order(). `sums` has the padded size of coefficients().
    void sum(int from, double h, double* sums) const {
        interpreter_->sum(coefficients(0), tape_->layout.states, order(), from, h, sums);
    }
    /// The k-th coefficient of state variable i.
    double coefficient(int i, int k) const { return coefficients(k)[i]; }

  private:
    std::shared_ptr<const PreparedTape> tape_;
    const TapeInterpreter* interpreter_;
    std::vector<double, LineAllocator<double>> memory_;
};

/// Substeps of eight states of a recorded system side by side.
class TapeRates {
  public:
    static constexpr int lanes = TapeLayout::line;

    explicit TapeRates(const Recording<double>& recording, TapeOptions options = {});

    void operator()(const TapeSubstep& substep) {
        if (tape_->code)
            tape_->code->add_rates(memory_.data(), substep);
        else
            interpreter_->add_rates(tape_->program, memory_.data(), substep);
    }
    /// Computes only the rates of the states y.
    void find(const double* y, double* rates);
    /// Returns whether the rate of variable i is identically zero.
    bool is_parameter(int i) const { return tape_->program.first_rates[i].from == TapeProgram::none; }

  private:
    std::shared_ptr<const PreparedTape> tape_;
    const TapeInterpreter* interpreter_;
    std::vector<double, LineAllocator<double>> memory_, zeros_;
};

}  // namespace polhode
