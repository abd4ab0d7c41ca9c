"""Every example through `rtdsl trade`, and the setting to take.

The rule by which a setting is chosen: the scene's own if it is on the front, of the largest error or of the RMSE; else what
beats it, the quickest setting of the front that is no worse in both; else the knee.

32 bits are timed apart from the sweep, on larger pictures, one thread, in turn with 64 bits: the least of five.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LARGE = 300_000  # pixels of the pictures by which 32 bits are timed
RUNS = 5


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--budget", default="30s", help="time for each sweep (30s)")
    parser.add_argument("--pixels", type=int, default=15_000, help="of each picture of a sweep (15000)")
    parser.add_argument("--only", default="", help="examples, by commas")
    parser.add_argument("--rtdsl", type=Path, default=ROOT / "target/release/rtdsl")
    args = parser.parse_args()
    wanted = [name for name in args.only.split(",") if name]
    scenes = [p for p in sorted((ROOT / "examples").glob("*.scene")) if not wanted or p.stem in wanted]
    print("| example | its own setting | front, from quick to exact | take | 4/255: proved, bounded, estimated, open | 32 bits |")
    print("|---|---|---|---|---|---|")
    for scene in scenes:
        print(row(args, scene), flush=True)
        print(f"{scene.stem} done", file=sys.stderr)


def run(command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if not done.stdout:
        raise RuntimeError(done.stderr[-2000:])
    return done


def render(args, scene, desk, *options):
    command = [args.rtdsl, "render", scene, "-q", "-o", desk / "picture.png", "--stats", "json", *options]
    return json.loads(run(command).stdout)


def size(shape, pixels):
    """The scene's proportions at so many pixels."""
    factor = math.sqrt(pixels / (shape[0] * shape[1]))
    return "x".join(str(max(1, round(side * factor))) for side in shape)


def row(args, scene):
    with tempfile.TemporaryDirectory() as desk:
        desk = Path(desk)
        own = render(args, scene, desk, "--aa", "off")["size"]
        small = size(own, args.pixels)
        # A code of 4: the sweep found what must not be, and tells it.
        command = [args.rtdsl, "trade", scene, "--size", small, "--budget", args.budget, "-q", "-o", desk / "trade"]
        swept = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        report = json.loads((desk / "trade/trade.json").read_text())
        if swept.returncode != 0 or report["violations"]:
            print(f"{scene.stem}: {swept.stderr} {report['violations']}", file=sys.stderr)
        sure = render(args, scene, desk, "--size", small, "--max-error", "4/255")
        bits = thirty_two(args, scene, desk, size(own, LARGE), report)
    points = report["points"]
    cells = [
        scene.stem,
        told(points[0]),
        " · ".join(points[i]["label"] for i in by_time(points, report["front"])),
        chosen(report),
        shares(sure),
        bits,
    ]
    return f"| {' | '.join(cells)} |"


def told(p):
    return f"{p['setting']}: {milliseconds(p)}, errs by {p['max'][0]:.1f}, RMSE {p['rmse'][0]:.2f}"


def milliseconds(p):
    ms = 1e3 * p["seconds"]
    return f"{ms:.0f} ms" if ms >= 10 else f"{ms:.1f} ms"


def by_time(points, which):
    return sorted(which, key=lambda i: points[i]["seconds"])


def chosen(report):
    points, own = report["points"], report["points"][0]
    if 0 in report["front"] or 0 in report["front_rmse"]:
        return "its own: nothing is as good in less time"
    front = by_time(points, set(report["front"]) | set(report["front_rmse"]))
    worst = lambda p, what: p[what][0]
    for i in front:
        p = points[i]
        better = p["seconds"] <= own["seconds"] and all(worst(p, what) <= worst(own, what) for what in ("max", "rmse"))
        if better and p["depth"] == own["depth"] and p["precision"] == own["precision"]:
            return f"{told(p)}; better and quicker"
    if report["knee"] is None:
        return "its own"
    return f"{told(points[report['knee']])}; the knee"


def shares(stats):
    a = stats["accuracy"]
    kinds = [a[kind] for kind in ("proved", "bounded", "estimated", "open")]
    of = sum(kinds)
    return ", ".join(f"{100 * n / of:.3g} %" if n else "0" for n in kinds) + f"; {stats['seconds']['render']:.2f} s"


def thirty_two(args, scene, desk, large, report):
    times = {"f64": [], "f32": []}
    for _ in range(RUNS):
        for precision, seconds in times.items():
            options = ["--size", large, "--aa", "grid:2", "--threads", "1", "--precision", precision]
            try:
                seconds.append(render(args, scene, desk, *options)["seconds"]["render"])
            except RuntimeError as error:
                return "can't: " + str(error).splitlines()[0].removeprefix("error: ")
    changes = [p["change"] for p in report["points"] if p["precision"] == "f32"]
    change = f", changes {changes[0]:.1f}" if changes else ""
    return f"{min(times['f64']) / min(times['f32']):.2f} × as quick{change}"


if __name__ == "__main__":
    main()
