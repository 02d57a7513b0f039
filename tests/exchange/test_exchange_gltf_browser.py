"""three.js in a real Chromium draws the .glb: its pixels against the factors, and its errors."""

from __future__ import annotations

import dataclasses
import functools
import http.server
import threading

import numpy as np
import pytest
from browsers import SWIFTSHADER, call, call_array, chromium, console, open_page
from gltf_judges import FOLDER

import relgloss_view as rg
from relgloss_view.exchange import judge
from relgloss_view.exchange.gltf import glb
from relgloss_view.exchange.gltf_refit import refit_gltf
from relgloss_view.exchange.refit import LAMP
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB
from relgloss_view.pack.built_in import load_finish
from relgloss_view.picture.model import lights
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Lamp, Setup

pytestmark = pytest.mark.slow

SIZE = 512
PAGE = """<!doctype html><link rel="icon" href="data:,"><script type="importmap">{"imports": {
  "three": "/node_modules/three/build/three.module.js",
  "three/addons/": "/node_modules/three/examples/jsm/"}}</script><canvas></canvas>
<script type="module">
import * as THREE from "three";
import {GLTFLoader} from "three/addons/loaders/GLTFLoader.js";
window.draw = async (file, angle, azimuth, middle) => {
  const renderer = new THREE.WebGLRenderer({canvas: document.querySelector("canvas")});
  const target = new THREE.WebGLRenderTarget(512, 512, {type: THREE.FloatType});
  const scene = new THREE.Scene();
  scene.add((await new GLTFLoader().loadAsync(file)).scene);
  const camera = new THREE.PerspectiveCamera(angle, 1, 0.01, 10);
  camera.position.set(0, middle, 0.6);
  camera.lookAt(0, middle, 0);
  const lamp = new THREE.PointLight(0xffffff, 1, 0, 2);
  lamp.position.set(Math.sin(azimuth), middle, Math.cos(azimuth));
  scene.add(lamp);
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const pixels = new Float32Array(512 * 512 * 4);
  renderer.readRenderTargetPixels(target, 0, 0, 512, 512, pixels);
  return pixels;
};
window.loaded = true;
</script>"""


class _Handler(http.server.SimpleHTTPRequestHandler):
    extensions_map = {".js": "text/javascript", ".html": "text/html", "": "model/gltf-binary"}  # noqa: RUF012

    def log_message(self, *words):
        """No line for each request."""

    def translate_path(self, path):
        if path.startswith("/node_modules/"):
            return str(FOLDER / path.lstrip("/"))
        return super().translate_path(path)


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """A function that draws a .glb: linear RGB (512, 512, 3), row 0 the top."""
    if not (FOLDER / "node_modules" / "three").is_dir():
        pytest.fail(
            "three is missing. Install it: npm ci --prefix requirements/gltf-validator "
            "--ignore-scripts (make test does)",
            pytrace=False,
        )
    folder = tmp_path_factory.mktemp("page")
    (folder / "page.html").write_text(PAGE)
    handler = functools.partial(_Handler, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with chromium(*SWIFTSHADER, needs="SwiftShader") as browser:

            def draw(data: bytes, angle_deg: float, middle: float) -> np.ndarray:
                (folder / "it.glb").write_bytes(data)
                address = f"http://127.0.0.1:{server.server_port}/page.html"
                open_page(browser, address, wait=False)
                frame = "new Promise(requestAnimationFrame)"
                call(browser, f"async () => {{ while (!window.loaded) await {frame}; }}")
                azimuth = float(np.radians(50.0))
                words = ("it.glb", angle_deg, azimuth, middle)
                pixels = call_array(browser, "(...words) => window.draw(...words)", *words)
                console(browser)  # errors fail here
                return pixels.reshape(SIZE, SIZE, 4)[::-1, :, :3].astype(float)

            yield draw
        server.shutdown()


@pytest.mark.parametrize(
    ("name", "most"),
    # three.js widens lobes on curved forms so that they do not flicker, by up to a pixel's turn of
    # the normal: nothing for a matt surface, much for a foil, whose lobe is 1.5 pixels wide.
    [("soft-touch", 0.5), ("matte-coated", 1.5), ("satin-varnish", 3.0), ("cold-foil-gold", 6.0)],
)
def test_three_draws_the_highlight_that_the_factors_state(drawn, name, most):
    material = load_finish(name)
    setup = Setup(lamp=Lamp(azimuth_deg=50.0))
    view = view_of(setup.shape, setup.eye, (SIZE, SIZE))
    angle = float(np.degrees(2.0 * np.arctan(0.5 * SIZE * view.pixel_step)))
    picture = drawn(glb(material)[0], angle, 0.05)
    row = SIZE // 2 - 1
    hit, ray, _ = sight(setup.shape, view, np.arange(SIZE)[None], np.full((1, SIZE), row))
    on = hit.found[0]
    o = -ray[0][on] / np.linalg.norm(ray[0][on], axis=-1, keepdims=True)
    [light] = lights.lit(setup, hit.point_m[0][on])
    frames = judge._frames(hit.normal[0][on])
    i, o = (np.einsum("pab,pb->pa", frames, v) for v in (light.i, o))
    arriving = np.maximum(i[:, 2], 0.0) / light.distance2
    surface = refit_gltf(material).surface
    diffuse, specular = surface.evaluate(i, o)
    weights = xyz_weights(RGB, illuminant(LAMP)) * np.pi / np.max(arriving)
    white = illuminant(LAMP).white_xyz()
    ours = ((diffuse + specular) * arriving[:, None]) @ weights
    theirs = picture[row][on] @ weights
    in_highlight = (specular * arriving[:, None] @ weights)[:, 1] > 0.01
    assert in_highlight.sum() > 5
    apart = delta_e_2000(lab_from_xyz(ours, white), lab_from_xyz(theirs, white))
    assert np.percentile(apart[in_highlight], 95) <= most
    # Negative control: the highlight of a surface a tenth rougher lies further off.
    rougher = dataclasses.replace(
        surface,
        roughness=1.1 * surface.roughness,
        clearcoat_roughness=1.1 * surface.clearcoat_roughness,
    )
    other = sum(rougher.evaluate(i, o)) * arriving[:, None] @ weights
    control = delta_e_2000(lab_from_xyz(other, white), lab_from_xyz(theirs, white))
    if name != "cold-foil-gold":
        assert np.mean(control[in_highlight]) > np.mean(apart[in_highlight])


def test_three_draws_the_can_upright_with_its_artwork(drawn):
    """Berries (red) below the middle, the gold moon above it: no flip of v, no mirror."""
    picture = drawn(glb(rg.read_pack("can"), most_px=512)[0], 14.0, 0.0575)
    red = (picture[..., 0] > 3.0 * picture[..., 1]) & (picture[..., 0] > 0.02)
    rows, columns = np.nonzero(red)
    assert len(rows) > 500
    assert rows.mean() > SIZE * 0.6
    body = picture[SIZE // 2, :, 1] > 1e-3
    assert 100 < body.sum() < 450
    assert abs(columns.mean() - SIZE / 2) < 60
