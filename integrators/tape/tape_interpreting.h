// The interpreter's source, compiled for each set of instructions by a file of its own. Nothing here may become a
// function that those files share: the linker would keep one, of instructions that not every processor has.
#include "integrators/tape/tape_interpreter.h"

namespace polhode {
namespace {

double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }

void operate(const TapeProgram::Operation* at, const TapeProgram::Operation* end, double* x) {
    using Kind = TapeProgram::Kind;
    for (; at != end; ++at) {
        const double a = x[at->a];
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
        }
    }
}

template <int lanes>
void add_lanes(double x, const double* __restrict y, double* __restrict sum) {
    for (int j = 0; j < lanes; ++j) sum[j] = fused(x, y[j], sum[j]);
}

// what the newest order m adds to the sums of later orders
template <int lanes>
void add_products(const TapeProgram& program, const TapeLayout& layout, int m, const double* states, double* memory) {
    double* const rows = memory + layout.rows;
    const int row_count = static_cast<int>(program.rows.size()), sum_count = static_cast<int>(program.sums.size());
    const auto newest = [&](int row) {
        const int slot = program.rows.data()[row];
        return slot < program.states ? states[slot] : memory[slot];
    };
    if (m <= lanes)
        for (int r = 0; r < row_count; ++r) rows[r * layout.lanes + m - 1] = newest(r);
    double* sum = memory + layout.sums;
    for (int s = 0; s < sum_count; ++s, sum += layout.lanes) {
        const TapeProgram::Sum& of = program.sums.data()[s];
        double p[lanes], u[lanes];
        // those that have begun; both of j < m, one of j = m
        for (int j = 0; j < lanes; ++j) p[j] = j < m - 2 ? sum[j] : 0.0;
        const TapeProgram::Pair& head = program.pairs.data()[of.first];
        add_lanes<lanes>(newest(head.x), rows + head.y * layout.lanes, p);
        for (int j = 0; j < lanes; ++j) u[j] = newest(head.y) * rows[head.x * layout.lanes + j];
        for (int i = of.first + 1; i < of.end; ++i) {
            const TapeProgram::Pair& pair = program.pairs.data()[i];
            double x_m = newest(pair.x), y_m = newest(pair.y);
            if (pair.weight != TapeProgram::none) x_m *= memory[pair.weight], y_m *= memory[pair.weight];
            if (pair.negative) x_m = -x_m, y_m = -y_m;
            add_lanes<lanes>(x_m, rows + pair.y * layout.lanes, p);
            add_lanes<lanes>(y_m, rows + pair.x * layout.lanes, u);
        }
        for (int j = 0; j < lanes; ++j) p[j] = j < m - 1 ? p[j] + u[j] : p[j];
        memory[of.to] = p[0];
        for (int j = 1; j < lanes; ++j) sum[j - 1] = p[j];
    }
}

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

void expand(const TapeProgram& program, const TapeLayout& layout, bool careful, double* memory) {
    const auto run = [memory](const auto& list) { operate(list.data(), list.data() + list.size(), memory); };
    double* coefficients = memory + layout.coefficients;
    for (int i = 0; i < program.states; ++i) coefficients[i] = memory[program.values.data()[i]];
    begin_order(program, 0, memory);
    run(program.begin);
    integrate(program, program.first_rates.data(), careful, memory, coefficients += layout.states);
    for (int k = 1; k < layout.order; ++k) {
        const double* const before = coefficients - layout.states;
        const int filled = k == 1 ? 0 : layout.filled(k - 1);
        if (filled == 0)
            for (int s = 0, n = static_cast<int>(program.sums.size()); s < n; ++s) memory[program.sums.data()[s].to] = 0;
        else if (filled <= TapeLayout::line)
            add_products<TapeLayout::line>(program, layout, k - 1, before, memory);
        else
            add_products<2 * TapeLayout::line>(program, layout, k - 1, before, memory);
        begin_order(program, k, memory);
        run(program.step);
        integrate(program, program.rates.data(), careful, memory, coefficients += layout.states);
    }
}

}  // namespace
}  // namespace polhode
