// The table of MJCF elements and attributes, and how the importer treats each (MuJoCo 2.1 to 3.x; names of all
// versions).
//
// Attributes and children of an element that is irrelevant or omitted as a whole share its verdict and are not
// listed. Elements inside <default> have no attributes when the table is applied: mjcf_defaults.cpp has written them
// into the elements of their class. <composite> and <flexcomp> elements that create bodies are refused by name
// (mjcf_parts.cpp).
#include <tinyxml2.h>

#include <string_view>

#include "scene/mjcf_actuators.h"
#include "scene/robot_schema.h"

namespace polhode {
namespace {

using enum RobotVerdict;

bool has_word(const XMLElement& at, const char* attribute, std::string_view word) {
    const char* text = at.Attribute(attribute);
    return text && text == word;
}

// Whether an attribute contains a number that is not zero.
bool is_set(const XMLElement& at, const char* attribute) {
    const char* text = at.Attribute(attribute);
    return text && std::string_view(text).find_first_of("123456789") != std::string_view::npos;
}

const XMLElement* model_of(const XMLElement& at) {
    const tinyxml2::XMLNode* node = &at;
    while (node->Parent() && node->Parent()->ToElement()) node = node->Parent();
    return node->ToElement();
}

// limited="auto" follows autolimits, which is on unless the file disables it
bool is_limited(const XMLElement& at, const char* limited, const char* range) {
    if (has_word(at, limited, "false")) return false;
    if (has_word(at, limited, "true")) return true;
    if (!is_set(at, range)) return false;
    bool automatic = true;
    for (const XMLElement* c = model_of(at)->FirstChildElement("compiler"); c; c = c->NextSiblingElement("compiler"))
        if (c->Attribute("autolimits")) automatic = !has_word(*c, "autolimits", "false");
    return automatic;
}
bool has_limits(const XMLElement& at) { return !has_word(at, "type", "free") && is_limited(at, "limited", "range"); }

}  // namespace

bool has_mjcf_limits(const XMLElement& at) { return has_limits(at); }
bool has_mjcf_range(const XMLElement& at, const char* limited, const char* range) {
    return is_limited(at, limited, range);
}

namespace {

// wind acts only in a medium
bool has_wind(const XMLElement& at) {
    if (!is_set(at, "wind")) return false;
    for (const XMLElement* o = model_of(at)->FirstChildElement("option"); o; o = o->NextSiblingElement("option"))
        if (is_set(*o, "density") || is_set(*o, "viscosity")) return true;
    return false;
}

bool is_active(const XMLElement& at) { return !has_word(at, "active", "false"); }

bool acts_as_tendon(const XMLElement& at) {
    for (const char* name : {"stiffness", "damping", "frictionloss", "armature"})
        if (is_set(at, name)) return true;
    return has_limits(at);
}

bool is_soft(const XMLElement& at) { return !has_word(at, "rigid", "true"); }

constexpr const char* angles = "orientation";
constexpr const char* soft = "softness of contacts or constraints";
constexpr const char* looks = "appearance";
constexpr const char* numerics = "numerical setting of MuJoCo";
constexpr const char* contact = "contact is omitted entirely and reported per body";
constexpr const char* label = "a name or number for other programs";
constexpr const char* switches = "switches a part that is omitted or reported elsewhere";
constexpr const char* actuation = "affects only actuators that are reported as omitted";
constexpr const char* by_class = "default values, copied to the elements of the class";
constexpr const char* equalities = "equality constraints";
constexpr const char* actuators = "actuators";

constexpr RobotConstruct mjcf_rows[] = {
    {"", "mujoco", "", modelled, "the root element"},
    {"", "mujoco", "model", irrelevant, "a name"},
    {"*", "include", "", modelled, "replaced by the children of the root of the included file"},
    {"*", "include", "file", modelled, "the file; each file is included once"},

    {"mujoco", "compiler", "", modelled, "several elements are merged"},
    {"mujoco", "compiler", "angle", modelled, "degree (default) or radian"},
    {"mujoco", "compiler", "eulerseq", modelled, "axes of Euler angles"},
    {"mujoco", "compiler", "coordinate", modelled, "local; global is refused"},
    {"mujoco", "compiler", "autolimits", modelled, "whether a range without \"limited\" counts as a limit"},
    {"mujoco", "compiler", "inertiafromgeom", modelled,
     "masses from geoms, from inertials, or from inertials where given"},
    {"mujoco", "compiler", "inertiagrouprange", modelled, "groups of geoms that have mass"},
    {"mujoco", "compiler", "boundmass", modelled, "minimum mass of a body"},
    {"mujoco", "compiler", "boundinertia", modelled, "minimum principal moment of a body"},
    {"mujoco", "compiler", "balanceinertia", modelled, "impossible principal moments are replaced by their mean"},
    {"mujoco", "compiler", "settotalmass", modelled, "scales all masses and tensors"},
    {"mujoco", "compiler", "fusestatic", modelled, "bodies fixed to the world do not count for settotalmass"},
    {"mujoco", "compiler", "alignfree", modelled, "the point where the damping of a free body acts"},
    {"mujoco", "compiler", "discardvisual", modelled, "the mass of visual shapes is kept, as in MuJoCo 3"},
    {"mujoco", "compiler", "assetdir", modelled, "folder of meshes"},
    {"mujoco", "compiler", "meshdir", modelled, "folder of meshes"},
    {"mujoco", "compiler", "strippath", modelled, "only the file name of each mesh path is used"},
    {"mujoco", "compiler", "fitaabb", modelled, "fits to bounding boxes are refused where their mass matters"},
    {"mujoco", "compiler", "exactmeshinertia", modelled, "mesh volumes are always exact"},
    {"mujoco", "compiler", "texturedir", irrelevant, looks},
    {"mujoco", "compiler", "convexhull", irrelevant, contact},
    {"mujoco", "compiler", "usethread", irrelevant, numerics},
    {"mujoco", "compiler", "saveinertial", irrelevant, "affects only files that MuJoCo writes"},
    {"mujoco", "compiler", "conflict", omitted, "options merged from attached models", "warning|error"},
    {"compiler", "lengthrange", "", irrelevant, actuation},

    {"mujoco", "option", "", modelled, "several elements are merged"},
    {"mujoco", "option", "gravity", modelled, "gravity, by default (0, 0, -9.81)"},
    {"mujoco", "option", "wind", omitted, "fluid forces", {}, has_wind},
    {"mujoco", "option", "density", omitted, "fluid forces", "0"},
    {"mujoco", "option", "viscosity", omitted, "fluid forces", "0"},
    {"mujoco", "option", "magnetic", irrelevant, "affects only sensors"},
    {"mujoco", "option", "timestep", irrelevant, numerics},
    {"mujoco", "option", "integrator", irrelevant, numerics},
    {"mujoco", "option", "apirate", irrelevant, numerics},
    {"mujoco", "option", "collision", irrelevant, contact},
    {"mujoco", "option", "cone", irrelevant, contact},
    {"mujoco", "option", "impratio", irrelevant, soft},
    {"mujoco", "option", "o_margin", irrelevant, soft},
    {"mujoco", "option", "o_solref", irrelevant, soft},
    {"mujoco", "option", "o_solimp", irrelevant, soft},
    {"mujoco", "option", "o_friction", irrelevant, soft},
    {"mujoco", "option", "jacobian", irrelevant, numerics},
    {"mujoco", "option", "solver", irrelevant, numerics},
    {"mujoco", "option", "iterations", irrelevant, numerics},
    {"mujoco", "option", "tolerance", irrelevant, numerics},
    {"mujoco", "option", "ls_iterations", irrelevant, numerics},
    {"mujoco", "option", "ls_tolerance", irrelevant, numerics},
    {"mujoco", "option", "noslip_iterations", irrelevant, numerics},
    {"mujoco", "option", "noslip_tolerance", irrelevant, numerics},
    {"mujoco", "option", "mpr_iterations", irrelevant, numerics},
    {"mujoco", "option", "mpr_tolerance", irrelevant, numerics},
    {"mujoco", "option", "ccd_iterations", irrelevant, numerics},
    {"mujoco", "option", "ccd_tolerance", irrelevant, numerics},
    {"mujoco", "option", "sdf_iterations", irrelevant, numerics},
    {"mujoco", "option", "sdf_initpoints", irrelevant, numerics},
    {"mujoco", "option", "sleep_tolerance", irrelevant, "affects only the flag sleep, which is reported as omitted"},
    {"mujoco", "option", "actuatorgroupdisable", modelled, "groups of actuators that do not act"},
    {"option", "flag", "", modelled, "switches forces on and off"},
    {"option", "flag", "gravity", modelled, "disable: no gravity"},
    {"option", "flag", "passive", modelled, "disable: no springs and no dampers"},
    {"option", "flag", "spring", modelled, "disable: no springs"},
    {"option", "flag", "damper", modelled, "disable: no dampers"},
    {"option", "flag", "sleep", omitted, "sleeping of bodies", "disable"},
    {"option", "flag", "constraint", modelled, "disable: no equality constraints"},
    {"option", "flag", "equality", modelled, "disable: no equality constraints"},
    {"option", "flag", "frictionloss", irrelevant, switches},
    {"option", "flag", "limit", irrelevant, switches},
    {"option", "flag", "contact", irrelevant, switches},
    {"option", "flag", "filterparent", irrelevant, switches},
    {"option", "flag", "midphase", irrelevant, switches},
    {"option", "flag", "override", irrelevant, switches},
    {"option", "flag", "multiccd", irrelevant, switches},
    {"option", "flag", "nativeccd", irrelevant, switches},
    {"option", "flag", "actuation", modelled, "disable: no actuators"},
    {"option", "flag", "clampctrl", irrelevant, switches},
    {"option", "flag", "refsafe", irrelevant, switches},
    {"option", "flag", "diagexact", irrelevant, switches},
    {"option", "flag", "sensor", irrelevant, "sensors"},
    {"option", "flag", "sensornoise", irrelevant, "sensors"},
    {"option", "flag", "energy", irrelevant, "computes energies, which do not affect the motion"},
    {"option", "flag", "fwdinv", irrelevant, numerics},
    {"option", "flag", "invdiscrete", irrelevant, numerics},
    {"option", "flag", "warmstart", irrelevant, numerics},
    {"option", "flag", "eulerdamp", irrelevant, numerics},
    {"option", "flag", "autoreset", irrelevant, numerics},
    {"option", "flag", "island", irrelevant, numerics},

    {"mujoco", "size", "", irrelevant, "memory"},
    {"mujoco", "statistic", "", irrelevant, looks},
    {"mujoco", "visual", "", irrelevant, looks},
    {"mujoco", "custom", "", irrelevant, label},
    {"mujoco", "extension", "", irrelevant, "declares plugins, which are reported where they are used"},
    {"mujoco", "keyframe", "", irrelevant, "stored states; a scene starts in the pose as written"},
    {"mujoco", "sensor", "", irrelevant, "a sensor does not affect the motion"},
    {"mujoco", "contact", "", irrelevant, contact},
    {"mujoco", "deformable", "", modelled, "its elements are reported as omitted or irrelevant"},
    {"deformable", "flex", "", omitted, "flexible objects", {}, is_soft},
    {"deformable", "skin", "", irrelevant, looks},
    {"mujoco", "equality", "", modelled, "constraints that cannot be modelled are reported as omitted"},
    {"equality", "connect", "", modelled, "a spherical loop of two bodies; of sites: reported as omitted"},
    {"equality", "connect", "name", modelled, "the loop's name"},
    {"equality", "connect", "class", modelled, by_class},
    {"equality", "connect", "active", modelled, "whether the constraint acts"},
    {"equality", "connect", "solref", irrelevant, soft},
    {"equality", "connect", "solimp", irrelevant, soft},
    {"equality", "connect", "body1", modelled, "the first body"},
    {"equality", "connect", "body2", modelled, "the second body, by default the world"},
    {"equality", "connect", "anchor", modelled, "the point in the first body"},
    {"equality", "connect", "site1", modelled, "reported as omitted"},
    {"equality", "connect", "site2", modelled, "reported as omitted"},
    {"equality", "weld", "", modelled,
     "a fixed joint in place of the free joint of one body; others are reported as omitted"},
    {"equality", "weld", "name", irrelevant, "a name"},
    {"equality", "weld", "class", modelled, by_class},
    {"equality", "weld", "active", modelled, "whether the constraint acts"},
    {"equality", "weld", "solref", irrelevant, soft},
    {"equality", "weld", "solimp", irrelevant, soft},
    {"equality", "weld", "body1", modelled, "the first body"},
    {"equality", "weld", "body2", modelled, "the second body, by default the world"},
    {"equality", "weld", "relpose", modelled, "the pose of the second body in the first"},
    {"equality", "weld", "anchor", irrelevant, soft},
    {"equality", "weld", "torquescale", irrelevant, soft},
    {"equality", "weld", "site1", modelled, "reported as omitted"},
    {"equality", "weld", "site2", modelled, "reported as omitted"},
    {"equality", "joint", "", modelled,
     "a coupling, or a fixed joint without joint2; of higher order: reported as omitted"},
    {"equality", "joint", "name", irrelevant, "a name"},
    {"equality", "joint", "class", modelled, by_class},
    {"equality", "joint", "active", modelled, "whether the constraint acts"},
    {"equality", "joint", "solref", irrelevant, soft},
    {"equality", "joint", "solimp", irrelevant, soft},
    {"equality", "joint", "joint1", modelled, "the dependent joint"},
    {"equality", "joint", "joint2", modelled, "the other joint"},
    {"equality", "joint", "polycoef", modelled, "offset and ratio"},
    {"equality", "tendon", "", omitted, equalities, {}, is_active},
    {"equality", "flex", "", omitted, equalities, {}, is_active},
    {"equality", "flexvert", "", omitted, equalities, {}, is_active},
    {"equality", "flexstrain", "", omitted, equalities, {}, is_active},
    {"equality", "distance", "", omitted, equalities, {}, is_active},
    {"mujoco", "tendon", "", modelled, "elements that exert forces are reported as omitted"},
    {"tendon",
     "spatial",
     "",
     omitted,
     "tendons with springs, dampers, friction, armature or limits",
     {},
     acts_as_tendon},
    {"tendon", "fixed", "", omitted, "tendons with springs, dampers, friction, armature or limits", {}, acts_as_tendon},
    {"mujoco", "actuator", "", modelled, "drives of hinges and slides; others are reported as omitted"},
    {"actuator", "general", "", partial, actuators},
    {"actuator", "motor", "", partial, actuators},
    {"actuator", "position", "", partial, actuators},
    {"actuator", "velocity", "", partial, actuators},
    {"actuator", "intvelocity", "", omitted, actuators},
    {"actuator", "orientation", "", omitted, actuators},
    {"actuator", "pid", "", omitted, actuators},
    {"actuator", "damper", "", partial, actuators},
    {"actuator", "cylinder", "", omitted, actuators},
    {"actuator", "muscle", "", omitted, actuators},
    {"actuator", "adhesion", "", omitted, actuators},
    {"actuator", "dcmotor", "", omitted, actuators},
    {"actuator", "plugin", "", omitted, actuators},

    {"mujoco", "default", "", modelled, "classes of default values; several top-level elements are merged"},
    {"*", "default", "class", modelled, "name of the class; for a top-level element, another name of \"main\""},
    {"default", "default", "", modelled, "a class that inherits the values of the enclosing class"},
    {"default", "joint", "", modelled, by_class},
    {"default", "geom", "", modelled, by_class},
    {"default", "mesh", "", modelled, by_class},
    {"default", "equality", "", modelled, by_class},
    {"default", "tendon", "", modelled, by_class},
    {"default", "material", "", irrelevant, looks},
    {"default", "site", "", irrelevant, label},
    {"default", "camera", "", irrelevant, looks},
    {"default", "light", "", irrelevant, looks},
    {"default", "pair", "", irrelevant, contact},
    {"default", "general", "", modelled, by_class},
    {"default", "motor", "", modelled, by_class},
    {"default", "position", "", modelled, by_class},
    {"default", "velocity", "", modelled, by_class},
    {"default", "intvelocity", "", irrelevant, actuation},
    {"default", "orientation", "", irrelevant, actuation},
    {"default", "pid", "", irrelevant, actuation},
    {"default", "damper", "", modelled, by_class},
    {"default", "cylinder", "", irrelevant, actuation},
    {"default", "muscle", "", irrelevant, actuation},
    {"default", "adhesion", "", irrelevant, actuation},
    {"default", "dcmotor", "", irrelevant, actuation},

    {"mujoco", "asset", "", modelled, "meshes, height fields and models"},
    {"asset", "mesh", "", modelled, "a solid or a surface"},
    {"asset", "mesh", "name", modelled, "default: the file name without its extension"},
    {"asset", "mesh", "class", modelled, "class of <default>"},
    {"asset", "mesh", "file", modelled, "OBJ or STL"},
    {"asset", "mesh", "vertex", modelled, "vertices given inline"},
    {"asset", "mesh", "face", modelled, "faces of these vertices; default: faces of their convex hull"},
    {"asset", "mesh", "refpos", modelled, "subtracted from the vertices"},
    {"asset", "mesh", "refquat", modelled, "inverse rotation applied to the vertices"},
    {"asset", "mesh", "scale", modelled, "factors applied after refpos and refquat"},
    {"asset", "mesh", "inertia", modelled, "shell: surface; legacy, exact: exact volume; convex: volume of the hull"},
    {"asset", "mesh", "builtin", modelled, "refused where its mass matters"},
    {"asset", "mesh", "params", modelled, "parameters of builtin"},
    {"mesh", "plugin", "", modelled, "refused where its mass matters"},
    {"mesh", "plugin", "plugin", irrelevant, "refused where its mass matters"},
    {"mesh", "plugin", "instance", irrelevant, "refused where its mass matters"},
    {"plugin", "instance", "", irrelevant, "declared in <extension>"},
    {"plugin", "config", "", irrelevant, "refused where its mass matters"},
    {"asset", "mesh", "content_type", irrelevant, "the file name extension determines the format"},
    {"asset", "mesh", "normal", irrelevant, looks},
    {"asset", "mesh", "texcoord", irrelevant, looks},
    {"asset", "mesh", "smoothnormal", irrelevant, looks},
    {"asset", "mesh", "maxhullvert", modelled, "refused where the mass of the hull matters"},
    {"asset", "mesh", "material", irrelevant, looks},
    {"asset", "hfield", "", modelled, "a box with the mass that MuJoCo 3 computes"},
    {"asset", "hfield", "name", modelled, "its name"},
    {"asset", "hfield", "size", modelled, "half sizes x and y; a quarter of the height and half the base"},
    {"asset", "hfield", "content_type", irrelevant, contact},
    {"asset", "hfield", "file", irrelevant, contact},
    {"asset", "hfield", "nrow", irrelevant, contact},
    {"asset", "hfield", "ncol", irrelevant, contact},
    {"asset", "hfield", "elevation", irrelevant, contact},
    {"asset", "model", "", modelled, "a model to attach"},
    {"asset", "model", "name", modelled, "default: the name of the root element of the file"},
    {"asset", "model", "file", modelled, "an MJCF file"},
    {"asset", "model", "content_type", irrelevant, "only MJCF is read"},
    {"asset", "texture", "", irrelevant, looks},
    {"asset", "material", "", irrelevant, looks},
    {"asset", "skin", "", irrelevant, looks},

    {"mujoco", "worldbody", "", modelled, "the world; several elements are merged"},
    {"*", "body", "", modelled, "a body; without joints it is welded to its parent"},
    {"*", "body", "name", modelled, "name of the body; body1, .. if missing"},
    {"*", "body", "childclass", modelled, "class of the elements inside"},
    {"*", "body", "pos", modelled, "position in the parent"},
    {"*", "body", "quat", modelled, angles},
    {"*", "body", "axisangle", modelled, angles},
    {"*", "body", "euler", modelled, angles},
    {"*", "body", "xyaxes", modelled, angles},
    {"*", "body", "zaxis", modelled, angles},
    {"*", "body", "mocap", modelled, "mocap bodies do not move"},
    {"*", "body", "gravcomp", partial, "gravity compensation of bodies", "0"},
    {"*", "body", "sleep", irrelevant, "affects only the flag sleep, which is reported as omitted"},
    {"*", "body", "simple", irrelevant, numerics},
    {"*", "body", "user", irrelevant, label},
    {"*", "frame", "", modelled, "a pose of the elements inside"},
    {"*", "frame", "name", modelled, "name used by <attach>"},
    {"*", "frame", "childclass", modelled, "class of the elements inside"},
    {"*", "frame", "pos", modelled, "position"},
    {"*", "frame", "quat", modelled, angles},
    {"*", "frame", "axisangle", modelled, angles},
    {"*", "frame", "euler", modelled, angles},
    {"*", "frame", "xyaxes", modelled, angles},
    {"*", "frame", "zaxis", modelled, angles},
    {"*", "replicate", "", modelled, "copies of the elements inside"},
    {"*", "replicate", "count", modelled, "number of copies"},
    {"*", "replicate", "offset", modelled, "translation from copy to copy, in the axes of the previous copy"},
    {"*", "replicate", "euler", modelled, "rotation, multiplied by the index of the copy"},
    {"*", "replicate", "sep", modelled, "separator between a name and the index of the copy"},
    {"*", "replicate", "childclass", modelled, "class of the elements inside"},
    {"*", "attach", "", modelled, "a body, a frame or another model as a whole"},
    {"*", "attach", "model", modelled, "name of the model; this model if missing"},
    {"*", "attach", "body", modelled, "the body"},
    {"*", "attach", "frame", modelled, "the frame"},
    {"*", "attach", "prefix", modelled, "prefix of the attached names"},
    {"*", "inertial", "", modelled, "mass properties"},
    {"*", "inertial", "pos", modelled, "centre of mass"},
    {"*", "inertial", "mass", modelled, "mass; 0 with zero moments means a body without mass"},
    {"*", "inertial", "diaginertia", modelled, "principal moments"},
    {"*", "inertial", "fullinertia", modelled, "tensor: xx, yy, zz, xy, xz, yz"},
    {"*", "inertial", "quat", modelled, angles},
    {"*", "inertial", "axisangle", modelled, angles},
    {"*", "inertial", "euler", modelled, angles},
    {"*", "inertial", "xyaxes", modelled, angles},
    {"*", "inertial", "zaxis", modelled, angles},
    {"*", "joint", "", modelled, "several joints of one body act in sequence"},
    {"*", "joint", "name", modelled, "the joint's name"},
    {"*", "joint", "class", modelled, "class of <default>"},
    {"*", "joint", "type", modelled, "hinge (default), slide, ball, free"},
    {"*", "joint", "pos", modelled, "a point of the axis, or the centre of a ball joint"},
    {"*", "joint", "axis", modelled, "default: z"},
    {"*", "joint", "stiffness", modelled,
     "linear spring of hinges and slides; all other springs are reported as omitted"},
    {"*", "joint", "damping", modelled,
     "linear damper, also of ball and free joints; nonlinear terms are reported as omitted"},
    {"*", "joint", "ref", modelled, "coordinate of the pose as written; the scene's coordinate is zero there"},
    {"*", "joint", "springref", modelled, "coordinate where the spring is at rest"},
    {"*", "joint", "springdamper", modelled, "time constant and damping ratio, converted by the inertia at the joint"},
    {"*", "joint", "limited", partial, "joint limits", {}, has_limits},
    {"*", "joint", "range", partial, "joint limits", {}, has_limits},
    {"*", "joint", "frictionloss", partial, "joint friction", "0"},
    {"*", "joint", "armature", modelled, "inertia of rotors; of free joints it is reported as omitted"},
    {"*", "joint", "actuatorfrclimited", irrelevant, actuation},
    {"*", "joint", "actuatorfrcrange", irrelevant, actuation},
    {"*", "joint", "actuatorforcelimited", irrelevant, actuation},
    {"*", "joint", "actuatorforcerange", irrelevant, actuation},
    {"*", "joint", "actuatorgravcomp", irrelevant, actuation},
    {"*", "joint", "solreflimit", irrelevant, soft},
    {"*", "joint", "solimplimit", irrelevant, soft},
    {"*", "joint", "solreffriction", irrelevant, soft},
    {"*", "joint", "solimpfriction", irrelevant, soft},
    {"*", "joint", "margin", irrelevant, soft},
    {"*", "joint", "group", irrelevant, looks},
    {"*", "joint", "user", irrelevant, label},
    {"*", "freejoint", "", modelled, "a free body; <default> does not apply"},
    {"*", "freejoint", "name", modelled, "the joint's name"},
    {"*", "freejoint", "group", irrelevant, looks},
    {"*", "freejoint", "align", irrelevant, "moves the frame of a body without damping, not the body"},
    {"*", "geom", "", modelled, "mass of a body"},
    {"*", "geom", "name", irrelevant, label},
    {"*", "geom", "class", modelled, "class of <default>"},
    {"*", "geom", "type", modelled,
     "sphere (default), capsule, cylinder, box, ellipsoid, mesh, sdf, hfield; a plane has no mass"},
    {"*", "geom", "size", modelled, "half sizes"},
    {"*", "geom", "mass", modelled, "mass"},
    {"*", "geom", "density", modelled, "density, default 1000 kg/m^3; for shells in kg/m^2"},
    {"*", "geom", "shellinertia", modelled, "mass on the surface"},
    {"*", "geom", "fromto", modelled, "ends of a capsule, cylinder, box or ellipsoid"},
    {"*", "geom", "pos", modelled, "position"},
    {"*", "geom", "quat", modelled, angles},
    {"*", "geom", "axisangle", modelled, angles},
    {"*", "geom", "euler", modelled, angles},
    {"*", "geom", "xyaxes", modelled, angles},
    {"*", "geom", "zaxis", modelled, angles},
    {"*", "geom", "mesh", modelled, "the mesh, or the mesh that a primitive is fitted to"},
    {"*", "geom", "fitscale", modelled, "scale of a fitted primitive"},
    {"*", "geom", "hfield", modelled, "the height field"},
    {"*", "geom", "group", modelled, "selects geoms for inertiagrouprange"},
    {"*", "geom", "contype", modelled, "whether the body is reported among the contact shapes"},
    {"*", "geom", "conaffinity", modelled, "whether the body is reported among the contact shapes"},
    {"*", "geom", "condim", irrelevant, contact},
    {"*", "geom", "priority", irrelevant, contact},
    {"*", "geom", "friction", irrelevant, contact},
    {"*", "geom", "solmix", irrelevant, contact},
    {"*", "geom", "solref", irrelevant, contact},
    {"*", "geom", "solimp", irrelevant, contact},
    {"*", "geom", "margin", irrelevant, contact},
    {"*", "geom", "gap", irrelevant, contact},
    {"*", "geom", "surfacevel", irrelevant, contact},
    {"*", "geom", "adhesion", irrelevant, contact},
    {"*", "geom", "fluidshape", irrelevant, "affects only fluid forces, which are reported as omitted"},
    {"*", "geom", "fluidcoef", irrelevant, "affects only fluid forces, which are reported as omitted"},
    {"*", "geom", "material", irrelevant, looks},
    {"*", "geom", "rgba", irrelevant, looks},
    {"*", "geom", "user", irrelevant, label},
    {"geom", "plugin", "", irrelevant, contact},
    {"*", "site", "", irrelevant, label},
    {"*", "camera", "", irrelevant, looks},
    {"*", "light", "", irrelevant, looks},
    {"*", "plugin", "", omitted, "plugins of bodies"},
    {"*", "composite", "", omitted, "composite objects"},
    {"*", "flexcomp", "", omitted, "flexible objects", {}, is_soft},
};

}  // namespace

std::span<const RobotConstruct> mjcf_constructs() { return mjcf_rows; }

}  // namespace polhode
