// Writes golden data as CSV, JSON, C, C++ and C#. JSON and code are made from the same document.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "check/golden_code.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

using namespace golden_code;

// The body, its shape, planes and loads.
ordered_json surroundings(const Golden& g, const Numbers& number) {
    if (has_several_bodies(g)) return system_surroundings(g, number);
    ordered_json all;
    const Body& body = g.scene.body;
    all["body"] = {{"mass", number(body.mass)},
                   {"center_of_mass", number(body.center_of_mass)},
                   {"inertia", number(body.inertia_B)}};
    all["pivot"] = g.scene.pivot ? number(*g.scene.pivot) : ordered_json(nullptr);
    all["shape"] = shape_of(g.shapes.front(), number);
    // in the form of scene files
    const ordered_json written = number.all_of(ordered_json::parse(write_scene(g.scene)));
    for (const char* list : {"planes", "loads"}) all[list] = written.value(list, ordered_json::array());
    add_names_of_formulas(written, all);
    if (scalar_last(g))
        for (ordered_json& load : all["loads"])
            if (load.contains("rest_orientation"))
                std::rotate(load["rest_orientation"].begin(), load["rest_orientation"].begin() + 1,
                            load["rest_orientation"].end());
    return all;
}

ordered_json event_of(const GoldenEvent& event, const Numbers& number) {
    if (event.other.empty())
        return {
            {"t", number(event.t)}, {"joint", event.body}, {"event", event.event}, {"impulse", number(event.impulse)}};
    return {{"t", number(event.t)},
            {"body", event.body},
            {"other", event.other},
            {"event", event.event},
            {"normal_impulse", number(event.impulse)},
            {"tangential_impulse", number(event.tangential_impulse)}};
}

std::string csv(const Golden& g, const Numbers& number) {
    std::string text = fmt::format("# {}: {}\n# {}; bound {:.2e} (rad, and relative); tolerance {} rad ({})\n",
                                   one_line(g.scene.name, 100), one_line(g.truth, 500), axes_of(g), g.bound,
                                   shortest_decimal(g.tolerances.front().value), g.tolerances.front().from);
    const std::vector<std::string>& bodies = g.motion.bodies;
    text += bodies.empty() ? "t" : "t,body";
    text += scalar_last(g) ? ",qx,qy,qz,qw" : ",qw,qx,qy,qz";
    text += ",wx,wy,wz,px,py,pz,vx,vy,vz\n";
    std::size_t k = 0;
    for (const TrajectoryRow& row : g.motion.rows) {
        text += shortest_decimal(row.t);
        if (!bodies.empty()) text.append(",").append(bodies[k++ % bodies.size()]);
        for (const ordered_json& block : {number(row.q, scalar_last(g)), number(row.angular_velocity_W),
                                          number(row.position_W), number(row.velocity_W)})
            for (const double x : block) text += "," + shortest_decimal(x);
        text += '\n';
    }
    return text;
}

