// The table that an ensemble starts from, some rows at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "motion/ensemble_columns.h"
#include "motion/ensemble_table.h"

namespace polhode {

/// A table of one body or of several whose columns have been read. It gives what read_ensemble() gives and is as
/// strict, but of a table of any length it holds one piece.
class EnsembleStream {
  public:
    virtual ~EnsembleStream() = default;

    /// Reads the next rows into `piece`, at most `most`; where bad ones are passed over they are listed among the
    /// refused, with their numbers in the whole table. False where there are no more rows. Throws InputError.
    bool next(EnsembleTable& piece, std::size_t most, BadRows bad = BadRows::pass_over);
    /// Skips the next rows, whatever they say; they count in the numbers of those behind them. Returns how many there
    /// were, at most `rows`. Throws InputError where the table cannot be read on.
    std::size_t skip(std::size_t rows);
    /// Throws InputError unless at least one row was read that was not refused.
    void require_rows() const;

    /// How many rows were read or skipped so far.
    std::size_t rows_passed() const { return rows_passed_; }
    /// Whether the rows have names of their own.
    bool has_ids() const { return columns_->has_ids(); }
    /// The longest name that a row can have, in bytes, where the format sets one; else 0.
    std::size_t id_width() const { return id_width_; }
    /// A table without rows, with the columns that this has.
    EnsembleTable empty_table() const;
    /// The row at hand in messages: "FILE: line 3".
    std::string where() const { return file_ + ": " + here(); }
    /// Throws InputError: what is wrong with the row at hand.
    [[noreturn]] void refuse(const BodyFault& fault) const;

  protected:
    EnsembleStream(std::string file, const Scene& scene);

    /// Goes to the next row; false where there is none. Throws InputError where the table cannot be read on.
    virtual bool advance() = 0;
    /// Goes on by `rows` rows at most, and returns by how many.
    virtual std::size_t advance_by(std::size_t rows) = 0;
    /// Reads the row at hand into `numbers_` and `id_`. Throws InputError.
    virtual void read_cells() = 0;
    /// About how many rows there are from here on, as far as that is known.
    virtual std::size_t rows_left() const = 0;
    /// The row at hand in its file: "line 3".
    virtual std::string here() const = 0;

    /// Selects the columns of the table by their places among columns(), at `place` of the file. Throws InputError.
    void select(const std::vector<std::size_t>& places, const std::string& place);
    const EnsembleColumns& columns() const { return *columns_; }
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const;

    const std::string file_;
    std::size_t id_width_ = 0;
    std::vector<double> numbers_;  ///< of the row at hand, one for each selected column
    std::string_view id_;          ///< of the row at hand

  private:
    std::unique_ptr<EnsembleColumns> columns_;
    std::size_t rows_passed_ = 0, rows_taken_ = 0;
    std::string first_refusal_;
};

/// Opens a table: NumPy's format where the path ends in .npy (motion/ensemble_npy.h), else CSV (see parse_ensemble), of
/// any length. `scene` outlives what is returned. Throws InputError.
std::unique_ptr<EnsembleStream> open_ensemble(const std::string& path, const Scene& scene);

/// The rows of a CSV text. The text and the scene outlive what is returned. Throws InputError.
std::unique_ptr<EnsembleStream> ensemble_of_text(std::string_view text, const std::string& file, const Scene& scene);

}  // namespace polhode
