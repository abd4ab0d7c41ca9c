"""Renders the seed scene, scaled and moved, with POV-Ray, Tachyon and rtdsl; compares each picture with the same program's
picture of the scene as written; prints one table, and makes a picture of it.

A pixel counts as changed if a channel of the program's own 8-bit picture differs by more than 2 codes.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import seed

# name, factor of all lengths, move along x after it, whether a row of the picture
VARIANTS = (
    ("as written", 1, 0, True),
    ("× 1e-6", 1e-6, 0, True),
    ("× 1e-3", 1e-3, 0, False),
    ("× 1e3", 1e3, 0, False),
    ("× 1e6", 1e6, 0, True),
    ("× 1e9", 1e9, 0, True),
    ("moved by 1e3", 1, 1e3, False),
    ("moved by 1e5", 1, 1e5, False),
    ("moved by 1e7", 1, 1e7, True),
    ("moved by 1e12", 1, 1e12, False),
)
CODES = 2  # a pixel that differs by no more than this in each channel counts as the same
BOUND = 1e-4  # the share of pixels that may change in rtdsl's picture

GLOBE = Path(__file__).resolve().parents[2] / "examples/assets/earth.png"


class PovRay:
    name, program = "POV-Ray", "povray"

    def version(self):
        found = subprocess.run([self.program, "--version"], capture_output=True, text=True)
        return re.search(r"POV-Ray (\S+)", found.stdout + found.stderr)[1]

    def picture(self, s, tx, size, desk):
        scene, out = desk / "seed.pov", desk / "povray.png"
        scene.write_text(seed.povray(s, tx, GLOBE))
        switches = ["-D", "-V", "-A"]  # no window, no chatter, no anti-aliasing
        return render([self.program, f"+I{scene}", f"+O{out}", f"+W{size[0]}", f"+H{size[1]}", *switches], desk, out)

    def for_display(self, picture):
        return picture


class Tachyon:
    name, program = "Tachyon", "tachyon"

    def version(self):
        # It names itself when it has a scene to read, be it one that isn't there.
        found = subprocess.run([self.program, "none.dat"], capture_output=True, text=True)
        return re.search(r"Version (\S+)", found.stdout)[1]

    def picture(self, s, tx, size, desk):
        scene, out = desk / "seed.dat", desk / "tachyon.png"
        maps = {name: desk / f"{name}.ppm" for name in ("globe", "stripes", "floor")}
        self.make_maps(maps)
        scene.write_text(seed.tachyon(s, tx, size, *maps.values()))
        switches = ["-aasamples", "0", "-res", str(size[0]), str(size[1]), "-format", "PNG"]
        return render([self.program, scene, *switches, "-o", out], desk, out)

    def make_maps(self, maps):
        """Tachyon computes with the codes of a picture as they are: so these hold linear values."""
        if maps["globe"].exists():
            return
        globe = codes(GLOBE) / 255
        save_linear(np.where(globe <= 0.04045, globe / 12.92, ((globe + 0.055) / 1.055) ** 2.4), maps["globe"])
        rows = 4096
        height = seed.STRIPED_AT[1] + seed.STRIPED_R * np.sin((0.5 - (np.arange(rows) + 0.5) / rows) * np.pi)
        odd = np.floor(height / seed.STRIPE).astype(int) % 2
        save_linear(np.repeat(np.array(seed.STRIPES)[odd][:, None], 8, axis=1), maps["stripes"])
        # Odd: the picture's edges are wrapped round, between its first and its last pixel.
        side = 2048
        square = (np.arange(side) * seed.SQUARES / (side - 1)).astype(int) % seed.SQUARES
        dark = (square[:, None] + square[None, :]) % 2
        save_linear(np.array((seed.LIGHT_SQUARE, seed.DARK_SQUARE))[dark], maps["floor"])

    def for_display(self, picture):
        """Tachyon writes linear values: they get sRGB's curve, as the other two have it."""
        v = picture / 255
        return np.rint(255 * np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)).astype(np.uint8)


class Rtdsl:
    name = "rtdsl"

    def __init__(self, program):
        self.program = program

    def version(self):
        return subprocess.run([self.program, "--version"], capture_output=True, text=True).stdout.split()[-1]

    def picture(self, s, tx, size, desk):
        scene, out = desk / "seed.scene", desk / "rtdsl.png"
        scene.write_text(seed.rtdsl(s, tx, GLOBE))
        switches = ["--size", f"{size[0]}x{size[1]}", "--allow-read", GLOBE.parent, "--quiet"]
        return render([self.program, "render", scene, *switches, "-o", out], desk, out)

    def for_display(self, picture):
        return picture


