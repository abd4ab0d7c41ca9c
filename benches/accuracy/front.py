"""The seed scene by rtdsl and POV-Ray at many settings: seconds of tracing, and how far the picture is from the true one.

The truth is rtdsl's picture at half a code, of 16 bits, all but a few pixels of it proved. The two programs' pictures of one ray
a pixel are the same but for a few pixels, so it is the truth for both. Times are the clock's, with as many threads as each
program takes by itself, the least of n runs; POV-Ray tells its own time of tracing, and so does rtdsl.
"""

import argparse
import json
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benches/extremes"))
import seed  # noqa: E402

GLOBE = ROOT / "examples/assets/earth.png"

# POV-Ray's switches, and how many times less we should need to be as good.
POVRAY = (
    (["-A"], None),
    (["+AM2", "+R2", "+A0.3"], None),
    (["+AM1", "+R3", "+A0.3"], None),
    (["+AM1", "+R3", "+A0.1"], 15),
    (["+AM1", "+R4", "+A0.05"], 15),
    (["+AM1", "+R5", "+A0.03"], 15),
    (["+AM1", "+R9", "+A0.0"], 30),
)
GRIDS = (1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32)
ADAPTIVE = (4, 6, 8, 16, 32, 64, 256)
TIMES = ("50ms", "100ms", "150ms", "200ms", "300ms", "400ms", "600ms", "1s")
ERRORS = (32, 16, 8, 4, 2, 1)


def codes(path):
    """sRGB codes, in steps of 8 bits."""
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB")).astype(float)


def codes_of_16_bits(path):
    """Likewise of a PNG of 16 bits, which Pillow would cut to 8."""
    data = path.read_bytes()
    at, body = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind = data[at + 4 : at + 8]
        chunk = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height = struct.unpack(">II", chunk[:8])
        if kind == b"IDAT":
            body += chunk
        at += 12 + length
    raw = zlib.decompress(body)
    stride = 6 * width
    out = np.zeros((height, stride), dtype=np.uint8)
    before = np.zeros(stride, dtype=int)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = np.frombuffer(raw, dtype=np.uint8, count=stride, offset=y * (stride + 1) + 1).astype(int)
        row = unfiltered(kind, row, before)
        out[y], before = row, row
    wide = out.reshape(height, width, 3, 2).astype(float)
    return (256 * wide[..., 0] + wide[..., 1]) / 257


def unfiltered(kind, row, before):
    if kind == 0:
        return row
    if kind == 2:
        return (row + before) % 256
    row = row.copy()
    for i in range(len(row)):
        left, corner = (row[i - 6], before[i - 6]) if i >= 6 else (0, 0)
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + before[i]) // 2
        else:
            p = left + before[i] - corner
            guess = min((abs(p - left), 0, left), (abs(p - before[i]), 1, before[i]), (abs(p - corner), 2, corner))[2]
        row[i] = (row[i] + guess) % 256
    return row


def errors(picture, truth):
    off = np.abs(picture - truth)
    return float(np.sqrt((off**2).mean())), float(np.quantile(off.max(axis=2), 0.99)), float(off.max())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=3, help="runs of each setting (3)")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--json", action="store_true", help="figures for programs instead of a table")
    parser.add_argument("--rtdsl", type=Path, default=ROOT / "target/release/rtdsl")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as desk:
        rows = measure(args, Path(desk))
    print(json.dumps(rows) if args.json else table(rows, args.size))


def measure(args, desk):
    scene, pov = desk / "seed.scene", desk / "seed.pov"
    scene.write_text(seed.rtdsl(1, 0, GLOBE))
    pov.write_text(seed.povray(1, 0, GLOBE))
    out = desk / "picture.png"

    def ours(options):
        command = [args.rtdsl, "render", scene, "--allow-read", GLOBE.parent, "-q", "-o", out, "--size", args.size]
        done = subprocess.run([str(c) for c in [*command, "--stats", "json", *options]], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)
        return json.loads(done.stdout)

    def theirs(switches):
        width, height = args.size.split("x")
        command = ["povray", f"+I{pov}", f"+O{out}", f"+W{width}", f"+H{height}", "-D", "-J", *switches]
        done = subprocess.run(command, cwd=desk, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr[-2000:])
        return float(re.search(r"Trace Time:.*\(([0-9.]+) seconds\)", done.stderr)[1])

    ours(["--max-error", "0.5/255", "--bits", "16"])
    truth = codes_of_16_bits(out)
    rows = []

    def add(name, kind, run, **more):
        seconds = min(run() for _ in range(args.n))
        rmse, p99, most = errors(codes(out), truth)
        rows.append({"setting": name, "kind": kind, "seconds": seconds, "rmse": rmse, "p99": p99, "max": most, **more})
        print(f"{name}: {seconds:.3f} s, RMSE {rmse:.2f}", file=sys.stderr)

    for n in GRIDS:
        add(f"grid {n} × {n}", "grid", lambda: ours(["--aa", f"grid:{n}"])["seconds"]["render"])
    for n in ADAPTIVE:
        add(f"adaptive {n}", "adaptive", lambda: ours(["--aa", f"adaptive:{n}"])["seconds"]["render"])
    for time in TIMES:
        add(f"`--time {time}`", "time", lambda: ours(["--time", time])["seconds"]["render"])
    for e in ERRORS:
        add(f"`--max-error {e}/255`", "error", lambda: ours(["--max-error", f"{e}/255"])["seconds"]["render"])
    if shutil.which("povray"):
        for switches, wanted in POVRAY:
            add(f"POV-Ray {' '.join(switches)}", "povray", lambda: theirs(switches), wanted=wanted)
            compared(rows[-1], rows)
    return rows


def compared(row, rows):
    """How much longer POV-Ray takes than the quickest of our settings that is at least as good."""
    better = [r for r in rows if r["kind"] != "povray" and r["rmse"] <= row["rmse"]]
    best = min(better, key=lambda r: r["seconds"], default=None)
    if best:
        row.update(ratio=row["seconds"] / best["seconds"], beside=best["setting"])


def table(rows, size):
    lines = [f"Seed scene, {size}.", "", "| setting | tracing, s | RMSE | p99 | max | as good by rtdsl | wanted |", "|---|--:|--:|--:|--:|---|---|"]
    for r in rows:
        ours = f"{r['beside']}: 1/{r['ratio']:.1f}" if "ratio" in r else ""
        wanted = f"1/{r['wanted']}" if r.get("wanted") else ""
        lines.append(f"| {r['setting']} | {r['seconds']:.3f} | {r['rmse']:.2f} | {r['p99']:.1f} | {r['max']:.1f} | {ours} | {wanted} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
