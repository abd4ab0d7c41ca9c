"""The mesh in Mitsuba, scalar: load, build, trace one ray a pixel and one to the light, write the picture.
`python mitsuba_mesh.py FOLDER OUT.png` reads FOLDER/mesh1m.ply; camera, light and color are those of mesh.scene."""
import sys

import mitsuba as mi

mi.set_variant('scalar_rgb')
scene = mi.load_dict({
    'type': 'scene',
    # One ray to the light for each hit and none at random, as the others do.
    'integrator': {'type': 'direct', 'emitter_samples': 1, 'bsdf_samples': 0},
    'sensor': {
        'type': 'perspective',
        'fov': 28.0724869,
        'fov_axis': 'y',
        'to_world': mi.ScalarTransform4f().look_at(origin=[0, 5, 14], target=[0, 0, 0], up=[0, 1, 0]),
        'sampler': {'type': 'independent', 'sample_count': 1},
        'film': {'type': 'hdrfilm', 'width': 1280, 'height': 720, 'rfilter': {'type': 'box'}, 'pixel_format': 'rgb'},
    },
    'light': {'type': 'point', 'position': [6, 10, 6], 'intensity': {'type': 'rgb', 'value': 300.0}},
    'mesh': {
        'type': 'ply',
        'filename': f'{sys.argv[1]}/mesh1m.ply',
        'face_normals': True,
        'bsdf': {'type': 'diffuse', 'reflectance': {'type': 'rgb', 'value': [0.7, 0.6, 0.4]}},
    },
})
mi.util.write_bitmap(sys.argv[2], mi.render(scene), write_async=False)
