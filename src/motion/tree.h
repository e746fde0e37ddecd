// A mechanism in joint coordinates: the state y = (coordinates, rates) of its links, their motion and its equations by
// the articulated-body recursion (motion/articulated.h), with loops closed by multipliers on accelerations.
//
// The constants are exact in the scalar P; the equations are a template over the scalar S of the state.
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

/// A point of a link, or of the world.
template <class P>
struct LinkPoint {
    int link = world_link;
    Vector3<P> point;  ///< from the link's origin, its axes; of the world, world axes
    int body = -1;     ///< index in scene.bodies; -1 of the world
};

/// What acts on the links from the event last entered on.
template <class P>
struct LinkLoads {
    struct Constant {
        int link, body;
        Pair6<P> load;  ///< torque about the origin and force, link axes
    };
    struct InWorld {
        int link, body;
        Vector3<P> torque_W, force_W, point;  ///< the force acts at a point of the link
    };
    struct AtWorldPoint {
        int link, body;
        Vector3<P> force, point_W;
        bool in_link;  ///< the force is constant in the link's axes, else in the world's
    };
    struct Drag {
        int link, body;
        Matrix3<P> rotational;  ///< torque -C w, link axes
        P translational;
        Vector3<P> center;  ///< where the force -c v acts, link axes
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
    std::vector<P> motors;  ///< of each link, on its joint

    bool needs_frames() const {
        return !(in_world.empty() && at_world_points.empty() && springs.empty() && between.empty()) ||
               needs_velocities();
    }
    bool needs_velocities() const { return !drags.empty(); }
};

/// The world's view of a link.
template <class S>
struct LinkFrame {
    Matrix3<S> R;  ///< link axes to world axes
    Vector3<S> x;  ///< its origin, m
};

/// One scalar condition g = 0 of a loop, g' = sum over its two links of turning . w + linear . v.
template <class S>
struct LoopRow {
    Pair6<S> first, second;  ///< the torque about the link's origin and the force of multiplier 1, link axes
    S value = S(0);          ///< g, m or rad
    S velocity = S(0);       ///< g'
    S bias = S(0);           ///< g'' less sum turning . alpha + linear . a
};

/// A loop's condition between two links.
template <class P>
struct LinkLoop {
    LoopType type = LoopType::spherical;
    LinkPoint<P> first, second;
    Vector3<P> across[2];    ///< revolute: perpendicular to the first axis, the first link's axes
    Vector3<P> second_axis;  ///< revolute: unit, the second link's axes
    P length = P(0);

    int rows() const { return type == LoopType::spherical ? 3 : type == LoopType::revolute ? 5 : 1; }
};

/// Memory of the recursion, one for each thread and scalar.
template <class S>
struct TreeWork {
    std::vector<LinkWork<S>> links;
    std::vector<LinkFrame<S>> frames;  ///< where the loads or loops ask for them
    std::vector<Vector3<S>> velocity_W;
    std::vector<Quaternion<S>> q;
    std::vector<LoopRow<S>> rows;
    std::vector<Pair6<S>> wrench;    ///< of a response, link by link
    std::vector<Pair6<S>> response;  ///< accelerations by row and link
    std::vector<S> rates;            ///< generalized accelerations by row
    std::vector<S> matrix, multipliers;
};

/// See above. `P`: the scalar of the constants.
template <class P>
class Tree {
  public:
    /// Of a valid scene of several bodies, with these mass properties. Throws InputError where the loops do not close,
    /// or where a joint can move without any inertia resisting it: the mass matrix is singular.
    Tree(const Scene& scene, const std::vector<MassProperties<P>>& properties);
    /// The constants and the start of another one, each number made by P(theirs).
    template <class Other>
    explicit Tree(const Tree<Other>& other);

