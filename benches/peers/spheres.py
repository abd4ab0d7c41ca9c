"""A hundred thousand spheres: `python3 spheres.py OUT` writes OUT/spheres.scene (a line each), spheres.pov and spheres.dat.
The same numbers every time. spheres_loop.scene, beside this file, draws from the same law in the scene language itself."""
import random
from heads import f, g, out, povray, tachyon

COUNT = 100_000
COLORS = [(.8, .3, .3), (.3, .7, .3), (.3, .4, .8), (.1, .1, .1)]  # sphere i has color i % 4; the last one mirrors
MIRROR = 0.6


def spheres():
    chance = random.Random(1)
    for _ in range(COUNT):
        x, y, z = chance.uniform(-20, 20), chance.uniform(.1, 6), chance.uniform(-20, 20)
        yield round(x, 5), round(y, 5), round(z, 5), round(chance.uniform(.05, .12), 5)


def scene(file, all):
    file.write('rtdsl 1\n')
    for i, color in enumerate(COLORS):
        reflect = f', reflect: {MIRROR}' if i == 3 else ''
        file.write('let m%d = phong(color: linear(%g, %g, %g), ambient: 1, diffuse: 0.8%s)\n' % (i, *color, reflect))
    file.write('''plane(y: 0, mat: phong(color: checker(linear(0.9, 0.9, 0.85), linear(0.15, 0.35, 0.2), size: 1), ambient: 1, diffuse: 0.8))
camera(from: [0, 14, 40], at: [0, 2, 0], fov: 28.0724869deg)
background(linear(0.45, 0.6, 0.8))
ambient(0.2)
light(at: [30, 60, 30])
render(size: [1280, 720], aa: off, depth: 3)
''')
    for i, (x, y, z, r) in enumerate(all):
        file.write('sphere(at: [%g, %g, %g], r: %g, mat: m%d)\n' % (x, y, z, r, i % 4))


def pov(file, all):
    file.write(povray(3, '0,14,-40', '0,2,0', '30,60,-30'))
    for i, color in enumerate(COLORS):
        reflection = ' reflection{%g}' % MIRROR if i == 3 else ''
        file.write('#declare M%d=texture{pigment{rgb <%s>} finish{F%s}}\n' % (i, f(*color), reflection))
    file.write('plane{y,0 pigment{checker rgb <.9,.9,.85> rgb <.15,.35,.2>} finish{F}}\n')
    for i, (x, y, z, r) in enumerate(all):
        file.write('sphere{<%g,%g,%g>,%g texture{M%d}}\n' % (x, y, -z, r, i % 4))


def dat(file, all):
    file.write(tachyon(3, '0 14 -40', '0 -12 40', '30 60 -30'))
    for i, color in enumerate(COLORS):
        file.write(f'TEXDEF m{i} AMBIENT 0.2 DIFFUSE 0.8 SPECULAR {MIRROR if i == 3 else 0} OPACITY 1 COLOR {g(*color)} TEXFUNC 0\n')
    file.write('PLANE CENTER 0 0 0 NORMAL 0 1 0 TEXTURE AMBIENT 0.2 DIFFUSE 0.8 SPECULAR 0 OPACITY 1 COLOR 1 1 1 '
               'TEXFUNC 1 CENTER 0 0 0 ROTATE 0 0 0 SCALE 1 1 1\n')
    for i, (x, y, z, r) in enumerate(all):
        file.write('SPHERE CENTER %g %g %g RAD %g m%d\n' % (x, y, -z, r, i % 4))
    file.write('END_SCENE\n')


if __name__ == '__main__':
    everything = list(spheres())
    for write in scene, pov, dat:
        with open(f'{out()}/spheres.{write.__name__}', 'w') as file:
            write(file, everything)
