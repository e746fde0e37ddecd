// The interpreter's source, compiled for each set of instructions by a file of its own. Nothing here may become a
// function that those files share: the linker would keep one, of instructions that not every processor has.
#include "integrators/tape/tape_interpreter.h"

namespace polhode {
namespace {

double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }

template <int lanes>
void add_lanes(double x, const double* __restrict y, double* __restrict sum) {
    for (int j = 0; j < lanes; ++j) sum[j] = fused(x, y[j], sum[j]);
}

/// One order's work on memory: `states` are the coefficients of the order before.
template <int lanes>
class Order {
  public:
    Order(const TapeProgram& program, const TapeLayout& layout, int k, const double* states, double* memory)
        : program_(program), layout_(layout), k_(k), states_(states), memory_(memory) {}

    void find_inner_sums() {
        for (int i = 0; i < program_.inner; ++i)
            if (k_ > 1)
                add_products(i, k_ - 2);
            else
                memory_[program_.sums.data()[i].to] = 0;
    }
    void operate(const TapeProgram::Operation* at, const TapeProgram::Operation* end) {
        using Kind = TapeProgram::Kind;
        double* const x = memory_;
        for (; at != end; ++at) {
            const double a = at->kind == Kind::sum ? 0 : x[at->a];
            double& to = x[at->to];
            switch (at->kind) {
                case Kind::add:
                    to = a + x[at->b];
                    break;
                case Kind::subtract:
                    to = a - x[at->b];
                    break;
                case Kind::multiply:
                    to = a * x[at->b];
                    break;
                case Kind::product_plus:
                    to = fused(a, x[at->b], x[at->c]);
                    break;
                case Kind::product_minus:
                    to = fused(a, x[at->b], -x[at->c]);
                    break;
                case Kind::minus_product:
                    to = fused(-a, x[at->b], x[at->c]);
                    break;
                case Kind::minus_product_minus:
                    to = fused(-a, x[at->b], -x[at->c]);
                    break;
                case Kind::divide:
                    to = a / x[at->b];
                    break;
                case Kind::root:
                    to = __builtin_sqrt(a);
                    break;
                case Kind::sine_cosine:
                    sine_cosine_of(a, to, x[at->b]);
                    break;
                case Kind::sum:
                    add_products(at->a, k_);
            }
        }
    }

  private:
    const TapeProgram& program_;
    const TapeLayout& layout_;
    int k_;
    const double* states_;
    double* memory_;

