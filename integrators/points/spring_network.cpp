#include "integrators/points/spring_network.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace polhode {

void SpringNetwork::accelerations(const double* r, double* a) const {
    const int n = body_->count();
    std::fill(a, a + 3 * n, 0.0);
    for (const Link& link : body_->links) {
        const Vector3<double> d = vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j);
        const double length = std::sqrt(dot(d, d));
        const Vector3<double> pull = (specific_stiffness_ * (link.length - length) / length) * d;
        put(a, 3 * link.i, vector_at(a, 3 * link.i) + pull);
        put(a, 3 * link.j, vector_at(a, 3 * link.j) - pull);
    }
    if (!body_->pivoted) return;
    Vector3<double> held;
    for (int i = 0; i < n; ++i) held = held + body_->pivot_weights[i] * vector_at(r, 3 * i);
    for (int i = 0; i < n; ++i)
        put(a, 3 * i, vector_at(a, 3 * i) - (specific_stiffness_ * body_->pivot_weights[i]) * held);
}

Eigen::MatrixXd SpringNetwork::jacobian(const double* r) const {
    const int n = body_->count();
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (const Link& link : body_->links) {
        const Vector3<double> d = vector_at(r, 3 * link.i) - vector_at(r, 3 * link.j);
        const double length = std::sqrt(dot(d, d)), tension = 1 - link.length / length;
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

SpringFrequencies spring_frequencies(const PointBody& body, double stiffness) {
    std::vector<double> rest(3 * body.rest_B.size());
    // the pivot rests at the origin
    Vector3<double> held;
    for (int i = 0; body.pivoted && i < body.count(); ++i) held = held + body.pivot_weights[i] * body.rest_B[i];
    for (int i = 0; i < body.count(); ++i) put(rest.data(), 3 * i, body.rest_B[i] - held);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(-SpringNetwork(body, stiffness).jacobian(rest.data()),
                                                                Eigen::EigenvaluesOnly);
    const Eigen::VectorXd& squares = solver.eigenvalues();
    // a rigid motion costs nothing: 6 of them, 3 about a pivot
    const Eigen::Index rigid = body.pivoted ? 3 : 6;
    return {std::sqrt(std::max(0.0, squares[rigid])), std::sqrt(squares[squares.size() - 1])};
}

double default_stiffness(const Problem& problem, const PointBody& body) {
    constexpr double ratio = 1e3;
    const double rate = std::max(problem.scales.angular_velocity, 1 / problem.scene.duration);
    const double wanted = ratio * rate / spring_frequencies(body, 1).slowest;
    return wanted * wanted;
}

}  // namespace polhode
