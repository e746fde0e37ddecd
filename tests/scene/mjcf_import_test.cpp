// MJCF import: masses, joints and poses against closed forms and the rules in MuJoCo's documentation; refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "scene/robot_file.h"
#include "scene/robot_parts.h"
#include "scene/scene_file.h"

namespace polhode::mjcf_import_test {
namespace {

constexpr double pi = std::numbers::pi;

// A temporary folder that the destructor removes.
class Folder {
  public:
    Folder() {
        path_ = std::filesystem::path(::testing::TempDir()) /
                ("polhode_mjcf_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)));
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name) << text;
    }
    std::string path() const { return path_.string(); }
    Robot read(const std::string& name) const {
        const RobotFiles files(path_.string(), name);
        return parse_robot(files.text(std::filesystem::path(name).filename().string()), name, {}, files);
    }
    std::string fault(const std::string& name) const {
        try {
            read(name);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

  private:
    std::filesystem::path path_;
};

Robot read(const std::string& text) { return parse_robot(text, "robot.xml"); }
std::string fault(const std::string& text) {
    try {
        read(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string model(const std::string& body_list, const std::string& sections = "") {
    return "<mujoco>" + sections + "<worldbody>" + body_list + "</worldbody></mujoco>";
}
const std::string one_kg = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
std::string hinged(const std::string& name, const std::string& inside) {
    return "<body name='" + name + "'><joint axis='0 1 0'/>" + inside + "</body>";
}

const RobotLink& link_named(const Robot& robot, const std::string& name) {
    for (const RobotLink& link : robot.links)
        if (link.name == name) return link;
    throw std::out_of_range("no link " + name);
}
const RobotJoint& joint_named(const Robot& robot, const std::string& name) {
    for (const RobotJoint& joint : robot.joints)
        if (joint.name == name) return joint;
    throw std::out_of_range("no joint " + name);
}
const RobotJoint& joint_of(const Robot& robot, const std::string& link) {
    for (const RobotJoint& joint : robot.joints)
        if (robot.links[joint.child].name == link) return joint;
    throw std::out_of_range("no joint of " + link);
}
double mass_of(const Robot& robot, const std::string& name) { return double(link_named(robot, name).mass->mass); }
Matrix3<double> tensor_of(const Robot& robot, const std::string& name) {
    return cast<double>(link_named(robot, name).mass->inertia);
}
Vector3<double> center_of(const Robot& robot, const std::string& name) {
    return cast<double>(link_named(robot, name).mass->center);
}
bool is_noted(const RobotNotes& notes, const std::string& heading, const std::string& name) {
    const auto found = notes.find(heading);
    return found != notes.end() && std::find(found->second.begin(), found->second.end(), name) != found->second.end();
}
void expect_near(const Vector3<double>& a, const Vector3<double>& b, double within) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], within) << i;
}
void expect_moments(const Robot& robot, const std::string& name, const Vector3<double>& moments, double within) {
    const Matrix3<double> I = tensor_of(robot, name);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(I[i][j], i == j ? moments[i] : 0, within) << name << i << j;
}

// --- <default> ---------------------------------------------------------------------------------------------------

// r04: <joint type="free"> takes the values of <default>; <freejoint> does not.
TEST(MjcfImport, FreeJointsAreDampedByDefault) {
    const std::string defaults = "<default><joint damping='0.7' armature='0.4' frictionloss='0.2'/></default>";
    const Robot robot = read(model("<body name='a'><joint type='free' name='fa'/>" + one_kg +
                                       "</body><body name='b'><freejoint name='fb'/>" + one_kg + "</body>",
                                   defaults));
    ASSERT_EQ(robot.free_damping.size(), 1u);
    EXPECT_EQ(robot.links[robot.free_damping[0].link].name, "a");
    EXPECT_EQ(robot.free_damping[0].rotational, 0.7);
    EXPECT_EQ(robot.free_damping[0].translational, 0.7);
    EXPECT_EQ(robot.omitted, (RobotNotes{{"armature of free joints", {"fa"}}, {"joint friction", {"fa"}}}));
    EXPECT_EQ(joint_named(robot, "fa").motion, RobotMotion::free);
}

// r05, and nested classes: a class takes the values of the enclosing class at that point of the document.
TEST(MjcfImport, DefaultsMergeAndNest) {
    const Robot two = read(model(hinged("a", "<geom type='box' size='0.1 0.2 0.3'/>"),
                                 "<default><joint damping='0.7'/></default><default><geom density='300'/></default>"));
    EXPECT_EQ(double(joint_of(two, "a").damping[0]), 0.7);
    EXPECT_NEAR(mass_of(two, "a"), 300 * 0.048, 1e-13);
    const std::string classes =
        "<default><joint damping='1'/><default class='k'><joint stiffness='2'/>"
        "<default class='m'><joint damping='3'/></default></default></default>"
        "<default class='other'><joint damping='7'/></default>";
    const Robot nested = read(
        model("<body name='a'><joint class='k'/>" + one_kg + "</body><body name='b' childclass='m'><joint/>" + one_kg +
                  "<body name='c'><joint class='main'/>" + one_kg + "</body><body name='d'><joint class='other'/>" +
                  one_kg + "</body><body name='e'><joint damping='9'/>" + one_kg + "</body></body>",
              classes));
    const auto values = [&](const char* name) {
        const RobotJoint& joint = joint_of(nested, name);
        return std::pair(double(joint.damping[0]), double(joint.stiffness[0]));
    };
    EXPECT_EQ(values("a"), std::pair(1.0, 2.0));
    EXPECT_EQ(values("b"), std::pair(3.0, 2.0));
    EXPECT_EQ(values("c"), std::pair(7.0, 0.0));
    EXPECT_EQ(values("d"), std::pair(7.0, 0.0));
    EXPECT_EQ(values("e"), std::pair(9.0, 2.0));
}

// An alternative orientation in the class overrides the element's quaternion; one in the element overrides both.
TEST(MjcfImport, OrientationsOfClasses) {
    const Robot robot = read(model(hinged("a", "<geom quat='1 1 0 0'/>") + hinged("b", "<geom axisangle='1 0 0 90'/>"),
                                   "<default><geom type='box' size='0.1 0.2 0.3' mass='3' euler='0 0 90'/></default>"));
    // moments of the box about x, y and z: 0.13, 0.1, 0.05
    expect_moments(robot, "a", {0.1, 0.13, 0.05}, 1e-15);
    expect_moments(robot, "b", {0.13, 0.05, 0.1}, 1e-15);
}

// --- files -------------------------------------------------------------------------------------------------------

TEST(MjcfImport, IncludedFilesTakeThePlaceOfTheElement) {
    const Folder folder;
    folder.write("main.xml",
                 "<mujoco>\n<include file='parts/common.xml'/>\n<worldbody><body name='a'>"
                 "<include file='parts/inside.xml'/></body></worldbody></mujoco>");
    folder.write("parts/common.xml", "<mujoco><compiler angle='radian'/>\n<include file='deep.xml'/></mujoco>");
    folder.write("parts/deep.xml", "<x><option gravity='1 2 3'/></x>");  // relative to the including file
    folder.write("parts/inside.xml",
                 "<x><joint name='j' type='slide' axis='0 1 0'/>\n<inertial pos='0 0 0' euler='0 0 1.5707963267948966' "
                 "mass='2' diaginertia='1 2 2.5'/></x>");
    const Robot robot = folder.read("main.xml");
    EXPECT_EQ(robot.gravity_W, Vector3<double>(1, 2, 3));
    EXPECT_EQ(robot.gravity_source, "<option gravity>");
    EXPECT_EQ(joint_named(robot, "j").place, "parts/inside.xml: line 1");
    expect_moments(robot, "a", {2, 1, 2.5}, 1e-15);
    // errors name the included file and its own line numbers
    folder.write("parts/inside.xml", "<x>\n<joint axis='0 0'/></x>");
    EXPECT_EQ(folder.fault("main.xml"), "parts/inside.xml: line 2, <joint>: has 2 numbers in axis; give 3");
    folder.write("parts/inside.xml", "<x><include file='parts/common.xml'/></x>");
    EXPECT_EQ(
        folder.fault("main.xml"),
        "parts/inside.xml: line 1, <include>: includes \"parts/common.xml\" a second time; MuJoCo includes a file "
        "only once: copy it, or attach it as a model");
    folder.write("parts/inside.xml", "<x><include file='main.xml'/></x>");
    EXPECT_NE(folder.fault("main.xml").find("includes \"main.xml\" a second time"), std::string::npos);
    folder.write("parts/inside.xml", "<x><include file='none.xml'/></x>");
    EXPECT_EQ(folder.fault("main.xml").find("parts/inside.xml: line 1, <include>: "), 0u) << folder.fault("main.xml");
    folder.write("other/main.xml", "<mujoco><include file='../parts/common.xml'/></mujoco>");
    const RobotFiles inside(folder.path() + "/other", "main.xml");
    try {
        parse_robot(inside.text("main.xml"), "main.xml", {}, inside);
        ADD_FAILURE() << "read a file outside the folder";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("--allow-outside"), std::string::npos) << error.what();
    }
    EXPECT_EQ(
        fault("<mujoco><include file='a.xml'/></mujoco>"),
        "robot.xml: line 1, <include>: a.xml: is referenced by a robot description given as text; read the description "
        "from a file");
}

TEST(MjcfImport, AttachesModelsWithTheirOwnSettings) {
    const Folder folder;
    folder.write("main.xml",
                 "<mujoco><asset><model name='c' file='arms/child.xml'/></asset><worldbody><frame pos='0 1 0' "
                 "euler='0 0 90'><attach model='c' body='a' prefix='x_'/></frame><body name='h' pos='5 0 0'><joint/>" +
                     one_kg + "<attach model='c' prefix='y_'/><attach body='h2' prefix='z_'/></body><body name='h2'>" +
                     one_kg + "</body></worldbody></mujoco>");
    folder.write("arms/child.xml",
                 "<mujoco><compiler angle='radian' inertiafromgeom='true'/><option gravity='0 0 -1'/><default><joint "
                 "damping='5'/></default><worldbody><body name='p' pos='0 0 7'>" +
                     one_kg + "<body name='a' pos='1 0 0' euler='0 0 1.5'><joint name='j'/>" + one_kg +
                     "<geom type='box' size='0.1 0.2 0.3'/></body></body></worldbody></mujoco>");
    const Robot robot = folder.read("main.xml");
    EXPECT_EQ(*robot.gravity_W, Vector3<double>(0, 0, -9.81));  // the options of the parent model apply
    EXPECT_NEAR(mass_of(robot, "x_a"), 48, 1e-13);              // the inertiafromgeom of the attached model applies
    const RobotJoint& x = joint_named(robot, "x_j");
    EXPECT_EQ(double(x.damping[0]), 5);
    expect_near(cast<double>(x.placement.position), {0, 2, 0}, 1e-15);
    EXPECT_NEAR(double(x.placement.turn.w), std::cos((pi / 2 + 1.5) / 2), 1e-15);
    EXPECT_EQ(robot.links[joint_of(robot, "y_p").parent].name, "h");
    EXPECT_EQ(robot.links[joint_named(robot, "y_j").parent].name, "y_p");
    EXPECT_EQ(mass_of(robot, "z_h2"), 1);
    EXPECT_EQ(joint_named(robot, "y_j").place, "arms/child.xml: line 1");
    // a model named by its root element; a model that attaches itself
    folder.write("main.xml",
                 "<mujoco><asset><model file='child.xml'/></asset><worldbody><attach model='kid' prefix='k'/>"
                 "</worldbody></mujoco>");
    folder.write("child.xml",
                 "<mujoco model='kid'><worldbody><body name='b'>" + one_kg + "</body></worldbody></mujoco>");
    EXPECT_EQ(mass_of(folder.read("main.xml"), "kb"), 1);
    folder.write(
        "child.xml",
        "<mujoco model='kid'><asset><model name='me' file='child.xml'/></asset><worldbody><body name='b'><joint "
        "/>" +
            one_kg + "<attach model='me' prefix='_'/></body></worldbody></mujoco>");
    EXPECT_NE(folder.fault("main.xml").find("is nested more than 300 bodies and frames deep"), std::string::npos)
        << folder.fault("main.xml");
    folder.write("child.xml", "<robot name='r'/>");
    EXPECT_NE(folder.fault("main.xml").find("attach only MJCF files (<mujoco>)"), std::string::npos);
    EXPECT_NE(fault(model("<attach model='q' prefix=''/>"))
                  .find("attaches the model \"q\", which no <asset><model> "
                        "defines"),
              std::string::npos);
}

// --- frames and copies -------------------------------------------------------------------------------------------

TEST(MjcfImport, FramesMoveWhatIsInside) {
    const Robot robot = read(model(
        "<frame pos='1 2 3' euler='0 0 90' childclass='q'><body name='a' pos='1 0 0'><joint name='j0' pos='0.1 0 0'/>" +
            std::string("<geom type='box' size='0.1 0.2 0.3' mass='3'/><frame pos='0 0 1' euler='90 0 0'><joint "
                        "name='j' pos='0.1 0 0' axis='0 1 0'/><geom size='0.5' pos='0 2 0' mass='1'/></frame></body>"
                        "</frame><body name='c'><joint/><frame pos='1 0 0' euler='0 0 90'><inertial pos='0 1 0' "
                        "mass='1' diaginertia='1 2 2.5'/></frame></body>"),
        "<default><default class='q'><joint damping='3'/></default></default>"));
    const RobotJoint &j0 = joint_named(robot, "j0"), &j = joint_named(robot, "j");
    expect_near(cast<double>(j0.placement.position), {1, 3, 3}, 1e-15);
    EXPECT_EQ(double(j0.damping[0]), 3);
    EXPECT_EQ(double(j.damping[0]), 3);
    expect_near(cast<double>(j.point), {0.1, 0, 1}, 1e-15);
    expect_near(cast<double>(j.axes[0]), {0, 0, 1}, 1e-15);
    expect_near(center_of(robot, "a"), {0, 0, 3. / 4}, 1e-15);  // the sphere is at (0, 0, 3)
    expect_near(center_of(robot, "c"), {0, 0, 0}, 1e-15);
    expect_moments(robot, "c", {2, 1, 2.5}, 1e-15);
}

// Copy i is at R(0) d + .. + R((i - 1) a) d, rotated by R(i a); names get the number of the copy.
TEST(MjcfImport, ReplicatesBodies) {
    const Robot robot =
        read(model("<replicate count='11' offset='0 0.5 0' euler='0 0 30' sep='_'><body name='a' "
                   "pos='1 0 0'><joint name='j'/>" +
                   one_kg + "<replicate count='2' offset='0 0 1'><body name='q'><joint name='k'/>" + one_kg +
                   "</body></replicate></body></replicate>"));
    EXPECT_EQ(robot.links.size(), 33u);
    const double a = pi / 6;
    for (int i = 0; i < 11; ++i) {
        const std::string number = (i < 10 ? "_0" : "_") + std::to_string(i);
        Vector3<double> there(std::cos(i * a), std::sin(i * a), 0);
        for (int k = 0; k < i; ++k) there = there + Vector3<double>(-0.5 * std::sin(k * a), 0.5 * std::cos(k * a), 0);
        expect_near(cast<double>(joint_named(robot, "j" + number).placement.position), there, 1e-14);
        EXPECT_EQ(robot.links[joint_named(robot, "k1" + number).child].name, "q1" + number);
        expect_near(cast<double>(joint_named(robot, "k1" + number).placement.position), {0, 0, 1}, 1e-15);
    }
    EXPECT_EQ(read(model("<replicate count='0'><body/></replicate>" + hinged("a", one_kg))).links.size(), 1u);
    for (const char* count : {"-1", "1.5", "2000000"})
        EXPECT_NE(fault(model("<replicate count='" + std::string(count) + "'/>")).find("has the count"),
                  std::string::npos);
    const std::string bomb =
        "<replicate count='1000'><replicate count='1000'><replicate count='1000'><body/></replicate>"
        "</replicate></replicate>";
    EXPECT_NE(fault(model(bomb)).find("makes the robot exceed"), std::string::npos);
}

// --- masses ------------------------------------------------------------------------------------------------------

TEST(MjcfImport, InertialsInEachForm) {
    const auto tensor = [](const std::string& attributes) {
        return tensor_of(read(model(hinged("a", "<inertial pos='0 0 0' mass='1' " + attributes + "/>"))), "a");
    };
    const double c = std::cos(0.3), s = std::sin(0.3);
    const Matrix3<double> turned = [&] {
        Matrix3<double> m;  // diag(1, 2, 2.5) rotated about z
        m[0] = {c * c + 2 * s * s, -s * c, 0}, m[1] = {-s * c, s * s + 2 * c * c, 0}, m[2] = {0, 0, 2.5};
        return m;
    }();
    const std::string degrees = std::to_string(0.3 * 180 / pi);
    char text[200];
    std::snprintf(text, sizeof text, "%.17g", 0.3 * 180 / pi);
    const std::string d = "diaginertia='1 2 2.5' ";
    const std::string angle(text);
    std::snprintf(text, sizeof text, "xyaxes='%.17g %.17g 0 -0.5 3 0'", c, s);
    const std::string axes(text);
    std::snprintf(text, sizeof text, "quat='%.17g 0 0 %.17g'", 2 * std::cos(0.15), 2 * std::sin(0.15));
    for (const std::string& way :
         {"euler='0 0 " + angle + "'", "axisangle='0 0 5 " + angle + "'", axes, std::string(text)}) {
        const Matrix3<double> I = tensor(d + way);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(I[i][j], turned[i][j], 1e-15) << way;
    }
    // z to x: a quarter rotation about y
    const Matrix3<double> I = tensor(d + "zaxis='7 0 0'");
    expect_near({I[0][0], I[1][1], I[2][2]}, {2.5, 2, 1}, 1e-15);
    const Matrix3<double> full = tensor("fullinertia='1 2 2.5 0.1 0.2 0.3'");
    EXPECT_EQ(full[0][1], 0.1);
    EXPECT_EQ(full[2][0], 0.2);
    EXPECT_EQ(full[1][2], 0.3);
    const std::string bad =
        model(hinged("a", "<inertial pos='0 0 0' mass='1' fullinertia='1 1 1 0 0 0' euler='0 0 1'/>"));
    EXPECT_NE(fault(bad).find("has both fullinertia and euler"), std::string::npos);
    EXPECT_NE(fault(model(hinged("a", "<inertial mass='1'/>"))).find("has no \"pos\""), std::string::npos);
    EXPECT_FALSE(link_named(read(model(hinged("a", one_kg + "<body name='b'><inertial pos='0 0 0' mass='0' diaginertia="
                                                            "'0 0 0'/></body>"))),
                            "b")
                     .mass);
}

TEST(MjcfImport, MassesOfGeomsOrInertials) {
    const std::string geom = "<geom type='box' size='0.1 0.2 0.3' mass='3' group='1'/><geom size='0.1' mass='2'/>";
    const auto mass = [&](const std::string& compiler, const std::string& inside) {
        const Robot robot = read(model(hinged("a", inside), "<compiler " + compiler + "/>"));
        const auto& found = link_named(robot, "a").mass;
        return found ? double(found->mass) : 0.0;
    };
    EXPECT_EQ(mass("", geom), 5);
    EXPECT_EQ(mass("", geom + one_kg), 1);
    EXPECT_EQ(mass("inertiafromgeom='true'", geom + one_kg), 5);  // r33
    EXPECT_EQ(mass("inertiafromgeom='true'", one_kg), 1);         // no geom has mass
    EXPECT_EQ(mass("inertiafromgeom='false'", geom), 0);
    EXPECT_EQ(mass("inertiagrouprange='1 2'", geom), 3);
    EXPECT_EQ(mass("inertiagrouprange='1 2' inertiafromgeom='true'", one_kg + "<geom size='1'/>"), 1);
    EXPECT_NEAR(mass("", "<geom type='box' size='0.1 0.2 0.3' density='10' mass='7'/>"), 7, 1e-15);
    EXPECT_EQ(mass("", "<geom type='plane' size='1 1 1' mass='7'/>"), 0);
    EXPECT_NEAR(mass("", "<geom type='box' fromto='0 0 0 3 4 0' size='0.1'/>"), 1000 * 0.04 * 5, 1e-12);
    EXPECT_NEAR(mass("", "<geom type='ellipsoid' fromto='0 0 0 0 2 0' size='0.1'/>"), 4000 * pi / 3 * 0.01, 1e-12);
    EXPECT_NEAR(mass("discardvisual='true'", geom + "<geom size='1' mass='4' contype='0' conaffinity='0'/>"), 9, 1e-15);
    const std::string field = "<asset><hfield name='h' nrow='2' ncol='2' size='1 2 0.5 0.1'/></asset>";
    const Robot robot = read(model(hinged("a", "<geom type='hfield' hfield='h'/>"), field));
    EXPECT_NEAR(mass_of(robot, "a"), 8000 * 2 * (0.125 + 0.05), 1e-10);
    EXPECT_TRUE(is_noted(robot.assumed, "shapes with MuJoCo's default density of 1000 kg/m^3", "a"));
}

TEST(MjcfImport, BoundsAndTotalMass) {
    const Robot bound =
        read(model(hinged("a", "<inertial pos='0 0 0' quat='1 1 0 0' mass='1' diaginertia='0.01 0.02 0.5'/>") +
                       "<body name='e' pos='0 0 7'><joint/></body>" +
                       hinged("f", "<inertial pos='0 0 0' euler='0 0 30' mass='3' diaginertia='0.01 0.3 0.3'/>"),
                   "<compiler boundmass='2' boundinertia='0.02' balanceinertia='true'/>"));
    EXPECT_EQ(mass_of(bound, "a"), 2);
    expect_moments(bound, "a", {0.18, 0.18, 0.18}, 1e-15);
    EXPECT_EQ(mass_of(bound, "e"), 2);
    expect_near(center_of(bound, "e"), {0, 0, 7}, 0);
    EXPECT_EQ(mass_of(bound, "f"), 3);
    EXPECT_NEAR(tensor_of(bound, "f")[0][0], 0.02 * 0.75 + 0.3 * 0.25, 1e-15);
    EXPECT_TRUE(is_noted(bound.assumed, "inertia tensors balanced by balanceinertia", "a"));
    EXPECT_TRUE(is_noted(bound.assumed, "bodies raised to boundmass or boundinertia", "f"));

    const std::string body_list =
        "<body name='s'><geom type='box' size='0.1 0.2 0.3' mass='4'/></body>" +
        hinged("a", "<geom type='box' size='0.1 0.2 0.3' mass='6'/><body name='w'>" + one_kg + "</body>");
    const Robot total = read(model(body_list, "<compiler settotalmass='22'/>"));
    EXPECT_NEAR(mass_of(total, "a"), 12, 1e-14);
    EXPECT_NEAR(mass_of(total, "w"), 2, 1e-15);
    EXPECT_NEAR(tensor_of(total, "a")[0][0], 12. / 3 * 0.13, 1e-15);
    // fusestatic removes "s" first
    const Robot fused = read(model(body_list, "<compiler settotalmass='14' fusestatic='true'/>"));
    EXPECT_NEAR(mass_of(fused, "a"), 12, 1e-14);
}

// Surface integrals of the sphere, box, cylinder and capsule.
TEST(MjcfImport, ShellsOfPrimitives) {
    const auto shell = [](const std::string& geom) {
        return read(model(hinged("a", "<geom shellinertia='true' " + geom + "/>")));
    };
    const Robot sphere = shell("size='0.1'");
    EXPECT_NEAR(mass_of(sphere, "a"), 1000 * 4 * pi * 0.01, 1e-12);
    const double m = mass_of(sphere, "a");
    expect_moments(sphere, "a", {2. / 3 * m * 0.01, 2. / 3 * m * 0.01, 2. / 3 * m * 0.01}, 1e-14);
    // a cube with half side a: <x^2> = (2 a^2 + 4 a^2 / 3) / 6
    const Robot cube = shell("type='box' size='0.3 0.3 0.3' mass='6'");
    const double cube_moment = 6 * 2 * (0.09 * 10 / 18.);
    expect_moments(cube, "a", {cube_moment, cube_moment, cube_moment}, 1e-15);
    const Robot box = shell("type='box' size='0.1 0.2 0.3'");
    EXPECT_NEAR(mass_of(box, "a"), 8000 * (0.02 + 0.06 + 0.03), 1e-11);
    // a tube of area 2 pi r 2h and two discs
    const double r = 0.1, h = 0.2, side = 4 * pi * r * h, discs = 2 * pi * r * r;
    const Robot tin = shell("type='cylinder' size='0.1 0.2' density='10'");
    EXPECT_NEAR(mass_of(tin, "a"), 10 * (side + discs), 1e-13);
    EXPECT_NEAR(tensor_of(tin, "a")[2][2], 10 * (side * r * r + discs * r * r / 2), 1e-15);
    EXPECT_NEAR(tensor_of(tin, "a")[0][0], 10 * (side * (r * r / 2 + h * h / 3) + discs * (r * r / 4 + h * h)), 1e-15);
    const double balls = 4 * pi * r * r;
    const Robot pill = shell("type='capsule' size='0.1 0.2' density='10'");
    EXPECT_NEAR(mass_of(pill, "a"), 10 * (side + balls), 1e-13);
    EXPECT_NEAR(tensor_of(pill, "a")[2][2], 10 * (side * r * r + balls * 2 * r * r / 3), 1e-15);
    EXPECT_NEAR(tensor_of(pill, "a")[0][0],
                10 * (side * (r * r / 2 + h * h / 3) + balls * (2 * r * r / 3 + h * h + h * r)), 1e-14);
    const Robot egg = shell("type='ellipsoid' size='0.1 0.1 0.1' mass='3'");
    EXPECT_NEAR(tensor_of(egg, "a")[0][0], 2. / 3 * 3 * 0.01, 1e-6);
    EXPECT_TRUE(is_noted(egg.assumed, "ellipsoid shells, computed by MuJoCo's approximations", "a"));
}

// A tetrahedron with corners 0, a e1, b e2 and c e3: V = abc/6, centre at a quarter of each edge, <x^2> = 3 a^2 / 80.
const std::string corner = "vertex='0 0 0 2 0 0 0 1 0 0 0 3' face='0 2 1 0 1 3 1 2 3 0 3 2'";

TEST(MjcfImport, MeshesByExactIntegrals) {
    const auto body = [](const std::string& mesh, const std::string& geom) {
        return read(model(hinged("a", "<geom type='mesh' mesh='m' " + geom + "/>"),
                          "<asset><mesh name='m' " + mesh + "/></asset>"));
    };
    const Robot plain = body(corner, "density='10'");
    EXPECT_NEAR(mass_of(plain, "a"), 10, 1e-14);
    expect_near(center_of(plain, "a"), {0.5, 0.25, 0.75}, 1e-15);
    EXPECT_NEAR(tensor_of(plain, "a")[0][0], 10 * (3 + 27) / 80., 1e-14);
    EXPECT_NEAR(tensor_of(plain, "a")[0][1], 10 * 2 / 80., 1e-15);  // <xy> = -ab/80
    // x' = scale R^T (x - refpos): refquat rotates by a quarter about z, so R^T maps to (y, -x)
    const Robot moved = body(corner + " refpos='1 0 0' refquat='1 0 0 1' scale='2 -3 1'", "mass='4' pos='0 0 1'");
    EXPECT_NEAR(mass_of(moved, "a"), 4, 1e-15);
    expect_near(center_of(moved, "a"), {0.5, -3 * 0.5, 1.75}, 1e-14);
    EXPECT_NEAR(tensor_of(moved, "a")[2][2], 4 * 3 / 80. * (4 * 1 + 9 * 4), 1e-14);
    // faces of the convex hull, with a vertex inside it
    const Robot hull = body("vertex='0 0 0 2 0 0 0 1 0 0 0 3 0.1 0.1 0.1'", "density='10'");
    EXPECT_NEAR(mass_of(hull, "a"), 10, 1e-14);
    const Robot cube = body("vertex='0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1 0.5 0.5 0 0.5 0 0 1 0.25 1'", "");
    EXPECT_NEAR(mass_of(cube, "a"), 1000, 1e-11);
    // the surface of a cube
    const std::string shell = "vertex='0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1' inertia='shell'";
    EXPECT_NEAR(mass_of(body(shell, ""), "a"), 6000, 1e-10);
    EXPECT_NEAR(tensor_of(body(shell, "mass='6'"), "a")[1][1], 6 * 2 * (0.25 * 10 / 18.), 1e-14);
    // MuJoCo adds absolute volumes, which counts a dent twice
    const std::string dented =
        "vertex='0 0 0 2 0 0 0 2 0 0 0 2 0.1 0.1 0.1' face='0 2 1 0 1 3 0 3 2 1 2 4 2 3 4 3 1 4'";
    const Robot dent = body(dented, "density='1'");
    EXPECT_NEAR(mass_of(dent, "a"), 8 / 6. * 0.15, 1e-14);
    EXPECT_EQ(dent.assumed.count("meshes computed by their exact volume, where MuJoCo's rule \"legacy\" gives more"),
              1u);
    EXPECT_EQ(body(dented + " inertia='exact'", "density='1'")
                  .assumed.count("meshes computed by their exact volume, where MuJoCo's rule \"legacy\" gives more"),
              0u);
    EXPECT_NEAR(mass_of(body(dented + " inertia='convex'", "density='1'"), "a"), 8 / 6., 1e-14);
}

// A box fitted to the mesh of a box has the same mass properties; fitscale 0.5 leaves an eighth of the mass.
TEST(MjcfImport, PrimitivesFittedToMeshes) {
    const std::string asset =
        "<asset><mesh name='m' vertex='0 0 0 2 0 0 0 1 0 2 1 0 0 0 4 2 0 4 0 1 4 2 1 4'/></asset>";
    const Robot robot = read(model(hinged("a", "<geom type='box' mesh='m' density='1'/>") +
                                       hinged("b", "<geom type='box' mesh='m' density='1' fitscale='0.5'/>") +
                                       hinged("c", "<geom type='cylinder' mesh='m' density='1'/>") +
                                       hinged("d", "<geom mesh='m' density='1'/>") +
                                       hinged("e", "<geom type='capsule' mesh='m' density='1'/>"),
                                   asset));
    EXPECT_NEAR(mass_of(robot, "a"), 8, 1e-14);
    expect_near(center_of(robot, "a"), {1, 0.5, 2}, 1e-15);
    expect_moments(robot, "a", {8 / 12. * 17, 8 / 12. * 20, 8 / 12. * 5}, 1e-13);
    EXPECT_NEAR(mass_of(robot, "b"), 1, 1e-15);
    const double radius = 0.75;  // the mean of the half sizes 0.5 and 1
    EXPECT_NEAR(mass_of(robot, "c"), pi * radius * radius * 4, 1e-13);
    EXPECT_NEAR(mass_of(robot, "d"), 4 * pi / 3 * std::pow(3.5 / 3, 3), 1e-13);
    EXPECT_NEAR(mass_of(robot, "e"), pi * radius * radius * (2 * (2 - radius / 2) + 4 * radius / 3), 1e-13);
}

TEST(MjcfImport, MeshesFromFiles) {
    const Folder folder;
    const std::string obj = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    folder.write("assets/corner.obj", obj);
    const std::string body = "<body name='a'><joint/><geom type='mesh' mesh='corner' density='10'/></body>";
    for (const char* where : {"meshdir='assets'", "assetdir='assets/'", "meshdir='assets' strippath='true'"}) {
        const bool strips = std::string(where).find("strip") != std::string::npos;
        folder.write("main.xml", model(body, "<compiler " + std::string(where) + "/><asset><mesh file='" +
                                                 (strips ? "some\\where/" : "") + "corner.obj'/></asset>"));
        EXPECT_NEAR(mass_of(folder.read("main.xml"), "a"), 10, 1e-14) << where;
    }
    const std::string missing = "<asset><mesh name='corner' file='none.obj'/></asset>";
    folder.write("main.xml", model(body, missing));
    EXPECT_EQ(folder.fault("main.xml").find("main.xml: line 1, <mesh>: "), 0u) << folder.fault("main.xml");
    // static bodies and bodies with <inertial> need no mesh
    folder.write("main.xml", model("<body name='s'><geom type='mesh' mesh='corner'/></body>" +
                                       hinged("a", one_kg + "<geom type='mesh' mesh='corner'/>"),
                                   missing));
    const Robot robot = folder.read("main.xml");
    EXPECT_EQ(mass_of(robot, "a"), 1);
    EXPECT_TRUE(
        is_noted(robot.assumed, "fixed bodies whose mass cannot be computed, treated as bodies without mass", "s"));
}

// --- joints ------------------------------------------------------------------------------------------------------

// The written pose is at ref; the scene's coordinate is 0 there.
TEST(MjcfImport, SpringsRestAtSpringrefLessRef) {
    const Robot robot = read(
        model("<body name='a'><joint name='h' ref='30' springref='90' stiffness='2' damping='3'/>" + one_kg +
              "<body name='b'><joint name='s' type='slide' ref='0.3' stiffness='5'/>" + one_kg + "</body></body>"));
    EXPECT_NEAR(double(joint_named(robot, "h").rest[0]), pi / 3, 1e-15);
    EXPECT_EQ(double(joint_named(robot, "h").stiffness[0]), 2);
    EXPECT_EQ(double(joint_named(robot, "h").damping[0]), 3);
    EXPECT_EQ(double(joint_named(robot, "s").rest[0]), -0.3);
    const std::string passive = model("<body name='a'><joint stiffness='2' damping='3'/>" + one_kg + "</body>",
                                      "<option><flag FLAG='disable'/></option>");
    const auto forces = [&](const std::string& flag) {
        std::string text = passive;
        text.replace(text.find("FLAG"), 4, flag);
        const Robot one = read(text);
        return std::pair(double(one.joints[0].stiffness[0]), double(one.joints[0].damping[0]));
    };
    EXPECT_EQ(forces("spring"), std::pair(0.0, 3.0));
    EXPECT_EQ(forces("damper"), std::pair(2.0, 0.0));
    EXPECT_EQ(forces("passive"), std::pair(0.0, 0.0));
    EXPECT_EQ(forces("limit"), std::pair(2.0, 3.0));
    const Robot cubic = read(model("<body><joint name='c' stiffness='2 1' damping='3 0 1'/>" + one_kg + "</body>"));
    EXPECT_TRUE(is_noted(cubic.omitted, "nonlinear terms of joint springs and dampers", "c"));
}

// stiffness = I / (T z)^2 and damping = 2 I / T, with 1 / I the inverse inertia at the joint, armature included.
TEST(MjcfImport, SpringdamperByTheInertiaAtTheJoint) {
    const Robot one =
        read(model("<body name='a'><joint name='h' axis='0 1 0' springdamper='0.5 0.8' armature='0.03'/>"
                   "<inertial pos='1 0 0' mass='3' diaginertia='1 0.5 1'/></body>"
                   "<body name='f'><joint name='f' type='free' springdamper='0.5 1'/><inertial pos='0 0 0' mass='4' "
                   "diaginertia='1 0.5 0.8'/></body>"));
    const double inertia = 3 + 0.5 + 0.03;
    EXPECT_NEAR(double(joint_named(one, "h").stiffness[0]), inertia / 0.16, 1e-13);
    EXPECT_NEAR(double(joint_named(one, "h").damping[0]), 2 * inertia / 0.5, 1e-13);
    // the mean of the inverses of 4, 4, 4, 1, 0.5 and 0.8
    const double mean = 6 / (0.75 + 1 + 2 + 1.25);
    ASSERT_EQ(one.free_damping.size(), 1u);
    EXPECT_NEAR(one.free_damping[0].rotational, 2 * mean / 0.5, 1e-14);
    EXPECT_TRUE(is_noted(one.omitted, "springs of free joints", "f"));
    // a straight double pendulum of point masses: M = [[m1 l^2 + m2 (l + l)^2, 2 m2 l^2], [2 m2 l^2, m2 l^2]]
    const std::string bob = "<inertial pos='0 0 -1' mass='1' diaginertia='0 0 0'/>";
    const Robot two = read(model("<body name='a'><joint name='j1' axis='0 1 0' springdamper='1 1'/>" + bob +
                                 "<body name='b' pos='0 0 -1'><joint name='j2' axis='0 1 0' springdamper='1 1'/>" +
                                 bob + "</body></body>"));
    // M = [[5, 2], [2, 1]] with determinant 1: the diagonal of the inverse is 1, 5
    EXPECT_NEAR(double(joint_named(two, "j1").stiffness[0]), 1, 1e-15);
    EXPECT_NEAR(double(joint_named(two, "j2").stiffness[0]), 1 / 5., 1e-15);
    EXPECT_NE(fault(model("<body><joint springdamper='1 0'/>" + one_kg + "</body>")).find("that is not positive"),
              std::string::npos);
    EXPECT_NE(fault(model("<body><joint springdamper='1 1'/><body><joint/></body></body>")).find("is singular"),
              std::string::npos);
}

TEST(MjcfImport, LimitsByLimitedAndAutolimits) {
    const auto limits = [](const std::string& joint, const std::string& sections = "") {
        return read(model("<body name='b'><joint name='j' " + joint + "/>" + one_kg + "</body>", sections))
                   .omitted.count("joint limits") > 0;
    };
    EXPECT_TRUE(limits("range='-1 1'"));
    EXPECT_TRUE(limits("range='-1 1' limited='true'"));
    EXPECT_FALSE(limits("range='-1 1' limited='false'"));
    EXPECT_FALSE(limits("range='0 0'"));
    EXPECT_FALSE(limits("type='free' range='-1 1'"));
    EXPECT_FALSE(limits("range='-1 1'", "<compiler autolimits='false'/>"));
    EXPECT_TRUE(limits("range='-1 1' limited='true'", "<compiler autolimits='false'/>"));
}

// Several joints on one body become massless links in its frame.
TEST(MjcfImport, SeveralJointsOfOneBody) {
    const Robot robot =
        read(model("<body name='a' pos='1 0 0'><joint name='x' type='slide' axis='1 0 0'/><joint "
                   "name='z' type='slide' axis='0 0 1'/><joint name='r' axis='0 1 0' pos='0 0 1'/>" +
                   one_kg + "</body>"));
    ASSERT_EQ(robot.links.size(), 3u);
    EXPECT_EQ(robot.links[0].name, "a (joint 1)");
    EXPECT_FALSE(robot.links[0].mass || robot.links[1].mass);
    EXPECT_EQ(joint_named(robot, "x").parent, RobotJoint::world);
    expect_near(cast<double>(joint_named(robot, "x").placement.position), {1, 0, 0}, 0);
    EXPECT_EQ(joint_named(robot, "z").parent, 0u);
    EXPECT_EQ(joint_named(robot, "r").parent, 1u);
    expect_near(cast<double>(joint_named(robot, "r").placement.position), {0, 0, 0}, 0);
    EXPECT_EQ(robot.links[joint_named(robot, "r").child].name, "a");
}

TEST(MjcfImport, BodiesWithoutJointsAndMocapBodies) {
    const Robot robot =
        read(model("<body name='m' mocap='true' pos='1 2 3'>" + one_kg + "<body name='w' pos='0 1 0'>" + one_kg +
                   "</body></body><body name='s' pos='4 0 0'>" + one_kg + "</body>" + hinged("a", one_kg)));
    EXPECT_EQ(joint_of(robot, "m").motion, RobotMotion::fixed);
    EXPECT_EQ(joint_of(robot, "m").parent, RobotJoint::world);
    expect_near(cast<double>(joint_of(robot, "m").placement.position), {1, 2, 3}, 0);
    EXPECT_EQ(joint_of(robot, "w").motion, RobotMotion::fixed);
    EXPECT_TRUE(is_noted(robot.assumed, "mocap bodies, fixed in place", "m"));
    EXPECT_NE(fault(model("<body mocap='true'><joint/></body>")).find("is a mocap body with joints"),
              std::string::npos);
    EXPECT_NE(fault(model("<body><body mocap='true'/></body>")).find("inside another body"), std::string::npos);
    // with alignfree the damping of a free body acts at its centre of mass
    const Robot aligned =
        read(model("<body name='a' pos='1 0 0'><joint type='free' damping='3'/><geom size='0.1' pos="
                   "'0 1 0'/></body>",
                   "<compiler alignfree='true'/>"));
    expect_near(center_of(aligned, "a"), {0, 0, 0}, 0);
    expect_near(cast<double>(joint_of(aligned, "a").placement.position), {1, 1, 0}, 0);
}

// r06: generated names differ from all given ones, including later ones.
TEST(MjcfImport, GeneratedNamesCollideWithNothing) {
    const Robot robot = read(model("<body name='arm'><joint/>" + one_kg + "<body><joint name='arm_joint'/>" + one_kg +
                                   "</body><body name='body1'><joint/>" + one_kg + "</body></body>"));
    std::set<std::string> links, joints;
    for (const RobotLink& link : robot.links) links.insert(link.name);
    for (const RobotJoint& joint : robot.joints) joints.insert(joint.name);
    EXPECT_EQ(links.size(), 3u);
    EXPECT_EQ(joints.size(), 3u);
    EXPECT_EQ(robot.links[joint_named(robot, "arm_joint").child].name, "body1_");
    EXPECT_EQ(robot.links[joint_named(robot, "arm_joint_").child].name, "arm");
    EXPECT_TRUE(is_noted(robot.assumed, "generated names of bodies", "body1_"));
}

TEST(MjcfImport, Gravity) {
    const auto gravity = [](const std::string& sections) {
        const Robot robot = read(model(hinged("a", one_kg), sections));
        return std::pair(*robot.gravity_W, robot.gravity_source);
    };
    EXPECT_EQ(gravity(""), std::pair(Vector3<double>(0, 0, -9.81), std::string("MuJoCo's default")));
    EXPECT_EQ(gravity("<option gravity='1 2 3'/><option timestep='1'/>"),
              std::pair(Vector3<double>(1, 2, 3), std::string("<option gravity>")));
    EXPECT_EQ(gravity("<option gravity='1 2 3'><flag gravity='disable'/></option>"),
              std::pair(Vector3<double>(0, 0, 0), std::string("<flag gravity=\"disable\">")));
    Scene scene;
    scene.name = "robot", scene.duration = 1;
    add_robot(read(model(hinged("a", one_kg), "<option><flag gravity='disable'/></option>")), {}, "robot.xml", scene);
    validate(scene, "robot.xml");
}

// --- one link as a body ------------------------------------------------------------------------------------------

TEST(MjcfImport, OneBodyFollowsTheSameRules) {
    const auto mass = [](const std::string& text, const std::string& body) {
        const BodyDefinition made = parse_robot_body(text, "robot.xml", body, false, {});
        return std::visit(
            [](const auto& one) -> std::pair<std::string, double> {
                using T = std::decay_t<decltype(one)>;
                if constexpr (std::is_same_v<T, ImportedBody>) return {"given", one.mass};
                if constexpr (std::is_same_v<T, NumericBody>) return {"computed", one.mass};
                return {"", 0};
            },
            made);
    };
    using Result = std::pair<std::string, double>;
    const std::string both = hinged("arm",
                                    "<inertial pos='0 0 0' mass='5' diaginertia='1 1 1'/><geom type='box' "
                                    "size='0.03 0.04 0.2' mass='2'/>");
    EXPECT_EQ(mass(model(both), "arm"), Result("given", 5));
    EXPECT_EQ(mass(model(both, "<compiler inertiafromgeom='true'/>"), "arm"), Result("computed", 2));
    EXPECT_EQ(mass(model(both, "<compiler settotalmass='8'/>"), "arm"), Result("computed", 8));
    EXPECT_EQ(mass(model(both, "<compiler boundmass='6'/>"), "arm"), Result("computed", 6));
    EXPECT_EQ(mass(model("<replicate count='2'>" + both + "</replicate>"), "arm1"), Result("computed", 5));
    EXPECT_EQ(mass(model("<frame pos='1 0 0'>" + both + "</frame>"), "arm"), Result("given", 5));
    EXPECT_EQ(mass(model(hinged("a", "<inertial pos='0 0 0' mass='5' diaginertia='1 1 1' zaxis='1 0 0'/>")), "a"),
              Result("computed", 5));
    EXPECT_THROW(mass(model("<body name='a'><joint/></body>"), "a"), InputError);
    EXPECT_THROW(mass(model(both), "b"), InputError);
}

// --- refusals ----------------------------------------------------------------------------------------------------

TEST(MjcfImport, RefusalsNameThePlaceAndTheRemedy) {
    const std::string mesh = "<asset><mesh name='m' " + corner + "/></asset>";
    const auto geom = [](const std::string& attributes) { return hinged("a", "<geom " + attributes + "/>"); };
    const std::pair<std::string, const char*> faults[] = {
        {model("", "<compiler coordinate='global'/>"), "has global coordinates"},
        {model("", "<compiler angle='turns'/>"), "has \"turns\" in angle; give one of radian, degree"},
        {model("", "<compiler eulerseq='xyw'/>"), "has the eulerseq \"xyw\""},
        {model("<joint/>"), "is a joint of the world"},
        {model(one_kg), "is an <inertial> of the world"},
        {model(hinged("a", one_kg + one_kg)), "is a second <inertial> of one body"},
        {model("<body><composite prefix='p'/></body>"),
         "generates bodies by <composite> \"p\", which is not supported"},
        {model("<flexcomp name='f'/>"), "generates bodies by <flexcomp> \"f\", which is not supported"},
        {model(geom("type='cone' size='1 1'")), "has the type \"cone\""},
        {model(geom("type='capsule' fromto='0 0 0 0 0 0' size='1'")), "has a vector of length zero in fromto"},
        {model(geom("type='sphere' fromto='0 0 0 0 0 1' size='1'")), "is a sphere and has fromto"},
        {model(geom("type='box' fromto='0 0 0 0 0 1' size='1' pos='1 0 0'")), "has both pos and fromto"},
        {model(geom("size='-1'")), "has no volume"},
        {model(geom("size='1' density='-1'")), "has a negative mass or density"},
        {model(geom("type='mesh' mesh='q'")), "has the mesh \"q\", which no <asset> defines"},
        {model(geom("type='cylinder' mesh='m'"), mesh + "<compiler fitaabb='true'/>"), "bounding box of a mesh"},
        {model(geom("type='mesh' mesh='m'"), "<asset><mesh name='m' builtin='cone' params='1 1'/></asset>"),
         "generates the mesh \"m\""},
        {model(geom("type='mesh' mesh='m'"), "<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 1 1 0'/></asset>"),
         "convex hull that cannot be computed"},
        {model(geom("type='mesh' mesh='m'"),
               "<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2 0 1 7 0 0 0 0 0 0'/></asset>"),
         "has the index 7 in face"},
        {model("", "<asset><mesh name='m'/><mesh name='m'/></asset>"), "is a second mesh \"m\""},
        {model("", "<default><default/></default>"), "has no \"class\""},
        {model("", "<default><default class='a'/><default class='a'/></default>"), "is a second class \"a\""},
        {model("<body><joint type='free'/><joint/></body>"), "is a free joint of the body \"body1\""},
        {model(hinged("a", "<body name='b'><freejoint/>" + one_kg + "</body>")), "is a free joint of the body \"b\""},
        {model("<body name='a'/><body name='a'/>"), "is a second body \"a\""},
        {model("", "<option><flag gravity='off'/></option>"), "give enable or disable"},
        {model("<attach prefix='a'/>"), "has no model, and no body or frame of this model"},
        {model("<include file='a.xml'><body/></include>"), "has elements inside"},
    };
    for (const auto& [text, expected] : faults) {
        const std::string message = fault(text);
        EXPECT_NE(message.find(expected), std::string::npos) << text << "\n" << message;
        EXPECT_EQ(message.find("robot.xml: line 1, <"), 0u) << message;
        EXPECT_NE(message.find("; "), std::string::npos) << message;
    }
    std::string deep;
    for (int i = 0; i < 350; ++i) deep = "<body>" + deep + "</body>";
    EXPECT_NE(fault(model(deep)), "");
}

}  // namespace
}  // namespace polhode::mjcf_import_test
