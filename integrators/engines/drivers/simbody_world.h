// Interface to Simbody with plain numbers, because its headers compile only as C++17.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace polhode::engines {

/// Initial state of the body and the driver's setting.
struct SimbodyStart {
    double mass;
    double moments[3], q[4], w[3], p[3], v[3], gravity[3];
    bool pivoted;
    double pivot[3];  ///< body axes
    std::string setting;
};

class SimbodySystem {
  public:
    explicit SimbodySystem(const SimbodyStart& start);
    ~SimbodySystem();

    /// Writes q, w, p and v.
    void motion(double (&numbers)[13]) const;
    void set_velocities(const double* w, const double* v);
    void set_gravity(const double* gravity);
    void apply(const double* force, const double* torque);
    void step(double h);
    double mass() const;
    void moments(double* three) const;
    static std::string version();

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// Initial state of a body of a mechanism.
struct SimbodyLink {
    double mass;
    double moments[3], motion[13];  ///< motion: q, w, p and v
};

/// A joint or the closure of a loop, with a frame in each body; the frames coincide at the start. Revolute joints
/// rotate about z, prismatic joints move along x, universal joints rotate about x, then y.
struct SimbodyJoint {
    std::string type;
    int parent, child;  ///< indices; -1: the world
    double parent_point[3], child_point[3], parent_frame[4], child_frame[4];
};

struct SimbodyMechanismStart {
    std::vector<SimbodyLink> links;
    std::vector<SimbodyJoint> joints, loops;  ///< one joint per body, "free" for free bodies; parents first
    double gravity[3];
    std::string setting;
};

class SimbodyMechanismSystem {
  public:
    explicit SimbodyMechanismSystem(const SimbodyMechanismStart& start);
    ~SimbodyMechanismSystem();

    /// Writes 13 numbers per body: q, w, p and v.
    void motions(double* numbers) const;
    /// Sets the force at the centre of mass of a body and the torque, world axes.
    void apply(int body, const double* force, const double* torque);
    void step(double h);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace polhode::engines
