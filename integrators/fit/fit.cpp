#include "integrators/fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <utility>

#include "body/algebra.h"
#include "body/mass_properties.h"
#include "integrators/fit/scene_sensitivities.h"
#include "integrators/series/levenberg_marquardt.h"
#include "text/message.h"

namespace polhode {
namespace {

// One evaluation: motion minus data and its derivatives by the numbers, in units of the columns.
struct FitResiduals {
    Eigen::VectorXd residuals;
    Eigen::MatrixXd slopes;
};

// Value of a measured component and its derivatives. The derivatives of a body come as those of the rotation vector
// (world axes), w, p and v: w_B = R^T w, and dR = d x R, so that dw_B = R^T (dw - d x w) and dq = (0, d) q / 2.
class MeasuredComponent {
  public:
    MeasuredComponent(const Sample& sample, const double* derivatives, std::size_t parameters, const FitColumn& column)
        : q_(normalized(sample.q)),
          w_(angular_velocity_W(sample)),
          sample_(sample),
          derivatives_(derivatives),
          parameters_(parameters),
          column_(column) {}

    double value() const {
        const std::size_t k = column_.component;
        switch (column_.quantity) {
            case FitQuantity::attitude:
                return components(q_)[k];
            case FitQuantity::angular_velocity_W:
                return w_[axis()];
            case FitQuantity::angular_velocity_B:
                return rotate(conjugate(q_), w_)[axis()];
            case FitQuantity::position_W:
                return sample_.position_W[axis()];
            case FitQuantity::velocity_W:
                return sample_.velocity_W[axis()];
        }
        return 0;
    }

    double slope(std::size_t parameter) const {
        const Vector3<double> turn = vector(0, parameter);
        switch (column_.quantity) {
            case FitQuantity::attitude: {
                const Quaternion<double> dq = Quaternion<double>{0, turn[0], turn[1], turn[2]} * q_;
                return components(dq)[column_.component] / 2;
            }
            case FitQuantity::angular_velocity_W:
                return vector(3, parameter)[axis()];
            case FitQuantity::angular_velocity_B:
                return rotate(conjugate(q_), vector(3, parameter) - cross(turn, w_))[axis()];
            case FitQuantity::position_W:
                return vector(6, parameter)[axis()];
            case FitQuantity::velocity_W:
                return vector(9, parameter)[axis()];
        }
        return 0;
    }

  private:
    static std::array<double, 4> components(const Quaternion<double>& q) { return {q.w, q.x, q.y, q.z}; }
    int axis() const { return static_cast<int>(column_.component); }
    Vector3<double> vector(std::size_t first, std::size_t parameter) const {
        const auto at = [&](std::size_t k) { return derivatives_[(first + k) * parameters_ + parameter]; };
        return {at(0), at(1), at(2)};
    }

    Quaternion<double> q_;
    Vector3<double> w_;
    const Sample& sample_;
    const double* derivatives_;
    std::size_t parameters_;
    const FitColumn& column_;
};

// Evaluates the residuals of the fit for numbers in units of their sizes. Its types and operators are those that
// Eigen's LevenbergMarquardt requires.
class FitProblem : public Eigen::DenseFunctor<double> {
  public:
    FitProblem(const SceneNumbers& scene, const std::vector<std::string>& pointers, const FitData& data,
               const FitSettings& settings)
        : DenseFunctor(static_cast<int>(pointers.size()), static_cast<int>(data.values.size())),
          scene_(scene),
          pointers_(pointers),
          data_(data),
          settings_(settings) {
        for (const std::string& pointer : pointers) {
            const double value = scene.number(pointer);
            start_.push_back(value);
            sizes_.push_back(value != 0 ? std::abs(value) : scene.scale(pointer));
        }
    }

    Eigen::VectorXd start() const {
        Eigen::VectorXd x(inputs());
        for (int i = 0; i < inputs(); ++i) x[i] = start_[at(i)] / sizes_[at(i)];
        return x;
    }

    std::vector<double> numbers(const Eigen::VectorXd& x) const {
        std::vector<double> values;
        for (int i = 0; i < inputs(); ++i) values.push_back(x[i] * sizes_[at(i)]);
        return values;
    }

    // the evaluation at x, or nothing if it failed: fault() says why
    const FitResiduals* evaluate(const Eigen::VectorXd& x) {
        if (last_ && last_->first == x) return &last_->second;
        last_.reset();
        fault_.clear();
        if (++evaluations_ > settings_.max_evaluations) {
            fault_ = fmt::format("no convergence in {} evaluations", settings_.max_evaluations);
            return nullptr;
        }
        try {
            last_.emplace(x, residuals_at(numbers(x)));
        } catch (const InputError& error) {
            fault_ = error.what();
        }
        return last_ ? &last_->second : nullptr;
    }

