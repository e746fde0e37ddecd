// MuJoCo: a body with a free joint, or with a ball joint at its pivot; mechanisms as nested bodies.
//
// Models are written as MJCF text and loaded from memory (load_model()). MujocoWorld has one body; MujocoMechanism
// nests each body in its parent and closes loops by "connect" equality constraints. Limits, friction, armature, springs
// and couplings of joints are attributes of the model; motors are generalized forces. serve.h runs the requests.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cstring>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

std::string format_vector(const Vector3<double>& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v[0], v[1], v[2]); }

// Replaces MuJoCo's error handler, which would end the program.
[[noreturn]] void throw_error(const char* message) { throw std::runtime_error(message); }

const char* integrator_name(const std::string& setting) {
    return setting == "rk4"            ? "RK4"
           : setting == "implicit"     ? "implicit"
           : setting == "stiff"        ? "implicit"
           : setting == "implicitfast" ? "implicitfast"
                                       : "Euler";
}

// Loads a model from text; the caller creates its data.
mjModel* load_model(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    char error[300] = "";
    mj_makeEmptyFileVFS(files.get(), "model.xml", int(xml.size()));
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    mjModel* model = mj_loadXML("model.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(error);
    return model;
}

void advance(mjModel* model, mjData* data, double h) {
    model->opt.timestep = h;
    mj_step(model, data);
    // MuJoCo resets a bad state and continues with a warning
    if (data->warning[mjWARN_BADQPOS].number + data->warning[mjWARN_BADQVEL].number +
            data->warning[mjWARN_BADQACC].number >
        0)
        throw std::runtime_error("MuJoCo detected an invalid state and reset the simulation");
}

// A shape as a geom. Its friction is sliding friction alone: contacts have three dimensions.
std::string write_geom(const EngineShape& shape, double friction) {
    const auto write = [&](const char* type, const std::string& size) {
        return fmt::format(
            R"(<geom type="{}" size="{}" pos="{}" quat="{:.17g} {:.17g} {:.17g} {:.17g}" friction="{:.17g} 0 0"/>)",
            type, size, format_vector(shape.position), shape.q.w, shape.q.x, shape.q.y, shape.q.z, friction);
    };
    if (shape.type == "ball") return write("sphere", fmt::format("{:.17g}", shape.radius));
    if (shape.type == "ellipsoid") return write("ellipsoid", format_vector(shape.half));
    if (shape.type == "box") return write("box", format_vector(shape.half));
    const double half_height = shape.type == "disc" ? disc_half_height(shape) : shape.half_height;
    return write(shape.type == "capsule" ? "capsule" : "cylinder",
                 fmt::format("{:.17g} {:.17g}", shape.radius, half_height));
}

std::string write_plane(const Plane& plane) {
    const Quaternion<double> q = frame_about(plane.normal_W);
    return fmt::format(
        R"(<geom type="plane" size="0 0 1" pos="{}" quat="{:.17g} {:.17g} {:.17g} {:.17g}" friction="{:.17g} 0 0"/>)",
        format_vector(plane.offset * plane.normal_W), q.w, q.x, q.y, q.z, plane.friction);
}

class MujocoWorld {
  public:
    explicit MujocoWorld(const Body& body) : pivot_(body.pivot) {
        if (!body.planes.empty() && body.planes.front().restitution > 0)
            throw Unsupported("MuJoCo's contacts have no coefficient of restitution");
        std::string geoms, planes;
        for (const Plane& plane : body.planes) planes += write_plane(plane);
        for (const EngineShape& shape : body.shapes) geoms += write_geom(shape, body.planes.front().friction);
        const char* integrator = integrator_name(body.setting);
        const std::string joint =
            body.pivot ? fmt::format(R"(<joint type="ball" pos="{}"/>)", format_vector(*body.pivot)) : "<freejoint/>";
        const std::string xml = fmt::format(
            R"(<mujoco><option gravity="{}" integrator="{}" cone="{}"/><worldbody>{}<body pos="{}">{}<inertial )"
            R"(pos="0 0 0" mass="{:.17g}" diaginertia="{}"/>{}</body></worldbody></mujoco>)",
            format_vector(body.gravity), integrator, body.setting == "elliptic" ? "elliptic" : "pyramidal", planes,
            format_vector(body.pivot ? -*body.pivot : body.p), joint, body.mass, format_vector(body.moments), geoms);
        model_ = load_model(xml);
        data_ = mj_makeData(model_);
        mjtNum* q = data_->qpos + first_q();
        q[0] = body.q.w, q[1] = body.q.x, q[2] = body.q.y, q[3] = body.q.z;
        if (!pivot_)
            for (int i = 0; i < 3; ++i) data_->qpos[i] = body.p[i];
        set_velocities(body.w, body.v);
    }
    ~MujocoWorld() {
        mj_deleteData(data_);
        mj_deleteModel(model_);
    }
    MujocoWorld(const MujocoWorld&) = delete;
    MujocoWorld& operator=(const MujocoWorld&) = delete;

    Motion motion() const {
        const mjtNum *q = data_->qpos + first_q(), *w = data_->qvel + first_w();
        Motion at{{q[0], q[1], q[2], q[3]}, {}, {}, {}};
        const Quaternion<double> turn = normalized(at.q);
        at.w = rotate(turn, vector_of(w));
        if (pivot_) {
            at.p = -rotate(turn, *pivot_);
            at.v = cross(at.w, at.p);
        } else {
            at.p = vector_of(data_->qpos), at.v = vector_of(data_->qvel);
        }
        return at;
    }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) {
        const mjtNum* q = data_->qpos + first_q();
        const Vector3<double> w_B = rotate_back(normalized(Quaternion<double>{q[0], q[1], q[2], q[3]}), w);
        for (int i = 0; i < 3; ++i) data_->qvel[first_w() + i] = w_B[i];
        if (!pivot_)
            for (int i = 0; i < 3; ++i) data_->qvel[i] = v[i];
    }
    void set_gravity(const Vector3<double>& gravity) {
        for (int i = 0; i < 3; ++i) model_->opt.gravity[i] = gravity[i];
    }
    void apply(const Vector3<double>& force, const Vector3<double>& torque) {
        for (int i = 0; i < 3; ++i) {
            data_->xfrc_applied[6 + i] = force[i];
            data_->xfrc_applied[9 + i] = torque[i];
        }
    }
    void step(double h) {
        advance(model_, data_, h);
        for (int i = 6; i < 12; ++i) data_->xfrc_applied[i] = 0;
    }
    double mass() const { return model_->body_mass[1]; }
    Vector3<double> moments() const { return vector_of(model_->body_inertia + 3); }

  private:
    int first_q() const { return pivot_ ? 0 : 3; }
    int first_w() const { return pivot_ ? 0 : 3; }

    std::optional<Vector3<double>> pivot_;
    mjModel* model_ = nullptr;
    mjData* data_ = nullptr;
};

