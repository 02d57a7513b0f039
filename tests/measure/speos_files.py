"""Speos files for tests: the first block of a file that Ansys publishes, and made ones.

The readings are those of `test_13_planesymmetric_brdf_speos_reference.anisotropicbsdf` in
github.com/ansys/optical-automation (MIT licence), incidence 15 degrees, every third azimuth, to six
decimals. Ansys' converter made it of a measurement in Zemax' format, whose own numbers are ZEMAX.
"""

from __future__ import annotations

PHI = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0)
BLOCK = {
    0: (0.179442,) * 7,
    5: (0.190801, 0.189551, 0.185417, 0.179537, 0.174150, 0.170309, 0.168440),
    10: (0.200570, 0.197770, 0.188212, 0.176241, 0.166824, 0.162561, 0.159158),
    15: (0.206899, 0.201195, 0.186075, 0.171082, 0.159136, 0.153838, 0.149876),
    20: (0.207905, 0.200352, 0.182577, 0.164864, 0.151226, 0.144246, 0.140464),
    25: (0.203361, 0.194597, 0.175449, 0.157887, 0.144026, 0.135084, 0.131052),
    30: (0.198071, 0.187305, 0.167830, 0.150261, 0.136452, 0.128548, 0.125389),
    35: (0.189471, 0.179056, 0.160197, 0.143514, 0.130892, 0.123086, 0.119726),
    40: (0.182363, 0.170869, 0.153811, 0.138023, 0.125769, 0.119105, 0.116058),
    45: (0.175256, 0.163881, 0.147069, 0.133542, 0.122553, 0.115670, 0.112391),
    50: (0.168391, 0.157436, 0.142324, 0.129533, 0.119808, 0.112957, 0.109811),
    55: (0.161527, 0.152283, 0.137934, 0.126419, 0.117401, 0.110597, 0.107230),
    60: (0.157503, 0.148527, 0.135121, 0.123695, 0.115143, 0.108941, 0.105851),
    65: (0.153479, 0.145376, 0.132810, 0.122217, 0.114122, 0.107711, 0.104472),
    70: (0.152197, 0.142863, 0.131247, 0.116782, 0.114172, 0.0, 0.0),
    75: (0.150915, 0.142650, 0.130445, 0.097311, 0.0, 0.0, 0.0),
    80: (0.075457, 0.144944, 0.093623, 0.0, 0.0, 0.0, 0.0),
    85: (0.0, 0.115352, 0.030246, 0.0, 0.0, 0.0, 0.0),
    90: (0.0, 0.042978, 0.0, 0.0, 0.0, 0.0, 0.0),
}
#: BRDF of the measurement itself, 1/sr: by polar angle at the side of the mirror direction (0) and
#: of the lamp (180), of `test_13_planesymmetric_btdf_zemax.bsdf` there.
ZEMAX = {
    (0, 0): 5.529e-2,
    (5, 0): 5.879e-2,
    (10, 0): 6.180e-2,
    (15, 0): 6.375e-2,
    (20, 0): 6.406e-2,
    (25, 0): 6.266e-2,
    (35, 0): 5.838e-2,
    (45, 0): 5.400e-2,
    (55, 0): 4.977e-2,
    (65, 0): 4.729e-2,
    (5, 180): 5.190e-2,
    (15, 180): 4.618e-2,
    (25, 180): 4.038e-2,
    (45, 180): 3.463e-2,
    (55, 180): 3.304e-2,
}


def block(phi, rows):
    """A block of readings; rows: by polar angle."""
    lines = [f"{len(rows)} {len(phi)}", "\t" + "\t".join(map(str, phi))]
    lines += ["\t".join(map(str, (theta, *values))) for theta, values in rows.items()]
    return "\n".join(lines) + "\n"


def published(spectrum=((350, 13.4506), (850, 13.4506)), flags="1\t0", kind=1):
    """The published file with its first incidence alone, whose azimuths reach over a turn."""
    phi = [*PHI, *(360.0 - p for p in PHI[-2::-1])]
    rows = {theta: [*values, *values[-2::-1]] for theta, values in BLOCK.items()}
    head = "OPTIS - Anisotropic BSDF surface file v7.0\n0\nComment\n23\nMeasurement description\n"
    head += f"0\t1\t0\n{flags}\n{kind}\n1\n0.0\t\n1\n15.0\t\n15.0\t0\n\n{len(spectrum)}\n"
    head += "".join(f"{nm}\t{percent}\n" for nm, percent in spectrum)
    return head + block(phi, rows) + "End of file\n"


def lambert(percents=(20.0, 40.0), nm=(500, 600), incidences=(10, 40), kind=1):
    """A .brdf of a matt surface, whose readings have another factor in each block."""
    text = "OPTIS - brdf surface file v8.0\n0\nmade\n5\n-----\n1\t0\n"
    text += f"{kind}\n{len(incidences)}\t{len(nm)}\n"
    text += " ".join(map(str, incidences)) + "\n" + "\t".join(map(str, nm)) + "\n"
    for k in range(len(incidences)):
        for band, percent in enumerate(percents):
            rows = dict.fromkeys(range(0, 91, 2), (k + 2.0 + band,) * 5)
            text += f"{percent}\n" + block((0, 90, 180, 270, 360), rows)
    return text
