// Loads given by formulas as sent to engines: a list of scalar operations that a driver evaluates at each step.
//
// The operations are those of formula/expression.h. Nodes that depend on neither time nor state are numbers. Formulas
// refer to the axes of the scene's body; `axes` converts from the principal axes that engines use. README.md documents
// the JSON form.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "motion/exact_body.h"
#include "scene/scene_formulas.h"

namespace polhode {

struct EngineMechanism;

/// Why an engine whose hello does not list formulas refuses them.
inline constexpr const char* no_formulas = "its driver does not support loads given by formulas";

/// A force, a torque or the force of a motor.
struct EngineFormulaLoad {
    FormulaKind kind = FormulaKind::torque;                                          ///< force, torque or motor
    int body = 0;                                                                    ///< index of a body; not of motors
    int joint = 0;                                                                   ///< motor: index of a joint
    std::array<int, 3> value{formula::no_node, formula::no_node, formula::no_node};  ///< operations; motor: the first
    Frame frame = Frame::world;                                                      ///< axes of the value
    std::optional<Vector3<double>> point{};  ///< force: where it acts if not at the centre of mass, m
    Frame point_frame = Frame::body;         ///< body: from the centre of mass; world: from the world's origin
    Window window{};                         ///< when it acts

    /// The number of components of `value`.
    int components() const { return kind == FormulaKind::motor ? 1 : 3; }
};

/// A value that is sampled at multiples of a period and held between them.
struct EngineHold {
    int value = 0;      ///< the operation that is sampled
    double period = 0;  ///< s
    int input = 0;      ///< number of the input
};

/// All formulas of a scene. The inputs are the time, 13 numbers of each body (w in its axes, q, p, v), two numbers of
/// each joint (coordinate and rate), and the held values.
struct EngineFormulas {
    std::vector<formula::Node> operations;     ///< number, input, or an operation on earlier ones
    std::vector<std::array<int, 2>> switches;  ///< argument and threshold; threshold no_node: zero
    std::vector<EngineHold> holds;             ///< a value may depend on those before it
    std::vector<EngineFormulaLoad> loads;      ///< a potential is a force and a torque
    std::vector<Quaternion<double>> axes;      ///< by body: the engine's axes to those of the formulas
    std::vector<double> coordinates;           ///< by joint: the coordinate at t = 0, rad or m
    std::vector<double> times;  ///< at which a load begins, ends or is sampled, s, increasing; steps are split there
    int count_inputs() const;   ///< the number of inputs
    int joint_input(std::size_t joint) const;  ///< the input of a joint's coordinate; that of its rate follows
};

/// The formulas of a scene of one body, or none. `q_BP`: the engine's axes to those of the body; `center`: the centre
/// of mass, body axes. Throws std::invalid_argument with a short reason if engines cannot evaluate them.
std::optional<EngineFormulas> body_formulas(const Scene& scene, const ExactBody<double>& body,
                                            const Quaternion<double>& q_BP, const Vector3<double>& center);
/// The formulas of a scene of several bodies, or none, for the bodies and joints of `mechanism`.
std::optional<EngineFormulas> mechanism_formulas(const Scene& scene, const EngineMechanism& mechanism);

/// The formulas, with each of `times` that differs from the boundary of a step only by rounding set to this boundary.
EngineFormulas align_to_steps(EngineFormulas formulas, double duration, long samples, long steps_per_sample);

nlohmann::json write_formulas(const EngineFormulas& formulas);
/// Throws nlohmann::json::exception or std::invalid_argument if the member of a request is invalid.
EngineFormulas read_formulas(const nlohmann::json& formulas);

}  // namespace polhode
