// Incremental convex hull (M. Kallay 1984). Each point outside the current hull replaces the faces visible from it by
// a cone over their horizon. Signed volumes are computed in binary64 and, near zero, again in 113 bits. The result is
// verified: no point lies outside the plane of a face.
#include "scene/mjcf_hull.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "body/elementary.h"

namespace polhode {
namespace {

using Triangle = std::array<int, 3>;
constexpr std::size_t most_tests = 300'000'000;

class Hull {
  public:
    explicit Hull(const std::vector<Vector3<double>>& points) : points_(points) {
        for (const Vector3<double>& p : points)
            for (int i = 0; i < 3; ++i) size_ = std::max(size_, std::abs(p[i]));
    }

    std::vector<Triangle> triangles() {
        if (!(size_ > 0) || !start()) return {};
        for (const int p : insertion_order())
            if (!insert(p)) return {};
        const std::size_t tests = points_.size() * faces_.size();
        if (tests > most_tests) return {};
        for (const Triangle& face : faces_)
            for (std::size_t p = 0; p < points_.size(); ++p)
                if (is_outside(face, static_cast<int>(p))) return {};
        return faces_;
    }

  private:
    template <class S>
    S six_volumes(const Triangle& t, int p) const {
        const Vector3<S> o = cast<S>(points_[static_cast<std::size_t>(p)]);
        const auto from = [&](int i) { return cast<S>(points_[static_cast<std::size_t>(i)]) - o; };
        return dot(from(t[0]), cross(from(t[1]), from(t[2])));
    }

    // Whether the point sees the face: the tetrahedron from the point to the face has negative volume.
    bool is_outside(const Triangle& t, int p) const {
        const double scale = size_ * size_ * size_, volume = six_volumes<double>(t, p);
        if (std::abs(volume) > 1e-12 * scale) return volume < 0;
        return six_volumes<Wide>(t, p) < Wide(-1e-25) * Wide(scale);
    }

    // Finds an initial tetrahedron of points that are far apart.
    bool start() {
        const auto farthest = [&](auto&& distance) {
            int best = 0;
            double largest = -1;
            for (std::size_t i = 0; i < points_.size(); ++i)
                if (const double d = distance(points_[i]); d > largest) largest = d, best = static_cast<int>(i);
            return std::pair(best, largest);
        };
        const auto at = [&](int i) { return points_[static_cast<std::size_t>(i)]; };
        const int a = farthest([](const Vector3<double>& p) { return dot(p, p); }).first;
        const int b = farthest([&](const Vector3<double>& p) { return dot(p - at(a), p - at(a)); }).first;
        const Vector3<double> along = at(b) - at(a);
        const int c = farthest([&](const Vector3<double>& p) {
                          const Vector3<double> n = cross(along, p - at(a));
                          return dot(n, n);
                      }).first;
        const Vector3<double> normal = cross(along, at(c) - at(a));
        const auto [d, height] = farthest([&](const Vector3<double>& p) { return std::abs(dot(normal, p - at(a))); });
        if (!(height > 1e-10 * size_ * size_ * size_)) return false;
        Triangle base{a, b, c};
        if (is_outside(base, d)) std::swap(base[1], base[2]);
        faces_ = {base, {base[0], d, base[1]}, {base[1], d, base[2]}, {base[2], d, base[0]}};
        return true;
    }

    // Extreme points first, so that the faces and edges of a polyhedron are complete before the points on them are
    // inserted.
    std::vector<int> insertion_order() const {
        std::vector<int> order;
        std::set<int> taken;
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const Vector3<double> way(x, y, z);
                    const auto best = std::max_element(
                        points_.begin(), points_.end(),
                        [&](const Vector3<double>& p, const Vector3<double>& q) { return dot(way, p) < dot(way, q); });
                    const int i = static_cast<int>(best - points_.begin());
                    if (taken.insert(i).second) order.push_back(i);
                }
        for (std::size_t i = 0; i < points_.size(); ++i)
            if (!taken.contains(static_cast<int>(i))) order.push_back(static_cast<int>(i));
        return order;
    }

    bool insert(int p) {
        tests_ += faces_.size();
        if (tests_ > most_tests) return false;
        const auto seen =
            std::partition(faces_.begin(), faces_.end(), [&](const Triangle& t) { return !is_outside(t, p); });
        std::set<std::pair<int, int>> edges;
        for (auto t = seen; t != faces_.end(); ++t)
            for (std::size_t k = 0; k < 3; ++k) edges.insert({(*t)[k], (*t)[(k + 1) % 3]});
        faces_.erase(seen, faces_.end());
        for (const auto& [from, to] : edges)
            if (!edges.contains({to, from})) faces_.push_back({from, to, p});
        return true;
    }

    const std::vector<Vector3<double>>& points_;
    std::vector<Triangle> faces_;
    double size_ = 0;
    std::size_t tests_ = 0;
};

}  // namespace

std::vector<Triangle> convex_hull(const std::vector<Vector3<double>>& points) {
    return points.size() < 4 ? std::vector<Triangle>{} : Hull(points).triangles();
}

}  // namespace polhode
