#include "body/mesh.h"

#include <fmt/format.h>

#include <map>
#include <utility>

namespace polhode {
namespace {

// for each vertex the first at the same place: files of triangles alone repeat their corners
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
    // the sum of the tetrahedra's volumes, and of their sizes
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
    std::map<std::pair<int, int>, int> edges;  // directed, how often
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::array<int, 3>& triangle = mesh.triangles[t];
        for (const int corner : triangle)
            if (corner < 0 || corner >= static_cast<int>(mesh.vertices.size()))
                return fmt::format("triangle {} has a corner {} that is no vertex", t + 1, corner + 1);
        for (int k = 0; k < 3; ++k) {
            const int from = same[triangle[k]], to = same[triangle[(k + 1) % 3]];
            if (from == to) return fmt::format("triangle {} is degenerate: two corners are one point", t + 1);
            ++edges[{from, to}];
        }
    }
    for (const auto& entry : edges) {
        const std::pair<int, int>& edge = entry.first;
        const int count = entry.second;
        const auto across = edges.find({edge.second, edge.first});
        const int back = across == edges.end() ? 0 : across->second;
        const auto named = [&] {
            return fmt::format("the edge from vertex {} to {}", edge.first + 1, edge.second + 1);
        };
        if (count + back > 2) return fmt::format("{} belongs to {} triangles", named(), count + back);
        if (count == 2)
            return fmt::format("two triangles run through {} the same way: their orientations disagree", named());
        if (back == 0) return fmt::format("{} belongs to one triangle: the surface is open", named());
    }
    return "";
}

}  // namespace polhode
