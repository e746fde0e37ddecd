// Conditioning of a mechanism, or of one body with formula loads, by its variational equation.
//
// Variation holds the state y and the columns S = dy/da of its derivative with respect to the initial state, and
// advances both by DOP853 with step control. Dual numbers give df/dy S, jacobian_directions columns per evaluation.
// Norms are taken in minimal coordinates (to_minimal_coordinates()). Above max_full_directions, initial_directions()
// mixes them at random. VariationRun advances it between samples, within the limits of the run.
#include "integrators/analysis/model_conditioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "integrators/analysis/spectral_norm.h"
#include "integrators/own/dormand_prince.h"
#include "integrators/run/processor_time.h"
#include "integrators/series/linear_algebra.h"
#include "motion/body_equations.h"
#include "motion/formula_mechanism.h"
#include "motion/itinerary.h"
#include "motion/mechanism.h"
#include "motion/user_system.h"
#include "text/interruption.h"

namespace polhode {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr int max_full_directions = 40, mixed_directions = 16;
constexpr double variation_tolerance = 1e-8;
// step of central differences: their truncation error is its square, their rounding error 1e-16 divided by it
constexpr double difference_step = 1e-5;
constexpr double max_prompt_steps = 20'000;

// The components of the state y, of which the time and the variables of formulas are no part.
struct StateParts {
    struct Part {
        bool is_attitude;  // a quaternion; else one number
        int first;         // in y
        bool is_angle = false;
    };
    std::vector<Part> coordinates, rates;

    explicit StateParts(const Problem& problem) {
        if (problem.needs.system == SystemKind::body_with_formulas) {
            const auto& [w, q, p, v] = BodyState::blocks;
            coordinates.push_back({true, q.first});
            for (int i = 0; i < 3; ++i) rates.push_back({false, w.first + i});
            if (problem.body.pivoted) return;
            for (int i = 0; i < 3; ++i) coordinates.push_back({false, p.first + i});
            for (int i = 0; i < 3; ++i) rates.push_back({false, v.first + i});
            return;
        }
        const Links<double>& links = tree_of(problem).links();
        for (const Link<double>& link : links.links) {
            int i = link.coordinate;
            if (link.kind == LinkJoint::spherical || link.kind == LinkJoint::free)
                coordinates.push_back({true, i}), i += 4;
            for (; i < link.coordinate + link.coordinates(); ++i)
                coordinates.push_back({false, i, link.kind == LinkJoint::revolute && i == link.coordinate});
        }
        for (int i = 0; i < links.rates; ++i) rates.push_back({false, links.coordinates + i});
    }

    // The number of minimal coordinates: as many as there are rates.
    Eigen::Index minimal() const { return static_cast<Eigen::Index>(rates.size()); }
    template <class Visit>
    void each(const Visit& visit) const {
        for (const Part& part : coordinates) visit(part);
        for (const Part& part : rates) visit(part);
    }
};

// The state y and the columns S = dy/da, advanced together.
class Variation {
  public:
    Variation(const Problem& problem) : parts_(problem), scales_(problem.model()->scales()), model_(problem.model()) {
        y_.resize(size());
        units_ = scales_;
        for (const StateParts::Part& part : parts_.coordinates)
            if (part.is_angle) units_[static_cast<std::size_t>(part.first)] = 1;
        model_->initial(y_.data());
        S_ = initial_directions();
    }

    int size() const { return model_->dimension(); }
    int columns() const { return static_cast<int>(S_.cols()); }
    bool mixed() const { return mixed_; }
    double step_work() const { return size() * std::ceil(static_cast<double>(columns()) / jacobian_directions); }

    // Processes an event: an impulse changes y, and S by its derivative.
    void enter(double t) {
        std::vector<double> y = y_;
        std::shared_ptr<const ErasedModel> next = model_->enter_event(t, y.data());
        if (!next) return;
        if (y != y_) {
            const Matrix before = S_;
            for (int c = 0; c < columns(); ++c)
                S_.col(c) = difference_along(before.col(c), [&](double* moved) { model_->enter_event(t, moved); });
        }
        y_ = std::move(y), model_ = std::move(next);
    }

