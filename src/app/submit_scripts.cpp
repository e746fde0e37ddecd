#include "app/submit_scripts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "text/json_document.h"

namespace polhode {
namespace {

std::string words(const std::vector<std::string>& texts) {
    std::string line;
    for (const std::string& text : texts) line += " " + shell_word(text);
    return line;
}

// the assignments that both scripts begin with
std::string assignments(const Submission& s) {
    return fmt::format(
        "program={}\nexperiment={}\noutput={}\nplan={}\nshards={}\njobs={}\noptions=({})\nmerge_options=({})\n",
        shell_word(s.program), shell_word(s.experiment), shell_word(s.output), shell_word(s.plan), s.shards, s.jobs,
        words(s.options), words(s.merge_options));
}

// A Python list of strings; JSON's escapes are Python's, but for those of what is beyond 16 bits, which it never
// writes.
std::string python_list(const std::vector<std::string>& texts) {
    std::string list;
    for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + json_string(text);
    return "[" + list + "]";
}

}  // namespace

std::string shell_word(const std::string& text) {
    const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 ||
               std::string_view("_-./=:,+").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (plain) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

std::string slurm_time(long seconds) {
    const long minutes = std::max(1L, (seconds + 59) / 60);
    return fmt::format("{}-{:02}:{:02}:00", minutes / 1440, minutes / 60 % 24, minutes % 60);
}

std::string slurm_script(const Submission& s) {
    const std::string beginning = fmt::format(R"sh(#!/usr/bin/env bash
# {name} in {shards} shards by Slurm, and their merge:
#
#   bash {name}.slurm.sh [OPTION OF sbatch, such as --partition=P]..
#
# Can be submitted again: what is finished stays. The time limit is three times what the dearest shard is expected to take,
# and ten minutes.
set -euo pipefail

)sh",
                                              fmt::arg("name", s.name), fmt::arg("shards", s.shards));
    return beginning + assignments(s) + fmt::format("time={}\nname={}\n", slurm_time(s.seconds), s.name) + R"sh(
# requeue TASK REASON: queues this task again, five times at the most
requeue() {
    if ((${SLURM_RESTART_COUNT:-0} >= 5)); then
        echo "$name: $2; it was queued again five times" >&2
        return 1
    fi
    echo "$name: $2; queued again" >&2
    scontrol requeue "$1"
}

case ${1:-} in
shard)
    shard=$(($2 + SLURM_ARRAY_TASK_ID))
    task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
    out_of_time=0 status=0 child=""
    # told a minute before the end: the case at hand is finished, and the rest left to the next start
    trap 'out_of_time=1; [[ -z $child ]] || kill -TERM "$child" 2>/dev/null || true' USR1
    "$program" run "$experiment" "${options[@]}" --shard "$shard/$shards" --plan "$plan" \
        --output "$output/shards/$shard" --jobs "$jobs" --quiet &
    child=$!
    # it may have been told before there was a child
    ((!out_of_time)) || kill -TERM "$child" 2>/dev/null || true
    wait "$child" || status=$?
    if ((out_of_time)); then
        wait "$child" || true
        requeue "$task" "shard $shard is out of time"
    elif ((status > 128)); then
        requeue "$task" "shard $shard ended by signal $((status - 128))"
    fi
    exit "$status"
    ;;
merge)
    exec "$program" merge "$output"/shards/*/ "${merge_options[@]}" --output "$output"
    ;;
esac

mkdir -p "$output/shards" "$output/logs"
# a cluster's largest index of an array is one below its MaxArraySize
most=$(scontrol show config | sed -nE 's/^MaxArraySize *= *([0-9]+).*/\1/p')
most=$((${most:-1001} - 1))
arrays=""
for ((done_before = 0; done_before < shards; done_before += most)); do
    count=$((shards - done_before < most ? shards - done_before : most))
    array=$(sbatch --parsable --job-name="$name" --array="1-$count" --requeue --open-mode=append --signal=B:USR1@60 \
        --time="$time" --cpus-per-task="$jobs" --output="${output//%/%%}/logs/%A_%a.log" "$@" "$0" shard "$done_before")
    arrays+=":${array%%;*}"
