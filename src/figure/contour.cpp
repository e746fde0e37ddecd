#include "figure/contour.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

namespace polhode {

namespace {

/// An edge of the grid from node (i, j) to the right or upward.
struct Edge {
    int i, j;
    bool upward;
    bool operator<(const Edge& other) const {
        return std::tie(i, j, upward) < std::tie(other.i, other.j, other.upward);
    }
    bool operator==(const Edge& other) const = default;
};

class Grid {
  public:
    Grid(const std::function<double(double, double)>& f, Limits x, Limits y, int columns, int rows)
        : f_(f), x_(x), y_(y), columns_(columns), rows_(rows) {
        for (int j = 0; j <= rows; ++j)
            for (int i = 0; i <= columns; ++i) inside_.push_back(f(at_x(i), at_y(j)) <= 0);
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) join_in_cell(i, j);
    }

    std::vector<ContourLine> lines() {
        std::vector<ContourLine> lines;
        // start open lines at their ends first; the remaining lines are closed
        for (const bool closed : {false, true})
            for (auto& [edge, next] : joins_)
                if (!next.empty() && (closed || next.size() == 1)) lines.push_back(line_from(edge, closed));
        return lines;
    }

  private:
    double at_x(double i) const { return x_.low + (x_.high - x_.low) * i / columns_; }
    double at_y(double j) const { return y_.low + (y_.high - y_.low) * j / rows_; }
    bool inside(int i, int j) const { return inside_[static_cast<std::size_t>(j) * (columns_ + 1U) + i]; }

    void join(const Edge& a, const Edge& b) {
        joins_[a].push_back(b);
        joins_[b].push_back(a);
    }
    void join_in_cell(int i, int j) {
        const std::array<bool, 4> corner{inside(i, j), inside(i + 1, j), inside(i + 1, j + 1), inside(i, j + 1)};
        // edge k leads from corner k to corner k + 1
        const std::array<Edge, 4> edge{Edge{i, j, false}, Edge{i + 1, j, true}, Edge{i, j + 1, false},
                                       Edge{i, j, true}};
        std::vector<int> cut;
        for (int k = 0; k < 4; ++k)
            if (corner[k] != corner[(k + 1) % 4]) cut.push_back(k);
        if (cut.size() == 2) join(edge[cut[0]], edge[cut[1]]);
        if (cut.size() < 4) return;
        // saddle: the value at the cell centre decides which corners are connected
        const bool middle = f_(at_x(i + 0.5), at_y(j + 0.5)) <= 0;
        const int first = corner[0] == middle ? 0 : 3;
        join(edge[first], edge[(first + 1) % 4]);
        join(edge[(first + 2) % 4], edge[(first + 3) % 4]);
    }

    /// Follows a line from `edge` and removes its joins.
    ContourLine line_from(Edge edge, bool closed) {
        ContourLine line;
        const Edge first = edge;
        while (true) {
            const auto [x, y] = crossing(edge);
            line.x.push_back(x), line.y.push_back(y);
            std::vector<Edge>& next = joins_[edge];
            if (next.empty()) break;
            const Edge to = next.back();
            next.pop_back();
            std::vector<Edge>& back = joins_[to];
            for (std::size_t k = 0; k < back.size(); ++k)
                if (back[k] == edge) {
                    back.erase(back.begin() + static_cast<std::ptrdiff_t>(k));
                    break;
                }
            edge = to;
            if (closed && edge == first) {
                line.x.push_back(line.x.front()), line.y.push_back(line.y.front());
                break;
            }
        }
        return line;
    }
    std::pair<double, double> crossing(const Edge& edge) const {
        double low = 0, high = 1;
        const auto place = [&](double share) {
            return std::pair(at_x(edge.i + (edge.upward ? 0 : share)), at_y(edge.j + (edge.upward ? share : 0)));
        };
        const bool begin = inside(edge.i, edge.j);
        while (high - low > 1e-9) {
            const double middle = (low + high) / 2;
            const auto [x, y] = place(middle);
            ((f_(x, y) <= 0) == begin ? low : high) = middle;
        }
        return place((low + high) / 2);
    }

    const std::function<double(double, double)>& f_;
    Limits x_, y_;
    int columns_, rows_;
    std::vector<bool> inside_;
    std::map<Edge, std::vector<Edge>> joins_;
};

}  // namespace

std::vector<ContourLine> contour(const std::function<double(double, double)>& f, Limits x, Limits y, int columns,
                                 int rows) {
    return Grid(f, x, y, columns, rows).lines();
}

}  // namespace polhode
