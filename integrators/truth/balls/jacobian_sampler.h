// Jacobians along an approximate motion, in doubles, for planning a proof. The proof does not depend on their accuracy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "integrators/series/linear_algebra.h"
#include "integrators/series/series.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/motion.h"
#include "scene/scene.h"

namespace polhode::truth {

struct JacobianSample {
    Eigen::MatrixXd J;
    double seconds;  ///< length of the interval that J represents
};

/// Computes Jacobians along an approximate motion, at most 64 per piece.
template <class Form>
class JacobianSampler {
  public:
    /// The scene must outlive this object.
    JacobianSampler(const Scene& scene, std::vector<Block> blocks)
        : form_(scene), blocks_(std::move(blocks)), y_(static_cast<std::size_t>(form_.dimension())) {
        form_.initial(y_.data());
        largest_.assign(y_.size(), 0.0);
    }

    std::vector<JacobianSample> visits(double begin, double end) {
        constexpr int order = 12, most_steps = 4000;
        constexpr double tolerance = 1e-6;
        const int n = form_.dimension();
        form_.enter(begin, y_.data());
        note_size();
        Series<double> series(record<double>(form_, n), order);
        std::vector<JacobianSample> all;
        double t = begin;
        for (int step = 0; t < end; ++step) {
            series.expand(y_.data());
            double h = end - t;
            for (const Block& block : blocks_) {
                // variables that start at zero get a minimum size
                double size = 1e-3 * block.scale, last = 0;
                for (int i = block.first; i < block.first + block.size; ++i) {
                    size = std::max(size, std::abs(y_[i]));
                    last = std::max(last, std::abs(series.coefficient(i, order)));
                }
                if (last > 0 && size > 0) h = std::min(h, std::pow(tolerance * size / last, 1.0 / order));
            }
            const bool give_up = step >= most_steps || !(t + h > t);
            if (give_up) h = end - t;
            const std::vector<double> J = jacobian_of(series.recording(), y_.data());
            all.push_back({Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(J.data(), n, n), h});
            if (give_up) break;
            series.evaluate(h, y_.data());
            note_size();
            t = end - t <= h ? end : t + h;
        }
        return thin_out(std::move(all));
    }

    /// The largest magnitude of each variable along the motion so far.
    const std::vector<double>& largest() const { return largest_; }

  private:
    Form form_;
    std::vector<Block> blocks_;
    std::vector<double> y_, largest_;

    void note_size() {
        for (std::size_t i = 0; i < y_.size(); ++i)
            if (std::isfinite(y_[i])) largest_[i] = std::max(largest_[i], std::abs(y_[i]));
    }

    static std::vector<JacobianSample> thin_out(std::vector<JacobianSample> all) {
        constexpr std::size_t most = 64;
        const std::size_t stride = (all.size() + most - 1) / most;
        std::vector<JacobianSample> selected;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!all[i].J.allFinite()) continue;
            if (i % stride == 0 || selected.empty())
                selected.push_back(std::move(all[i]));
            else
                selected.back().seconds += all[i].seconds;
        }
        return selected;
    }
};

/// Integral of the positive part of the logarithmic norm along the visits, weighted by S, in bits.
double growth_bits(const std::vector<JacobianSample>& visits, const Eigen::MatrixXd& S);

}  // namespace polhode::truth
