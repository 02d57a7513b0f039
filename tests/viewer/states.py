"""States that hypothesis makes: every entry anywhere in its declared range."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import materials
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.display.display import Display
from relgloss_view.material.files import load_material, save_material
from relgloss_view.material.recolour import Colour
from relgloss_view.material.spectra import SHIPPED_ILLUMINANTS
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup
from relgloss_view.viewer.state.state import Presentation, Side, State

#: Names that files may have, and that quoting, TOML and argparse have to stand.
NAMES = (
    "plain.json",
    "two words.json",
    'it\'s "quoted" $HOME `x` \\n.json',
    "line\nbreak\r\ttab\x7f\x1b.json",
    "-o=x.json",
    "--size",
    "光沢 é 🎨.json",
    "deep/er/a#b=c;d.json",
    "None",
    "1e5",
    "[look]",
    " 'D65' ",
)


def values(f):
    """A strategy for one field by what it declares."""
    meta = f.metadata
    if "options" in meta:
        made = st.sampled_from(meta["options"])
    elif meta.get("file"):
        made = st.just(f.default)  # what files there are, a test knows itself
    elif meta.get("switch"):
        made = st.booleans()
    elif "range" in meta:
        low, high = meta["range"].low, meta["range"].high
        whole = meta.get("whole")
        made = st.integers(low, high) if whole else st.floats(low, high) | st.just(int(high))
    elif f.name == "illuminant":
        made = st.sampled_from((*SHIPPED_ILLUMINANTS, "FL2"))
    else:
        x, y = st.floats(0.0, 0.5), st.floats(1e-6, 0.5)
        made = st.tuples(x, y)
        if f.name == "primaries_xy":
            made = st.tuples(made, made, made)
        made = made | st.just(f.default)
    return made | st.none() if meta.get("optional") else made


def parts(kind, **fixed):
    """A strategy for a frozen dataclass; combinations that it refuses are left out."""
    named = {f.name: values(f) for f in dataclasses.fields(kind)} | fixed

    def make(entries):
        try:
            return kind(**entries)
        except InputError:
            return None

    return st.fixed_dictionaries(named).map(make).filter(lambda part: part is not None)


looks = st.one_of(parts(Look, c=st.none()), parts(Look, c_fraction=st.none()))


def write_materials(folder: Path) -> tuple[Sample, ...]:
    """Samples in files of difficult names under a folder, some with the table they came from."""
    made = []
    for k, name in enumerate(NAMES):
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        save_material(materials.paper(list(materials.PAPERS)[k % 4]), file)
        table = str(folder / f"{name}.csv") if k % 2 else None
        made.append(Sample(load_material(file), file=str(file), table=table))
    return tuple(made)


def write_lamps(folder: Path) -> tuple[str, ...]:
    """Lamp files of difficult names under a folder, one named as a lamp is."""
    names = ("lamp.csv", "FL2", "None", "5", "my lamp's\nspectrum.txt", "'a'", "-x.csv")
    for name in names:
        (folder / name).write_bytes(asset("spectra", "D65.csv").read_bytes())
    return tuple(str(folder / name) for name in names)


def states(samples=(), lamps=()):
    """A strategy for whole states, on built-in samples and those given."""
    choices = [Sample.built_in(name) for name in SAMPLES] + list(samples)
    choices += [choices[1].in_colour(Colour((50.5, 60.0, 1 / 3)))]
    if samples:
        choices += [samples[-1].in_colour(Colour((60.0, -10.0, 20.0), *lamps[-3:-2]))]
    side = st.builds(Side, st.sampled_from(choices), looks)
    lamp_names = st.sampled_from((*SHIPPED_ILLUMINANTS, "FL2", *lamps))
    return st.builds(
        State,
        side,
        side,
        st.builds(
            Setup, parts(Shape), parts(Lamp, illuminant=lamp_names), parts(Eye), parts(Display)
        ),
        parts(Presentation),
    )
