#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/polhode_picture.h"
#include "app/polhode_view.h"

namespace polhode {
namespace {

using V = Vector3<double>;

constexpr int columns = 34, rows = 17;  // in characters, each two dots wide and four dots high
constexpr int width = 2 * columns, height = 4 * rows;

V axis(int i) {
    V e;
    e[i] = 1;
    return e;
}

class Raster {
  public:
    explicit Raster(double reach) : scale_((width - 3) / (2 * reach)) {}

    // Draws every `stride`-th dot of the line.
    void line(const std::vector<PagePoint>& points, int stride) {
        int count = 0, last_x = -1, last_y = -1;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const PagePoint from = points[i > 0 ? i - 1 : 0], to = points[i];
            const int steps =
                1 + static_cast<int>(2 * scale_ * std::max(std::abs(to.x - from.x), std::abs(to.y - from.y)));
            for (int k = 1; k <= steps; ++k) {
                const double share = static_cast<double>(k) / steps;
                const auto [x, y] = dot_at({from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)});
                if (x == last_x && y == last_y) continue;
                last_x = x, last_y = y;
                if (count++ % stride == 0) set(x, y);
            }
        }
    }
    void mark(const PagePoint& point, char sign) {
        const auto [x, y] = dot_at(point);
        if (inside(x, y)) marks_[y / 4][x / 2] = sign;
    }
    std::string row(int r) const {
        // bits of the dots in a Braille pattern, U+2800 + bits
        constexpr int bit[4][2] = {{0, 3}, {1, 4}, {2, 5}, {6, 7}};
        std::string text;
        for (int c = 0; c < columns; ++c) {
            int bits = 0;
            for (int y = 0; y < 4; ++y)
                for (int x = 0; x < 2; ++x)
                    if (dots_[4 * r + y][2 * c + x]) bits |= 1 << bit[y][x];
            if (marks_[r][c] != 0) {
                text += marks_[r][c];
            } else if (bits == 0) {
                text += ' ';
            } else {
                text += {static_cast<char>(0xe2), static_cast<char>(0xa0 | (bits >> 6)),
                         static_cast<char>(0x80 | (bits & 0x3f))};
            }
        }
        return text;
    }

  private:
    std::array<int, 2> dot_at(const PagePoint& p) const {
        return {static_cast<int>(std::lround((width - 1) / 2.0 + scale_ * p.x)),
                static_cast<int>(std::lround((height - 1) / 2.0 - scale_ * p.y))};
    }
    static bool inside(int x, int y) { return x >= 0 && x < width && y >= 0 && y < height; }
    void set(int x, int y) {
        if (inside(x, y)) dots_[y][x] = true;
    }

    double scale_;
    std::array<std::array<bool, width>, height> dots_{};
    std::array<std::array<char, columns>, rows> marks_{};
};

Raster view_along(const PolhodeCurve& polhode, int along) {
    const PolhodeView view(polhode, axis(along), axis((along + 1) % 3));
    double reach = 0;
    const auto reaches = [&](const PagePoint& p) { reach = std::max({reach, std::abs(p.x), std::abs(p.y)}); };
    const std::vector<PagePoint> outline = view.outline();
    for (const PagePoint& p : outline) reaches(p);
    for (const Polyline& line : polhode.curve)
        for (const V& rate : line) reaches(view.at(rate));
    Raster raster(reach);
    raster.line(outline, 4);
    for (const Polyline& line : polhode.curve) {
        const VisibleLine seen = view.seen(line);
        for (const auto& part : seen.behind) raster.line(part, 2);
        for (const auto& part : seen.front) raster.line(part, 1);
    }
    raster.mark(view.at(polhode.curve.front().front()), 'o');
    return raster;
}

}  // namespace

std::vector<std::string> polhode_text(const PolhodeCurve& polhode) {
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return polhode.moments[i] < polhode.moments[j]; });
    const int along[2] = {order[2], order[1]};
    const auto heading = [](int k) {
        return fmt::format("along w{}: w{} right, w{} up", k + 1, (k + 1) % 3 + 1, (k + 2) % 3 + 1);
    };
    std::vector<std::string> lines{fmt::format("{:<{}}    {}", heading(along[0]), columns, heading(along[1]))};
    const Raster left = view_along(polhode, along[0]), right = view_along(polhode, along[1]);
    for (int r = 0; r < rows; ++r) {
        std::string line = left.row(r) + "    " + right.row(r);
        line.erase(line.find_last_not_of(' ') + 1);
        lines.push_back(line);
    }
    return lines;
}

}  // namespace polhode