def render(command, desk, out):
    """Runs `command`, which leaves its picture at `out`."""
    out.unlink(missing_ok=True)
    done = subprocess.run([str(c) for c in command], cwd=desk, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return codes(out)


def codes(path):
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def save_linear(values, path):
    Image.fromarray(np.rint(255 * values).astype(np.uint8)).save(path)


def difference(here, there):
    """How many pixels changed, their share, and the greatest difference of a channel."""
    far = np.abs(here.astype(int) - there.astype(int)).max(axis=2)
    changed = int((far > CODES).sum())
    return {"pixels": changed, "share": changed / far.size, "max": int(far.max())}


def measure(tools, size, desk):
    """Pictures by tool and variant, and a row of findings for each variant but the first."""
    pictures, rows = {}, []
    for name, s, tx, _ in VARIANTS:
        row = {"scene": name, "scale": s, "moved": tx, "tools": {}}
        for tool in tools:
            print(f"  {tool.name}, {name}", file=sys.stderr)
            pictures[tool.name, name] = tool.picture(s, tx, size, desk)
            row["tools"][tool.name] = difference(pictures[tool.name, VARIANTS[0][0]], pictures[tool.name, name])
        rows.append(row)
    return pictures, rows[1:]


def amount(cell):
    """How much changed: few pixels as their number, more as their share."""
    n, p = cell["pixels"], 100 * cell["share"]
    return "no pixel" if n == 0 else f"{n} pixel{'s' if n > 1 else ''}" if p < 0.01 else f"{p:.0f} %" if p >= 10 else f"{p:.2g} %"


def table(tools, rows):
    lines = ["| scene | " + " | ".join(f"{t.name} {t.version()}" for t in tools) + " |", "|---" * (len(tools) + 1) + "|"]
    for row in rows:
        cells = (f"{amount(c)}, most {c['max']}" if c["max"] else "the same" for c in row["tools"].values())
        lines.append(f"| {row['scene']} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


CELL, GAP, LEFT, TOP, CAPTION = (240, 135), 8, 96, 26, 18


def sheet(tools, pictures, rows):
    """Columns of programs, rows of variants; under each cell what changed."""
    found = {(name, row["scene"]): amount(cell) for row in rows for name, cell in row["tools"].items()}
    shown = [name for name, _, _, is_shown in VARIANTS if is_shown]
    width = LEFT + len(tools) * (CELL[0] + GAP)
    height = TOP + len(shown) * (CELL[1] + CAPTION + GAP)
    out = Image.new("RGB", (width, height), "white")
    draw, large, small = ImageDraw.Draw(out), ImageFont.load_default(15), ImageFont.load_default(12)
    for r, name in enumerate(shown):
        top = TOP + r * (CELL[1] + CAPTION + GAP)
        # Pillow's font has no ×.
        label = name.replace("× ", "lengths\ntimes ").replace(" by ", "\nby ")
        draw.text((LEFT - 8, top + CELL[1] / 2), label, "black", small, anchor="rm", align="right")
        for column, tool in enumerate(tools):
            left = LEFT + column * (CELL[0] + GAP)
            if r == 0:
                draw.text((left + CELL[0] / 2, TOP / 2), tool.name, "black", large, anchor="mm")
            full = Image.fromarray(tool.for_display(pictures[tool.name, name]))
            out.paste(full.resize(CELL, Image.Resampling.LANCZOS), (left, top))
            changed = found.get((tool.name, name))
            text = "what the others are compared with" if changed is None else f"changed: {changed}"
            draw.text((left + CELL[0] / 2, top + CELL[1] + CAPTION / 2), text, "black", small, anchor="mm")
    return out.quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)  # looks the same, in a third of the bytes


def main():
    parse = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parse.add_argument("--rtdsl", default="target/release/rtdsl", type=Path, help="the program that is measured")
    parse.add_argument("--size", default="1280x720", help="of each picture, 16:9")
    parse.add_argument("--json", action="store_true", help="the findings as JSON instead of a table")
    parse.add_argument("--picture", type=Path, help="where to write the picture of the columns, a PNG")
    args = parse.parse_args()
    size = tuple(int(n) for n in args.size.split("x"))
    tools = []
    for tool in (PovRay(), Tachyon(), Rtdsl(args.rtdsl.resolve())):
        if shutil.which(tool.program):
            tools.append(tool)
        elif tool.name == "rtdsl":
            sys.exit(f"{tool.program} isn't there: cargo build --release")
        else:
            print(f"{tool.name} is left out: `{tool.program}` isn't installed", file=sys.stderr)
    with tempfile.TemporaryDirectory() as desk:
        pictures, rows = measure(tools, size, Path(desk))
    if args.json:
        versions = {t.name: t.version() for t in tools}
        print(json.dumps({"size": size, "codes": CODES, "versions": versions, "rows": rows}, indent=1))
    else:
        print(table(tools, rows))
    if args.picture:
        sheet(tools, pictures, rows).save(args.picture, optimize=True)
    wrong = [row["scene"] for row in rows if row["tools"]["rtdsl"]["share"] > BOUND]
    if wrong:
        sys.exit(f"rtdsl changes more than {100 * BOUND} % of the pixels: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