std::string json(const Golden& g, const Numbers& number) {
    ordered_json all{{"scene", g.scene.name},
                     {"about", g.scene.about},
                     {"scene_hash", g.scene_hash},
                     {"truth", g.truth},
                     {"convention", axes_of(g)},
                     {"length_unit", g.convention.length_unit},
                     {"bound", g.bound},
                     {"tolerance", g.tolerances.front().value},
                     {"tolerance_from", g.tolerances.front().from}};
    for (const GoldenTolerance& t : g.tolerances) all["tolerances"][t.block] = {{"value", t.value}, {"from", t.from}};
    all["float64_floor"] = g.float64_floor ? ordered_json(*g.float64_floor) : ordered_json(nullptr);
    all["float32_floor"] = g.float32_floor;
    all["energy_scale"] = number(g.energy_scale), all["momentum_scale"] = number(g.momentum_scale);
    all.update(surroundings(g, number));
    all["columns"] = {"t", "qw", "qx", "qy", "qz", "wx", "wy", "wz", "px", "py", "pz", "vx", "vy", "vz"};
    if (scalar_last(g)) std::rotate(all["columns"].begin() + 1, all["columns"].begin() + 2, all["columns"].begin() + 5);
    const std::vector<std::string>& bodies = g.motion.bodies;
    if (!bodies.empty()) all["columns"].insert(all["columns"].begin() + 1, "body");
    all["energy"] = number.all_of(g.energy), all["momentum"] = ordered_json::array();
    for (const Vector3<double>& momentum : g.momentum) all["momentum"].push_back(number(momentum));
    if (!g.forces.empty()) {
        all["reaction_forces"] = ordered_json::array(), all["reaction_torques"] = ordered_json::array();
        for (const Vector3<double>& force : g.forces) all["reaction_forces"].push_back(number(force));
        for (const Vector3<double>& torque : g.torques) all["reaction_torques"].push_back(number(torque));
    }
    if (!g.events.empty()) {
        all["event_time_tolerance"] = number(golden_event_tolerance);
        all["events"] = ordered_json::array();
        for (const GoldenEvent& event : g.events) all["events"].push_back(event_of(event, number));
    }
    // one line per key and per sample
    std::string text;
    for (const auto& [key, value] : all.items())
        text += fmt::format("{}{}: {}", text.empty() ? "{" : ",\n ", ordered_json(key).dump(),
                            value.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
    text += ",\n \"samples\": [";
    std::size_t k = 0;
    for (const TrajectoryRow& row : g.motion.rows) {
        ordered_json sample{number(row.t)};
        if (!bodies.empty()) sample.push_back(bodies[k++ % bodies.size()]);
        for (const ordered_json& block : {number(row.q, scalar_last(g)), number(row.angular_velocity_W),
                                          number(row.position_W), number(row.velocity_W)})
            sample.insert(sample.end(), block.begin(), block.end());
        text += fmt::format("{}\n  {}", &row == &g.motion.rows.front() ? "" : ",", sample.dump());
    }
    return text + "\n]}\n";
}

// The constants of a scene of one body. `m`: the unit of length.
void add_body_fields(const Golden& g, const ordered_json& around, const std::string& m, FieldList& all) {
    const std::map<std::string, std::string> units{
        {"mass", "kg"},
        {"center_of_mass", m + ", from the body's origin, body axes"},
        {"inertia", "kg " + m + "^2, about the centre of mass, body axes"},
        {"acceleration", m + "/s^2"},
        {"rotational", "kg " + m + "^2/s, about each body axis"},
        {"translational", "kg/s"},
        {"stiffness", "kg " + m + "^2/s^2"},
        {"point", m},
        {"offset", m},
        {"torsional_friction", m},
        {"rolling_friction", m},
        {"center", m},
        {"semi_axes", m + ", one per row: the piece is center + the ellipsoid, "
                          "swept by a ball of the radius"},
        {"radius", m},
        {"from", "s"},
        {"until", "s"},
        {"at", "s"}};
    const std::map<std::string, std::string> vectors{
        {"force", "kg " + m + "/s^2"}, {"torque", "kg " + m + "^2/s^2"}, {"impulse", "kg " + m + "/s"}};
    const auto add_members = [&](const std::string& prefix, const ordered_json& members, const std::string& type) {
        for (const auto& [key, value] : members.items()) {
            if (key == "type" || key == "name") continue;
            // a frame becomes a flag: 1 for the body's
            if (key == "restitution_law")
                all.add(prefix + key, restitution_law_number(value), restitution_laws);
            else if (value.is_string())
                all.add(prefix + key + "_is_body", value == "body" ? 1 : 0, "1: body axes, 0: world axes");
            else
                all.add(prefix + key, value,
                        key == "vector"       ? vectors.at(type)
                        : units.contains(key) ? units.at(key)
                                              : "");
        }
    };
    all.add("has_pivot", g.scene.pivot ? 1 : 0, "");
    add_members("", around["body"], "");
    all.add("pivot", g.scene.pivot ? around["pivot"] : ordered_json{0.0, 0.0, 0.0},
            m + ", held at the world's origin if has_pivot");
    for (const char* list : {"shape", "planes", "loads"})
        for (std::size_t i = 0; i < around[list].size(); ++i) {
            const ordered_json& one = around[list][i];
            const std::string type = one.value("type", std::string(list) == "planes" ? "plane" : "shape");
            add_members(fmt::format("{}_{}_", type, i), one, type);
        }
}

void add_tolerances(const Golden& g, const Numbers& number, const std::string& m, FieldList& all) {
    for (const GoldenTolerance& t : g.tolerances) {
        const std::string& block = t.block;
        const std::string of = block == "attitude"           ? "rad"
                               : block == "angular_velocity" ? (g.convention.degrees ? "degrees/s" : "rad/s")
                               : block == "position"         ? m
                               : block == "velocity"         ? m + "/s"
                                                             : "relative";
        all.add(block == "attitude" ? "tolerance" : "tolerance_" + block, number(t.value), of + ": " + t.from);
    }
}

void add_motion(const Golden& g, const Numbers& number, const std::string& m, bool several, FieldList& all) {
    ordered_json t = ordered_json::array(), q = t, w = t, p = t, v = t;
    for (const TrajectoryRow& row : g.motion.rows) {
        if (t.empty() || t.back() != number(row.t)) t.push_back(number(row.t));
        q.push_back(number(row.q, scalar_last(g)));
        w.push_back(number(row.angular_velocity_W)), p.push_back(number(row.position_W));
        v.push_back(number(row.velocity_W));
    }
    all.add("t", t, "s");
    const std::string rows = several ? ", row sample * bodies + body" : "";
    all.add("q", q, (scalar_last(g) ? "x, y, z, w" : "w, x, y, z") + rows);
    all.add("w", w, g.convention.degrees ? "degrees/s" : "rad/s");
    all.add("p", p, m), all.add("v", v, m + "/s");
}

void add_reactions(const Golden& g, const Numbers& number, const std::string& m, FieldList& all) {
    ordered_json forces = ordered_json::array(), torques = forces;
    for (const Vector3<double>& force : g.forces) forces.push_back(number(force));
    for (const Vector3<double>& torque : g.torques) torques.push_back(number(torque));
    const bool of_planes = !g.scene.planes.empty();
    const std::string row =
        of_planes ? ", exerted by a plane on the body, world axes, row sample * planes + plane"
                  : ", exerted by the parent on the child, world axes, row sample * (joints + loops) + joint";
    const std::string about = of_planes ? "the contact point" : "the child's point";
    all.add("reaction_force", forces, "kg " + m + "/s^2" + row);
    all.add("reaction_torque", torques, "kg " + m + "^2/s^2, about " + about + row);
}

void add_invariants(const Golden& g, const Numbers& number, const std::string& m, bool several, FieldList& all) {
    ordered_json momentum = ordered_json::array();
    for (const Vector3<double>& L : g.momentum) momentum.push_back(number(L));
    const std::string per = "errors are relative to this value";
    all.add("energy", number.all_of(g.energy), "kg " + m + "^2/s^2, kinetic and potential");
    all.add("energy_scale", number(g.energy_scale), per);
    all.add(
        "momentum", momentum,
        "kg " + m +
            (several ? "^2/s, angular, whole system, about the world's origin, or about the centre of mass if no joint "
                       "ties the system to the world; world axes"
                     : "^2/s, angular, about the pivot or the centre of mass, world axes"));
    if (!g.forces.empty()) add_reactions(g, number, m, all);
    all.add("momentum_scale", number(g.momentum_scale), per);
}

// Events as lists, with numbers for their kinds and for the contacts or joints where they occur.
void add_events(const Golden& g, const Numbers& number, const std::string& m, FieldList& all) {
    if (g.events.empty()) return;
    std::vector<std::string> kinds, places;
    const auto index = [](std::vector<std::string>& names, const std::string& name) {
        const auto found = std::ranges::find(names, name);
        if (found != names.end()) return static_cast<int>(found - names.begin());
        names.push_back(name);
        return static_cast<int>(names.size()) - 1;
    };
    const auto numbered = [](const std::vector<std::string>& names) {
        std::string text;
        for (std::size_t i = 0; i < names.size(); ++i) text += fmt::format("{}{} {}", i == 0 ? "" : ", ", i, names[i]);
        return text;
    };
    ordered_json t = ordered_json::array(), kind = t, place = t, normal = t, tangential = t;
    for (const GoldenEvent& event : g.events) {
        t.push_back(number(event.t)), kind.push_back(index(kinds, event.event));
        place.push_back(
            index(places, event.other.empty() ? event.body : fmt::format("{} with {}", event.body, event.other)));
        normal.push_back(number(event.impulse)), tangential.push_back(number(event.tangential_impulse));
    }
    const bool of_joints = g.events.front().other.empty();
    all.add("events", g.events.size(), "");
    all.add("event_t", t, "s");
    all.add("event_kind", kind, numbered(kinds));
    all.add("event_place", place, numbered(places));
    if (of_joints) {
        all.add("event_impulse", normal, "on the joint's coordinate, kg " + m + "^2/s or kg " + m + "/s");
    } else {
        all.add("event_normal_impulse", normal, "kg " + m + "/s");
        all.add("event_tangential_impulse", tangential, "kg " + m + "/s, on the body, world axes");
    }
    all.add("event_time_tolerance", number(golden_event_tolerance), "s: a step at 60 Hz");
}

std::vector<Field> fields_of(const Golden& g, const Numbers& number) {
    FieldList all;
    const double unit = g.convention.length_unit;
    const std::string m = unit == 1 ? "m" : fmt::format("({} m)", shortest_decimal(unit));
    const ordered_json around = surroundings(g, number);
    const bool several = has_several_bodies(g);
    all.add("samples", g.motion.rows.size() / g.motion.bodies_at_once(), "");
    if (several)
        add_system_fields(g, around, m, all);
    else
        add_body_fields(g, around, m, all);
    all.add("bound", g.bound, "rad for q, relative to the largest norm for the others");
    add_tolerances(g, number, m, all);
    all.add("float32_floor", number(g.float32_floor), "rad: attitude error caused by rounding the start to binary32");
    add_motion(g, number, m, several, all);
    add_invariants(g, number, m, several, all);
    add_events(g, number, m, all);
    return std::move(all.fields);
}

// The comment at the top of the code in all three languages.
std::vector<std::string> preface(const Golden& g) {
    const double unit = g.convention.length_unit;
    std::vector<std::string> lines{
        fmt::format("{}: {}", comment(g.scene.name), comment(g.scene.about)),
        fmt::format("Truth: {}; scene {}.", comment(g.truth), g.scene_hash),
        fmt::format("{} units{}. Axes: {}. q (order {}) maps body to world; w is in {} axes;",
                    unit == 1 ? "SI" : fmt::format("Lengths in {} m, all else in SI", shortest_decimal(unit)),
                    g.convention.degrees ? ", w in degrees/s" : "", axes_of(g),
                    scalar_last(g) ? "x, y, z, w" : "w, x, y, z", g.convention.body_rates ? "body" : "world"),
        "p and v are those of the centre of mass. Each number is correct to within the bound and its rounding.",
        "A test creates a body from mass, center_of_mass and inertia, starts it at q[0], w[0], p[0], v[0], applies the",
        "loads, steps to each t and passes the engine's state to compare, with null for blocks that the engine does",
        "not have. Tolerances of energy and momentum are relative to their largest value over the run. Loads, planes",
        "and the pieces whose convex hull is the body's shape are numbered and use the same axes."};
    if (!has_several_bodies(g)) return lines;
    lines.resize(lines.size() - 4);
    for (const char* line :
         {"A test creates the bodies from mass, center_of_mass and inertia, connects them by the joints and loops,",
          "starts each at q[body], w[body], p[body], v[body], applies the loads, steps to each t and passes the",
          "state of each body to compare, with null for blocks that the engine does not have. Energy and momentum are",
          "those of the whole system; their tolerances are relative to their largest value over the run."})
        lines.emplace_back(line);
    return lines;
}

// The function that compares. Placeholders: NAME_ is the prefix of names, REAL the type of numbers, SCALAR and VECTOR
// are the offsets of a quaternion's parts, DATA converts a row to a pointer. No parameter hides a constant.
constexpr const char* compare_c = R"(
/* Returns the number of blocks of WHOSE state at sample k that exceed their tolerances. Blocks whose pointer is null
 * are not compared. If size > 0, the message lists the blocks that exceed them, with their errors. */
static inline int NAME_compare(size_t k, C_PARAMETERconst REAL *own_q, const REAL *own_w, const REAL *own_p, const REAL *own_v,
                               const REAL *own_energy, const REAL *own_momentum, char *message, size_t size) {
    const struct {
        const char *name;
        const REAL *own, *expected;
        int count;
        double allowed, scale;
    } blocks[6] = {{"attitude", own_q, NAME_q[C_ROW]DATA, 4, NAME_tolerance, 1},
                   {"angular velocity", own_w, NAME_w[C_ROW]DATA, 3, NAME_tolerance_angular_velocity, 1},
                   {"position", own_p, NAME_p[C_ROW]DATA, 3, NAME_tolerance_position, 1},
                   {"velocity", own_v, NAME_v[C_ROW]DATA, 3, NAME_tolerance_velocity, 1},
                   {"energy", own_energy, &NAME_energy[k], 1, NAME_tolerance_energy, NAME_energy_scale},
                   {"angular momentum", own_momentum, NAME_momentum[k]DATA, 3, NAME_tolerance_momentum,
                    NAME_momentum_scale}};
    int block, i, failed = 0;
    if (size > 0) message[0] = 0;
    for (block = 0; block < 6; ++block) {
        const REAL *const x = blocks[block].expected, *const y = blocks[block].own;
        double off = 0;
        if (!y) continue;
        if (blocks[block].count == 4) {
            /* the rotation between the two: 2 atan2(|vec|, |scal|) of conj(x) y */
            const double s = x[SCALAR], a = x[VECTOR], b = x[VECTOR + 1], c = x[VECTOR + 2];
            const double e = y[SCALAR], f = y[VECTOR], g = y[VECTOR + 1], h = y[VECTOR + 2];
            const double l = s * f - e * a - (b * h - c * g), m = s * g - e * b - (c * f - a * h);
            const double n = s * h - e * c - (a * g - b * f);
            off = 2 * atan2(sqrt(l * l + m * m + n * n), fabs(s * e + a * f + b * g + c * h));
        } else {
            for (i = 0; i < blocks[block].count; ++i) {
                const double a = x[i], b = y[i];
                off += (b - a) * (b - a);
            }
            off = sqrt(off) / blocks[block].scale;
        }
        /* NaN exceeds any tolerance */
        if (off <= blocks[block].allowed) continue;
        ++failed;
        if (size > 0) {
            const size_t used = strlen(message);
            snprintf(message + used, size - used, "%s%s error %.6g at t = %.6g s exceeds %.6g", used > 0 ? "; " : "",
                     blocks[block].name, off, NAME_t[k], blocks[block].allowed);
        }
    }
    return failed;
}
)";

