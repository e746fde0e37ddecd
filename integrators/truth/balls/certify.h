// Types shared by the proofs for one body, for trees of bodies, for formula loads and for spheres on planes. Each
// attempt encloses the motion at one working precision and returns the precision that the next attempt needs.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/motion.h"
#include "motion/contact.h"
#include "motion/problem.h"

namespace polhode::truth {

// The cost of a series grows with the cube of the bits: beyond 3000 bits it takes hours. Closed forms stay fast.
constexpr double most_series_bits = 3000, most_bits = 32768;

/// The columns of a trajectory file after t as balls: blocks q, w, p, v.
using CertifiedColumns = std::array<Ball, 13>;
CertifiedColumns make_columns(const Motion<Ball>& motion);

/// An event at a contact of a sphere with a plane.
struct EnclosedEvent {
    Ball t;             ///< s
    std::size_t plane;  ///< index of the plane
    const char* kind;   ///< as contact::event_names
};

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
    std::vector<EnclosedEvent> events{};    ///< in the order of time
};

/// log2 of the largest kappa along the motion: an estimate for the precision. If it is too low, an attempt is repeated.
double kappa_bits(const Problem& problem);

/// Encloses a motion whose equations are recorded as one tape, at the thread's working precision: trees of bodies
/// without loops, and formula loads without switching points. Parallelepipeds carry the errors. `least_bits` is the
/// precision that the requested digits require.
class TapeCertifier {
  public:
    /// The problem and the times must outlive this object.
    TapeCertifier(const Problem& problem, const std::vector<double>& times, double least_bits)
        : problem_(problem), times_(times), least_bits_(least_bits) {}
    CertifiedAttempt attempt();

  private:
    const Problem& problem_;
    const std::vector<double>& times_;
    double least_bits_;
    PiecePlan plan_;
    double lost_bits_ = 0;

    template <class Equations>
    void make_plan();
    template <class Equations>
    CertifiedAttempt attempt_with();
};

/// Encloses the motion of a uniform sphere on planes under constant gravity (contact_ball.cpp).
class SphereCertifier {
  public:
    /// The scene and the times must outlive this object.
    SphereCertifier(const Scene& scene, const std::vector<double>& times);
    CertifiedAttempt attempt();
    /// Why a scene of one body with planes is not supported; empty if it may be.
    static std::string refusal(const Scene& scene);

  private:
    using Vector = Vector3<Ball>;
    enum class Mode { flight, sliding, rolling };
    /// Constant acceleration of the centre (m/s^2) and of the rotation (rad/s^2, world axes).
    struct Path {
        Vector a, alpha;
    };
    /// The first plane that is reached, and when (s from now).
    struct Arrival {
        std::size_t plane;
        Ball time;
    };

    const Scene& scene_;
    const std::vector<double>& times_;
    std::size_t next_sample_ = 0;
    CertifiedAttempt result_;
    std::vector<ContactPlane<Ball>> planes_;
    Ball mass_, moment_, radius_;
    Vector gravity_;
    // the state at the time t_, world axes
    Ball t_;
    Vector x_, v_, w_;
    Quaternion<Ball> q_;
    Mode mode_ = Mode::flight;
    std::optional<std::size_t> plane_;    // in contact
    std::optional<std::size_t> touched_;  // the plane from which a flight starts
    Ball leaves_;                         // normal speed at the start of this flight, m/s
    Vector tangent_, foot_;               // velocity and position along that plane at the start of the flight
    Vector direction_;                    // unit vector along the slip; zero without friction
    bool sticks_ = false;                 // the last impact ended the slip

    void start();
    void follow_piece();
    void leave(std::size_t k, const Ball& normal, const Vector& along);
    void collide(std::size_t k, const Ball& u, const Vector& along, const Vector& slipping);
    void accumulate(std::size_t k, const Ball& u, const Ball& a);
    void stay_on(std::size_t k, bool no_slip);
    void move(const Ball& end, const Path& path);
    void add_sample(double sample, const Path& path);
    void place_on(std::size_t k);
    void ask_for_bits(const char* why);
    void end_hopelessly(const char* why);
    Path path() const;
    Ball gap(std::size_t k) const;
    Vector slip(std::size_t k) const;
    std::optional<Ball> closing_time(std::size_t k, const Vector& a);
    std::optional<Arrival> first_arrival(const Vector& a);
    std::optional<Ball> end_of_slip();
    std::optional<bool> is_before(double sample, const Ball& end);
};

}  // namespace polhode::truth
