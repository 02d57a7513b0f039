"""Pictures whose L* is split in pass 1 or in pass 2, and what rounding may change between them."""

from __future__ import annotations

import ctypes
import ctypes.util

import numpy as np

from relgloss_view.pack.shape import Shape
from relgloss_view.picture.method import FIRST_PASS, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

SIZE = (56, 42)
IN_PASS_1 = Method(split=FIRST_PASS)
SHAPES = ("cylinder", "sphere", "plane", "box")
ULP = 2.0**-24  #: relative rounding of one operation in float32

GL_TEXTURE_2D, GL_TEXTURE_INTERNAL_FORMAT = 0x0DE1, 0x1003
FORMATS = {0x8230: "RG32F", 0x8814: "RGBA32F", 0x881A: "RGBA16F", 0x8058: "RGBA8"}


def scene_of(shape="cylinder", material=None, azimuth_deg=-12.0, **changes):
    """A shape seen from above, its lamp near where a sheet mirrors the eye."""
    return Scene(
        material or load_sample("matte-coated"),
        shape=Shape(kind=shape, width_m=0.07, depth_m=0.05),
        eye=Eye(azimuth_deg=15.0, elevation_deg=20.0),
        lamp=Lamp(azimuth_deg=azimuth_deg, elevation_deg=-18.0),
        **changes,
    )


def forced(**entries):
    return Method(variant=tuple(entries.items()))


def bounds(frame, bands):
    """What rounding may change of (L_d*, L_s*, a*, b*), (H, W, 4), of one drawing of a pixel.

    XYZ is a sum of products: one product a band, or two where the spectra are folded, then their
    sum, the sum of diffuse and specular and the division by the white. Every term is positive (but
    for a broad band's weights), so that the relative error is at most one rounding an operation.
    cube_root is right within 4 units in the last place (cube_root.glsl), and f varies less than in
    proportion to t; the last two operations round once each. Units of f count 116, 500 and 200
    times in L*, a*, b*; L_s* is a difference of two lightnesses.
    """
    white = frame.white_xyz
    diffuse, specular = (a.astype(np.float64) for a in (frame.diffuse, frame.specular))
    operations = 2 * max(bands, 2) + 2 + 2 * 4 + 2
    f = np.max(np.abs(tone.lab_f((diffuse + specular) / white)), axis=-1)
    rounding = operations * ULP * f
    return np.stack([116.0 * rounding, 232.0 * rounding, 1000.0 * rounding, 400.0 * rounding], -1)


def excess(frame, other, bands=0):
    """The largest difference of two frames' split, as a multiple of what rounding may do.

    Each frame may be off by the bound, so that 2 is the most that rounding explains.
    """
    first, second = (f._fetch("split").astype(np.float64) for f in (frame, other))
    np.testing.assert_array_equal(frame.on_object, other.on_object)
    on = frame.on_object
    return float(np.max(np.abs(first - second)[on] / bounds(frame, bands)[on]))


def internal_format(renderer, name):
    """OpenGL's own word for the numbers of a target."""
    egl = ctypes.CDLL(ctypes.util.find_library("EGL"))
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    read = ctypes.CFUNCTYPE(None, *[ctypes.c_uint] * 3, ctypes.POINTER(ctypes.c_int))(
        egl.eglGetProcAddress(b"glGetTexLevelParameteriv")
    )
    renderer.texture(name).use()
    value = ctypes.c_int()
    read(GL_TEXTURE_2D, 0, GL_TEXTURE_INTERNAL_FORMAT, ctypes.byref(value))
    return FORMATS[value.value]
