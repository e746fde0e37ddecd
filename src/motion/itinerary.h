// The legs of a run between its events, and the assignment of samples to legs.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// The rule for samples at events: a sample at the time of an event shows the motion after it. An event at t = 0 acts
/// before the first sample, and an impulse at the end of the run before the last.
constexpr bool acts_before_sample(double event, double sample) { return event <= sample; }

/// The interval between two events, in which the motion is smooth.
struct Leg {
    std::size_t index = 0;  ///< 0 for the first leg
    double begin = 0;       ///< s
    double end = 0;         ///< s; an impulse at the end of the run opens a last leg of length zero
    bool last = false;      ///< no leg follows

    /// Whether a sample at t >= begin belongs to this leg and not to a later one.
    bool shows(double t) const { return last || !acts_before_sample(end, t); }
};

/// The times at which the motion is not smooth, from 0 to the scene's duration. The duration appears twice if an
/// impulse acts at the end.
std::vector<double> event_times(const Scene& scene);

/// The legs between the event times. They cover the time from 0 to the scene's duration without gaps.
std::vector<Leg> itinerary(const Scene& scene);

/// The samples of a run that have not been taken yet.
class SampleQueue {
  public:
    /// No samples.
    SampleQueue() = default;
    /// The samples at sample_time(duration, k, n), k = 0..n.
    SampleQueue(double duration, long n) : duration_(duration), count_(n + 1) { look(); }
    /// Samples at user-defined times (s) in non-decreasing order. `times` must outlive the queue.
    explicit SampleQueue(std::span<const double> times)
        : times_(times.data()), count_(static_cast<long>(times.size())) {
        look();
    }

    /// Whether all samples have been taken.
    bool empty() const { return next_ == count_; }
    /// The time of the next sample, s; infinite if there is none.
    double front() const { return front_; }
    /// Removes the next sample.
    void pop() { ++next_, look(); }

    /// Whether the next sample belongs to the leg.
    bool in(const Leg& leg) const { return !empty() && leg.shows(front_); }
    /// Whether the next sample belongs to the leg and its time (s) has been reached.
    template <class Time>
    bool due(const Leg& leg, const Time& reached) const {
        return in(leg) && front_ <= reached;
    }

  private:
    const double* times_ = nullptr;
    double duration_ = 0, front_ = std::numeric_limits<double>::infinity();
    long next_ = 0, count_ = 0;

    void look() {
        if (empty())
            front_ = std::numeric_limits<double>::infinity();
        else
            front_ = times_ ? times_[next_] : sample_time(duration_, next_, count_ - 1);
    }
};

/// The pending events of a run, for a driver that steps from sample to sample. LegType: Leg or a type derived from
/// it.
template <class LegType>
class EventQueue {
  public:
    /// All events of a run; the legs must outlive the queue.
    explicit EventQueue(const std::vector<LegType>& legs) : next_(legs.data()), end_(next_ + legs.size()) { look(); }

    /// Whether the next event acts before a sample at t.
    bool due(double t) const { return acts_before_sample(front_, t); }
    /// The time of the next event, s; infinite if there is none.
    double front() const { return front_; }
    /// Removes the next event and returns the leg that it opens.
    const LegType& pop() {
        const LegType& leg = *next_++;
        look();
        return leg;
    }

  private:
    const LegType *next_, *end_;
    double front_ = 0;

    void look() { front_ = next_ == end_ ? std::numeric_limits<double>::infinity() : next_->begin; }
};

/// Processes a run leg by leg. For each leg, enter(leg) applies the event that opens it, show(t) takes the samples at
/// its start, and go(leg) integrates to its end and removes the samples of this leg from the queue. Each returns
/// whether to continue. follow() returns false if one of them stopped the run.
template <class Legs, class Enter, class Show, class Go>
bool follow(const Legs& legs, SampleQueue& samples, Enter&& enter, Show&& show, Go&& go) {
    for (const auto& leg : legs) {
        if (!enter(leg)) return false;
        for (; samples.due(leg, leg.begin); samples.pop())
            if (!show(samples.front())) return false;
        if (!go(leg)) return false;
    }
    return true;
}

}  // namespace polhode
