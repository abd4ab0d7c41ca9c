#!/usr/bin/env bash
# Extremes beside the peers: renders the seed scene, scaled and moved, with POV-Ray, Tachyon and rtdsl, and prints a table of
# how many pixels change. Ends with 1 if more than 0.01 % change in rtdsl's.
#
#     cargo build --release && benches/extremes/extremes.sh [--json] [--picture OUT.png] [--size 640x360] [--rtdsl PROGRAM]
#
# Needs Python 3 with venv; the peers are Debian's packages `povray` and `tachyon`, and one that isn't installed is left out.
# NumPy and Pillow go into target/extremes.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tools=$here/../../target/extremes

if ! "$tools/bin/python" -c 'import numpy, PIL' 2>/dev/null; then
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet --disable-pip-version-check 'numpy>=1.26' 'pillow>=10.1' # 10.1: its own font in any size
fi
exec "$tools/bin/python" -B "$here/extremes.py" "$@"
