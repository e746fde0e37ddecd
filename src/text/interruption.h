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
    using Callback = std::function<bool()>;

    /// For the thread that was asked to do the work.
    explicit Interruption(Callback callback)
        : callback_(std::move(callback)), previous_(std::exchange(current_, &callback_)) {}
    /// For a helper thread: it uses current() of the thread that it helps, which must outlive this object.
    explicit Interruption(const Callback* inherited) : previous_(std::exchange(current_, inherited)) {}
    ~Interruption() { current_ = previous_; }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// What this thread polls; null if it cannot be interrupted.
    static const Callback* current() { return current_; }
    /// Whether the work should stop.
    static bool is_requested() { return current_ && (*current_)(); }

  private:
    static inline thread_local const Callback* current_ = nullptr;
    Callback callback_;
    const Callback* previous_;
};

}  // namespace polhode
