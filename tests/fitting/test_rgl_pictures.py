"""Pictures of a fit against pictures of the measured table itself, on the cylinder of the paper.

The table is read by our reader, which tests/measure/test_rgl.py holds against mitsuba's `measured`.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from rgl_data import rgl_file

from relgloss_view.fitting import fit_material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.readers import read_measurement, rgl
from relgloss_view.picture.model import shape, tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp

SIZE = (160, 160)
LAMP = "HP5"


def frame_of(normal):
    """Two tangents and the normal, each (N, 3)."""
    aside = np.where(np.abs(normal[:, :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    tangent = np.cross(normal, aside)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return tangent, np.cross(normal, tangent), normal


def lights(material, table, azimuth_deg):
    """XYZ of the fit's diffuse and specular part and of the table's whole light, (N, 3) each."""
    scene = Scene(material, lamp=Lamp(azimuth_deg=azimuth_deg, illuminant=LAMP))
    view = View.of(scene, SIZE)
    ray = view.rays(slice(0, SIZE[1]))
    hit = shape.meet("cylinder", view.eye_m, ray, np.asarray(scene.shape.half_extent_m()))
    normal, ray = hit.normal[hit.found], ray[hit.found]
    way = np.asarray(scene.lamp.position_m) - hit.point_m[hit.found]
    distance = np.linalg.norm(way, axis=1)
    to_lamp, to_eye = way / distance[:, None], -ray / np.linalg.norm(ray, axis=1)[:, None]
    lit = np.maximum(np.sum(normal * to_lamp, axis=1), 0.0) / distance**2
    i, o = (
        np.stack([np.sum(v * axis, axis=1) for axis in frame_of(normal)], axis=-1)
        for v in (to_lamp, to_eye)
    )
    arriving = (np.pi / np.max(lit) * lit)[:, None]
    weights = xyz_weights(material.bands, illuminant(LAMP))
    diffuse, specular = (arriving * (part @ weights) for part in material.evaluate(i, o))
    whole = arriving * (table.evaluate(i, o) @ xyz_weights(RGB, illuminant(LAMP)))
    return diffuse, specular, whole


def differences(material, path, azimuth_deg):
    """dE2000 of every pixel on the object at the fit's c_max, and which are the brightest 5 %."""
    diffuse, specular, whole = lights(material, rgl.load(path), azimuth_deg)
    white = illuminant(LAMP).white_xyz()
    fitted = tone.split_lab(diffuse, specular, white)
    # The fit's diffuse part under both: what is left of the table's light is its highlight.
    measured = tone.split_lab(diffuse, whole - diffuse, white)
    shines = fitted[:, 1] > 1e-6
    c = min(float(np.min((100.0 - fitted[shines, 0]) / fitted[shines, 1])), 1.0)
    error = delta_e_2000(tone.scaled_lab(fitted, c), tone.scaled_lab(measured, c))
    return error, whole[:, 1] >= np.percentile(whole[:, 1], 95.0)


@pytest.mark.parametrize(
    ("name", "median", "p95"), [("paper_white", 0.6, 3.2), ("cg_sunflower", 1.0, 4.0)]
)
def test_the_body_at_lamp_50(name, median, p95):
    path = rgl_file(name)
    error, _ = differences(fit_material(read_measurement(path)), path, 50.0)
    assert np.median(error) <= median
    assert np.percentile(error, 95.0) <= p95


def test_a_yellow_cut_to_srgb_is_another_yellow():
    """Negative control: with its blue channel cut at zero the body is off by dE 2 and more."""
    path = rgl_file("cg_sunflower")
    measurement = read_measurement(path)
    to_srgb = xyz_weights(measurement.bands, illuminant("D65")) @ np.linalg.inv(
        xyz_weights(RGB, illuminant("D65"))
    )
    cut = np.maximum(measurement.radiance_factor @ to_srgb, 0.0)
    cut_table = dataclasses.replace(measurement, bands=RGB, radiance_factor=cut)
    error, _ = differences(fit_material(cut_table), path, 50.0)
    assert np.median(error) > 2.0


def test_a_satin_film_is_taken_for_a_metal_under_a_coat():
    """Its highlight turns white sooner than a metal's: closer than with colours that stay."""
    path = rgl_file("satin_rosaline")
    measurement = read_measurement(path)
    material = fit_material(measurement)
    assert material.fit is not None
    assert material.fit.chosen == "metal-and-lobe"
    stays = fit_material(measurement, model="two-lobes", free_index=False)
    assert stays.specular[0].strength != stays.specular[0].strength[:1]
    medians = []
    for fitted in (material, stays):
        error, brightest = differences(fitted, path, 110.0)
        medians.append(float(np.median(error[brightest])))
    assert medians[0] < medians[1] - 2.0
