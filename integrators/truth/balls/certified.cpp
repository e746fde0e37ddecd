// Computes certified reference solutions: every number is enclosed by a ball with a proven radius.
//
// certified_reference() repeats attempts at increasing working precision until all radii meet the requested digits. An
// attempt that fails returns the precision to try next (CertifiedAttempt::wanted_bits). Certifier encloses one body;
// TapeCertifier (certify_tape.cpp) encloses trees of bodies and formula loads. Certifier follows the motion from event
// to event (Piece) and encloses each piece by the first applicable method:
//   closed form          no torque (closed_form.cpp); a sphere on planes (contact_ball.cpp, SphereCertifier)
//   collocation          strongly damped pieces (collocation.cpp)
//   Taylor series        errors carried by the logarithmic norm or by parallelepipeds (taylor.cpp, parallelepiped.cpp)
// Route holds this choice and a plan computed in double precision. The plan affects cost only, not the proof.
#include "integrators/truth/balls/certified.h"

#include <arb.h>
#include <flint/flint.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "integrators/analysis/conditioning.h"
#include "integrators/contact/joint_events.h"
#include "integrators/truth/allowance.h"
#include "integrators/truth/balls/ball_decimal.h"
#include "integrators/truth/balls/certify.h"
#include "integrators/truth/balls/flow.h"
#include "integrators/truth/strong_damping.h"
#include "motion/formula_model.h"
#include "motion/problem.h"
#include "scene/plane_file.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "text/content_hash.h"

namespace polhode {
namespace {

using truth::Ball;
using truth::Bound;
using truth::Carry;
using truth::CertifiedAttempt;
using truth::CertifiedColumns;
using truth::Enclosure;
using truth::EulerForm;
using truth::most_bits;
using truth::most_series_bits;
using truth::Piece;
using truth::PiecePlan;

constexpr double bits_per_digit = 3.3219280948873623;
constexpr double spare_bits = 40;
// Number of known bits of the largest entry of the tensor's inverse; 0 if the inverse is not known to exist.
double known_bits(const Matrix3<Ball>& inertia) {
    const Matrix3<Ball> inverted = inverse(inertia);
    double size = -std::numeric_limits<double>::infinity(), radius = size;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            if (!inverted[i][j].is_finite()) return 0;
            size = std::max(size, inverted[i][j].log2_near());
            radius = std::max(radius, Bound::radius_of(inverted[i][j]).log2_near());
        }
    return size - radius;
}

constexpr int block_start[] = {0, 4, 7, 10, 13};

// Encloses the motion of one body, at increasing precision.
class Certifier {
  public:
    Certifier(const Scene& scene, const std::vector<double>& times, double least_bits)
        : scene_(scene), times_(times), legs_(itinerary(scene)), least_bits_(least_bits) {}

    /// Encloses the motion at the thread's working precision, piece by piece.
    CertifiedAttempt attempt() {
        CertifiedAttempt result;
        EulerForm<Ball> form(scene_);
        // a tensor whose digits cancel requires more bits, whatever the motion requires
        if (const double known = known_bits(form.body().inertia_B); known < least_bits_ - spare_bits) {
            const auto bits = static_cast<double>(Ball::precision());
            result.fault = "cancellation in the inertia tensor";
            result.wanted_bits = known > 0 ? bits + least_bits_ - known : 2 * bits;
            return result;
        }
        std::vector<Ball> y(form.dimension());
        form.initial(y.data());
        SampleQueue samples(times_);
        const auto enter = [&](const Leg& leg) {
            form.enter(leg.begin, y.data());
            return true;
        };
        const auto show = [&](double) {
            result.columns.push_back(truth::make_columns(form.motion(y.data())));
            return true;
        };
        follow(legs_, samples, enter, show, [&](const Leg& leg) {
            Piece piece(form, leg.begin, leg.end, {});
            for (; samples.in(leg); samples.pop()) piece.sample_times.push_back(samples.front());
            Enclosure enclosure = enclose_piece(piece, leg.index, y, result);
            if (!result.fault.empty()) return false;
            result.steps += enclosure.steps;
            for (const std::vector<Ball>& state : enclosure.samples)
                result.columns.push_back(truth::make_columns(form.motion(state.data())));
            y = std::move(enclosure.end);
            return true;
        });
        return result;
    }

