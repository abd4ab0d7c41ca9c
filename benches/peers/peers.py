"""Runs rtdsl and its peers on the same work, one after the other and again, and prints a table of ratios; see peers.sh.

A ratio is ours over theirs, the median over all pairs. Time is that of whole processes: cpu is user and system of all threads,
wall is the clock's. Every program writes its picture as PNG, with as many threads as it takes by itself.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from process import cost, median, peak

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


class Row:
    """A line of the table: the same work by us and by a peer, and what is aimed at (`None`: nothing)."""

    def __init__(self, group, work, against, ours, theirs, cpu=None, wall=None):
        self.group, self.work, self.against = group, work, against
        self.ours, self.theirs, self.cpu, self.wall = ours, theirs, cpu, wall

    def line(self, n, folder):
        pairs = [(cost(self.ours, folder), cost(self.theirs, folder)) for _ in range(n)]
        cpu, wall = (median(ours[k] / theirs[k] for ours, theirs in pairs) for k in (0, 1))
        ms = [1e3 * median(ours[k] for ours, _ in pairs) for k in (0, 1)]
        return cells(self.work, self.against, cpu, wall, target(self.cpu, self.wall), f'{ms[0]:.1f} cpu, {ms[1]:.1f} wall')


class Slope(Row):
    """What each further ray a pixel takes: each of `ours` and `theirs` is the run with one ray and that with 16."""

    def line(self, n, folder):
        def further(runs):
            one, many = (cost(run, folder)[0] for run in runs)
            return (many - one) / 15

        pairs = [(further(self.ours), further(self.theirs)) for _ in range(n)]
        ms = 1e3 * median(ours for ours, _ in pairs)
        return cells(self.work, self.against, median(a / b for a, b in pairs), None, target(self.cpu, None), f'{ms:.2f} cpu')


class Peak(Row):
    """The most memory held; its target stands in `cpu`'s place."""

    def line(self, n, folder):
        ours, theirs = (median(peak(run, folder) for _ in range(min(n, 3))) for run in (self.ours, self.theirs))
        wanted = f'memory ≤ {self.cpu}'
        return cells(self.work, self.against, None, None, wanted, f'{ours / 2**20:.1f} MiB', ours / theirs)


class Threads(Row):
    """How many times faster two threads trace than one: `ours` with two, `theirs` with one; both are our program."""

    def line(self, n, folder):
        def seconds(run):
            return json.loads(subprocess.run(run, cwd=folder, check=True, capture_output=True).stdout)['seconds']['render']

        pairs = [(seconds(self.ours), seconds(self.theirs)) for _ in range(n)]
        ms = 1e3 * median(two for two, _ in pairs)
        return cells(self.work, self.against, None, median(two / one for two, one in pairs), target(None, self.wall), f'{ms:.1f} wall')


def target(cpu, wall):
    return ', '.join(f'{word} ≤ {x}' for word, x in (('cpu', cpu), ('wall', wall)) if x is not None)


def cells(work, against, cpu, wall, wanted, ours, memory=None):
    ratios = ' | '.join('' if x is None else f'{x:.3f}' for x in (cpu, wall, memory))
    return f'| {work} | {against} | {ratios} | {wanted} | {ours} |'


