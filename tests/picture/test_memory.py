import subprocess
import sys

import pytest

from relgloss_view.picture.gpu.memory import bytes_per_pixel, device_bytes

#: A software driver keeps textures in the process's own memory, where they can be seen.
GROWTH = """
import sys
from relgloss_view.picture.gpu.context import open_context
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

def resident():
    with open("/proc/self/statm") as file:
        return 4096 * int(file.read().split()[1])

ctx = open_context("egl")
renderer = Renderer(ctx)
scene, look = Scene(load_sample("matte-coated")), Look(sigma_n_deg=1.0)
for size in ((64, 64), (2048, 2048)):
    before = resident()
    request = renderer.request(scene, look, size)
    renderer.passes.bring_up_to_date(request)
    ctx.finish()
    shown = resident()
    renderer.passes.bring(request, "diffuse")
    ctx.finish()
print(shown - before, resident() - shown)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_a_picture_takes_what_the_formula_says():
    """Within 15 %, the driver's own tiles and bins included."""
    done = subprocess.run(
        [sys.executable, "-c", GROWTH], capture_output=True, text=True, timeout=60, check=True
    )
    shown, parts = (int(word) for word in done.stdout.split())
    size = (2048, 2048)
    assert shown == pytest.approx(device_bytes(size), rel=0.15)
    assert parts == pytest.approx(device_bytes(size, ("XYZ",)) - device_bytes(size), rel=0.15)


def test_more_is_asked_for_more():
    # Two targets of two floats; L* split, four; display, four bytes; two results of four floats for
    # 4 x 4 pixels.
    assert bytes_per_pixel() == pytest.approx(2 * 8 + 16 + 4 + 2, abs=0.01)
    assert bytes_per_pixel(("XYZ", "normals")) - bytes_per_pixel() == 32 + 48
