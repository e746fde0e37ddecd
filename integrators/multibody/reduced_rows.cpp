#include "integrators/multibody/reduced_rows.h"

namespace polhode::multibody {

ReducedRows::ReducedRows(const Scene& scene, const Tree<double>& tree) {
    const Links<double>& all = tree.links();
    for (const Link<double>& link : all.links)
        armature_.insert(armature_.end(), std::size_t(link.rates()), link.armature);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const Joint& joint = scene.joints[j];
        const int index = all.link_of_joint[j];
        if (index == world_link || (joint.friction == 0 && !joint.limits.any())) continue;
        const Link<double>& link = all.links[std::size_t(index)];
        joints_.push_back({.coordinate = std::size_t(link.coordinate),
                           .rate = std::size_t(link.rate - all.coordinates),
                           .constraint = constraints_,
                           .has_limits = joint.limits.any(),
                           .friction = joint.friction,
                           .limits = limits_of<double>(joint)});
        constraints_ += (joint.limits.any() ? 1 : 0) + (joint.friction > 0 ? 1 : 0);
    }
    if (joints_.empty()) return;
    std::vector<double> zero(std::size_t(tree.dimension()), 0.0);
    for (const Link<double>& link : all.links)
        if (link.coordinates() > 1) zero[std::size_t(link.coordinate)] = 1;  // q = 1
    factorize(tree, zero.data());
    for (JointLaws& joint : joints_) joint.inverse_inertia = respond(tree, joint.rate, 1)[joint.rate];
}

const std::vector<ReducedRow>& ReducedRows::select(const Tree<double>& tree, const double* y) {
    rows_.clear();
    const double* const rates = y + tree.links().coordinates;
    for (const JointLaws& joint : joints_) {
        const double rate = rates[joint.rate];
        for (const JointLimit<double>& limit : joint.limits)
            if (const double gap = limit.gap_at(y[joint.coordinate]); gap < 0)
                rows_.push_back({.rate = joint.rate,
                                 .constraint = joint.constraint,
                                 .sign = limit.sign,
                                 .gap = gap,
                                 .velocity = limit.sign * rate,
                                 .inverse_inertia = joint.inverse_inertia});
        if (joint.friction > 0)
            rows_.push_back({.rate = joint.rate,
                             .constraint = joint.constraint + (joint.has_limits ? 1 : 0),
                             .friction = joint.friction,
                             .velocity = rate,
                             .inverse_inertia = joint.inverse_inertia});
    }
    return rows_;
}

std::vector<double> ReducedRows::inverse_inertia(const Tree<double>& tree, const double* y) {
    factorize(tree, y);
    responses_.clear();
    for (const ReducedRow& row : rows_) responses_.push_back(respond(tree, row.rate, row.sign));
    std::vector<double> matrix;
    for (const ReducedRow& row : rows_)
        for (const std::vector<double>& response : responses_) matrix.push_back(row.sign * response[row.rate]);
    return matrix;
}

void ReducedRows::apply(const std::vector<double>& forces, double* rates) const {
    for (std::size_t i = 0; i < forces.size(); ++i)
        for (std::size_t k = 0; k < responses_[i].size(); ++k) rates[k] += forces[i] * responses_[i][k];
}

void ReducedRows::factorize(const Tree<double>& tree, const double* y) {
    TreeWork<double>& at = tree.work<double>();
    tree.move(y, at);
    solver_.copy_links(tree, at);
    solver_.factorize(tree, armature_);
}

std::vector<double> ReducedRows::respond(const Tree<double>& tree, std::size_t rate, double force) {
    std::vector<double> torque(armature_.size(), 0.0), response;
    torque[rate] = force;
    solver_.solve(tree, torque, response);
    return response;
}

}  // namespace polhode::multibody
