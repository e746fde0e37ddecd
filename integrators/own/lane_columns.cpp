#include "integrators/own/lane_columns.h"

#include <algorithm>
#include <array>

#include "integrators/lanes/lane_math.h"
#include "integrators/lanes/rotation_lanes.h"

namespace polhode {
namespace {

/// The data of a compensated substep: eight numbers per variable.
struct CompensatedSubstep {
    std::size_t end;
    const double *start, *twice_h, *rate;
    double *before, *now, *lost_before, *lost, *y;
};
POLHODE_INLINE void advance_substep(const CompensatedSubstep& s) {
    const Octet twice_h = octet_at(s.twice_h);
    for (std::size_t i = 0; i < s.end; i += 8) {
        const Octet before = octet_at(s.before + i), lost_before = octet_at(s.lost_before + i);
        const Octet change = twice_h * octet_at(s.rate + i) + lost_before;
        const Octet next = before + change, lost = rounded_away(before, change, next);
        put(s.lost_before + i, octet_at(s.lost + i)), put(s.lost + i, lost);
        put(s.before + i, octet_at(s.now + i)), put(s.now + i, next);
        put(s.y + i, octet_at(s.start + i) + (next + lost));
    }
}
using SubstepKernel = void(const CompensatedSubstep&);
void advance_substep_plain(const CompensatedSubstep& s) { advance_substep(s); }
POLHODE_TARGET_AVX2 void advance_substep_avx2(const CompensatedSubstep& s) { advance_substep(s); }
POLHODE_TARGET_AVX512 void advance_substep_avx512(const CompensatedSubstep& s) { advance_substep(s); }

}  // namespace

LaneColumns::LaneColumns(const Recording<double>& recording)
    : size_(static_cast<int>(recording.rates.size())), rates_(recording) {
    for (Lanes* const list :
         {&start_, &before_, &now_, &lost_before_, &lost_, &y_, &rate_, &increment_, &increment_lost_})
        list->assign(index_of(size_, 0), 0);
}

void LaneColumns::step(const double* y, double H, const ExtrapolationRow& row, bool careful) {
    constexpr SubstepKernel* all[] = {advance_substep_plain, advance_substep_avx2, advance_substep_avx512};
    SubstepKernel* const advance_substep = all[static_cast<std::size_t>(instruction_set())];
    const int K = row.columns;
    alignas(64) std::array<double, lanes> twice_h{};
    // Unused lanes repeat the last column.
    for (int j = 0; j < lanes; ++j) twice_h[j] = 2 * (H / row.substeps[std::min(j, K - 1)]);
    for (int i = 0; i < size_; ++i) std::fill_n(&start_[index_of(i, 0)], lanes, y[i]);
    rates_.find(start_.data(), rate_.data());
    for (Lanes* const list : {&before_, &lost_before_, &lost_}) std::fill(list->begin(), list->end(), 0);
    for (std::size_t i = 0; i < rate_.size(); ++i) now_[i] = twice_h[i % lanes] / 2 * rate_[i];
    for (std::size_t i = 0; careful && i < rate_.size(); ++i) y_[i] = start_[i] + now_[i];
    for (int m = 1, j = 0; j < K; ++m) {
        if (m > 1 && careful) {
            rates_.find(y_.data(), rate_.data());
            advance_substep({rate_.size(), start_.data(), twice_h.data(), rate_.data(), before_.data(), now_.data(),
                             lost_before_.data(), lost_.data(), y_.data()});
        } else if (m > 1) {
            rates_({start_.data(), now_.data(), twice_h.data(), before_.data()});
            std::swap(before_, now_);
        }
        for (; j < K && row.substeps[j] == m; ++j)
            for (int i = 0; i < size_; ++i)
                increment_[index_of(i, j)] = now_[index_of(i, j)],
                                       increment_lost_[index_of(i, j)] = lost_[index_of(i, j)];
    }
}

}  // namespace polhode
