// The scripts that polhode submit writes, for the engines that run shards of an experiment on many machines.
#pragma once

#include <string>
#include <vector>

namespace polhode {

/// An experiment in shards, as it is to be submitted.
struct Submission {
    std::string name;                          ///< the experiment's
    std::string program;                       ///< polhode itself, by its absolute path
    std::string experiment;                    ///< a built-in one's name, or an absolute path
    std::string output;                        ///< the folder that all is written into, an absolute path
    std::string plan;                          ///< the file of the expected costs, an absolute path
    std::vector<std::string> options{};        ///< further ones, for each shard
    std::vector<std::string> merge_options{};  ///< and for the merge
    int shards = 1, jobs = 1;                  ///< jobs: threads of each shard
    long seconds = 0;                          ///< that a shard may take
};

/// `text` as one word of a shell (POSIX: in single quotes where it holds more than letters, digits and _ - . / = : ,
/// +).
std::string shell_word(const std::string& text);

/// Seconds as Slurm writes a time: D-HH:MM:SS, rounded up to whole minutes.
std::string slurm_time(long seconds);

/// The file name of the script of an engine: `slurm`, `parallel` or `snakemake`.
std::string script_name(const std::string& engine, const Submission& submission);

/// The script that runs the shards with an engine and merges them: the engine's template of src/app/submit/, filled in.
/// Throws std::invalid_argument for another engine.
std::string submit_script(const std::string& engine, const Submission& submission);

}  // namespace polhode
