// How long a truth may take.
#pragma once

#include <algorithm>
#include <limits>

#include "integrators/run/processor_time.h"
#include "text/interruption.h"

namespace polhode::truth {

/// While it lives, what this thread makes of a truth has `seconds` of its own time; one inside another gives no more
/// than is left. Each step asks; an interruption spends it all.
class Allowance {
  public:
    explicit Allowance(double seconds) : former_(end_) { end_ = std::min(end_, processor_time() + seconds); }
    ~Allowance() { end_ = former_; }
    Allowance(const Allowance&) = delete;
    Allowance& operator=(const Allowance&) = delete;

    static bool is_spent() { return processor_time() > end_ || Interruption::is_wanted(); }
    static double left() { return end_ - processor_time(); }
    /// The fault of a run that stops when it is spent.
    static constexpr const char* fault = "the time allowed is spent";

  private:
    static inline thread_local double end_ = std::numeric_limits<double>::infinity();
    double former_;
};

}  // namespace polhode::truth