// The body's name in the model; "world" for a negative index.
std::string body_name(int index) { return index < 0 ? "world" : fmt::format("b{}", index); }

// The limits, friction, armature, spring and damper of a joint as attributes.
std::string write_laws(const JointLaws& laws) {
    std::string all;
    const auto add = [&](const char* attribute, double value) {
        if (value != 0) all += fmt::format(R"( {}="{:.17g}")", attribute, value);
    };
    // MuJoCo has no limits on one side
    constexpr double far = 1e9;
    if (laws.limits.any())
        all += fmt::format(R"( limited="true" range="{:.17g} {:.17g}")", std::max(laws.limits.lower, -far),
                           std::min(laws.limits.upper, far));
    add("frictionloss", laws.friction), add("armature", laws.armature);
    add("stiffness", laws.stiffness), add("springref", laws.rest), add("damping", laws.damping);
    return all;
}

std::string joint_name(std::size_t index) { return fmt::format("j{}", index); }

// The joints of a body. All coordinates are zero in the initial configuration.
std::string write_joints(const Mechanism& mechanism, const LinkJoint* joint) {
    if (!joint) return "<freejoint/>";
    if (joint->type == "fixed") return "";
    const char* type = joint->type == "spherical" ? "ball" : joint->type == "prismatic" ? "slide" : "hinge";
    if (joint->child_axes.size() == 1)
        return fmt::format(R"(<joint name="{}" type="{}" pos="{}" axis="{}"{}/>)",
                           joint_name(std::size_t(joint - mechanism.joints.data())), type,
                           format_vector(joint->child_point), format_vector(joint->child_axes[0]),
                           write_laws(joint->laws));
    std::string all;
    for (std::size_t i = 0; i < std::max<std::size_t>(joint->child_axes.size(), 1); ++i)
        all += fmt::format(
            R"(<joint type="{}" pos="{}"{}/>)", type, format_vector(joint->child_point),
            joint->child_axes.empty() ? "" : fmt::format(R"( axis="{}")", format_vector(joint->child_axes[i])));
    return all;
}