// Placeholders whose text depends on the number of bodies. A placeholder precedes those that its name contains.
struct MarkOfBodies {
    const char *mark, *of_one, *of_several;
};
constexpr MarkOfBodies marks_of_bodies[] = {{"WHOSE", "the engine's", "a body's"},
                                            {"ARGUMENT", "", "body, "},
                                            {"C_PARAMETER", "", "size_t body, "},
                                            {"C_ROW", "k", "k * NAME_bodies + body"},
                                            {"CS_PARAMETER", "", "int body, "},
                                            {"CS_ROW", "k", "row"},
                                            {"ROW_LINE", "", "int row = k * bodies + body;\n        "},
                                            {"AT_TYPE", "", ", int"},
                                            {"AT_PARAMETER", "", ", at"},
                                            {"[AT,", "[k,", "[at,"},
                                            {"OF_ROW", "", ", row"},
                                            {"OF_SAMPLE", "", ", k"}};

// C++: text before and after the function
constexpr const char* names_of_cpp = R"(
using std::atan2, std::fabs, std::size_t, std::snprintf, std::sqrt, std::strlen;
)";
constexpr const char* compare_cpp = R"(
/// Returns the message of the function above: empty if no block exceeds its tolerance.
inline std::string compare(size_t k, C_PARAMETERconst REAL* own_q, const REAL* own_w = nullptr, const REAL* own_p = nullptr,
                           const REAL* own_v = nullptr, const REAL* own_energy = nullptr,
                           const REAL* own_momentum = nullptr) {
    char message[1000];
    compare(k, ARGUMENTown_q, own_w, own_p, own_v, own_energy, own_momentum, message, sizeof message);
    return message;
}
)";

