#!/usr/bin/env bash
# How the cost of a picture grows with pixels (0.1 to 64 million), spheres (10 to 10^6), lights (1 to 256), depth (1 to 32) and
# unbounded planes (1 to 64), as tables and, where asked, CSV. Some minutes; the largest pictures need 1 to 2 GB.
#
#     cargo build --release && benches/peers/growth.sh [-n 3] [--only spheres,lights] [--csv FILE] [--rtdsl PROGRAM]
set -euo pipefail
exec python3 -B "$(cd "$(dirname "$0")" && pwd)/growth.py" "$@"
