// Inverse mass matrix of a tree in the pose as written.
//
// Each degree of freedom k moves a subtree with the angular velocity w_k and the velocity v_k of the point at the
// world's origin. With the subtree's mass m, first moment s and tensor J about the origin, its momenta are
// P_k = m v_k + w_k x s and L_k = J w_k + s x v_k, and M_jk = w_j . L_k + v_j . P_k for all j above k (composite
// rigid bodies: R. Featherstone 2008, Rigid Body Dynamics Algorithms, chapter 6). The factorisation M = L^T D L
// preserves the zeros of the tree.
#include "scene/mjcf_springs.h"

#include <fmt/format.h>

#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

struct Freedom {
    Vector3<Wide> w, v;
    std::size_t joint, link, above;  // above: the previous degree of freedom in the tree, or none
};

class TreeInertia {
  public:
    TreeInertia(const Robot& robot, const std::vector<double>& armature) : robot_(robot) {
        carrier_.assign(robot.links.size(), none);
        for (std::size_t j = 0; j < robot.joints.size(); ++j) carrier_[robot.joints[j].child] = j;
        place_links();
        add_freedoms();
        add_composites();
        factorize(armature);
    }

    std::size_t size() const { return freedoms_.size(); }
    bool is_regular() const { return regular_; }

    // d / trace of the joint's block of the inverse mass matrix
    Wide mean_inertia(std::size_t joint) const {
        Wide trace = 0;
        int count = 0;
        for (std::size_t k = 0; k < freedoms_.size(); ++k)
            if (freedoms_[k].joint == joint) trace = trace + inverse_entry(k), ++count;
        return Wide(count) / trace;
    }

  private:
    // relies on parents preceding their children, as in a robot read by mjcf_robot()
    void place_links() {
        poses_.resize(robot_.links.size());
        for (std::size_t i = 0; i < robot_.links.size(); ++i) {
            if (carrier_[i] == none) {
                if (i < robot_.places.size()) poses_[i] = robot_.places[i];
                continue;
            }
            const RobotJoint& joint = robot_.joints[carrier_[i]];
            poses_[i] = joint.parent == RobotJoint::world ? joint.placement : poses_[joint.parent] * joint.placement;
        }
    }

    void add(const Vector3<Wide>& w, const Vector3<Wide>& v, std::size_t joint, std::size_t link) {
        freedoms_.push_back({w, v, joint, link, last_[link]});
        last_[link] = freedoms_.size() - 1;
    }

    void add_freedoms() {
        last_.assign(robot_.links.size(), none);
        for (std::size_t i = 0; i < robot_.links.size(); ++i) {
            if (carrier_[i] == none) continue;
            const std::size_t j = carrier_[i];
            const RobotJoint& joint = robot_.joints[j];
            if (joint.parent != RobotJoint::world) last_[i] = last_[joint.parent];
            const Vector3<Wide> point = poses_[i] * joint.point;
            const Vector3<Wide> along = rotate(poses_[i].turn, joint.axes[0]);
            const Vector3<Wide> axis = (Wide(1) / square_root(dot(along, along))) * along;
            if (joint.motion == RobotMotion::revolute) add(axis, cross(point, axis), j, i);
            if (joint.motion == RobotMotion::prismatic) add({}, axis, j, i);
            for (int k = 0; k < 3; ++k) {
                Vector3<Wide> e;
                e[k] = Wide(1);
                if (joint.motion == RobotMotion::free) add({}, e, j, i);
                if (joint.motion == RobotMotion::spherical) add(e, cross(point, e), j, i);
            }
            for (int k = 0; k < 3 && joint.motion == RobotMotion::free; ++k) {
                Vector3<Wide> e;
                e[k] = Wide(1);
                add(e, cross(poses_[i].position, e), j, i);
            }
        }
    }

    // mass, first moment and tensor about the world's origin of each link including all links below it
    void add_composites() {
        mass_.assign(robot_.links.size(), Wide(0));
        first_.resize(robot_.links.size()), second_.resize(robot_.links.size());
        for (std::size_t i = robot_.links.size(); i-- > 0;) {
            if (const auto& own = robot_.links[i].mass) {
                const MassProperties<Wide> there = placed(*own, poses_[i].position, poses_[i].turn);
                mass_[i] = mass_[i] + there.mass;
                first_[i] = first_[i] + there.mass * there.center;
                second_[i] = second_[i] + about_point(there, Vector3<Wide>());
            }
            if (carrier_[i] == none || robot_.joints[carrier_[i]].parent == RobotJoint::world) continue;
            const std::size_t parent = robot_.joints[carrier_[i]].parent;
            mass_[parent] = mass_[parent] + mass_[i];
            first_[parent] = first_[parent] + first_[i];
            second_[parent] = second_[parent] + second_[i];
        }
    }

