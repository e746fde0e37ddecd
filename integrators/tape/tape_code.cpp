// Code generator for tape programs, x86-64 with AVX2 or AVX-512 (asmjit).
//
// The generated series code is one function of the memory block. It performs order 0, then calls one subroutine for
// each later order. There is one subroutine for each number of quarter cache lines that the order's products fill.
// The generated rate code evaluates the order-0 operations for eight states side by side.
//
// TapeCompiler emits the instructions. Before each part it lists all uses of each value. Registers are then assigned
// on the fly: when none is free, the value whose next use is furthest away is evicted (Belady 1966).
#include "integrators/tape/tape_code.h"

#include <asmjit/x86.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <vector>

#include "integrators/tape/tape_interpreter.h"

namespace polhode {
namespace {

namespace x86 = asmjit::x86;
using Kind = TapeProgram::Kind;
constexpr int none = TapeProgram::none;

class TapeCompiler {
  public:
    /// `eight`: the program computes rates, and each number is eight numbers side by side.
    TapeCompiler(const TapeProgram& program, const TapeLayout& layout, bool careful, bool wide, bool eight,
                 asmjit::CodeHolder& holder)
        : eight_(eight),
          program_(program),
          layout_(layout),
          careful_(careful),
          wide_(wide),
          width_(wide ? 8 : 4),
          a_(&holder),
          registers_per_row_(layout.lanes / width_),
          row_count_(static_cast<int>(program.rows.size())),
          register_of_(static_cast<std::size_t>(program.slots + row_count_ * (1 + registers_per_row_)), none),
          lane_is_current_(static_cast<std::size_t>(row_count_), 0),
          persistent_(static_cast<std::size_t>(program.slots), 0) {
        register_count_ = wide ? 32 : 16;
        if (wide && !eight) reserve_registers();
        for (const TapeProgram::Row& row : program.rows) persistent_[row.slot] = 1;
    }

    void write() {
        const asmjit::Label counts = a_.newLabel(), masks = a_.newLabel();
        std::vector<asmjit::Label> parts(static_cast<std::size_t>(layout_.lanes / 4) + 1);
        a_.push(x86::rbx), a_.push(x86::r12), a_.push(x86::r13);
        a_.mov(x86::rbx, x86::rdi);
        a_.lea(x86::r12, x86::ptr(x86::rbx, 8 * static_cast<int>(layout_.coefficients)));
        for (int i = 0; i < program_.states; ++i) {
            a_.vmovsd(x86::xmm0, slot(program_.values[i]));
            a_.vmovsd(x86::ptr(x86::r12, 8 * i), x86::xmm0);
        }
        begin_order(0, counts);
        begin();
        for (int k = 1; k < layout_.order; ++k) {
            begin_order(k, counts);
            const int quarters = k == 1 ? 0 : (layout_.filled(k) + 3) / 4;
            a_.lea(x86::r13, x86::ptr(masks, mask_size() * mask_count() * k));
            if (!parts[quarters].isValid()) parts[quarters] = a_.newLabel();
            a_.call(parts[quarters]);
        }
        a_.vzeroupper();
        a_.pop(x86::r13), a_.pop(x86::r12), a_.pop(x86::rbx);
        a_.ret();
        for (int quarters = 0; quarters <= layout_.lanes / 4; ++quarters) {
            if (!parts[quarters].isValid()) continue;
            a_.align(asmjit::AlignMode::kCode, 32);
            a_.bind(parts[quarters]);
            quarters_ = std::max(quarters, 1);
            step(quarters == 0);
            a_.ret();
        }
        embed(counts, masks);
    }

    void write_rates() {
        // Arguments: memory, start, now, scale, change.
        const std::array argument_registers{x86::rbx, x86::r12, x86::r13, x86::r14, x86::r15};
        const std::array incoming_registers{x86::rdi, x86::rsi, x86::rdx, x86::rcx, x86::r8};
        for (const x86::Gp& r : argument_registers) a_.push(r);
        for (std::size_t i = 0; i < argument_registers.size(); ++i)
            a_.mov(argument_registers[i], incoming_registers[i]);
        const asmjit::Label part = a_.newLabel();
        if (!wide_) {
            a_.sub(x86::rsp, 8);
            a_.call(part);
            for (const x86::Gp& r : argument_registers) a_.add(r, 32);
            a_.call(part);
            a_.add(x86::rsp, 8);
        } else {
            add_eight_rates();
        }
        a_.vzeroupper();
        for (auto r = argument_registers.rbegin(); r != argument_registers.rend(); ++r) a_.pop(*r);
        a_.ret();
        if (wide_) return;
        a_.bind(part);
        add_eight_rates();
        a_.ret();
    }

  private:
    using Register = int;
    static constexpr int free_ = -1, locked_ = -2;

