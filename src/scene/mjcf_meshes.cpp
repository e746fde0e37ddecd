// Masses of MJCF meshes: exact integrals over the solid or the surface.
//
// A mesh asset is read from an OBJ or STL file, or from its vertices and faces. It is then translated by refpos,
// rotated back by refquat and scaled. For solids, the integrals of the mesh as written suffice: under x' = A (x - r)
// the volume scales by |det A|, and the spread becomes A spread A^T. MuJoCo's default rule "legacy" adds the absolute
// volumes of the pyramids over the faces, which overestimates the volume of a non-convex mesh. This file uses the
// exact volume and notes the difference.
#include <fmt/format.h>

#include <cmath>

#include "body/mesh.h"
#include "scene/mjcf_hull.h"
#include "scene/mjcf_mass.h"
#include "scene/robot_parts.h"
#include "scene/scene_limits.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr const char* remedy = "give the body an <inertial>";

// The map x' = scale R^T (x - reference).
struct MeshMap {
    Vector3<Wide> reference, scale{Wide(1), Wide(1), Wide(1)};
    Quaternion<Wide> turn;

    Vector3<Wide> linear(const Vector3<Wide>& x) const {
        const Vector3<Wide> y = rotate_back(turn, x);
        return {scale[0] * y[0], scale[1] * y[1], scale[2] * y[2]};
    }
    Vector3<Wide> operator()(const Vector3<Wide>& x) const { return linear(x - reference); }
    Matrix3<Wide> matrix() const {
        Matrix3<Wide> m;
        for (int j = 0; j < 3; ++j) {
            Vector3<Wide> e;
            e[j] = Wide(1);
            const Vector3<Wide> column = linear(e);
            for (int i = 0; i < 3; ++i) m[i][j] = column[i];
        }
        return m;
    }
    Wide determinant() const { return scale[0] * scale[1] * scale[2]; }
};

MeshMap map_of(const RobotXml& xml, const XMLElement& asset) {
    MeshMap map;
    if (asset.Attribute("refpos")) map.reference = cast<Wide>(three_of(xml.attribute(asset, "refpos", 3)));
    if (asset.Attribute("scale")) map.scale = cast<Wide>(three_of(xml.attribute(asset, "scale", 3)));
    if (asset.Attribute("refquat")) {
        const std::vector<double> q = xml.attribute(asset, "refquat", 4);
        map.turn = unit_quaternion<Wide>(xml.rotate_by(asset, {q[0], q[1], q[2], q[3]}));
    }
    if (map.determinant() == Wide(0)) xml.fail(asset, "has a scale of zero", "give three numbers that are not 0");
    return map;
}

// Replaces the faces by those of the convex hull.
void add_hull(const RobotXml& xml, const XMLElement& asset, Mesh& mesh) {
    if (asset.Attribute("maxhullvert") && xml.attribute(asset, "maxhullvert", 1)[0] >= 0)
        xml.fail(asset, "needs the mass of a convex hull with limited vertices (maxhullvert), which is not supported",
                 remedy);
    mesh.triangles = convex_hull(mesh.vertices);
    if (mesh.triangles.empty())
        xml.fail(asset, "needs the mass of a convex hull that cannot be computed: too many points, or all in one plane",
                 remedy);
}

// The mesh given inline, in the numbers of the file.
Mesh inline_mesh(const RobotXml& xml, const XMLElement& asset) {
    Mesh mesh;
    const std::vector<double> v = xml.numbers(asset, "vertex", asset.Attribute("vertex"), 12, 3 * most_vertices);
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) mesh.vertices.push_back(three_of(v, i));
    if (v.size() % 3 != 0)
        xml.fail(asset, "has a count of numbers in vertex that is not a multiple of 3", "give three per point");
    if (!asset.Attribute("face")) {
        add_hull(xml, asset, mesh);
        return mesh;
    }
    const std::vector<double> f = xml.numbers(asset, "face", asset.Attribute("face"), 12, 3 * most_triangles);
    if (f.size() % 3 != 0)
        xml.fail(asset, "has a count of numbers in face that is not a multiple of 3", "give three per face");
    for (std::size_t i = 0; i < f.size(); i += 3) {
        std::array<int, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            const double index = f[i + k];
            if (!(index >= 0 && index < static_cast<double>(mesh.vertices.size()) && index == std::floor(index)))
                xml.fail(asset, fmt::format("has the index {} in face", index), "count the vertices from 0");
            triangle[k] = static_cast<int>(index);
        }
        mesh.triangles.push_back(triangle);
    }
    if (const std::string fault = mesh_fault(mesh); !fault.empty()) xml.fail(asset, fault, remedy);
    return mesh;
}

Mesh mesh_of(const RobotXml& xml, const MjcfModel& model, const XMLElement& asset) {
    const std::string name = one_line(mjcf_asset_name(asset), 60);
    const char* file = asset.Attribute("file");
    if (asset.Attribute("builtin") || asset.FirstChildElement("plugin"))
        xml.fail(asset, fmt::format("generates the mesh \"{}\" (builtin or plugin), which is not supported", name),
                 remedy);
    if (!file && asset.Attribute("vertex")) return inline_mesh(xml, asset);
    if (!file) xml.fail(asset, "has neither a file nor vertices", "give one of them");
    std::string path = file;
    if (model.compiler.strips_path) path.erase(0, path.find_last_of("/\\") + 1);  // npos + 1 = 0
    if (!path.starts_with('/')) path = model.compiler.mesh_folder + path;
    try {
        return model.files.mesh(path);
    } catch (const InputError& error) {
        fail_mjcf_file(xml, asset, error);
    }
}