// A coupling as a constraint between two joints.
std::string write_coupling(const JointCoupling& coupling) {
    return fmt::format(R"(<joint joint1="{}" joint2="{}" polycoef="0 {:.17g} 0 0 0"/>)", joint_name(coupling.second),
                       joint_name(coupling.first), coupling.ratio);
}

// The stiffest soft constraints that MuJoCo permits: a time constant of two steps and an impedance of 0.9999.
void stiffen(mjModel* model, double h) {
    const auto set = [&](mjtNum* solref, mjtNum* solimp, int count) {
        for (int i = 0; i < count; ++i) {
            solref[mjNREF * i] = 2 * h, solref[mjNREF * i + 1] = 1;
            solimp[mjNIMP * i] = solimp[mjNIMP * i + 1] = 0.9999;
        }
    };
    set(model->jnt_solref, model->jnt_solimp, model->njnt);
    set(model->dof_solref, model->dof_solimp, model->nv);
    set(model->eq_solref, model->eq_solimp, model->neq);
}

// A body and all bodies that it carries.
std::string write_body(const Mechanism& mechanism, int index) {
    const LinkJoint* joint = mechanism.parent_joint(index);
    const LinkBody& body = mechanism.body(index);
    const int parent = joint ? joint->parent : -1;
    const Quaternion<double> up = conjugate(mechanism.attitude(parent)), q = up * body.start.q;
    const Vector3<double> p = parent < 0 ? body.start.p : rotate(up, body.start.p - mechanism.body(parent).start.p);
    std::string all = fmt::format(
        R"(<body name="{}" pos="{}" quat="{:.17g} {:.17g} {:.17g} {:.17g}">{}<inertial pos="0 0 0" mass="{:.17g}" )"
        R"(diaginertia="{}"/>)",
        body_name(index), format_vector(p), q.w, q.x, q.y, q.z, write_joints(mechanism, joint), body.mass,
        format_vector(body.moments));
    for (const LinkJoint& other : mechanism.joints)
        if (other.parent == index) all += write_body(mechanism, other.child);
    return all + "</body>";
}

// Constraints that close a loop. A hinge constrains two points of its axis.
std::string write_closure(const LinkJoint& loop) {
    std::string all;
    const auto add_connection = [&](const Vector3<double>& anchor) {
        const bool from_parent = loop.parent >= 0;
        const int first = from_parent ? loop.parent : loop.child, second = from_parent ? loop.child : -1;
        all += fmt::format(R"(<connect body1="{}" {} anchor="{}"/>)", body_name(first),
                           second < 0 ? "" : fmt::format(R"(body2="{}")", body_name(second)), format_vector(anchor));
    };
    const bool from_parent = loop.parent >= 0;
    const Vector3<double>& point = from_parent ? loop.parent_point : loop.child_point;
    add_connection(point);
    if (!loop.axes_W.empty()) add_connection(point + (from_parent ? loop.parent_axes[0] : loop.child_axes[0]));
    return all;
}

