// The scripts of polhode submit, for workflow engines that run shards of an experiment on many machines.
#pragma once

#include <string>
#include <vector>

namespace polhode {

/// An experiment to be submitted in shards.
struct Submission {
    std::string name;                          ///< name of the experiment
    std::string program;                       ///< absolute path of polhode
    std::string experiment;                    ///< name of a built-in experiment, or an absolute path
    std::string output;                        ///< absolute path of the output directory
    std::string plan;                          ///< absolute path of the file of expected costs
    std::vector<std::string> options{};        ///< further options of each shard
    std::vector<std::string> merge_options{};  ///< further options of the merge
    int shards = 1, jobs = 1;                  ///< jobs: threads of each shard
    long seconds = 0;                          ///< time limit of a shard, s
};

/// Quotes `text` as one word of a POSIX shell: in single quotes unless it consists of letters, digits and _ - . / = : ,
/// + only.
std::string shell_word(const std::string& text);

/// Formats seconds as a time of Slurm, D-HH:MM:SS, rounded up to whole minutes.
std::string slurm_time(long seconds);

/// Returns the file name of the script for an engine: `slurm`, `parallel` or `snakemake`.
std::string script_name(const std::string& engine, const Submission& submission);

/// Returns the script that runs the shards with an engine and merges them, from the template in src/app/submit/. Throws
/// std::invalid_argument for other engines.
std::string submit_script(const std::string& engine, const Submission& submission);

}  // namespace polhode
