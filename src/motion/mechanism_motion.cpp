#include "motion/mechanism_motion_of.h"

namespace polhode {

namespace {

template <class Named>
int index_of(const std::vector<Named>& all, const std::string& name) {
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].name == name) return static_cast<int>(i);
    return -1;
}

}  // namespace

int body_index(const Scene& scene, const std::string& name) { return index_of(scene.bodies, name); }
int joint_index(const Scene& scene, const std::string& name) { return index_of(scene.joints, name); }

std::vector<std::string> body_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const NamedBody& body : scene.bodies) names.push_back(body.name);
    return names;
}

std::vector<std::string> joint_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const Joint& joint : scene.joints) names.push_back(joint.name);
    for (const Loop& loop : scene.loops) names.push_back(loop.name);
    return names;
}

JointCoordinates::JointCoordinates(const Scene& scene) {
    for (const Joint& joint : scene.joints)
        values_.push_back(joint.coordinate), rates_.push_back(joint.rate), times_.push_back({});
}

void JointCoordinates::set(double t, std::span<const std::array<double, 2>> values) {
    values_.assign(values.begin(), values.end());
    times_.assign(values_.size(), {t, t});
}

double JointCoordinates::turns(std::size_t joint, std::size_t axis, double t, double angle, double rate) const {
    const double ahead = (t - times_[joint][axis]) * ((rates_[joint][axis] + rate) / 2);
    const double turns = std::round((values_[joint][axis] + ahead - angle) / (2 * std::numbers::pi));
    return std::isfinite(turns) ? turns : 0;
}

void JointCoordinates::keep(std::size_t joint, std::size_t axis, double t, double value, double rate) {
    values_[joint][axis] = value, rates_[joint][axis] = rate, times_[joint][axis] = t;
}

template std::vector<MassProperties<double>> bodies_mass_properties(const Scene& scene);
template std::vector<MassProperties<Wide>> bodies_mass_properties(const Scene& scene);
template class MechanismMeasure<double>;
template class MechanismMeasure<Wide>;

}  // namespace polhode
