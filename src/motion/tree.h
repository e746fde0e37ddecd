// A mechanism in joint coordinates: the state y = (coordinates, rates) of its links, their motion, and the equations
// of motion by the articulated-body recursion (motion/articulated.h). Loops are closed by Lagrange multipliers on the
// acceleration level.
//
// Constants are exact in the scalar P; the equations are templates over the scalar S of the state. Main types: Tree
// (the mechanism), LinkLoads (loads on links), LinkLoop and LoopRow (loop constraints), TreeWork (per-thread memory).
// Definitions: tree_start.h, tree_equations.h, tree_loops.h, tree_reactions.h, tree_inertia.h,
// tree_armature.h, tree_cast.h.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "motion/articulated.h"
#include "motion/exact_body.h"
#include "motion/links.h"
#include "motion/mechanism_motion.h"
#include "motion/trajectory.h"

namespace polhode {

/// A point of a link or of the world.
template <class P>
struct LinkPoint {
    int link = world_link;
    Vector3<P> point;  ///< from the link's origin, in its axes; for the world, in world axes
    int body = -1;     ///< index in scene.bodies; -1 for the world
};

/// The loads on the links since the last event.
template <class P>
struct LinkLoads {
    struct Constant {
        int link, body;
        Pair6<P> load;  ///< torque about the link's origin and force, link axes
    };
    struct InWorld {
        int link, body;
        Vector3<P> torque_W, force_W, point;  ///< the force acts at `point` of the link
    };
    struct AtWorldPoint {
        int link, body;
        Vector3<P> force, point_W;
        bool in_link;  ///< the force is constant in the link's axes; otherwise in world axes
    };
    struct Drag {
        int link, body;
        Matrix3<P> rotational;  ///< torque -C w, link axes
        P translational;
        Vector3<P> center;  ///< point at which the force -c v acts, link axes
    };
    struct Spring {
        int link, body;
        P stiffness;
        Quaternion<P> q;     ///< body axes to link axes
        Quaternion<P> rest;  ///< body axes to world axes
    };
    struct Between {
        LinkPoint<P> first, second;
        P stiffness, rest_length;
    };
    Vector3<P> gravity_W;
    std::vector<Constant> constant;
    std::vector<InWorld> in_world;
    std::vector<AtWorldPoint> at_world_points;
    std::vector<Drag> drags;
    std::vector<Spring> springs;
    std::vector<Between> between;
    std::vector<P> motors;  ///< per link, generalized force on its joint

    bool needs_frames() const {
        return !(in_world.empty() && at_world_points.empty() && springs.empty() && between.empty()) ||
               needs_velocities();
    }
    bool needs_velocities() const { return !drags.empty(); }
};

/// The pose of a link in the world.
template <class S>
struct LinkFrame {
    Matrix3<S> R;  ///< link axes to world axes
    Vector3<S> x;  ///< its origin, m
};

/// One scalar constraint g = 0 of a loop: g' = sum over its two links of turning . w + linear . v.
template <class S>
struct LoopRow {
    Pair6<S> first, second;  ///< torque about the link's origin and force for a unit multiplier, link axes
    S value = S(0);          ///< g, m or rad
    S velocity = S(0);       ///< g'
    S bias = S(0);           ///< g'' minus the sum of turning . alpha + linear . a
};

/// A loop constraint between two links.
template <class P>
struct LinkLoop {
    LoopType type = LoopType::spherical;
    LinkPoint<P> first, second;
    Vector3<P> across[2];    ///< revolute: unit vectors perpendicular to the first axis, in the first link's axes
    Vector3<P> second_axis;  ///< revolute: unit, in the second link's axes
    P length = P(0);
    /// A constraint of joint coordinates instead: second = ratio * first + offset, where `second.link` and `first.link`
    /// are the links of the coordinates.
    bool couples = false;
    P ratio = P(0), offset = P(0);

