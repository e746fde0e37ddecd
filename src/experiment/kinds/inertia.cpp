// The kind `inertia`: error and computing time of inertia tensors as sums over point masses, compared with closed forms
// and surface integrals.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "body/filling.h"
#include "body/tessellation.h"
#include "experiment/kinds/inertia_error.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "figure/curve_style.h"
#include "measure/statistics.h"

namespace polhode {
namespace {

using Properties = MassProperties<double>;

constexpr double unit_mass = 1;

struct Way {
    std::string shape, way;
    long pieces;  ///< points or triangles
    std::function<Properties()> work;
    Matrix3<Wide> truth;
};

// sum m (r^2 1 - r r^T) over the points, about their centre of mass
Properties sum_points(const std::vector<PointMass<double>>& points) {
    double total = 0;
    Vector3<double> moment;
    Matrix3<double> second;
    for (const PointMass<double>& p : points) {
        total += p.mass, moment = moment + p.mass * p.position;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j <= i; ++j) second[i][j] += p.mass * p.position[i] * p.position[j];
    }
    const Vector3<double> center = (1 / total) * moment;
    Properties body{total, center, {}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) second[i][j] = second[j][i] = second[i][j] - total * center[i] * center[j];
    const double trace = second[0][0] + second[1][1] + second[2][2];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) body.inertia[i][j] = (i == j ? trace : 0) - second[i][j];
    return body;
}

Properties integrate_surface(const Mesh& mesh) { return uniform_body(mesh_extent<double>(mesh), unit_mass); }

const std::pair<const char*, Shape> inertia_shapes[] = {
    {"box", Box{{0.3, 0.2, 0.1}}}, {"sphere", SolidSphere{0.25}}, {"torus", Torus{0.3, 0.1}}, {"cone", Cone{0.2, 0.4}}};

// Appends the ways to compute the inertia of a shape.
void add_ways(std::vector<Way>& ways, const char* name, const Shape& shape, bool quick) {
    const Matrix3<Wide> truth = body_from_mass<Wide>(shape, unit_mass).inertia;
    const auto add = [&, shape_name = std::string(name)](const char* way, std::size_t pieces,
                                                         std::function<Properties()> work) {
        ways.push_back({shape_name, way, static_cast<long>(pieces), std::move(work), truth});
    };
    add("closed_form", 1, [shape] { return body_from_mass<double>(shape, unit_mass); });
    for (int n = 4; n <= (quick ? 32 : 128); n *= 2) {
        const std::size_t count = grid_points(shape, unit_mass, n).size();
        add("grid", count, [shape, n] { return sum_points(grid_points(shape, unit_mass, n)); });
    }
    for (long n = 64; n <= (quick ? 4096 : 1048576); n *= 4)
        add("monte_carlo", static_cast<std::size_t>(n),
            [shape, n] { return sum_points(random_points(shape, unit_mass, n, 1)); });
    const auto surface = [&](Mesh mesh) {
        const std::size_t triangles = mesh.triangles.size();
        add("mesh", triangles, [mesh = std::move(mesh)] { return integrate_surface(mesh); });
    };
    if (const auto* box = std::get_if<Box>(&shape)) surface(tessellate(*box));
    if (const auto* sphere = std::get_if<SolidSphere>(&shape))
        for (int level = 0; level <= (quick ? 4 : 6); ++level) surface(tessellate(*sphere, level));
    if (const auto* torus = std::get_if<Torus>(&shape))
        for (int n = 8; n <= (quick ? 64 : 256); n *= 2) surface(tessellate(*torus, n));
}

// Times of each way. They are timed in turn, so that disturbances of the machine affect all alike.
std::vector<std::vector<double>> time_ways(const std::vector<Way>& ways, int rounds) {
    std::vector<std::vector<double>> seconds(ways.size());
    double sum = 0;
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < ways.size(); ++i)
            seconds[i].push_back(measure_seconds([&] { sum += ways[i].work().inertia[0][0]; }));
    if (!std::isfinite(sum)) throw std::runtime_error("a sum over a body is not finite");
    return seconds;
}

// Error against computing time: one panel per shape, one curve per way.
NamedFigure draw_inertia(const Table& table) {
    NamedFigure figure{"inertia", {"Error of the inertia against computing time", 2, {}, ""}};
    for (const auto& [name, shape] : inertia_shapes) {
        Panel panel{name, "time (s)", "relative error of the tensor", true, true, {}};
        int place = 0;
        for (const char* way : {"closed_form", "grid", "monte_carlo", "mesh"}) {
            Curve curve;
            curve.label = way;
            set_style(curve, plain_style(place++));
            for (const auto& row : table.rows)
                if (text_of(row[0]) == name && text_of(row[1]) == way) {
                    curve.x.push_back(std::get<double>(row[4]));
                    // zero cannot be drawn on a logarithmic axis
                    curve.y.push_back(std::max(std::get<double>(row[5]), 0x1p-54));
                }
            if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
        }
        figure.figure.panels.push_back(std::move(panel));
    }
    figure.figure.note = "An error of zero is drawn at 2^-54.";
    return figure;
}

}  // namespace

Findings run_inertia(const Plan& plan, const RunOptions& options) {
    std::vector<Way> ways;
    for (const auto& [name, shape] : inertia_shapes) add_ways(ways, name, shape, options.quick);
    const std::vector<std::vector<double>> seconds =
        time_ways(ways, std::min(plan.experiment.repeats, options.quick ? 3 : 1000));
    Findings result;
    NamedTable table = make_named_table("", "",
                                        {{"shape", "shape"},
                                         {"way", "computed by"},
                                         {"pieces", "points or triangles"},
                                         {"seconds_min", ""},
                                         {"seconds_median", "time (s)"},
                                         {"inertia_error", "relative error of the tensor"}});
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const Way& way = ways[i];
        table.table.rows.push_back({way.shape, way.way, way.pieces,
                                    *std::min_element(seconds[i].begin(), seconds[i].end()), median(seconds[i]),
                                    relative_error(way.work().inertia, way.truth)});
    }
    result.figures.push_back(draw_inertia(table.table));
    result.tables.push_back(std::move(table));
    return result;
}

}  // namespace polhode
