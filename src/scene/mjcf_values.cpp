// Orientations and inertials of MJCF, in 113 bits.
#include "scene/mjcf_values.h"

#include <fmt/format.h>

#include "text/message.h"

namespace polhode {
namespace {

Vector3<Wide> unit_vector(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v) {
    const Wide length = square_root(dot(v, v));
    if (!(length > Wide(1e-100)))
        xml.fail(at, fmt::format("has a vector of length zero in {}", what), "give a direction");
    return (Wide(1) / length) * v;
}

// The rotation whose matrix has these columns, from the largest quaternion component (Shepperd 1978).
Quaternion<Wide> rotation_from_columns(const Vector3<Wide>& x, const Vector3<Wide>& y, const Vector3<Wide>& z) {
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

Quaternion<Wide> rotation_from_z(const RobotXml& xml, const XMLElement& at, const char* what, const Vector3<Wide>& v) {
    const Vector3<Wide> to = unit_vector(xml, at, what, v);
    // the unnormalised quaternion to half-way between z and `to`; a half rotation about x if they are opposite
    const Quaternion<Wide> twice{Wide(1) + to[2], -to[1], to[0], Wide(0)};
    return squared_norm(twice) > Wide(1e-60) ? normalized(twice) : Quaternion<Wide>{Wide(0), Wide(1), Wide(0), Wide(0)};
}

Quaternion<Wide> mjcf_euler(const Vector3<double>& angles, const MjcfCompiler& compiler) {
    EulerRotation turn = compiler.euler;
    turn.angles = angles;
    return unit_quaternion<Wide>(turn);
}

Quaternion<Wide> mjcf_rotation(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler) {
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
        return unit_quaternion<Wide>(xml.rotate_by(at, {v[0], v[1], v[2], v[3]}));
    }
    if (kind == "euler") return mjcf_euler(three_of(xml.attribute(at, "euler", 3)), compiler);
    if (kind == "axisangle") return turn_about(xml, at, compiler);
    if (kind == "zaxis") return rotation_from_z(xml, at, "zaxis", cast<Wide>(three_of(xml.attribute(at, "zaxis", 3))));
    const std::vector<double> v = xml.attribute(at, "xyaxes", 6);
    const Vector3<Wide> x = unit_vector(xml, at, "xyaxes", cast<Wide>(three_of(v)));
    const Vector3<Wide> along = cast<Wide>(three_of(v, 3));
    const Vector3<Wide> y = unit_vector(xml, at, "xyaxes", along - dot(along, x) * x);
    return rotation_from_columns(x, y, cross(x, y));
}

RobotPose mjcf_pose(const RobotXml& xml, const XMLElement& at, const MjcfCompiler& compiler) {
    RobotPose pose;
    if (at.Attribute("pos")) pose.position = cast<Wide>(three_of(xml.attribute(at, "pos", 3)));
    pose.turn = mjcf_rotation(xml, at, compiler);
    return pose;
}

namespace {

// Mass, centre and tensor in the frame of the inertial.
ImportedBody inertial_numbers(const RobotXml& xml, const XMLElement& inertial) {
    ImportedBody body;
    body.center_of_mass = three_of(xml.attribute(inertial, "pos", 3));
    body.mass = xml.checked_mass(inertial, xml.attribute(inertial, "mass", 1)[0]);
    if (inertial.Attribute("fullinertia")) {
        for (const char* other : {"diaginertia", "quat", "axisangle", "euler", "xyaxes", "zaxis"})
            if (inertial.Attribute(other))
                xml.fail(inertial, fmt::format("has both fullinertia and {}", other), "remove one of them");
        body.inertia = RobotXml::tensor(xml.attribute(inertial, "fullinertia", 6));
    } else if (inertial.Attribute("diaginertia")) {
        const std::vector<double> v = xml.attribute(inertial, "diaginertia", 3);
        body.inertia = RobotXml::tensor({v[0], v[1], v[2], 0, 0, 0});
    }
    return body;
}

}  // namespace

MassProperties<Wide> mjcf_inertial(const RobotXml& xml, const XMLElement& inertial, const MjcfCompiler& compiler) {
    const ImportedBody body = inertial_numbers(xml, inertial);
    return {Wide(body.mass), cast<Wide>(body.center_of_mass),
            rotated(cast<Wide>(body.inertia), mjcf_rotation(xml, inertial, compiler))};
}

std::optional<ImportedBody> mjcf_given_inertial(const RobotXml& xml, const XMLElement& inertial,
                                                const MjcfCompiler& compiler) {
    for (const char* name : {"axisangle", "xyaxes", "zaxis"})
        if (inertial.Attribute(name)) return {};
    ImportedBody body = inertial_numbers(xml, inertial);
    mjcf_rotation(xml, inertial, compiler);  // validates the orientation
    if (inertial.Attribute("quat")) {
        const std::vector<double> v = xml.attribute(inertial, "quat", 4);
        body.orientation = Quaternion<double>{v[0], v[1], v[2], v[3]};
    } else if (inertial.Attribute("euler")) {
        EulerRotation turn = compiler.euler;
        turn.angles = three_of(xml.attribute(inertial, "euler", 3));
        body.orientation = turn;
    }
    return body;
}

}  // namespace polhode