    int rows() const { return couples ? 1 : type == LoopType::spherical ? 3 : type == LoopType::revolute ? 5 : 1; }
};

/// Memory of the recursion, one instance per thread and scalar.
template <class S>
struct TreeWork {
    std::vector<LinkWork<S>> links;
    const S* y = nullptr;              ///< the state of the last move()
    std::vector<LinkFrame<S>> frames;  ///< computed only if loads or loops need them
    std::vector<Vector3<S>> velocity_W;
    std::vector<Quaternion<S>> q;
    std::vector<LoopRow<S>> rows;
    std::vector<Pair6<S>> wrench;    ///< input of respond(), per link
    std::vector<Pair6<S>> response;  ///< accelerations by row and link
    std::vector<S> rates;            ///< generalized accelerations by row
    std::vector<S> matrix, multipliers;
    std::vector<S> locks;      ///< generalized forces that keep the accelerations of locked coordinates
    std::vector<S> row_locks;  ///< their changes by unit multipliers, by row and lock
};

/// A coordinate that is locked, or whose acceleration is given.
struct CoordinateLock {
    int link;
    int drive = -1;  ///< the acceleration is y[drive], a component of y after the state; -1: locked
};

/// A load on a body, for reactions: torque about the link's origin and force, link axes.
template <class S>
struct BodyLoad {
    int body, link;
    Pair6<S> load;
};

/// A mechanism in joint coordinates. `P`: the scalar of the constants.
template <class P>
class Tree {
  public:
    /// From a valid scene of several bodies and its mass properties. Throws InputError if the loops do not close, or
    /// if the mass matrix is singular (a joint can move without inertia).
    Tree(const Scene& scene, const std::vector<MassProperties<P>>& properties);
    /// Converts the constants and the initial state of another tree by P(number).
    template <class Other>
    explicit Tree(const Tree<Other>& other);

    int dimension() const { return links_.coordinates + links_.rates; }
    const Links<P>& links() const { return links_; }
    const LinkLoads<P>& loads() const { return loads_; }
    bool has_loops() const { return !chosen_.empty(); }
    /// The number of scalar loop constraints, and the number of independent ones at the start.
    std::size_t loop_rows() const { return all_rows_; }
    std::size_t independent_loop_rows() const { return chosen_.size(); }

    /// y at t = 0, before any impulse there.
    void initial(P* y) const { std::copy(start_.begin(), start_.end(), y); }
    /// Sets the loads that act from `begin` (s) on.
    void set_loads(const Scene& scene, double begin) { loads_ = loads_at(scene, begin); }
    /// The loads that act from `begin` (s) on.
    LinkLoads<P> loads_at(const Scene& scene, double begin) const;
    /// Sets loads converted by P(number).
    template <class Other>
    void convert_loads(const LinkLoads<Other>& loads);
    /// Applies the impulses at `time` (s) to y. Returns whether there were any.
    bool apply_impulses(const Scene& scene, double time, P* y) const;

    /// dy/dt.
    template <class S>
    void derivative(const S* y, S* dy) const {
        TreeWork<S>& at = work<S>();
        accelerate(y, at, dy);
        coordinate_rates(y, at, dy);
    }
    /// Computes the accelerations of all links into `at`, and the derivatives of the rates into dy.
    template <class S>
    void accelerate(const S* y, TreeWork<S>& at, S* dy) const;
    /// dy/dt under further loads. `add_loads(at)` adds them to the forces of the links, after their world poses have
    /// been computed. work<S>() then has the poses and the accelerations of the links; these do not include gravity.
    template <class S, class AddLoads>
    void derivative_with(const S* y, S* dy, const AddLoads& add_loads) const;
    /// Adds a torque about the link's origin and a force, both in link axes, to those that act on a link.
    template <class S>
    static void add_load(TreeWork<S>& at, int link, const Pair6<S>& load);
    /// The motion of every body, in the scene's order. The quaternions are not normalised.
    template <class S>
    std::vector<BodyMotion<S>> motions(const S* y) const;
    /// The coordinates of each joint at y, in the scene's order: rad, including full revolutions, or m.
    std::vector<std::array<P, 2>> joint_coordinates(const P* y) const;
    /// The reactions of the joints, then of the loops, in the scene's order.
    template <class S>
    std::vector<Reaction<S>> reactions(const Scene& scene, const S* y) const;
    /// The reactions under further loads (see derivative_with()). `add_loads(at)` returns those on bodies.
    template <class S, class AddLoads>
    std::vector<Reaction<S>> reactions_with(const Scene& scene, const S* y, const AddLoads& add_loads) const;
    /// Locks the coordinates of these links of one coordinate: their accelerations vanish. Replaces former locks. The
    /// coordinates of the links `driven` have given accelerations: y[first_drive] and the following components of the
    /// argument y of all functions of the state, which is longer by them. accelerate() computes the forces of the
    /// locks, in this order, into work().locks. The cost does not depend on the number of locks.
    void lock(const std::vector<int>& links, const std::vector<int>& driven = {}, int first_drive = 0);
    /// Adds a generalized force to a link's coordinate until loads are set again.
    void add_motor(int link, const P& force);
    /// The changes of the rates by a generalized impulse of size 1 on a link's coordinate. Locks and couplings hold.
    std::vector<P> unit_response(int link, const P* y) const;
    /// Replaces the coordinate and the rate of links of one coordinate at t = 0. Dependent joints then close the loops.
    struct Start {
        int link;
        P coordinate, rate;
    };
    void restart(const std::vector<Start>& starts);
    /// Projects y onto the loop constraints by the smallest step in the mass metric, then its rates in the same way.
    void project(P* y) const;
    /// The largest violation of the loop constraints and of their rates at y (m, rad, SI).
    P loop_gap(const P* y) const;

