"""The seed scene (`examples/cosc363.scene`) as text for POV-Ray, Tachyon and rtdsl, with all lengths times `s` and then moved
by `tx` along x. The three texts come from one description, and every length in them is the same double, with 17 digits.

Right-handed, y up, eye at the origin looking along -z, the picture half as high as it is far away.
"""

import math

LIGHT = (30, 45, 20)
BACKGROUND = (0.45, 0.6, 0.8)
FLOOR_Y, SQUARE, LIGHT_SQUARE, DARK_SQUARE = -15, 10, (0.9, 0.9, 0.85), (0.15, 0.35, 0.2)
MIRROR_AT, MIRROR_R, MIRROR_COLOR, REFLECT = (0, 0, -115), 13, (0.1, 0.1, 0.3), 0.7
GLOBE_AT, GLOBE_R = (-23, -5, -100), 9
STRIPED_AT, STRIPED_R, STRIPES, STRIPE = (23, -6, -95), 9, ((0.9, 0.5, 0.1), (0.2, 0.2, 0.7)), 1
TUBE_FROM, TUBE_TO, TUBE_R, TUBE_COLOR, TRANSMIT = (10, -15, -75), (10, -5, -75), 3.5, (0.1, 0.25, 0.1), 0.7
CONE_FROM, CONE_TO, CONE_R, CONE_COLOR = (-12, -15, -78), (-12, -5, -78), 4, (0.8, 0.2, 0.2)
CORNERS = ((-3, -15, -66), (4, -15, -68), (0.5, -15, -74), (0.7, -8, -69))
TETRAHEDRON_COLOR = (0.9, 0.8, 0.2)
FACES = ((0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3))
AMBIENT, DIFFUSE, SPECULAR, SHININESS = 0.2, 0.8, 0.5, 20
DEPTH, ASPECT = 5, 16 / 9


def place(p, s, tx):
    """A point, scaled, then moved."""
    return (p[0] * s + tx, p[1] * s, p[2] * s)


def numbers(values, between):
    """Numbers that read back as the same doubles."""
    return between.join("%.17g" % v for v in values)


def rtdsl(s, tx, globe):
    """`globe`: the path of the picture on the globe, as for the other two."""
    at = lambda p: "[" + numbers(place(p, s, tx), ", ") + "]"
    length = lambda x: "%.17g" % (x * s)
    color = lambda c: "linear(" + numbers(c, ", ") + ")"
    to_world = f"move([{tx:.17g}, 0, 0])"
    return f"""let shiny = phong(diffuse: {DIFFUSE}, specular: {SPECULAR}, shininess: {SHININESS})
camera(from: {at((0, 0, 0))}, at: {at((0, 0, -1))}, fov: 2 * atan(0.25))
background({color(BACKGROUND)})
ambient({AMBIENT})
light(at: {at(LIGHT)})
plane(y: {length(FLOOR_Y)}, mat: phong(color: checker({color(LIGHT_SQUARE)}, {color(DARK_SQUARE)}, size: {length(SQUARE)}) |> {to_world}))
sphere(at: {at(MIRROR_AT)}, r: {length(MIRROR_R)}, mat: shiny.with(color: {color(MIRROR_COLOR)}, reflect: {REFLECT}))
sphere(at: {at(GLOBE_AT)}, r: {length(GLOBE_R)}, mat: shiny.with(color: image("{globe}", mapping: "normal", filter: "nearest")))
sphere(at: {at(STRIPED_AT)}, r: {length(STRIPED_R)}, mat: shiny.with(color: stripes({color(STRIPES[0])}, {color(STRIPES[1])}, axis: "y", size: {length(STRIPE)})))
cylinder(from: {at(TUBE_FROM)}, to: {at(TUBE_TO)}, r: {length(TUBE_R)}, caps: false, mat: shiny.with(color: {color(TUBE_COLOR)}, transmit: {TRANSMIT}))
cone(from: {at(CONE_FROM)}, to: {at(CONE_TO)}, r: {length(CONE_R)}, mat: shiny.with(color: {color(CONE_COLOR)}))
tetrahedron(points: [{", ".join(at(p) for p in CORNERS)}], mat: shiny.with(color: {color(TETRAHEDRON_COLOR)}))
render(aa: off, depth: {DEPTH})
"""


