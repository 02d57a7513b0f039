"""Readings of a dark ink that scatter about zero: the fit takes them as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sampled

from relgloss_view import fit_material
from relgloss_view.measure.readers import read_measurement

NM = (450.0, 475.0, 500.0, 525.0, 600.0, 650.0)
DARK, LEVEL, NOISE = 4, 0.004, 0.004
BODY = np.array([LEVEL] * DARK + [0.3, 0.25])


def readings(seed):
    """Angles (N, 4) and radiance factors (N, B) with additive noise as large as the dark level."""
    angles = sampled.rings()
    values = sampled.factors(*sampled.directions(angles), strength=0.5, body=BODY)
    return angles, values + NOISE * np.random.default_rng(seed).standard_normal(values.shape)


def dark_albedo(path, angles, values):
    """What the fit finds for the dark bands, relative to the truth."""
    lines = ["# quantity: radiance-factor", "# aperture_sd_deg: 0.3"]
    lines.append(",".join(["theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg", *map(str, NM)]))
    lines += [",".join(f"{x:.9g}" for x in (*a, *v)) for a, v in zip(angles, values, strict=True)]
    path.write_text("\n".join(lines))
    measurement = read_measurement(path)
    assert measurement.kept.all()
    return np.array(fit_material(measurement, model="lobe").diffuse.albedo[:DARK]) / LEVEL


def test_a_dark_body_is_not_biased_by_noise_below_zero(tmp_path):
    # The mean of four bands of 500 readings has a standard error of about 3 %.
    angles, values = readings(seed=1)
    kept = dark_albedo(tmp_path / "t.csv", angles, values)
    assert abs(np.mean(kept) - 1.0) < 0.08
    # The negative control: without what lies below zero the mean of the others is 1.288 times the
    # level, phi(1) / Phi(1) above it for noise as large as the level.
    dropped = dark_albedo(tmp_path / "t.csv", angles, np.maximum(values, 0.0))
    assert np.mean(dropped) > 1.15


@pytest.mark.slow
def test_nor_over_many_tables(tmp_path):
    many = {"kept": [], "clipped": [], "dropped": []}
    for seed in range(8):
        angles, values = readings(seed)
        many["kept"].append(dark_albedo(tmp_path / "t.csv", angles, values))
        clipped = np.maximum(values, 1e-9)
        many["clipped"].append(dark_albedo(tmp_path / "t.csv", angles, clipped))
        dropped = np.maximum(values, 0.0)
        many["dropped"].append(dark_albedo(tmp_path / "t.csv", angles, dropped))
    ratios = {name: float(np.mean(all_of)) for name, all_of in many.items()}
    print(ratios)
    assert abs(ratios["kept"] - 1.0) < 0.03
    # Phi(1) + phi(1) = 1.083 where noise is cut off at zero.
    assert ratios["clipped"] > 1.05
    assert ratios["dropped"] > 1.2


def test_values_below_zero_weigh_in_the_fit():
    from relgloss_view.fitting.observations import prepare

    angles, values = readings(seed=1)
    measurement = sampled.measured(angles, np.abs(values), bands=NM)
    some = prepare(replace(measurement, radiance_factor=values))
    assert np.min(some.value) < 0.0
    assert np.all(some.weight > 0.0)
    # The logarithm exists wherever noise goes, with room to spare.
    assert np.all(some.value + some.floor > 0.5 * some.floor)
