#include "check/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "check/tolerated.h"
#include "integrators/analysis/conditioning.h"
#include "scene/scene_file.h"
#include "text/content_hash.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

Vector3<double> rounded(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }

// I there = M I M^T: each column of M I is a vector, and so is each row of the result
Matrix3<double> tensor_to(Axes axes, const Matrix3<double>& tensor) {
    Matrix3<double> half;
    for (int i = 0; i < 3; ++i) half[i] = vector_to(axes, tensor[i]);
    half = transposed(half);
    for (int i = 0; i < 3; ++i) half[i] = vector_to(axes, half[i]);
    return half;
}

std::string loads_of(const Scene& scene) {
    const std::string text = write_scene(scene);
    const std::string mark = "\"loads\": ";
    const std::size_t begin = text.find(mark);
    if (scene.loads.empty() || begin == text.npos) return "[]";
    // to the bracket that closes the list
    std::size_t end = begin + mark.size();
    for (int depth = 0; end < text.size(); ++end) {
        depth += text[end] == '[' ? 1 : text[end] == ']' ? -1 : 0;
        if (depth == 0) break;
    }
    std::string list = text.substr(begin + mark.size(), end + 1 - begin - mark.size());
    // on one line
    for (std::size_t at = list.find('\n'); at != list.npos; at = list.find('\n', at))
        list.replace(at, list.find_first_not_of(" \n", at) - at, 1, ' ');
    return list;
}

// The wider of what the scene tolerates and what binary32 rounding of the start alone leads to, ten times over for the
// rounding of the steps.
void set_tolerance(const Scene& scene, Golden& g) {
    const double end = g.motion.rows.back().t;
    const std::vector<double> times = sample_times(end, 400);
    const std::optional<double> given = tolerated_error(scene, "attitude");
    g.tolerance = given.value_or(default_tolerated_attitude);
    g.tolerance_from = given ? "what the scene tolerates" : "1/20 of a degree";
    ConditioningSettings settings;
    settings.max_steps = prompt_conditioning_steps;
    const Conditioning kappa = conditioning(scene, times, settings);
    if (!kappa.available) return;
    g.float64_floor = kappa.floor_peak(float64_roundoff).value;
    g.float32_floor = kappa.floor_peak(float32_roundoff).value;
    if (given || 10 * *g.float32_floor <= g.tolerance) return;
    g.tolerance = std::min(10 * *g.float32_floor, std::numbers::pi);
    g.tolerance_from = "ten times the float32 floor";
}

std::string list(const Vector3<double>& v) {
    return fmt::format("{}, {}, {}", shortest_decimal(v[0]), shortest_decimal(v[1]), shortest_decimal(v[2]));
}
std::string list(const Quaternion<double>& q, bool scalar_last) {
    const std::string u = list(vector_part(q)), w = shortest_decimal(q.w);
    return scalar_last ? fmt::format("{}, {}", u, w) : fmt::format("{}, {}", w, u);
}

// a name for C: "9 lives!" becomes 9_lives_
std::string identifier(const std::string& name) {
    std::string result;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte < 0x80 && std::isalnum(byte) != 0;
        // one _ for what cannot stand there, and never two: such names are C++'s own
        if (plain)
            result += c;
        else if (!result.empty() && result.back() != '_')
            result += '_';
    }
    while (!result.empty() && result.back() == '_') result.pop_back();
    return result.empty() ? "scene" : result;
}

// fit for a C comment, which may neither end in it nor begin again, and keeps no trigraphs
std::string comment(const std::string& text, std::size_t limit = 1000) {
    std::string safe = one_line(text, limit);
    for (std::size_t i = 0; i + 1 < safe.size(); ++i)
        if ((safe[i] == '*' && safe[i + 1] == '/') || (safe[i] == '/' && safe[i + 1] == '*') ||
            (safe[i] == '?' && safe[i + 1] == '?'))
            safe.insert(i + 1, 1, ' ');
    return safe;
}

// a literal that is a double in C
std::string literal(double value) {
    const std::string text = shortest_decimal(value);
    return text.find_first_of(".e") == text.npos ? fmt::format("{}.0", text) : text;
}
std::string literals(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text.append(text.empty() ? "{" : ", ").append(literal(value));
    return text.append("}");
}
std::string literals(const Vector3<double>& v) { return literals(std::vector{v[0], v[1], v[2]}); }

std::string axes_of(const Golden& g) {
    return g.convention.empty() ? "z up, right-handed, radians, quaternion w,x,y,z" : g.convention;
}

}  // namespace