    int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& weighted) {
        if (evaluations_ >= settings_.max_evaluations) return -1;
        if (const FitResiduals* found = evaluate(x)) {
            weighted = found->residuals;
            for (Eigen::Index i = 0; i < weighted.size(); ++i) weighted[i] /= deviation(i);
            largest_ = std::max(largest_, weighted.cwiseAbs().maxCoeff());
        } else {
            // numbers that no body has: the iteration takes a smaller step
            constexpr double refused = 1e3;
            weighted.setConstant(values(), refused * (1 + largest_));
        }
        return 0;
    }

    int df(const Eigen::VectorXd& x, Eigen::MatrixXd& slopes) {
        const FitResiduals* found = evaluate(x);
        if (!found) return -1;
        slopes = found->slopes;
        for (Eigen::Index i = 0; i < slopes.rows(); ++i) slopes.row(i) /= deviation(i);
        for (Eigen::Index k = 0; k < slopes.cols(); ++k) slopes.col(k) *= sizes_[at(k)];
        return 0;
    }

    const std::string& fault() const { return fault_; }
    int evaluations() const { return evaluations_; }
    double size(Eigen::Index i) const { return sizes_[at(i)]; }

  private:
    static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

    double deviation(Eigen::Index row) const {
        return settings_.deviations.empty() ? 1 : settings_.deviations[at(row) % data_.columns.size()];
    }

    FitResiduals residuals_at(const std::vector<double>& numbers) const {
        std::vector<SceneChange> changes;
        for (std::size_t i = 0; i < pointers_.size(); ++i) changes.push_back(change(numbers, i));
        Scene scene = scene_.replace(pointers_, numbers);
        scene.duration = std::max(scene.duration, data_.times.back());
        SensitivitySettings settings;
        settings.tolerance = settings_.tolerance, settings.seconds_limit = settings_.seconds_limit;
        const Sensitivities found = scene_sensitivities(scene, changes, data_.times, settings);
        if (found.status != Status::ok)
            throw InputError(scene.name, "", "the derivatives cannot be computed", found.message);
        return compare(found);
    }

    // the scene with one number slightly larger and smaller
    SceneChange change(const std::vector<double>& numbers, std::size_t i) const {
        constexpr int digits = 42;  // the difference is 2^-42 of the number's size
        const double by = std::ldexp(1, std::ilogb(std::max(std::abs(numbers[i]), sizes_[i])) - digits);
        std::vector<double> ahead = numbers, behind = numbers;
        ahead[i] += by, behind[i] -= by;
        SceneChange change{scene_.replace(pointers_, ahead), scene_.replace(pointers_, behind), ahead[i] - behind[i]};
        change.ahead.duration = change.behind.duration = std::max(change.ahead.duration, data_.times.back());
        return change;
    }

    FitResiduals compare(const Sensitivities& found) const {
        FitResiduals result;
        result.residuals.resize(values());
        result.slopes.resize(values(), inputs());
        const std::size_t columns = data_.columns.size();
        for (std::size_t t = 0; t < data_.times.size(); ++t)
            for (std::size_t c = 0; c < columns; ++c) {
                const FitColumn& column = data_.columns[c];
                const std::size_t row = t * static_cast<std::size_t>(found.bodies) + column.body;
                const MeasuredComponent component(
                    found.samples[row], &found.derivatives[row * Sensitivities::quantities * found.parameters],
                    found.parameters, column);
                const double sign = sign_of(found, t, column);
                const auto i = static_cast<Eigen::Index>(t * columns + c);
                result.residuals[i] = sign * component.value() - data_.values[t * columns + c];
                for (std::size_t k = 0; k < found.parameters; ++k)
                    result.slopes(i, static_cast<Eigen::Index>(k)) = sign * component.slope(k);
            }
        return result;
    }

    // q and -q are the same attitude: -1 if the measured components of the quaternion are nearer to -q
    double sign_of(const Sensitivities& found, std::size_t t, const FitColumn& of) const {
        if (of.quantity != FitQuantity::attitude) return 1;
        double product = 0;
        const Quaternion<double>& q = found.samples[t * static_cast<std::size_t>(found.bodies) + of.body].q;
        const std::array<double, 4> components{q.w, q.x, q.y, q.z};
        for (std::size_t c = 0; c < data_.columns.size(); ++c)
            if (data_.columns[c].quantity == FitQuantity::attitude && data_.columns[c].body == of.body)
                product += data_.values[t * data_.columns.size() + c] * components[data_.columns[c].component];
        return product < 0 ? -1 : 1;
    }

