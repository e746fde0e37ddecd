// SDFormat import: rules by version, frames, defaults, computed inertia, worlds and included models, each against a
// closed form; refusals; and the table of constructs, row by row.
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "body/orientation.h"
#include "places.h"
#include "scene/robot_file.h"
#include "scene/robot_schema.h"
#include "scene/robot_tree.h"
#include "scene/scene_file.h"
#include "text/named_file.h"

namespace polhode::sdf_import_test {
namespace {

const double pi = 3.141592653589793;

Robot read_sdf(const std::string& text, const std::string& model = "", const RobotFiles& files = {}) {
    RobotOptions options;
    options.model = model;
    return parse_robot(text, "robot.sdf", options, files);
}

Scene sdf_scene(const std::string& text, RobotOptions options = {}, const RobotFiles& files = {}) {
    Scene scene;
    scene.name = "robot", scene.duration = 1;
    add_robot(parse_robot(text, "robot.sdf", options, files), options, "robot.sdf", scene);
    validate(scene, "robot.sdf");
    return scene;
}

std::string sdf_fault(const std::string& text, const std::string& model = "") {
    try {
        RobotOptions options;
        options.model = model;
        sdf_scene(text, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string sdf(const std::string& version, const std::string& inside) {
    return "<sdf version='" + version + "'>" + inside + "</sdf>";
}
std::string model(const std::string& name, const std::string& inside, const std::string& attributes = "") {
    return "<model name='" + name + "' " + attributes + ">" + inside + "</model>";
}
const std::string inertial =
    "<inertial><pose>.1 .2 .3 0 0 0</pose><mass>2</mass><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia>"
    "</inertial>";
std::string link(const std::string& name, const std::string& inside = "") {
    return "<link name='" + name + "'>" + inside + inertial + "</link>";
}
std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& inside = "<axis><xyz>1 0 0</xyz></axis>", const std::string& type = "revolute") {
    return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child +
           "</child>" + inside + "</joint>";
}

void expect_vector(const Vector3<double>& a, const Vector3<double>& b, double within = 1e-15) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], within) << "component " << i;
}
Vector3<double> about_z(double angle, const Vector3<double>& v) {
    return {std::cos(angle) * v[0] - std::sin(angle) * v[1], std::sin(angle) * v[0] + std::cos(angle) * v[1], v[2]};
}
Vector3<double> narrow(const Vector3<Wide>& v) { return cast<double>(v); }
std::vector<std::string> names_of(const Robot& robot) {
    std::vector<std::string> names;
    for (const RobotLink& one : robot.links) names.push_back(one.name);
    for (const RobotJoint& one : robot.joints) names.push_back(one.name);
    return names;
}
using Names = std::vector<std::string>;

// The child is rotated by 1.2 rad about z in the model, its joint by a further 0.5 rad.
TEST(SdfImport, AxesAreInTheFrameOfTheirVersion) {
    const auto axis = [](const std::string& version, const std::string& in_axis, const std::string& xyz = "") {
        const Robot robot = read_sdf(
            sdf(version, model("m", "<pose>1 2 3 0 0 0.7</pose>" + link("a") + link("b", "<pose>0 0 1 0 0 1.2</pose>") +
                                        joint("j", "a", "b",
                                              "<pose>0 0 0 0 0 0.5</pose><axis><xyz " + xyz + ">1 0 0</xyz>" + in_axis +
                                                  "</axis>"))));
        return narrow(robot.joints.at(0).axes[0]);
    };
    const std::string by_model = "<use_parent_model_frame>true</use_parent_model_frame>";
    const Vector3<double> x(1, 0, 0), in_model = about_z(-1.2, x), in_joint = about_z(0.5, x);
    for (const char* version : {"1.3", "1.4"}) expect_vector(axis(version, ""), in_model);
    for (const char* version : {"1.5", "1.6"}) {
        expect_vector(axis(version, ""), in_joint);
        expect_vector(axis(version, by_model), in_model);
        expect_vector(axis(version, "<use_parent_model_frame>0</use_parent_model_frame>"), in_joint);
    }
    for (const char* version : {"1.7", "1.8", "1.9", "1.10", "1.11", "1.12"}) {
        expect_vector(axis(version, ""), in_joint);
        expect_vector(axis(version, "", "expressed_in='__model__'"), in_model);
        expect_vector(axis(version, "", "expressed_in='b'"), x);
        expect_vector(axis(version, by_model), in_joint);
    }
}

TEST(SdfImport, VersionsThatAreNotSupportedAreRefusedByNumber) {
    const std::string inside = model("m", link("a"));
    for (const char* version : {"1.0", "1.2", "1.13", "2.0", "1.60", "x"})
        EXPECT_NE(sdf_fault(sdf(version, inside))
                      .find("robot.sdf: line 1, <sdf>: has the version \"" + std::string(version) +
                            "\"; versions 1.3 to 1.12 are supported"),
                  std::string::npos)
            << sdf_fault(sdf(version, inside));
    EXPECT_NE(sdf_fault("<gazebo version='1.2'/>").find("is SDFormat 1.0 to 1.2; versions 1.3 to 1.12 are supported"),
              std::string::npos);
    EXPECT_EQ(read_sdf("<sdf>" + inside + "</sdf>").assumed["SDFormat version, missing in the file"], Names{"1.12"});
}

TEST(SdfImport, PosesAreRelativeToTheirFrames) {
    // the attribute is `frame` before version 1.7; an empty pose is the identity
    for (const char* attribute : {"frame", "relative_to"}) {
        const Robot robot = read_sdf(
            sdf(*attribute == 'f' ? "1.6" : "1.9",
                model("m", "<frame name='tip'><pose>0 0 1 0 0 0.3</pose></frame><link name='b'><pose " +
                               std::string(attribute) + "='tip'/>" + inertial + "</link>" + "<link name='c'><pose " +
                               attribute + "='b'>1 0 0 0 0 0</pose>" + inertial + "</link>")));
        expect_vector(narrow(robot.places[0].position), {0, 0, 1});
        expect_vector(narrow(robot.places[1].position), {std::cos(0.3), std::sin(0.3), 1});
    }
    const Robot since = read_sdf(
        sdf("1.7", model("m", link("a", "<pose>1 0 0 0 0 0</pose>") +
                                  "<link name='b'><pose frame='a'>0 1 0 0 0 0</pose>" + inertial + "</link>")));
    expect_vector(narrow(since.places[1].position), {0, 1, 0});
    EXPECT_EQ(since.omitted.at("attribute frame of <pose>, which SDFormat 1.7 replaced by relative_to"), Names{"b"});
    // angles in degrees, and a quaternion of any length
    for (const char* pose :
         {"<pose degrees='true'>1 2 3 0 0 90</pose>", "<pose rotation_format='quat_xyzw'>1 2 3 0 0 2 2</pose>"}) {
        const Robot robot = read_sdf(sdf("1.9", model("m", link("a", pose))));
        expect_vector(narrow(robot.places[0] * Vector3<Wide>(Wide(1), Wide(0), Wide(0))), {1, 3, 3});
    }
}

TEST(SdfImport, FramesAndModelsAreEndsOfJoints) {
    // the joint is at its child's frame
    const Robot robot = read_sdf(
        sdf("1.9", model("m", link("a") + "<frame name='hook' attached_to='a'><pose>0 .1 -.4 0 0 0</pose></frame>" +
                                  link("b", "<pose>0 0 -.8 0 0 .4</pose>") +
                                  "<frame name='eye' attached_to='b'><pose relative_to='hook'/></frame>" +
                                  joint("j", "hook", "eye"))));
    ASSERT_EQ(robot.joints.size(), 1u);
    EXPECT_EQ(robot.joints[0].parent, 0u);
    EXPECT_EQ(robot.joints[0].child, 1u);
    expect_vector(narrow(robot.joints[0].point), about_z(-.4, {0, .1, .4}));
    expect_vector(narrow(robot.joints[0].axes[0]), about_z(-.4, {1, 0, 0}));
    // a model stands for its canonical link: by name, else its first link, else that of the first nested model
    const auto child_of = [](const std::string& attributes, const std::string& inside) {
        const Robot one =
            read_sdf(sdf("1.9", model("m", link("z") + model("n", inside, attributes) + joint("j", "z", "n"))));
        return one.links.at(one.joints.at(0).child).name;
    };
    EXPECT_EQ(child_of("", link("a") + link("b")), "n::a");
    EXPECT_EQ(child_of("canonical_link='b'", link("a") + link("b")), "n::b");
    EXPECT_EQ(child_of("canonical_link='k::b'", link("a") + model("k", link("b"))), "n::k::b");
    EXPECT_EQ(child_of("", model("k", link("b")) + model("l", link("c"))), "n::k::b");
    // the pose is that of the placement frame: link a is at -1 along the x axis of frame f
    const Robot placed = read_sdf(sdf(
        "1.9", model("m", "<pose>5 0 0 0 0 0</pose>" + link("a") + "<frame name='f'><pose>1 0 0 0 0 0</pose></frame>",
                     "placement_frame='f'")));
    expect_vector(narrow(placed.places[0].position), {4, 0, 0});
}

TEST(SdfImport, LinkAndJointMayShareANameBefore17) {
    const std::string inside = model("m", link("a") + link("b") + joint("a", "a", "b"));
    EXPECT_EQ(read_sdf(sdf("1.6", inside)).joints.at(0).name, "a");
    EXPECT_NE(sdf_fault(sdf("1.7", inside)).find("is a second \"m::a\"; the first is at line 1"), std::string::npos);
}

TEST(SdfImport, DefaultsAreTakenAndNamed) {
    const auto mass = [](const std::string& inside, const std::string& heading) {
        Robot robot = read_sdf(sdf("1.6", model("m", "<link name='b'>" + inside + "</link>")));
        EXPECT_EQ(robot.assumed[heading], Names{"b"});
        return *robot.links.at(0).mass;
    };
    const MassProperties<Wide> none =
        mass("", "links without <inertial>: 1 kg and moments of 1 kg m^2, SDFormat's default");
    EXPECT_EQ(double(none.mass), 1);
    EXPECT_EQ(double(none.inertia[2][2]), 1);
    EXPECT_EQ(double(none.inertia[0][1]), 0);
    EXPECT_EQ(double(mass("<inertial><inertia><ixx>.2</ixx><iyy>.3</iyy><izz>.4</izz></inertia></inertial>",
                          "links without <mass>: 1 kg, SDFormat's default")
                         .inertia[1][1]),
              .3);
    const MassProperties<Wide> part =
        mass("<inertial><mass>3</mass><inertia><ixx>.5</ixx><ixy>.1</ixy></inertia></inertial>",
             "links without <inertia> or with moments missing: 1 kg m^2, SDFormat's default");
    EXPECT_EQ(double(part.mass), 3);
    EXPECT_EQ(double(part.inertia[0][0]), .5);
    EXPECT_EQ(double(part.inertia[0][1]), .1);
    EXPECT_EQ(double(part.inertia[1][1]), 1);
    Robot axis = read_sdf(sdf("1.6", model("m", link("a") + link("b") + joint("j", "a", "b", "<axis/>"))));
    expect_vector(narrow(axis.joints.at(0).axes[0]), {0, 0, 1});
    EXPECT_EQ(axis.assumed["axes 0 0 1, SDFormat's default"], Names{"j"});
}

// Inertia computed from collisions agrees with the moments of the textbook solids.
TEST(SdfImport, InertiaIsComputedFromCollisions) {
    const auto computed = [](const std::string& collisions, const std::string& inside = "") {
        return *read_sdf(sdf("1.11", model("m", "<link name='b'><inertial auto='true'>" + inside + "</inertial>" +
                                                    collisions + "</link>")))
                    .links.at(0)
                    .mass;
    };
    const auto collision = [](const std::string& shape, const std::string& more = "") {
        return "<collision name='c'>" + more + "<geometry>" + shape + "</geometry></collision>";
    };
    const auto expect = [](const MassProperties<Wide>& m, double mass, const Vector3<double>& moments,
                           double height = 0) {
        EXPECT_NEAR(double(m.mass), mass, 1e-14 * mass);
        expect_vector(narrow(m.center), {0, 0, height});
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(double(m.inertia[i][i]), moments[i], 1e-14 * mass);
    };
    const std::string box = "<box><size>0.2 0.1 0.3</size></box>", density = "<density>2700</density>";
    const double m = 2700 * 0.006;
    const Vector3<double> of_box(m / 12 * 0.1, m / 12 * 0.13, m / 12 * 0.05);
    expect(computed(collision(box), density), m, of_box);
    expect(computed(collision(box, density)), m, of_box);
    // computed values replace <inertia> and <pose>; the collision's density takes precedence; <mass> scales the result
    const std::string numbers = "<pose>1 1 1 0 0 0</pose><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>";
    expect(computed(collision(box, density), "<density>1</density>" + numbers), m, of_box);
    expect(computed(collision(box, density), "<mass>9</mass>" + numbers), 9, (9 / m) * of_box);
    double mass = 1000 * 4 / 3. * pi * 0.008;
    expect(computed(collision("<sphere><radius>.2</radius></sphere>")), mass,
           {.4 * mass * .04, .4 * mass * .04, .4 * mass * .04});
    mass = 1000 * pi * .04 * .6;
    expect(computed(collision("<cylinder><radius>.2</radius><length>.6</length></cylinder>")), mass,
           {mass * (.01 + .03), mass * (.01 + .03), mass * .02});
    mass = 1000 * pi / 3 * .04 * .6;
    expect(computed(collision("<cone><radius>.2</radius><length>.6</length></cone>")), mass,
           {mass * (.15 * .04 + .0375 * .36), mass * (.15 * .04 + .0375 * .36), mass * .3 * .04}, -.15);
    mass = 1000 * 4 / 3. * pi * .006;
    expect(computed(collision("<ellipsoid><radii>.1 .2 .3</radii></ellipsoid>")), mass,
           {mass / 5 * .13, mass / 5 * .1, mass / 5 * .05});
    const MassProperties<Wide> capsule =
        computed(collision("<capsule><radius>.2</radius><length>.6</length></capsule>"));
    EXPECT_NEAR(double(capsule.mass), 1000 * pi * (.04 * .6 + 4 / 3. * .008), 1e-12);
    // two spheres 1 m apart, the second placed by a frame of the model
    const MassProperties<Wide> two =
        *read_sdf(sdf("1.11",
                      model("m", "<frame name='f'><pose>1 0 0 0 0 0</pose></frame><link name='b'><pose>0 0 0 0 0 " +
                                     std::to_string(0) + "</pose><inertial auto='1'><mass>2</mass></inertial>" +
                                     collision("<sphere><radius>.1</radius></sphere>") +
                                     "<collision name='d'><pose relative_to='f'/><geometry><sphere><radius>.1</radius>"
                                     "</sphere></geometry></collision></link>")))
             .links.at(0)
             .mass;
    expect_vector(narrow(two.center), {.5, 0, 0});
    EXPECT_NEAR(double(two.inertia[1][1]), 2 * (.4 * .01 + .25), 1e-15);
    // shapes without volume
    for (const char* shape : {"plane", "heightmap", "polyline", "image", "empty"}) {
        try {
            computed(collision("<" + std::string(shape) + "/>"));
            ADD_FAILURE() << shape;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what())
                          .find("<" + std::string(shape) + ">: is a shape whose inertia SDFormat does not compute"),
                      std::string::npos);
        }
    }
    EXPECT_NE(sdf_fault(sdf("1.11", model("m", "<link name='b'><inertial auto='true'/></link>")))
                  .find("link \"b\" has no <collision>"),
              std::string::npos);
}

