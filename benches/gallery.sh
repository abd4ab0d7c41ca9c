#!/usr/bin/env bash
# What `rtdsl gallery` costs when nothing changed: makes 30 small scenes once, then prints the median time of whole processes
# that find nothing to do. The bound that it is held to: 100 ms.
#
#     cargo build --release && benches/gallery.sh [PROGRAM] [RUNS]
set -euo pipefail
program=$(realpath "${1:-target/release/rtdsl}")
runs=${2:-21}
examples=$(realpath "$(dirname "$0")/../examples")
desk=$(mktemp -d)
trap 'rm -rf "$desk"' EXIT
cd "$desk"

# The examples, some of them twice: real texts, real imports, real pictures.
mkdir scenes
cp -r "$examples"/assets "$examples"/lib scenes/
n=0
while [ "$n" -lt 30 ]; do
    for scene in "$examples"/*.scene; do
        [ "$n" -lt 30 ] || break
        n=$((n + 1))
        cp "$scene" "scenes/$n-$(basename "$scene")"
    done
done
"$program" gallery scenes -o out --width 480 --aa off --quiet
printf '%s files, %s bytes\n' "$(find out -type f | wc -l)" "$(du -sb out | cut -f1)"

for _ in $(seq "$runs"); do
    start=$(date +%s%N)
    "$program" gallery scenes -o out --width 480 --aa off --quiet
    end=$(date +%s%N)
    echo $(((end - start) / 10000))
done | sort -n | awk '{ t[NR] = $1 / 100 } END { printf "median of %d runs: %.1f ms (fastest %.1f, slowest %.1f)\n", NR, t[int((NR + 1) / 2)], t[1], t[NR] }'
