// Reads tables of initial states and parameters of mechanisms. ColumnMaker lists the columns of each joint and body;
// each column refers to a number in a Scene.

#include "motion/mechanism_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace polhode {
namespace {

// The columns of one joint or body.
class ColumnMaker {
  public:
    ColumnMaker(std::vector<MechanismColumn>& all, std::string owner) : all_(all), owner_(std::move(owner)) {}

    template <class Number>
    void alone(const char* name, Number number, std::function<void(Scene&)> prepare = {}) {
        all_.push_back({owner_ + "." + name, owner_ + "." + name, std::move(number), std::move(prepare), true});
    }
    // a parameter of the mechanism, not of its initial state
    template <class Number>
    void constant(const char* name, Number number, std::function<void(Scene&)> prepare = {}) {
        alone(name, std::move(number), std::move(prepare));
        all_.back().is_start = false;
    }
    // `part(scene, i)`: the i-th number of a block
    template <class Part>
    void block(std::initializer_list<const char*> names, Part part) {
        std::vector<std::string> full;
        for (const char* name : names) full.push_back(owner_ + "." + name);
        const std::string block = fmt::format("{}", fmt::join(full, ","));
        for (std::size_t i = 0; i < full.size(); ++i)
            all_.push_back({full[i], block, [part, i](Scene& scene) -> double& { return part(scene, i); }, {}, true});
    }

  private:
    std::vector<MechanismColumn>& all_;
    std::string owner_;
};

double& part_of(Quaternion<double>& q, std::size_t i) { return i == 0 ? q.w : i == 1 ? q.x : i == 2 ? q.y : q.z; }

void add_joint(std::vector<MechanismColumn>& all, const Scene& scene, std::size_t j) {
    ColumnMaker make(all, scene.joints[j].name);
    const auto number = [j](std::array<double, 2> Joint::*member, std::size_t i) {
        return [j, member, i](Scene& s) -> double& { return (s.joints[j].*member)[i]; };
    };
    const auto one_coordinate = [&](const char* coordinate, const char* rate) {
        make.alone(coordinate, number(&Joint::coordinate, 0)), make.alone(rate, number(&Joint::rate, 0));
        make.constant("stiffness", number(&Joint::stiffness, 0)), make.constant("rest", number(&Joint::rest, 0));
        make.constant("damping", number(&Joint::damping, 0));
    };
    switch (scene.joints[j].type) {
        case JointType::revolute:
            one_coordinate("angle", "rate");
            break;
        case JointType::prismatic:
            one_coordinate("displacement", "speed");
            break;
        case JointType::universal:
            make.alone("angle1", number(&Joint::coordinate, 0)), make.alone("angle2", number(&Joint::coordinate, 1));
            make.alone("rate1", number(&Joint::rate, 0)), make.alone("rate2", number(&Joint::rate, 1));
            break;
        case JointType::spherical:
            make.block({"qw", "qx", "qy", "qz"},
                       [j](Scene& s, std::size_t i) -> double& { return part_of(s.joints[j].orientation, i); });
            make.block({"wx", "wy", "wz"}, [j](Scene& s, std::size_t i) -> double& {
                return s.joints[j].angular_velocity[static_cast<int>(i)];
            });
            break;
        case JointType::fixed:
            break;
    }
}

void add_body(std::vector<MechanismColumn>& all, const Scene& scene, std::size_t b) {
    const std::string& name = scene.bodies[b].name;
    ColumnMaker make(all, name);
    // without its source: the description no longer determines the mass
    make.constant(
        "mass", [b](Scene& s) -> double& { return s.bodies[b].body.mass; },
        [b](Scene& s) { s.bodies[b].body.source = nullptr; });
    if (std::ranges::any_of(scene.joints, [&](const Joint& joint) { return joint.child == name; })) return;
    make.block({"qw", "qx", "qy", "qz"},
               [b](Scene& s, std::size_t i) -> double& { return part_of(s.bodies[b].initial.orientation, i); });
    const auto vector = [&](std::initializer_list<const char*> names, Vector3<double> Initial::*member) {
        make.block(names, [b, member](Scene& s, std::size_t i) -> double& {
            return (s.bodies[b].initial.*member)[static_cast<int>(i)];
        });
    };
    vector({"wx", "wy", "wz"}, &Initial::angular_velocity);
    vector({"px", "py", "pz"}, &Initial::position_W);
    vector({"vx", "vy", "vz"}, &Initial::velocity_W);
}

}  // namespace

std::vector<MechanismColumn> mechanism_columns(const Scene& scene) {
    std::vector<MechanismColumn> all;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) add_joint(all, scene, j);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) add_body(all, scene, b);
    return all;
}

bool MechanismTable::only_starts() const {
    return std::ranges::all_of(columns, [](const MechanismColumn& column) { return column.is_start; });
}

Scene scene_with(const Scene& scene, const std::vector<MechanismColumn>& columns, std::span<const double> numbers) {
    Scene row = scene;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].prepare) columns[i].prepare(row);
        columns[i].number(row) = numbers[i];
    }
    return row;
}

Scene MechanismTable::scene_of(const Scene& scene, std::size_t k) const {
    return scene_with(scene, columns, std::span(numbers).subspan(k * columns.size(), columns.size()));
}

}  // namespace polhode
