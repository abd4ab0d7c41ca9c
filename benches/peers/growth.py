"""How cost grows with pixels, objects, lights, depth and unbounded planes; see growth.sh. Every scene is written here, in the
language itself. Prints a table for each, and writes everything as CSV where asked.

A time is that of tracing alone, as `--stats json` tells it, on one thread, the shortest of several runs, over the number of all
rays. Bytes an object are those that the scene holds while it is traced, by `rtdsl explain`, less those of the smallest, over
the objects that it has more.
"""
import argparse
import csv
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

HEAD = '''rtdsl 1
camera(from: [0, 6, 24], at: [0, 2, 0], fov: 30deg)
background(linear(0.5, 0.6, 0.8))
'''
LIGHT = 'light(at: [15, 30, 15])\n'
FLOOR = 'plane(y: 0, mat: phong(color: checker(linear(0.9, 0.9, 0.85), linear(0.15, 0.35, 0.2))))\n'


def spheres(n):
    """`n` balls in the same room that fill as much of it whatever `n` is; one in four is a mirror. (Balls that hide as much of it
    get so small that a ray passes between ever more of them, by the cube root of `n`, before it meets one.)"""
    return f'''let skins = [for i in 0..4 {{ phong(color: hsv(i * 90deg, 0.6, 0.7), reflect: if i == 3 {{ 0.6 }} else {{ 0 }}) }}]
for i in 0..{n} {{ sphere(at: in_box([-8, 0, -8], [8, 6, 8], i), r: {2.15 / n ** (1 / 3):.9f}, mat: skins[i % 4]) }}
'''


def lights(n):
    """`n` lights on a ring, as strong all together as one."""
    return f'for i in 0..{n} {{ light(at: [15 * cos(i * {360 / n:.9f}deg), 30, 15 * sin(i * {360 / n:.9f}deg)], power: {1 / n:.9f}) }}\n'


def depth(n):
    """A room of mirrors, with a ball in it, that sends most rays on and on."""
    wall = 'mat: phong(color: linear(0.05, 0.05, 0.05), reflect: 0.95)'
    walls = ''.join(f'plane({way}, {wall})\n' for way in ('x: -9', 'x: 9', 'z: -9', 'z: 25', 'y: 12'))
    return f'{walls}sphere(at: [0, 3, 0], r: 2, {wall})\nrender(depth: {n})\n'


def planes(n):
    """`n` floors, one below the other, of which only the first is seen."""
    return f'for i in 0..{n} {{ plane(y: -i, mat: matte(gray(0.5))) }}\nsphere(at: [0, 2, 0], r: 2)\n'


SMALL = LIGHT + FLOOR + spheres(12)
# name, what is counted, the counts, the scene of a count (`None`: the picture's width), the picture's width
CURVES = (
    ('pixels', (427, 1280, 2560, 5120, 10667), lambda _: SMALL, None),
    ('spheres', (10, 100, 1_000, 10_000, 100_000, 1_000_000), lambda n: LIGHT + FLOOR + spheres(n), 640),
    ('lights', (1, 4, 16, 64, 256), lambda n: lights(n) + FLOOR + spheres(100), 320),
    ('depth', (1, 2, 4, 8, 16, 32), lambda n: LIGHT + FLOOR + depth(n), 640),
    ('planes', (1, 4, 16, 64), lambda n: LIGHT + planes(n), 640),
)
COLUMNS = ('curve', 'count', 'pixels', 'rays', 'seconds', 'ns_a_ray', 'evaluate_seconds', 'world_seconds', 'peak_bytes', 'held_bytes', 'bytes_an_object')


def measure(rtdsl, desk, text, width, runs):
    """Statistics of the fastest run, and the bytes held for tracing."""
    (desk / 'a.scene').write_text(HEAD + text)
    size = f'{width}x{round(width * 9 / 16)}'
    command = [rtdsl, 'render', 'a.scene', '--size', size, '--aa', 'off', '--threads', '1', '--stats', 'json', '-o', 'a.png']
    found = []
    while len(found) < runs and (not found or found[0]['seconds']['total'] < 8):  # slow ones need no second look
        done = subprocess.run(command, cwd=desk, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr[-1000:])
        found.append(json.loads(done.stdout))
    explained = subprocess.run([rtdsl, 'explain', 'a.scene'], cwd=desk, capture_output=True, text=True, check=True).stdout
    held = 1e3 * float(re.search(r'([0-9.]+) kB held for tracing', explained)[1])
    return min(found, key=lambda s: s['seconds']['render']), held


def curve(name, counts, text, width, rtdsl, desk, runs):
    rows, least = [], None
    for n in counts:
        stats, held = measure(rtdsl, desk, text(n), width or n, runs)
        pixels, rays, seconds = stats['size'][0] * stats['size'][1], stats['rays']['total'], stats['seconds']
        least = least or (n, held)
        each = (held - least[1]) / (n - least[0]) if name in ('spheres', 'planes') and n > least[0] else None
        cells = name, pixels if width is None else n, pixels, rays, seconds['render'], 1e9 * seconds['render'] / rays
        rows.append(dict(zip(COLUMNS, (*cells, seconds['evaluate'], seconds['world'], stats['peak_memory_bytes'], held, each))))
    return rows


def table(name, rows):
    print(f'\n| {name} | rays | ns a ray | beside the first | tracing, s | most memory, MB | bytes an object |\n|---|---|---|---|---|---|---|')
    for r in rows:
        memory = '' if r['peak_bytes'] is None else f'{r["peak_bytes"] / 1e6:.1f}'
        each = '' if r['bytes_an_object'] is None else f'{r["bytes_an_object"]:.0f}'
        ratio = r['ns_a_ray'] / rows[0]['ns_a_ray']
        print(f'| {r["count"]:,} | {r["rays"]:,} | {r["ns_a_ray"]:.1f} | {ratio:.2f} | {r["seconds"]:.3f} | {memory} | {each} |', flush=True)


def main():
    names = ', '.join(c[0] for c in CURVES)
    parse = argparse.ArgumentParser(prog='growth.sh', description=__doc__.split('\n\n')[0])
    parse.add_argument('-n', type=int, default=3, help='runs, of which the fastest counts')
    parse.add_argument('--only', default='', help=f'curves, divided by commas: {names}')
    parse.add_argument('--rtdsl', default=ROOT / 'target/release/rtdsl', type=Path, help='the program that is measured')
    parse.add_argument('--csv', type=Path, help='where to write all figures')
    args = parse.parse_args()
    wanted, everything = set(args.only.split(',')) - {''}, []
    if wanted - {c[0] for c in CURVES} or args.n < 1:
        parse.error(f'-n is at least 1, and the curves are {names}')
    with tempfile.TemporaryDirectory() as desk:
        for name, counts, text, width in CURVES:
            if not wanted or name in wanted:
                rows = curve(name, counts, text, width, args.rtdsl.resolve(), Path(desk), args.n)
                table(name, rows)
                everything += rows
    if args.csv:
        with open(args.csv, 'w', newline='') as file:
            out = csv.DictWriter(file, COLUMNS)
            out.writeheader()
            out.writerows(everything)


if __name__ == '__main__':
    main()
