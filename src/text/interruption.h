// Whether the work at hand is still wanted: asked now and then by whatever may take long.
#pragma once

#include <functional>
#include <utility>

namespace polhode {

/// While it lives, what this thread does asks `asked` every some 10 ms whether it is to stop, and stops as if a limit
/// of time were reached. Threads that help this one ask too, so `asked` is called from several at once.
class Interruption {
  public:
    /// What a thread asks.
    using Question = std::function<bool()>;

    /// For the thread that whoever wants the work speaks to.
    explicit Interruption(Question asked) : own_(std::move(asked)), former_(std::exchange(current_, &own_)) {}
    /// For a thread that helps another: it asks what is current() there, which outlives this.
    explicit Interruption(const Question* of_another) : former_(std::exchange(current_, of_another)) {}
    ~Interruption() { current_ = former_; }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// What this thread asks; null where nobody will interrupt it.
    static const Question* current() { return current_; }
    /// Whether the work is to stop.
    static bool is_wanted() { return current_ && (*current_)(); }

  private:
    static inline thread_local const Question* current_ = nullptr;
    Question own_;
    const Question* former_;
};

}  // namespace polhode