Golden golden(const Scene& scene, const Reference& truth, const Convention& convention) {
    if (!truth.available || truth.samples.empty()) throw std::invalid_argument("there is no truth to export");
    const Axes axes = convention.axes;
    Golden g;
    g.scene = scene.name, g.about = scene.about, g.scene_hash = content_hash(write_scene(scene));
    g.truth = truth.message, g.convention = name_of(convention);
    g.scalar_last = convention.quaternion == QuaternionColumns::scalar_last, g.degrees = convention.degrees,
    g.body_rates = convention.body_rates;
    g.mass = scene.body.mass;
    // lengths in the target's unit
    const auto length_to = [&](const Vector3<double>& v) {
        const Vector3<double> there = vector_to(axes, v);
        return convention.length_unit == 1 ? there : (1 / convention.length_unit) * there;
    };
    g.length_unit = convention.length_unit;
    g.center_of_mass = length_to(scene.body.center_of_mass);
    g.inertia = tensor_to(axes, scene.body.inertia_B);
    if (convention.length_unit != 1)
        for (Vector3<double>& row : g.inertia.row) row = (1 / (convention.length_unit * convention.length_unit)) * row;
    if (scene.pivot) g.pivot = length_to(*scene.pivot);
    g.loads = loads_of(scene);
    // rounding to binary64 turns a quaternion by at most 4 2^-53 rad, and moves a vector by less
    g.bound = truth.bound + 0x1p-51;
    g.motion.has_angular_velocity = g.motion.has_position = g.motion.has_velocity = true;
    for (const ReferenceSample& s : truth.samples) {
        const Quaternion<double> q{s.q.w.high, s.q.x.high, s.q.y.high, s.q.z.high};
        // w in world axes is rounded once: from the parts of both
        const Quaternion<Wide> exact{Wide(s.q.w.high) + s.q.w.low, Wide(s.q.x.high) + s.q.x.low,
                                     Wide(s.q.y.high) + s.q.y.low, Wide(s.q.z.high) + s.q.z.low};
        Vector3<Wide> w;
        for (int i = 0; i < 3; ++i) w[i] = Wide(s.angular_velocity_B[i].high) + s.angular_velocity_B[i].low;
        const Wide unit = convention.degrees ? Wide(180) / Wide(std::numbers::pi) : Wide(1);
        g.motion.rows.push_back(
            {s.t, quaternion_to(axes, q),
             pseudovector_to(axes, cast<double>(unit * (convention.body_rates ? w : rotate(exact, w)))),
             length_to(rounded(s.position_W)), length_to(rounded(s.velocity_W))});
    }
    set_tolerance(scene, g);
    return g;
}

std::string golden_csv(const Golden& g) {
    const bool last = g.scalar_last;
    std::string text =
        fmt::format("# {}: {}\n# {}; bound {:.2e} (rad, and relative); tolerance {} rad ({})\n", one_line(g.scene, 100),
                    one_line(g.truth, 500), axes_of(g), g.bound, shortest_decimal(g.tolerance), g.tolerance_from);
    text += last ? "t,qx,qy,qz,qw" : "t,qw,qx,qy,qz";
    text += ",wx,wy,wz,px,py,pz,vx,vy,vz\n";
    for (const TrajectoryRow& row : g.motion.rows) {
        std::string line = fmt::format("{}, {}, {}, {}, {}\n", shortest_decimal(row.t), list(row.q, last),
                                       list(row.angular_velocity_W), list(row.position_W), list(row.velocity_W));
        line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
        text += line;
    }
    return text;
}

std::string golden_json(const Golden& g) {
    const bool last = g.scalar_last;
    const auto number = [](const std::optional<double>& value) {
        return value && std::isfinite(*value) ? shortest_decimal(*value) : std::string("null");
    };
    std::string text = fmt::format(
        "{{\"scene\": {}, \"about\": {}, \"scene_hash\": \"{}\", \"truth\": {}, \"convention\": {},\n",
        json_string(g.scene), json_string(g.about), g.scene_hash, json_string(g.truth), json_string(axes_of(g)));
    text += fmt::format(
        " \"bound\": {}, \"tolerance\": {}, \"tolerance_from\": {}, \"float64_floor\": {}, \"float32_floor\": {},\n",
        shortest_decimal(g.bound), shortest_decimal(g.tolerance), json_string(g.tolerance_from),
        number(g.float64_floor), number(g.float32_floor));
    text += fmt::format(
        " \"body\": {{\"mass\": {}, \"center_of_mass\": [{}], \"inertia\": [[{}], [{}], [{}]]}},\n \"pivot\": {},\n",
        shortest_decimal(g.mass), list(g.center_of_mass), list(g.inertia[0]), list(g.inertia[1]), list(g.inertia[2]),
        g.pivot ? fmt::format("[{}]", list(*g.pivot)) : std::string("null"));
    text += fmt::format(" \"loads_z_up\": {},\n", g.loads);
    text += fmt::format(
        " \"columns\": [\"t\", {}, \"wx\", \"wy\", \"wz\", \"px\", \"py\", \"pz\", \"vx\", \"vy\", "
        "\"vz\"],\n \"samples\": [",
        last ? R"("qx", "qy", "qz", "qw")" : R"("qw", "qx", "qy", "qz")");
    for (const TrajectoryRow& row : g.motion.rows)
        text += fmt::format("{}\n  [{}, {}, {}, {}, {}]", &row == &g.motion.rows.front() ? "" : ",",
                            shortest_decimal(row.t), list(row.q, last), list(row.angular_velocity_W),
                            list(row.position_W), list(row.velocity_W));
    return text + "\n]}\n";
}

