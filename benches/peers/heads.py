"""What the scenes of POV-Ray and Tachyon begin with: size, camera, light, background. Both are left-handed: z is turned round."""
import os
import sys


def f(*numbers):
    return ','.join('%.17g' % x for x in numbers)


def g(*numbers):
    return ' '.join('%.17g' % x for x in numbers)


def out():
    """The folder to write to: the first argument, or `out`."""
    folder = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else 'out')
    os.makedirs(folder, exist_ok=True)
    return folder


def povray(depth, camera, at, light):
    return '''#version 3.7;
global_settings{assumed_gamma 1 max_trace_level %d}
background{rgb <0.45,0.6,0.8>}
camera{perspective location <%s> right x*16/9 up y direction z*2 look_at <%s>}
light_source{<%s> rgb 1}
#declare F=finish{ambient .2 diffuse .8}
''' % (depth, camera, at, light)


def tachyon(depth, center, direction, light):
    return f'''BEGIN_SCENE
RESOLUTION 1280 720
CAMERA
 ZOOM 2.0
 ASPECTRATIO 1.0
 ANTIALIASING 0
 RAYDEPTH {depth}
 CENTER {center}
 VIEWDIR {direction}
 UPDIR 0 1 0
END_CAMERA
BACKGROUND 0.45 0.6 0.8
LIGHT CENTER {light} RAD 0.001 COLOR 1 1 1
'''
