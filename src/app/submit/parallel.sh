#!/usr/bin/env bash
# Runs @name@ in @shards@ shards with GNU parallel and merges the results:
#
#   bash @name@.parallel.sh [OPTION OF parallel, such as --sshloginfile F].. (default: --jobs 100%)
#
# Can be run again: it then runs the jobs that failed or did not run according to the job log.
set -euo pipefail

program=@program@
experiment=@experiment@
output=@output@
plan=@plan@
shards=@shards@
jobs=@jobs@
options=(@options@)
merge_options=(@merge_options@)
name=@name@

mkdir -p "$output/shards"
(($#)) || set -- --jobs 100%
failed=0
seq "$shards" | parallel "$@" --joblog "$output/$name.joblog" --resume-failed --retries 3 --quote \
    "$program" run "$experiment" "${options[@]}" --shard "{}/$shards" --plan "$plan" \
    --output "$output/shards/{}" --jobs "$jobs" --quiet || failed=$?
((failed == 0)) || echo "$name: $failed shards failed; see $output/$name.joblog" >&2
exec "$program" merge "$output"/shards/*/ "${merge_options[@]}" --output "$output"
