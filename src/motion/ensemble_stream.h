// The table that an ensemble starts from, some rows at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "motion/ensemble_table.h"

namespace polhode {

/// A table whose columns have been read. It gives what read_ensemble() gives and is as strict, but of a table of any
/// length it holds one piece.
class EnsembleStream {
  public:
    virtual ~EnsembleStream() = default;

    /// The next rows into `piece`, at most `most`; where bad ones are passed over they stand among the refused, with
    /// their numbers in the whole table. False where there are no more rows. Throws InputError.
    bool next(EnsembleTable& piece, std::size_t most, BadRows bad = BadRows::pass_over);
    /// Leaves out the next rows, whatever they say; they count in the numbers of those behind them. Returns how many
    /// there were, at most `rows`. Throws InputError where the table cannot be read on.
    std::size_t skip(std::size_t rows);
    /// Throws InputError where no row that was read is a body.
    void require_bodies() const;

    /// How many rows were read or left out so far.
    std::size_t rows_passed() const { return rows_passed_; }
    /// Whether the rows have names of their own.
    bool has_ids() const { return has_ids_; }
    /// The longest name that a row can have, in bytes, where the format sets one; else 0.
    std::size_t id_width() const { return id_width_; }

  protected:
    /// Goes to the next row; false where there is none. Throws InputError where the table cannot be read on.
    virtual bool advance() = 0;
    /// Goes on by `rows` rows at most, and returns by how many.
    virtual std::size_t advance_by(std::size_t rows) = 0;
    /// Appends the row at hand. Throws InputError where it is no body.
    virtual void read_row(EnsembleTable& piece) const = 0;
    /// About how many rows there are from here on, as far as that is known.
    virtual std::size_t rows_left() const = 0;
    /// The table's name in errors.
    virtual const std::string& file() const = 0;

    bool has_ids_ = false;
    std::size_t id_width_ = 0;

  private:
    std::size_t rows_passed_ = 0, bodies_ = 0;
    std::string first_refusal_;
};

/// Opens a table: NumPy's format where the path ends in .npy (motion/ensemble_npy.h), else CSV (see parse_ensemble), of
/// any length. `scene` outlives what is returned. Throws InputError.
std::unique_ptr<EnsembleStream> open_ensemble(const std::string& path, const Scene& scene);

/// The rows of a CSV text. The text and the scene outlive what is returned. Throws InputError.
std::unique_ptr<EnsembleStream> ensemble_of_text(std::string_view text, const std::string& file, const Scene& scene);

}  // namespace polhode
