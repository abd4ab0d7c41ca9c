"""What each feature of a scene costs, used and unused, in instructions a camera ray: `python3 benches/features.py` prints a
table. Counts, not times, so it may run on a busy machine.

    cargo build --release && python3 benches/features.py [--rtdsl PROGRAM] [--only mirror,glass]

Needs valgrind, whose callgrind counts. What is read, evaluated, built and written is the same whether a pixel takes 1 ray or 16,
so the difference of two such runs is the tracing of 15 rays a pixel and nothing else; what is found once for a tile is left out
with the rest. Valgrind has no AVX-512: where the processor has AVX2, its 4 rays at a time are what is counted, so one instruction
may serve 4 rays.

"used" is the baseline, a matte ball on a matte floor, with the feature in it; "unused" is the baseline with the same thing made
but put nowhere. Unused things may cost nothing: more than 0.1 % of a ray ends the program with 1.
"""
import argparse
import json
import math
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / 'examples/assets/earth.png'
WIDTH, HEIGHT, SIDE = 160, 90, 4
BOUND = 0.001

HEAD = '''rtdsl 1
camera(from: [0, 1.5, 6], at: [0, 0.8, 0], fov: 30deg)
background(linear(0.5, 0.6, 0.8))
'''
FLOOR = 'plane(y: 0, mat: {})\n'
BALL = 'sphere(at: [0, 1, 0], r: 1, mat: {})\n'
LIGHT = 'light(at: [4, 6, 5])\n'
MATTE = 'phong(color: linear(0.7, 0.5, 0.3))'


def scene(ball=MATTE, floor=MATTE, more='', lights=LIGHT, shape=BALL):
    return HEAD + lights + FLOOR.format(floor) + shape.format(ball) + more


def material(name, ball):
    """A material with the feature, worn by the ball or by nothing."""
    return name, scene(ball=ball), f'let unused = {ball}\n'


def pattern(name, color):
    """A pattern of the floor."""
    look = f'phong(color: {color})'
    return name, scene(floor=look), f'let unused = {look}\n'


def shape(name, text):
    """A shape in the ball's place."""
    return name, scene(shape=text + '\n'), f'let unused = {text.format(MATTE)}\n'


def features():
    """Name, the scene that uses it (`None`: nothing can), and what to add to the baseline to have it there unused."""
    by_normal = 'mapping: "normal", filter: "nearest"'
    return [
        ('no light', scene(lights=''), None),
        ('a second light', scene(more='light(at: [-5, 6, 3])\n'), 'fn unused() = light(at: [-5, 6, 3])\n'),
        material('highlight', 'phong(color: linear(0.7, 0.5, 0.3), specular: 0.5, shininess: 20)'),
        material('mirror', 'phong(color: linear(0.7, 0.5, 0.3), reflect: 0.5)'),
        material('transparency', 'phong(color: linear(0.3, 0.2, 0.1), transmit: 0.7)'),
        material('glass', 'glass()'),
        material('bump', 'phong(color: linear(0.7, 0.5, 0.3), bump: noise(0, 0.2))'),
        pattern('checker', 'checker(linear(0.9, 0.9, 0.8), linear(0.1, 0.3, 0.2))'),
        pattern('stripes', 'stripes(linear(0.9, 0.9, 0.8), linear(0.1, 0.3, 0.2))'),
        pattern('gradient', 'gradient(linear(0.9, 0.9, 0.8), linear(0.1, 0.3, 0.2), axis: "x")'),
        pattern('noise, 1 octave', 'noise(linear(0.9, 0.9, 0.8), linear(0.1, 0.3, 0.2), octaves: 1)'),
        pattern('noise, 4 octaves', 'noise(linear(0.9, 0.9, 0.8), linear(0.1, 0.3, 0.2))'),
        pattern('a checker of checkers', 'checker(checker(white, black, size: 0.25), linear(0.1, 0.3, 0.2))'),
        material('picture by normal, nearest', f'phong(color: image("earth.png", {by_normal}))'),
        material('picture by longitude, bilinear', 'phong(color: image("earth.png"))'),
        shape('box', 'box(at: [0, 1, 0], size: [1.6, 2, 1.6], mat: {})'),
        shape('disc', 'disc(at: [0, 1, 0], normal: [0, 0, 1], mat: {})'),
        shape('cylinder', 'cylinder(from: [0, 0, 0], to: [0, 2, 0], r: 0.8, mat: {})'),
        shape('cone', 'cone(from: [0, 0, 0], to: [0, 2, 0], r: 1, mat: {})'),
        shape('torus', 'torus(at: [0, 1, 0], r: 0.7, tube: 0.3, axis: [0, 0, 1], mat: {})'),
        shape('tetrahedron', 'tetrahedron(points: [[-1, 0, 0.6], [1, 0, 0.6], [0, 0, -1], [0, 2, 0]], mat: {})'),
        shape('an ellipsoid: a stretched frame', 'sphere(at: [0, 1, 0], r: 1, mat: {}) |> scale([1, 1, 0.5])'),
        shape('mesh of 5,000 triangles', 'mesh("ball.ply", mat: {})'),
        ('a function', None, 'fn unused(x) = sphere(at: [x, 0, 0], r: 1)\n'),
        ('10,000 values', None, ''.join(f'let unused{i} = {i} * 2 + 1\n' for i in range(10_000))),
        ('10,000 materials', None, 'let unused = [for i in 0..10000 { phong(color: gray(i / 10000), reflect: 0.5) }]\n'),
    ]