def rows(rtdsl, mitsuba, folder):
    def us(scene, *options):
        return [rtdsl, 'render', f'{folder}/{scene}.scene', '-q', '-o', f'{folder}/rtdsl.png', *options]

    def tachyon(scene, samples=0, size=(1280, 720)):
        size = [str(x) for x in size]
        return ['tachyon', f'{folder}/{scene}.dat', '-aasamples', str(samples), '-res', *size, '-format', 'PNG', '-o', 'tachyon.png']

    def povray(scene):
        return ['povray', f'+I{folder}/{scene}.pov', f'+O{folder}/povray.png', '+W1280', '+H720', '-D', '-V', '-A']

    one, small, raw = us('seed', '--aa', 'off'), *(us(scene, '--aa', 'off', '--size', '16x16') for scene in ('seed', 'seed_ppm'))
    loop, text, mesh = us('spheres_loop'), us('spheres'), us('mesh')
    slopes = ([one, us('seed', '--aa', 'grid:4')], [tachyon('seed'), tachyon('seed', 15)])
    spheres = '100,000 spheres, shadows and mirrors'
    triangles = '1.0 M triangles, load, build and trace'
    seeds = 'seed scene 1280x720'
    alone = ['--aa', 'grid:4', '--stats', 'json', '--threads']
    return [
        Row('seed', f'{seeds}, 1 ray a pixel', 'Tachyon', one, tachyon('seed'), 0.10, 0.15),
        Row('seed', f'{seeds}, 1 ray a pixel', 'POV-Ray', one, povray('seed'), 0.04, 0.04),
        Row('seed', f'{seeds}, 4 rays a pixel', 'Tachyon', us('seed', '--aa', 'grid:2'), tachyon('seed', 3), 0.07, 0.08),
        Slope('slope', f'{seeds}, each further ray a pixel, 1 to 16', 'Tachyon', *slopes, 0.06),
        Row('start', 'seed scene 16x16 (start-up)', 'Tachyon', small, tachyon('seed', size=(16, 16)), 0.5, 0.5),
        Row('start', 'seed scene 16x16 (start-up), both read the globe from the same PPM', 'Tachyon', raw, tachyon('seed', size=(16, 16))),
        Row('spheres', f'{spheres}, from a loop', 'Tachyon', loop, tachyon('spheres'), 0.30, 0.35),
        Row('spheres', f'{spheres}, from 100,000 lines', 'Tachyon', text, tachyon('spheres'), 0.6, 0.6),
        Row('spheres', f'{spheres}, from 100,000 lines', 'POV-Ray', text, povray('spheres')),
        Row('mesh', f'{triangles}, PLY', 'Mitsuba scalar', mesh, [mitsuba, '-B', HERE / 'mitsuba_mesh.py', folder, 'mitsuba.png'], 0.25, 0.30),
        Row('mesh', f'{triangles}, PLY beside its text', 'Tachyon', mesh, tachyon('mesh')),
        Row('mesh', f'{triangles}, PLY beside its text', 'POV-Ray', mesh, povray('mesh')),
        Peak('memory', 'most memory, seed scene', 'Tachyon', one, tachyon('seed'), 0.6),
        Peak('memory', 'most memory, spheres from a loop', 'Tachyon', loop, tachyon('spheres'), 0.6),
        Peak('memory', 'most memory, spheres from lines', 'Tachyon', text, tachyon('spheres'), 0.6),
        Peak('memory', 'most memory, mesh', 'Tachyon', mesh, tachyon('mesh'), 0.6),
        Row('evaluate', '1,000,000 turns: a call and vector arithmetic', 'Lua 5.4', [rtdsl, 'check', HERE / 'loop.scene'], ['lua5.4', HERE / 'loop.lua'], 1.5),
        Threads('threads', f'{seeds}, 16 rays a pixel, tracing, 2 threads', 'itself, 1', us('seed', *alone, '2'), us('seed', *alone, '1'), wall=0.526),
    ]


GROUPS = ('seed', 'slope', 'start', 'spheres', 'mesh', 'memory', 'evaluate', 'threads')