  private:
    // How a piece is enclosed by polynomials, if no closed form encloses it.
    struct Route {
        PiecePlan plan;
        bool closed = false;        ///< the piece has a closed form; the balls may be too wide to evaluate it
        Carry carry = Carry::norm;  ///< how errors are carried unless the piece is strongly damped

        bool strongly_damped() const { return plan.damping_number > truth::strong_damping_number; }
    };

    const Scene& scene_;
    const std::vector<double>& times_;
    std::vector<Leg> legs_;
    double least_bits_;
    std::vector<Route> routes_;    // computed on first use
    double sensitivity_bits_ = 0;  // bits lost by parallelepipeds
    // accumulated over the pieces that were reached so far and have no usable closed form
    double growth_ = 0, spread_ = 0;
    bool sheared_ = false;
    std::size_t reached_count_ = 0;

    // Selects how each piece carries its errors. Parallelepipeds make a step about twice as expensive (measured). They
    // pay off where the logarithmic norm would require 1.4 times the bits.
    void find_routes() {
        constexpr double least_growth = 16;  // bits; below this the norm is sufficient in any case
        const Problem problem = pose(scene_);
        EulerForm<Ball> form(scene_);
        std::vector<Ball> unused(form.dimension());
        form.initial(unused.data());
        double growth = 0, spread = 0;
        for (PiecePlan& plan : truth::plan_pieces(problem)) {
            form.enter(legs_[routes_.size()].begin, unused.data());
            const bool closed = truth::has_closed_form(form.forcing());
            if (!closed) growth += plan.growth_bits, spread = std::max(spread, plan.spread_bits);
            routes_.push_back({std::move(plan), closed, Carry::norm});
        }
        const auto is_expensive = [&](double growth_bits, double spread_bits) {
            return least_bits_ + growth_bits + spread_bits > 1.4 * (least_bits_ + sensitivity_bits_ + spread_bits);
        };
        const auto choose = [&] {
            const bool all_expensive = is_expensive(growth, spread);
            bool any = false;
            for (Route& route : routes_) {
                const double own = route.plan.growth_bits;
                const bool expensive =
                    route.closed ? is_expensive(own, route.plan.spread_bits) : all_expensive && own > least_growth;
                route.carry = expensive ? Carry::parallelepiped : Carry::norm;
                any = any || expensive;
            }
            return any;
        };
        // A minimum loss of 24 bits decides most scenes. Only the others compute kappa, a numerical solution.
        sensitivity_bits_ = 24;
        if (!choose()) return;
        sensitivity_bits_ += truth::kappa_bits(problem);
        choose();
    }

