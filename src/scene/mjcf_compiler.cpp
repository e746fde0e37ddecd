// Reads the settings of MJCF's <compiler>.
#include <fmt/format.h>

#include "scene/mjcf_values.h"
#include "text/message.h"

namespace polhode {
namespace {

// The index of the attribute's value among `words`, or `fallback` if the attribute is missing.
std::size_t word(const RobotXml& xml, const XMLElement& at, const char* name, const std::vector<std::string>& words,
                 std::size_t fallback) {
    const char* text = at.Attribute(name);
    if (!text) return fallback;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (text == words[i]) return i;
    xml.fail(at, fmt::format("has \"{}\" in {}", one_line(text, 40), name), "give one of " + join_with_commas(words));
}

bool flag_or(const RobotXml& xml, const XMLElement& at, const char* name, bool fallback) {
    return at.Attribute(name) ? xml.flag(at, name) : fallback;
}

// Lower-case letters rotate about body axes, upper-case letters about fixed axes.
void read_sequence(const RobotXml& xml, const XMLElement& at, EulerRotation& euler) {
    const char* sequence = at.Attribute("eulerseq");
    if (!sequence) return;
    const std::string_view letters = sequence;
    const bool turned = letters.find_first_not_of("xyz") == letters.npos;
    if (letters.size() != 3 || (!turned && letters.find_first_not_of("XYZ") != letters.npos))
        xml.fail(at, fmt::format("has the eulerseq \"{}\"", one_line(letters, 40)),
                 "give three letters of xyz (rotating axes) or of XYZ (fixed axes)");
    euler.intrinsic = turned;
    for (std::size_t i = 0; i < 3; ++i) euler.axes[i] = letters[i] - (turned ? 'x' : 'X');
}

void read_mass_rules(const RobotXml& xml, const XMLElement& at, MjcfCompiler& compiler) {
    constexpr MjcfInertia rules[] = {MjcfInertia::from_inertials, MjcfInertia::from_geoms, MjcfInertia::either};
    compiler.inertia = rules[word(xml, at, "inertiafromgeom", {"false", "true", "auto"},
                                  compiler.inertia == MjcfInertia::from_inertials ? 0
                                  : compiler.inertia == MjcfInertia::from_geoms   ? 1
                                                                                  : 2)];
    if (at.Attribute("inertiagrouprange")) {
        const std::vector<double> range = xml.attribute(at, "inertiagrouprange", 2);
        compiler.first_group = range[0], compiler.last_group = range[1];
    }
    compiler.least_mass = xml.attribute_or(at, "boundmass", compiler.least_mass);
    compiler.least_moment = xml.attribute_or(at, "boundinertia", compiler.least_moment);
    compiler.balances = flag_or(xml, at, "balanceinertia", compiler.balances);
    compiler.total_mass = xml.attribute_or(at, "settotalmass", compiler.total_mass);
}

void read_folder(const XMLElement& at, const char* name, MjcfCompiler& compiler) {
    const char* folder = at.Attribute(name);
    if (!folder) return;
    compiler.mesh_folder = folder;
    if (!compiler.mesh_folder.empty() && compiler.mesh_folder.back() != '/') compiler.mesh_folder += '/';
}

}  // namespace

MjcfCompiler mjcf_compiler(const RobotXml& xml, const XMLElement& root) {
    MjcfCompiler compiler;
    for (const XMLElement* c = root.FirstChildElement("compiler"); c; c = c->NextSiblingElement("compiler")) {
        if (word(xml, *c, "coordinate", {"local", "global"}, 0) == 1)
            xml.fail(*c, "has global coordinates, which MuJoCo removed in version 2.3.4",
                     "load and save the file with MuJoCo 2.3.3 or older");
        compiler.in_degrees = word(xml, *c, "angle", {"radian", "degree"}, compiler.in_degrees) == 1;
        read_sequence(xml, *c, compiler.euler);
        read_mass_rules(xml, *c, compiler);
        read_folder(*c, "assetdir", compiler);
        read_folder(*c, "meshdir", compiler);
        compiler.strips_path = flag_or(xml, *c, "strippath", compiler.strips_path);
        compiler.fuses_static = flag_or(xml, *c, "fusestatic", compiler.fuses_static);
        compiler.aligns_free = flag_or(xml, *c, "alignfree", compiler.aligns_free);
        compiler.drops_visual = flag_or(xml, *c, "discardvisual", compiler.drops_visual);
        compiler.exact_meshes = flag_or(xml, *c, "exactmeshinertia", compiler.exact_meshes);
        compiler.fits_box = flag_or(xml, *c, "fitaabb", compiler.fits_box);
    }
    compiler.euler.in_degrees = compiler.in_degrees;
    return compiler;
}

}  // namespace polhode