    // Advances by at most h and sets h to the next step. Returns the time advanced, or 0 if the step was rejected.
    double step(double& h) {
        const int n = size(), m = columns();
        if (!(h > 0) || !std::isfinite(h)) return 0;
        const double done = h;
        std::vector<std::vector<double>> k(dop853_stages);
        std::vector<Matrix> K(dop853_stages);
        std::vector<double> y(y_.size());
        Matrix S(n, m);
        const auto sum = [&](const double* weights, int count, double from_y, std::vector<double>& into, Matrix& Into) {
            for (std::size_t i = 0; i < into.size(); ++i) {
                double slope = 0;
                for (int j = 0; j < count; ++j)
                    if (weights[j] != 0) slope += weights[j] * k[static_cast<std::size_t>(j)][i];
                into[i] = from_y * y_[i] + done * slope;
            }
            Into = from_y * S_;
            for (int j = 0; j < count; ++j)
                if (weights[j] != 0) Into += (done * weights[j]) * K[static_cast<std::size_t>(j)];
        };
        for (int i = 0; i < dop853_stages; ++i) {
            sum(dop853.a[i], i, 1, y, S);
            compute_rates(y, S, k[static_cast<std::size_t>(i)], K[static_cast<std::size_t>(i)]);
        }
        std::vector<double> change(y_.size());
        Matrix Change(n, m);
        sum(dop853.fifth_error, dop853_stages, 0, change, Change);
        const double error = change_norm(change, Change) / variation_tolerance;
        if (!std::isfinite(error)) {
            h /= 10;
            return 0;
        }
        h *= std::clamp(0.9 * std::pow(error, -1.0 / 6), 0.2, 5.0);
        if (error > 1) return 0;
        sum(dop853.b, dop853_stages, 1, y, S);
        y_ = y, S_ = S;
        if (model_->projects()) model_->project(y_.data());
        return done;
    }

    // || d state(t) / d state(0) ||, in minimal coordinates in units of their scales.
    double state_norm() const { return spectral_norm(to_minimal_coordinates(S_)); }

    // Norm of the attitude rows of the body with the largest response, rad.
    double attitude_norm() const {
        std::vector<Matrix> rotations;
        for (int c = 0; c < columns(); ++c) {
            // normalised by the coordinates alone: rates do not rotate anything, however large they are in their units
            const double size = to_minimal_coordinates(S_.col(c)).topRows(parts_.minimal()).norm();
            if (!(size > 0) || !std::isfinite(size)) continue;
            const Eigen::VectorXd along = S_.col(c) / size;
            const auto moved = [&](double by) {
                std::vector<double> y = y_;
                for (std::size_t i = 0; i < y.size(); ++i) y[i] += by * along[static_cast<Eigen::Index>(i)];
                return model_->motion(y.data());
            };
            const std::vector<Sample> ahead = moved(difference_step), behind = moved(-difference_step);
            rotations.resize(ahead.size(), Matrix::Zero(3, columns()));
            for (std::size_t b = 0; b < ahead.size(); ++b) {
                const Quaternion<double> r = conjugate(normalized(behind[b].q)) * normalized(ahead[b].q);
                const double to_rate = (r.w < 0 ? -2 : 2) * size / (2 * difference_step);
                rotations[b].col(c) << to_rate * r.x, to_rate * r.y, to_rate * r.z;
            }
        }
        double largest = 0;
        for (const Matrix& rotation : rotations) largest = std::max(largest, spectral_norm(rotation));
        return largest;
    }

  private:
    StateParts parts_;
    std::vector<double> scales_, units_;  // units_: the scales, but 1 rad for angles
    std::shared_ptr<const ErasedModel> model_;
    std::vector<double> y_;
    Matrix S_;
    bool mixed_ = false;

    static Quaternion<double> quaternion_at(const double* q) { return {q[0], q[1], q[2], q[3]}; }

    // Converts changes of y to minimal coordinates, in units of the scales.
    Matrix to_minimal_coordinates(const Matrix& changes) const {
        Matrix small(2 * parts_.minimal(), changes.cols());
        for (Eigen::Index c = 0; c < changes.cols(); ++c) {
            Eigen::Index row = 0;
            parts_.each([&](const StateParts::Part& part) {
                const int i = part.first;
                if (!part.is_attitude) {
                    small(row++, c) = changes(i, c) / units_[static_cast<std::size_t>(i)];
                    return;
                }
                const Quaternion<double> q = quaternion_at(y_.data() + i);
                const Quaternion<double> dq{changes(i, c), changes(i + 1, c), changes(i + 2, c), changes(i + 3, c)};
                const Quaternion<double> rotation = conjugate(q) * dq;
                const double to_angle = 2 / squared_norm(q);
                for (const double component : {rotation.x, rotation.y, rotation.z})
                    small(row++, c) = to_angle * component;
            });
        }
        return small;
    }