TEST(SdfImport, WorldsHaveGravityJointsAndFrames) {
    const auto world = [](const std::string& version, const std::string& inside) {
        return read_sdf(sdf(version, "<world name='w'>" + inside + "</world>"));
    };
    const std::string m = model("m", "<pose>0 0 2 0 0 0</pose>" + link("b"));
    EXPECT_EQ(*world("1.11", "<gravity>0 0 -3.7</gravity>" + m).gravity_W, Vector3<double>(0, 0, -3.7));
    EXPECT_EQ(*world("1.11", m).gravity_W, Vector3<double>(0, 0, -9.8));
    EXPECT_EQ(world("1.11", m).gravity_source, "SDFormat's default");
    const std::string physics = "<physics type='ode'><gravity>1 2 3</gravity></physics>";
    EXPECT_EQ(*world("1.5", physics + m).gravity_W, Vector3<double>(1, 2, 3));
    EXPECT_EQ(*world("1.6", physics + m).gravity_W, Vector3<double>(0, 0, -9.8));
    EXPECT_EQ(world("1.6", physics + m).omitted.size(), 1u);
    EXPECT_FALSE(read_sdf(sdf("1.11", m)).gravity_W);
    const Robot held = world("1.11", m + joint("pivot", "world", "m"));
    ASSERT_EQ(held.joints.size(), 1u);
    EXPECT_EQ(held.joints[0].parent, RobotJoint::world);
    const Robot framed = world("1.11", "<frame name='f'><pose>1 0 0 0 0 0</pose></frame>" +
                                           model("m", "<pose relative_to='f'>1 0 0 0 0 0</pose>" + link("b")) +
                                           model("n", "<pose relative_to='m::b'>1 0 0 0 0 0</pose>" + link("b")));
    expect_vector(narrow(framed.places.at(0).position), {2, 0, 0});
    expect_vector(narrow(framed.places.at(1).position), {3, 0, 0});
    EXPECT_EQ(names_of(framed), (Names{"m::b", "n::b"}));
}

