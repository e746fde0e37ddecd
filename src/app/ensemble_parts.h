// Parts of an ensemble: rows of one table solved by several processes or machines, and their merge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace polhode {

/// Part `part` of `parts`, counted from 1.
struct Shard {
    std::size_t part = 1, parts = 1;
};

/// Reads "I/N", 1 <= I <= N <= 10^6. Throws UsageError.
Shard parse_shard(const std::string& text);

/// Returns the rows of a part as a half-open range [first, last), counted from 0. Parts are contiguous, and their
/// numbers of rows differ by at most one.
std::pair<std::size_t, std::size_t> shard_rows(std::size_t rows, const Shard& shard);

/// Returns the path of a part of `output`, in the same directory: "out.part-0003-of-0200.npy" for "out.npy".
std::string part_path(const std::string& output, const Shard& shard);

/// Identifies a table.
struct TableIdentity {
    std::size_t rows = 0;
    std::uint64_t bytes = 0;
    std::string hash;  ///< content_hash() of the file, or of the blocks that compute_identity() reads
};

/// Identifies a table by its content and its number of rows. A CSV file is read completely. For an .npy file of more
/// than 64 MiB, about a thousand blocks are read, so that tables of equal length that differ in few rows may not be
/// distinguished. Throws InputError.
TableIdentity compute_identity(const std::string& path, const Scene& scene);

/// The contents of the .json file of a part: identifies the part and its ensemble.
struct EnsemblePart {
    Shard shard;
    std::string output;       ///< name of the complete output, without a directory
    TableIdentity table;      ///< the table that the rows are from
    std::string scene;        ///< hash of the solved scene
    std::string program;      ///< key of the program: everything that may change the bits
    std::string options;      ///< options that may change a row
    std::size_t rows = 0;     ///< rows of the table in this part
    std::size_t ok = 0;       ///< rows with status ok
    std::size_t refused = 0;  ///< invalid rows
    std::uint64_t bytes = 0;  ///< size of the part's file after its header
    std::string hash;         ///< content_hash() of these bytes
};

/// Returns the part as JSON.
std::string write_part(const EnsemblePart& part);

/// Parses the output of write_part(). Throws InputError.
EnsemblePart parse_part(const std::string& text, const std::string& file);

/// Returns whether a directory contains parts of ensembles.
bool has_ensemble_parts(const std::string& dir);

/// Result of merging parts.
struct MergedEnsemble {
    std::string output;       ///< the written file
    std::size_t parts = 0;    ///< number of parts
    std::size_t rows = 0;     ///< rows of the table
    std::size_t ok = 0;       ///< rows with status ok
    std::size_t refused = 0;  ///< invalid rows
    /// Returns whether all rows have status ok, which determines the exit code.
    bool all_ok() const { return refused == 0 && ok == rows; }
};

/// Merges the parts in these directories into `output`, or into a file in it if it is a directory. The bytes are the
/// same as from one run over the whole table. If the directories contain parts of several ensembles, those with the
/// name of `output` are merged. Copies of a part must have the same content. Parts are not changed, so that the merge
/// can be repeated. Throws InputError if a part is missing, damaged or from another ensemble, and std::runtime_error if
/// `output` cannot be written; a previous file is then unchanged.
MergedEnsemble merge_ensemble_parts(const std::vector<std::string>& dirs, const std::string& output);

}  // namespace polhode