    double newest(int row) const {
        const TapeProgram::Row& of = program_.rows.data()[row];
        return of.is_inner() && of.slot < program_.states ? states_[of.slot] : memory_[of.slot];
    }
    /// The row, with its newest coefficient in the lane.
    double* lanes_of(int row, int lane) const {
        double* const at = memory_ + layout_.rows + static_cast<std::size_t>(row) * layout_.lanes;
        if (lane < lanes) at[lane] = newest(row);
        return at;
    }
    // what the newest order, in that lane, adds to a sum of this and of later orders
    void add_products(int which, int lane) {
        double* const sum = memory_ + layout_.sums + static_cast<std::size_t>(which) * layout_.lanes;
        const TapeProgram::Sum& of = program_.sums.data()[which];
        double p[lanes], u[lanes];
        // those that have begun; both of j < lane, one of j = lane
        for (int j = 0; j < lanes; ++j) p[j] = j < lane - 1 ? sum[j] : 0.0;
        const TapeProgram::Pair& head = program_.pairs.data()[of.first];
        const double *x = lanes_of(head.x, lane), *y = lanes_of(head.y, lane);
        add_lanes<lanes>(newest(head.x), y, p);
        for (int j = 0; j < lanes; ++j) u[j] = newest(head.y) * x[j];
        for (int i = of.first + 1; i < of.end; ++i) {
            const TapeProgram::Pair& pair = program_.pairs.data()[i];
            x = lanes_of(pair.x, lane), y = lanes_of(pair.y, lane);
            double x_m = newest(pair.x), y_m = newest(pair.y);
            if (pair.weight != TapeProgram::none) x_m *= memory_[pair.weight], y_m *= memory_[pair.weight];
            if (pair.negative) x_m = -x_m, y_m = -y_m;
            add_lanes<lanes>(x_m, y, p);
            add_lanes<lanes>(y_m, x, u);
        }
        for (int j = 0; j < lanes; ++j) p[j] = j < lane ? p[j] + u[j] : p[j];
        memory_[of.to] = p[0];
        for (int j = 1; j < lanes; ++j) sum[j - 1] = p[j];
    }
};

void begin_order(const TapeProgram& program, int k, double* x) {
    if (program.order != TapeProgram::none) x[program.order] = k, x[program.inverse_order] = 1.0 / k;
    x[program.next] = k + 1, x[program.inverse_next] = 1.0 / (k + 1);
}

void integrate(const TapeProgram& program, const TapeProgram::Rate* rates, bool careful, double* x, double* next) {
    for (int i = 0; i < program.states; ++i) {
        double rate = x[rates[i].from];
        if (rates[i].factor != TapeProgram::none) rate *= x[rates[i].factor];
        x[i] = next[i] = careful ? rate / x[program.next] : rate * x[program.inverse_next];
    }
}

template <int lanes>
void expand_order(const TapeProgram& program, const TapeLayout& layout, int k, const double* states, double* memory) {
    Order<lanes> order(program, layout, k, states, memory);
    order.find_inner_sums();
    order.operate(program.step.data(), program.step.data() + program.step.size());
}

void expand(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory) {
    constexpr int line = TapeLayout::line;
    double* coefficients = memory + layout.coefficients;
    for (int i = 0; i < program.states; ++i) coefficients[i] = memory[program.values.data()[i]];
    begin_order(program, 0, memory);
    Order<line>(program, layout, 0, coefficients, memory)
        .operate(program.begin.data(), program.begin.data() + program.begin.size());
    for (std::size_t r = 0, n = program.rows.size(); r < n; ++r) {
        const TapeProgram::Row& row = program.rows.data()[r];
        if (!row.is_inner()) memory[layout.rows + r * layout.lanes] = memory[row.value];
    }
    integrate(program, program.first_rates.data(), careful, memory, coefficients += layout.states);
    for (int k = 1; k < layout.order; ++k) {
        const auto work = layout.filled(k) <= line ? expand_order<line> : expand_order<2 * line>;
        begin_order(program, k, memory);
        work(program, layout, k, coefficients - layout.states, memory);
        integrate(program, program.rates.data(), careful, memory, coefficients += layout.states);
    }
}

void find_rates_of(const TapeProgram& program, double* memory, const double* y, double* rates) {
    using Kind = TapeProgram::Kind;
    constexpr int line = TapeLayout::line;
    const auto at = [memory](int slot) { return memory + static_cast<std::size_t>(slot) * line; };
    for (int i = 0; i < program.states * line; ++i) at(program.values.data()[0])[i] = y[i];
    const TapeProgram::Operation* const list = program.begin.data();
    for (std::size_t n = 0; n < program.begin.size(); ++n) {
        const TapeProgram::Operation& op = list[n];
        const double* const a = at(op.a);
        const double* const b = op.b == TapeProgram::none ? a : at(op.b);
        const double* const c = op.c == TapeProgram::none ? a : at(op.c);
        double* const to = at(op.to);
        switch (op.kind) {
            case Kind::add:
                for (int i = 0; i < line; ++i) to[i] = a[i] + b[i];
                break;
            case Kind::subtract:
                for (int i = 0; i < line; ++i) to[i] = a[i] - b[i];
                break;
            case Kind::multiply:
                for (int i = 0; i < line; ++i) to[i] = a[i] * b[i];
                break;
            case Kind::product_plus:
                for (int i = 0; i < line; ++i) to[i] = fused(a[i], b[i], c[i]);
                break;
            case Kind::product_minus:
                for (int i = 0; i < line; ++i) to[i] = fused(a[i], b[i], -c[i]);
                break;
            case Kind::minus_product:
                for (int i = 0; i < line; ++i) to[i] = fused(-a[i], b[i], c[i]);
                break;
            case Kind::minus_product_minus:
                for (int i = 0; i < line; ++i) to[i] = fused(-a[i], b[i], -c[i]);
                break;
            case Kind::divide:
                for (int i = 0; i < line; ++i) to[i] = a[i] / b[i];
                break;
            case Kind::root:
                for (int i = 0; i < line; ++i) to[i] = __builtin_sqrt(a[i]);
                break;
            case Kind::sine_cosine:
                sines_cosines_of_eight(a, to, at(op.b));
                break;
            case Kind::sum:
                break;
        }
    }
    for (int i = 0; i < program.states; ++i) {
        const TapeProgram::Rate& rate = program.first_rates.data()[i];
        const double* const from = at(rate.from);
        for (int lane = 0; lane < line; ++lane)
            rates[i * line + lane] = rate.factor == TapeProgram::none ? from[lane] : from[lane] * at(rate.factor)[lane];
    }
}

// even and odd degrees beside each other: half the time that each waits for the one before
void sum_states(const double* coefficients, int states, int order, int from, double h, double* sums) {
    constexpr int line = TapeLayout::line;
    const double hh = h * h;
    for (int first = 0; first < states; first += line) {
        const double* const last = coefficients + static_cast<std::size_t>(order) * states + first;
        double even[line], odd[line];
        for (int i = 0; i < line; ++i) even[i] = last[i], odd[i] = last[i - states];
        int k = order - 2;
        for (; k > from; k -= 2) {
            const double* const y = coefficients + static_cast<std::size_t>(k) * states + first;
            for (int i = 0; i < line; ++i) even[i] = fused(even[i], hh, y[i]);
            for (int i = 0; i < line; ++i) odd[i] = fused(odd[i], hh, y[i - states]);
        }
        // of the degree `from`, or of the one after it, is the last of one of the two
        if (k == from) {
            const double* const y = coefficients + static_cast<std::size_t>(k) * states + first;
            for (int i = 0; i < line; ++i) sums[first + i] = fused(odd[i], h, fused(even[i], hh, y[i]));
        } else {
            for (int i = 0; i < line; ++i) sums[first + i] = fused(even[i], h, odd[i]);
        }
    }
}

}  // namespace
}  // namespace polhode
