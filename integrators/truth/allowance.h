// Time limit for computing a reference solution.
#pragma once

#include <algorithm>
#include <limits>

#include "integrators/run/processor_time.h"
#include "text/interruption.h"

namespace polhode::truth {

/// Limits the processor time of this thread to `seconds` during the lifetime of this object. A nested limit cannot
/// exceed the remaining time of the outer one. Every step checks is_spent(); an interruption also ends the time.
class Allowance {
  public:
    explicit Allowance(double seconds) : former_(end_) { end_ = std::min(end_, processor_time() + seconds); }
    ~Allowance() { end_ = former_; }
    Allowance(const Allowance&) = delete;
    Allowance& operator=(const Allowance&) = delete;

    static bool is_spent() { return processor_time() > end_ || Interruption::is_requested(); }
    static double left() { return end_ - processor_time(); }
    /// Fault reported by a run that stops at the limit.
    static constexpr const char* fault = "the time limit is reached";

  private:
    static inline thread_local double end_ = std::numeric_limits<double>::infinity();
    double former_;
};

}  // namespace polhode::truth