TEST(SdfImport, ModelsAreTakenByNameOrAllTogether) {
    const std::string text = sdf("1.11", "<world name='w'>" +
                                             model("m", link("a") + link("b") + joint("j", "a", "b") +
                                                            model("k", link("c") + link("d") + joint("j", "c", "d"))) +
                                             model("n", link("a")) + joint("j", "m::a", "n") + "</world>");
    EXPECT_EQ(names_of(read_sdf(text)), (Names{"m::a", "m::b", "m::k::c", "m::k::d", "n::a", "m::k::j", "m::j", "j"}));
    const Robot m = read_sdf(text, "m");
    EXPECT_EQ(names_of(m), (Names{"a", "b", "k::c", "k::d", "k::j", "j"}));
    EXPECT_EQ(m.omitted.at("joints to models that are not imported").size(), 1u);
    EXPECT_EQ(names_of(read_sdf(text, "m::k")), (Names{"c", "d", "j"}));
    EXPECT_NE(sdf_fault(text, "m::l").find("has no model \"m::l\""), std::string::npos);
}

TEST(SdfImport, StaticModelsArePartOfTheWorld) {
    const std::string post = model("post", "<static>true</static><pose>1 0 0 0 0 0</pose>" + link("beam"));
    Robot robot = read_sdf(
        sdf("1.11", "<world name='w'>" + post + model("m", link("a")) + joint("j", "post::beam", "m::a") + "</world>"));
    EXPECT_EQ(names_of(robot), (Names{"a", "j"}));
    EXPECT_EQ(robot.joints[0].parent, RobotJoint::world);
    EXPECT_EQ(robot.assumed["static models, treated as part of the world"], Names{"post"});
    // as the child: the joint is read from the world to the model, with the same coordinate
    robot = read_sdf(
        sdf("1.11", "<world name='w'>" + post + model("m", link("a")) + joint("j", "m::a", "post::beam") + "</world>"));
    ASSERT_EQ(robot.joints.size(), 1u);
    EXPECT_EQ(robot.joints[0].parent, RobotJoint::world);
    expect_vector(narrow(robot.joints[0].axes[0]), {-1, 0, 0});
    expect_vector(narrow(robot.joints[0].point), {1, 0, 0});
    EXPECT_NE(sdf_fault(sdf("1.11", "<world name='w'>" + post + "</world>")).find("all are static"), std::string::npos);
}

