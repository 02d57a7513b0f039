"""CIELAB split, scaling, gamut and display. The twin of shaders/tone.glsl, in float64.

Ishii et al., eqs. 1-4, with CIE 15's piecewise lightness. XYZ is relative to Y_n.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.seen import beyond
from relgloss_view.material import cielab

LAB_EPSILON = cielab.EPSILON
GAMUT_TOLERANCE = 1e-4
CLIP_TOLERANCE = 1e-3
BISECTIONS = 16
MOST_HELD = 256  #: lights whose digital values a display holds
OFF_OBJECT = -60000.0  #: L_d* of a pixel that shows nothing of the object
#: Below this L_s* a highlight is invisible, and c_max has no meaning.
NO_LOBE_LSTAR = 0.5


def lab_f(t: Array) -> Array:
    """CIE 15's f of a relative tristimulus value; value and slope are continuous.

    >>> lab_f(np.array([1.0])).tolist()
    [1.0]
    """
    return cielab.f_of_ratio(t)


def lab_f_inverse(f: Array) -> Array:
    """Inverse of lab_f."""
    return cielab.ratio_of_f(f)


def lightness(y: Array) -> Array:
    """L* of a relative luminance y: 0 at 0, 100 at 1 (CIE 15:2004).

    >>> lightness(np.array([0.0, 0.18, 1.0])).round(3).tolist()  # black, an 18 % card, white
    [0.0, 49.496, 100.0]
    """
    return cielab.lightness(y)


def lab_from_xyz(xyz: Array, white: Array) -> Array:
    """L*, a*, b* of XYZ (..., 3) against a white (3,), in the same unit (CIE 15:2004).

    >>> lab_from_xyz(np.array([0.2, 0.18, 0.1]), np.array([0.9505, 1.0, 1.0891])).round(2).tolist()
    [49.5, 15.08, 22.7]
    """
    return cielab.lab_from_xyz(xyz, white)


def xyz_from_lab(lab: Array, white: Array) -> Array:
    """XYZ (..., 3) of L*, a*, b* against a white (3,); the inverse of lab_from_xyz.

    >>> xyz_from_lab(np.array([100.0, 0.0, 0.0]), np.array([0.95, 1.0, 1.09])).round(6).tolist()
    [0.95, 1.0, 1.09]
    """
    return cielab.xyz_from_lab(lab, white)


def split_lightness(y_diffuse: Array, y_specular: Array) -> tuple[Array, Array]:
    """L_d* and L_s*: lightness of the diffuse part, and its increase by the specular part (eq. 1).

    y_diffuse, y_specular: luminance relative to Y_n.

    >>> l_d, l_s = split_lightness(np.array(0.2), np.array(0.3))
    >>> round(float(l_d), 3), round(float(l_s), 3), round(float(l_d + l_s), 3)
    (51.837, 24.232, 76.069)
    """
    diffuse = lightness(y_diffuse)
    return diffuse, lightness(y_diffuse + y_specular) - diffuse


def split_lab(diffuse: Array, specular: Array, white: Array) -> Array:
    """(L_d*, L_s*, a*, b*), (..., 4), of diffuse and specular XYZ (..., 3) against a white (3,)."""
    l_d, l_s = split_lightness(diffuse[..., 1], specular[..., 1])
    chromatic = lab_from_xyz(diffuse + specular, white)[..., 1:]
    return np.concatenate([l_d[..., None], l_s[..., None], chromatic], axis=-1)


def scaled_lab(split: Array, c: float) -> Array:
    """L~*, a*, b* (..., 3) of (L_d*, L_s*, a*, b*), the specular part scaled by c (eqs. 2-3).

    >>> scaled_lab(np.array([50.0, 40.0, 1.0, 2.0]), 0.5).tolist()
    [70.0, 1.0, 2.0]
    """
    return np.concatenate([split[..., :1] + c * split[..., 1:2], split[..., 2:]], axis=-1)


def false_colour(lightness_: Array) -> Array:
    """(..., 3), a Lab colour for each lightness, its hue turning from violet to yellow."""
    share = np.clip(lightness_ / 100.0, 0.0, 1.0)
    angle = 5.4 - 3.8 * share
    return np.stack([100.0 * share, 45.0 * np.cos(angle), 45.0 * np.sin(angle)], axis=-1)


def largest_c(l_diffuse: Array, l_specular: Array) -> Array:
    """The largest c that keeps each pixel at L* 100 or below (eq. 4); 1e30 without specular part.

    >>> largest_c(np.array([60.0, 50.0]), np.array([80.0, 0.0])).tolist()
    [0.5, 1e+30]
    """
    seen = l_specular > 1e-6
    return np.where(seen, (100.0 - l_diffuse) / np.where(seen, l_specular, 1.0), 1e30)


def in_gamut(rgb: Array, display: DisplayModel) -> Mask:
    """Whether linear RGB (..., 3) lies in the display's cube, and its table shows it if it has one.

    What a table shows is decided as on the device (Table.reach).
    """
    inside = np.asarray(np.all((rgb >= -GAMUT_TOLERANCE) & (rgb <= 1.0 + GAMUT_TOLERANCE), axis=-1))
    if display.emission is None or display.fills_cube:
        return inside
    bounded = np.clip(rgb[inside], display.lowest, 1.0)
    inside[inside] = display.emission.reach((bounded - display.floor) / (1.0 - display.floor))
    return inside


def display_rgb(lab: Array, display: DisplayModel) -> tuple[Array, Mask]:
    """Linear display RGB (..., 3), `lowest` to 1, and (...) whether each is inside the gamut.

    lab: (..., 3), relative to the display's white. Outside the gamut, 'chroma' keeps L* and hue and
    reduces chroma by bisection to the gamut's edge; 'clip' cuts each channel.

    >>> from relgloss_view.display.display import Display
    >>> rgb, inside = display_rgb(np.array([[50.0, 0.0, 0.0]]), DisplayModel.of(Display()))
    >>> rgb.round(3).tolist(), inside.tolist()
    ([[0.184, 0.184, 0.184]], [True])
    """

    def rgb_of(lightness_: Array, chromatic: Array) -> Array:
        xyz = xyz_from_lab(np.concatenate([lightness_, chromatic], axis=-1), display.white)
        return np.asarray(xyz @ display.rgb_from_xyz.T)

    bounded = np.clip(lab[..., :1], 0.0, 100.0)
    rgb = rgb_of(bounded, lab[..., 1:])
    inside = in_gamut(rgb, display)
    if not np.all(inside) and display.gamut == "chroma":
        held, chroma = bounded[~inside], lab[..., 1:][~inside]
        low, high = np.zeros(len(held)), np.ones(len(held))
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            fits = in_gamut(rgb_of(held, middle[:, None] * chroma), display)
            low, high = np.where(fits, middle, low), np.where(fits, high, middle)
        rgb[~inside] = rgb_of(held, low[:, None] * chroma)
    return np.clip(rgb, display.lowest, 1.0), inside


def srgb_encode(light: Array) -> Array:
    """Digital values, 0 to 1, of linear light, 0 to 1 (IEC 61966-2-1:1999).

    >>> srgb_encode(np.array([0.0, 0.18, 1.0])).round(4).tolist()
    [0.0, 0.4614, 1.0]
    """
    return cielab.srgb_encoded(light)


def on_screen(rgb: Array, display: DisplayModel) -> Array:
    """Linear RGB of the screen that shows a display's light (..., 3), before it is cut.

    A display that no other one shows is its own screen. The display shows no less than its black.
    """
    rgb = np.maximum(rgb, display.darkest)
    return rgb if display.screen_from_rgb is None else np.asarray(rgb @ display.screen_from_rgb.T)


def cut_by_screen(rgb: Array, display: DisplayModel) -> Mask:
    """(...) whether the screen that shows a display's light (..., 3) can't show it as it is."""
    if display.screen is None:
        return np.zeros(rgb.shape[:-1], dtype=bool)
    return beyond(on_screen(rgb, display), display.screen.darkest)


def encode(rgb: Array, display: DisplayModel) -> Array:
    """Digital values, 0 to 1, of linear light, 0 to 1, through the display's transfer function.

    sRGB, or the inverse of light = (gain d + offset)^gamma + flare (Berns 1996).

    >>> from relgloss_view.display.display import Display
    >>> gamma = DisplayModel.of(Display(transfer="gain-offset-gamma", gamma=2.0))
    >>> encode(np.array([0.25]), gamma).tolist()
    [0.5]
    """
    if display.screen is not None:
        return encode(np.clip(on_screen(rgb, display), 0.0, 1.0), display.screen)
    if display.emission is not None:  # a table shows some light below 0 of a channel
        light = (rgb - display.floor) / (1.0 - display.floor)
        return display.emission.cut(light.reshape(-1, 3)).reshape(rgb.shape)
    if np.any(display.floor):
        rgb = np.maximum(rgb - display.floor, 0.0) / (1.0 - display.floor)
    if display.transfer == "srgb":
        return srgb_encode(rgb)
    gain, offset, gamma, flare = display.curve
    white = (gain + offset) ** gamma + flare
    light = np.maximum(rgb * white - flare, 0.0)
    return np.asarray(np.clip((np.power(light, 1.0 / gamma) - offset) / gain, 0.0, 1.0))


def as_shown(rgb: Array, display: DisplayModel) -> Array:
    """Linear RGB (..., 3) that the display shows of what it is asked for: no less than its black.

    >>> from relgloss_view.display.display import Display
    >>> as_shown(np.zeros((1, 3)), DisplayModel.of(Display(black_cd_m2=2.0))).round(3).tolist()
    [[0.02, 0.02, 0.02]]
    """
    return np.maximum(rgb, display.darkest) if np.any(display.darkest) else rgb


def surround_digital(display: DisplayModel) -> Array:
    """(3,), digital values of the neutral surround, 0 to 1. By a profile the channels differ.

    >>> from relgloss_view.display.display import Display
    >>> surround_digital(DisplayModel.of(Display())).round(3).tolist()
    [0.466, 0.466, 0.466]
    """
    if "surround" not in display.held:
        display.held["surround"] = tuple(encode(display.background_rgb, display).tolist())
    return np.array(display.held["surround"])


def neutral_digital(light: float, display: DisplayModel) -> tuple[float, float, float]:
    """Digital values of a gray of linear light relative to white, which is cut to 0 to 1.

    >>> from relgloss_view.display.display import Display
    >>> [round(v, 3) for v in neutral_digital(0.184, DisplayModel.of(Display()))]
    [0.466, 0.466, 0.466]
    """
    light = min(max(float(light), 0.0), 1.0)
    if light not in display.held:
        if len(display.held) >= MOST_HELD:
            display.held.clear()
        display.held[light] = tuple(encode(np.full(3, light), display).tolist())
    red, green, blue = display.held[light]
    return red, green, blue


def dither_step(column: Ints, row: Ints) -> Array:
    """What is added to a digital value before it is rounded, in steps: above -0.5, below 0.5.

    column, row: of the pixel, the row from the bottom. Roberts 2018, R2, in 32 bits: evenly spread,
    with as little of coarse pattern as points in the plane can have.

    >>> dither_step(np.array([0, 1, 2]), np.array([0, 0, 0])).round(3).tolist()
    [-0.5, 0.255, 0.01]
    """
    x, y = (np.asarray(v).astype(np.uint32) for v in (column, row))
    turned = x * np.uint32(3242174889) + y * np.uint32(2447445413)
    return ((turned >> np.uint32(9)).astype(np.float64) + 0.5) * 2.0**-23 - 0.5


def digital_steps(
    light: Array, display: DisplayModel, dithered: Mask | None = None, lowest_row: int = 0
) -> Array:
    """Digital values of 8 bits, 0 to 255, of linear display RGB (H, W, 3).

    Rounded to the nearest; where `dithered` (H, W), after dither_step. lowest_row: that of the
    arrays' last one, counted from the bottom of the picture.
    """
    steps = 255.0 * encode(light, display) + 0.5
    if dithered is not None:
        height, width = dithered.shape
        from_bottom = lowest_row + np.arange(height, dtype=np.int64)[::-1, None]
        added = dither_step(np.arange(width, dtype=np.int64)[None, :], from_bottom)
        steps += np.where(dithered, added, 0.0)[..., None]
    return np.asarray(np.clip(np.floor(steps), 0.0, 255.0))
