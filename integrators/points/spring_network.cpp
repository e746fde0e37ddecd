#include "integrators/points/spring_network.h"

#include <algorithm>
#include <cmath>

#include "integrators/points/stiffness.h"
#include "integrators/series/linear_algebra.h"

namespace polhode {

void SpringNetwork::accelerations(const double* y, double* a) const {
    const int n = body_->count();
    const double *r = y, *v = y + 3 * n;
    std::fill(a, a + 3 * n, 0.0);
    for (const PointLink& link : body_->links) {
        const Vector3<double> d = vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j);
        const double square = dot(d, d), length = std::sqrt(square);
        double pull = (link.length - length) / length;
        if (is_damped())
            pull -= damping_per_stiffness_ * dot(d, vector_at(v, 3 * link.i) - vector_at(v, 3 * link.j)) / square;
        const Vector3<double> force = (specific_stiffness_ * pull) * d;
        put(a, 3 * link.i, vector_at(a, 3 * link.i) + force);
        put(a, 3 * link.j, vector_at(a, 3 * link.j) - force);
    }
    if (!body_->pivoted) return;
    Vector3<double> pivot_point;
    for (int i = 0; i < n; ++i)
        pivot_point = pivot_point +
                      body_->pivot_weights[i] * (vector_at(r, 3 * i) + damping_per_stiffness_ * vector_at(v, 3 * i));
    for (int i = 0; i < n; ++i)
        put(a, 3 * i, vector_at(a, 3 * i) - (specific_stiffness_ * body_->pivot_weights[i]) * pivot_point);
}

Eigen::MatrixXd SpringNetwork::jacobian(const double* r) const { return compute_jacobian(r, false); }

Eigen::MatrixXd SpringNetwork::velocity_jacobian(const double* r) const {
    return damping_per_stiffness_ * compute_jacobian(r, true);
}

Eigen::MatrixXd SpringNetwork::compute_jacobian(const double* r, bool tension_free) const {
    const int n = body_->count();
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (const PointLink& link : body_->links) {
        const Vector3<double> d = vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j);
        const double length = std::sqrt(dot(d, d)), tension = tension_free ? 0 : 1 - link.length / length;
        const Eigen::Vector3d u = Eigen::Vector3d(d[0], d[1], d[2]) / length;
        const Eigen::Matrix3d block =
            specific_stiffness_ * ((1 - tension) * u * u.transpose() + tension * Eigen::Matrix3d::Identity());
        J.block<3, 3>(3 * link.i, 3 * link.i) -= block;
        J.block<3, 3>(3 * link.j, 3 * link.j) -= block;
        J.block<3, 3>(3 * link.i, 3 * link.j) += block;
        J.block<3, 3>(3 * link.j, 3 * link.i) += block;
    }
    if (!body_->pivoted) return J;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            J.block<3, 3>(3 * i, 3 * j).diagonal().array() -=
                specific_stiffness_ * body_->pivot_weights[i] * body_->pivot_weights[j];
    return J;
}

void SpringNetwork::apply_rotation_stretch(const Vector3<double>& angular_velocity_W, double* y) const {
    const Vector3<double>& w = angular_velocity_W;
    const int n = body_->count();
    const PointCloud cloud = compute_cloud(body_->point_mass, y, n);
    // About the pivot, W's origin, if there is one.
    const Vector3<double> origin = body_->pivoted ? Vector3<double>() : cloud.center;
    Matrix3<double> J = cloud.inertia;
    if (body_->pivoted) J = J + parallel_axis(n * body_->point_mass, cloud.center);
    const Vector3<double> w_rate = inverse(J) * cross(J * w, w);
    // Rigid motions, which no spring resists: the stretch must have no component along them.
    Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(3 * n, body_->pivoted ? 3 : 6);
    Eigen::VectorXd needed(3 * n);
    for (int i = 0; i < n; ++i) {
        const Vector3<double> r = vector_at(y, 3 * i) - origin;
        const Vector3<double> a = cross(w, cross(w, r)) + cross(w_rate, r);
        for (int b = 0; b < 3; ++b) {
            needed[3 * i + b] = a[b];
            const int c = (b + 1) % 3, d = (b + 2) % 3;
            rigid(3 * i + d, b) = r[c], rigid(3 * i + c, b) = -r[d];
            if (!body_->pivoted) rigid(3 * i + b, 3 + b) = 1;
        }
    }
    Eigen::MatrixXd K = -jacobian(y);
    const Eigen::MatrixXd Q =
        Eigen::HouseholderQR<Eigen::MatrixXd>(rigid).householderQ() * Eigen::MatrixXd::Identity(3 * n, rigid.cols());
    K += K.trace() / (3 * n) * Q * Q.transpose();
    const Eigen::VectorXd u = -K.ldlt().solve(needed);
    for (int i = 0; i < n; ++i) {
        const Vector3<double> stretch(u[3 * i], u[3 * i + 1], u[3 * i + 2]);
        put(y, 3 * i, vector_at(y, 3 * i) + stretch);
        put(y, 3 * (n + i), vector_at(y, 3 * (n + i)) + cross(w, stretch));
    }
}

SpringFrequencies spring_frequencies(const PointBody& body, double stiffness) {
    std::vector<double> rest(3 * body.rest_B.size());
    // At rest the pivot is at the origin.
    Vector3<double> pivot_point;
    for (int i = 0; body.pivoted && i < body.count(); ++i)
        pivot_point = pivot_point + body.pivot_weights[i] * body.rest_B[i];
    for (int i = 0; i < body.count(); ++i) put(rest.data(), 3 * i, body.rest_B[i] - pivot_point);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(-SpringNetwork(body, stiffness).jacobian(rest.data()),
                                                                Eigen::EigenvaluesOnly);
    const Eigen::VectorXd& squares = solver.eigenvalues();
    // Rigid motions have zero frequency: 6 of them, or 3 with a pivot.
    const Eigen::Index rigid = body.pivoted ? 3 : 6;
    return {std::sqrt(std::max(0.0, squares[rigid])), std::sqrt(squares[squares.size() - 1])};
}

double default_stiffness(const Problem& problem, const PointBody& body) {
    constexpr double ratio = 100;
    const double rate = std::max(problem.scales.angular_velocity, 1 / problem.scene.duration);
    const double target = ratio * rate / spring_frequencies(body, 1).slowest;
    return target * target;
}

double damping_from_ratio(const PointBody& body, double stiffness, double ratio) {
    return 2 * ratio * stiffness / spring_frequencies(body, stiffness).slowest;
}

}  // namespace polhode