constexpr const char* compare_csharp = R"(
    /// Returns the blocks of WHOSE state at sample k that exceed their tolerances, with their errors; empty if there is
    /// none. Blocks that are null are not compared.
    public static string compare(int k, CS_PARAMETERREAL[] own_q, REAL[] own_w = null, REAL[] own_p = null, REAL[] own_v = null,
                                 REAL? own_energy = null, REAL[] own_momentum = null) {
        var failed = new System.Collections.Generic.List<string>();
        System.Action<string, double, double> judge = (name, off, allowed) => {
            // NaN exceeds any tolerance
            if (off <= allowed) return;
            failed.Add(string.Format(System.Globalization.CultureInfo.InvariantCulture,
                                     "{0} error {1:G6} at t = {2:G6} s exceeds {3:G6}", name, off, t[k], allowed));
        };
        ROW_LINESystem.Func<REAL[], REAL[,]AT_TYPE, double> distance = (own, expectedAT_PARAMETER) => {
            double off = 0;
            for (int i = 0; i < 3; ++i) off += ((double)own[i] - expected[AT, i]) * ((double)own[i] - expected[AT, i]);
            return System.Math.Sqrt(off);
        };
        if (own_q != null) {
            // the rotation between the two: 2 atan2(|vec|, |scal|) of conj(x) y
            double s = q[CS_ROW, SCALAR], a = q[CS_ROW, VECTOR], b = q[CS_ROW, VECTOR + 1], c = q[CS_ROW, VECTOR + 2];
            double e = own_q[SCALAR], f = own_q[VECTOR], g = own_q[VECTOR + 1], h = own_q[VECTOR + 2];
            double x = s * f - e * a - (b * h - c * g), y = s * g - e * b - (c * f - a * h);
            double z = s * h - e * c - (a * g - b * f);
            judge("attitude", 2 * System.Math.Atan2(System.Math.Sqrt(x * x + y * y + z * z),
                                                    System.Math.Abs(s * e + a * f + b * g + c * h)), tolerance);
        }
        if (own_w != null) judge("angular velocity", distance(own_w, wOF_ROW), tolerance_angular_velocity);
        if (own_p != null) judge("position", distance(own_p, pOF_ROW), tolerance_position);
        if (own_v != null) judge("velocity", distance(own_v, vOF_ROW), tolerance_velocity);
        if (own_energy != null)
            judge("energy", System.Math.Abs((double)own_energy - energy[k]) / energy_scale, tolerance_energy);
        if (own_momentum != null)
            judge("angular momentum", distance(own_momentum, momentumOF_SAMPLE) / momentum_scale, tolerance_momentum);
        return string.Join("; ", failed);
    }
)";

