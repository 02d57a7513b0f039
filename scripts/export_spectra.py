"""Write the observer, the usual lamps and the spectra of sRGB into assets, from colour-science.

They are shipped as files because importing colour-science takes longer than drawing a picture.
Run: python scripts/export_spectra.py
"""

from __future__ import annotations

from pathlib import Path

import colour

LAMPS = {
    "HP5": "CIE high-pressure lamp HP5, a metal halide",
    "D65": "CIE standard illuminant D65, daylight",
    "D50": "CIE illuminant D50, daylight",
    "A": "CIE standard illuminant A, tungsten",
    "C": "CIE illuminant C, the daylight of gloss meters",
}
FOLDER = Path(__file__).resolve().parent.parent / "assets" / "spectra"


def main() -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    origin = f"from the tables of colour-science {colour.__version__}"
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    lines = [f"# CIE 1931 2 degree standard observer, 1 nm (CIE 15), {origin}"]
    lines.append("wavelength_nm,x,y,z")
    for wavelength, (x, y, z) in zip(observer.wavelengths, observer.values, strict=True):
        lines.append(f"{wavelength:g},{x:.12g},{y:.12g},{z:.12g}")
    (FOLDER / "cie1931_2deg.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for name, note in LAMPS.items():
        lamp = colour.SDS_ILLUMINANTS[name]
        lines = [f"# {note}, 5 nm (CIE 15), {origin}"]
        lines.append("wavelength_nm,relative_power")
        for wavelength, power in zip(lamp.wavelengths, lamp.values, strict=True):
            lines.append(f"{wavelength:g},{power:.12g}")
        (FOLDER / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    basis = colour.recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    lines = [
        "# Reflectances of red, green and blue of linear sRGB, 5 nm (Mallett, Yuksel 2019), "
        f"{origin}",
        "# (Copyright 2013 Colour Developers, BSD-3-Clause)",
        "wavelength_nm,red,green,blue",
    ]
    for wavelength, values in zip(basis.wavelengths, basis.values, strict=True):
        lines.append(",".join(f"{value:.12g}" for value in (wavelength, *values)))
    (FOLDER / "mallett2019.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
