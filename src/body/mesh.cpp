#include "body/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace polhode {
namespace {

// For each vertex, the first one at the same place. Files that list only triangles repeat their vertices.
std::vector<int> same_places(const Mesh& mesh) {
    std::map<std::array<double, 3>, int> first;
    std::vector<int> same;
    for (const Vector3<double>& v : mesh.vertices)
        same.push_back(
            first.emplace(std::array{v[0] + 0.0, v[1] + 0.0, v[2] + 0.0}, static_cast<int>(same.size())).first->second);
    return same;
}

}  // namespace

double enclosed_volume(const Mesh& mesh) {
    // the sum of the signed volumes of the tetrahedra, and the sum of their magnitudes
    const Vector3<Wide> from = cast<Wide>(mesh.vertices[static_cast<std::size_t>(mesh.triangles.front()[0])]);
    Wide volume = 0, size = 0;
    for (const std::array<int, 3>& triangle : mesh.triangles) {
        std::array<Vector3<Wide>, 3> v;
        for (int k = 0; k < 3; ++k) v[k] = cast<Wide>(mesh.vertices[triangle[k]]) - from;
        const Vector3<Wide> c = cross(v[1], v[2]);
        volume += dot(v[0], c) / 6;
        for (int i = 0; i < 3; ++i) size += Elementary<Wide>::magnitude(v[0][i] * c[i]) / 6;
    }
    return Elementary<Wide>::magnitude(volume) <= Wide(0x1p-52) * size ? 0 : double(volume);
}

std::string mesh_fault(const Mesh& mesh) {
    if (mesh.triangles.empty()) return "has no triangles";
    const std::vector<int> same = same_places(mesh);
    // for each edge, the number of traversals from its lower vertex to its higher one minus those in the other
    // direction
    std::map<std::pair<int, int>, int> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::array<int, 3>& triangle = mesh.triangles[t];
        for (const int corner : triangle)
            if (corner < 0 || corner >= static_cast<int>(mesh.vertices.size()))
                return fmt::format("triangle {} refers to vertex {}, which does not exist", t + 1, corner + 1);
        for (int k = 0; k < 3; ++k) {
            const int from = same[triangle[k]], to = same[triangle[(k + 1) % 3]];
            if (from != to) edges[std::minmax(from, to)] += from < to ? 1 : -1;
        }
    }
    std::erase_if(edges, [](const auto& edge) { return edge.second == 0; });
    if (edges.empty()) return "";
    constexpr std::size_t most = 5;
    std::vector<std::string> named;
    for (const auto& [edge, count] : edges) {
        if (named.size() == most) break;
        named.push_back(fmt::format("{}-{}", edge.first + 1, edge.second + 1));
    }
    return fmt::format(
        "is not a closed surface: {} edge{} run through more often in one direction than in the other, "
        "between vertices {}{}",
        edges.size(), edges.size() == 1 ? " is" : "s are", fmt::join(named, ", "), edges.size() > most ? ", .." : "");
}

}  // namespace polhode