    // The changes of y for unit changes of each minimal coordinate.
    Matrix unit_changes() const {
        Matrix all = Matrix::Zero(size(), 2 * parts_.minimal());
        Eigen::Index column = 0;
        parts_.each([&](const StateParts::Part& part) {
            const int i = part.first;
            if (!part.is_attitude) {
                all(i, column++) = units_[static_cast<std::size_t>(i)];
                return;
            }
            const Quaternion<double> q = quaternion_at(y_.data() + i);
            for (int axis = 0; axis < 3; ++axis, ++column) {
                const Quaternion<double> half{0, axis == 0 ? 0.5 : 0, axis == 1 ? 0.5 : 0, axis == 2 ? 0.5 : 0};
                const Quaternion<double> dq = q * half;
                all(i, column) = dq.w, all(i + 1, column) = dq.x, all(i + 2, column) = dq.y, all(i + 3, column) = dq.z;
            }
        });
        return all;
    }

    // (F(y + h s) - F(y - h s)) / 2h, with s normalised to length 1
    template <class F>
    Eigen::VectorXd difference_along(const Eigen::VectorXd& s, const F& apply) const {
        const double length = to_minimal_coordinates(s).norm();
        if (!(length > 0)) return Eigen::VectorXd::Zero(s.size());
        std::vector<double> ahead = y_, behind = y_;
        for (std::size_t i = 0; i < ahead.size(); ++i) {
            const double by = difference_step / length * s[static_cast<Eigen::Index>(i)];
            ahead[i] += by, behind[i] -= by;
        }
        apply(ahead.data()), apply(behind.data());
        Eigen::VectorXd rate(s.size());
        for (std::size_t i = 0; i < ahead.size(); ++i)
            rate[static_cast<Eigen::Index>(i)] = (ahead[i] - behind[i]) / (2 * difference_step) * length;
        return rate;
    }

    // Orthonormal changes of the initial state in minimal coordinates that keep loops closed.
    Matrix initial_directions() {
        Matrix all = unit_changes();
        if (model_->projects())
            for (Eigen::Index c = 0; c < all.cols(); ++c)
                all.col(c) = difference_along(all.col(c), [&](double* y) { model_->project(y); });
        mixed_ = all.cols() > max_full_directions;
        if (mixed_) {
            std::mt19937_64 engine(1);
            Matrix mixture(all.cols(), mixed_directions);
            for (Eigen::Index i = 0; i < mixture.size(); ++i)
                mixture.data()[i] = static_cast<double>(engine() >> 11) * 0x1p-52 - 1;
            all = all * mixture;
        } else if (!model_->projects()) {
            return all;
        }
        const Eigen::JacobiSVD<Matrix> svd(to_minimal_coordinates(all), Eigen::ComputeThinU | Eigen::ComputeThinV);
        const Eigen::VectorXd& values = svd.singularValues();
        Eigen::Index rank = 0;
        while (rank < values.size() && values[rank] > 1e-6 * values[0]) ++rank;
        return all * svd.matrixV().leftCols(rank) * values.head(rank).cwiseInverse().asDiagonal();
    }

    void compute_rates(const std::vector<double>& y, const Matrix& S, std::vector<double>& dy, Matrix& dS) const {
        using D = Dual<jacobian_directions>;
        const int n = size(), m = columns();
        dy.resize(y.size()), dS.resize(n, m);
        std::vector<D> state(y.size()), slope(y.size());
        if (m == 0) model_->derivative(y.data(), dy.data());
        for (int first = 0; first < m; first += jacobian_directions) {
            const int last = std::min(m, first + jacobian_directions);
            for (int i = 0; i < n; ++i) {
                D& one = state[static_cast<std::size_t>(i)];
                one = D(y[static_cast<std::size_t>(i)]);
                for (int c = first; c < last; ++c) one.slope[static_cast<std::size_t>(c - first)] = S(i, c);
            }
            model_->derivative(state.data(), slope.data());
            for (int i = 0; i < n; ++i) {
                dy[static_cast<std::size_t>(i)] = slope[static_cast<std::size_t>(i)].value;
                for (int c = first; c < last; ++c)
                    dS(i, c) = slope[static_cast<std::size_t>(i)].slope[static_cast<std::size_t>(c - first)];
            }
        }
    }

