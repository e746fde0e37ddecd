// Variants of fixed-step methods in binary32: the same steppers, with the scalar type as a parameter.
//
// The state, the body's constants and the loads (once each), the step length and the result of every operation of a
// step are rounded to 24 bits. Times, events and impulses stay in binary64. Samples are widened without rounding.
//
// Binary32<System> is a system over floats. with_binary32() adds NAME_float32 after each method of a family;
// MethodInBinary32 derives its descriptor at compile time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "integrators/run/march.h"
#include "motion/rounded.h"

namespace polhode {

/// Maps a set of equations over double to the same equations over float.
template <class Equations>
struct RoundedEquations;
template <template <class> class EquationsOf>
struct RoundedEquations<EquationsOf<double>> {
    using type = EquationsOf<float>;
};
template <template <class> class Inertia, bool translation>
struct RoundedEquations<LoadedEquations<double, Inertia<double>, translation>> {
    using type = LoadedEquations<float, Inertia<float>, translation>;
};

/// A system of motion/systems.h in binary32, with state and constants rounded. Does not support user-defined torques.
template <class SystemType>
class Binary32 {
  public:
    using Scalar = float;
    static constexpr int dimension = SystemType::dimension;
    static constexpr int size() { return dimension; }

    explicit Binary32(const Problem& problem) : system_(problem) { round_equations(); }

    void initial(float* y) const {
        double wide[dimension];
        system_.initial(wide);
        narrow(wide, y);
    }
    bool enter(const Segment& segment, float* y) {
        double wide[dimension];
        widen(y, wide);
        const bool has_impulse = system_.enter(segment, wide);
        if (has_impulse) narrow(wide, y);
        round_equations();
        return has_impulse;
    }
    template <class S>
    void derivative(double t, const S* y, S* dy) const {
        equations_.derivative(t, y, dy);
    }
    Sample motion(double t, const float* y) const {
        double wide[dimension];
        widen(y, wide);
        return system_.motion(t, wide);
    }
    void scales(double* scales) const { system_.scales(scales); }

  private:
    static void widen(const float* y, double* wide) { std::copy_n(y, dimension, wide); }
    static void narrow(const double* wide, float* y) {
        for (int i = 0; i < dimension; ++i) y[i] = static_cast<float>(wide[i]);
    }
    void round_equations() {
        if constexpr (SystemType::about_axis) {
            equations_ = rounded<float>(static_cast<const typename SystemType::Equations&>(system_));
        } else if constexpr (SystemType::has_torque) {
            forcing_ = std::make_shared<const Forcing<float>>(rounded<float>(*system_.forcing));
            equations_ = {rounded<float>(system_.inertia), forcing_.get()};
        } else {
            equations_ = {rounded<float>(system_.inertia)};
        }
    }

