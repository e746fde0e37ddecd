// The one walk through a run: the legs between its events, and which of them shows a sample.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// The rule of every run: a sample at the time of an event shows the motion after it. So an event at t = 0 acts before
/// the first sample, and an impulse at the very end before the last.
constexpr bool acts_before_sample(double event, double sample) { return event <= sample; }

/// The stretch of a run between two events, in which the motion is smooth.
struct Leg {
    std::size_t index = 0;  ///< 0 for the first one
    double begin = 0;       ///< s
    double end = 0;         ///< s; an impulse at the very end opens a last leg of no length
    bool last = false;      ///< no leg follows

    /// Whether a sample at t >= begin is this leg's, and not one's that begins later.
    bool shows(double t) const { return last || !acts_before_sample(end, t); }
};

/// The times at which the motion is not smooth, with 0 first and the scene's duration last; the duration stands there
/// twice where an impulse acts at the very end.
std::vector<double> event_times(const Scene& scene);

/// The legs between the event times: they follow each other without a gap from 0 to the scene's duration.
std::vector<Leg> itinerary(const Scene& scene);

/// The samples of a run that are still to be taken.
class SampleQueue {
  public:
    /// No samples.
    SampleQueue() = default;
    /// The samples at sample_time(duration, k, n), k = 0..n.
    SampleQueue(double duration, long n) : duration_(duration), count_(n + 1) { look(); }
    /// Samples at times of the caller's own (s), which do not decrease and outlive the queue.
    explicit SampleQueue(std::span<const double> times)
        : times_(times.data()), count_(static_cast<long>(times.size())) {
        look();
    }

    /// Whether all samples have been taken.
    bool empty() const { return next_ == count_; }
    /// The time of the next sample, s; infinite where there is none.
    double front() const { return front_; }
    /// The next sample has been taken.
    void pop() { ++next_, look(); }

    /// Whether the next sample is one that the leg shows.
    bool in(const Leg& leg) const { return !empty() && leg.shows(front_); }
    /// Whether the next sample is one that the leg shows, and the motion has come that far (s).
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

/// The events that a run still has to meet, for a driver that goes from sample to sample. LegType: Leg, or what is
/// derived from it.
template <class LegType>
class EventQueue {
  public:
    /// All events of a run; the legs must outlive the queue.
    explicit EventQueue(const std::vector<LegType>& legs) : next_(legs.data()), end_(next_ + legs.size()) { look(); }

    /// Whether the next event acts before a sample at t.
    bool due(double t) const { return acts_before_sample(front_, t); }
    /// The time of the next event, s; infinite where there is none.
    double front() const { return front_; }
    /// Meets the next event and gives the leg that it opens.
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

/// Follows a run leg by leg. Of each, enter(leg) brings about the event that opens it, show(t) takes the samples at its
/// begin, and go(leg) goes on to its end, with the samples that it shows on the way taken off the queue. Each says
/// whether to go on; so does follow(): false where one of them stopped.
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