    bool eight_;
    const TapeProgram& program_;
    const TapeLayout& layout_;
    bool careful_, wide_;
    int width_;  ///< numbers per register
    x86::Assembler a_;
    int registers_per_row_;
    int row_count_;
    // Register of each value, or `none`. Ids: the slots, then each row's newest coefficient broadcast to all lanes,
    // then the registers of each row.
    std::vector<Register> register_of_;
    std::vector<char> lane_is_current_;  // by row: the newest coefficient is in its lane
    std::vector<char> persistent_;       // by slot: store the value as soon as it is computed
    // Registers kept from order to order: coefficients by row, newest coefficient by row, sums.
    std::vector<Register> row_registers_, newest_registers_, sum_registers_;
    bool stores_all_ = false;
    int register_count_;
    std::array<int, 32> value_in_{};  // by register: the id of its value
    std::array<bool, 32> dirty_{};    // by register: the value is not in memory
    std::array<bool, 32> in_use_{};   // by register: used by the current instruction
    // Instruction positions of all uses in the current part, grouped by id.
    std::vector<int> first_use_, uses_, next_;
    int quarters_ = 2;    // quarter cache lines that products fill in the current part
    bool inner_ = false;  // the current products belong to P

    int vectors() const { return (4 * quarters_ + width_ - 1) / width_; }
    /// Memory operand of a slot. For states: the coefficient of the current order.
    x86::Mem slot(int i) const {
        if (eight_) return is_start(i) ? x86::ptr(x86::r12, 64 * (i - program_.values[0])) : x86::ptr(x86::rbx, 64 * i);
        return i < program_.states ? x86::ptr(x86::r12, 8 * i) : x86::ptr(x86::rbx, 8 * i);
    }
    // For `eight`: whether slot i is an initial state, and whether its increment `now` must be added.
    bool is_start(int i) const { return eight_ && i >= program_.values[0] && i < program_.values[0] + program_.states; }
    bool is_moving(int i) const { return is_start(i) && program_.first_rates[i - program_.values[0]].from != none; }
    x86::Mem lanes_at(std::size_t base, int which, int vector) const {
        const std::size_t at = base + static_cast<std::size_t>(which) * layout_.lanes + vector * width_;
        return x86::ptr(x86::rbx, static_cast<int>(8 * at));
    }
    /// Register for part `part` of a row or sum. The last part has half the width if that suffices.
    x86::Vec vec(Register r, int part = 0) const {
        return wide_ && quarters_ >= 2 * part + 2 ? x86::Vec(x86::zmm(r)) : x86::Vec(x86::ymm(r));
    }
    /// Register for a number: a scalar, or eight side by side.
    x86::Vec number(Register r) const { return eight_ ? vec(r) : x86::Vec(x86::xmm(r)); }
    std::uint32_t instruction(std::uint32_t alone, std::uint32_t side_by_side) const {
        return eight_ ? side_by_side : alone;
    }
    void load(Register r, const x86::Mem& from) {
        a_.emit(instruction(x86::Inst::kIdVmovsd, x86::Inst::kIdVmovapd), number(r), from);
    }
    void store(const x86::Mem& to, Register r) {
        a_.emit(instruction(x86::Inst::kIdVmovsd, x86::Inst::kIdVmovapd), to, number(r));
    }
    int newest(int row) const { return program_.slots + row; }
    int lanes_of(int row, int vector) const { return program_.slots + row_count_ + row * registers_per_row_ + vector; }

    // --- registers

    /// For small tapes, reserves registers for newest state coefficients, sums and rows. They then stay out of memory
    /// between orders.
    void reserve_registers() {
        constexpr int working = 9, most = 40;
        const auto is_of_state = [this](const TapeProgram::Row& row) {
            return !row.is_inner() && row.slot < program_.states;
        };
        const auto states = std::count_if(program_.rows.begin(), program_.rows.end(), is_of_state);
        if (states + registers_per_row_ * (std::ssize(program_.rows) + std::ssize(program_.sums)) > most) return;
        for (const TapeProgram::Row& row : program_.rows)
            newest_registers_.push_back(is_of_state(row) && register_count_ > working ? --register_count_ : none);
        for (std::vector<Register>* const list : {&sum_registers_, &row_registers_})
            for (std::size_t i = 0; i < (list == &sum_registers_ ? program_.sums.size() : program_.rows.size()); ++i)
                for (int v = 0; v < registers_per_row_ && register_count_ - registers_per_row_ + v >= working; ++v)
                    list->push_back(--register_count_);
    }

