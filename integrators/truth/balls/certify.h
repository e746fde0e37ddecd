// Types shared by the proofs for one body and for trees of bodies. Each attempt encloses the motion at one working
// precision and returns the precision that the next attempt needs.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/motion.h"
#include "motion/problem.h"

namespace polhode::truth {

// The cost of a series grows with the cube of the bits: beyond 3000 bits it takes hours. Closed forms stay fast.
constexpr double most_series_bits = 3000, most_bits = 32768;

/// The columns of a trajectory file after t as balls: blocks q, w, p, v.
using CertifiedColumns = std::array<Ball, 13>;
CertifiedColumns make_columns(const Motion<Ball>& motion);

/// Result of an attempt at one precision.
struct CertifiedAttempt {
    std::string fault;                    ///< why the attempt failed; empty if it succeeded
    bool hopeless = false;                ///< the failure cannot be fixed by more precision
    double wanted_bits = 0;               ///< precision to try next, bits
    double most_bits = truth::most_bits;  ///< highest precision that all methods used in this attempt support
    // methods used
    bool by_closed_form = false, by_series = false, by_parallelepiped = false, by_collocation = false;
    long steps = 0;
    std::vector<CertifiedColumns> columns;  ///< one row per sample and body
};

/// log2 of the largest kappa along the motion: an estimate for the precision. If it is too low, an attempt is repeated.
double kappa_bits(const Problem& problem);

/// Encloses the motion of a tree of bodies without loops at the thread's working precision. Parallelepipeds carry the
/// errors. `least_bits` is the precision that the requested digits require.
class TreeCertifier {
  public:
    /// The scene and the times must outlive this object.
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
