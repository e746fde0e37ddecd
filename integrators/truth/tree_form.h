// First formulation of the reference for a mechanism: joint coordinates with the articulated-body recursion, from the
// right-hand side in motion/tree.h that all methods share.
#pragma once

#include <array>
#include <vector>

#include "integrators/truth/motion.h"
#include "motion/mechanism_motion_of.h"
#include "motion/problem.h"
#include "motion/tree.h"

namespace polhode::truth {

/// The blocks of the state of a tree. `scales`: one per component.
template <class P>
std::vector<Block> tree_blocks(const Tree<P>& tree, const std::vector<double>& scales) {
    std::vector<Block> all;
    for (const polhode::Link<P>& link : tree.links().links) {
        const auto note = [&](int first, int size) {
            all.push_back({first, size, scales[static_cast<std::size_t>(first)]});
        };
        if (link.kind == LinkJoint::free) {
            note(link.coordinate, 4), note(link.coordinate + 4, 3);
            note(link.rate, 3), note(link.rate + 3, 3);
        } else {
            note(link.coordinate, link.coordinates()), note(link.rate, link.rates());
        }
    }
    return all;
}

template <class P>
class TreeForm {
  public:
    static constexpr const char* name = "joint coordinates";

    /// The scene must outlive this object.
    explicit TreeForm(const Scene& scene) : scene_(&scene), tree_(scene, bodies_mass_properties<P>(scene)) {}

    int dimension() const { return tree_.dimension(); }
    const Tree<P>& tree() const { return tree_; }
    void initial(P* y) const { tree_.initial(y); }
    void enter(double begin, P* y) {
        tree_.set_loads(*scene_, begin);
        tree_.apply_impulses(*scene_, begin, y);
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        tree_.derivative(y, dy);
    }
    /// The motions of the bodies, with unit quaternions.
    Motions<P> motion(const P* y) const {
        Motions<P> all = tree_.motions(y);
        for (Motion<P>& body : all) body.q = normalized(body.q);
        return all;
    }
    std::vector<Reaction<P>> reactions(const P* y) const { return tree_.reactions(*scene_, y); }

    /// `scales`: one per component of y, as from MechanismModel::scales().
    std::vector<Block> blocks(const std::vector<double>& scales) const { return tree_blocks(tree_, scales); }
    /// The coordinates of each joint, as in Tree.
    std::vector<std::array<P, 2>> joint_coordinates(const P* y) const { return tree_.joint_coordinates(y); }

  private:
    const Scene* scene_;
    Tree<P> tree_;
};

}  // namespace polhode::truth