class MujocoMechanism {
  public:
    explicit MujocoMechanism(const Mechanism& mechanism)
        : mechanism_(mechanism), forces_(mechanism_), is_stiff_(mechanism.setting == "stiff") {
        std::string bodies, closures;
        for (int i = 0; i < static_cast<int>(mechanism.bodies.size()); ++i)
            if (const LinkJoint* joint = mechanism.parent_joint(i); !joint || joint->parent < 0)
                bodies += write_body(mechanism, i);
        for (const LinkJoint& loop : mechanism.loops) closures += write_closure(loop);
        for (const JointCoupling& coupling : mechanism.couplings) closures += write_coupling(coupling);
        model_ = load_model(fmt::format(
            R"(<mujoco><compiler angle="radian"/><option gravity="{}" integrator="{}"/><worldbody>{}</worldbody>)"
            R"(<equality>{}</equality></mujoco>)",
            format_vector(mechanism.gravity), integrator_name(mechanism.setting), bodies, closures));
        data_ = mj_makeData(model_);
        for (int i = 0; i < static_cast<int>(mechanism.bodies.size()); ++i) {
            const int id = mj_name2id(model_, mjOBJ_BODY, body_name(i).c_str());
            ids_.push_back(id);
            mjtNum* rates = data_->qvel + model_->body_dofadr[id];
            const LinkJoint* joint = mechanism.parent_joint(i);
            const auto& [q, w, p, v] = mechanism.body(i).start;
            const Vector3<double> angular_velocity = rotate_back(q, joint ? joint->angular_velocity_W : w);
            if (!joint) std::copy_n(&v[0], 3, rates), rates += 3;
            if (!joint || joint->type == "spherical") std::copy_n(&angular_velocity[0], 3, rates);
            if (joint) std::copy(joint->rates.begin(), joint->rates.end(), rates);
        }
    }
    ~MujocoMechanism() {
        mj_deleteData(data_);
        mj_deleteModel(model_);
    }
    MujocoMechanism(const MujocoMechanism&) = delete;
    MujocoMechanism& operator=(const MujocoMechanism&) = delete;

    // updates positions and velocities of the bodies: a step leaves them at their values at its start
    std::vector<Motion> motions() {
        mj_kinematics(model_, data_), mj_comPos(model_, data_), mj_comVel(model_, data_);
        std::vector<Motion> all;
        for (const int id : ids_) {
            const mjtNum *q = data_->xquat + 4 * id, *velocity = data_->cvel + 6 * id;
            const Vector3<double> w = vector_of(velocity), p = vector_of(data_->xipos + 3 * id);
            const Vector3<double> center = vector_of(data_->subtree_com + 3 * model_->body_rootid[id]);
            all.push_back({{q[0], q[1], q[2], q[3]}, w, p, vector_of(velocity + 3) + cross(w, p - center)});
        }
        return all;
    }
    void apply(int index, const Vector3<double>& force, const Vector3<double>& torque) {
        mjtNum* const to = data_->xfrc_applied + 6 * ids_[std::size_t(index)];
        std::copy_n(&force[0], 3, to), std::copy_n(&torque[0], 3, to + 3);
    }
    void step(double h) {
        if (is_stiff_) stiffen(model_, h);
        forces_.enter_step(h);
        for (const JointMotor& motor : mechanism_.motors) {
            const int id = mj_name2id(model_, mjOBJ_JOINT, joint_name(motor.joint).c_str());
            data_->qfrc_applied[model_->jnt_dofadr[id]] = forces_.motor_force(motor.joint);
        }
        advance(model_, data_, h);
    }

  private:
    const Mechanism& mechanism_;
    JointForces forces_;
    bool is_stiff_;
    mjModel* model_ = nullptr;
    mjData* data_ = nullptr;
    std::vector<int> ids_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    mju_user_error = throw_error;
    // otherwise MuJoCo writes a log file into the current directory
    mju_user_warning = [](const char*) {};
    return serve<MujocoWorld, MujocoMechanism>(
        {"mujoco",
         mj_versionString(),
         "binary64",
         {{"default", "integrator Euler: semi-implicit, gyroscopic term explicit; no damping; pyramidal friction cone"},
          {"elliptic", "as default, with the elliptic friction cone"},
          {"implicit", "integrator implicit"},
          {"rk4", "integrator RK4"},
          {"stiff",
           "as implicit, with limits, friction and couplings of joints as stiff as MuJoCo permits at the step: "
           "solref 2 h, solimp 0.9999"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {"revolute", "spherical"},
         {"ball", "capsule", "cylinder", "disc", "ellipsoid", "box", "several"},
         false,
         {"limits", "friction", "armature", "springs", "motors", "couplings"}});
}
