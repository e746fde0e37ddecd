// What acts between two events, in the scalar of a method's state.
#pragma once

#include "motion/problem.h"
#include "motion/rounded.h"

namespace polhode {

/// What acts on a segment, in scalar S.
template <class S>
class SegmentForcing {
  public:
    explicit SegmentForcing(const Segment& segment) : forcing_(rounded<S>(segment.forcing)) {}
    void enter(const Segment& segment) { forcing_ = rounded<S>(segment.forcing); }
    const Forcing<S>& operator*() const { return forcing_; }
    const Forcing<S>* operator->() const { return &forcing_; }

  private:
    Forcing<S> forcing_;
};
template <>
class SegmentForcing<double> {
  public:
    explicit SegmentForcing(const Segment& segment) : forcing_(&segment.forcing) {}
    void enter(const Segment& segment) { forcing_ = &segment.forcing; }
    const Forcing<double>& operator*() const { return *forcing_; }
    const Forcing<double>* operator->() const { return forcing_; }

  private:
    const Forcing<double>* forcing_;
};

}  // namespace polhode
