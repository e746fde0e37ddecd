#include "check/attitude_update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "body/elementary.h"
#include "body/mass_properties.h"

namespace polhode {
namespace {

// Returns exp(h w / 2), or 1 + h w / 2 normalised.
Quaternion<double> turn(const Vector3<double>& w, double h, bool first_order) {
    const Vector3<double> half = (0.5 * h) * w;
    const double angle = length(half);
    if (first_order) return normalized(Quaternion<double>{1, half[0], half[1], half[2]});
    const double scale = angle > 1e-8 ? std::sin(angle) / angle : 1;
    return {std::cos(angle), scale * half[0], scale * half[1], scale * half[2]};
}

// Interpolates w between rows k and k + 1 by the polynomial through six rows.
class Rate {
  public:
    Rate(const std::vector<TrajectoryRow>& rows, std::size_t k) {
        for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] = &rows[k - 2 + i];
    }
    Vector3<double> at(double t) const {
        Vector3<double> sum;
        for (const TrajectoryRow* a : rows_) {
            double weight = 1;
            for (const TrajectoryRow* b : rows_)
                if (a != b) weight *= (t - b->t) / (a->t - b->t);
            sum = sum + weight * a->angular_velocity_W;
        }
        return sum;
    }

  private:
    std::array<const TrajectoryRow*, 6> rows_{};
};

constexpr std::array steps_a_row{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 20};
constexpr std::array places_of_rate{0.0, 0.5, 1.0};  // w at the start, middle and end of the step

}  // namespace

std::optional<FirstOrderUpdate> first_order_update(const TrajectoryFile& file) {
    const std::size_t count = std::min<std::size_t>(file.rows.size(), 120);
    if (count < 8) return {};
    // sum over the rows of the squared prediction error, for each update
    double left[2][steps_a_row.size()][places_of_rate.size()] = {};
    for (std::size_t k = 2; k + 3 < count; ++k) {
        const TrajectoryRow &a = file.rows[k], &b = file.rows[k + 1];
        const Rate rate(file.rows, k);
        const double dt = b.t - a.t;
        if (!(length(a.angular_velocity_W) * dt < 1)) return {};
        for (const bool first_order : {false, true})
            for (std::size_t m = 0; m < steps_a_row.size(); ++m)
                for (std::size_t place = 0; place < places_of_rate.size(); ++place) {
                    const double h = dt / steps_a_row[m];
                    Quaternion<double> q = a.q;
                    for (int i = 0; i < steps_a_row[m]; ++i)
                        q = turn(rate.at(a.t + (i + places_of_rate[place]) * h), h, first_order) * q;
                    const Quaternion<double> rest = conjugate(q) * b.q;
                    const double angle = 2 * std::atan2(length(vector_part(rest)), std::abs(rest.w));
                    left[first_order ? 1 : 0][m][place] += angle * angle;
                }
    }
    const double infinity = std::numeric_limits<double>::infinity();
    double exact = infinity, first = infinity;
    int steps = 1;
    for (std::size_t m = 0; m < steps_a_row.size(); ++m)
        for (std::size_t place = 0; place < places_of_rate.size(); ++place) {
            exact = std::min(exact, left[0][m][place]);
            if (left[1][m][place] < first) first = left[1][m][place], steps = steps_a_row[m];
        }
    const double pairs = static_cast<double>(count - 5);
    const FirstOrderUpdate update{(file.rows[count - 3].t - file.rows[2].t) / pairs / steps, std::sqrt(exact / pairs),
                                  std::sqrt(first / pairs)};
    if (!(update.error > 1e-6 && 10 * update.explained <= update.error)) return {};
    return update;
}

}  // namespace polhode
