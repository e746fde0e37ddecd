// The formulas of a scene, compiled to one list of operations (formula/expression.h).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "formula/expression.h"
#include "scene/scene.h"

namespace polhode {

/// Numbers of the inputs of a scene's expression: the time and the state of the body.
struct FormulaInputs {
    static constexpr int time = 0;              ///< s
    static constexpr int angular_velocity = 1;  ///< body axes, 3 numbers
    static constexpr int attitude = 4;          ///< body axes to world axes, 4 numbers
    static constexpr int position = 8;          ///< centre of mass, world axes, 3 numbers
    static constexpr int velocity = 11;         ///< velocity at the centre of mass, world axes, 3 numbers
    static constexpr int count = 14;
};

/// Numbers of the constants of a scene's expression, after the parameters.
struct FormulaConstants {
    static constexpr int mass = 0;
    static constexpr int inertia = 1;  ///< about the centre of mass, body axes, row by row
    static constexpr int arm = 10;     ///< one body: pivot to centre of mass; several bodies: origin to centre of mass
    static constexpr int count = 13;
};

/// Numbers of the inputs of a scene of several bodies: the time, the state of each body, then two numbers of each
/// joint.
struct MechanismInputs {
    static constexpr int per_body = FormulaInputs::count - 1;
    /// The input `which` (of FormulaInputs, not the time) of a body.
    static int of_body(int body, int which) { return which + per_body * body; }
    /// The coordinate of a revolute or prismatic joint; its rate follows.
    static int of_joint(int bodies, int joint) { return 1 + per_body * bodies + 2 * joint; }
    /// The number of inputs without held values.
    static int count(int bodies, int joints) { return of_joint(bodies, joints); }
};

/// The nodes of one load.
struct FormulaTerm {
    FormulaLoad load;                  ///< as given
    std::size_t index = 0;             ///< place in the list of loads
    std::array<int, 3> value{};        ///< torque or force in the load's frame; potential: the force, world axes
    std::array<int, 3> torque_B{};     ///< potential: the torque, body axes, about the pivot or the centre of mass
    int potential = formula::no_node;  ///< potential: J
    int body = -1;                     ///< several bodies: index of the body that it acts on
    int joint = -1;                    ///< motor: index of the joint; value[0] is its generalized force

    /// The number of components of `value`.
    int components() const { return load.kind == FormulaKind::motor ? 1 : 3; }
};

/// All formulas of a scene.
struct FormulaSet {
    formula::Expression expression;
    std::vector<FormulaTerm> terms;
    /// Nodes that become variables where a scalar has no value (formula/evaluate.h): transcendental functions and
    /// arguments of switches.
    std::vector<int> auxiliaries;
    std::vector<double> periods;  ///< periods of the held values, expression.holds(), s
};

/// Whether t (s), 0 or a multiple of `period` as computed by sampling_times(), is a time at which values are sampled.
bool is_sampling_time(double t, double period);
/// The times in the run at which values of formulas are sampled (held values), without 0, in any order, s. A multiple k
/// of a period h is the binary64 number nearest to k h.
std::vector<double> sampling_times(const Scene& scene);

/// Whether a load of the scene is a formula.
bool has_formula_loads(const Scene& scene);
/// Whether a potential of the scene is a formula.
bool has_formula_potential(const Scene& scene);

/// Compiles the formulas of a scene. Throws InputError at the place in `file` of the first fault.
std::shared_ptr<const FormulaSet> compile_formulas(const Scene& scene, const std::string& file);

/// Checks the names and numbers of parameters, tables and definitions, and compiles all formulas.
void check_formulas(const Scene& scene, const std::string& file);

}  // namespace polhode
