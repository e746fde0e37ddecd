// Output rows of an ensemble, as CSV or in NumPy's binary format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/own/mechanism_ensemble.h"
#include "motion/ensemble_stream.h"

namespace polhode {

/// Some rows of a table and their results.
struct SolvedPiece {
    EnsembleTable table;                       ///< input rows
    std::size_t first_row = 1;                 ///< row number of the first row in the whole table
    std::vector<std::vector<EnsembleRow>> at;  ///< one body: results by time, then by row; the last time is the end
    std::vector<MechanismRow> mechanisms;      ///< several bodies: results by row
    std::string text;                          ///< the output
    double solving = 0, formatting = 0;        ///< time spent, s

    /// Returns whether there are no rows.
    bool is_empty() const { return table.rows() == 0 && table.refused.empty(); }
};

/// One line of CSV, or one record of an .npy file: a body at one time, or the reason of a failure.
struct EnsembleRecord {
    std::size_t row;             ///< row number in the table
    const std::string* id;       ///< null if the table has no ids, and for refused rows
    Status status;               ///< status of the run until this time, or of a row that ended early
    const Sample* sample;        ///< the motion; null if there is none
    std::string_view body;       ///< name of the body (several bodies)
    const std::string& message;  ///< the reason if status is not ok
};

/// The format of records.
class EnsembleFormat {
  public:
    virtual ~EnsembleFormat() = default;
    /// Returns the text before `bytes` bytes of records. Its length does not depend on `bytes`.
    virtual std::string header(std::uint64_t bytes) const = 0;
    /// Returns whether the header depends on the number of records.
    virtual bool counts_records() const = 0;
    /// Appends a record.
    virtual void append(std::string& text, const EnsembleRecord& record) const = 0;
};

/// Returns the format of `path`: NumPy's if it ends in .npy, otherwise CSV. Throws InputError, naming the table `file`,
/// if the ids of the table have no fixed width, which NumPy's format requires.
std::unique_ptr<EnsembleFormat> make_format(const std::string& path, const Scene& scene, const EnsembleStream& table,
                                            const std::string& file);

/// Formats the rows of a piece in order, by row, time and body. A mechanism whose run ended early has one more record,
/// which reports the reason.
std::string format_rows(const SolvedPiece& piece, const Scene& scene, const EnsembleFormat& format);

}  // namespace polhode