    static constexpr int never = std::numeric_limits<int>::max();
    int next_use(int id) const { return next_[id] < first_use_[id + 1] ? uses_[next_[id]] : never; }
    void reset(int ids) {
        value_in_.fill(free_), dirty_.fill(false), in_use_.fill(false);
        std::fill(register_of_.begin(), register_of_.end(), none);
        std::fill(lane_is_current_.begin(), lane_is_current_.end(), 0);
        first_use_.assign(static_cast<std::size_t>(ids) + 1, 0);
    }
    /// Runs the enumeration of uses twice: first to count them, then to record them.
    template <class Enumerate>
    void note_uses(Enumerate&& enumerate) {
        const int ids = static_cast<int>(register_of_.size());
        reset(ids);
        enumerate([&](int id, int) { ++first_use_[id + 1]; });
        for (int i = 0; i < ids; ++i) first_use_[i + 1] += first_use_[i];
        uses_.resize(first_use_[ids]);
        next_.assign(first_use_.begin(), first_use_.end() - 1);
        enumerate([&](int id, int at) { uses_[next_[id]++] = at; });
        next_.assign(first_use_.begin(), first_use_.end() - 1);
    }
    void count_use(int id) { ++next_[id]; }

    Register allocate_register() {
        int best = -1, furthest = -1;
        for (int r = 0; r < register_count_; ++r) {
            if (in_use_[r] || value_in_[r] == locked_) continue;
            if (value_in_[r] == free_) {
                best = r;
                break;
            }
            const int use = next_use(value_in_[r]);
            if (use > furthest) best = r, furthest = use;
        }
        if (value_in_[best] >= 0) evict(best);
        return best;
    }
    void evict(Register r) {
        const int id = value_in_[r];
        if (dirty_[r] && next_use(id) != never) store(slot(id), r);
        register_of_[id] = none, value_in_[r] = free_, dirty_[r] = false;
    }
    Register temporary() {
        const Register r = allocate_register();
        value_in_[r] = locked_;
        return r;
    }
    void release(Register r) { value_in_[r] = free_; }
    void assign_register(Register r, int id, bool dirty) {
        if (register_of_[id] != none && register_of_[id] != r)
            value_in_[register_of_[id]] = free_, dirty_[register_of_[id]] = false;
        value_in_[r] = id, register_of_[id] = r, dirty_[r] = dirty;
    }
    /// Frees the register of a value without further uses.
    void release_if_dead(int id) {
        if (register_of_[id] == none || next_use(id) != never) return;
        value_in_[register_of_[id]] = free_, dirty_[register_of_[id]] = false, register_of_[id] = none;
    }
    Register fetch_scalar(int id) {
        if (register_of_[id] == none) {
            const Register r = allocate_register();
            load(r, slot(id));
            if (is_moving(id)) a_.vaddpd(vec(r), vec(r), x86::ptr(x86::r13, 64 * (id - program_.values[0])));
            assign_register(r, id, false);
        }
        in_use_[register_of_[id]] = true;
        return register_of_[id];
    }
    Register fetch_newest(int row) {
        if (!newest_registers_.empty() && newest_registers_[row] != none) return newest_registers_[row];
        const int id = newest(row);
        if (register_of_[id] == none) {
            const Register r = allocate_register();
            const TapeProgram::Row& of = program_.rows[row];
            if (of.is_inner() && of.slot < program_.states)
                // From the previous order.
                a_.vbroadcastsd(vec(r), x86::ptr(x86::r12, 8 * (of.slot - layout_.states)));
            else if (!of.is_inner() && register_of_[of.slot] != none)
                a_.vbroadcastsd(vec(r), x86::xmm(register_of_[of.slot]));
            else
                a_.vbroadcastsd(vec(r), slot(of.slot));
            assign_register(r, id, false);
        }
        in_use_[register_of_[id]] = true;
        return register_of_[id];
    }
    Register reserved_register(const std::vector<Register>& list, int which, int vector) const {
        const std::size_t i = static_cast<std::size_t>(which) * static_cast<std::size_t>(registers_per_row_) +
                              static_cast<std::size_t>(vector);
        return i < list.size() ? list[i] : none;
    }
    Register fetch_lanes(int row, int vector) {
        if (!lane_is_current_[row]) update_lane(row);
        if (const Register r = reserved_register(row_registers_, row, vector); r != none) return r;
        const int id = lanes_of(row, vector);
        if (register_of_[id] == none) {
            const Register r = allocate_register();
            a_.vmovapd(vec(r, vector), lanes_at(layout_.rows, row, vector));
            assign_register(r, id, false);
        }
        in_use_[register_of_[id]] = true;
        return register_of_[id];
    }
    /// Puts the newest coefficient into its lane.
    void update_lane(int row) {
        const Register x = fetch_newest(row);
        lane_is_current_[row] = 1;
        if (!program_.rows[row].is_inner())
            count_use(program_.rows[row].slot), release_if_dead(program_.rows[row].slot);
        for (int v = 0; v < vectors(); ++v) {
            if (const Register r = reserved_register(row_registers_, row, v); r != none) {
                a_.k(mask(v, newest_lane)).vmovapd(vec(r, v), vec(x, v));
                continue;
            }
            const Register r = allocate_register();
            in_use_[r] = true;
            const x86::Mem at = lanes_at(layout_.rows, row, v);
            a_.vmovapd(vec(r, v), at);
            if (wide_) {
                a_.k(mask(v, newest_lane)).vmovapd(vec(r, v), vec(x, v));
            } else {
                const Register m = temporary();
                a_.vmovapd(vec(m), mask_at(v, newest_lane));
                a_.vblendvpd(vec(r), vec(r), vec(x), vec(m));
                release(m);
            }
            a_.vmovapd(at, vec(r, v));
            assign_register(r, lanes_of(row, v), false);
            in_use_[r] = false;
        }
    }

