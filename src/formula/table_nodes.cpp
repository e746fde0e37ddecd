// A table is a tree of choices over its points, with a polynomial for each interval. The cubic polynomials have the
// slopes of F. N. Fritsch and J. Butland 1984, SIAM J. Sci. Stat. Comput. 5, 300, with the end slopes of C. Moler 2004,
// Numerical Computing with MATLAB, 3.6. Slopes and coefficients are operations, so that they are exact in any scalar.
#include "formula/table_nodes.h"

#include <cmath>
#include <cstddef>

namespace polhode::formula {
namespace {

class TableNodes {
  public:
    TableNodes(Expression& expression, const TableData& table, int x, const std::string& text)
        : e_(expression), table_(table), x_(x), text_(text) {
        for (std::size_t i = 0; i + 1 < table_.x.size(); ++i) {
            width_.push_back(e_.subtract(e_.number(table_.x[i + 1]), e_.number(table_.x[i])));
            secant_.push_back(
                e_.divide(e_.subtract(e_.number(table_.y[i + 1]), e_.number(table_.y[i])), width_.back()));
        }
        if (table_.cubic && table_.x.size() > 2) find_slopes();
    }
    int value() { return choose_between(0, table_.x.size()); }

  private:
    Expression& e_;
    const TableData& table_;
    int x_;
    const std::string& text_;
    std::vector<int> width_, secant_, slope_;

    // The value if x is in one of the intervals `first` to `last`. Interval i ends at point i.
    int choose_between(std::size_t first, std::size_t last) {
        if (first == last) return interval(first);
        const std::size_t middle = (first + last) / 2;
        const int left = choose_between(first, middle), right = choose_between(middle + 1, last);
        const int which = e_.compare(x_, e_.number(table_.x[middle]), text_);
        return e_.choose(which, Test::not_negative, right, left);
    }
    int interval(std::size_t i) {
        if (i == 0) return e_.number(table_.y.front());
        if (i == table_.x.size()) return e_.number(table_.y.back());
        const std::size_t k = i - 1;
        const int s = e_.subtract(x_, e_.number(table_.x[k])), y = e_.number(table_.y[k]);
        if (slope_.empty()) return e_.add(y, e_.multiply(secant_[k], s));
        const int left = slope_[k], right = slope_[k + 1], h = width_[k], secant = secant_[k];
        // y + s (d + s (c + s b)), c = (3 delta - 2 d - d') / h, b = (d - 2 delta + d') / h^2
        const int twice = e_.multiply(e_.number(2), secant);
        const int b = e_.divide(e_.subtract(e_.add(left, right), twice), e_.multiply(h, h));
        const int c = e_.divide(
            e_.subtract(e_.multiply(e_.number(3), secant), e_.add(e_.multiply(e_.number(2), left), right)), h);
        const int inner = e_.add(c, e_.multiply(s, b));
        return e_.add(y, e_.multiply(s, e_.add(left, e_.multiply(s, inner))));
    }
    double rise(std::size_t k) const { return table_.y[k + 1] - table_.y[k]; }
    double run(std::size_t k) const { return table_.x[k + 1] - table_.x[k]; }

    void find_slopes() {
        const std::size_t n = table_.x.size();
        slope_.push_back(end_slope(0, 1));
        for (std::size_t i = 1; i + 1 < n; ++i) slope_.push_back(inner_slope(i));
        slope_.push_back(end_slope(n - 2, n - 3));
    }
    // The weighted harmonic mean of the neighbouring secants; zero at an extremum.
    int inner_slope(std::size_t i) {
        if (!(rise(i - 1) * rise(i) > 0)) return e_.number(0);
        const int before = width_[i - 1], after = width_[i];
        const int weight_before = e_.add(e_.add(after, after), before);
        const int weight_after = e_.add(after, e_.add(before, before));
        return e_.divide(e_.add(weight_before, weight_after),
                         e_.add(e_.divide(weight_before, secant_[i - 1]), e_.divide(weight_after, secant_[i])));
    }
    // The slope of the parabola through three points at the end of interval k, limited so that the curve is monotone.
    int end_slope(std::size_t k, std::size_t next) {
        const double h = run(k), h_next = run(next), d = rise(k) / h, d_next = rise(next) / h_next;
        const double slope = ((2 * h + h_next) * d - h * d_next) / (h + h_next);
        if (!(slope * d > 0)) return e_.number(0);
        if (!(d * d_next > 0) && std::abs(slope) > 3 * std::abs(d)) return e_.multiply(e_.number(3), secant_[k]);
        const int a = width_[k], b = width_[next];
        return e_.divide(e_.subtract(e_.multiply(e_.add(e_.add(a, a), b), secant_[k]), e_.multiply(a, secant_[next])),
                         e_.add(a, b));
    }
};

}  // namespace

int table_nodes(Expression& expression, const TableData& table, int x, const std::string& text) {
    return TableNodes(expression, table, x, text).value();
}

}  // namespace polhode::formula