    Enclosure enclose_piece(const Piece& piece, std::size_t index, const std::vector<Ball>& y,
                            CertifiedAttempt& result) {
        const auto bits = static_cast<double>(Ball::precision());
        const bool closed = truth::has_closed_form(piece.body->forcing());
        if (closed) {
            Enclosure enclosure = truth::enclose_by_closed_form(piece, y);
            if (enclosure.fault.empty()) {
                result.by_closed_form = true;
                return enclosure;
            }
        }
        if (routes_.empty()) find_routes();
        const Route& route = routes_[index];
        const bool damped = route.strongly_damped(), sheared = !damped && route.carry == Carry::parallelepiped;
        if (index >= reached_count_) {
            reached_count_ = index + 1;
            if (sheared)
                sheared_ = true;
            else
                growth_ += route.plan.growth_bits;
            spread_ = std::max(spread_, route.plan.spread_bits);
        }
        const double wanted = least_bits_ + growth_ + (sheared_ ? sensitivity_bits_ : 0) + spread_;
        if (closed && wanted > most_series_bits) {
            result.fault = "the precision does not resolve the side of the separatrix", result.wanted_bits = 2 * bits;
            return {};
        }
        (damped ? result.by_collocation : sheared ? result.by_parallelepiped : result.by_series) = true;
        result.most_bits = std::min(result.most_bits, damped ? truth::most_collocation_bits : most_series_bits);
        if (wanted > bits || bits > result.most_bits) {
            result.fault = "the precision is too low", result.wanted_bits = std::max(wanted, bits);
            return {};
        }
        Enclosure enclosure = damped ? truth::enclose_by_collocation(scene_, piece, route.plan, y)
                                     : truth::enclose_by_taylor(piece, route.plan, y, route.carry);
        if (!enclosure.fault.empty())
            result.fault = enclosure.fault, result.hopeless = enclosure.hopeless, result.wanted_bits = 1.3 * bits + 64;
        return enclosure;
    }
};

// The largest length of each block over the run; 1 if it is not proven to be positive.
std::array<Ball, 4> block_sizes(const std::vector<CertifiedColumns>& all) {
    std::array<Ball, 4> sizes;
    for (int b = 0; b < 4; ++b) {
        for (const CertifiedColumns& columns : all) {
            Ball sum;
            for (int c = block_start[b]; c < block_start[b + 1]; ++c) sum += columns[c] * columns[c];
            if (arb_gt(sum.raw(), sizes[b].raw())) sizes[b] = std::move(sum);
        }
        sizes[b] = sizes[b].is_positive() ? sqrt(sizes[b]) : Ball(1);
    }
    return sizes;
}

// The largest number of digits d for which error <= 10^-d size is proven.
int proven_digits(const Bound& error, const Ball& size) {
    const truth::WorkingPrecision precision(128);
    int digits = static_cast<int>(std::floor((size.log2_near() - error.log2_near()) / bits_per_digit)) + 1;
    for (;; --digits) {
        Ball power, scaled = error.ball();
        arb_ui_pow_ui(power.raw(), 10, static_cast<ulong>(std::abs(digits)), Ball::precision());
        if (digits < 0)
            scaled /= power;
        else
            scaled *= power;
        if (arb_le(scaled.raw(), size.raw())) return digits;
    }
}

// log2 of the allowed radius for `digits` proven digits in a block of this size: min(1, size) 10^-digits.
double allowed_log2(const Ball& size, int digits) { return -digits * bits_per_digit + std::min(size.log2_near(), 0.0); }

void write_columns(const std::vector<CertifiedColumns>& all, int digits, CertifiedReference& result) {
    const std::array<Ball, 4> sizes = block_sizes(all);
    Bound largest;
    result.digits = digits;
    bool any = false;
    for (const CertifiedColumns& columns : all) {
        result.columns.emplace_back();
        Bound widest;
        for (int b = 0; b < 4; ++b)
            for (int c = block_start[b]; c < block_start[b + 1]; ++c) {
                const double allowed = allowed_log2(sizes[b], digits) / bits_per_digit;
                const double radius = Bound::radius_of(columns[c]).log2_near() / bits_per_digit;
                // rounded at the leading digit of the radius, or three digits below the allowed radius
                const long place = static_cast<long>(std::floor(std::max(radius, allowed - 3))) - 1;
                CertifiedNumber& number = result.columns.back()[c];
                Bound error;
                number.value = truth::decimal_near(columns[c], place, error);
                number.radius = truth::decimal_above(error);
                number.digits = digits;
                if (error.is_zero()) continue;
                number.digits = proven_digits(error, sizes[b]);
                result.digits = any ? std::min(result.digits, number.digits) : number.digits;
                any = true;
                if (widest < error) widest = error;
            }
        result.bounds.push_back(truth::decimal_above(widest));
        if (largest < widest) largest = widest;
    }
    result.radius = truth::decimal_above(largest);
}

// log2 of the largest ratio of a radius to the allowed radius
double excess_bits(const std::vector<CertifiedColumns>& all, int digits) {
    const std::array<Ball, 4> sizes = block_sizes(all);
    double worst = -std::numeric_limits<double>::infinity();
    for (const CertifiedColumns& columns : all)
        for (int b = 0; b < 4; ++b)
            for (int c = block_start[b]; c < block_start[b + 1]; ++c) {
                if (!columns[c].is_finite()) return std::numeric_limits<double>::infinity();
                worst = std::max(worst, Bound::radius_of(columns[c]).log2_near() - allowed_log2(sizes[b], digits));
            }
    return worst;
}

// Throws std::invalid_argument for arguments out of range.
void require_valid(const Scene& scene, const std::vector<double>& times, int digits) {
    if (times.empty()) throw std::invalid_argument("no times given");
    for (std::size_t i = 0; i < times.size(); ++i)
        if (!(times[i] >= 0 && times[i] <= scene.duration && (i == 0 || times[i] > times[i - 1])))
            throw std::invalid_argument("times must increase and lie between 0 and the scene's duration");
    if (digits < 1) throw std::invalid_argument("the number of digits must be at least 1");
}

// Why the scene has no certified reference; empty if it may have one.
std::string certification_refusal(const Problem& problem) {
    const Scene& scene = problem.scene;
    for (const Load& load : scene.loads)
        if (std::holds_alternative<UserTorque>(load))
            return "no certified truth: user-defined torques are not supported";
    if (has_formula_loads(scene) && has_switches(problem))
        return "no certified truth: formulas that switch (abs, min, if, tables) are not supported; remove --certified";
    if (has_formula_loads(scene) && !scene.planes.empty())
        return "no certified truth: formulas together with planes are not supported; remove --certified";
    if (!scene.couplings.empty()) return "no certified truth: couplings are not supported; remove --certified";
    if (contact::has_joint_events(scene))
        return "no certified truth: friction, limits and prescribed motions of joints are not supported; remove "
               "--certified";
    if (!scene.loops.empty()) return "no certified truth: loops are not supported; remove --certified";
    if (!scene.contacts.empty()) return "no certified truth: contacts of bodies are not supported; remove --certified";
    if (scene.planes.empty()) return "";
    const std::string why = truth::SphereCertifier::refusal(scene);
    return why.empty() ? "" : "no certified truth: " + why + "; remove --certified";
}

// The events of a run with their times to `digits` digits, or as many as are proven.
std::vector<CertifiedEvent> write_events(const Scene& scene, const std::vector<truth::EnclosedEvent>& events,
                                         int digits) {
    std::vector<CertifiedEvent> written;
    for (const truth::EnclosedEvent& event : events) {
        CertifiedEvent& one = written.emplace_back();
        one.kind = event.kind, one.plane = plane_name(scene, event.plane);
        const double radius = Bound::radius_of(event.t).log2_near() / bits_per_digit;
        Bound error;
        one.t.value =
            truth::decimal_near(event.t, static_cast<long>(std::floor(std::max(radius, -digits - 3.0))) - 1, error);
        one.t.radius = truth::decimal_above(error);
        one.t.digits = error.is_zero() ? digits : proven_digits(error, Ball(1));
    }
    return written;
}

// Names the methods that enclosed the motion, separated by semicolons.
std::string name_methods(const CertifiedAttempt& attempt) {
    std::string names;
    const auto add = [&](bool used, const char* method) {
        if (used) names += (names.empty() ? "" : "; ") + std::string(method);
    };
    add(attempt.by_closed_form, "closed form");
    add(attempt.by_series, "Taylor series with a proven defect, errors propagated by the logarithmic norm");
    add(attempt.by_parallelepiped, "Taylor series with a proven defect, errors propagated by parallelepipeds");
    add(attempt.by_collocation, "collocation with a proven defect, errors propagated by the logarithmic norm");
    return names;
}

// End of a search over working precisions.
struct PrecisionSearch {
    double bits;                    ///< precision that the next attempt would need
    double limit = most_bits;       ///< highest precision that all methods used support
    std::string permanent_failure;  ///< a failure that no precision fixes; empty if there was none
};

// Repeats attempts at increasing precision until all radii are as small as requested, and sets the result.
template <class AttemptFunction>
PrecisionSearch search_precision(const Scene& scene, const AttemptFunction& make_attempt, double least_bits, int digits,
                                 CertifiedReference& result) {
    PrecisionSearch search{least_bits, most_bits, {}};
    while (search.bits <= search.limit) {
        result.working_bits = (static_cast<long>(std::ceil(search.bits)) + 31) / 32 * 32;
        const truth::WorkingPrecision precision(result.working_bits);
        const CertifiedAttempt attempt = make_attempt();
        if (truth::Allowance::is_spent()) break;
        search.limit = std::min(search.limit, attempt.most_bits);
        if (attempt.hopeless) {
            search.permanent_failure = attempt.fault;
            break;
        }
        if (!attempt.fault.empty()) {
            search.bits = std::max(attempt.wanted_bits, static_cast<double>(result.working_bits + 1));
            continue;
        }
        // rounding to decimals may increase the radius by half; one more bit covers it
        const double excess = excess_bits(attempt.columns, digits) + 1;
        if (excess > 0) {
            search.bits = static_cast<double>(result.working_bits) +
                          std::min(excess, static_cast<double>(result.working_bits)) + 16;
            continue;
        }
        result.available = true;
        result.steps = attempt.steps;
        write_columns(attempt.columns, digits, result);
        result.events = write_events(scene, attempt.events, digits);
        result.method = name_methods(attempt);
        break;
    }
    return search;
}

// The message of a result after the search.
std::string describe_result(const CertifiedReference& result, const PrecisionSearch& search, int digits,
                            double seconds_limit) {
    if (result.available) return fmt::format("{}, {} bits", result.method, result.working_bits);
    if (truth::Allowance::is_spent()) return fmt::format("no certified truth within the limit of {} s", seconds_limit);
    if (!search.permanent_failure.empty()) return "no certified truth: " + search.permanent_failure;
    // 64 bits of margin for what a further attempt may find missing
    const double available_digits = std::floor(digits - (search.bits - search.limit + 64) / bits_per_digit);
    return available_digits < 1
               ? fmt::format("no certified truth: this motion loses all digits at {} bits", search.limit)
               : fmt::format("no certified truth to {} digits: {} digits are available", digits, available_digits);
}

}  // namespace

