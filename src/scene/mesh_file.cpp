// Parsers of OBJ text and of STL, text and binary. Lines splits a text into words and knows the line number for
// errors. parse_mesh() selects the format, checks the limits of scene_limits.h and the closure of the surface
// (body/mesh.h), and reverses surfaces that face inward.

#include "scene/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "scene/scene_limits.h"
#include "text/content_hash.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

constexpr const char* expected_file = "a surface in OBJ or STL format";

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// Splits a text file into lines and words. Errors name the line.
class Lines {
  public:
    Lines(std::string_view text, const std::string& path) : rest_(text), path_(path) {}

    /// Reads the words of the next non-empty line; returns false at the end. A backslash at the end of a line joins
    /// the next line.
    bool next(std::vector<std::string_view>& words, char comment) {
        words.clear();
        while (words.empty() && !rest_.empty()) {
            bool more = true;
            while (more && !rest_.empty()) {
                ++line_;
                const std::size_t end = std::min(rest_.find('\n'), rest_.size());
                std::string_view line = rest_.substr(0, end);
                rest_.remove_prefix(std::min(end + 1, rest_.size()));
                if (comment != 0) line = line.substr(0, line.find(comment));
                while (!line.empty() && is_space(line.back())) line.remove_suffix(1);
                more = !line.empty() && line.back() == '\\';
                if (more) line.remove_suffix(1);
                split(line, words);
            }
        }
        return !words.empty();
    }

    [[noreturn]] void fail(const std::string& fault, const std::string& remedy) const {
        throw InputError(path_, fmt::format("line {}", line_), fault, remedy);
    }

    double number(std::string_view word) const {
        const std::optional<double> value = parse_decimal(word);
        if (!value || !std::isfinite(*value))
            fail(fmt::format("\"{}\" is not a finite number", one_line(word, 40)), "give decimal coordinates in m");
        return *value;
    }
    Vector3<double> point(const std::vector<std::string_view>& words) const {
        return {number(words[1]), number(words[2]), number(words[3])};
    }

  private:
    void split(std::string_view line, std::vector<std::string_view>& words) const {
        for (std::size_t i = 0; i < line.size();) {
            if (is_space(line[i])) {
                ++i;
                continue;
            }
            std::size_t end = i;
            while (end < line.size() && !is_space(line[end])) ++end;
            if (words.size() > most_corners)
                fail(fmt::format("has more than {} words", most_corners),
                     fmt::format("give faces with at most {} corners", most_corners));
            words.push_back(line.substr(i, end - i));
            i = end;
        }
    }

    std::string_view rest_;
    const std::string& path_;
    long line_ = 0;
};

// Throws if the mesh exceeds the limits.
void require_bounded(const Mesh& mesh, const std::string& path) {
    const auto refuse = [&](std::size_t most, const char* what) {
        throw InputError(path, "", fmt::format("has more than {} {}", most, what), "give a coarser surface");
    };
    if (mesh.vertices.size() > most_vertices) refuse(most_vertices, "vertices");
    if (mesh.triangles.size() > most_triangles) refuse(most_triangles, "triangles");
}

Mesh parse_obj(std::string_view text, const std::string& path) {
    // statements that do not describe the surface
    static constexpr std::string_view ignored_keywords[] = {"vn", "vt", "vp", "g",      "o",
                                                            "s",  "l",  "p",  "usemtl", "mtllib"};
    Mesh mesh;
    Lines lines(text, path);
    std::vector<std::string_view> words;
    while (lines.next(words, '#')) {
        if (words[0] == "v") {
            // a fourth number is a weight, six numbers include a colour
            if (words.size() < 4) lines.fail("has a vertex with fewer than 3 coordinates", "give \"v x y z\"");
            mesh.vertices.push_back(lines.point(words));
            require_bounded(mesh, path);
        } else if (words[0] == "f") {
            if (words.size() < 4) lines.fail("has a face with fewer than 3 corners", "give \"f a b c ..\"");
            std::vector<int> corners;
            for (std::size_t i = 1; i < words.size(); ++i) {
                const std::string_view word = words[i].substr(0, words[i].find('/'));
                long index = 0;
                const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
                const long count = static_cast<long>(mesh.vertices.size());
                // indices count from 1, or backward from the last vertex
                const long corner = index < 0 ? count + index : index - 1;
                if (error != std::errc() || end != word.data() + word.size() || corner < 0 || corner >= count)
                    lines.fail(fmt::format("has a corner \"{}\", but {} vertices are defined so far",
                                           one_line(words[i], 40), count),
                               "refer to vertices defined on earlier lines");
                corners.push_back(static_cast<int>(corner));
            }
            for (std::size_t i = 2; i < corners.size(); ++i)
                mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
            require_bounded(mesh, path);
        } else if (std::find(std::begin(ignored_keywords), std::end(ignored_keywords), words[0]) ==
                   std::end(ignored_keywords)) {
            lines.fail(fmt::format("begins with \"{}\"", one_line(words[0], 40)),
                       "give an OBJ file of vertices (v) and faces (f)");
        }
    }
    return mesh;
}

void add_triangle(Mesh& mesh, const std::array<Vector3<double>, 3>& corners) {
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
}

