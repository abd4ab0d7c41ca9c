#!/usr/bin/env bash
# What accuracy costs in every example: the front of `rtdsl trade`, the setting to take and why, how many pixels keep 4/255 how
# surely, and what 32 bits bring; as a table in Markdown.
#
#     cargo build --release && benches/accuracy/examples.sh [--budget 30s] [--pixels 15000] [--only glass,sea] [--rtdsl PROGRAM]
#
# Needs Python 3. Takes about twice the budget for each of the examples.
set -euo pipefail
exec python3 -B "$(cd "$(dirname "$0")" && pwd)/examples.py" "$@"