def povray(s, tx, globe):
    """`globe`: the path of the picture on the globe, a PNG."""
    at = lambda p: "<" + numbers(place(p, s, tx), ",") + ">"
    length = lambda x: "%.17g" % (x * s)
    color = lambda c: "rgb <" + numbers(c, ",") + ">"
    triangles = "\n".join("triangle{" + ",".join(at(CORNERS[i]) for i in face) + "}" for face in FACES)
    # POV-Ray filters what lies behind and weighs the surface's own colour with the rest; ours adds both.
    tube = numbers([x / (1 - TRANSMIT) for x in TUBE_COLOR], ",")
    # The globe's picture is laid on by the normal: u = asin(x)/π + ½ and the same with y; a pigment for each channel.
    channels = "\n".join(
        f"[1 function{{0.9999*Picture(Across(x),Across(y),0).{c}}} color_map{{[0 rgb 0][1 rgb <{white}>]}}]"
        for c, white in (("red", "3,0,0"), ("green", "0,3,0"), ("blue", "0,0,3"))
    )
    bands = f"[0 {color(STRIPES[0])}][0.5 {color(STRIPES[0])}][0.5 {color(STRIPES[1])}][1 {color(STRIPES[1])}]"
    return f"""#version 3.7;
global_settings{{assumed_gamma 1 max_trace_level {DEPTH}}}
background{{{color(BACKGROUND)}}}
camera{{perspective location {at((0, 0, 0))} direction <0,0,{length(-2)}> up <0,{length(1)},0> right <{length(ASPECT)},0,0>}}
light_source{{{at(LIGHT)} rgb 1}}
#declare Shiny=finish{{ambient {AMBIENT} diffuse {DIFFUSE} phong {SPECULAR} phong_size {SHININESS}}}
#declare Picture=function{{pigment{{image_map{{png "{globe}" map_type 0}}}}}}
#declare Across=function(x){{asin(max(-1,min(1,x)))/pi+0.5}}
plane{{y,{length(FLOOR_Y)} pigment{{checker {color(LIGHT_SQUARE)} {color(DARK_SQUARE)} scale {length(SQUARE)} translate <{tx:.17g},0,0>}} finish{{ambient {AMBIENT} diffuse {DIFFUSE}}}}}
sphere{{{at(MIRROR_AT)},{length(MIRROR_R)} pigment{{{color(MIRROR_COLOR)}}} finish{{Shiny reflection{{{REFLECT}}}}}}}
sphere{{0,1 pigment{{average pigment_map{{{channels}}}}} finish{{Shiny}} scale {length(GLOBE_R)} translate {at(GLOBE_AT)}}}
sphere{{{at(STRIPED_AT)},{length(STRIPED_R)} pigment{{gradient y color_map{{{bands}}} scale {length(2 * STRIPE)}}} finish{{Shiny}}}}
cylinder{{{at(TUBE_FROM)},{at(TUBE_TO)},{length(TUBE_R)} open pigment{{rgbt <{tube},{TRANSMIT}>}} finish{{Shiny}}}}
cone{{{at(CONE_FROM)},{length(CONE_R)},{at(CONE_TO)},0 pigment{{{color(CONE_COLOR)}}} finish{{Shiny}}}}
union{{{triangles} pigment{{{color(TETRAHEDRON_COLOR)}}} finish{{Shiny}}}}
"""


# Tachyon's own checker has squares of a third of a unit, whatever its SCALE says. So its floor carries a picture of this many
# squares across; and it has no cone, so a fan of this many triangles with normals stands for one.
SQUARES, FAN = 64, 128


