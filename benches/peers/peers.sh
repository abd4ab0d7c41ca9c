#!/usr/bin/env bash
# The peers beside rtdsl: the same work done by each, in turn, and a table of ratios to hold a change against. It judges
# nothing: it always ends with 0, and figures of one run compare only with each other.
#
#     cargo build --release && benches/peers/peers.sh [-n 9] [--only seed,mesh] [--rtdsl PROGRAM] [--work FOLDER] [--embree]
#
# Needs Python 3 and nothing of its packages. A peer that isn't installed is left out: Debian's packages `tachyon`, `povray`,
# `lua5.4`, for --embree `g++` and `libembree-dev`; Mitsuba is `pip install mitsuba` in some Python, given as
# `--mitsuba PATH/bin/python`. `--help` lists all options.
set -euo pipefail
exec python3 -B "$(cd "$(dirname "$0")" && pwd)/peers.py" "$@"
