// Reads the table of initial states of an ensemble in pieces.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "motion/ensemble_columns.h"
#include "motion/ensemble_table.h"

namespace polhode {

/// An open table of initial states, for one body or several, whose columns have been read. Gives the same rows and
/// errors as parse_ensemble(), but holds only one piece of the table in memory.
class EnsembleStream {
  public:
    virtual ~EnsembleStream() = default;

    /// Reads the next rows, at most `most`, into `piece`. With BadRows::pass_over, invalid rows are listed in
    /// piece.refused with their numbers in the whole table. Returns whether there were more rows. Throws InputError.
    bool next(EnsembleTable& piece, std::size_t most, BadRows bad = BadRows::pass_over);
    /// Skips the next rows without validation; they count in the numbers of later rows. Returns the number of skipped
    /// rows, at most `rows`. Throws InputError if the table cannot be read.
    std::size_t skip(std::size_t rows);
    /// Throws InputError unless at least one valid row was read.
    void require_rows() const;

    /// The number of rows read or skipped so far.
    std::size_t rows_passed() const { return rows_passed_; }
    /// Whether the rows have ids.
    bool has_ids() const { return columns_->has_ids(); }
    /// The maximum length of an id in bytes, if the format sets one; else 0.
    std::size_t id_width() const { return id_width_; }
    /// A table with the same columns and no rows.
    EnsembleTable empty_table() const;
    /// The place of the current row for messages: "FILE: line 3".
    std::string where() const { return file_ + ": " + here(); }
    /// Throws InputError with this fault of the current row.
    [[noreturn]] void refuse(const BodyFault& fault) const;

  protected:
    EnsembleStream(std::string file, const Scene& scene);

    /// Moves to the next row. Returns false at the end. Throws InputError if the table cannot be read.
    virtual bool advance() = 0;
    /// Moves on by at most `rows` rows, and returns their number.
    virtual std::size_t advance_by(std::size_t rows) = 0;
    /// Reads the current row into `numbers_` and `id_`. Throws InputError.
    virtual void read_cells() = 0;
    /// An estimate of the number of rows from here on.
    virtual std::size_t rows_left() const = 0;
    /// The place of the current row in its file: "line 3".
    virtual std::string here() const = 0;

    /// Selects the table's columns by their indices in columns(). `place` is the place for messages. Throws InputError.
    void select(const std::vector<std::size_t>& places, const std::string& place);
    const EnsembleColumns& columns() const { return *columns_; }
    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const;

    const std::string file_;
    std::size_t id_width_ = 0;
    std::vector<double> numbers_;  ///< values of the current row, one per selected column
    std::string_view id_;          ///< id of the current row

  private:
    std::unique_ptr<EnsembleColumns> columns_;
    std::size_t rows_passed_ = 0, rows_taken_ = 0;
    std::string first_refusal_;
};

/// Opens a table of any length: NumPy's format if the path ends in .npy (motion/ensemble_npy.h), else CSV (see
/// parse_ensemble). `scene` must outlive the returned stream. Throws InputError.
std::unique_ptr<EnsembleStream> open_ensemble(const std::string& path, const Scene& scene);

/// Reads rows from a CSV text. Text and scene must outlive the returned stream. Throws InputError.
std::unique_ptr<EnsembleStream> ensemble_of_text(std::string_view text, const std::string& file, const Scene& scene);

}  // namespace polhode