// The joint c -> b is reversed where a carries b: universal axes swap order and change sign.
TEST(SdfImport, JointsAreDirectedFromTheRoot) {
    const std::string two_axes =
        "<axis><xyz>1 0 0</xyz><dynamics><damping>1</damping></dynamics></axis><axis2><xyz>0 1 0</xyz></axis2>";
    Robot robot = read_sdf(sdf(
        "1.9", model("m", link("a") + link("b", "<pose>0 0 1 0 0 0</pose>") + link("c", "<pose>0 0 3 0 0 0</pose>") +
                              joint("j", "a", "b") + joint("k", "c", "b", two_axes, "universal"))));
    ASSERT_EQ(robot.joints.size(), 2u);
    const RobotJoint& k = robot.joints[1];
    EXPECT_EQ(k.parent, 1u);
    EXPECT_EQ(k.child, 2u);
    expect_vector(narrow(k.axes[0]), {0, -1, 0});
    expect_vector(narrow(k.axes[1]), {-1, 0, 0});
    expect_vector(narrow(k.point), {0, 0, -2});
    expect_vector(narrow(k.placement.position), {0, 0, 2});
    EXPECT_EQ(double(k.damping[1]), 1);
    EXPECT_EQ(robot.assumed["joints with parent and child swapped, so that each link has one parent"], Names{"k"});
    const std::string fault = sdf_fault(sdf("1.9", model("m", link("a") + link("b") + link("c") + joint("j", "a", "b") +
                                                                  joint("k", "a", "c") + joint("l", "c", "b"))));
    EXPECT_NE(fault.find("joint \"l\" closes a loop: joint \"k\" already connects link \"c\""), std::string::npos)
        << fault;
}

class SdfFolder {
  public:
    SdfFolder() : path_(std::filesystem::path(::testing::TempDir()) / "polhode_sdf_import_test") {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~SdfFolder() { std::filesystem::remove_all(path_); }
    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name) << text;
    }
    RobotFiles files() const { return {path_.string(), "robot.sdf"}; }

  private:
    std::filesystem::path path_;
};