def ply(path, rings=50):
    """A ball of 2 · `rings`² triangles; the two at its poles that have no area are left out."""
    points = []
    for i in range(rings + 1):
        for j in range(rings):
            a, b = math.pi * i / rings, 2 * math.pi * j / rings
            points.append((math.sin(a) * math.cos(b), 1 + math.cos(a), math.sin(a) * math.sin(b)))
    faces = []
    for i in range(rings):
        for j in range(rings):
            a, b = i * rings + j, i * rings + (j + 1) % rings
            faces += [(a, b, b + rings)] * (i > 0) + [(a, b + rings, a + rings)] * (i < rings - 1)
    with open(path, 'wb') as file:
        file.write(f'''ply
format binary_little_endian 1.0
element vertex {len(points)}
property float x
property float y
property float z
element face {len(faces)}
property list uchar uint vertex_indices
end_header
'''.encode())
        file.write(b''.join(struct.pack('<3f', *p) for p in points) + b''.join(struct.pack('<B3I', 3, *f) for f in faces))


class Meter:
    def __init__(self, rtdsl, desk):
        self.rtdsl, self.desk = rtdsl, desk

    def run(self, command):
        done = subprocess.run([str(c) for c in command], cwd=self.desk, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError((done.stdout + done.stderr)[-600:])
        return done.stdout, done.stderr

    def instructions(self, side):
        """Of the whole process, with `side`² rays a pixel."""
        command = ['valgrind', '--tool=callgrind', '--callgrind-out-file=/dev/null', *self.render(side, '-q')]
        return int(re.search(r'Collected : (\d+)', self.run(command)[1])[1])

    def render(self, side, *options):
        size = f'{WIDTH}x{HEIGHT}'
        return [self.rtdsl, 'render', 'a.scene', '--size', size, '--aa', f'grid:{side}', '--threads', '1', '-o', 'a.png', *options]

    def cost(self, text):
        """Instructions and rays of all kinds for each camera ray, and kilobytes held for tracing."""
        (self.desk / 'a.scene').write_text(text)
        instructions = self.instructions(SIDE) - self.instructions(1)
        rays = json.loads(self.run(self.render(SIDE, '--stats', 'json'))[0])['rays']
        held = re.search(r'([0-9.]+) kB held for tracing', self.run([self.rtdsl, 'explain', 'a.scene'])[0])[1]
        return instructions / (WIDTH * HEIGHT * (SIDE * SIDE - 1)), rays['total'] / rays['camera'], held


def main():
    parse = argparse.ArgumentParser(description=__doc__.split('\n\n')[0])
    parse.add_argument('--rtdsl', default=ROOT / 'target/release/rtdsl', type=Path, help='the program that is measured')
    parse.add_argument('--only', default='', help='names of features, or parts of them, divided by commas')
    args = parse.parse_args()
    if not shutil.which('valgrind'):
        sys.exit('valgrind isn\'t installed')
    wanted, wrong = args.only.split(','), []
    with tempfile.TemporaryDirectory() as folder:
        desk = Path(folder)
        shutil.copyfile(PICTURE, desk / 'earth.png')
        ply(desk / 'ball.ply')
        meter = Meter(args.rtdsl.resolve(), desk)
        base, rays, held = meter.cost(scene())
        print('| feature | instructions a camera ray | more than the baseline | rays a camera ray | held, kB | unused: instructions | unused: held, kB |')
        print('|---|---|---|---|---|---|---|')
        print(f'| the baseline | {base:.1f} | | {rays:.2f} | {held} | | |', flush=True)
        for name, used, unused in features():
            if not any(w in name for w in wanted):
                continue
            row = [name, '', '', '', '', '', '']
            try:
                if used:
                    cost, rays, kilobytes = meter.cost(used)
                    row[1:5] = f'{cost:.1f}', f'{cost - base:+.1f}', f'{rays:.2f}', kilobytes
                if unused:
                    cost, _, kilobytes = meter.cost(scene(more=unused))
                    row[5:7] = f'{100 * (cost / base - 1):+.3f} %', kilobytes
                    if abs(cost / base - 1) > BOUND or kilobytes != held:
                        wrong.append(name)
            except RuntimeError as e:
                row[1] = 'failed'
                print(f'{name}: {e}', file=sys.stderr)
            print('| ' + ' | '.join(row) + ' |', flush=True)
    if wrong:
        sys.exit(f'unused, these cost something: {", ".join(wrong)}')


if __name__ == '__main__':
    main()