std::string golden_c(const Golden& g) {
    const bool last = g.scalar_last;
    const std::string name = fmt::format("polhode_{}", identifier(g.scene));
    const std::string length = g.length_unit == 1 ? "m" : fmt::format("({} m)", shortest_decimal(g.length_unit));
    std::string guard = fmt::format("{}_H", name);
    std::transform(guard.begin(), guard.end(), guard.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    const std::size_t count = g.motion.rows.size();
    std::string text = fmt::format("/* {}: {}\n * Truth: {}; scene {}.\n", comment(g.scene), comment(g.about),
                                   comment(g.truth), g.scene_hash);
    text += fmt::format(
        " * {} units{}. Axes: {}. q (order {}) maps body to world; w is in {} axes;\n"
        " * p and v are of the centre of mass. Each number is right within the bound and its rounding to binary64.\n"
        " * A test sets a body up from mass, center_of_mass (from the body's origin), inertia (tensor about the centre "
        "of\n"
        " * mass, body axes) and the start q[0], w[0], p[0], v[0], lets the loads act, steps to each t and asks that "
        "the\n"
        " * angle 2 atan2(|vec(q* q_engine)|, |scal(q* q_engine)|) stay below the tolerance.\n",
        g.length_unit == 1 ? "SI" : fmt::format("Lengths in {} m, all else in SI", shortest_decimal(g.length_unit)),
        g.degrees ? ", w in degrees/s" : "", axes_of(g), last ? "x, y, z, w" : "w, x, y, z",
        g.body_rates ? "body" : "world");
    text += fmt::format(" * Loads, as the scene file has them{}: {} */\n",
                        g.convention.empty() ? "" : " (z up, right-handed)", comment(g.loads, 100'000));
    text += fmt::format("#ifndef {0}\n#define {0}\n\n", guard);
    text += fmt::format("enum {{ {}_samples = {}, {}_has_pivot = {} }};\n", name, count, name, g.pivot ? 1 : 0);
    const auto scalar = [&](const char* what, double value, const std::string& remark) {
        text += fmt::format("static const double {}_{} = {}; /* {} */\n", name, what, literal(value), remark);
    };
    scalar("mass", g.mass, "kg");
    text += fmt::format("static const double {}_center_of_mass[3] = {}; /* {} */\n", name, literals(g.center_of_mass),
                        length);
    text += fmt::format("static const double {}_inertia[3][3] = {{{}, {}, {}}}; /* kg {}^2 */\n", name,
                        literals(g.inertia[0]), literals(g.inertia[1]), literals(g.inertia[2]), length);
    text += fmt::format("static const double {}_pivot[3] = {}; /* {}, held at the world's origin where has_pivot */\n",
                        name, literals(g.pivot.value_or(Vector3<double>())), length);
    scalar("bound", g.bound, "rad for q, relative to the largest length for the others");
    scalar("tolerance", g.tolerance, fmt::format("rad: {}", g.tolerance_from));
    if (g.float32_floor && std::isfinite(*g.float32_floor))
        scalar("float32_floor", *g.float32_floor, "rad: what rounding the start to binary32 alone leads to");
    text += '\n';
    const auto array = [&](const char* what, int width, const std::string& remark, const auto& values) {
        text += fmt::format("static const double {}_{}[{}]{} = {{ /* {} */\n", name, what, count,
                            width > 1 ? fmt::format("[{}]", width) : "", remark);
        for (const TrajectoryRow& row : g.motion.rows)
            text += fmt::format("    {}{}\n", values(row), &row == &g.motion.rows.back() ? "" : ",");
        text += "};\n";
    };
    array("t", 1, "s", [](const TrajectoryRow& row) { return literal(row.t); });
    array("q", 4, last ? "x, y, z, w" : "w, x, y, z", [&](const TrajectoryRow& row) {
        const Quaternion<double>& q = row.q;
        return last ? literals(std::vector{q.x, q.y, q.z, q.w}) : literals(std::vector{q.w, q.x, q.y, q.z});
    });
    array("w", 3, g.degrees ? "degrees/s" : "rad/s",
          [](const TrajectoryRow& row) { return literals(row.angular_velocity_W); });
    array("p", 3, length, [](const TrajectoryRow& row) { return literals(row.position_W); });
    array("v", 3, length + "/s", [](const TrajectoryRow& row) { return literals(row.velocity_W); });
    return text + fmt::format("\n#endif /* {} */\n", guard);
}

}  // namespace polhode