    // --- masks

    enum Mask { begun, both, newest_lane };
    x86::KReg mask(int vector, Mask which) const { return x86::k(1 + 3 * vector + which); }
    // By order: the masks of W, then those of P. One byte each for AVX-512, 32 bytes (a vector) each for AVX2.
    int mask_size() const { return wide_ ? 1 : 32; }
    int mask_count() const { return 2 * 3 * registers_per_row_; }
    x86::Mem mask_at(int vector, Mask which) const {
        return x86::ptr(x86::r13, mask_size() * ((inner_ ? 3 * registers_per_row_ : 0) + 3 * vector + which));
    }
    // Bit mask of lanes, given the lane of the newest coefficient.
    static unsigned lanes(int lane, Mask which) {
        if (lane < 0) return 0;
        switch (which) {
            case begun:
                return lane < 1 ? 0 : (1U << (lane - 1)) - 1;
            case both:
                return (1U << lane) - 1;
            default:
                return 1U << lane;
        }
    }
    void load_masks() {
        if (!wide_) return;
        for (int v = 0; v < vectors(); ++v)
            for (const Mask which : {begun, both, newest_lane}) a_.kmovb(mask(v, which), mask_at(v, which));
    }
    void embed(const asmjit::Label& counts, const asmjit::Label& masks) {
        a_.align(asmjit::AlignMode::kData, 64);
        a_.bind(masks);
        for (int k = 0; k < layout_.order; ++k)
            for (const int lane : {k, k - 2})
                for (int v = 0; v < registers_per_row_; ++v)
                    for (const Mask which : {begun, both, newest_lane}) {
                        const unsigned taken = lanes(lane, which) >> (v * width_);
                        if (wide_)
                            a_.embedUInt8(static_cast<std::uint8_t>(taken));
                        else
                            for (int i = 0; i < width_; ++i) a_.embedInt64((taken >> i) & 1 ? -1 : 0);
                    }
        a_.align(asmjit::AlignMode::kData, 64);
        a_.bind(counts);
        for (int k = 0; k < layout_.order; ++k)
            for (const double count : {1.0 * k, 1.0 / std::max(k, 1), k + 1.0, 1.0 / (k + 1)}) a_.embedDouble(count);
    }
    void begin_order(int k, const asmjit::Label& counts) {
        const std::array<int, 4> slots{program_.order, program_.inverse_order, careful_ ? program_.next : none,
                                       careful_ ? none : program_.inverse_next};
        for (int i = 0; i < 4; ++i) {
            if (slots[i] == none) continue;
            a_.vmovsd(x86::xmm0, x86::ptr(counts, 32 * k + 8 * i));
            a_.vmovsd(slot(slots[i]), x86::xmm0);
        }
    }

    // --- operations

    struct Operand {
        Register in;  ///< none: in memory
        x86::Mem at;
    };
    /// Returns the operand in a register, or in memory if it is there and this is its last use.
    Operand operand(int id) {
        const bool last = next_[id] + 1 >= first_use_[id + 1];
        if (register_of_[id] == none && last && !is_moving(id)) return {none, slot(id)};
        return {fetch_scalar(id), {}};
    }
    Register in_register(const Operand& operand, int id) { return operand.in != none ? operand.in : fetch_scalar(id); }
    bool is_dead(int id) const { return next_use(id) == never; }