    const SceneNumbers& scene_;
    const std::vector<std::string>& pointers_;
    const FitData& data_;
    const FitSettings& settings_;
    std::vector<double> start_, sizes_;
    std::optional<std::pair<Eigen::VectorXd, FitResiduals>> last_;
    std::string fault_;
    int evaluations_ = 0;
    double largest_ = 0;
};

// Returns the relative change of the numbers that the data do not determine; empty if they determine all.
std::string undetermined(const Eigen::MatrixXd& slopes, const std::vector<std::string>& pointers) {
    const Eigen::VectorXd lengths = slopes.colwise().norm();
    for (Eigen::Index k = 0; k < lengths.size(); ++k)
        if (!(lengths[k] > 0))
            return "the data do not depend on " + one_line(pointers[static_cast<std::size_t>(k)], 80);
    const Eigen::MatrixXd scaled = slopes * lengths.cwiseInverse().asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinV);
    constexpr double smallest = 1e-7;  // derivatives are correct to 1e-11, and squared in the covariance
    if (slopes.rows() >= slopes.cols() && svd.singularValues().tail(1)[0] > smallest * svd.singularValues()[0])
        return "";
    Eigen::VectorXd change = svd.matrixV().col(svd.matrixV().cols() - 1).cwiseQuotient(lengths);
    Eigen::Index most = 0;
    change.cwiseAbs().maxCoeff(&most);
    change /= change[most];
    std::string terms;
    for (Eigen::Index k = 0; k < change.size(); ++k)
        if (std::abs(change[k]) > 1e-3)
            terms += fmt::format("{}{:+.3g} * {}", terms.empty() ? "" : " ", change[k],
                                 one_line(pointers[static_cast<std::size_t>(k)], 80));
    return fmt::format("the data do not determine the common relative change {}; leave one of these numbers out",
                       terms);
}

void end_fit(Fit& fit, std::string why) {
    fit.status = Status::failed;
    fit.message = std::move(why);
}

// Fills in errors, covariance and residuals from the last evaluation.
void add_statistics(FitProblem& problem, const Eigen::VectorXd& x, const FitData& data, const FitSettings& settings,
                    Fit& fit) {
    const FitResiduals& found = *problem.evaluate(x);
    const auto columns = static_cast<Eigen::Index>(data.columns.size());
    const Eigen::Index rows = found.residuals.size(), n = x.size();
    for (Eigen::Index c = 0; c < columns; ++c) {
        double sum = 0;
        for (Eigen::Index i = c; i < rows; i += columns) sum += found.residuals[i] * found.residuals[i];
        fit.residuals.push_back(std::sqrt(sum / static_cast<double>(data.times.size())));
    }
    Eigen::MatrixXd slopes;
    Eigen::VectorXd weighted(rows);
    problem.df(x, slopes);
    problem(x, weighted);
    // covariance (J^T J)^-1 from J = Q R P^T
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(slopes);
    const Eigen::MatrixXd R = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
    Eigen::MatrixXd covariance = inverse * inverse.transpose();
    if (settings.deviations.empty())
        covariance *= weighted.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, rows - n));
    for (Eigen::Index i = 0; i < n; ++i) {
        fit.errors.push_back(problem.size(i) * std::sqrt(covariance(i, i)));
        for (Eigen::Index k = 0; k < n; ++k)
            fit.covariance.push_back(covariance(i, k) * problem.size(i) * problem.size(k));
    }
}

}  // namespace

Fit fit_numbers(const SceneNumbers& scene, const std::vector<std::string>& pointers, const FitData& data,
                const FitSettings& settings) {
    using namespace Eigen::LevenbergMarquardtSpace;
    FitProblem problem(scene, pointers, data, settings);
    Fit fit;
    Eigen::VectorXd x = problem.start();
    fit.values = problem.numbers(x);
    Eigen::MatrixXd slopes;
    if (problem.df(x, slopes) < 0) {
        end_fit(fit, problem.fault());
        return fit;
    }
    if (const std::string free = undetermined(slopes, pointers); !free.empty()) {
        fit.evaluations = problem.evaluations();
        end_fit(fit, free);
        return fit;
    }
    Eigen::LevenbergMarquardt<FitProblem> iteration(problem);
    iteration.setXtol(1e-12);
    iteration.setFtol(1e-14);
    iteration.setGtol(0);
    iteration.setMaxfev(std::numeric_limits<int>::max());
    const Eigen::LevenbergMarquardtSpace::Status ended = iteration.minimize(x);
    fit.values = problem.numbers(x);
    fit.evaluations = problem.evaluations();
    const bool converged = ended != UserAsked && ended != TooManyFunctionEvaluation && ended != ImproperInputParameters;
    if (!problem.evaluate(x) || !converged) {
        end_fit(fit, converged ? problem.fault()
                               : fmt::format("no convergence in {} evaluations", settings.max_evaluations));
        return fit;
    }
    problem.df(x, slopes);
    add_statistics(problem, x, data, settings, fit);
    if (const std::string free = undetermined(slopes, pointers); !free.empty()) end_fit(fit, free);
    return fit;
}

}  // namespace polhode
