// MuJoCo: a body with a free joint, or with a ball joint at its pivot; mechanisms as nested bodies.
//
// Models are written as MJCF text and loaded from memory (model_of()). MujocoWorld has one body; MujocoMechanism nests
// each body in its parent and closes loops by "connect" equality constraints. serve.h runs the requests.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cstring>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

std::string text(const Vector3<double>& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v[0], v[1], v[2]); }

// Replaces MuJoCo's error handler, which would end the program.
[[noreturn]] void give_up(const char* message) { throw std::runtime_error(message); }

const char* integrator_of(const std::string& setting) {
    return setting == "rk4"            ? "RK4"
           : setting == "implicit"     ? "implicit"
           : setting == "implicitfast" ? "implicitfast"
                                       : "Euler";
}

// Loads a model from text; the caller creates its data.
mjModel* model_of(const std::string& xml) {
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

class MujocoWorld {
  public:
    explicit MujocoWorld(const Body& body) : pivot_(body.pivot) {
        if (!body.planes.empty()) throw Unsupported("MuJoCo's contacts have no coefficient of restitution");
        const char* integrator = integrator_of(body.setting);
        const std::string joint =
            body.pivot ? fmt::format(R"(<joint type="ball" pos="{}"/>)", text(*body.pivot)) : "<freejoint/>";
        const std::string xml = fmt::format(
            R"(<mujoco><option gravity="{}" integrator="{}"/><worldbody><body pos="{}">{}<inertial pos="0 0 0" )"
            R"(mass="{:.17g}" diaginertia="{}"/></body></worldbody></mujoco>)",
            text(body.gravity), integrator, text(body.pivot ? -*body.pivot : body.p), joint, body.mass,
            text(body.moments));
        model_ = model_of(xml);
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
std::string name_of_body(int index) { return index < 0 ? "world" : fmt::format("b{}", index); }

// The joints of a body. All coordinates are zero in the initial configuration.
std::string joints_text(const LinkJoint* joint) {
    if (!joint) return "<freejoint/>";
    if (joint->type == "fixed") return "";
    const char* type = joint->type == "spherical" ? "ball" : joint->type == "prismatic" ? "slide" : "hinge";
    std::string all;
    for (std::size_t i = 0; i < std::max<std::size_t>(joint->child_axes.size(), 1); ++i)
        all += fmt::format(R"(<joint type="{}" pos="{}"{}/>)", type, text(joint->child_point),
                           joint->child_axes.empty() ? "" : fmt::format(R"( axis="{}")", text(joint->child_axes[i])));
    return all;
}

// A body and all bodies that it carries.
std::string body_text(const Mechanism& known, int index) {
    const LinkJoint* joint = known.carrier(index);
    const LinkBody& body = known.body(index);
    const int parent = joint ? joint->parent : -1;
    const Quaternion<double> up = conjugate(known.attitude(parent)), q = up * body.start.q;
    const Vector3<double> p = parent < 0 ? body.start.p : rotate(up, body.start.p - known.body(parent).start.p);
    std::string all = fmt::format(
        R"(<body name="{}" pos="{}" quat="{:.17g} {:.17g} {:.17g} {:.17g}">{}<inertial pos="0 0 0" mass="{:.17g}" )"
        R"(diaginertia="{}"/>)",
        name_of_body(index), text(p), q.w, q.x, q.y, q.z, joints_text(joint), body.mass, text(body.moments));
    for (const LinkJoint& other : known.joints)
        if (other.parent == index) all += body_text(known, other.child);
    return all + "</body>";
}

// Constraints that close a loop. A hinge constrains two points of its axis.
std::string closure_text(const LinkJoint& loop) {
    std::string all;
    const auto hold = [&](const Vector3<double>& anchor) {
        const bool from_parent = loop.parent >= 0;
        const int first = from_parent ? loop.parent : loop.child, second = from_parent ? loop.child : -1;
        all += fmt::format(R"(<connect body1="{}" {} anchor="{}"/>)", name_of_body(first),
                           second < 0 ? "" : fmt::format(R"(body2="{}")", name_of_body(second)), text(anchor));
    };
    const bool from_parent = loop.parent >= 0;
    const Vector3<double>& point = from_parent ? loop.parent_point : loop.child_point;
    hold(point);
    if (!loop.axes_W.empty()) hold(point + (from_parent ? loop.parent_axes[0] : loop.child_axes[0]));
    return all;
}

class MujocoMechanism {
  public:
    explicit MujocoMechanism(const Mechanism& known) {
        std::string bodies, closures;
        for (int i = 0; i < static_cast<int>(known.bodies.size()); ++i)
            if (const LinkJoint* joint = known.carrier(i); !joint || joint->parent < 0) bodies += body_text(known, i);
        for (const LinkJoint& loop : known.loops) closures += closure_text(loop);
        model_ = model_of(fmt::format(R"(<mujoco><option gravity="{}" integrator="{}"/><worldbody>{}</worldbody>)"
                                      R"(<equality>{}</equality></mujoco>)",
                                      text(known.gravity), integrator_of(known.setting), bodies, closures));
        data_ = mj_makeData(model_);
        for (int i = 0; i < static_cast<int>(known.bodies.size()); ++i) {
            const int id = mj_name2id(model_, mjOBJ_BODY, name_of_body(i).c_str());
            ids_.push_back(id);
            mjtNum* rates = data_->qvel + model_->body_dofadr[id];
            const LinkJoint* joint = known.carrier(i);
            const auto& [q, w, p, v] = known.body(i).start;
            const Vector3<double> turning = rotate_back(q, joint ? joint->turning_W : w);
            if (!joint) std::copy_n(&v[0], 3, rates), rates += 3;
            if (!joint || joint->type == "spherical") std::copy_n(&turning[0], 3, rates);
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
    void step(double h) { advance(model_, data_, h); }

  private:
    mjModel* model_ = nullptr;
    mjData* data_ = nullptr;
    std::vector<int> ids_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    mju_user_error = give_up;
    // otherwise MuJoCo writes a log file into the current directory
    mju_user_warning = [](const char*) {};
    return serve<MujocoWorld, MujocoMechanism>(
        {"mujoco",
         mj_versionString(),
         "binary64",
         {{"default", "integrator Euler: semi-implicit, gyroscopic term explicit; no damping"},
          {"implicit", "integrator implicit"},
          {"rk4", "integrator RK4"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {"revolute", "spherical"}});
}
