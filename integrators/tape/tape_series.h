// The Taylor coefficients of a recorded system in binary64: by machine code made for it, where code may be made, and by
// an interpreter elsewhere, with the same bits.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "integrators/tape/tape_code.h"
#include "integrators/tape/tape_interpreter.h"
#include "motion/numbers.h"

namespace polhode {

/// How series are computed: whatever it is, the bits are the same.
struct TapeOptions {
    InstructionSet instructions = instruction_set();
    bool compiled = may_compile();  ///< machine code, where the processor is one that it can be made for
    bool careful = false;           ///< as in ExpandTape
    int order = 0;                  ///< from 2 to TapeLayout::most_order; 0: that of least work at the tolerance
    double tolerance = 1e-12;
    TapeProgram::Purpose purpose = TapeProgram::Purpose::series;

    bool operator==(const TapeOptions&) const = default;
};

/// A tape made ready once: what many series of the same system share.
struct PreparedTape {
    TapeProgram program;
    TapeLayout layout;
    TapeOptions options;
    std::shared_ptr<const TapeCode> code;  ///< none: interpreted

    PreparedTape(const Recording<double>& recording, const TapeOptions& options_);
};

/// The one of this process for an equal recording and options, made at the first call. By any number of threads.
std::shared_ptr<const PreparedTape> prepared(const Recording<double>& recording, const TapeOptions& options);

/// The order of least work for a time, with steps as long as the tolerance admits (Jorba & Zou 2005, 3.1: where a
/// step's work is as the order squared, this is 1 - log(tolerance) / 2).
int best_order(const TapeProgram& program, double tolerance);

/// The coefficients of a recorded system's solution up to an order.
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
    /// The k-th coefficients of all state variables, and zeros up to the next multiple of TapeLayout::line.
    const double* coefficients(int k) const {
        return memory_.data() + tape_->layout.coefficients +
               static_cast<std::size_t>(k) * static_cast<std::size_t>(tape_->layout.states);
    }
    /// The sum of y_k h^(k - from) from k = from < order() on: into as many numbers as coefficients() has.
    void sum(int from, double h, double* sums) const {
        interpreter_->sum(coefficients(0), tape_->layout.states, order(), from, h, sums);
    }
    /// The k-th coefficient of the i-th state variable.
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
    /// The rates of the states y alone.
    void find(const double* y, double* rates);
    /// Whether the rate of the i-th variable is zero always.
    bool is_parameter(int i) const { return tape_->program.first_rates[i].from == TapeProgram::none; }

  private:
    std::shared_ptr<const PreparedTape> tape_;
    const TapeInterpreter* interpreter_;
    std::vector<double, LineAllocator<double>> memory_, nothing_;
};

}  // namespace polhode