    int dimension() const { return links_.coordinates + links_.rates; }
    const Links<P>& links() const { return links_; }
    const LinkLoads<P>& loads() const { return loads_; }
    bool has_loops() const { return !chosen_.empty(); }
    /// How many scalar conditions the loops pose, and how many of them are independent at the start.
    std::size_t loop_rows() const { return all_rows_; }
    std::size_t independent_loop_rows() const { return chosen_.size(); }

    /// y at t = 0, before any impulse there.
    void initial(P* y) const { std::copy(start_.begin(), start_.end(), y); }
    /// Takes up the loads that act from `begin` (s) on.
    void set_loads(const Scene& scene, double begin) { loads_ = loads_at(scene, begin); }
    /// What acts from `begin` (s) on.
    LinkLoads<P> loads_at(const Scene& scene, double begin) const;
    /// Takes over loads, each number made by P(theirs).
    template <class Other>
    void take_loads(const LinkLoads<Other>& loads);
    /// Applies the impulses at that time (s) to y; whether there were any.
    bool strike(const Scene& scene, double at, P* y) const;

    /// dy/dt.
    template <class S>
    void derivative(const S* y, S* dy) const {
        TreeWork<S>& at = work<S>();
        accelerate(y, at, dy);
        coordinate_rates(y, at, dy);
    }
    /// The accelerations of all links into `at`, and those of the rates into dy.
    template <class S>
    void accelerate(const S* y, TreeWork<S>& at, S* dy) const;
    /// The motion of every body, in the scene's order, with the quaternions as they come.
    template <class S>
    std::vector<BodyMotion<S>> motions(const S* y) const;
    /// The coordinates of each joint at y, in the scene's order: rad, with all their turns, or m.
    std::vector<std::array<P, 2>> joint_coordinates(const P* y) const;
    /// What each joint, then each loop does to its child or its second body, in the scene's order.
    template <class S>
    std::vector<Reaction<S>> reactions(const Scene& scene, const S* y) const;
    /// Moves y on to what the loops ask for by the smallest step that the masses allow, and its rates likewise.
    void project(P* y) const;
    /// Of the loops at y: the largest of the conditions and of their rates (m, rad, SI).
    P loop_gap(const P* y) const;

    /// Where links are: R, r, w and what follows from them.
    template <class S>
    void move(const S* y, TreeWork<S>& at) const;
    /// The world's view of them.
    template <class S>
    void see(const S* y, TreeWork<S>& at) const;
    /// The rows of all loops, all_rows_ of them.
    template <class S>
    void find_rows(TreeWork<S>& at) const;
    /// This thread's memory.
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
    std::vector<int> chosen_;  ///< independent rows
    std::vector<P> start_;

    /// Whether the accelerations need the world's view of the links.
    bool sees() const { return has_loops() || loads_.needs_frames(); }
    void find_loops(const Scene& scene);
    void find_start(const Scene& scene);
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
    void sweep_out(TreeWork<S>& at, S* rates) const;
    template <class S>
    void respond(TreeWork<S>& at, Pair6<S>* response, S* rates) const;
    template <class S>
    void respond_to_rows(TreeWork<S>& at) const;
    template <class S>
    S applied(std::size_t row, const TreeWork<S>& at, const Pair6<S>* accelerations) const;
    template <class S>
    void start_response(std::size_t row, TreeWork<S>& at) const;
    template <class S>
    void solve_rows(TreeWork<S>& at, std::vector<S>& right) const;
    template <class S>
    void coordinate_rates(const S* y, TreeWork<S>& at, S* dy) const;
    template <class S>
    void force_at(const LinkPoint<P>& at_point, const Vector3<S>& force_W, TreeWork<S>& at) const;
};

}  // namespace polhode

#include "motion/tree_cast.h"
#include "motion/tree_equations.h"
#include "motion/tree_inertia.h"
#include "motion/tree_instances.h"
#include "motion/tree_loops.h"
#include "motion/tree_reactions.h"
#include "motion/tree_start.h"
