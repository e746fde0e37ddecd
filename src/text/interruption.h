// Cooperative interruption: long computations poll whether to stop.
#pragma once

#include <functional>
#include <utility>

namespace polhode {

/// While this object lives, this thread's long computations call `asked` about every 10 ms. If it returns true, they
/// stop as if a time limit were reached. Helper threads of this one call it too, so `asked` must be thread-safe.
class Interruption {
  public:
    /// Returns true if the work should stop.
    using Question = std::function<bool()>;

    /// For the thread that was asked to do the work.
    explicit Interruption(Question asked) : own_(std::move(asked)), former_(std::exchange(current_, &own_)) {}
    /// For a helper thread: it uses current() of the thread that it helps, which must outlive this object.
    explicit Interruption(const Question* of_another) : former_(std::exchange(current_, of_another)) {}
    ~Interruption() { current_ = former_; }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// What this thread polls; null if it cannot be interrupted.
    static const Question* current() { return current_; }
    /// Whether the work should stop.
    static bool is_wanted() { return current_ && (*current_)(); }

  private:
    static inline thread_local const Question* current_ = nullptr;
    Question own_;
    const Question* former_;
};

}  // namespace polhode
