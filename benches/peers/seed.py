"""The seed scene, for us and the others: `python3 seed.py OUT` writes OUT/seed.scene, seed_ppm.scene (whose globe is the file
that Tachyon reads), seed.pov, seed.dat and the pictures that Tachyon reads. Right-handed, y up, the eye at the origin looking along -z, the tangent of half
the vertical angle 0.25, 16:9."""
import math
import os
import struct
import zlib
from heads import f, g, out

EARTH = os.path.join(os.path.dirname(os.path.abspath(__file__)), '../../examples/assets/earth.png')
LIGHT, BACKGROUND = (30, 45, 20), (0.45, 0.6, 0.8)
FLOOR, SQUARE, LIGHT_SQUARE, DARK_SQUARE = -15, 10, (0.9, 0.9, 0.85), (0.15, 0.35, 0.2)
MIRROR = ((0, 0, -115), 13, (0.1, 0.1, 0.3), 0.7)  # centre, radius, own color, share
GLOBE = ((-23, -5, -100), 9)
STRIPED = ((23, -6, -95), 9, (0.9, 0.5, 0.1), (0.2, 0.2, 0.7))
TUBE = ((10, -15, -75), 3.5, 10, (0.1, 0.25, 0.1), 0.7)  # base, radius, height, own color, share let through
CONE = ((-12, -15, -78), 4, 10, (0.8, 0.2, 0.2))
CORNERS, YELLOW = ((-3, -15, -66), (4, -15, -68), (0.5, -15, -74), (0.7, -8, -69)), (0.9, 0.8, 0.2)
FACES = [(0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
AMBIENT, DIFFUSE, SPECULAR, SHININESS, DEPTH = 0.2, 0.8, 0.5, 20, 5


def above(p, height):
    return p[0], p[1] + height, p[2]


def scene(earth):
    v = lambda p: '[' + ', '.join('%.17g' % x for x in p) + ']'
    c = lambda p: 'linear(' + ', '.join('%.17g' % x for x in p) + ')'
    return f'''rtdsl 1
let shiny = phong(diffuse: {DIFFUSE}, specular: {SPECULAR}, shininess: {SHININESS})
camera(from: [0, 0, 0], at: [0, 0, -1], fov: 28.0724869deg)
background({c(BACKGROUND)})
ambient({AMBIENT})
light(at: {v(LIGHT)})
plane(y: {FLOOR}, mat: phong(color: checker({c(LIGHT_SQUARE)}, {c(DARK_SQUARE)}, size: {SQUARE}), diffuse: {DIFFUSE}, specular: 0))
sphere(at: {v(MIRROR[0])}, r: {MIRROR[1]}, mat: shiny.with(color: {c(MIRROR[2])}, reflect: {MIRROR[3]}))
sphere(at: {v(GLOBE[0])}, r: {GLOBE[1]}, mat: shiny.with(color: image("{earth}", mapping: "normal")))
sphere(at: {v(STRIPED[0])}, r: {STRIPED[1]}, mat: shiny.with(color: stripes({c(STRIPED[2])}, {c(STRIPED[3])}, axis: "y", size: 1)))
cylinder(from: {v(TUBE[0])}, to: {v(above(TUBE[0], TUBE[2]))}, r: {TUBE[1]}, caps: false, mat: shiny.with(color: {c(TUBE[3])}, transmit: {TUBE[4]}))
cone(from: {v(CONE[0])}, to: {v(above(CONE[0], CONE[2]))}, r: {CONE[1]}, mat: shiny.with(color: {c(CONE[3])}))
tetrahedron(points: [{', '.join(map(v, CORNERS))}], mat: shiny.with(color: {c(YELLOW)}))
render(size: [1280, 720], aa: off, depth: {DEPTH})
'''


def pov():
    w = lambda p: '<' + f(*p) + '>'
    c = lambda p: 'rgb <' + f(*p) + '>'
    t = TUBE[4]
    head = f'''#version 3.7;
global_settings{{assumed_gamma 1 max_trace_level {DEPTH}}}
background{{{c(BACKGROUND)}}}
camera{{perspective location <0,0,0> direction <0,0,-2> up <0,1,0> right <{16 / 9:.17g},0,0>}}
light_source{{{w(LIGHT)} rgb 1}}
#declare F=finish{{ambient {AMBIENT} diffuse {DIFFUSE} phong {SPECULAR} phong_size {SHININESS}}}
#declare EFn=function{{pigment{{image_map{{png "{os.path.abspath(EARTH)}" map_type 0}}}}}}
#declare EU=function(x,y){{asin(max(-1,min(1,x)))/pi+0.5}}
#declare EarthPig=pigment{{average pigment_map{{
'''
    # The picture lies by the normal, as no mapping of POV-Ray's does: a channel a time.
    for channel, axis in ('red', '<3,0,0>'), ('green', '<0,3,0>'), ('blue', '<0,0,3>'):
        head += f' [1 function{{0.9999*EFn(EU(x,0),EU(y,0),0).{channel}}} color_map{{[0 rgb 0][1 rgb {axis}]}}]\n'
    a, b = c(STRIPED[2]), c(STRIPED[3])
    body = f'''}} }}
plane{{y,{FLOOR} pigment{{checker {c(LIGHT_SQUARE)} {c(DARK_SQUARE)} scale {SQUARE}}} finish{{ambient {AMBIENT} diffuse {DIFFUSE}}}}}
sphere{{{w(MIRROR[0])},{MIRROR[1]} pigment{{{c(MIRROR[2])}}} finish{{F reflection{{{MIRROR[3]}}}}}}}
sphere{{0,1 pigment{{EarthPig}} finish{{F}} scale {GLOBE[1]} translate {w(GLOBE[0])}}}
sphere{{{w(STRIPED[0])},{STRIPED[1]} pigment{{gradient y color_map{{[0 {a}][0.5 {a}][0.5 {b}][1 {b}]}} scale 2}} finish{{F}}}}
cylinder{{{w(TUBE[0])},{w(above(TUBE[0], TUBE[2]))},{TUBE[1]} open pigment{{rgbt <{f(*[x / (1 - t) for x in TUBE[3]])},{t}>}} finish{{F}}}}
cone{{{w(CONE[0])},{CONE[1]},{w(above(CONE[0], CONE[2]))},0 pigment{{{c(CONE[3])}}} finish{{F}}}}
'''
    faces = '\n'.join('triangle{' + ','.join(w(CORNERS[i]) for i in face) + '}' for face in FACES)
    return head + body + 'union{' + faces + f' pigment{{{c(YELLOW)}}} finish{{F}}}}\n'


def dat(folder):
    """Tachyon's checker has squares of a third, whatever its scale: the whole scene is a thirtieth as large. Its cone is a
    fan of 128 smooth triangles."""
    s = 1 / 30
    w = lambda p: g(p[0] * s, p[1] * s, -p[2] * s)

    def look(color, specular=0, opacity=1, texture='0', phong=True):
        shine = f'PHONG PLASTIC {SPECULAR} PHONG_SIZE {SHININESS} ' if phong else ''
        return (f'AMBIENT {AMBIENT} DIFFUSE {DIFFUSE} SPECULAR {specular} OPACITY {opacity} {shine}'
                f'COLOR {g(*color)} TEXFUNC {texture}\n')

    picture = lambda name, at: f'8 {folder}/{name} CENTER {w(at)} ROTATE 0 0 0 SCALE 1 1 1'
    squares = f'1 CENTER {g(SQUARE * s / 2, FLOOR * s, SQUARE * s / 2)} ROTATE 0 0 0 SCALE 1 1 1'
    base, r, height = CONE[:3]
    text = f'''BEGIN_SCENE
RESOLUTION 1280 720
CAMERA
 ZOOM 2.0
 ASPECTRATIO 1.0
 ANTIALIASING 0
 RAYDEPTH {DEPTH}
 CENTER 0 0 0
 VIEWDIR 0 0 1
 UPDIR 0 1 0
END_CAMERA
BACKGROUND {g(*BACKGROUND)}
LIGHT CENTER {w(LIGHT)} RAD {0.001 * s:.17g} COLOR 1 1 1
PLANE CENTER {w((0, FLOOR, 0))} NORMAL 0 1 0 TEXTURE {look((1, 1, 1), texture=squares, phong=False)}'''
    text += f'SPHERE CENTER {w(MIRROR[0])} RAD {MIRROR[1] * s:.17g} TEXTURE ' + look(MIRROR[2], MIRROR[3])
    for name, (at, radius) in ('earth.ppm', GLOBE), ('stripes.ppm', STRIPED[:2]):
        text += f'SPHERE CENTER {w(at)} RAD {radius * s:.17g} TEXTURE ' + look((1, 1, 1), texture=picture(name, at))
    text += f'FCYLINDER BASE {w(TUBE[0])} APEX {w(above(TUBE[0], TUBE[2]))} RAD {TUBE[1] * s:.17g} TEXTURE '
    text += look(TUBE[3], opacity=round(1 - TUBE[4], 6)) + 'TEXDEF cone ' + look(CONE[3])
    ring = [(math.cos(2 * math.pi * i / 128), math.sin(2 * math.pi * i / 128)) for i in range(128)]
    rim = [(base[0] + r * x, base[1], base[2] + r * z) for x, z in ring]
    normals = [(x, r / height, -z) for x, z in ring]
    for i in range(128):
        j = (i + 1) % 128
        middle = [(a + b) / 2 for a, b in zip(normals[i], normals[j])]
        text += f'STRI V0 {w(rim[i])} V1 {w(rim[j])} V2 {w(above(base, height))} '
        text += f'N0 {g(*normals[i])} N1 {g(*normals[j])} N2 {g(*middle)} cone\n'
    text += f'RING CENTER {w(base)} NORMAL 0 1 0 INNER 0 OUTER {r * s:.17g} cone\nTEXDEF yellow ' + look(YELLOW)
    for face in FACES:
        text += 'TRI ' + ' '.join(f'V{k} {w(CORNERS[i])}' for k, i in enumerate(face)) + ' yellow\n'
    return text + 'END_SCENE\n'


def png(path):
    """Width, height and RGB bytes of a PNG of 8-bit RGB, or of up to 256 colors that have numbers, that isn't interlaced."""
    data = open(path, 'rb').read()
    at, packed, palette = 8, b'', b''
    while at < len(data):
        (length,), kind = struct.unpack('>I', data[at:at + 4]), data[at + 4:at + 8]
        chunk, at = data[at + 8:at + 8 + length], at + 12 + length
        if kind == b'IHDR':
            width, height, *form = struct.unpack('>IIBBBBB', chunk)
            assert form in ([8, 2, 0, 0, 0], [8, 3, 0, 0, 0]), 'neither 8-bit RGB nor colors with numbers'
            pixel = 3 if form[1] == 2 else 1
        elif kind == b'PLTE':
            palette = chunk
        elif kind == b'IDAT':
            packed += chunk
    packed, size, rows, above = zlib.decompress(packed), pixel * width, bytearray(), bytes(pixel * width)
    for y in range(height):
        kind, row = packed[y * (size + 1)], bytearray(packed[y * (size + 1) + 1:(y + 1) * (size + 1)])
        for i in range(size):
            a, b, c = (row[i - pixel] if i >= pixel else 0), above[i], (above[i - pixel] if i >= pixel else 0)
            if kind == 4:
                p, q, s = abs(b - c), abs(a - c), abs(a + b - 2 * c)
                guess = a if p <= q and p <= s else b if q <= s else c
            else:
                guess = (0, a, b, (a + b) // 2)[kind]
            row[i] = row[i] + guess & 255
        rows += row
        above = row
    if pixel == 1:
        rows = b''.join(palette[3 * i:3 * i + 3] for i in rows)
    return width, height, bytes(rows)


def ppm(path, width, height, rows):
    with open(path, 'wb') as file:
        file.write(b'P6 %d %d 255\n' % (width, height) + rows)


def stripes(height=4096):
    """A picture that lies around the sphere by its height, in rows of one color each."""
    rows = b''
    for i in range(height):
        y = STRIPED[0][1] + STRIPED[1] * math.sin((0.5 - (i + .5) / height) * math.pi)
        color = STRIPED[2 + math.floor(y) % 2]
        rows += bytes(round(x * 255) for x in color) * 8
    return 8, height, rows


if __name__ == '__main__':
    folder = out()
    width, height, rows = png(EARTH)
    ppm(f'{folder}/earth.ppm', width, height, rows)
    ppm(f'{folder}/stripes.ppm', *stripes())
    with open(EARTH, 'rb') as source, open(f'{folder}/{os.path.basename(EARTH)}', 'wb') as copy:
        copy.write(source.read())
    scenes = ('seed.scene', scene(os.path.basename(EARTH))), ('seed_ppm.scene', scene('earth.ppm'))
    for name, text in *scenes, ('seed.pov', pov()), ('seed.dat', dat(folder)):
        with open(f'{folder}/{name}', 'w') as file:
            file.write(text)
