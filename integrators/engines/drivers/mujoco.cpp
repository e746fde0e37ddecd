// MuJoCo: a body with a free joint, or with a ball joint at its pivot.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cstring>

#include "integrators/engines/drivers/serve.h"

namespace polhode::engines {
namespace {

std::string text(const Vector3<double>& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v[0], v[1], v[2]); }

// MuJoCo stops the program at an error.
[[noreturn]] void give_up(const char* message) { throw std::runtime_error(message); }

class MujocoWorld {
  public:
    explicit MujocoWorld(const Body& body) : pivot_(body.pivot) {
        if (!body.planes.empty()) throw Unsupported("MuJoCo's contacts know no coefficient of restitution");
        const char* integrator = body.setting == "rk4"            ? "RK4"
                                 : body.setting == "implicit"     ? "implicit"
                                 : body.setting == "implicitfast" ? "implicitfast"
                                                                  : "Euler";
        const std::string joint =
            body.pivot ? fmt::format(R"(<joint type="ball" pos="{}"/>)", text(*body.pivot)) : "<freejoint/>";
        const std::string xml = fmt::format(
            R"(<mujoco><option gravity="{}" integrator="{}"/><worldbody><body pos="{}">{}<inertial pos="0 0 0" )"
            R"(mass="{:.17g}" diaginertia="{}"/></body></worldbody></mujoco>)",
            text(body.gravity), integrator, text(body.pivot ? -*body.pivot : body.p), joint, body.mass,
            text(body.moments));
        load(xml);
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
        model_->opt.timestep = h;
        mj_step(model_, data_);
        // MuJoCo answers a bad state by starting anew, with a warning
        if (data_->warning[mjWARN_BADQPOS].number + data_->warning[mjWARN_BADQVEL].number +
                data_->warning[mjWARN_BADQACC].number >
            0)
            throw std::runtime_error("MuJoCo found its state to be bad and began anew");
        for (int i = 6; i < 12; ++i) data_->xfrc_applied[i] = 0;
    }
    double mass() const { return model_->body_mass[1]; }
    Vector3<double> moments() const { return vector_of(model_->body_inertia + 3); }

  private:
    int first_q() const { return pivot_ ? 0 : 3; }
    int first_w() const { return pivot_ ? 0 : 3; }
    void load(const std::string& xml) {
        const auto files = std::make_unique<mjVFS>();
        mj_defaultVFS(files.get());
        char error[300] = "";
        mj_makeEmptyFileVFS(files.get(), "body.xml", int(xml.size()));
        std::memcpy(files->filedata[0], xml.data(), xml.size());
        model_ = mj_loadXML("body.xml", files.get(), error, sizeof error);
        mj_deleteVFS(files.get());
        if (!model_) throw std::runtime_error(error);
        data_ = mj_makeData(model_);
    }

    std::optional<Vector3<double>> pivot_;
    mjModel* model_ = nullptr;
    mjData* data_ = nullptr;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    mju_user_error = give_up;
    // else it writes a log file where it happens to be
    mju_user_warning = [](const char*) {};
    return serve<MujocoWorld>({"mujoco",
                               mj_versionString(),
                               "binary64",
                               {{"default", "its Euler: semi-implicit, the gyroscopic term explicit; no damping"},
                                {"implicit", "its integrator \"implicit\""},
                                {"rk4", "its integrator \"RK4\""}}});
}