    SystemType system_;
    std::shared_ptr<const Forcing<float>> forcing_;  // shared: copies of the system point to the same object
    typename RoundedEquations<typename SystemType::Equations>::type equations_;
};

/// A system of motion/systems.h with scalar type S.
template <class SystemType, class S>
using SystemIn = std::conditional_t<std::is_same_v<S, double>, SystemType, Binary32<SystemType>>;

/// with_one_body() for the scalar type S, double or float.
template <class S, class Visitor>
Trajectory with_one_body_in(const Problem& problem, Visitor&& visit) {
    if constexpr (std::is_same_v<S, double>) {
        return with_one_body(problem, std::forward<Visitor>(visit));
    } else {
        return with_one_body(problem,
                             [&]<class SystemType>() { return visit.template operator()<Binary32<SystemType>>(); });
    }
}

/// with_system() for the scalar type S. User-defined systems exist only in double.
template <class S, class Visitor>
Trajectory with_system_in(const Problem& problem, Visitor&& visit) {
    if constexpr (std::is_same_v<S, double>)
        return with_system(problem, std::forward<Visitor>(visit));
    else
        return with_one_body_in<S>(problem, std::forward<Visitor>(visit));
}

/// Why binary32 cannot represent the body or its initial state; empty if it can.
std::string binary32_refusal(const Problem& problem);

/// Why with_system_in() cannot represent the problem in binary32, right-hand side included; empty if it can.
std::string binary32_system_refusal(const Problem& problem);

/// Why binary32 cannot represent the step, s; empty if it can.
std::string binary32_step_refusal(double step);

using Solve = Trajectory (*)(const Problem&, const Settings&);
using Refusal = std::string (*)(const Problem&);

/// Calls `solve` if binary32 can represent the step; otherwise returns Status::unsupported.
template <Solve solve>
Trajectory solve_within_binary32(const Problem& problem, const Settings& settings) {
    if (std::string why = binary32_step_refusal(*settings.step); !why.empty()) return unsupported(std::move(why));
    return solve(problem, settings);
}

/// Concatenates `parts` at compile time, with a terminating zero as in a literal.
template <const auto& parts>
struct ConcatenatedText {
    static constexpr std::size_t length = [] {
        std::size_t sum = 0;
        for (const std::string_view part : parts) sum += part.size();
        return sum;
    }();
    static constexpr std::array<char, length + 1> characters = [] {
        std::array<char, length + 1> all{};
        std::size_t at = 0;
        for (const std::string_view part : parts)
            for (const char character : part) all[at++] = character;
        return all;
    }();
    static constexpr std::string_view text{characters.data(), length};
};

/// The descriptor of the i-th method of `methods` in binary32.
template <const auto& methods, std::size_t i, Refusal extra_refusal, Solve solve>
struct MethodInBinary32 {
    static constexpr std::array<std::string_view, 2> name{methods[i].name, "_float32"};
    static constexpr std::array<std::string_view, 4> documentation{
        "`", methods[i].name,
        "` in binary32: state, constants, step length and every operation of a step are rounded to 24 bits. Times, "
        "events and impulses stay in binary64. Scenes whose constants are outside the range of binary32 are refused. A "
        "state beyond 3.4e38 ends the run as `diverged`. Values below 1e-38, and terms lost in rounding, are lost "
        "without a message. ",
        methods[i].documentation};
    static constexpr std::array<std::string_view, 2> conserves{
        methods[i].conserves, methods[i].conserves == "nothing" ? "" : "; all to binary32 round-off"};

    static std::string find_refusal(const Problem& problem) {
        std::string why = extra_refusal(problem);
        if (why.empty() && methods[i].refusal) why = methods[i].refusal(problem);
        return why;
    }

    static constexpr Method method() {
        Method m = methods[i];
        m.name = ConcatenatedText<name>::text;
        m.precision = Precision::binary32;
        m.binary64_name = methods[i].name;
        m.refusal = find_refusal;
        m.documentation = ConcatenatedText<documentation>::text;
        m.origin = {};
        m.conserves = ConcatenatedText<conserves>::text;
        m.general_systems = false;
        m.solve = solve_within_binary32<solve>;
        return m;
    }
};

// Tests the type: GCC 12 does not accept comparing a function's address as constant under -fsanitize=undefined.
template <auto solve>
constexpr bool is_supplied = !std::is_null_pointer_v<decltype(solve)>;

/// The family `methods` with NAME_float32 directly after NAME. `extra_refusal` applies to all binary32 variants.
/// `solves` has one binary32 function per method, nullptr for none.
template <const auto& methods, Refusal extra_refusal, auto... solves>
constexpr auto with_binary32() {
    static_assert(sizeof...(solves) == std::size(methods), "one per method");
    constexpr std::size_t added = ((is_supplied<solves> ? 1 : 0) + ...);
    std::array<Method, sizeof...(solves) + added> all{};
    [&]<std::size_t... i>(std::index_sequence<i...>) {
        std::size_t at = 0;
        const auto add = [&]<std::size_t k, auto solve>() {
            all[at++] = methods[k];
            if constexpr (is_supplied<solve>) all[at++] = MethodInBinary32<methods, k, extra_refusal, solve>::method();
        };
        (add.template operator()<i, solves>(), ...);
    }
    (std::make_index_sequence<sizeof...(solves)>());
    return all;
}

}  // namespace polhode
