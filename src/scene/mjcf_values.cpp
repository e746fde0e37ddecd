// Orientations and inertials of MJCF.
#include "scene/mjcf_values.h"

#include <fmt/format.h>

#include "text/message.h"

namespace polhode {
namespace {

Vector3<Wide> unit_vector(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v) {
    const Wide length = square_root(dot(v, v));
    if (!(length > Wide(1e-100))) xml.fail(at, fmt::format("has no direction in {}", what), "give a direction");
    return (Wide(1) / length) * v;
}

// The rotation whose columns are these three, by its largest component (Shepperd).
Quaternion<Wide> turn_of_columns(const Vector3<Wide>& x, const Vector3<Wide>& y, const Vector3<Wide>& z) {
    const Wide squares[4] = {Wide(1) + x[0] + y[1] + z[2], Wide(1) + x[0] - y[1] - z[2], Wide(1) - x[0] + y[1] - z[2],
                             Wide(1) - x[0] - y[1] + z[2]};
    int largest = 0;
    for (int i = 1; i < 4; ++i)
        if (squares[i] > squares[largest]) largest = i;
    const Wide four = squares[largest];
    switch (largest) {
        case 0:
            return normalized(Quaternion<Wide>{four, y[2] - z[1], z[0] - x[2], x[1] - y[0]});
        case 1:
            return normalized(Quaternion<Wide>{y[2] - z[1], four, x[1] + y[0], z[0] + x[2]});
        case 2:
            return normalized(Quaternion<Wide>{z[0] - x[2], x[1] + y[0], four, y[2] + z[1]});
        default:
            return normalized(Quaternion<Wide>{x[1] - y[0], z[0] + x[2], y[2] + z[1], four});
    }
}

Quaternion<Wide> turn_about(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler) {
    const std::vector<double> v = xml.attribute(at, "axisangle", 4);
    const Vector3<Wide> axis = unit_vector(xml, at, "axisangle", cast<Wide>(three_of(v)));
    Wide half = Wide(v[3]) / Wide(2), sine, cosine;
    if (compiler.in_degrees) half = half * Elementary<Wide>::pi() / Wide(180);
    Elementary<Wide>::sine_cosine(half, sine, cosine);
    return {cosine, sine * axis[0], sine * axis[1], sine * axis[2]};
}

}  // namespace

Quaternion<Wide> turn_from_z(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v) {
    const Vector3<Wide> to = unit_vector(xml, at, what, v);
    // half way between z and there; a half turn about x where that is nowhere
    const Quaternion<Wide> twice{Wide(1) + to[2], -to[1], to[0], Wide(0)};
    return squared_norm(twice) > Wide(1e-60) ? normalized(twice) : Quaternion<Wide>{Wide(0), Wide(1), Wide(0), Wide(0)};
}

MjcfCompiler mjcf_compiler(const RobotXml& xml, const XMLElement& root) {
    MjcfCompiler compiler;
    for (const XMLElement* c = root.FirstChildElement("compiler"); c; c = c->NextSiblingElement("compiler")) {
        if (const char* angle = c->Attribute("angle")) {
            if (std::string_view(angle) != "degree" && std::string_view(angle) != "radian")
                xml.fail(*c, fmt::format("has the angle \"{}\"", one_line(angle, 40)), "give degree or radian");
            compiler.in_degrees = std::string_view(angle) == "degree";
        }
        const char* sequence = c->Attribute("eulerseq");
        if (!sequence) continue;
        const std::string_view letters = sequence;
        // lower case turns with the body, upper case is fixed
        const bool turned = letters.find_first_not_of("xyz") == letters.npos;
        if (letters.size() != 3 || (!turned && letters.find_first_not_of("XYZ") != letters.npos))
            xml.fail(*c, fmt::format("has the eulerseq \"{}\"", one_line(letters, 40)),
                     "give three of xyz (turned axes) or of XYZ (fixed axes)");
        compiler.euler.about_turned_axes = turned;
        for (std::size_t i = 0; i < 3; ++i) compiler.euler.axes[i] = letters[i] - (turned ? 'x' : 'X');
    }
    compiler.euler.in_degrees = compiler.in_degrees;
    return compiler;
}

Quaternion<Wide> mjcf_turn(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler) {
    const char* chosen = nullptr;
    for (const char* name : {"quat", "axisangle", "euler", "xyaxes", "zaxis"}) {
        if (!at.Attribute(name)) continue;
        if (chosen) xml.fail(at, "has two orientations", fmt::format("give {} or {}, not both", chosen, name));
        chosen = name;
    }
    if (!chosen) return {};
    const std::string_view kind = chosen;
    if (kind == "quat") {
        const std::vector<double> v = xml.attribute(at, "quat", 4);
        return unit_quaternion<Wide>(xml.turn_by(at, {v[0], v[1], v[2], v[3]}));
    }
    if (kind == "euler") {
        EulerTurn turn = compiler.euler;
        turn.angles = three_of(xml.attribute(at, "euler", 3));
        return unit_quaternion<Wide>(turn);
    }
    if (kind == "axisangle") return turn_about(xml, at, compiler);
    if (kind == "zaxis") return turn_from_z(xml, at, "zaxis", cast<Wide>(three_of(xml.attribute(at, "zaxis", 3))));
    const std::vector<double> v = xml.attribute(at, "xyaxes", 6);
    const Vector3<Wide> x = unit_vector(xml, at, "xyaxes", cast<Wide>(three_of(v)));
    const Vector3<Wide> along = cast<Wide>(three_of(v, 3));
    const Vector3<Wide> y = unit_vector(xml, at, "xyaxes", along - dot(along, x) * x);
    return turn_of_columns(x, y, cross(x, y));
}

ImportedBody mjcf_inertial(const RobotXml& xml, const XMLElement& inertial, const MjcfCompiler& compiler) {
    ImportedBody body;
    body.center_of_mass = three_of(xml.attribute(inertial, "pos", 3));
    for (const char* name : {"axisangle", "xyaxes", "zaxis"})
        if (inertial.Attribute(name))
            xml.fail(inertial, fmt::format("has an orientation by \"{}\"", name), "give it as quat or euler");
    if (inertial.Attribute("quat") && inertial.Attribute("euler"))
        xml.fail(inertial, "has two orientations", "give quat or euler, not both");
    if (inertial.Attribute("quat")) {
        const std::vector<double> v = xml.attribute(inertial, "quat", 4);
        body.orientation = xml.turn_by(inertial, {v[0], v[1], v[2], v[3]});
    } else if (inertial.Attribute("euler")) {
        EulerTurn turn = compiler.euler;
        turn.angles = three_of(xml.attribute(inertial, "euler", 3));
        body.orientation = turn;
    }
    body.mass = xml.checked_mass(inertial, xml.attribute(inertial, "mass", 1)[0]);
    if (inertial.Attribute("fullinertia")) {
        if (inertial.Attribute("diaginertia"))
            xml.fail(inertial, "has both diaginertia and fullinertia", "give one of them");
        body.inertia = RobotXml::tensor(xml.attribute(inertial, "fullinertia", 6));
    } else {
        const std::vector<double> v = xml.attribute(inertial, "diaginertia", 3);
        body.inertia = RobotXml::tensor({v[0], v[1], v[2], 0, 0, 0});
    }
    return body;
}

}  // namespace polhode
