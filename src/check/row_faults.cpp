#include "check/row_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "body/mass_properties.h"
#include "body/orientation.h"

namespace polhode {
namespace {

// number of rows that are tested
constexpr std::size_t most_rows_compared = 2000;

// Counts rows of one kind that alternate regularly with other rows. No motion does this by itself.
struct Share {
    int of_a_kind = 0, all = 0, changes = 0, run = 0, longest = 0;
    bool last = false;

    void add(bool is_of_kind) {
        if (all > 0 && is_of_kind != last) ++changes;
        of_a_kind += is_of_kind, ++all, last = is_of_kind;
        run = is_of_kind ? run + 1 : 0, longest = std::max(longest, run);
    }
    bool is_pattern(double least) const {
        return changes >= 8 && 16 * changes >= all && of_a_kind >= least * all && of_a_kind < all;
    }
};

bool same_state(const TrajectoryRow& a, const TrajectoryRow& b) { return a.q == b.q && a.position_W == b.position_W; }

}  // namespace

std::vector<Diagnosis> rows_between_steps(const TrajectoryFile& file) {
    const std::vector<TrajectoryRow>& rows = file.rows;
    const std::size_t count = std::min(rows.size(), most_rows_compared);
    if (count < 12) return {};
    const double duration = rows[count - 1].t - rows.front().t;
    Share repeated;
    for (std::size_t k = 1; k < count; ++k) repeated.add(same_state(rows[k], rows[k - 1]));
    if (repeated.is_pattern(0.1))
        return {
            {"rows_repeated",
             fmt::format("{} of {} rows repeat the state of the previous row: the engine steps at about {:.4g} Hz, but "
                         "rows are written more often; write one row after each step",
                         repeated.of_a_kind, repeated.all, (repeated.all - repeated.of_a_kind) / duration),
             "", 1, 0}};
    // mean rate of each interval, and its change from one interval to the next
    std::vector<Vector3<double>> rates;
    for (std::size_t k = 1; k < count; ++k)
        rates.push_back((1 / (rows[k].t - rows[k - 1].t)) *
                        rotation_vector_from_quaternion(conjugate(rows[k - 1].q) * rows[k].q));
    std::vector<double> changes;
    double largest_rate = 0, largest_turn = 0;
    for (std::size_t k = 1; k < rates.size(); ++k) {
        changes.push_back(length(rates[k] - rates[k - 1]));
        largest_rate = std::max(largest_rate, length(rates[k]));
        largest_turn = std::max(largest_turn, length(rates[k]) * (rows[k + 1].t - rows[k].t));
    }
    // Between two states, interpolated rows have a constant rate, and the rate jumps at each state. In a smooth
    // motion neighbouring changes are similar. If the body rotates far from row to row, the test is not possible.
    if (largest_turn > 0.5) return {};
    Share constant;
    constexpr std::size_t reach = 4;
    for (std::size_t k = reach; k + reach < changes.size(); ++k) {
        const auto begin = changes.begin() + static_cast<long>(k - reach);
        const double around = *std::max_element(begin, begin + 2 * reach + 1);
        if (around > 1e-6 * largest_rate) constant.add(changes[k] < 1e-3 * around);
    }
    // a frame rate is at most a few times the step rate; longer interpolations come from variable steps
    if (constant.is_pattern(0.25) && constant.longest <= 4 && 4 * constant.all > static_cast<int>(changes.size()))
        return {{"rows_interpolated",
                 fmt::format("rows are interpolated between the engine's states: in {} of {} rows the body rotates at "
                             "the rate of the previous row, and the rate jumps about {:.4g} times per second; write "
                             "the engine's states themselves, one row after each step",
                             constant.of_a_kind, constant.all,
                             static_cast<double>(constant.all - constant.of_a_kind) / constant.all *
                                 static_cast<double>(count - 1) / duration),
                 "", 1, 0}};
    return {};
}

namespace {

// Growth of log |q| from row k - 1 to row k, and the growth in one first-order update by the same rotation:
// |q + (h/2) w q| = |q| sqrt(1 + |w h/2|^2). With m updates per row, log |q| grows by 1/m of this.
struct Growth {
    double found = 0, expected = 0;
};
Growth growth(const std::vector<TrajectoryRow>& rows, std::size_t k) {
    const double tangent = std::tan(rotation_angle_between(rows[k - 1].q, rows[k].q) / 2);
    return {std::log(norm(rows[k].q) / norm(rows[k - 1].q)), 0.5 * std::log1p(tangent * tangent)};
}

// Whether this share of the expected growth corresponds to an integer number of updates per row.
bool is_of_whole_steps(double share, double most) {
    const double steps = std::round(1 / share);
    return steps >= 1 && steps <= most && std::abs(share * steps - 1) < 0.05;
}

// Diagnoses quaternions whose length grows in first-order updates and returns to 1 in every n-th row. The rule is
// strict, so that small deviations suffice: all other rows grow by the same share, and n is constant.
std::optional<Diagnosis> seldom_normalised(const std::vector<TrajectoryRow>& rows) {
    constexpr double tolerance = 0.2;  // relative to the growth per row: the error of binary32 in slow rotations
    constexpr std::size_t least_periods = 3;
    const std::size_t count = std::min(rows.size(), most_rows_compared);
    std::vector<double> shares;
    std::size_t last = 0, period = 0, periods = 0;
    double largest = 0;
    for (std::size_t k = 1; k < count; ++k) {
        const Growth g = growth(rows, k);
        if (!(g.expected > 1e-14) || !std::isfinite(g.expected)) return {};
        largest = std::max(largest, std::abs(norm(rows[k].q) - 1));
        if (g.found > 0) {
            shares.push_back(g.found / g.expected);
            continue;
        }
        // normalised before or after this row's update
        const double left = std::log(norm(rows[k].q)) / g.expected;
        if (!(left > -tolerance && left < 1 + tolerance)) return {};
        if (last > 0) {
            if (period > 0 && k - last != period) return {};
            period = k - last, ++periods;
        }
        last = k;
    }
    if (period < 2 || periods < least_periods || count - last > period + 1) return {};
    std::vector<double> sorted = shares;
    std::ranges::sort(sorted);
    const double usual = sorted[sorted.size() / 2];
    if (!is_of_whole_steps(usual, 100) || sorted.front() < (1 - tolerance) * usual ||
        sorted.back() > (1 + tolerance) * usual)
        return {};
    return Diagnosis{"quaternion_seldom_normalised",
                     fmt::format("the quaternion is normalised only every {} rows: in between its length grows as in "
                                 "first-order updates, up to 1 + {:.2g}; normalise it after each step",
                                 period, largest),
                     "", largest, 0};
}

}  // namespace

std::vector<Diagnosis> find_length_faults(const TrajectoryFile& file) {
    const std::vector<TrajectoryRow>& rows = file.rows;
    if (rows.size() < 12) return {};
    if (std::optional<Diagnosis> seldom = seldom_normalised(rows)) return {*std::move(seldom)};
    double worst = 0, at = 0;
    for (const TrajectoryRow& row : rows)
        if (const double off = std::abs(norm(row.q) - 1); off > worst) worst = off, at = row.t;
    if (!(worst > 1e-3)) return {};
    // log |q| must grow in every row by this law; methods of higher order drift differently
    std::vector<double> shares;
    for (std::size_t k = 1; k < rows.size(); ++k)
        if (const Growth g = growth(rows, k); g.expected > 1e-12) shares.push_back(g.found / g.expected);
    if (shares.size() < rows.size() / 2) return {};
    std::ranges::sort(shares);
    const auto part = [&](double p) {
        return shares[static_cast<std::size_t>(p * static_cast<double>(shares.size() - 1))];
    };
    if (!is_of_whole_steps(part(0.5), 16) || !(part(0.9) - part(0.1) < 0.1 * part(0.5))) return {};
    return {{"quaternion_not_normalised",
             fmt::format("the quaternion's length differs from 1 by {:.2g} at t = {:.6g} s, as in first-order updates "
                         "without normalisation; normalise it after each step",
                         worst, at),
             "", worst, 0}};
}

}  // namespace polhode