def tachyon(s, tx, size, globe, stripes, floor):
    """`globe`, `stripes`, `floor`: paths of PPM files, of the pictures that `extremes.py` makes. Left-handed: z is turned round."""
    at = lambda p: numbers((lambda x, y, z: (x, y, -z))(*place(p, s, tx)), " ")
    length = lambda x: "%.17g" % (x * s)

    def texture(color, reflect=0, opacity=1, shiny=True, pattern="0"):
        phong = f"PHONG PLASTIC {SPECULAR} PHONG_SIZE {SHININESS} " if shiny else ""
        surface = f"AMBIENT {AMBIENT} DIFFUSE {DIFFUSE} SPECULAR {reflect} OPACITY {opacity} {phong}"
        return f"{surface}COLOR {numbers(color, ' ')} TEXFUNC {pattern}"

    round_about = lambda file, p: f"8 {file} CENTER {at(p)} ROTATE 0 0 0 SCALE 1 1 1"
    across = "%.17g" % (1 / (SQUARES * SQUARE * s))
    laid_on = f"9 {floor} CENTER {tx:.17g} 0 0 ROTATE 0 0 0 SCALE {across} {across} 1 UAXIS 1 0 0 VAXIS 0 0 1"
    white = (1, 1, 1)
    out = [
        f"BEGIN_SCENE\nRESOLUTION {size[0]} {size[1]}",
        f"CAMERA\n ZOOM 2.0\n ASPECTRATIO 1.0\n ANTIALIASING 0\n RAYDEPTH {DEPTH}\n CENTER {at((0, 0, 0))}",
        " VIEWDIR 0 0 1\n UPDIR 0 1 0\nEND_CAMERA",
        f"BACKGROUND {numbers(BACKGROUND, ' ')}",
        f"LIGHT CENTER {at(LIGHT)} RAD {length(0.001)} COLOR 1 1 1",
        f"PLANE CENTER {at((0, FLOOR_Y, 0))} NORMAL 0 1 0 TEXTURE {texture(white, shiny=False, pattern=laid_on)}",
        f"SPHERE CENTER {at(MIRROR_AT)} RAD {length(MIRROR_R)} TEXTURE {texture(MIRROR_COLOR, reflect=REFLECT)}",
        f"SPHERE CENTER {at(GLOBE_AT)} RAD {length(GLOBE_R)} TEXTURE {texture(white, pattern=round_about(globe, GLOBE_AT))}",
        f"SPHERE CENTER {at(STRIPED_AT)} RAD {length(STRIPED_R)}"
        f" TEXTURE {texture(white, pattern=round_about(stripes, STRIPED_AT))}",
        f"FCYLINDER BASE {at(TUBE_FROM)} APEX {at(TUBE_TO)} RAD {length(TUBE_R)}"
        f" TEXTURE {texture(TUBE_COLOR, opacity=round(1 - TRANSMIT, 6))}",
        f"TEXDEF cone {texture(CONE_COLOR)}",
    ]
    height = CONE_TO[1] - CONE_FROM[1]
    x, y, z = CONE_FROM

    def corner(k):
        turn = 2 * math.pi * k / FAN
        return at((x + CONE_R * math.cos(turn), y, z + CONE_R * math.sin(turn)))

    def normal(k):
        turn = 2 * math.pi * k / FAN
        return numbers((math.cos(turn), CONE_R / height, -math.sin(turn)), " ")

    for k in range(FAN):
        corners = f"V0 {corner(k)} V1 {corner(k + 1)} V2 {at(CONE_TO)}"
        out.append(f"STRI {corners} N0 {normal(k)} N1 {normal(k + 1)} N2 {normal(k + 0.5)} cone")
    out.append(f"RING CENTER {at(CONE_FROM)} NORMAL 0 1 0 INNER 0 OUTER {length(CONE_R)} cone")
    out.append(f"TEXDEF tetrahedron {texture(TETRAHEDRON_COLOR)}")
    for face in FACES:
        out.append("TRI " + " ".join(f"V{k} {at(CORNERS[i])}" for k, i in enumerate(face)) + " tetrahedron")
    return "\n".join(out) + "\nEND_SCENE\n"