std::string code(const Golden& g, GoldenFormat format, const Numbers& number) {
    const Language language{format, number.floats};
    const std::string plain = identifier(g.scene.name), name = "polhode_" + plain;
    std::string guard = name + (format == GoldenFormat::c ? "_H" : "_HPP");
    std::ranges::transform(guard, guard.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    const bool c = format == GoldenFormat::c, csharp = format == GoldenFormat::csharp;
    std::string text = "/*";
    for (const std::string& line : preface(g)) text += (text == "/*" ? " " : "\n * ") + line;
    text += " */\n";
    if (!csharp) text += fmt::format("#ifndef {0}\n#define {0}\n\n", guard);
    if (c) text += "#include <math.h>\n#include <stddef.h>\n#include <stdio.h>\n#include <string.h>\n\n";
    if (format == GoldenFormat::cpp)
        text += fmt::format(
            "#include <array>\n#include <cmath>\n#include <cstddef>\n#include <cstdio>\n#include <cstring>\n"
            "#include <string>\n\nnamespace {} {{\n\n",
            name);
    if (csharp) text += fmt::format("public static class Polhode_{} {{\n", plain);
    for (const Field& field : fields_of(g, number)) text += language.constant(c ? name + "_" : "", field);
    std::string compare = csharp ? compare_csharp : compare_c;
    if (format == GoldenFormat::cpp)
        compare = names_of_cpp + replace_all(compare, "static inline", "inline") + compare_cpp;
    for (const auto& [what, of_one, of_several] : marks_of_bodies)
        compare = replace_all(std::move(compare), what, has_several_bodies(g) ? of_several : of_one);
    // the name comes last: it may contain any word
    for (const auto& [what, by] : {std::pair<std::string, std::string>{"REAL", language.real()},
                                   {"SCALAR", scalar_last(g) ? "3" : "0"},
                                   {"VECTOR", scalar_last(g) ? "0" : "1"},
                                   {"DATA", c ? "" : ".data()"},
                                   {"NAME_", c ? name + "_" : ""}})
        compare = replace_all(std::move(compare), what, by);
    text += compare;
    if (csharp) return text + "}\n";
    return text + (c ? "" : fmt::format("\n}}  // namespace {}\n", name)) + fmt::format("\n#endif /* {} */\n", guard);
}

}  // namespace

std::string golden_text(const Golden& g, GoldenFormat format, bool floats) {
    const Numbers number{floats};
    switch (format) {
        case GoldenFormat::csv:
            return csv(g, number);
        case GoldenFormat::json:
            return json(g, number);
        default:
            return code(g, format, number);
    }
}

}  // namespace polhode