    // Error norm: components relative to the scales, columns also relative to their length.
    double change_norm(const std::vector<double>& change, const Matrix& Change) const {
        double largest = 0;
        const auto include = [&](double size) { largest = size <= largest ? largest : size; };
        for (std::size_t i = 0; i < change.size(); ++i) include(std::abs(change[i]) / scales_[i]);
        for (int c = 0; c < columns(); ++c) {
            const double length = std::max(1.0, to_minimal_coordinates(S_.col(c)).norm());
            for (int i = 0; i < size(); ++i)
                include(std::abs(Change(i, c)) / (scales_[static_cast<std::size_t>(i)] * length));
        }
        return largest;
    }
};

/// The variational equation from one sample to the next, with the limits of a run. Functions return false if the run
/// must end; the message of `result` then has the reason.
class VariationRun {
  public:
    /// The arguments must outlive this object.
    VariationRun(const Problem& problem, const ConditioningSettings& settings, Conditioning& result)
        : settings_(settings),
          result_(result),
          variation_(problem),
          end_(processor_time() + settings.seconds_limit),
          max_steps_(std::min(static_cast<double>(settings.max_steps),
                              settings.max_steps <= prompt_conditioning_steps
                                  ? std::min(max_prompt_steps, settings.mechanism_work / variation_.step_work())
                                  : static_cast<double>(settings.max_steps))) {}

    const Variation& variation() const { return variation_; }
    double time() const { return t_; }

    void enter(const Segment& segment) {
        variation_.enter(segment.begin);
        t_ = segment.begin;
        if (h_ == 0) h_ = (segment.end - segment.begin) / 1000;
    }

    /// Records kappa at the current time, which is that of a sample up to rounding.
    bool record(double at) {
        const double state = variation_.state_norm(), attitude = variation_.attitude_norm();
        if (!std::isfinite(state) || !std::isfinite(attitude))
            return fail(fmt::format("kappa is beyond binary64 at t = {:g} s", at));
        result_.times.push_back(at), result_.state.push_back(state), result_.attitude.push_back(attitude);
        return true;
    }

    bool advance_to(double stop) {
        while (t_ < stop) {
            result_.limit_reached = static_cast<double>(++result_.steps) > max_steps_;
            if (result_.limit_reached)
                return fail(fmt::format("stopped at the limit of {:.0f} steps, at t = {:.4g} s", max_steps_, t_));
            if (Interruption::is_requested()) return fail("interrupted");
            if (processor_time() > end_)
                return fail(fmt::format("stopped at the limit of {} s", settings_.seconds_limit));
            const double remaining = stop - t_;
            const bool last = h_ >= remaining * (1 - 1e-14);
            double size = last ? remaining : h_;
            const double tried = size, done = variation_.step(size);
            if (done == 0) {
                h_ = size;
                if (!(h_ > 0) || t_ + h_ == t_)
                    return fail(fmt::format(
                        "step size below the spacing of numbers at t = {:g} s in the variational equation", t_));
                continue;
            }
            t_ = last ? stop : t_ + done;
            h_ = last && tried < h_ ? std::max(h_, size) : size;
        }
        return true;
    }

  private:
    bool fail(std::string message) {
        result_.message = std::move(message);
        return false;
    }

    const ConditioningSettings& settings_;
    Conditioning& result_;
    Variation variation_;
    double end_;  // s, processor time
    double max_steps_;
    double t_ = 0, h_ = 0;  // s
};

}  // namespace

Conditioning model_conditioning(const Problem& problem, const std::vector<double>& times,
                                const ConditioningSettings& settings) {
    Conditioning result;
    VariationRun run(problem, settings, result);
    SampleQueue samples(times);
    const auto enter = [&](const Segment& segment) {
        if (samples.empty()) return false;
        run.enter(segment);
        return true;
    };
    const auto record = [&](double at) { return run.record(at); };
    const auto integrate = [&](const Segment& segment) {
        while (run.time() < segment.end && !samples.empty()) {
            if (!run.advance_to(std::min(segment.end, std::max(samples.front(), run.time())))) return false;
            for (; samples.due(segment, run.time()); samples.pop())
                if (!run.record(samples.front())) return false;
        }
        return true;
    };
    follow(problem.segments, samples, enter, record, integrate);
    result.available = samples.empty();
    if (!result.available) return result;
    const Variation& variation = run.variation();
    result.message = fmt::format(
        "variational equation solved by DOP853 with dual numbers, {} directions{}, {} steps", variation.columns(),
        variation.mixed() ? " (random combinations: kappa is a lower bound)" : "", result.steps);
    return result;
}

}  // namespace polhode