    Wide& entry(std::size_t i, std::size_t j) { return matrix_[i * freedoms_.size() + j]; }
    const Wide& entry(std::size_t i, std::size_t j) const { return matrix_[i * freedoms_.size() + j]; }

    void factorize(const std::vector<double>& armature) {
        const std::size_t n = freedoms_.size();
        matrix_.assign(n * n, Wide(0));
        for (std::size_t k = 0; k < n; ++k) {
            const Freedom& one = freedoms_[k];
            const Vector3<Wide> P = mass_[one.link] * one.v + cross(one.w, first_[one.link]);
            const Vector3<Wide> L = second_[one.link] * one.w + cross(first_[one.link], one.v);
            for (std::size_t j = k; j != none; j = freedoms_[j].above)
                entry(k, j) = dot(freedoms_[j].w, L) + dot(freedoms_[j].v, P);
            entry(k, k) = entry(k, k) + Wide(armature[one.joint]);
        }
        for (std::size_t k = n; k-- > 0;) {
            const Wide before = entry(k, k);
            if (!(before > Wide(0))) regular_ = false;
            for (std::size_t i = freedoms_[k].above; i != none && regular_; i = freedoms_[i].above) {
                const Wide a = entry(k, i) / before;
                for (std::size_t j = i; j != none; j = freedoms_[j].above) entry(i, j) = entry(i, j) - a * entry(k, j);
                entry(k, i) = a;
            }
        }
    }

    // x_k of M x = e_k. Forward substitution involves only the degrees of freedom above k, and of the solution only
    // x_k is needed.
    Wide inverse_entry(std::size_t k) const {
        std::vector<Wide> y(freedoms_.size(), Wide(0));
        y[k] = Wide(1);
        for (std::size_t i = k; i != none; i = freedoms_[i].above)
            for (std::size_t j = freedoms_[i].above; j != none; j = freedoms_[j].above)
                y[j] = y[j] - entry(i, j) * y[i];
        // (L^-T e_k)^T D^-1 (L^-T e_k)
        Wide sum = 0;
        for (std::size_t i = k; i != none; i = freedoms_[i].above) sum = sum + y[i] * y[i] / entry(i, i);
        return sum;
    }

    const Robot& robot_;
    std::vector<std::size_t> carrier_, last_;
    std::vector<RobotPose> poses_;
    std::vector<Freedom> freedoms_;
    std::vector<Wide> mass_;
    std::vector<Vector3<Wide>> first_;
    std::vector<Matrix3<Wide>> second_;
    std::vector<Wide> matrix_;
    bool regular_ = true;
};

}  // namespace

void compute_springdampers(const RobotXml& xml, const Robot& robot, const std::vector<double>& armature,
                           std::vector<MjcfSpringDamper>& springs) {
    constexpr std::size_t most_freedoms = 2000;
    if (springs.empty()) return;
    std::size_t freedoms = 0;
    for (const RobotJoint& joint : robot.joints)
        freedoms += joint.motion == RobotMotion::free        ? 6
                    : joint.motion == RobotMotion::spherical ? 3
                    : joint.motion == RobotMotion::fixed     ? 0
                                                             : 1;
    if (freedoms > most_freedoms)
        xml.fail(*springs.front().at, fmt::format("has a springdamper in a robot of {} degrees of freedom", freedoms),
                 "give stiffness and damping as numbers");
    const TreeInertia inertia(robot, armature);
    for (MjcfSpringDamper& one : springs) {
        if (!inertia.is_regular())
            xml.fail(*one.at, "has a springdamper in a robot whose mass matrix is singular",
                     "give stiffness and damping as numbers");
        const Wide mean = inertia.mean_inertia(one.joint);
        const Wide product = one.time_constant * one.damping_ratio;
        one.stiffness = mean / (product * product);
        one.damping = Wide(2) * mean / one.time_constant;
    }
}

}  // namespace polhode
