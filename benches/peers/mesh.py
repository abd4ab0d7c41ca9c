"""A bumpy ball of 1,002,252 triangles: `python3 mesh.py OUT` writes OUT/mesh1m.ply (binary), mesh.obj, mesh.scene, mesh.pov,
mesh.dat, and mesh.v.f32 and mesh.f.u32 for a program that calls Embree. The same numbers every time; takes a minute."""
import math
import random
import struct
from array import array
from heads import out, povray, tachyon

SIDE = 289  # squares along a side of each of the cube's six faces


def ball():
    """Vertices, as three lists, and triangles, of a cube blown up to a ball."""
    steps = [math.tan((2 * i / SIDE - 1) * math.pi / 4) for i in range(SIDE + 1)]
    places = [lambda u, v: (u, v, 1), lambda u, v: (v, u, -1), lambda u, v: (1, u, v),
              lambda u, v: (-1, v, u), lambda u, v: (v, 1, u), lambda u, v: (u, -1, v)]
    vertices, triangles = [], []
    for k, place in enumerate(places):
        for u in steps:
            for v in steps:
                x, y, z = place(u, v)
                n = math.sqrt(x * x + y * y + z * z)
                vertices.append((x / n, y / n, z / n))
        row, first = SIDE + 1, k * (SIDE + 1) ** 2
        squares = [first + i * row + j for i in range(SIDE) for j in range(SIDE)]
        triangles += [(a, a + row, a + row + 1) for a in squares]
        triangles += [(a, a + row + 1, a + 1) for a in squares]
    return vertices, triangles


def bumps(vertices):
    """How far each vertex stands out: seven octaves of eight waves."""
    chance = random.Random(1)
    height = [0.0] * len(vertices)
    for octave in range(7):
        for _ in range(8):
            w = [chance.gauss(0, 1) for _ in range(3)]
            n = math.sqrt(sum(x * x for x in w))
            wx, wy, wz = (x / n * 2.2 * 2 ** octave for x in w)
            phase, size, sin = chance.uniform(0, 6.28), .5 ** octave, math.sin
            height = [h + size * sin(x * wx + y * wy + z * wz + phase) for h, (x, y, z) in zip(height, vertices)]
    return height



def main():
    folder = out()
    vertices, triangles = ball()
    radii = [3 + .22 * h for h in bumps(vertices)]
    flat = array('f', (x * r for v, r in zip(vertices, radii) for x in v))
    vertices = list(zip(flat[0::3], flat[1::3], flat[2::3]))
    corners = array('I', (i for t in triangles for i in t))
    print(f'{len(vertices)} vertices, {len(triangles)} triangles')
    with open(f'{folder}/mesh.v.f32', 'wb') as file:
        flat.tofile(file)
    with open(f'{folder}/mesh.f.u32', 'wb') as file:
        corners.tofile(file)
    with open(f'{folder}/mesh1m.ply', 'wb') as file:
        file.write(f'''ply
format binary_little_endian 1.0
element vertex {len(vertices)}
property float x
property float y
property float z
element face {len(triangles)}
property list uchar uint vertex_indices
end_header
'''.encode())
        file.write(struct.pack(f'<{len(flat)}f', *flat))
        face = struct.Struct('<B3I')
        file.write(b''.join(face.pack(3, *t) for t in triangles))
    with open(f'{folder}/mesh.obj', 'w') as file:
        file.writelines('v %.6g %.6g %.6g\n' % v for v in vertices)
        file.writelines('f %d %d %d\n' % (a + 1, b + 1, c + 1) for a, b, c in triangles)
    with open(f'{folder}/mesh.scene', 'w') as file:
        file.write('''rtdsl 1
mesh("mesh1m.ply", mat: phong(color: linear(0.7, 0.6, 0.4), ambient: 1, diffuse: 0.8))
camera(from: [0, 5, 14], at: [0, 0, 0], fov: 28.0724869deg)
background(linear(0.45, 0.6, 0.8))
ambient(0.2)
light(at: [6, 10, 6])
render(size: [1280, 720], aa: off, depth: 1)
''')
    turned = [(x, y, -z) for x, y, z in vertices]
    with open(f'{folder}/mesh.pov', 'w') as file:
        file.write(povray(1, '0,5,-14', '0,0,0', '6,10,-6'))
        file.write('mesh2{vertex_vectors{%d,\n' % len(turned))
        file.write(',\n'.join('<%.6g,%.6g,%.6g>' % v for v in turned))
        file.write('}\nface_indices{%d,\n' % len(triangles))
        file.write(',\n'.join('<%d,%d,%d>' % t for t in triangles))
        file.write('}\npigment{rgb <.7,.6,.4>} finish{F}}\n')
    with open(f'{folder}/mesh.dat', 'w') as file:
        file.write(tachyon(1, '0 5 -14', '0 -5 14', '6 10 -6'))
        file.write('TEXDEF m AMBIENT 0.2 DIFFUSE 0.8 SPECULAR 0 OPACITY 1 COLOR .7 .6 .4 TEXFUNC 0\n')
        text = ['%.6g %.6g %.6g' % v for v in turned]
        file.writelines(f'TRI V0 {text[a]} V1 {text[b]} V2 {text[c]} m\n' for a, b, c in triangles)
        file.write('END_SCENE\n')


if __name__ == '__main__':
    main()