def make_workloads(folder, groups):
    """Writes what isn't there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    wanted = [('seed', 'seed.dat', {'seed', 'slope', 'start', 'memory', 'threads'}), ('spheres', 'spheres.dat', {'spheres', 'memory'}), ('mesh', 'mesh.dat', {'mesh', 'memory'})]
    for name, last, users in wanted:
        if users & groups and not (folder / last).exists():
            print(f'  making {name}', file=sys.stderr)
            subprocess.run([sys.executable, '-B', HERE / f'{name}.py', folder], check=True, stdout=subprocess.DEVNULL)
    if {'spheres', 'memory'} & groups:
        shutil.copyfile(HERE / 'spheres_loop.scene', folder / 'spheres_loop.scene')


def finds_mitsuba(python):
    return subprocess.run([python, '-c', 'import mitsuba'], capture_output=True).returncode == 0


def embree(folder):
    """The tree alone beside Embree, both on the mesh and rays that the bench writes."""
    source = HERE / 'embree.cpp'
    if not (shutil.which('cargo') and shutil.which('g++') and source.exists() and Path('/usr/include/embree3/rtcore.h').exists() | Path('/usr/include/embree4/rtcore.h').exists()):
        print('Embree is left out: that needs cargo, g++ and libembree-dev', file=sys.stderr)
        return
    library = 'embree4' if Path('/usr/include/embree4/rtcore.h').exists() else 'embree3'
    subprocess.run(['g++', '-O3', '-march=native', source, f'-l{library}', '-o', folder / 'embree'], check=True)
    ours = ['cargo', 'bench', '--quiet', '--bench', 'tree', '--', '--write', folder]
    for name, command in ('rtdsl', ours), ('Embree', [folder / 'embree', 'threads=1']), ('Embree', [folder / 'embree', 'threads=2']):
        print(f'\n{name}:\n\n```text', flush=True)
        subprocess.run(command, cwd=ROOT if name == 'rtdsl' else folder, check=True)
        print('```')


def versions(rtdsl):
    """A line that says what ran, on what."""
    found = [subprocess.run([rtdsl, '--version'], capture_output=True, text=True).stdout.strip()]
    for name, command, word in ('Tachyon', ['tachyon', 'none.dat'], 'Version'), ('POV-Ray', ['povray', '--version'], 'POV-Ray'), ('', ['lua5.4', '-v'], 'Lua'):
        if shutil.which(command[0]):
            said = subprocess.run(command, capture_output=True, text=True)
            words = (said.stdout + said.stderr).split()
            if word in words[:-1]:
                found.append(f'{name or word} {words[words.index(word) + 1]}')
    return f'{", ".join(found)}; {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start'


def main():
    parse = argparse.ArgumentParser(prog='peers.sh', description=__doc__.split('\n\n')[0])
    parse.add_argument('-n', type=int, default=9, help='pairs of runs a row')
    parse.add_argument('--only', default=','.join(GROUPS), help=f'rows, divided by commas: {", ".join(GROUPS)}')
    parse.add_argument('--rtdsl', default=ROOT / 'target/release/rtdsl', type=Path, help='the program that is measured')
    parse.add_argument('--mitsuba', default=sys.executable, help='a Python that has the module mitsuba')
    parse.add_argument('--work', type=Path, help='keep the workloads here and find them again; else they go')
    parse.add_argument('--embree', action='store_true', help='also the tree alone, beside Embree; compiles')
    args = parse.parse_args()
    groups = set(args.only.split(',')) - {''}
    if groups - set(GROUPS):
        parse.error(f'there are no rows {", ".join(sorted(groups - set(GROUPS)))}')
    if args.n < 1:
        parse.error('-n is at least 1')
    rtdsl = args.rtdsl.resolve()
    if not rtdsl.exists():
        sys.exit(f'{rtdsl} isn\'t there: cargo build --release')
    mitsuba = 'mesh' in groups and finds_mitsuba(args.mitsuba)
    with tempfile.TemporaryDirectory() as desk:
        folder = (args.work or Path(desk)).resolve()
        make_workloads(folder, groups)
        print(f'{versions(rtdsl)}; medians of {args.n} pairs\n')
        print('| work | against | cpu | wall | memory | target | ours, ms |\n|---|---|---|---|---|---|---|', flush=True)
        for row in rows(rtdsl, args.mitsuba, folder):
            if row.group not in groups:
                continue
            peer = {'Tachyon': 'tachyon', 'POV-Ray': 'povray', 'Lua 5.4': 'lua5.4'}.get(row.against)
            if (peer and not shutil.which(peer)) or (row.against == 'Mitsuba scalar' and not mitsuba):
                print(f'  {row.against} isn\'t installed: {row.work}', file=sys.stderr)
                continue
            try:
                print(row.line(args.n, folder), flush=True)
            except (RuntimeError, subprocess.CalledProcessError) as e:
                print(f'| {row.work} | {row.against} | failed | | | | |', flush=True)
                print(f'  {e}', file=sys.stderr)
        if args.embree:
            embree(folder)


if __name__ == '__main__':
    main()
