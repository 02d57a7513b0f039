import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.writers import WAITING, Writers
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

SIZE = (60, 40)


def test_every_file_is_what_one_writes_alone(renderer, tmp_path):
    scene = Scene(load_sample("matte-coated"))
    looks = [Look(sigma_n_deg=0.1 * k, c=0.1 + 0.05 * k) for k in range(2 * WAITING + 1)]
    with Writers() as writers:
        for k, look in enumerate(looks):
            writers.save(renderer.render(scene, look, SIZE), tmp_path / f"{k}.png", "a command")
    pictures = []
    for k, look in enumerate(looks):
        save_frame(renderer.render(scene, look, SIZE), tmp_path / "alone.png", "a command")
        assert (tmp_path / f"{k}.png").read_bytes() == (tmp_path / "alone.png").read_bytes()
        pictures.append(np.asarray(Image.open(tmp_path / f"{k}.png")))
    assert np.any(pictures[0] != pictures[-1])  # or the order would not show


def test_a_fault_is_raised(renderer, tmp_path):
    frame = renderer.render(Scene(load_sample("matte-coated")), Look(), SIZE)
    writers = Writers()
    with pytest.raises(InputError, match="gone"), writers:
        writers.save(frame, tmp_path / "gone" / "a.png", "")
