#include <fmt/format.h>

#include <cmath>
#include <type_traits>
#include <utility>

#include "integrators/series/linear_algebra.h"
#include "integrators/truth/balls/ball_functions.h"
#include "integrators/truth/balls/certify.h"
#include "integrators/truth/balls/flow.h"
#include "integrators/truth/balls/jacobian_sampler.h"
#include "integrators/truth/formula_mechanism_form.h"
#include "integrators/truth/tree_form.h"
#include "motion/formula_mechanism.h"
#include "motion/itinerary.h"
#include "motion/mechanism.h"

namespace polhode::truth {

namespace {

// limit of count_coefficients(); each number takes about 50 bytes
constexpr double max_coefficients = 2e7;

// Weights that balance the rows and columns of the Jacobian (E. E. Osborne 1960): each variable then influences the
// others as much as they influence it. A stiff spring then rotates its coordinate and rate into each other, and its
// errors do not grow. `coupling` holds the magnitudes of the Jacobian's entries.
std::vector<double> balance_weights(const Eigen::MatrixXd& coupling, const std::vector<double>& scales) {
    constexpr int rounds = 20;
    // weaker influences over the run, relative to the scales, are rounding errors
    constexpr double least_influence = 1e-9;
    const auto n = coupling.rows();
    std::vector<double> unit(scales);
    const auto is_coupled = [&](Eigen::Index i, Eigen::Index j) {
        return i != j && coupling(i, j) * scales[static_cast<std::size_t>(j)] >
                             least_influence * scales[static_cast<std::size_t>(i)];
    };
    for (int round = 0; round < rounds; ++round)
        for (Eigen::Index i = 0; i < n; ++i) {
            double by_others = 0, of_others = 0;
            for (Eigen::Index j = 0; j < n; ++j) {
                if (is_coupled(i, j)) by_others += coupling(i, j) * unit[static_cast<std::size_t>(j)];
                if (is_coupled(j, i)) of_others += coupling(j, i) / unit[static_cast<std::size_t>(j)];
            }
            if (by_others > 0 && of_others > 0) unit[static_cast<std::size_t>(i)] = std::sqrt(by_others / of_others);
        }
    return unit;
}

/// Estimates how many numbers the variational equations of a tape hold: derivatives with respect to each variable, each
/// a sum of products, to the order that a precision of `bits` requires.
double count_coefficients(const Recording<Ball>& recording, double bits) {
    constexpr double products = 2, order_a_bit = 0.35;
    return products * static_cast<double>(recording.tape.nodes.size() * recording.rates.size()) * order_a_bit * bits;
}

// The equations that are recorded: their form over any scalar, and the blocks of its variables.
template <template <class> class TreeOf>
struct TreeEquations {
    template <class P>
    using Form = TreeOf<P>;
    static std::vector<Block> blocks(const Form<double>& form, const Problem& problem) {
        return form.blocks(problem.model()->scales());
    }
    static double link_count(const Form<double>& form) { return static_cast<double>(form.tree().links().links.size()); }
    static Motions<Ball> motions(const Form<Ball>& form, const Ball* y) {
        Motions<Ball> all = form.tree().motions(y);
        for (Motion<Ball>& body : all) body.q = normalized(body.q);
        return all;
    }
};

struct FormulaBodyEquations {
    template <class P>
    using Form = FormulaEulerForm<P>;
    static std::vector<Block> blocks(const Form<double>& form, const Problem& problem) {
        return form.blocks(problem.scales, {});
    }
    static double link_count(const Form<double>&) { return 1; }
    static Motions<Ball> motions(const Form<Ball>& form, const Ball* y) { return {form.motion(y)}; }
};

}  // namespace

template <class Equations>
void TapeCertifier::make_plan() {
    // per link: bits lost because bounds of a right-hand side use only the magnitude of each intermediate value
    constexpr double parallelepiped_bits = 24, bits_a_link = 6;
    using Form = typename Equations::template Form<double>;
    const Form form(problem_.scene);
    plan_.dimension = form.dimension();
    plan_.scales = problem_.model()->scales();
    plan_.blocks = Equations::blocks(form, problem_);
    const auto n = static_cast<std::size_t>(plan_.dimension);
    plan_.weights.assign(n * n, 0);
    JacobianSampler<Form> sampler(problem_.scene, plan_.blocks);
    Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(plan_.dimension, plan_.dimension);
    for (const Leg& leg : itinerary(problem_.scene))
        for (const JacobianSample& visit : sampler.visits(leg.begin, leg.end))
            coupling += visit.seconds * visit.J.cwiseAbs();
    if constexpr (requires { form.terms(); }) {
        // auxiliaries have any size
        const std::vector<double>& largest = sampler.largest();
        for (Block& block : plan_.blocks)
            if (block.first > form.time_index() && largest[block.first] > 0)
                block.scale = plan_.scales[block.first] = largest[block.first];
    }
    const std::vector<double> unit = balance_weights(coupling, plan_.scales);
    for (std::size_t i = 0; i < n; ++i) plan_.weights[i * n + i] = 1 / unit[i];
    lost_bits_ = parallelepiped_bits + bits_a_link * Equations::link_count(form) + kappa_bits(problem_);
}

CertifiedAttempt TapeCertifier::attempt() {
    switch (problem_.needs.system) {
        case SystemKind::mechanism_with_formulas:
            return attempt_with<TreeEquations<FormulaTreeForm>>();
        case SystemKind::body_with_formulas:
            return attempt_with<FormulaBodyEquations>();
        default:
            return attempt_with<TreeEquations<TreeForm>>();
    }
}

template <class Equations>
CertifiedAttempt TapeCertifier::attempt_with() try {
    CertifiedAttempt result;
    result.by_parallelepiped = true;
    result.most_bits = most_series_bits;
    const auto bits = static_cast<double>(Ball::precision());
    if (plan_.dimension == 0) make_plan<Equations>();
    if (least_bits_ + lost_bits_ > bits) {
        result.fault = "the precision is too low", result.wanted_bits = least_bits_ + lost_bits_;
        return result;
    }
    typename Equations::template Form<Ball> form(problem_.scene);
    std::vector<Ball> y(static_cast<std::size_t>(form.dimension()));
    form.initial(y.data());
    SampleQueue samples(times_);
    const auto store_state = [&](const std::vector<Ball>& state) {
        for (const Motion<Ball>& body : Equations::motions(form, state.data()))
            result.columns.push_back(make_columns(body));
        return true;
    };
    const auto enter = [&](const Leg& leg) {
        form.enter(leg.begin, y.data());
        if constexpr (requires { form.terms(); })
            for (const Ball& argument : form.terms().root_arguments(form.formula_state(y.data())))
                if (argument.is_zero()) {
                    result.fault =
                        fmt::format("a square root of the formulas (norm, unit, sqrt) is zero at t = {} s", leg.begin);
                    result.hopeless = true;
                    return false;
                }
        return true;
    };
    const std::vector<Leg> legs = itinerary(problem_.scene);
    follow(
        legs, samples, enter, [&](double) { return store_state(y); },
        [&](const Leg& leg) {
            Piece piece(record<Ball>(form, form.dimension()), leg.begin, leg.end, {});
            if (count_coefficients(piece.equations, bits - plan_.spare_bits) > max_coefficients) {
                result.fault = fmt::format("the error bounds of {} variables need too much memory", form.dimension());
                result.hopeless = true;
                return false;
            }
            for (; samples.in(leg); samples.pop()) piece.sample_times.push_back(samples.front());
            Enclosure enclosure = enclose_by_taylor(piece, plan_, y, Carry::parallelepiped);
            result.steps += enclosure.steps;
            result.fault = enclosure.fault, result.hopeless = enclosure.hopeless;
            if (!result.fault.empty()) {
                result.wanted_bits = 1.3 * bits + 64;
                if (enclosure.coarse) {
                    const double spare = 64 + plan_.spare_bits;
                    plan_.spare_bits += spare, result.wanted_bits = bits + spare;
                }
                return false;
            }
            for (const std::vector<Ball>& state : enclosure.samples) store_state(state);
            y = std::move(enclosure.end);
            return true;
        });
    return result;
} catch (const UndecidedSign&) {
    CertifiedAttempt result;
    result.fault = "the sign of a constant of the formulas is not decided";
    result.wanted_bits = 2 * static_cast<double>(Ball::precision());
    return result;
}

}  // namespace polhode::truth
