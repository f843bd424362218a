#!/bin/sh
# Counts instructions of tracing and gathering in homogeneous isotropic fog: by the program, by loops written for that case
# alone, and by kiddo's own search. Fails if the program needs more than 5 % above those loops, or more than
# 4000 (k = 50) or 11000 (k = 200) instructions to find the photons of a query.
# Needs valgrind, which knows AVX2 and not AVX-512.
set -eu
cd "$(dirname "$0")/.."
bench=${1:-$(cargo bench --bench instructions --no-run --message-format=json 2>/dev/null |
    sed -n 's/.*"executable":"\([^"]*instructions-[^"]*\)".*/\1/p' | tail -n 1)}
# A copy by "rep movsb" is one instruction and counted as one a byte.
GLIBC_TUNABLES=glibc.cpu.x86_rep_movsb_threshold=1000000000
export GLIBC_TUNABLES
counts=$(mktemp)
trap 'rm -f "$counts"' EXIT

# Instructions of one round.
count() {
    for rounds in 1 2; do
        valgrind --tool=callgrind --callgrind-out-file=/dev/null "$bench" "$1" "$rounds" 2>"$counts" >/dev/null
        sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$counts"
    done | paste -s -d ' ' | awk '{ printf "%.0f", $2 - $1 }'
}

photons=20000
queries=65536
status=0
report() { # work, unit, units
    result=$(count "$1")
    echo "$1: $((result / $3)) instructions a $2"
}
at_most() { # what, limit
    echo "$1 (at most $2)"
    awk "BEGIN { exit !($3 <= $2) }" || { echo "too many"; status=1; }
}

report trace-loop photon $photons; alone=$result
report trace-program photon $photons
ratio=$(awk "BEGIN { printf \"%.3f\", $result / $alone }")
at_most "tracing, program / loop: $ratio" 1.05 "$ratio"
for k in 50 200; do
    report uniform-loop-$k query $queries; alone=$result
    report uniform-program-$k query $queries
    ratio=$(awk "BEGIN { printf \"%.3f\", $result / $alone }")
    at_most "gathering, program / loop: $ratio" 1.05 "$ratio"
    report uniform-radius-$k query $queries
    limit=4000; [ $k = 200 ] && limit=11000
    at_most "the k nearest alone: $((result / queries))" $limit $((result / queries))
    report uniform-kiddo-$k query $queries
done
exit $status
