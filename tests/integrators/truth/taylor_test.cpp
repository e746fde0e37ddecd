// The truth's Taylor series for states whose size is known only at run time.
#include "integrators/truth/taylor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "integrators/truth/euler_form.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using P = Real<50>;
using Form = truth::EulerForm<P>;

/// Independent bodies, one state after the other.
class SideBySide {
  public:
    explicit SideBySide(const std::vector<Scene>& scenes) {
        for (const Scene& scene : scenes) forms_.emplace_back(scene);
    }
    int dimension() const {
        int sum = 0;
        for (const Form& form : forms_) sum += form.dimension();
        return sum;
    }
    void initial(P* y) const {
        each([&](const Form& form, int first) { form.initial(y + first); });
    }
    void enter(double begin, P* y) {
        int first = 0;
        for (Form& form : forms_) form.enter(begin, y + first), first += form.dimension();
    }
    template <class S>
    void derivative(const S* y, S* dy) const {
        each([&](const Form& form, int first) { form.derivative(y + first, dy + first); });
    }
    std::vector<truth::Motion<P>> motion(const P* y) const {
        std::vector<truth::Motion<P>> bodies;
        each([&](const Form& form, int first) { bodies.push_back(form.motion(y + first)); });
        return bodies;
    }
    std::vector<truth::Block> blocks(const std::vector<Problem>& problems) const {
        std::vector<truth::Block> all;
        std::size_t i = 0;
        each([&](const Form& form, int first) {
            const Problem& problem = problems[i++];
            for (truth::Block block : form.blocks(problem.scales, problem.body.principal.moments))
                block.first += first, all.push_back(block);
        });
        return all;
    }

  private:
    std::vector<Form> forms_;

    template <class Visit>
    void each(Visit&& visit) const {
        int first = 0;
        for (const Form& form : forms_) visit(form, first), first += form.dimension();
    }
};

// Each body alone takes longer steps than all together, at the same local error of 1e-32 of each block's scale. Over
// several hundred steps of motions that lose less than three digits in 3 s, the two agree to 25 digits. Their errors
// are independent, so digits in agreement are correct in both.
TEST(TruthTaylor, BodiesSideBySideMoveAsEachDoesAlone) {
    std::vector<Scene> scenes;
    std::vector<Problem> problems;
    for (const char* name : {"free_asymmetric", "lagrange_top", "damped_spin"}) {
        scenes.push_back(find_scene(name));
        scenes.back().duration = 3;
        problems.push_back(pose(scenes.back()));
    }
    const std::vector<double> times = sample_times(3, 4);
    const truth::TaylorSettings settings{36, 32, 1, 100'000};
    const SideBySide form(scenes);
    ASSERT_EQ(form.dimension(), 13 + 7 + 13);
    const auto all = truth::taylor<P>(form, itinerary(scenes[0]), times, form.blocks(problems), settings);
    ASSERT_EQ(all.fault, "");
    ASSERT_EQ(all.motions.size(), times.size());
    for (std::size_t body = 0; body < scenes.size(); ++body) {
        const Problem& problem = problems[body];
        const auto alone =
            truth::taylor<P, Form>(scenes[body], times, problem.scales, problem.body.principal.moments, settings);
        ASSERT_EQ(alone.fault, "");
        EXPECT_LE(alone.steps, all.steps);
        for (std::size_t k = 0; k < times.size(); ++k) {
            const truth::Motion<P>&a = alone.motions[k], &b = all.motions[k][body];
            for (int i = 0; i < 3; ++i) {
                EXPECT_LT(abs(a.angular_velocity_B[i] - b.angular_velocity_B[i]),
                          P(1e-25) * problem.scales.angular_velocity)
                    << scenes[body].name;
                EXPECT_LT(abs(a.position_W[i] - b.position_W[i]), P(1e-25) * problem.scales.position);
            }
            const Quaternion<P> d = conjugate(a.q) * b.q;
            EXPECT_LT(abs(d.x) + abs(d.y) + abs(d.z), P(1e-25)) << scenes[body].name;
        }
    }
}

TEST(TruthTaylor, EndsWhereItWouldTakeMoreStepsThanAreAllowed) {
    const Scene scene = find_scene("free_asymmetric");
    const Problem problem = pose(scene);
    const auto run = truth::taylor<P, Form>(scene, {0, scene.duration}, problem.scales, problem.body.principal.moments,
                                            {36, 32, 1, 3});
    EXPECT_EQ(run.fault, "the step limit is reached");
}

}  // namespace
}  // namespace polhode
