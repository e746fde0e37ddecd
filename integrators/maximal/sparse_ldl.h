// L D L^T factorisation of a sparse symmetric matrix in a fixed order, without pivoting. There are no branches on
// values, so any scalar type can be used. Order and fill-in are determined once from the sparsity pattern.
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

namespace polhode::maximal {

/// Sparsity pattern of a matrix and its factor, and the order of all operations on them.
class SparsePattern {
  public:
    SparsePattern() = default;
    /// `entries`: for each column, the rows below the diagonal with a nonzero entry.
    explicit SparsePattern(std::vector<std::set<int>> entries) : begin_(entries.size() + 1, 0) {
        const std::size_t n = entries.size();
        for (std::size_t k = 0; k < n; ++k) {
            // Eliminating k couples all rows that are coupled to k.
            for (auto i = entries[k].begin(); i != entries[k].end(); ++i)
                entries[static_cast<std::size_t>(*i)].insert(std::next(i), entries[k].end());
            rows_.insert(rows_.end(), entries[k].begin(), entries[k].end());
            begin_[k + 1] = static_cast<int>(rows_.size());
        }
        for (std::size_t k = 0; k < n; ++k)
            for (int a = begin_[k]; a < begin_[k + 1]; ++a)
                for (int b = a; b < begin_[k + 1]; ++b) targets_.push_back(place(rows_[a], rows_[b]));
    }

    int size() const { return static_cast<int>(begin_.size()) - 1; }
    /// Number of entries: the diagonal first, then those below it.
    int entries() const { return size() + static_cast<int>(rows_.size()); }
    /// Whether the factor has this entry.
    bool has(int i, int j) const {
        const int column = std::min(i, j), row = std::max(i, j);
        return i == j || std::binary_search(rows_.begin() + begin_[column], rows_.begin() + begin_[column + 1], row);
    }
    /// Index of an entry, which must exist.
    int place(int i, int j) const {
        if (i == j) return i;
        const int column = std::min(i, j), row = std::max(i, j);
        const auto first = rows_.begin() + begin_[column], last = rows_.begin() + begin_[column + 1];
        return size() + static_cast<int>(std::lower_bound(first, last, row) - rows_.begin());
    }

    /// Eliminates the columns [0, count) of A in place, giving D and L; the rest becomes its Schur complement.
    template <class S>
    void factorize(std::vector<S>& A, int count) const {
        std::size_t next = 0;
        std::vector<S> column;
        for (int k = 0; k < count; ++k) {
            const int first = begin_[k], last = begin_[k + 1];
            if (first == last) continue;
            const S scale = S(1) / A[k];
            column.assign(A.begin() + size() + first, A.begin() + size() + last);
            for (int a = first; a < last; ++a) {
                S& l = A[size() + a];
                l = scale * l;
                for (int b = a; b < last; ++b) {
                    S& entry = A[targets_[next++]];
                    entry = entry - l * column[b - first];
                }
            }
        }
    }
    /// Forward substitution with an A whose columns [0, count) are factorised: x becomes D^-1 L^-1 x there, and the
    /// reduced right side in the rest.
    template <class S>
    void descend(const std::vector<S>& A, std::vector<S>& x, int count) const {
        for (int k = 0; k < count; ++k)
            for (int a = begin_[k]; a < begin_[k + 1]; ++a) x[rows_[a]] = x[rows_[a]] - A[size() + a] * x[k];
        for (int k = 0; k < count; ++k) x[k] = x[k] / A[k];
    }
    /// Back substitution, after the rest of x has been solved for.
    template <class S>
    void ascend(const std::vector<S>& A, std::vector<S>& x, int count) const {
        for (int k = count; k-- > 0;)
            for (int a = begin_[k]; a < begin_[k + 1]; ++a) x[k] = x[k] - A[size() + a] * x[rows_[a]];
    }

  private:
    std::vector<int> begin_, rows_;  // by column, below the diagonal
    std::vector<int> targets_;       // by update, in order
};

}  // namespace polhode::maximal
