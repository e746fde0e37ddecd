// Classification of run outcomes, on trajectories made by hand.
#include "measure/stability.h"

#include <gtest/gtest.h>

#include <cmath>

namespace polhode {
namespace {

constexpr long last = 8;

// A body that rotates at `rate` about z, sampled once per second.
Reference turning(double rate) {
    Reference reference;
    reference.available = true;
    for (long k = 0; k <= last; ++k) {
        const double t = static_cast<double>(k), half = rate * t / 2;
        ReferenceSample sample;
        sample.t = t;
        sample.q = {Pair(std::cos(half)), Pair(0), Pair(0), Pair(std::sin(half))};
        sample.angular_velocity_B = {Pair(0), Pair(0), Pair(rate)};
        reference.samples.push_back(sample);
    }
    return reference;
}

Trajectory turning_at(double rate, double final_rate) {
    Trajectory trajectory;
    for (long k = 0; k <= last; ++k) {
        Sample sample;
        sample.t = static_cast<double>(k);
        sample.angular_velocity_B = {0, 0, k < last - 1 ? rate : final_rate};
        trajectory.samples.push_back(sample);
    }
    return trajectory;
}

Errors errors_of(double attitude, double omega, double energy) {
    Errors errors;
    errors["attitude"].final = errors["attitude"].max = attitude;
    errors["omega"].max = omega, errors["energy"].max = energy;
    return errors;
}

TEST(Stability, IsBoundedByTheMotionsOwnSize) {
    EXPECT_TRUE(is_stable(errors_of(3, 2, 4)));  // rotates in the opposite direction at the right rate
    EXPECT_FALSE(is_stable(errors_of(0, 4.1, 0)));
    EXPECT_FALSE(is_stable(errors_of(0, 0, 8.1)));
    EXPECT_FALSE(is_stable(Errors{}));  // no errors available
    Errors nan = errors_of(0, std::nan(""), 0);
    EXPECT_FALSE(is_stable(nan));
}

TEST(Stability, RestIsWhereTheTrueMotionIsNot) {
    for (const double rate : {1e-150, 1.0, 1e150}) {
        EXPECT_TRUE(is_damped_to_rest(turning_at(rate, 0.05 * rate), turning(rate)));
        EXPECT_FALSE(is_damped_to_rest(turning_at(rate, rate), turning(rate)));
        EXPECT_FALSE(is_damped_to_rest(turning_at(rate, 0.2 * rate), turning(rate)));
    }
    EXPECT_FALSE(is_damped_to_rest(turning_at(0, 0), turning(0)));
    // the reference is at rest by then as well
    Reference stops = turning(1);
    for (long k = 4; k <= last; ++k) stops.samples[static_cast<std::size_t>(k)].angular_velocity_B = {};
    EXPECT_FALSE(is_damped_to_rest(turning_at(1, 0), stops));
    Trajectory shorter = turning_at(1, 0);
    shorter.samples.pop_back();
    EXPECT_FALSE(is_damped_to_rest(shorter, turning(1)));
}

TEST(Stability, OutcomesInTheirOrder) {
    const Reference truth = turning(1);
    const Trajectory same = turning_at(1, 1), rest = turning_at(1, 0);
    EXPECT_EQ(outcome_of(same, errors_of(1e-3, 0, 0), truth), Outcome::accurate);
    EXPECT_EQ(outcome_of(same, errors_of(1.1e-3, 0, 0), truth), Outcome::close);
    EXPECT_EQ(outcome_of(same, errors_of(0.11, 0, 0), truth), Outcome::wrong_but_bounded);
    EXPECT_EQ(outcome_of(rest, errors_of(1e-4, 1, 1), truth), Outcome::damped_to_rest);
    EXPECT_EQ(outcome_of(same, errors_of(0.5, 5, 0), truth), Outcome::diverged);
    EXPECT_EQ(outcome_of(same, Errors{}, truth), Outcome::no_truth);
    for (const auto& [status, outcome] :
         {std::pair{Status::diverged, Outcome::diverged}, std::pair{Status::failed, Outcome::failed},
          std::pair{Status::unsupported, Outcome::unsupported},
          std::pair{Status::tolerance_not_met, Outcome::tolerance_not_met}}) {
        Trajectory ended = same;
        ended.status = status;
        EXPECT_EQ(outcome_of(ended, errors_of(0, 0, 0), truth), outcome);
    }
}

TEST(Stability, HoldsAtItsBounds) {
    EXPECT_TRUE(is_stable(errors_of(0, 4, 8)));
    EXPECT_EQ(outcome_of(turning_at(1, 1), errors_of(close_attitude, 0, 0), turning(1)), Outcome::close);
}

TEST(Stability, DetectsRestByTheLastQuarterAndTheLargestRate) {
    // only the last quarter counts: a body at rest until then that rotates in it again is not damped to rest
    Trajectory turns_again = turning_at(1, 1);
    for (std::size_t k = 4; k < 7; ++k) turns_again.samples[k].angular_velocity_B = {};
    EXPECT_FALSE(is_damped_to_rest(turns_again, turning(1)));
    Trajectory stops = turning_at(1, 0);
    EXPECT_TRUE(is_damped_to_rest(stops, turning(1)));
    // a reference that slows down to a thousandth of its largest rate is at rest as well
    Reference slows = turning(1);
    for (std::size_t k = 7; k <= 8; ++k) slows.samples[k].angular_velocity_B = {Pair(0), Pair(0), Pair(9e-4)};
    EXPECT_FALSE(is_damped_to_rest(stops, slows));
    // with three samples the last quarter is the last sample
    Reference three = turning(1);
    three.samples.resize(3);
    Trajectory short_stop = turning_at(1, 0);
    short_stop.samples.erase(short_stop.samples.begin() + 2, short_stop.samples.end() - 1);
    EXPECT_TRUE(is_damped_to_rest(short_stop, three));
}

}  // namespace
}  // namespace polhode