    template <class Instruction>
    void emit(Instruction id, Register to, Register a, const Operand& b) {
        if (b.in != none)
            a_.emit(id, number(to), number(a), number(b.in));
        else
            a_.emit(id, number(to), number(a), b.at);
    }
    void define(int to, Register r) {
        const bool stored = stores_all_ || persistent_[to] != 0;
        assign_register(r, to, !stored);
        if (stored) store(slot(to), r);
        release_if_dead(to);
    }
    void finish(const TapeProgram::Operation& op) {
        in_use_.fill(false);
        for (const int id : {op.a, op.b, op.c})
            if (id != none) release_if_dead(id);
    }
    /// Returns a register for the result: that of an operand without further uses, or a new one.
    Register result(std::initializer_list<std::pair<int, Register>> operands) {
        for (const auto& [id, r] : operands)
            if (id != none && r != none && is_dead(id)) {
                register_of_[id] = none, value_in_[r] = free_, dirty_[r] = false;
                return r;
            }
        return allocate_register();
    }
    void operate(const TapeProgram::Operation& op) {
        switch (op.kind) {
            case Kind::add:
                return emit_binary(op, instruction(x86::Inst::kIdVaddsd, x86::Inst::kIdVaddpd), true);
            case Kind::subtract:
                return emit_binary(op, instruction(x86::Inst::kIdVsubsd, x86::Inst::kIdVsubpd), false);
            case Kind::multiply:
                return emit_binary(op, instruction(x86::Inst::kIdVmulsd, x86::Inst::kIdVmulpd), true);
            case Kind::divide:
                return emit_binary(op, instruction(x86::Inst::kIdVdivsd, x86::Inst::kIdVdivpd), false);
            case Kind::product_plus:
                return emit_fused(op, instruction(x86::Inst::kIdVfmadd231sd, x86::Inst::kIdVfmadd231pd),
                                  instruction(x86::Inst::kIdVfmadd213sd, x86::Inst::kIdVfmadd213pd));
            case Kind::product_minus:
                return emit_fused(op, instruction(x86::Inst::kIdVfmsub231sd, x86::Inst::kIdVfmsub231pd),
                                  instruction(x86::Inst::kIdVfmsub213sd, x86::Inst::kIdVfmsub213pd));
            case Kind::minus_product:
                return emit_fused(op, instruction(x86::Inst::kIdVfnmadd231sd, x86::Inst::kIdVfnmadd231pd),
                                  instruction(x86::Inst::kIdVfnmadd213sd, x86::Inst::kIdVfnmadd213pd));
            case Kind::minus_product_minus:
                return emit_fused(op, instruction(x86::Inst::kIdVfnmsub231sd, x86::Inst::kIdVfnmsub231pd),
                                  instruction(x86::Inst::kIdVfnmsub213sd, x86::Inst::kIdVfnmsub213pd));
            case Kind::root: {
                const Register a = fetch_scalar(op.a);
                count_use(op.a);
                const Register to = result({{op.a, a}});
                if (eight_)
                    a_.vsqrtpd(vec(to), vec(a));
                else
                    a_.vsqrtsd(x86::xmm(to), x86::xmm(a), x86::xmm(a));
                define(op.to, to);
                return finish(op);
            }
            case Kind::sum:
                return add_products(program_.sums[op.a]);
            case Kind::sine_cosine:
                if (is_moving(op.a)) store(x86::ptr(x86::rbx, 64 * op.a), fetch_scalar(op.a));
                count_use(op.a);
                // All vector registers are caller-saved: store live values before the call.
                for (Register r = 0; r < register_count_; ++r)
                    if (value_in_[r] >= 0 && dirty_[r] && (value_in_[r] == op.a || next_use(value_in_[r]) != never))
                        store(slot(value_in_[r]), r);
                value_in_.fill(free_), dirty_.fill(false), in_use_.fill(false);
                std::fill(register_of_.begin(), register_of_.end(), none);
                call_sine(op);
        }
    }
    void call_sine(const TapeProgram::Operation& op) {
        std::uint64_t function = reinterpret_cast<std::uint64_t>(&scalar_sine_cosine);
        if (eight_) {
            a_.lea(x86::rdi, is_moving(op.a) ? x86::ptr(x86::rbx, 64 * op.a) : slot(op.a));
            a_.lea(x86::rsi, slot(op.to)), a_.lea(x86::rdx, slot(op.b));
            function = wide_ ? reinterpret_cast<std::uint64_t>(tape_interpreter_avx512.sines_cosines)
                             : reinterpret_cast<std::uint64_t>(tape_interpreter_avx2.four_sines_cosines);
        } else {
            a_.vmovsd(x86::xmm0, slot(op.a));
            a_.lea(x86::rdi, slot(op.to)), a_.lea(x86::rsi, slot(op.b));
        }
        a_.vzeroupper();
        a_.mov(x86::rax, function);
        a_.call(x86::rax);
    }
    void emit_binary(const TapeProgram::Operation& op, std::uint32_t instruction, bool commutes) {
        int first = op.a, second = op.b;
        Operand a = operand(first), b = first == second ? a : operand(second);
        if (commutes && a.in == none && b.in != none) std::swap(a, b), std::swap(first, second);
        const Register left = in_register(a, first);
        if (first == second) b.in = left;
        count_use(op.a), count_use(op.b);
        const Register to = result({{first, left}, {second, b.in}});
        emit(instruction, to, left, b);
        define(op.to, to);
        finish(op);
    }
    void emit_fused(const TapeProgram::Operation& op, std::uint32_t onto_sum, std::uint32_t onto_factor) {
        int first = op.a, second = op.b;
        Operand a = operand(first), b = first == second ? a : operand(second);
        if (b.in == none && a.in != none) std::swap(a, b), std::swap(first, second);
        // From here, `a` is the operand in memory if there is one.
        const Register right = in_register(b, second);
        if (first == second) a.in = right;
        const bool is_factor = op.c == op.a || op.c == op.b;
        const Register sum = is_factor || is_moving(op.c) ? fetch_scalar(op.c) : register_of_[op.c];
        if (sum != none) in_use_[sum] = true;
        count_use(op.a), count_use(op.b), count_use(op.c);
        if (sum != none && is_dead(op.c) && !is_factor) {
            register_of_[op.c] = none, value_in_[sum] = free_, dirty_[sum] = false;
            emit(onto_sum, sum, right, a);
            define(op.to, sum);
        } else if (sum != none && is_dead(second) && !is_factor && first != second && a.in != none) {
            register_of_[second] = none, value_in_[right] = free_, dirty_[right] = false;
            a_.emit(onto_factor, number(right), number(a.in), number(sum));
            define(op.to, right);
        } else {
            const Register to = allocate_register();
            if (sum != none)
                a_.emit(x86::Inst::kIdVmovapd, number(to), number(sum));
            else
                load(to, slot(op.c));
            emit(onto_sum, to, right, a);
            define(op.to, to);
        }
        finish(op);
    }
    void integrate(const TapeProgram::Rate& rate, int i) {
        const int count = careful_ ? program_.next : program_.inverse_next;
        const Register share = fetch_scalar(count);
        Operand from = operand(rate.from);
        const Register r = in_register(from, rate.from);
        count_use(rate.from), count_use(count);
        const Register to = allocate_register();
        in_use_[to] = true;
        Register now = r;
        if (rate.factor != none) {
            const Operand factor = operand(rate.factor);
            emit(x86::Inst::kIdVmulsd, to, r, factor);
            count_use(rate.factor), now = to;
        }
        if (careful_)
            a_.vdivsd(x86::xmm(to), x86::xmm(now), x86::xmm(share));
        else
            a_.vmulsd(x86::xmm(to), x86::xmm(now), x86::xmm(share));
        a_.vmovsd(slot(i), x86::xmm(to));
        for (int row = 0; row < static_cast<int>(newest_registers_.size()); ++row)
            if (newest_registers_[row] != none && program_.rows[row].slot == i)
                a_.vbroadcastsd(x86::zmm(newest_registers_[row]), x86::xmm(to));
        in_use_.fill(false);
        for (const int id : {rate.from, rate.factor, count})
            if (id != none) release_if_dead(id);
    }
    void integrate(const std::vector<TapeProgram::Rate>& rates) {
        a_.add(x86::r12, 8 * layout_.states);
        for (int i = 0; i < program_.states; ++i) integrate(rates[i], i);
    }
    template <class Visit>
    void enumerate(const TapeProgram::Sum& sum, int& at, Visit&& visit) {
        for (int i = sum.first; i < sum.end; ++i) {
            const TapeProgram::Pair& pair = program_.pairs[i];
            ++at;
            visit(newest(pair.x), at), visit(newest(pair.y), at);
            for (const int row : {pair.x, pair.y}) {
                for (int v = 0; v < vectors(); ++v) visit(lanes_of(row, v), at);
                // The newest coefficient is read from its slot.
                if (!lane_is_current_[row] && !program_.rows[row].is_inner()) visit(program_.rows[row].slot, at);
                lane_is_current_[row] = 1;
            }
        }
    }
    template <class Visit>
    void enumerate(const std::vector<TapeProgram::Operation>& list, const std::vector<TapeProgram::Rate>& rates, int at,
                   Visit&& visit) {
        for (const TapeProgram::Operation& op : list) {
            ++at;
            if (op.kind == Kind::sum) {
                enumerate(program_.sums[op.a], at, visit);
                continue;
            }
            visit(op.a, at);
            if (op.kind == Kind::sine_cosine) continue;
            for (const int id : {op.b, op.c})
                if (id != none) visit(id, at);
        }
        for (const TapeProgram::Rate& rate : rates) {
            ++at;
            for (const int id : {rate.from, careful_ ? program_.next : program_.inverse_next, rate.factor})
                if (id != none) visit(id, at);
        }
        std::fill(lane_is_current_.begin(), lane_is_current_.end(), 0);
    }

