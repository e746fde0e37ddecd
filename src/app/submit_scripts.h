// What polhode submit writes: text for the engines that run shards of an experiment on many machines.
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

/// A script that submits itself: one job array, or as many as the cluster's MaxArraySize asks for, and a job behind
/// them that merges. A shard that runs out of time, or is killed, is queued again and goes on.
std::string slurm_script(const Submission& submission);

/// A script that runs the shards by GNU parallel with a log of its jobs, those that failed again, and merges.
std::string parallel_script(const Submission& submission);

/// Rules for Snakemake: one a shard, one that merges.
std::string snakefile(const Submission& submission);

}  // namespace polhode
