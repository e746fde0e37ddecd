// Each mode starts IDA with consistent multipliers. States within a step come from its interpolating polynomial.
#include "integrators/sundials/ida_mode_steps.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "integrators/contact/constrained_joint_form.h"
#include "integrators/contact/mode_steps.h"
#include "integrators/sundials/ida_solver.h"

namespace polhode {
namespace {

using contact::ConstrainedJointForm;

class IdaModeSteps : public SystemSteps {
  public:
    IdaModeSteps(const ConstrainedJointForm& form, std::vector<double> start, maximal::Index index, double tolerance)
        : form_(&form),
          start_(std::move(start)),
          state_(start_),
          mode_(form.mode(index, start_.data())),
          solver_(mode_.system(), mode_.equations(), form.scales(), tolerance,
                  [this](double s) { mode_.set_time(s); }) {
        std::copy_n(start_.begin(), form.bodies_dimension(), solver_.unknowns());
        solver_.set_state(0);
        flag_ = solver_.start_from_event();
    }

    double step(double longest) override {
        constexpr int standstill = 100;
        begin_ = solver_.time();
        const double end = begin_ + longest;
        if (flag_ >= 0) flag_ = solver_.set_stop(end);
        // flags below zero are errors
        for (int i = 0; i < standstill && flag_ >= 0; ++i) {
            flag_ = solver_.step();
            if (flag_ >= 0 && solver_.time() > begin_) {
                read(solver_.unknowns(), solver_.time(), state_.data());
                return solver_.time() == end ? longest : solver_.time() - begin_;
            }
        }
        return 0;
    }
    std::string fault() override {
        if (solver_.not_finite_at()) return "the right-hand side is not finite";
        return flag_ < 0 ? solver_.reason(flag_) : "IDA does not advance";
    }
    const double* state() override { return state_.data(); }
    int dense_degree() override { return solver_.last_order(); }
    void inside(double s, double* y) override { read(solver_.inside(begin_ + s), begin_ + s, y); }
    long evaluations() override { return solver_.evaluations(); }

  private:
    const ConstrainedJointForm* form_;
    std::vector<double> start_, state_;
    contact::ConstrainedMode mode_;
    IdaSolver solver_;
    double begin_ = 0;
    int flag_ = 0;

    // the state of the form at s after the start of the mode, from the unknowns z
    void read(const double* z, double s, double* y) {
        std::copy(start_.begin(), start_.end(), y);
        std::copy_n(z, form_->bodies_dimension(), y);
        form_->read_coordinates(mode_.equations(), z, y);
        form_->set_time(s, start_.data(), y);
    }
};

std::unique_ptr<SystemSteps> make_ida_mode_steps(const Problem& problem, double tolerance, maximal::Index index) {
    const auto model = problem.model();
    const auto* mode = dynamic_cast<const contact::ModeModel<ConstrainedJointForm>*>(model.get());
    if (!mode) throw std::logic_error("IDA steps only in maximal coordinates");
    std::vector<double> start(static_cast<std::size_t>(mode->dimension()));
    mode->initial(start.data());
    return std::make_unique<IdaModeSteps>(mode->form(), std::move(start), index, tolerance);
}

}  // namespace

std::unique_ptr<SystemSteps> make_ida_index1_steps(const Problem& problem, double tolerance) {
    return make_ida_mode_steps(problem, tolerance, maximal::Index::one);
}

std::unique_ptr<SystemSteps> make_ida_index2_steps(const Problem& problem, double tolerance) {
    return make_ida_mode_steps(problem, tolerance, maximal::Index::two);
}

}  // namespace polhode
