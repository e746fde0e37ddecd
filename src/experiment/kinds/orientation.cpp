// The kind `orientation`: measures the claims about orientation in D. Fleck's slides. Interpolated angles, the order of
// angles and of matrices, reflections, vertices that are rotated incrementally, inertia summed over world points.
#include "body/orientation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "body/mass_properties.h"
#include "experiment/kinds/curves.h"
#include "experiment/kinds/inertia_error.h"
#include "experiment/kinds/kinds.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "measure/statistics.h"

namespace polhode {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr EulerSequence yaw_pitch_roll = EulerSequence::zyx;

Quaternion<double> from_degrees(const EulerAngles& a) {
    return quaternion_from_euler(yaw_pitch_roll, {a[0] * degree, a[1] * degree, a[2] * degree});
}

std::string format_degrees(const EulerAngles& a) { return text_of(a[0]) + " " + text_of(a[1]) + " " + text_of(a[2]); }

// Interpolation between two orientations

constexpr int pieces = 1000;

/// Length and speed of a path from one orientation to another, in `pieces` steps of equal time.
struct Route {
    double length = 0;                                                      ///< rad
    double slowest = std::numeric_limits<double>::infinity(), fastest = 0;  ///< rad per step
};
template <class At>
Route measure_route(const At& at) {
    Route way;
    Quaternion<double> before = at(0.0);
    for (int k = 1; k <= pieces; ++k) {
        const Quaternion<double> q = at(k / static_cast<double>(pieces));
        const double turn = rotation_angle_between(q, before);
        way.length += turn;
        way.slowest = std::min(way.slowest, turn), way.fastest = std::max(way.fastest, turn);
        before = q;
    }
    return way;
}

NamedTable interpolation() {
    const struct {
        const char* what;
        EulerAngles from, to;  ///< degrees
    } pairs[] = {{"about one axis", {0, 0, 0}, {90, 0, 0}},
                 {"about three axes", {30, 20, 10}, {80, -30, 120}},
                 {"yaw through 180 degrees", {170, 0, 0}, {-170, 0, 0}},
                 {"roll and yaw through 180 degrees", {175, 30, -170}, {-160, 40, 165}},
                 {"through the vertical, pitch 80 at both ends", {0, 80, 0}, {180, 80, 180}},
                 {"near the vertical", {0, 89, 0}, {90, 89, 0}},
                 {"roll equal to yaw, to near the vertical", {0, 60, 0}, {170, 89, 170}},
                 {"near half a revolution", {0, 0, 0}, {170, 10, 40}}};
    NamedTable table =
        make_named_table("", "Interpolated Euler angles (z-y-x) against slerp, in 1000 steps of equal time",
                         {{"pair", "pair"},
                          {"from_degrees", "from yaw, pitch, roll (deg)"},
                          {"to_degrees", "to yaw, pitch, roll (deg)"},
                          {"interpolation", "interpolation"},
                          {"length", "path length (rad)"},
                          {"shortest", ""},
                          {"length_ratio", "path length / shortest"},
                          {"largest_jump", "largest rotation in a step (rad)"},
                          {"speed_ratio", "fastest / slowest"}});
    for (const auto& pair : pairs) {
        const Quaternion<double> a = from_degrees(pair.from), b = from_degrees(pair.to);
        const double shortest = rotation_angle_between(a, b);
        const auto add = [&](const char* name, const Route& way) {
            table.table.rows.push_back({std::string(pair.what), format_degrees(pair.from), format_degrees(pair.to),
                                        std::string(name), way.length, shortest, way.length / shortest, way.fastest,
                                        way.fastest / way.slowest});
        };
        add("euler_angles", measure_route([&](double t) {
                EulerAngles now{};
                for (std::size_t i = 0; i < 3; ++i) now[i] = pair.from[i] + t * (pair.to[i] - pair.from[i]);
                return from_degrees(now);
            }));
        add("slerp", measure_route([&](double t) { return slerp(a, b, t); }));
    }
    return table;
}

/// A body rotates at a constant rate about an axis that is inclined to the horizontal by `distance`, so that its nose
/// passes the vertical at this distance. Its orientation is given at keys every 9 degrees and interpolated between
/// them.
NamedTable keys() {
    constexpr int count = 20;
    NamedTable table = make_named_table("keys", "Interpolation between 21 keys of half a revolution past gimbal lock",
                                        {{"distance", "distance from gimbal lock (rad)"},
                                         {"interpolation", "interpolation"},
                                         {"largest_angle_change", "largest change of an angle between keys (rad)"},
                                         {"attitude_error", "largest attitude error (rad)"},
                                         {"largest_jump", "largest rotation in 1/50 of a key interval (rad)"}});
    for (const double distance : {1.0, 0.1, 0.01, 0.001}) {
        // yaw goes from 100 to 280 degrees, so it passes 180 degrees regardless of rounding
        const Quaternion<double> start = quaternion_from_euler(yaw_pitch_roll, {100 * degree, 0, distance});
        const auto motion = [&](double t) {  // t in keys
            return start * quaternion_from_axis_angle({{0, 1, 0}, t * std::numbers::pi / count});
        };
        std::vector<EulerAngles> wrapped, unwrapped;
        for (int k = 0; k <= count; ++k) {
            const EulerAngles a = euler_from_quaternion(yaw_pitch_roll, motion(k));
            wrapped.push_back(a);
            unwrapped.push_back(a);
            // unwrap: the angle nearest to that of the previous key
            if (k > 0)
                for (std::size_t i = 0; i < 3; ++i) {
                    const double full = 2 * std::numbers::pi, before = unwrapped[unwrapped.size() - 2][i];
                    unwrapped.back()[i] += full * std::round((before - a[i]) / full);
                }
        }
        const auto add = [&](const char* name, std::optional<double> change, const auto& at) {
            double error = 0, jump = 0;
            Quaternion<double> before = motion(0);
            for (int n = 0; n < 50 * count; ++n) {
                const int k = n / 50;
                const double t = (n % 50) / 50.0;
                const Quaternion<double> q = at(static_cast<std::size_t>(k), t);
                error = std::max(error, rotation_angle_between(q, motion(k + t)));
                jump = std::max(jump, rotation_angle_between(q, before));
                before = q;
            }
            table.table.rows.push_back({distance, std::string(name), cell_of(change), error, jump});
        };
        const auto add_angles = [&](const char* name, const std::vector<EulerAngles>& angles) {
            double change = 0;
            for (std::size_t k = 0; k < count; ++k)
                for (std::size_t i = 0; i < 3; ++i)
                    change = std::max(change, std::abs(angles[k + 1][i] - angles[k][i]));
            add(name, change, [&](std::size_t k, double t) {
                EulerAngles now{};
                for (std::size_t i = 0; i < 3; ++i) now[i] = angles[k][i] + t * (angles[k + 1][i] - angles[k][i]);
                return quaternion_from_euler(yaw_pitch_roll, now);
            });
        };
        add_angles("euler_angles in (-180, 180]", wrapped);
        add_angles("euler_angles, unwrapped", unwrapped);
        add("slerp", std::nullopt, [&](std::size_t k, double t) {
            return slerp(motion(static_cast<double>(k)), motion(static_cast<double>(k + 1)), t);
        });
    }
    return table;
}

// Order of rotations

/// The slide's angles, X = 20, Y = 5, Z = 15 degrees, in each order of three different axes.
NamedTable angle_order() {
    const double about[] = {20 * degree, 5 * degree, 15 * degree};
    const auto turned = [&](EulerSequence sequence) {
        EulerAngles angles{};
        for (std::size_t i = 0; i < 3; ++i) angles[i] = about[static_cast<std::size_t>(name_of(sequence)[i] - 'x')];
        return quaternion_from_euler(sequence, angles);
    };
    NamedTable table{"angle_order",
                     "Angle between the orientations of X = 20, Y = 5, Z = 15 degrees in each order (rad)",
                     {{"sequence", "extrinsic"}, {}}};
    for (const EulerSequence other : euler_sequences)
        if (!is_proper(other)) table.table.columns.push_back("from_" + std::string(name_of(other)));
    for (const EulerSequence sequence : euler_sequences) {
        if (is_proper(sequence)) continue;
        const std::string name(name_of(sequence));
        std::vector<Cell> row{name, std::string(name.rbegin(), name.rend())};
        for (const EulerSequence other : euler_sequences)
            if (!is_proper(other)) row.emplace_back(rotation_angle_between(turned(sequence), turned(other)));
        table.table.rows.push_back(std::move(row));
    }
    return table;
}

/// Measures the slide's claim "To combine rotations A*B = N, rotating first by A then B is the same as just multiplying
/// by N", with its convention A*V = V'.
NamedTable matrix_order() {
    const Matrix3<double> A = rotation_matrix(quaternion_from_axis_angle({{1, 0, 0}, 20 * degree})),
                          B = rotation_matrix(quaternion_from_axis_angle({{0, 0, 1}, 15 * degree}));
    const Vector3<double> V(1, 2, 3);
    const Vector3<double> first_A_then_B = B * (A * V);
    NamedTable table = make_named_table(
        "matrix_order",
        "B (A V) against one product: A rotates V = (1, 2, 3) by 20 degrees about x, then B by 15 degrees "
        "about z",
        {{"product", "product"},
         {"meaning", "meaning"},
         {"difference", "difference of the vector / |V|"},
         {"angle", "difference of the rotation (rad)"}});
    const auto add = [&](const char* product, const char* meaning, const Matrix3<double>& N, const Vector3<double>& W) {
        const Vector3<double> d = W - first_A_then_B;
        const double angle = rotation_angle_between(quaternion_from_matrix(N), quaternion_from_matrix(B * A));
        table.table.rows.push_back(
            {std::string(product), std::string(meaning), std::sqrt(dot(d, d) / dot(V, V)), angle});
    };
    const Matrix3<double> AB = A * B, BA = B * A, rows = transposed(A) * transposed(B);
    add("(A B) V",
        "the slide's N = A B with its V' = A V: first B, then A about fixed axes; or first A, then B about rotated "
        "axes",
        AB, AB * V);
    add("(B A) V", "first A, then B, both about fixed axes", BA, BA * V);
    add("V^T (A^T B^T)", "row vectors instead of column vectors: the first rotation is the left factor",
        transposed(rows), transposed(rows) * V);
    return table;
}

// Rotations and reflections

NamedTable reflection() {
    const Matrix3<double> R = rotation_matrix(from_degrees({40, 20, -30}));
    Matrix3<double> drifted = R;
    const Vector3<double> w(0.1, 0.2, 0.3);
    for (int n = 0; n < 100; ++n) drifted = drifted + skew(0.01 * w) * drifted;
    Matrix3<double> exchanged = R;
    std::swap(exchanged[0], exchanged[1]);
    NamedTable table{"reflection",
                     "Matrices that are accepted as orientations",
                     {{"matrix", "determinant", "defect", "accepted", "message"}, {}}};
    const std::pair<const char*, Matrix3<double>> matrices[] = {
        {"a rotation", R},
        {"one axis mirrored", R * diagonal(Vector3<double>(1, 1, -1))},
        {"all axes mirrored", R * diagonal(Vector3<double>(-1, -1, -1))},
        {"two rows exchanged", exchanged},
        {"two axes mirrored (a rotation by half a revolution)", R * diagonal(Vector3<double>(-1, -1, 1))},
        {"scaled by 1.1", R * diagonal(Vector3<double>(1.1, 1.1, 1.1))},
        {"100 steps A += h skew(w) A, h |w| = 0.0037", drifted},
        {"100 steps A += h skew(w) A, re-orthogonalised", reorthogonalise(drifted)}};
    for (const auto& [what, A] : matrices) {
        std::string message;
        try {
            require_rotation(A);
        } catch (const std::invalid_argument& refused) {
            message = refused.what();
        }
        table.table.rows.push_back({std::string(what), determinant(A), orthogonality_defect(A),
                                    std::string(message.empty() ? "yes" : "no"), message});
    }
    return table;
}

// Vertices

/// Three vertices at unit distance on the axes, rotated by the same R in each step.
template <class S>
void rotate_vertices(const char* scalar, long most, Table& table) {
    // 1/64 rad per step about (1, -2, 2)/3
    const Quaternion<double> turn = quaternion_from_axis_angle({{1, -2, 2}, 1.0 / 64});
    const Quaternion<S> step = cast<S>(turn);
    const Matrix3<S> R = rotation_matrix(step);
    Matrix3<S> moved = diagonal(Vector3<S>(S(1), S(1), S(1)));
    Quaternion<S> q{S(1), S(0), S(0), S(0)}, free = q;
    long n = 0;
    for (long stop = 10; stop <= most; stop *= 10) {
        for (; n < stop; ++n) {
            moved = R * moved;
            q = normalized(step * q);
            free = step * free;
        }
        const auto add = [&](const char* way, const Matrix3<S>& A) {
            const Matrix3<double> columns = cast<double>(A);
            // n/128, the half angle, is exact in binary64
            const Quaternion<double> truth = quaternion_from_axis_angle({{1, -2, 2}, static_cast<double>(n) / 64});
            const double error = rotation_angle_between(quaternion_from_rotation(nearest_rotation(columns)), truth);
            table.rows.push_back({std::string(scalar), std::string(way), n, orthogonality_defect(columns), error});
        };
        add("V <- R V", moved);
        add("V = A(q) V0, q <- theta q normalised", rotation_matrix(q));
        add("V = A(q) V0, q <- theta q", rotation_matrix(free));
    }
}

NamedTable vertices(bool quick) {
    NamedTable table = make_named_table(
        "vertices", "Three vertices rotated by 1/64 rad per step, from the previous vertices or from the original ones",
        {{"scalar", "precision"},
         {"way", "update"},
         {"steps", "steps"},
         {"defect", "|V^T V - 1|"},
         {"attitude_error", "attitude error (rad)"}});
    rotate_vertices<float>("binary32", quick ? 100000 : 1000000, table.table);
    rotate_vertices<double>("binary64", quick ? 100000 : 1000000, table.table);
    return table;
}

// The inertia in world axes

/// n^3 equal masses on a grid along the principal axes, scaled so that the sum equals the tensor of the moments. The
/// positions 2 k - (n - 1), k = 0 .. n - 1, have the mean square (n^2 - 1)/3.
template <class S>
std::vector<PointMass<S>> grid_body(int n, const Vector3<double>& moments, double mass) {
    Vector3<double> scale;
    for (int i = 0; i < 3; ++i) {
        const double second = (moments[(i + 1) % 3] + moments[(i + 2) % 3] - moments[i]) / (2 * mass);
        scale[i] = std::sqrt(3 * second / (n * n - 1));
    }
    std::vector<PointMass<S>> points;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                points.push_back(
                    {S(mass / (n * n * n)), Vector3<S>(S(scale[0] * (2 * i - n + 1)), S(scale[1] * (2 * j - n + 1)),
                                                       S(scale[2] * (2 * k - n + 1)))});
    return points;
}

/// sum m (r^2 1 - r r^T) over r = A r(0)
template <class S>
Matrix3<S> sum_rotated(const std::vector<PointMass<S>>& points, const Matrix3<S>& A) {
    Matrix3<S> sum;
    for (const PointMass<S>& point : points) sum = sum + parallel_axis(point.mass, A * point.position);
    return sum;
}

struct InertiaSum {
    std::string scalar, way;
    std::optional<long> points;
    double error = 0;
    std::vector<double> seconds{};
};

template <class S>
void sum_inertia(const char* scalar, int rounds, std::vector<InertiaSum>& found) {
    const Vector3<double> moments(1, 2, 2.5);
    const Quaternion<double> q = from_degrees({40, 20, -30});
    const Matrix3<Wide> exact = rotation_matrix(normalized(cast<Wide>(q)));
    const Matrix3<Wide> truth = exact * diagonal(cast<Wide>(moments)) * transposed(exact);
    const Matrix3<S> I = diagonal(cast<S>(moments));
    const auto measure = [&](const char* way, std::optional<long> points, const auto& tensor) {
        // the orientation changes slightly in each frame, so that no compiler hoists the sum out of the loop
        Quaternion<S> turned = cast<S>(q);
        InertiaSum inertia_sum{scalar, way, points,
                               relative_error(cast<double>(tensor(rotation_matrix(turned))), truth)};
        S sum = S(0);
        for (int round = 0; round < rounds; ++round)
            inertia_sum.seconds.push_back(measure_seconds([&] {
                turned.w = turned.w + S(1e-6);
                sum = sum + tensor(rotation_matrix(turned))[0][0];
            }));
        if (!std::isfinite(sum)) throw std::runtime_error("an inertia tensor is not finite");
        found.push_back(std::move(inertia_sum));
    };
    measure("A I A^T", std::nullopt, [&](const Matrix3<S>& A) { return A * I * transposed(A); });
    for (const int n : {2, 4, 8, 16}) {
        const std::vector<PointMass<S>> points = grid_body<S>(n, moments, 2);
        measure("sum over world points", static_cast<long>(points.size()),
                [&](const Matrix3<S>& A) { return sum_rotated(points, A); });
    }
}

NamedTable inertia(int rounds) {
    std::vector<InertiaSum> found;
    sum_inertia<float>("binary32", rounds, found);
    sum_inertia<double>("binary64", rounds, found);
    NamedTable table = make_named_table(
        "inertia", "The inertia tensor in world axes, computed in each frame: sum over world points, or A I A^T",
        {{"scalar", "precision"},
         {"way", "computed by"},
         {"points", "points"},
         {"seconds_min", ""},
         {"seconds_median", "time per frame (s)"},
         {"inertia_error", "relative error of the tensor"}});
    for (const InertiaSum& s : found)
        table.table.rows.push_back({s.scalar, s.way, cell_of(s.points),
                                    *std::min_element(s.seconds.begin(), s.seconds.end()), median(s.seconds), s.error});
    return table;
}

}  // namespace

Findings run_orientation(const Plan& plan, const RunOptions& options) {
    Findings result;
    result.tables = {interpolation(),
                     keys(),
                     angle_order(),
                     matrix_order(),
                     reflection(),
                     vertices(options.quick),
                     inertia(std::min(plan.experiment.repeats, options.quick ? 3 : 1000))};

    const Table& drift = std::ranges::find(result.tables, "vertices", &NamedTable::name)->table;
    NamedFigure figure{"orientation_vertices", {"Drift of vertices that are rotated in each step", 2, {}, ""}};
    for (const char* scalar : {"binary32", "binary64"}) {
        Panel panel{scalar, "steps", "|V^T V - 1|", true, true, {}};
        for (const auto& row : drift.rows) {
            if (text_of(row[0]) != scalar) continue;
            Curve& curve = find_or_add_curve(panel.curves, text_of(row[1]));
            curve.x.push_back(static_cast<double>(std::get<long>(row[2])));
            curve.y.push_back(std::get<double>(row[3]));
        }
        figure.figure.panels.push_back(std::move(panel));
    }
    result.figures.push_back(std::move(figure));
    return result;
}

}  // namespace polhode
