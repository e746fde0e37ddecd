#include "integrators/own/lane_columns.h"

#include <algorithm>
#include <array>

#include "integrators/lanes/lane_math.h"
#include "integrators/lanes/rotation_lanes.h"

namespace polhode {
namespace {

/// What a substep works on: of each variable eight numbers, and one of y's.
struct Substep {
    int size;
    bool careful;
    const double *start, *rate;
    double *before, *now, *lost_before, *lost, *y;
};

POLHODE_INLINE Octet loaded(const double* from) {
    Octet x;
    __builtin_memcpy(&x.v, from, sizeof x.v);
    return x;
}
POLHODE_INLINE void store(const Octet& x, double* to) { __builtin_memcpy(to, &x.v, sizeof x.v); }

// z_1 = h f(y)
POLHODE_INLINE void begin(const Substep& s, const Octet& h) {
    const Octet zero = octet(0);
    for (int i = 0; i < s.size; ++i) {
        const Octet now = h * loaded(s.rate + 8 * i);
        store(zero, s.before + 8 * i), store(zero, s.lost_before + 8 * i), store(zero, s.lost + 8 * i);
        store(now, s.now + 8 * i);
        store(octet(s.start[i]) + now, s.y + 8 * i);
    }
}
POLHODE_INLINE void go_on(const Substep& s, const Octet& h) {
    const Octet twice = 2.0 * h;
    for (int i = 0; i < s.size; ++i) {
        const Octet before = loaded(s.before + 8 * i), now = loaded(s.now + 8 * i);
        Octet change = twice * loaded(s.rate + 8 * i);
        if (!s.careful) {
            const Octet next = before + change;
            store(now, s.before + 8 * i), store(next, s.now + 8 * i);
            store(octet(s.start[i]) + next, s.y + 8 * i);
            continue;
        }
        change = change + loaded(s.lost_before + 8 * i);
        const Octet next = before + change, lost = rounded_away(before, change, next);
        store(loaded(s.lost + 8 * i), s.lost_before + 8 * i), store(lost, s.lost + 8 * i);
        store(now, s.before + 8 * i), store(next, s.now + 8 * i);
        store(octet(s.start[i]) + (next + lost), s.y + 8 * i);
    }
}
POLHODE_INLINE void work(const Substep& s, const double* h, bool is_first) {
    if (is_first)
        begin(s, loaded(h));
    else
        go_on(s, loaded(h));
}
using Work = void(const Substep&, const double*, bool);
void work_plain(const Substep& s, const double* h, bool is_first) { work(s, h, is_first); }
POLHODE_TARGET_AVX2 void work_avx2(const Substep& s, const double* h, bool is_first) { work(s, h, is_first); }
POLHODE_TARGET_AVX512 void work_avx512(const Substep& s, const double* h, bool is_first) { work(s, h, is_first); }

}  // namespace

LaneColumns::LaneColumns(const truth::Recording<double>& recording)
    : size_(static_cast<int>(recording.rates.size())), rates_(recording) {
    for (Lanes* const lanes : {&before_, &now_, &lost_before_, &lost_, &y_, &rate_, &found_, &found_lost_})
        lanes->assign(place(size_, 0), 0);
}

void LaneColumns::step(const double* y, double H, const ExtrapolationRow& row, bool careful) {
    constexpr Work* all[] = {work_plain, work_avx2, work_avx512};
    Work* const work = all[static_cast<std::size_t>(instruction_set())];
    const int K = row.columns;
    alignas(64) std::array<double, TapeRates::lanes> h{};
    // lanes that are left over do what the last column does
    for (int j = 0; j < TapeRates::lanes; ++j) h[j] = H / row.substeps[std::min(j, K - 1)];
    const Substep substep{size_,        careful,  y, rate_.data(), before_.data(), now_.data(), lost_before_.data(),
                          lost_.data(), y_.data()};
    for (int i = 0; i < size_; ++i) std::fill_n(&y_[place(i, 0)], TapeRates::lanes, y[i]);
    for (int m = 1, j = 0; j < K; ++m) {
        rates_(y_.data(), rate_.data());
        work(substep, h.data(), m == 1);
        for (; j < K && row.substeps[j] == m; ++j)
            for (int i = 0; i < size_; ++i)
                found_[place(i, j)] = now_[place(i, j)], found_lost_[place(i, j)] = lost_[place(i, j)];
    }
}

}  // namespace polhode
