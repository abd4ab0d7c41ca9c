"""How much arithmetic the seed scene's rays take, by phase, and how long the machine needs for it at least: `python3
benches/limit.py` prints a table.

    CARGO_PROFILE_RELEASE_DEBUG=line-tables-only cargo build --release --target-dir target/limit
    python3 benches/limit.py [--rtdsl target/limit/release/rtdsl]

Needs valgrind and binutils. Callgrind counts how often each instruction runs with 1 and with 4 rays a pixel; the difference is
the tracing of 3. The disassembly says what each instruction is and on how many numbers it works, the debug information
from which file of src/render it was inlined: that is its phase. Valgrind knows AVX2 and not AVX-512, so the numbers are
those of four rays at a time; the count of operations is all but the same with eight. Operations that a mask throws away count
as well: they take their time.
"""
import argparse
import collections
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WIDTH, HEIGHT, SIDE = 1280, 720, 2
# Which file of src/render belongs to which phase; what isn't here (shapes, lanes) belongs to the phase that it was inlined into.
PHASES = {
    'tile': 'camera rays and sums', 'camera': 'camera rays and sums',
    'candidates': 'culling', 'cull': 'culling', 'span': 'culling',
    'nearest': 'nearest surface', 'sweep': 'nearest surface', 'closest': 'nearest surface', 'walk': 'nearest surface', 'slabs': 'nearest surface',
    'light': 'shadows', 'shadow_rays': 'shadows', 'between': 'shadows', 'touch': 'shadows',
    'run': 'sorting', 'flock': 'sorting', 'batch': 'sorting', 'gathered': 'sorting',
    'shade': 'shading', 'surfaces': 'shading', 'run_of_hits': 'shading', 'illuminate': 'shading', 'material': 'shading',
    'paint': 'patterns', 'pattern': 'patterns', 'surface_pattern': 'patterns', 'texture': 'patterns',
    'spawn': 'mirrored and transmitted rays', 'optics': 'mirrored and transmitted rays',
}  # fmt: skip
KINDS = ('add', 'mul', 'fma', 'div', 'sqrt')
ARITHMETIC = re.compile(r'^v?(?:(add|sub)|(mul)|(fn?m(?:add|sub)\w*?)|(div)|(sqrt))([ps])([ds])$')


def operation(mnemonic, operands):
    """Kind of an instruction's arithmetic and the numbers that it works on."""
    found = ARITHMETIC.match(mnemonic)
    if not found:
        return None
    kind = KINDS[[0, 1, 2, 3, 4][next(i for i in range(5) if found[i + 1])]]
    if found[6] == 's':
        return kind, 1
    bits = 512 if 'zmm' in operands else 256 if 'ymm' in operands else 128
    return kind, bits // (64 if found[7] == 'd' else 32)


def disassembly(program):
    """Address to kind and width, of the instructions that compute."""
    text = subprocess.run(['objdump', '-d', '--no-show-raw-insn', program], check=True, capture_output=True, text=True).stdout
    out = {}
    for line in text.splitlines():
        parts = line.split(None, 2)
        if len(parts) == 3 and parts[0].endswith(':') and (found := operation(parts[1], parts[2])):
            out[int(parts[0][:-1], 16)] = found
    return out


def executed(program, side, desk):
    """Address to how often it ran, within the program itself."""
    out = desk / f'callgrind.{side}'
    scene = ROOT / 'examples/cosc363.scene'
    render = ['render', scene, '--size', f'{WIDTH}x{HEIGHT}', '--aa', f'grid:{side}', '--threads', '1', '-q', '-o', desk / 'a.png']
    options = ['--dump-instr=yes', '--compress-pos=no', '--compress-strings=no', f'--callgrind-out-file={out}']
    subprocess.run(['valgrind', '--tool=callgrind', *options, program, *render], check=True, capture_output=True)
    counts, is_ours, is_call = collections.Counter(), False, False
    with open(out) as file:
        for line in file:
            if line.startswith('ob='):
                is_ours = line[3:].strip() == str(program)
            elif line.startswith('calls='):
                is_call = True  # the next line is what was called, which counts where it stands
            elif line.startswith('0x'):
                if is_ours and not is_call:
                    address, *_, cost = line.split()
                    counts[int(address, 16)] += int(cost)
                is_call = False
    return counts


def phases(program, addresses):
    """The phase of each address: of the innermost inlined function that has one."""
    asked = ''.join(f'{a:#x}\n' for a in addresses)
    text = subprocess.run(['addr2line', '-a', '-i', '-e', program], input=asked, check=True, capture_output=True, text=True).stdout
    out, at = {}, None
    for line in text.splitlines():
        if line.startswith('0x'):
            at = int(line, 16)
        elif at not in out and (found := re.search(r'src/render/(?:\w+/)?(\w+)\.rs', line)) and found[1] in PHASES:
            out[at] = PHASES[found[1]]
    return out


def main():
    parse = argparse.ArgumentParser(description=__doc__.split('\n\n')[0])
    parse.add_argument('--rtdsl', default=ROOT / 'target/limit/release/rtdsl', type=Path, help='a program with debug information')
    # What two instructions of 512 bits, eight f64 each, take on the processor at hand; measured there or from its manual.
    parse.add_argument('--div', type=float, default=16, help='cycles between two divisions of eight f64')
    parse.add_argument('--sqrt', type=float, default=24, help='cycles between two roots of eight f64')
    parse.add_argument('--fma', type=float, default=2, help='multiplications, additions or both of eight f64 a cycle')
    args = parse.parse_args()
    program = args.rtdsl.resolve()
    if not program.exists():
        sys.exit(f'{program} isn\'t there; see the head of this file')
    with tempfile.TemporaryDirectory() as desk:
        many, one = (executed(program, side, Path(desk)) for side in (SIDE, 1))
    kinds = disassembly(program)
    rays = WIDTH * HEIGHT * (SIDE * SIDE - 1)
    ran = {a: n - one[a] for a, n in many.items() if n > one[a]}
    of = phases(program, sorted(ran))
    total, table = collections.Counter(), collections.defaultdict(collections.Counter)
    for address, n in ran.items():
        for row in (table[of.get(address, 'other')], total):
            row['instructions'] += n
            if address in kinds:
                kind, width = kinds[address]
                row[kind] += n * width
    print(f'| phase | instructions | {" | ".join(KINDS)} | divider, cycles | multiply-adds, cycles |\n|{"---|" * 9}')
    rows = sorted(table.items(), key=lambda r: -r[1]['instructions'])
    for name, row in [*rows, ('all', total)]:
        per = {k: row[k] / rays for k in ('instructions', *KINDS)}
        divider = (per['div'] * args.div + per['sqrt'] * args.sqrt) / 8
        ports = (per['add'] + per['mul'] + per['fma']) / 8 / args.fma
        cells = ' | '.join(f'{per[k]:.2f}' for k in KINDS)
        print(f'| {name} | {per["instructions"]:.1f} | {cells} | {divider:.2f} | {ports:.2f} |')
    print('\nEach figure is for one camera ray and all that follows from it; cycles are those of eight rays at a time.')


if __name__ == '__main__':
    main()