Extent<Wide> surface_extent(const Mesh& mesh, const MeshMap& map) {
    Wide area = 0;
    Vector3<Wide> first;
    Matrix3<Wide> second;
    std::vector<Vector3<Wide>> vertices;
    for (const Vector3<double>& v : mesh.vertices) vertices.push_back(map(cast<Wide>(v)));
    const Vector3<Wide> origin = vertices.empty() ? Vector3<Wide>() : vertices.front();
    for (const std::array<int, 3>& triangle : mesh.triangles) {
        std::array<Vector3<Wide>, 3> v;
        for (std::size_t k = 0; k < 3; ++k) v[k] = vertices[static_cast<std::size_t>(triangle[k])] - origin;
        const Vector3<Wide> normal = cross(v[1] - v[0], v[2] - v[0]), sum = v[0] + v[1] + v[2];
        const Wide part = square_root(dot(normal, normal)) / Wide(2);
        area = area + part;
        first = first + (part / Wide(3)) * sum;
        // integral of r r^T over a triangle: A/12 (sum v v^T + s s^T), s = sum v
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                second[i][j] =
                    second[i][j] +
                    part / Wide(12) * (v[0][i] * v[0][j] + v[1][i] * v[1][j] + v[2][i] * v[2][j] + sum[i] * sum[j]);
    }
    Extent<Wide> e{area, {}, {}};
    if (!(area > Wide(0))) return e;
    const Vector3<Wide> mean = (Wide(1) / area) * first;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) e.spread[i][j] = second[i][j] / area - mean[i] * mean[j];
    e.mean = origin + mean;
    return e;
}

Extent<Wide> solid_extent(const Mesh& mesh, const MeshMap& map) {
    const Extent<Wide> raw = mesh_extent<Wide>(mesh);
    const Matrix3<Wide> A = map.matrix();
    Extent<Wide> e{Elementary<Wide>::magnitude(raw.size * map.determinant()), map(raw.mean), {}};
    e.spread = A * raw.spread * transposed(A);
    return e;
}

// The ratio of MuJoCo's legacy volume to the exact one, in binary64.
double legacy_ratio(const Mesh& mesh, const MeshMap& map, const Wide& volume) {
    std::vector<Vector3<double>> v;
    for (const Vector3<double>& one : mesh.vertices) v.push_back(cast<double>(map(cast<Wide>(one))));
    Vector3<double> center;
    double area = 0, sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vector3<double> n = cross(v[b] - v[a], v[c] - v[a]);
        const double part = std::sqrt(dot(n, n));
        area += part, center = center + (part / 3) * (v[a] + v[b] + v[c]);
    }
    if (!(area > 0)) return 1;
    center = (1 / area) * center;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += std::abs(dot(v[a] - center, cross(v[b] - center, v[c] - center))) / 6;
    return sum / double(volume);
}

}  // namespace

Extent<Wide> mjcf_mesh_extent(const RobotXml& xml, const MjcfModel& model, const XMLElement& asset, bool shell,
                              RobotNotes& assumed) {
    const std::string name = mjcf_asset_name(asset);
    const std::string usual = model.compiler.exact_meshes ? "exact" : "legacy";
    const std::string rule = asset.Attribute("inertia") ? asset.Attribute("inertia") : usual;
    if (rule != "legacy" && rule != "exact" && rule != "convex" && rule != "shell")
        xml.fail(asset, fmt::format("has the inertia \"{}\"", one_line(rule, 40)),
                 "give convex, exact, legacy or shell");
    const MeshMap map = map_of(xml, asset);
    Mesh mesh = mesh_of(xml, model, asset);
    Extent<Wide> e;
    if (shell || rule == "shell") {
        e = surface_extent(mesh, map);
    } else {
        if (rule == "convex") add_hull(xml, asset, mesh);
        e = solid_extent(mesh, map);
    }
    if (!(e.size > Wide(1e-15)))
        xml.fail(asset, fmt::format("is the mesh \"{}\" without volume or area", one_line(name, 60)), remedy);
    if (!shell && rule == "legacy") {
        const double ratio = legacy_ratio(mesh, map, e.size);
        if (std::abs(ratio - 1) > 1e-6)
            assumed["meshes computed by their exact volume, where MuJoCo's rule \"legacy\" gives more"].push_back(
                fmt::format("{} ({:.6g} times the volume)", one_line(name, 60), ratio));
    }
    return e;
}

const Extent<Wide>& MjcfMeshes::extent(const MjcfModel& model, const XMLElement& geom, bool shell) {
    const std::string name = xml_.name(geom, "mesh", "the mesh's name");
    const auto asset = model.meshes.find(name);
    if (asset == model.meshes.end())
        xml_.fail(geom, fmt::format("has the mesh \"{}\", which no <asset> defines", one_line(name, 60)),
                  "define it by <asset><mesh>");
    const Key key{asset->second, shell};
    const auto known = extents_.find(key);
    if (known != extents_.end()) return known->second;
    return extents_.emplace(key, mjcf_mesh_extent(xml_, model, *asset->second, shell, assumed_)).first->second;
}

}  // namespace polhode
