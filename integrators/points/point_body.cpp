#include "integrators/points/point_body.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "integrators/series/linear_algebra.h"
#include "scene/body_source.h"

namespace polhode {
namespace {

constexpr double flat_ratio = 1e-6;

using UnitPoints = std::vector<Vector3<double>>;

// Coordinates with unit mean square along each axis.

UnitPoints unit_simplex() { return {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}; }

UnitPoints unit_triangle(int flat_axis) {
    const int x = (flat_axis + 1) % 3, y = (flat_axis + 2) % 3;
    UnitPoints points(3);
    const double c = std::numbers::sqrt2 / 2, s = std::sqrt(1.5);
    points[0][x] = std::numbers::sqrt2;
    points[1][x] = -c, points[1][y] = s;
    points[2][x] = -c, points[2][y] = -s;
    return points;
}

UnitPoints unit_box(int n) {
    // Nodes -1, .., 1 in n - 1 equal steps have the mean square (n + 1) / (3 (n - 1)).
    const double scale = 1 / std::sqrt((n + 1.0) / (3.0 * (n - 1)));
    const auto node = [&](int i) { return scale * (2.0 * i / (n - 1) - 1); };
    UnitPoints points;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) points.push_back({node(i), node(j), node(k)});
    return points;
}

bool are_neighbours(int a, int b, int n) {
    const auto near = [](int i, int j) { return std::abs(i - j) <= 1; };
    return near(a % n, b % n) && near(a / n % n, b / n % n) && near(a / n / n, b / n / n);
}

}  // namespace

PointBody point_body(const Problem& problem, Arrangement arrangement) {
    PointBody body;
    const double mass = problem.body.mass;
    body.pivoted = problem.body.pivoted;

    const MassProperties<Wide> exact = mass_properties<Wide>(problem.scene.body);
    const Wide m = exact.mass;
    const WidePrincipalFrame frame = wide_principal_frame(exact.inertia);
    const Vector3<Wide>& I = frame.moments;
    Vector3<double> a;
    for (int k = 0; k < 3; ++k) {
        const Wide square = (I[(k + 1) % 3] + I[(k + 2) % 3] - I[k]) / (2 * m);
        a[k] = square > 0 ? double(square_root(square)) : 0;
    }
    const double most = std::max({a[0], a[1], a[2]});
    const auto vanishes = [&](int k) { return a[k] < flat_ratio * most; };
    const int vanishing = vanishes(0) + vanishes(1) + vanishes(2);
    if (vanishing > 1) {
        body.refusal = "the body is a thin rod: points on a line do not define the rotation about it";
        return body;
    }
    const bool flat = vanishing == 1;
    const int least = vanishes(0) ? 0 : vanishes(1) ? 1 : 2;
    if (flat) a[least] = 0;
    const bool box = !flat && arrangement.kind == Arrangement::Kind::box;
    const UnitPoints unit = flat ? unit_triangle(least) : box ? unit_box(arrangement.n) : unit_simplex();
    const int count = static_cast<int>(unit.size());
    body.point_mass = mass / count;

    const Quaternion<double> q_BP = rounded(frame).q_BP;
    for (const Vector3<double>& u : unit)
        body.rest_B.push_back(rotate(q_BP, Vector3<double>(a[0] * u[0], a[1] * u[1], a[2] * u[2])));
    body.extent = length(a);
    for (int i = 0; i < count; ++i)
        for (int j = i + 1; j < count; ++j)
            if (!box || arrangement.n == 2 || are_neighbours(i, j, arrangement.n))
                body.links.push_back({i, j, length(body.rest_B[i] - body.rest_B[j])});

    if (body.pivoted) {
        // c_i = (1 + sum_k s_k u_ik / a_k) / N, with sum_i u_ik u_il = N delta_kl; then sum c_i a_k u_ik = s_k.
        const Vector3<double> s = rotate_back(q_BP, -problem.body.arm);
        for (int k = 0; k < 3; ++k)
            if (vanishes(k) && std::abs(s[k]) > flat_ratio * most)
                body.refusal = "the body is flat and its pivot lies outside its plane";
        for (const Vector3<double>& u : unit) {
            double sum = 1;
            for (int k = 0; k < 3; ++k)
                if (!vanishes(k)) sum += s[k] * u[k] / a[k];
            body.pivot_weights.push_back(sum / count);
        }
    }
    return body;
}

std::string point_body_refusal(const Problem& problem) { return point_body(problem, {}).refusal; }

PointCloud compute_cloud(double point_mass, const double* r, int count) {
    PointCloud cloud;
    for (int i = 0; i < count; ++i) cloud.center = cloud.center + vector_at(r, 3 * i);
    cloud.center = (1.0 / count) * cloud.center;
    for (int i = 0; i < count; ++i)
        cloud.inertia = cloud.inertia + parallel_axis(point_mass, vector_at(r, 3 * i) - cloud.center);
    return cloud;
}

Quaternion<double> best_rotation(const std::vector<Vector3<double>>& rest_B, const double* r,
                                 const Vector3<double>& center) {
    Matrix3<double> S;  // S_ab = sum x_a r_b
    for (std::size_t i = 0; i < rest_B.size(); ++i) {
        const Vector3<double> d = vector_at(r, 3 * static_cast<int>(i)) - center;
        for (int a = 0; a < 3; ++a) S[a] = S[a] + rest_B[i][a] * d;
    }
    Eigen::Matrix4d N;
    N << S[0][0] + S[1][1] + S[2][2], S[1][2] - S[2][1], S[2][0] - S[0][2], S[0][1] - S[1][0],  //
        0, S[0][0] - S[1][1] - S[2][2], S[0][1] + S[1][0], S[2][0] + S[0][2],                   //
        0, 0, S[1][1] - S[0][0] - S[2][2], S[1][2] + S[2][1],                                   //
        0, 0, 0, S[2][2] - S[0][0] - S[1][1];
    const Quaternion<double> unknown{std::nan(""), 0, 0, 0};
    if (!N.allFinite()) return unknown;
    N.triangularView<Eigen::StrictlyLower>() = N.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(N);
    if (solver.info() != Eigen::Success) return unknown;
    const Eigen::Vector4d top = solver.eigenvectors().col(3);
    Quaternion<double> q{top[0], top[1], top[2], top[3]};

    // With u = R x: sum (u + delta x u) x d = 0, so that (sum (u.d) 1 - u d^T) delta = sum u x d.
    const Matrix3<double> turned = rotation_matrix(q) * S;  // sum u d^T
    const double trace = turned[0][0] + turned[1][1] + turned[2][2];
    Matrix3<double> slope;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) slope[a][b] = (a == b ? trace : 0) - turned[a][b];
    const Vector3<double> rest(turned[1][2] - turned[2][1], turned[2][0] - turned[0][2], turned[0][1] - turned[1][0]);
    const Vector3<double> delta = inverse(slope) * rest;
    q = normalized(Quaternion<double>{1, delta[0] / 2, delta[1] / 2, delta[2] / 2} * q);
    return q.w < 0 ? Quaternion<double>{-q.w, -q.x, -q.y, -q.z} : q;
}

double largest_stretch(const PointBody& body, const double* r) {
    double worst = 0;
    for (const PointLink& link : body.links) {
        const double distance = length(vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j));
        worst = std::max(worst, std::abs(distance - link.length) / link.length);
    }
    return worst;
}

}  // namespace polhode