    void begin() {
        note_uses([this](auto&& visit) { enumerate(program_.begin, program_.first_rates, 0, visit); });
        stores_all_ = true;
        for (const TapeProgram::Operation& op : program_.begin) operate(op);
        integrate(program_.first_rates);
        stores_all_ = false;
        // Fill the first lane of each row. The other lanes are not meaningful yet but are stored too, so that later
        // vector loads are forwarded from whole stores.
        for (int row = 0; row < row_count_; ++row) {
            if (program_.rows[row].is_inner()) continue;
            const Register kept = reserved_register(row_registers_, row, 0), r = kept == none ? 0 : kept;
            a_.vbroadcastsd(vec(r), slot(program_.rows[row].value));
            if (kept == none) a_.vmovapd(lanes_at(layout_.rows, row, 0), vec(r));
        }
    }
    void add_eight_rates() {
        note_uses([this](auto&& visit) {
            int at = 0;
            enumerate(program_.begin, {}, at, visit);
            at += static_cast<int>(program_.begin.size());
            for (const TapeProgram::Rate& rate : program_.first_rates)
                if (rate.from != none) visit(rate.from, ++at);
        });
        for (const TapeProgram::Operation& op : program_.begin) operate(op);
        const Register scale = temporary(), scaled = temporary();
        a_.vmovapd(vec(scale), x86::ptr(x86::r14));
        int factor = none;
        for (int i = 0; i < program_.states; ++i) {
            const TapeProgram::Rate& rate = program_.first_rates[i];
            if (rate.from == none) continue;
            if (rate.factor != none && rate.factor != factor)
                a_.vmulpd(vec(scaled), vec(scale), slot(factor = rate.factor));
            const Register r = fetch_scalar(rate.from), sum = allocate_register();
            const x86::Mem change = x86::ptr(x86::r15, 64 * i);
            load(sum, change);
            a_.vfmadd231pd(vec(sum), vec(r), vec(rate.factor == none ? scale : scaled));
            store(change, sum);
            in_use_.fill(false);
            count_use(rate.from), release_if_dead(rate.from);
        }
    }
    // In the subroutine of the first order, all P are still zero.
    void step(bool is_first) {
        note_uses([&](auto&& visit) {
            int at = 0;
            for (int i = 0; i < program_.inner && !is_first; ++i) enumerate(program_.sums[i], at, visit);
            enumerate(program_.step, program_.rates, at, visit);
        });
        inner_ = true;
        if (program_.inner > 0) load_masks();
        for (int i = 0; i < program_.inner; ++i)
            if (is_first)
                define_zero(program_.sums[i].to);
            else
                add_products(program_.sums[i]);
        inner_ = false;
        load_masks();
        for (const TapeProgram::Operation& op : program_.step) operate(op);
        integrate(program_.rates);
    }
    void define_zero(int to) {
        const Register r = allocate_register();
        a_.vxorpd(x86::xmm(r), x86::xmm(r), x86::xmm(r));
        define(to, r);
    }
    // The registers of a sum of products x y, one per vector of lanes. p: the newest x times the lanes of y; u: the
    // newest y times the lanes of x. The narrowest vector has four lanes.
    struct PartialSums {
        std::array<Register, TapeLayout::most_lanes / 4> p{}, u{};
    };