    /// Computes the relative poses and velocities of the links: R, r, w and the bias accelerations.
    template <class S>
    void move(const S* y, TreeWork<S>& at) const;
    /// Computes the world poses and velocities of the links.
    template <class S>
    void compute_frames(const S* y, TreeWork<S>& at) const;
    /// Computes all constraint rows; there are all_rows_ of them.
    template <class S>
    void find_rows(TreeWork<S>& at) const;
    /// This thread's work memory.
    template <class S>
    TreeWork<S>& work() const;
    const std::vector<LinkLoop<P>>& loops() const { return loops_; }
    const std::vector<int>& chosen_rows() const { return chosen_; }

  private:
    template <class Other>
    friend class Tree;

    Links<P> links_;
    LinkLoads<P> loads_;
    std::vector<LinkLoop<P>> loops_;
    std::vector<int> loop_of_row_;
    std::size_t all_rows_ = 0;
    std::vector<int> chosen_;  ///< indices of independent rows
    std::vector<P> start_;
    std::vector<CoordinateLock> locks_;
    std::vector<int> lock_of_link_;  ///< index in locks_, or -1; empty without locks

    /// Whether the accelerations need the world poses of the links.
    bool uses_frames() const { return has_loops() || loads_.needs_frames(); }
    /// Index in locks_, or -1.
    int lock_of(std::size_t link) const { return lock_of_link_.empty() ? -1 : lock_of_link_[link]; }
    /// Whether joints can transmit inertia along their free directions.
    bool transmits_along_axes() const { return links_.has_armature || !locks_.empty(); }
    void find_loops(const Scene& scene);
    void find_start(const Scene& scene);
    std::vector<int> dependent_links() const;
    void close_by_dependent(const std::vector<int>& dependent);
    void choose_rows();
    void require_inertia(const Scene& scene) const;
    void require_inertia(const Scene& scene, std::size_t link, const ArticulatedInertia<P>& articulated, const P& mass,
                         const P& trace) const;
    LinkPoint<P> point_of(const Scene& scene, const std::string& body, const Vector3<double>& point) const;
    void displace(const P* by, P* y) const;
    template <class S>
    void load(const S* y, TreeWork<S>& at) const;
    template <class S>
    Quaternion<S> attitude_of(std::size_t link, const S* y, const TreeWork<S>& at) const;
    template <class S>
    void articulate(TreeWork<S>& at) const;
    template <class S>
    void articulate_with_armature(TreeWork<S>& at) const;
    template <class S>
    void compute_accelerations(TreeWork<S>& at, S* rates) const;
    template <bool along_axes, class S>
    void compute_accelerations_of(TreeWork<S>& at, S* rates) const;
    template <class S>
    void solve_accelerations(TreeWork<S>& at, S* dy) const;
    template <class S>
    void respond(TreeWork<S>& at, Pair6<S>* response, S* rates, S* locks) const;
    template <bool along_axes, class S>
    void respond_of(TreeWork<S>& at, Pair6<S>* response, S* rates, S* locks) const;
    template <class S>
    std::vector<Reaction<S>> find_reactions(const Scene& scene, const S* y, TreeWork<S>& at,
                                            const std::vector<BodyLoad<S>>& applied) const;
    template <class S>
    void respond_to_rows(TreeWork<S>& at) const;
    template <class S>
    [[gnu::always_inline]] inline S applied(std::size_t row, const TreeWork<S>& at, const Pair6<S>* accelerations,
                                            const S* rates) const;
    template <class S>
    void add_generalized_force(int link, const S& size, TreeWork<S>& at) const;
    template <class S>
    [[gnu::always_inline]] inline void start_response(std::size_t row, TreeWork<S>& at) const;
    template <class S>
    void start_coupling_response(const LinkLoop<P>& coupling, TreeWork<S>& at) const;
    template <class S>
    S applied_to_coupling(const LinkLoop<P>& coupling, const S* rates) const;
    void hold_rows(TreeWork<P>& at, const Pair6<P>* jumps, P* jump) const;
    template <class S>
    void solve_rows(TreeWork<S>& at, std::vector<S>& right) const;
    template <class S>
    void coordinate_rates(const S* y, TreeWork<S>& at, S* dy) const;
    template <class S>
    void force_at(const LinkPoint<P>& at_point, const Vector3<S>& force_W, TreeWork<S>& at) const;
};

}  // namespace polhode

#include "motion/tree_armature.h"
#include "motion/tree_cast.h"
#include "motion/tree_equations.h"
#include "motion/tree_inertia.h"
#include "motion/tree_instances.h"
#include "motion/tree_loops.h"
#include "motion/tree_reactions.h"
#include "motion/tree_start.h"