done
merge=$(sbatch --parsable --job-name="$name-merge" --dependency="afterany$arrays" --requeue --open-mode=append \
    --time="$time" --output="${output//%/%%}/logs/merge_%j.log" "$@" "$0" merge)
echo "$name: $shards shards in arrays ${arrays#:}, merged by ${merge%%;*}"
)sh";
}

std::string parallel_script(const Submission& s) {
    const std::string beginning = fmt::format(R"sh(#!/usr/bin/env bash
# {name} in {shards} shards by GNU parallel, and their merge:
#
#   bash {name}.parallel.sh [OPTION OF parallel, such as --sshloginfile F].. (default: --jobs 100%)
#
# Can be run again: by the log of jobs those that failed or never ran.
set -euo pipefail

)sh",
                                              fmt::arg("name", s.name), fmt::arg("shards", s.shards));
    return beginning + assignments(s) + fmt::format("name={}\n", s.name) + R"sh(
mkdir -p "$output/shards"
(($#)) || set -- --jobs 100%
failed=0
seq "$shards" | parallel "$@" --joblog "$output/$name.joblog" --resume-failed --retries 3 --quote \
    "$program" run "$experiment" "${options[@]}" --shard "{}/$shards" --plan "$plan" \
    --output "$output/shards/{}" --jobs "$jobs" --quiet || failed=$?
((failed == 0)) || echo "$name: $failed shards failed; see $output/$name.joblog" >&2
exec "$program" merge "$output"/shards/*/ "${merge_options[@]}" --output "$output"
)sh";
}

std::string snakefile(const Submission& s) {
    const std::string values = fmt::format(
        "PROGRAM = {}\nEXPERIMENT = {}\nOUTPUT = {}\nPLAN = {}\nNAME = {}\nSHARDS = {}\nJOBS = {}\nMINUTES = {}\n"
        "OPTIONS = {}\nMERGE_OPTIONS = {}\n",
        json_string(s.program), json_string(s.experiment), json_string(s.output), json_string(s.plan),
        json_string(s.name), s.shards, s.jobs, (s.seconds + 59) / 60, python_list(s.options),
        python_list(s.merge_options));
    return fmt::format(
               "# {} in {} shards by Snakemake, and their merge:\n#\n#   snakemake --snakefile {}.Snakefile --cores "
               "all "
               "--keep-going --rerun-incomplete\n\n",
               s.name, s.shards, s.name) +
           values + R"py(# in names of files a brace begins a wildcard
PLACE = OUTPUT.replace("{", "{{").replace("}", "}}")


rule all:
    input:
        f"{PLACE}/{NAME}.merged",


rule shard:
    output:
        touch(PLACE + "/shards/{shard}.done"),
    params:
        command=lambda wildcards: [
            PROGRAM, "run", EXPERIMENT, *OPTIONS, "--shard", f"{wildcards.shard}/{SHARDS}", "--plan", PLAN,
            "--output", f"{OUTPUT}/shards/{wildcards.shard}", "--jobs", str(JOBS), "--quiet",
        ],
    wildcard_constraints:
        shard="[0-9]+",
    threads: JOBS
    retries: 3
    resources:
        runtime=MINUTES,
    shell:
        "{params.command:q}"


rule merge:
    input:
        expand(PLACE + "/shards/{shard}.done", shard=range(1, SHARDS + 1)),
    output:
        touch(f"{PLACE}/{NAME}.merged"),
    params:
        command=lambda wildcards: [
            PROGRAM, "merge", *(f"{OUTPUT}/shards/{shard}" for shard in range(1, SHARDS + 1)), *MERGE_OPTIONS,
            "--output", OUTPUT,
        ],
    shell:
        "{params.command:q}"
)py";
}

}  // namespace polhode
