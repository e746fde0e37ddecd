#include "body/tessellation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace polhode {

Mesh tessellate(const Box& box) {
    Mesh mesh;
    const Vector3<double>& a = box.half_extents;
    // bit k of i is the sign of corner i along axis k
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({i & 1 ? a[0] : -a[0], i & 2 ? a[1] : -a[1], i & 4 ? a[2] : -a[2]});
    for (const std::array<int, 4>& face : {std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}, std::array{0, 1, 5, 4},
                                           std::array{2, 6, 7, 3}, std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}}) {
        mesh.triangles.push_back({face[0], face[1], face[2]});
        mesh.triangles.push_back({face[0], face[2], face[3]});
    }
    return mesh;
}

Mesh tessellate(const SolidSphere& sphere, int subdivisions) {
    const double golden = std::numbers::phi;
    const auto on_sphere = [&](const Vector3<double>& v) { return (sphere.radius / std::sqrt(dot(v, v))) * v; };
    Mesh mesh;
    for (const Vector3<double>& v :
         {Vector3<double>(-1, golden, 0), Vector3<double>(1, golden, 0), Vector3<double>(-1, -golden, 0),
          Vector3<double>(1, -golden, 0), Vector3<double>(0, -1, golden), Vector3<double>(0, 1, golden),
          Vector3<double>(0, -1, -golden), Vector3<double>(0, 1, -golden), Vector3<double>(golden, 0, -1),
          Vector3<double>(golden, 0, 1), Vector3<double>(-golden, 0, -1), Vector3<double>(-golden, 0, 1)})
        mesh.vertices.push_back(on_sphere(v));
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < subdivisions; ++level) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
            if (is_new) mesh.vertices.push_back(on_sphere(mesh.vertices[a] + mesh.vertices[b]));
            return place->second;
        };
        std::vector<std::array<int, 3>> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const std::array<int, 3>& part :
                 {std::array{a, ab, ca}, std::array{b, bc, ab}, std::array{c, ca, bc}, std::array{ab, bc, ca}})
                finer.push_back(part);
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

Mesh tessellate(const Torus& torus, int n) {
    Mesh mesh;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / n;
            const double across = torus.major_radius + torus.minor_radius * std::cos(v);
            mesh.vertices.push_back({across * std::cos(u), across * std::sin(u), torus.minor_radius * std::sin(v)});
        }
    const auto at = [&](int i, int j) { return (i % n) * n + j % n; };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

}  // namespace polhode
