// What the proofs of one body's motion and of several bodies' have in common: a motion is enclosed at one working
// precision after another, each told by the last attempt.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"

namespace polhode::truth {

// what a series costs grows with the third power of the bits: beyond these, hours; closed forms cost little
constexpr double most_series_bits = 3000, most_bits = 32768;

/// The columns of a trajectory file after t, as balls: blocks q, w, p, v.
using CertifiedColumns = std::array<Ball, 13>;
CertifiedColumns columns_of(const Motion<Ball>& motion);

/// What an attempt at one precision came to.
struct CertifiedAttempt {
    std::string fault;                    ///< why it failed; empty if it did not
    bool hopeless = false;                ///< no precision gets over the fault
    double wanted_bits = 0;               ///< the precision to try next
    double most_bits = truth::most_bits;  ///< that all ways together can carry
    // the ways taken
    bool by_closed_form = false, by_series = false, by_parallelepiped = false, by_collocation = false;
    long steps = 0;
    std::vector<CertifiedColumns> columns;  ///< at each sample those of each body
};

/// log2 of the largest kappa along a motion, as a guide to the precision: where it is too low, that rises once more.
double kappa_bits(const Problem& problem);

/// The motions of a tree without loops at the thread's working precision, errors carried by parallelepipeds.
/// `least_bits`: what its digits take.
class TreeCertifier {
  public:
    /// The scene and the times outlive it.
    TreeCertifier(const Scene& scene, const std::vector<double>& times, double least_bits)
        : scene_(scene), times_(times), least_bits_(least_bits) {}
    CertifiedAttempt attempt();

  private:
    const Scene& scene_;
    const std::vector<double>& times_;
    double least_bits_;
    PiecePlan plan_;
    double lost_bits_ = 0;

    void make_plan();
};

}  // namespace polhode::truth
