// Simbody behind plain numbers: its headers compile only as C++17.
#pragma once

#include <memory>
#include <string>

namespace polhode::engines {

/// How the body starts, and by which of the driver's settings.
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

    /// q, w, p and v.
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

}  // namespace polhode::engines