    void add_products(const TapeProgram::Sum& sum) {
        const int which = static_cast<int>(&sum - program_.sums.data());
        const PartialSums sums = load_partial_sums(which);
        for (int i = sum.first; i < sum.end; ++i) add_pair(program_.pairs[i], i == sum.first, sums);
        combine(sums);
        shift_and_store(which, sums);
        for (int v = 1; v < vectors(); ++v) release(sums.p[v]);
        release(sums.p[0]);
        define(sum.to, sums.p[0]);
    }
    PartialSums load_partial_sums(int which) {
        PartialSums sums;
        auto& [p, u] = sums;
        for (int v = 0; v < vectors(); ++v) {
            p[v] = temporary(), u[v] = temporary();
            const x86::Mem at = lanes_at(layout_.sums, which, v);
            if (const Register r = reserved_register(sum_registers_, which, v); r != none) {
                a_.k(mask(v, begun)).z().vmovapd(vec(p[v], v), vec(r, v));
            } else if (wide_) {
                a_.k(mask(v, begun)).z().vmovapd(vec(p[v], v), at);
            } else {
                a_.vmovapd(vec(p[v]), mask_at(v, begun));
                a_.vandpd(vec(p[v]), vec(p[v]), at);
            }
        }
        return sums;
    }
    void add_pair(const TapeProgram::Pair& pair, bool is_first, const PartialSums& sums) {
        const auto& [p, u] = sums;
        Register x = fetch_newest(pair.x), y = fetch_newest(pair.y);
        Register scaled_x = none, scaled_y = none;
        if (pair.weight != none) {
            scaled_x = temporary();
            a_.vbroadcastsd(vec(scaled_x), slot(pair.weight));
            scaled_y = pair.x == pair.y ? scaled_x : temporary();
            if (scaled_y != scaled_x) a_.vmulpd(vec(scaled_y), vec(scaled_x), vec(y));
            a_.vmulpd(vec(scaled_x), vec(scaled_x), vec(x));
            x = scaled_x, y = scaled_y;
        }
        for (int v = 0; v < vectors(); ++v) {
            const Register y_j = fetch_lanes(pair.y, v), x_j = fetch_lanes(pair.x, v);
            if (pair.negative)
                a_.vfnmadd231pd(vec(p[v], v), vec(x, v), vec(y_j, v));
            else
                a_.vfmadd231pd(vec(p[v], v), vec(x, v), vec(y_j, v));
            if (is_first)
                a_.vmulpd(vec(u[v], v), vec(y, v), vec(x_j, v));
            else if (pair.negative)
                a_.vfnmadd231pd(vec(u[v], v), vec(y, v), vec(x_j, v));
            else
                a_.vfmadd231pd(vec(u[v], v), vec(y, v), vec(x_j, v));
            in_use_[y_j] = in_use_[x_j] = false;
            for (const int row : {pair.x, pair.y}) count_use(lanes_of(row, v));
            for (const int row : {pair.x, pair.y}) release_if_dead(lanes_of(row, v));
        }
        if (scaled_x != none) release(scaled_x);
        if (scaled_y != none && scaled_y != scaled_x) release(scaled_y);
        in_use_.fill(false);
        for (const int row : {pair.x, pair.y}) count_use(newest(row));
        for (const int row : {pair.x, pair.y}) release_if_dead(newest(row));
    }
    // Adds u to p in the lanes that need both products.
    void combine(const PartialSums& sums) {
        const auto& [p, u] = sums;
        for (int v = 0; v < vectors(); ++v) {
            if (wide_) {
                a_.k(mask(v, both)).vaddpd(vec(p[v], v), vec(p[v], v), vec(u[v], v));
            } else {
                const Register m = temporary();
                a_.vmovapd(vec(m, v), mask_at(v, both));
                a_.vaddpd(vec(u[v], v), vec(u[v], v), vec(p[v], v));
                a_.vblendvpd(vec(p[v], v), vec(p[v], v), vec(u[v], v), vec(m, v));
                release(m);
            }
        }
    }
    // Shifts by one lane: every partial sum is now one order closer to its own.
    void shift_and_store(int which, const PartialSums& sums) {
        const auto& [p, u] = sums;
        const int vectors = this->vectors();
        for (int v = 0; v < vectors; ++v) {
            const Register above = v + 1 < vectors ? p[v + 1] : none, r = reserved_register(sum_registers_, which, v);
            if (wide_) {
                a_.valignq(vec(r != none ? r : u[v], v), vec(above != none ? above : p[v], v), vec(p[v], v), 1);
            } else {
                a_.vpermpd(vec(u[v]), vec(p[v]), 0x39);
                if (above != none) {
                    const Register m = temporary();
                    a_.vpermpd(vec(m), vec(above), 0x39);
                    a_.vblendpd(vec(u[v]), vec(u[v]), vec(m), 8);
                    release(m);
                }
            }
            if (r == none) a_.vmovapd(lanes_at(layout_.sums, which, v), vec(u[v], v));
            release(u[v]);
        }
    }
};

}  // namespace

bool may_compile() {
    static const bool may = [] {
        const char* const setting = std::getenv("POLHODE_CODE");
        return !(setting && std::string_view(setting) == "interpreted");
    }();
    return may;
}

namespace {

std::shared_ptr<const TapeCode> load_code(asmjit::CodeHolder& holder) {
    using asmjit::VirtMem::MemoryFlags;
    if (holder.flatten() != asmjit::kErrorOk || holder.resolveUnresolvedLinks() != asmjit::kErrorOk ||
        holder.hasUnresolvedLinks())
        return nullptr;
    const std::size_t page = asmjit::VirtMem::info().pageSize;
    const std::size_t size = (holder.codeSize() + page - 1) / page * page;
    void* memory = nullptr;
    if (asmjit::VirtMem::alloc(&memory, size, MemoryFlags::kAccessRW) != asmjit::kErrorOk) return nullptr;
    const std::shared_ptr<void> owner(memory, [size](void* m) { asmjit::VirtMem::release(m, size); });
    if (holder.relocateToBase(reinterpret_cast<std::uint64_t>(memory)) != asmjit::kErrorOk ||
        holder.copyFlattenedData(memory, size) != asmjit::kErrorOk ||
        asmjit::VirtMem::protect(memory, size, MemoryFlags::kAccessRX) != asmjit::kErrorOk)
        return nullptr;
    return std::make_shared<const TapeCode>(owner, size);
}

}  // namespace

std::shared_ptr<const TapeCode> compile_series(const TapeProgram& program, const TapeLayout& layout, bool careful,
                                               InstructionSet instructions) {
    if (instructions == InstructionSet::plain) return nullptr;
    asmjit::CodeHolder holder;
    holder.init(asmjit::Environment::host());
    TapeCompiler(program, layout, careful, instructions == InstructionSet::avx512, false, holder).write();
    return load_code(holder);
}

std::shared_ptr<const TapeCode> compile_rates(const TapeProgram& program, InstructionSet instructions) {
    if (instructions == InstructionSet::plain) return nullptr;
    asmjit::CodeHolder holder;
    holder.init(asmjit::Environment::host());
    const TapeLayout layout(program, 2);
    TapeCompiler(program, layout, false, instructions == InstructionSet::avx512, true, holder).write_rates();
    return load_code(holder);
}

}  // namespace polhode
