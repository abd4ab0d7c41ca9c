#!/usr/bin/env bash
# What accuracy costs: the seed scene by rtdsl, with one ray a pixel, grids, times and stated errors, and by POV-Ray with and
# without its adaptive anti-aliasing; the time of tracing beside the error, in one table.
#
#     cargo build --release && benches/accuracy/front.sh [-n 3] [--size 1280x720] [--json] [--rtdsl PROGRAM]
#
# Needs Python 3 with numpy and Pillow, and POV-Ray (Debian's `povray`), without which its rows are left out.
set -euo pipefail
exec python3 -B "$(cd "$(dirname "$0")" && pwd)/front.py" "$@"