CertifiedColumns truth::make_columns(const Motion<Ball>& m) {
    const Vector3<Ball> w = rotate(m.q, m.angular_velocity_B);
    return {
        m.q.w,           m.q.x,           m.q.y,           m.q.z,           w[0],           w[1], w[2], m.position_W[0],
        m.position_W[1], m.position_W[2], m.velocity_W[0], m.velocity_W[1], m.velocity_W[2]};
}

double truth::kappa_bits(const Problem& problem) {
    constexpr int times = 32;
    constexpr double unknown = 64;
    ConditioningSettings settings;
    settings.max_steps = prompt_conditioning_steps;
    settings.seconds_limit = Allowance::left();
    const Conditioning found = conditioning(problem, sample_times(problem.scene.duration, times), settings);
    return found.available ? std::log2(std::max(1.0, found.state_peak().value)) : unknown;
}

CertifiedReference certified_reference(const Scene& scene, long samples, int digits, double seconds_limit) {
    if (samples < 1) throw std::invalid_argument("the number of samples must be at least 1");
    return certified_reference(scene, sample_times(scene.duration, samples), digits, seconds_limit);
}

CertifiedReference certified_reference(const Scene& scene, const std::vector<double>& times, int digits,
                                       double seconds_limit) {
    require_valid(scene, times, digits);
    validate(scene, scene.name);
    CertifiedReference result;
    result.requested_digits = digits;
    const Problem problem = pose(scene);
    result.message = certification_refusal(problem);
    if (!result.message.empty()) return result;
    result.scene_hash = content_hash(write_scene(scene));
    const auto start = std::chrono::steady_clock::now();
    result.times = times;

    const truth::Allowance allowance(seconds_limit);
    const double least_bits = digits * bits_per_digit + spare_bits;
    Certifier certifier(scene, result.times, least_bits);
    truth::TapeCertifier tape_certifier(problem, result.times, least_bits);
    const bool by_tape = !std::holds_alternative<OneBody>(problem.system);
    result.bodies = static_cast<int>(body_count(scene));
    truth::SphereCertifier sphere_certifier(scene, result.times);
    const PrecisionSearch search = search_precision(
        scene,
        [&] {
            if (!scene.planes.empty()) return sphere_certifier.attempt();
            return by_tape ? tape_certifier.attempt() : certifier.attempt();
        },
        least_bits, digits, result);
    flint_cleanup();
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!result.available) result.times.clear();
    result.message = describe_result(result, search, digits, seconds_limit);
    return result;
}

std::string ball_arithmetic_version() { return fmt::format("{} (FLINT {})", arb_version, FLINT_VERSION); }

}  // namespace polhode
