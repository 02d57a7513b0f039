"""Files of artwork for tests: TIFF and PSD of any layout, deep PNG, PDF with spot colours."""

from __future__ import annotations

import struct
import zlib

import numpy as np


def packbits(data):
    parts = [data[k : k + 128] for k in range(0, len(data), 128)]
    return b"".join(bytes([len(part) - 1]) + part for part in parts)


def deep_png(values, colour_type):
    """A PNG of 16 bits; values (H, W, channels)."""
    height, width, _ = values.shape
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in values)
    head = struct.pack(">IIBBBBB", width, height, 16, colour_type, 0, 0, 0)
    return png(head, (b"IDAT", zlib.compress(rows)))


def png(head, *chunks):
    parts = [(b"IHDR", head), *chunks, (b"IEND", b"")]
    made = (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in parts
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(made)


def tiff(values, order="<", *, kind=2, compression=1, rows=7, tile=None, planar=1, predictor=1,
         extra=(), tags=()):  # fmt: skip
    """A TIFF of values (H, W, channels), uint8 or uint16; kind: photometric interpretation."""
    height, width, count = values.shape
    size = values.dtype.itemsize
    planes = [values[..., k : k + 1] for k in range(count)] if planar == 2 else [values]
    parts = []
    for plane in planes:
        if tile is None:
            parts += [plane[y : y + rows] for y in range(0, height, rows)]
            continue
        for y in range(0, height, tile):
            for x in range(0, width, tile):
                whole = np.zeros((tile, tile, plane.shape[2]), plane.dtype)
                inside = plane[y : y + tile, x : x + tile]
                whole[: inside.shape[0], : inside.shape[1]] = inside
                parts.append(whole)
    data, offsets, lengths = b"", [], []
    for part in parts:
        if predictor == 2:
            part = np.concatenate([part[:, :1], np.diff(part, axis=1)], axis=1)
        lines = [row.astype(f"{order}u{size}").tobytes() for row in part]
        packed = b"".join(map(packbits, lines) if compression == 32773 else lines)
        packed = zlib.compress(packed) if compression == 8 else packed
        offsets.append(8 + len(data))
        lengths.append(len(packed))
        data += packed + bytes(len(packed) % 2)
    entries = [(256, 4, [width]), (257, 4, [height]), (258, 3, [8 * size] * count),
               (259, 3, [compression]), (262, 3, [kind]), (277, 3, [count]), (284, 3, [planar]),
               (317, 3, [predictor]), *tags]  # fmt: skip
    entries += [(338, 3, list(extra))] if extra else []
    if tile is None:
        entries += [(273, 4, offsets), (278, 4, [rows]), (279, 4, lengths)]
    else:
        entries += [(322, 4, [tile]), (323, 4, [tile]), (324, 4, offsets), (325, 4, lengths)]
    start = 8 + len(data)
    after = start + 2 + 12 * len(entries) + 4
    table, rest = struct.pack(order + "H", len(entries)), b""
    for number, form, value in sorted(entries):
        packed = bytes(value) if form == 7 else struct.pack(
            f"{order}{len(value)}{'H' if form == 3 else 'I'}", *value
        )  # fmt: skip
        table += struct.pack(order + "HHI", number, form, len(value))
        if len(packed) <= 4:
            table += packed.ljust(4, b"\0")
        else:
            table += struct.pack(order + "I", after + len(rest))
            rest += packed + bytes(len(packed) % 2)
    mark = b"II*\0" if order == "<" else b"MM\0*"
    return mark + struct.pack(order + "I", start) + data + table + bytes(4) + rest


def resource(number, data):
    """An image resource of Photoshop."""
    return b"8BIM" + struct.pack(">HHI", number, 0, len(data)) + data + bytes(len(data) % 2)


def psd(values, mode, *, packed=True, kinds=(), names=b"", version=1):
    """A PSD of values (H, W, channels) and 200 dpi; names: of its resource 1006."""
    height, width, count = values.shape
    size = values.dtype.itemsize
    resources = resource(1006, names) if names else b""
    if kinds:
        each = b"".join(bytes(12) + bytes([kind]) for kind in kinds)
        resources += resource(1077, struct.pack(">I", 1) + each)
    resources += resource(1005, struct.pack(">IHHIHH", 200 << 16, 1, 1, 200 << 16, 1, 1))
    rows = [
        values[y, :, c].astype(f">u{size}").tobytes() for c in range(count) for y in range(height)
    ]
    if packed:
        rows = [packbits(row) for row in rows]
        form = ">H" if version == 1 else ">I"
        body = b"\0\1" + b"".join(struct.pack(form, len(row)) for row in rows)
    else:
        body = b"\0\0"
    head = struct.pack(">H6xHIIHH", version, count, height, width, 8 * size, mode)
    sections = struct.pack(">II", 0, len(resources)) + resources
    layers = bytes(4 if version == 1 else 8)
    return b"8BPS" + head + sections + layers + body + b"".join(rows)


def pdf(path, content, spots, *, profile=None, size=(200, 100), change=None):
    """A PDF page. spots: names and CMYK alternates by resource; change(pdf, page) comes last.

    ExtGState /OV overprints, /NO knocks out.
    """
    import pikepdf
    from pikepdf import Array, Dictionary, Name

    made = pikepdf.Pdf.new()
    made.add_blank_page(page_size=size)
    page = made.pages[0]
    spaces = Dictionary()
    for key, (name, cmyk) in spots.items():
        tint = Dictionary(FunctionType=2, Domain=[0, 1], C0=[0, 0, 0, 0], C1=list(cmyk), N=1)
        space = Array([Name.Separation, Name("/" + name), Name.DeviceCMYK, tint])
        spaces["/" + key] = made.make_indirect(space)
    states = Dictionary(OV=Dictionary(OP=True, op=True, OPM=1), NO=Dictionary(OP=False, op=False))
    page.obj["/Resources"] = Dictionary(ColorSpace=spaces, ExtGState=states)
    page.obj["/Contents"] = made.make_stream(content)
    if profile is not None:
        stream = made.make_stream(profile)
        stream["/N"] = 4
        intent = Dictionary(Type=Name.OutputIntent, S=Name("/GTS_PDFX"), DestOutputProfile=stream)
        intent["/OutputConditionIdentifier"] = "FOGRA39"
        made.Root["/OutputIntents"] = Array([intent])
    if change is not None:
        change(made, page)
    made.save(path)
