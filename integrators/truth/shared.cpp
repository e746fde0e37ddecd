#include "integrators/truth/shared.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "integrators/series/real.h"
#include "integrators/truth/compare.h"
#include "integrators/truth/tree_form.h"
#include "motion/exact_body_of.h"

namespace polhode::truth {
namespace {

// scenes that pass validation lose at most about 60 digits
using Exact = Real<200>;

// Largest error noted; infinite if a value is NaN or infinite.
class LargestError {
  public:
    void add(const Exact& off) {
        double size = std::numeric_limits<double>::infinity();
        if (is_finite(off)) size = std::abs(off.convert_to<double>());
        worst_ = std::max(worst_, size);
    }
    template <class P>
    void add(const P& found, const Exact& exact) {
        const Exact off = Exact(found) - exact;
        if (off != 0) add(exact == 0 ? off : Exact(off / exact));
    }
    template <class P>
    void add(const Vector3<P>& found, const Vector3<Exact>& exact) {
        const Exact off = length(cast<Exact>(found) - exact), size = length(exact);
        if (off != 0) add(size == 0 ? off : Exact(off / size));
    }
    template <class P>
    void add(const Quaternion<P>& found, const Quaternion<Exact>& exact) {
        add(Exact(2 * length(vector_part(conjugate(exact) * cast<Exact>(found)))));
    }
    template <class P>
    void add(const Matrix3<P>& found, const Matrix3<Exact>& exact) {
        Exact off(0), size(0);
        for (int i = 0; i < 3; ++i)
            off = larger(off, length(cast<Exact>(found[i]) - exact[i])), size = larger(size, length(exact[i]));
        if (off != 0) add(size == 0 ? off : Exact(off / size));
    }
    double worst() const { return worst_; }

  private:
    double worst_ = 0;
};

// I^-1 (a x Ib + b x Ia) for unit rotations about each axis and about each pair of axes
template <class P>
std::vector<Vector3<P>> gyroscopic_accelerations(const Matrix3<P>& inertia) {
    const Matrix3<P> inverse_inertia = inverse(inertia);
    std::vector<Vector3<P>> all;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) {
            Vector3<P> a, b;
            a[i] = P(1), b[j] = P(1);
            all.push_back(inverse_inertia * (cross(a, inertia * b) + cross(b, inertia * a)));
        }
    return all;
}

template <class P>
void add_tensor(const Matrix3<P>& found, const Matrix3<Exact>& exact, LargestError& worst) {
    worst.add(found, exact);
    worst.add(inverse(found), inverse(exact));
    const std::vector<Vector3<P>> computed = gyroscopic_accelerations(found);
    const std::vector<Vector3<Exact>> expected = gyroscopic_accelerations(exact);
    for (std::size_t i = 0; i < computed.size(); ++i) worst.add(Exact(length(cast<Exact>(computed[i]) - expected[i])));
}

template <class P>
void add_body(const Scene& scene, LargestError& worst) {
    const ExactBody<P> found = exact_body<P>(scene);
    const ExactBody<Exact> exact = exact_body<Exact>(scene);
    worst.add(found.mass, exact.mass);
    worst.add(found.center, exact.center);
    worst.add(found.arm, exact.arm);
    add_tensor(found.inertia_B, exact.inertia_B, worst);
    worst.add(found.q, exact.q);
    worst.add(found.angular_velocity_B, exact.angular_velocity_B);
    worst.add(found.position_W, exact.position_W);
    worst.add(found.velocity_W, exact.velocity_W);
}

template <class P>
Motions<P> start(const TreeForm<P>& form) {
    std::vector<P> y(static_cast<std::size_t>(form.dimension()));
    form.initial(y.data());
    return form.motion(y.data());
}

template <class P>
void add_bodies(const Scene& scene, LargestError& worst) {
    const std::vector<MassProperties<P>> found = bodies_mass_properties<P>(scene);
    const std::vector<MassProperties<Exact>> exact = bodies_mass_properties<Exact>(scene);
    for (std::size_t i = 0; i < found.size(); ++i) {
        worst.add(found[i].mass, exact[i].mass);
        worst.add(found[i].center, exact[i].center);
        // the inverse of the tensor of a rod or a point mass is not used
        if (has_three_moments(exact[i].inertia))
            add_tensor(found[i].inertia, exact[i].inertia, worst);
        else
            worst.add(found[i].inertia, exact[i].inertia);
    }
    const Motions<P> computed = start(TreeForm<P>(scene));
    const Motions<Exact> expected = start(TreeForm<Exact>(scene));
    // compared like motions: lengths relative to the largest of all bodies
    Difference<Exact> difference(natural_sizes<Exact>(scene));
    for (std::size_t i = 0; i < computed.size(); ++i) difference.add(cast<Exact>(computed[i]), expected[i]);
    worst.add(Exact(difference.worst()));
}

}  // namespace

template <unsigned working>
double shared_rounding(const Scene& scene) {
    // rounding error of each step, with a margin for sums of many terms
    const double usual = std::pow(10.0, 4 - static_cast<double>(working));
    LargestError worst;
    if (is_mechanism(scene))
        add_bodies<Real<working>>(scene, worst);
    else
        add_body<Real<working>>(scene, worst);
    return worst.worst() > usual ? worst.worst() : 0;
}

template double shared_rounding<50>(const Scene&);
template double shared_rounding<100>(const Scene&);

double shared_error(double rounding, double radians, double difference, unsigned working, double local_digits) {
    if (rounding == 0) return 0;
    const double path = 1 + radians;
    // error of the steps without growth; difference / step_error is the growth factor of the motion
    const double step_error =
        std::max(std::pow(10.0, -local_digits), path * std::pow(10.0, -static_cast<double>(working)));
    return rounding * path * std::max(path, difference / step_error);
}

}  // namespace polhode::truth