Mesh parse_text_stl(std::string_view text, const std::string& path) {
    Mesh mesh;
    Lines lines(text, path);
    std::vector<std::string_view> words;
    const char* remedy = "give text STL: solid, facet, outer loop, 3 x vertex, endloop, endfacet, endsolid";
    const auto expect = [&](std::initializer_list<std::string_view> beginning) {
        if (!lines.next(words, 0)) lines.fail("ends before \"endsolid\"", remedy);
        if (words.size() < beginning.size() || !std::equal(beginning.begin(), beginning.end(), words.begin()))
            lines.fail(
                fmt::format("begins with \"{}\" where \"{}\" is expected", one_line(words[0], 40), *beginning.begin()),
                remedy);
    };
    while (lines.next(words, 0)) {
        if (words[0] != "solid") lines.fail(fmt::format("begins with \"{}\"", one_line(words[0], 40)), remedy);
        for (;;) {
            if (!lines.next(words, 0)) lines.fail("ends before \"endsolid\"", remedy);
            if (words[0] == "endsolid") break;
            if (words[0] != "facet") lines.fail(fmt::format("begins with \"{}\"", one_line(words[0], 40)), remedy);
            expect({"outer", "loop"});
            std::array<Vector3<double>, 3> corners;
            for (Vector3<double>& corner : corners) {
                expect({"vertex"});
                if (words.size() != 4) lines.fail("has a vertex that does not have 3 coordinates", remedy);
                corner = lines.point(words);
            }
            expect({"endloop"});
            expect({"endfacet"});
            add_triangle(mesh, corners);
            require_bounded(mesh, path);
        }
    }
    return mesh;
}

// 80 bytes, the number of triangles, then per triangle 12 binary32 (normal, vertices) and two bytes; little-endian
constexpr std::size_t stl_header = 84, stl_triangle = 50;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (int i = 3; i >= 0; --i)
        value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
    return value;
}

Mesh parse_binary_stl(std::string_view bytes, const std::string& path) {
    const auto refuse = [&](const std::string& fault) {
        throw InputError(path, "", fault, "give a binary STL file of 84 + 50 n bytes, or a text STL file");
    };
    if (bytes.size() < stl_header) refuse(fmt::format("has {} bytes: the header is truncated", bytes.size()));
    const std::size_t count = word_at(bytes, 80);
    if (bytes.size() != stl_header + stl_triangle * count)
        refuse(fmt::format("declares {} triangles, but has {} bytes instead of {}", count, bytes.size(),
                           stl_header + stl_triangle * count));
    if (count > most_triangles)
        throw InputError(path, "", fmt::format("has more than {} triangles", most_triangles), "give a coarser surface");
    Mesh mesh;
    for (std::size_t t = 0; t < count; ++t) {
        std::array<Vector3<double>, 3> corners;
        for (std::size_t i = 0; i < 9; ++i) {
            const float x = std::bit_cast<float>(word_at(bytes, stl_header + stl_triangle * t + 12 + 4 * i));
            if (!std::isfinite(x)) refuse(fmt::format("has a coordinate in triangle {} that is not finite", t + 1));
            corners[i / 3][i % 3] = static_cast<double>(x);
        }
        add_triangle(mesh, corners);
    }
    return mesh;
}

Mesh parse_stl(std::string_view bytes, const std::string& path) {
    // a binary file may also begin with "solid"; its size identifies it
    const bool binary_by_size =
        bytes.size() >= stl_header && bytes.size() == stl_header + stl_triangle * word_at(bytes, 80);
    if (!binary_by_size && bytes.substr(0, 5) == "solid" && bytes.find('\0') == bytes.npos)
        return parse_text_stl(bytes, path);
    return parse_binary_stl(bytes, path);
}

bool ends_in(const std::string& path, std::string_view ending) {
    return path.size() >= ending.size() &&
           std::equal(ending.rbegin(), ending.rend(), path.rbegin(),
                      [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
}

}  // namespace

Mesh parse_mesh(std::string_view bytes, const std::string& path) {
    Mesh mesh;
    if (ends_in(path, ".obj"))
        mesh = parse_obj(bytes, path);
    else if (ends_in(path, ".stl"))
        mesh = parse_stl(bytes, path);
    else
        throw InputError(path, "", "is neither .obj nor .stl", "give a surface in OBJ or STL format");
    if (const std::string fault = mesh_fault(mesh); !fault.empty())
        throw InputError(path, "", fault, "give a closed surface of consistently oriented triangles");
    const double size = enclosed_volume(mesh);
    if (!std::isfinite(size))
        throw InputError(path, "", "encloses a volume that is too large for binary64", "give smaller coordinates");
    if (size == 0) throw InputError(path, "", "encloses no volume", "give the closed surface of a solid");
    if (size < 0)
        for (std::array<int, 3>& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    return mesh;
}

MeshFile read_mesh(const std::string& path) {
    const std::string bytes = read_text(path, largest_mesh_file, expected_file);
    return {parse_mesh(bytes, path), content_hash(bytes)};
}

MeshFile read_mesh(const std::string& folder, const std::string& name) {
    const std::string bytes = read_named_text(folder, name, largest_mesh_file, expected_file);
    return {parse_mesh(bytes, path_in(folder, name)), content_hash(bytes)};
}

}  // namespace polhode