TEST(SdfImport, IncludedModelsAreReadFromTheFolder) {
    const SdfFolder folder;
    // version 1.4 gives the axis in the model's frame, whichever version includes the file
    folder.write("crank/old.sdf", sdf("1.4", model("crank", link("rod") + link("wheel", "<pose>0 0 0 0 0 1</pose>") +
                                                                joint("k", "rod", "wheel"))));
    folder.write("crank/new.sdf", sdf("1.9", model("crank", "<pose>0 0 7 0 0 0</pose>" + link("rod") +
                                                                link("wheel", "<pose>0 0 0 0 0 1</pose>") +
                                                                joint("k", "rod", "wheel"))));
    folder.write("crank/model.config",
                 "<model><name>c</name><sdf version='1.4'>old.sdf</sdf>"
                 "<sdf version='1.9'>new.sdf</sdf><sdf version='9.9'>none.sdf</sdf></model>");
    folder.write("plain/model.sdf", sdf("1.6", model("plain", link("p"))));
    const auto read = [&](const std::string& inside) {
        return read_sdf(sdf("1.10", "<world name='w'>" + inside + "</world>"), "", folder.files());
    };
    const auto include = [](const std::string& uri, const std::string& more = "", const std::string& attributes = "") {
        return "<include " + attributes + "><uri>" + uri + "</uri>" + more + "</include>";
    };
    for (const char* uri : {"model://crank", "crank", "file://crank", "crank/new.sdf"}) {
        const Robot robot = read(include(uri));
        EXPECT_EQ(names_of(robot), (Names{"rod", "wheel", "k"}));
        expect_vector(narrow(robot.places[0].position), {0, 0, 7});
        expect_vector(narrow(robot.joints[0].axes[0]), {1, 0, 0});
    }
    expect_vector(narrow(read(include("crank/old.sdf")).joints[0].axes[0]), about_z(-1, {1, 0, 0}));
    // name, pose, placement_frame and static of the include take precedence
    const Robot two = read(include("model://crank", "<name>x</name><pose>0 0 1 0 0 0</pose>") +
                           include("model://plain", "<pose>3 0 0 0 0 0</pose>"));
    EXPECT_EQ(names_of(two), (Names{"x::rod", "x::wheel", "plain::p", "x::k"}));
    expect_vector(narrow(two.places[0].position), {0, 0, 1});
    const Robot still = read(include("crank", "<static>true</static>") + include("plain"));
    EXPECT_EQ(names_of(still), Names{"p"});
    // merged: the names belong to the enclosing model
    const Robot merged = read(
        model("m", link("a") + include("crank", "<pose>1 0 0 0 0 0</pose>", "merge='true'") + joint("j", "a", "rod")));
    EXPECT_EQ(names_of(merged), (Names{"a", "rod", "wheel", "k", "j"}));
    expect_vector(narrow(merged.places[1].position), {1, 0, 0});
    // an error in an included file names that file
    folder.write("bad/model.sdf", sdf("1.6", model("bad", "\n" + link("p", "<pose>1 2</pose>"))));
    const auto fault = [&](const std::string& inside) -> std::string {
        try {
            read(inside);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(fault(include("bad")).find("bad/model.sdf: line 2, <pose>: has 2 numbers"), std::string::npos)
        << fault(include("bad"));
    EXPECT_NE(fault(include("https://fuel.gazebosim.org/x")).find("which is not a file"), std::string::npos);
    EXPECT_NE(fault(include("model://none")).find("no such model was found"), std::string::npos);
    EXPECT_NE(fault(include("../../etc/passwd.sdf")).find("no such model was found"), std::string::npos);
    EXPECT_NE(fault(include("crank", "<placement_frame>rod</placement_frame>")).find("without a <pose>"),
              std::string::npos);
    folder.write("self/model.sdf", sdf("1.6", model("self", link("p") + include("model://self", "<name>t</name>"))));
    EXPECT_NE(fault(include("self")).find("is nested more than 16 files deep"), std::string::npos);
    folder.write("twice/model.sdf",
                 sdf("1.6", model("t", include("../twice", "<name>a</name>") + include("../twice", "<name>b</name>"))));
    EXPECT_NE(fault(include("twice")), "");
}

TEST(SdfImport, OneLinkFollowsTheSameRules) {
    const SdfFolder folder;
    folder.write("part.sdf", sdf("1.9", model("part", link("p"))));
    const auto read = [&](const std::string& text, const std::string& name) {
        return parse_robot_body(text, "robot.sdf", name, false, folder.files());
    };
    const std::string text =
        sdf("1.11", model("m", link("a") + "<link name='d'/>" + "<link name='c'><inertial auto='1'/>" +
                                   "<collision name='c'><geometry><sphere><radius>1</radius>"
                                   "</sphere></geometry></collision></link>" +
                                   "<include><uri>part.sdf</uri></include>"));
    EXPECT_TRUE(std::holds_alternative<ImportedBody>(read(text, "a")));
    EXPECT_EQ(std::get<NumericBody>(read(text, "d")).mass, 1);
    EXPECT_NEAR(std::get<NumericBody>(read(text, "c")).mass, 4000 * pi / 3, 1e-12);
    EXPECT_EQ(std::get<NumericBody>(read(text, "p")).mass, 2);
    EXPECT_EQ(std::get<NumericBody>(read(text, "m::part::p")).mass, 2);
}

const Joint& by_name(const Scene& scene, const std::string& name) {
    return *std::ranges::find_if(scene.joints, [&](const Joint& one) { return one.name == name; });
}

// A screw of 0.02 m per revolution, in both ways to state it: the rotation by x moves the nut by 0.02 x / (2 pi).
TEST(SdfImport, ScrewsAreRotationsWithACoupledDisplacement) {
    for (const char* pitch :
         {"<screw_thread_pitch>0.02</screw_thread_pitch>", "<thread_pitch>-314.1592653589793</thread_pitch>"}) {
        const Scene s =
            sdf_scene(sdf("1.10", model("m", link("a") + link("b") +
                                                 "<joint name='j' type='screw'><parent>a</parent><child>b</child>"
                                                 "<axis><xyz>0 0 1</xyz><limit><lower>-3</lower></limit>"
                                                 "<initial_position>0.5</initial_position></axis>" +
                                                 pitch + "</joint>")));
        ASSERT_EQ(s.joints.size(), 2u);
        const Joint &turn = by_name(s, "j"), &shift = by_name(s, "j_translation");
        EXPECT_EQ(shift.type, JointType::prismatic);
        EXPECT_EQ(turn.type, JointType::revolute);
        EXPECT_EQ(turn.limits.lower, -3);
        EXPECT_EQ(turn.coordinate[0], 0.5);
        ASSERT_EQ(s.couplings.size(), 1u);
        EXPECT_EQ(s.couplings[0].first, "j");
        EXPECT_NEAR(s.couplings[0].ratio, 0.02 / (2 * pi), 1e-17);
        EXPECT_NEAR(shift.coordinate[0], 0.5 * 0.02 / (2 * pi), 1e-17);
        EXPECT_TRUE(s.omitted.empty());
    }
    const Scene normal = sdf_scene(sdf("1.10", model("m", link("a") + link("b") +
                                                              "<joint name='j' type='screw'><parent>a</parent>"
                                                              "<child>b</child><axis/></joint>")));
    EXPECT_NEAR(normal.couplings[0].ratio, 1 / (2 * pi), 1e-16);
}

// revolute2 has any two axes; limits of one of them make two joints. Equal limits fix a joint.
TEST(SdfImport, Revolute2AndLockedJoints) {
    const auto read = [](const std::string& first, const std::string& second) {
        return sdf_scene(
            sdf("1.10", model("m", link("a") + link("b") +
                                       "<joint name='j' type='revolute2'><parent>a</parent><child>b</child>"
                                       "<axis><xyz>0 0 1</xyz>" +
                                       first + "</axis><axis2><xyz>0 1 0.5</xyz>" + second + "</axis2></joint>")));
    };
    const Scene plain = read("", "<initial_position>0.25</initial_position>");
    ASSERT_EQ(plain.joints.size(), 1u);
    EXPECT_EQ(plain.joints[0].type, JointType::universal);
    EXPECT_EQ(plain.joints[0].coordinate, (std::array<double, 2>{0, 0.25}));
    const Scene split = read("<limit><upper>0.5</upper></limit>", "<dynamics><friction>0.1</friction></dynamics>");
    ASSERT_EQ(split.joints.size(), 2u);
    EXPECT_EQ(by_name(split, "j_1").limits.upper, 0.5);
    EXPECT_EQ(by_name(split, "j_2").friction, 0.1);
    EXPECT_TRUE(split.omitted.empty());
    const Scene locked =
        sdf_scene(sdf("1.10", model("m", link("a") + link("b") + link("c") + joint("k", "b", "c") +
                                             joint("j", "a", "b",
                                                   "<axis><xyz>0 0 1</xyz><limit><lower>0.5</lower><upper>0.5</upper>"
                                                   "</limit></axis>"))));
    const Joint& fixed = by_name(locked, "j");
    EXPECT_EQ(fixed.type, JointType::fixed);
    EXPECT_NEAR(fixed.parent_orientation.w, std::cos(0.25), 1e-15);
    EXPECT_NEAR(fixed.parent_orientation.z, std::sin(0.25), 1e-15);
}

TEST(SdfImport, RefusesWhatItCannotMake) {
    const auto two = [](const std::string& more) { return sdf("1.9", model("m", link("a") + link("b") + more)); };
    const auto typed = [&](const std::string& type) {
        return two("<joint name='j' type='" + type + "'><parent>a</parent><child>b</child></joint>");
    };
    const std::pair<std::string, const char*> faults[] = {
        {"<sdf version='1.9'/>", "has no <model> with a link"},
        {two("<joint name='j' "
             "type='screw'><parent>a</parent><child>b</child><axis/><thread_pitch>0</thread_pitch></joint>"),
         "<thread_pitch>: is 0"},
        {typed("gearbox"), "has no <gearbox_reference_body>"},
        {typed("revolute2"), "has no <axis>"},
        {typed("magic"), "joint \"j\" has the type \"magic\"; give revolute, continuous"},
        {typed("revolute"), "has no <axis>"},
        {typed("universal"), "has no <axis>"},
        {two("<drake:joint name='j' type='planar'/>"),
         "<drake:joint>: \"j\" is a joint type that is not part of SDFormat"},
        {two(joint("j", "a", "world")), "<child>: of joint \"j\" is the world; swap parent and child"},
        {two(joint("j", "a", "c")), "<child>: refers to \"c\", which does not exist in the model \"m\""},
        {two(joint("j", "a", "a")), "joint \"j\" has the same link as parent and child"},
        {two(joint("j", "a", "b", "<axis><xyz>0 0 0</xyz></axis>")), "<xyz>: is zero"},
        {two(joint("j", "a", "b") + joint("j", "b", "a")), "is a second \"m::j\""},
        {two("<frame name='f'><pose relative_to='g'/></frame><frame name='g' attached_to='f'/>" +
             joint("j", "a", "b", "<pose relative_to='f'/>", "fixed")),
         "is placed relative to itself"},
        {two("<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>" + joint("j", "a", "f")),
         "is attached to itself"},
        {two("<frame name='world'/>"), "has the reserved name \"world\""},
        {two("<model name='n'/>" + joint("j", "a", "n")), "refers to the model \"m::n\", which has no link"},
        {two("<include><uri>x</uri></include>"), "no such model was found"},
        {sdf("1.9", model("m", link("a", "<pose rotation_format='matrix'/>"))), "has the rotation_format \"matrix\""},
        {sdf("1.9", model("m", link("a", "<pose degrees='maybe'/>"))), "has \"maybe\" in degrees"},
        {sdf("1.9", model("m", "<static>perhaps</static>" + link("a"))), "has \"perhaps\" in it"},
        {sdf("1.9", model("m", "<link name='a'><inertial><mass>-1</mass></inertial></link>")),
         "has the negative mass -1"},
    };
    for (const auto& [text, fault] : faults) {
        const std::string message = sdf_fault(text);
        EXPECT_NE(message.find(fault), std::string::npos) << text << "\n" << message;
        EXPECT_EQ(message.find("robot.sdf: "), 0u) << message;
    }
}

// The table contains every element and attribute of the schemas 1.3 to 1.12, and its verdicts are correct.

const RobotConstruct* row_of(std::string_view parent, std::string_view element, std::string_view attribute) {
    for (const std::string_view over : {parent, std::string_view("*")})
        for (const RobotConstruct& row : sdf_constructs())
            if (row.parent == over && row.element == element && row.attribute == attribute) return &row;
    return nullptr;
}

TEST(SdfConstructs, ListTheWholeSchema) {
    std::ifstream schema(source_dir() + "/tests/scene/sdf_schema.txt");
    std::string parent, element, attribute;
    int rows = 0;
    for (; schema >> parent >> element >> attribute; ++rows) {
        if (parent == "-") parent = "";
        if (attribute == "-") attribute = "";
        const RobotConstruct* whole = row_of(parent, element, "");
        ASSERT_TRUE(whole) << parent << " " << element;
        EXPECT_TRUE(row_of(parent, element, attribute) || whole->verdict != RobotVerdict::modelled)
            << parent << " " << element << " " << attribute;
    }
    EXPECT_GT(rows, 250);
    std::set<std::string> keys;
    for (const RobotConstruct& row : sdf_constructs())
        EXPECT_TRUE(
            keys.insert(std::string(row.parent) + " " + std::string(row.element) + " " + std::string(row.attribute))
                .second)
            << row.element;
}

// A world whose scenery is missing can be read; the missing models are listed as omitted.
TEST(SdfImport, MissingModelsOfAWorldAreNamed) {
    const std::string world =
        "<sdf version='1.9'><world name='w'><include><uri>model://sun</uri></include><model name='m'><link "
        "name='a'/></model></world></sdf>";
    const Scene scene = sdf_scene(world);
    EXPECT_EQ(scene.bodies.size(), 1u);
    EXPECT_EQ(scene.omitted, std::vector<std::string>{"included models of the world that were not found: model://sun"});
}

// A document with every modelled element that has text or an attribute, with values that have an effect.
std::string full_document(const std::string& version) {
    const std::string pose = std::stoi(version.substr(2)) < 7 ? "frame" : "relative_to";
    return "<sdf version='" + version +
           "'><world name='w'><gravity>0 0 -1</gravity>"
           "<physics type='ode'><gravity>0 0 -2</gravity><ode/></physics><wind/>"
           "<frame name='wf'><pose>1 0 0 0 0 0</pose></frame>"
           "<model name='m' canonical_link='a' placement_frame='mf'><static>false</static><pose " +
           pose +
           "='wf' degrees='true' rotation_format='euler_rpy'>0 0 1 0 0 10</pose>"
           "<frame name='mf' attached_to='a'><pose>0 1 0 0 0 0</pose></frame>"
           "<link name='a'><inertial auto='true'><density>500</density></inertial>"
           "<collision name='c'><geometry><box><size>1 2 3</size></box></geometry></collision>"
           "<collision "
           "name='d'><density>3</density><geometry><sphere><radius>1</radius></sphere></geometry></collision>"
           "<collision "
           "name='e'><geometry><cylinder><radius>1</radius><length>2</length></cylinder></geometry></collision>"
           "<collision name='f'><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></collision></link>"
           "<link "
           "name='b'><velocity_decay/><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz><ixy>0</ixy>"
           "<ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>"
           "<joint name='j' type='universal'><parent>__model__</parent><child>b</child>"
           "<axis><xyz expressed_in='a'>1 0 0</xyz><use_parent_model_frame>false</use_parent_model_frame>"
           "<dynamics><damping>1</damping><spring_reference>1</spring_reference>"
           "<spring_stiffness>1</spring_stiffness></dynamics><limit/></axis><axis2><xyz>0 1 0</xyz></axis2>"
           "<physics><ode/></physics></joint></model></world></sdf>";
}

// The scene with its notes, or the refusal.
std::string reading_of(const std::string& text, bool with_notes = true) {
    try {
        const Scene scene = sdf_scene(text);
        std::string all = write_scene(scene);
        for (const std::string& one : scene.omitted)
            if (with_notes) all += one + "\n";
        return all;
    } catch (const InputError& error) {
        return std::string("refused: ") + error.what();
    }
}

XMLElement* find_tag(XMLElement& at, std::string_view tag) {
    if (tag == at.Name()) return &at;
    for (XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement())
        if (XMLElement* found = find_tag(*one, tag)) return found;
    return nullptr;
}

std::string printed(const tinyxml2::XMLDocument& document) {
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    return printer.CStr();
}

// The document with <element>text</element> in its first <parent>; text that starts with < is parsed as an element.
// Returns an empty string if there is no such parent.
std::string with_element(const RobotConstruct& row, const std::string& text) {
    static const std::map<std::string_view, const char*> parents = {{"frame", "link"},
                                                                    {"plugin", "model"},
                                                                    {"model_state", "model"},
                                                                    {"sensor", "link"},
                                                                    {"auto_inertia_params", "inertial"},
                                                                    {"initial_position", "axis"},
                                                                    {"mimic", "axis"}};
    tinyxml2::XMLDocument document;
    document.Parse(full_document("1.12").c_str());
    const std::string parent(row.parent == "*" ? parents.at(row.element) : row.parent);
    XMLElement* within = find_tag(*document.RootElement(), parent);
    if (parent == "mesh" || !within) return "";
    XMLElement* one = within->InsertNewChildElement(std::string(row.element).c_str());
    if (!text.empty() && text[0] == '<')
        one->InsertNewChildElement(text.substr(1, text.size() - 2).c_str());
    else
        one->SetText(text.c_str());
    return printed(document);
}

TEST(SdfConstructs, WhatIsIrrelevantOrOmittedHasThatVerdict) {
    const std::string plain = reading_of(full_document("1.12")), bare = reading_of(full_document("1.12"), false);
    ASSERT_EQ(plain.find("refused"), std::string::npos) << plain;
    ASSERT_EQ(plain.find("unknown"), std::string::npos) << plain;
    int irrelevant = 0, omitted = 0;
    for (const RobotConstruct& row : sdf_constructs()) {
        if (row.verdict == RobotVerdict::modelled || !row.attribute.empty()) continue;
        SCOPED_TRACE(std::string(row.parent) + " " + std::string(row.element));
        if (row.verdict == RobotVerdict::irrelevant && row.parent != "mesh" && row.parent != "include" &&
            row.parent != "geometry") {
            EXPECT_EQ(reading_of(with_element(row, "7")), plain);
            ++irrelevant;
        }
        if (row.verdict != RobotVerdict::omitted) continue;
        bool is_named = false;
        for (const char* text : {"0.5", "true", "false", "<x>", "<plugin>"}) {
            const std::string reading = reading_of(with_element(row, text));
            EXPECT_EQ(reading.rfind(bare, 0), 0u) << reading;  // the scene itself does not change
            is_named = is_named || reading.find(std::string(row.note) + ": ") != std::string::npos;
        }
        EXPECT_TRUE(is_named);
        ++omitted;
        for (std::string_view left = row.neutral; !left.empty();) {
            const std::size_t end = std::min(left.find('|'), left.size());
            EXPECT_EQ(reading_of(with_element(row, std::string(left.substr(0, end)))), plain);
            left.remove_prefix(std::min(end + 1, left.size()));
        }
    }
    EXPECT_GT(irrelevant, 50);
    EXPECT_GT(omitted, 15);
    EXPECT_NE(reading_of(with_element({.parent = "link", .element = "mystery", .attribute = "", .note = ""}, ""))
                  .find("unknown element <mystery>: a"),
              std::string::npos);
}

// Invalid text in any element or attribute of the document is refused or changes the scene.
TEST(SdfConstructs, WhatIsModelledReacts) {
    std::set<std::string> seen;
    // gravity in <physics> acts before version 1.6 in worlds without their own; model names matter among several
    const std::string two_models =
        "<sdf version='1.5'><world name='w'><physics type='ode'><gravity>0 0 -2</gravity></physics>"
        "<model name='m'><link name='a'/></model><model name='n'><link name='a'/></model></world></sdf>";
    for (const std::string& text : {full_document("1.5"), full_document("1.6"), full_document("1.12"), two_models}) {
        tinyxml2::XMLDocument document;
        document.Parse(text.c_str());
        const std::string plain = reading_of(printed(document), false);
        ASSERT_EQ(plain.find("refused"), std::string::npos) << plain;
        const std::function<void(XMLElement&, const std::string&)> walk = [&](XMLElement& at,
                                                                              const std::string& parent) {
            const auto expect_reaction = [&](const std::string& what) {
                if (reading_of(printed(document), false) != plain) seen.insert(what);
            };
            if (at.GetText()) {
                const std::string before = at.GetText();
                at.SetText("1 garbage");
                expect_reaction(parent + " " + at.Name());
                at.SetText(before.c_str());
            }
            for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next()) {
                const std::string before = a->Value(), name = a->Name();
                at.SetAttribute(name.c_str(), "garbage");
                expect_reaction(parent + " " + at.Name() + " " + name);
                at.SetAttribute(name.c_str(), before.c_str());
            }
            for (XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement()) walk(*one, at.Name());
        };
        walk(*document.RootElement(), "");
    }
    tinyxml2::XMLDocument document;
    document.Parse(full_document("1.12").c_str());
    const std::function<void(const XMLElement&, const std::string&)> check = [&](const XMLElement& at,
                                                                                 const std::string& parent) {
        const RobotConstruct* row = row_of(parent, at.Name(), "");
        if (at.GetText() && row && row->verdict == RobotVerdict::modelled) {
            EXPECT_TRUE(seen.contains(parent + " " + at.Name())) << parent << " " << at.Name();
        }
        for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next()) {
            const RobotConstruct* of = row_of(parent, at.Name(), a->Name());
            const bool is_inner_name = std::string_view(at.Name()) == "frame" && a->Name() == std::string("name");
            if (of && of->verdict == RobotVerdict::modelled && !is_inner_name) {
                EXPECT_TRUE(seen.contains(parent + " " + at.Name() + " " + a->Name()))
                    << parent << " " << at.Name() << " " << a->Name();
            }
        }
        for (const XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement())
            check(*one, at.Name());
    };
    check(*document.RootElement(), "");
}

}  // namespace
}  // namespace polhode::sdf_import_test
