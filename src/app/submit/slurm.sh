#!/usr/bin/env bash
# Runs @name@ in @shards@ shards with Slurm and merges the results:
#
#   bash @name@.slurm.sh [OPTION OF sbatch, such as --partition=P]..
#
# Can be submitted again: finished cases are kept. The time limit is three times the expected time of the longest shard
# plus ten minutes.
set -euo pipefail

program=@program@
experiment=@experiment@
output=@output@
plan=@plan@
shards=@shards@
jobs=@jobs@
options=(@options@)
merge_options=(@merge_options@)
time=@time@
name=@name@

# requeue TASK REASON: requeues this task, at most five times
requeue() {
    if ((${SLURM_RESTART_COUNT:-0} >= 5)); then
        echo "$name: $2; not queued again: the limit is five times" >&2
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
    # signal one minute before the time limit: finish the current case; the next start runs the remaining cases
    trap 'out_of_time=1; [[ -z $child ]] || kill -TERM "$child" 2>/dev/null || true' USR1
    "$program" run "$experiment" "${options[@]}" --shard "$shard/$shards" --plan "$plan" \
        --output "$output/shards/$shard" --jobs "$jobs" --quiet &
    child=$!
    # the signal may have arrived before the child started
    ((!out_of_time)) || kill -TERM "$child" 2>/dev/null || true
    wait "$child" || status=$?
    if ((out_of_time)); then
        wait "$child" || true
        requeue "$task" "shard $shard ran out of time"
    elif ((status > 128)); then
        requeue "$task" "shard $shard was terminated by signal $((status - 128))"
    fi
    exit "$status"
    ;;
merge)
    exec "$program" merge "$output"/shards/*/ "${merge_options[@]}" --output "$output"
    ;;
esac

mkdir -p "$output/shards" "$output/logs"
# the largest array index of a cluster is MaxArraySize - 1
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
