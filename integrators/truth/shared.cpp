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
using Many = Real<200>;

// Largest error noted; infinite if a value is NaN or infinite.
class Worst {
  public:
    void note(const Many& off) {
        double size = std::numeric_limits<double>::infinity();
        if (is_finite(off)) size = std::abs(off.convert_to<double>());
        worst_ = std::max(worst_, size);
    }
    template <class P>
    void note(const P& found, const Many& right) {
        const Many off = Many(found) - right;
        if (off != 0) note(right == 0 ? off : Many(off / right));
    }
    template <class P>
    void note(const Vector3<P>& found, const Vector3<Many>& right) {
        const Many off = length(cast<Many>(found) - right), size = length(right);
        if (off != 0) note(size == 0 ? off : Many(off / size));
    }
    template <class P>
    void note(const Quaternion<P>& found, const Quaternion<Many>& right) {
        note(Many(2 * length(vector_part(conjugate(right) * cast<Many>(found)))));
    }
    template <class P>
    void note(const Matrix3<P>& found, const Matrix3<Many>& right) {
        Many off(0), size(0);
        for (int i = 0; i < 3; ++i)
            off = larger(off, length(cast<Many>(found[i]) - right[i])), size = larger(size, length(right[i]));
        if (off != 0) note(size == 0 ? off : Many(off / size));
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
void note_tensor(const Matrix3<P>& found, const Matrix3<Many>& right, Worst& worst) {
    worst.note(found, right);
    worst.note(inverse(found), inverse(right));
    const std::vector<Vector3<P>> turned = gyroscopic_accelerations(found);
    const std::vector<Vector3<Many>> rightly = gyroscopic_accelerations(right);
    for (std::size_t i = 0; i < turned.size(); ++i) worst.note(Many(length(cast<Many>(turned[i]) - rightly[i])));
}

template <class P>
void note_body(const Scene& scene, Worst& worst) {
    const ExactBody<P> found = exact_body<P>(scene);
    const ExactBody<Many> right = exact_body<Many>(scene);
    worst.note(found.mass, right.mass);
    worst.note(found.center, right.center);
    worst.note(found.arm, right.arm);
    note_tensor(found.inertia_B, right.inertia_B, worst);
    worst.note(found.q, right.q);
    worst.note(found.angular_velocity_B, right.angular_velocity_B);
    worst.note(found.position_W, right.position_W);
    worst.note(found.velocity_W, right.velocity_W);
}

template <class P>
Motions<P> start(const TreeForm<P>& form) {
    std::vector<P> y(static_cast<std::size_t>(form.dimension()));
    form.initial(y.data());
    return form.motion(y.data());
}

template <class P>
void note_bodies(const Scene& scene, Worst& worst) {
    const std::vector<MassProperties<P>> found = bodies_mass_properties<P>(scene);
    const std::vector<MassProperties<Many>> right = bodies_mass_properties<Many>(scene);
    for (std::size_t i = 0; i < found.size(); ++i) {
        worst.note(found[i].mass, right[i].mass);
        worst.note(found[i].center, right[i].center);
        // the inverse of the tensor of a rod or a point mass is not used
        if (has_three_moments(right[i].inertia))
            note_tensor(found[i].inertia, right[i].inertia, worst);
        else
            worst.note(found[i].inertia, right[i].inertia);
    }
    const Motions<P> begun = start(TreeForm<P>(scene));
    const Motions<Many> rightly = start(TreeForm<Many>(scene));
    // compared like motions: lengths relative to the largest of all bodies
    Difference<Many> difference(natural_sizes<Many>(scene));
    for (std::size_t i = 0; i < begun.size(); ++i) difference.note(cast<Many>(begun[i]), rightly[i]);
    worst.note(Many(difference.worst()));
}

}  // namespace

template <unsigned working>
double shared_rounding(const Scene& scene) {
    // rounding error of each step, with a margin for sums of many terms
    const double usual = std::pow(10.0, 4 - static_cast<double>(working));
    Worst worst;
    if (is_mechanism(scene))
        note_bodies<Real<working>>(scene, worst);
    else
        note_body<Real<working>>(scene, worst);
    return worst.worst() > usual ? worst.worst() : 0;
}

template double shared_rounding<50>(const Scene&);
template double shared_rounding<100>(const Scene&);

double shared_error(double rounding, double radians, double difference, unsigned working, double local_digits) {
    if (rounding == 0) return 0;
    const double path = 1 + radians;
    // error of the steps without growth; difference / of_steps is the growth factor of the motion
    const double of_steps =
        std::max(std::pow(10.0, -local_digits), path * std::pow(10.0, -static_cast<double>(working)));
    return rounding * path * std::max(path, difference / of_steps);
}

}  // namespace polhode::truth
