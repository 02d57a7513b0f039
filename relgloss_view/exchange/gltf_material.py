"""One material of a glTF file, checked: its factors, the means of its textures, what is left."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.exchange.gltf_brdf import COAT, IOR, SPECULAR, Colour, GltfSurface
from relgloss_view.exchange.picture_mean import picture_mean
from relgloss_view.material.cielab import srgb_decoded
from relgloss_view.pack.forms.gltf_document import Document

EXTENSIONS = (SPECULAR, IOR, COAT)  #: that the surface holds
GLOSSINESS, UNLIT = "KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit"
MOST_LINES = 40
#: What other extensions state, for people.
_WORDS = {
    "KHR_materials_transmission": "light that passes through (KHR_materials_transmission)",
    "KHR_materials_diffuse_transmission": (
        "diffuse light that passes through (KHR_materials_diffuse_transmission)"
    ),
    "KHR_materials_volume": "the inside of the body (KHR_materials_volume)",
    "KHR_materials_sheen": "the sheen of cloth (KHR_materials_sheen)",
    "KHR_materials_anisotropy": "brushed facets (KHR_materials_anisotropy)",
    "KHR_materials_iridescence": "thin films (KHR_materials_iridescence)",
    "KHR_materials_dispersion": "dispersion (KHR_materials_dispersion)",
    "KHR_materials_emissive_strength": "the strength of its own light",
}
_SRGB = "sRGB"
#: By name, the factors of which an extension does nothing where all are 0, as they are by default.
_NOTHING = {
    "KHR_materials_transmission": ("transmissionFactor",),
    "KHR_materials_diffuse_transmission": ("diffuseTransmissionFactor",),
    "KHR_materials_volume": ("thicknessFactor",),
    "KHR_materials_sheen": ("sheenColorFactor",),
    "KHR_materials_anisotropy": ("anisotropyStrength",),
    "KHR_materials_iridescence": ("iridescenceFactor",),
    "KHR_materials_dispersion": ("dispersion",),
}
THROUGH = ("KHR_materials_transmission", "KHR_materials_diffuse_transmission")
WEBP, TRANSFORM = "EXT_texture_webp", "KHR_texture_transform"
#: Pictures that a gloss meter sees.
_OF_GLOSS = (
    *("roughness and metallic", "specular", "specular and glossiness"),
    *("clear coat", "clear coat's roughness"),
)


class GltfMaterial:
    """A material's entry. `lines` names what is not carried, after `surface` was asked for."""

    def __init__(self, document: Document, entry: dict[str, Any]) -> None:
        self._document, self._entry = document, entry
        self._extensions = _part(entry, "extensions")
        self.lines: list[str] = []

    def surface(self) -> GltfSurface:
        """The surface. Raises InputError where a factor is none, or a texture can't be read."""
        if GLOSSINESS in self._extensions:
            surface = self._glossiness(_part(self._extensions, GLOSSINESS))
        else:
            surface = self._metallic(_part(self._entry, "pbrMetallicRoughness"))
        if UNLIT in self._extensions:
            surface = GltfSurface(surface.base_color, 0.0, 1.0, specular=0.0)
            self.lines.append(
                "that no lamp lights it (KHR_materials_unlit): its colour is that of a matt surface"
            )
        self._name_rest()
        return surface

    def _metallic(self, core: dict[str, Any]) -> GltfSurface:
        base = self._colour(core, "baseColorFactor", 4)
        base = base * self._mean(core, "baseColorTexture", "base colour", _SRGB)[:3]
        rough = self._mean(core, "metallicRoughnessTexture", "roughness and metallic", "")
        specular, ior = _part(self._extensions, SPECULAR), _part(self._extensions, IOR)
        coat = _part(self._extensions, COAT)
        tint = self._colour(specular, "specularColorFactor", 3, most=1e3)
        tint = tint * self._mean(specular, "specularColorTexture", "specular colour", _SRGB)[:3]
        weight = _number(specular, "specularFactor", 1.0, 0.0, 1.0)
        clearcoat = _number(coat, "clearcoatFactor", 0.0, 0.0, 1.0)
        clear_rough = _number(coat, "clearcoatRoughnessFactor", 0.0, 0.0, 1.0)
        if "clearcoatNormalTexture" in coat:
            self.lines.append("the relief of the clear coat (clearcoatNormalTexture)")
        index = _number(ior, "ior", 1.5, 0.0, 100.0)
        if index < 1.0:
            # 0 stands for a reflection of 1 (KHR_materials_ior): as an index, a very large one.
            index = 1e4
        return GltfSurface(
            _as_colour(base),
            _number(core, "metallicFactor", 1.0, 0.0, 1.0) * float(rough[2]),
            _number(core, "roughnessFactor", 1.0, 0.0, 1.0) * float(rough[1]),
            index,
            weight * float(self._mean(specular, "specularTexture", "specular", "")[3]),
            _as_colour(tint),
            clearcoat * float(self._mean(coat, "clearcoatTexture", "clear coat", "")[0]),
            clear_rough
            * float(self._mean(coat, "clearcoatRoughnessTexture", "clear coat's roughness", "")[1]),
        )

    def _glossiness(self, core: dict[str, Any]) -> GltfSurface:
        """The older words for the same: a diffuse colour, F0, and glossiness."""
        diffuse = self._colour(core, "diffuseFactor", 4)
        diffuse = diffuse * self._mean(core, "diffuseTexture", "diffuse colour", _SRGB)[:3]
        picture = self._mean(core, "specularGlossinessTexture", "specular and glossiness", _SRGB)
        f0 = self._colour(core, "specularFactor", 3) * picture[:3]
        gloss = _number(core, "glossinessFactor", 1.0, 0.0, 1.0) * float(picture[3])
        return GltfSurface(_as_colour(diffuse), 0.0, 1.0 - gloss, 1.5, 1.0, _as_colour(f0 / 0.04))

    def _name_rest(self) -> None:
        entry = self._entry
        for name in self._extensions:
            if name in (*EXTENSIONS, GLOSSINESS, UNLIT) or len(self.lines) > MOST_LINES:
                continue
            if self._does_nothing(name):
                continue
            self.lines.append(_WORDS.get(name, f"the extension {printable(name, 60)}"))
        if any(self._colour(entry, "emissiveFactor", 3, default=0.0)):
            self.lines.append("its own light (emissiveFactor)")
        if "normalTexture" in entry:
            self.lines.append("the relief of its surface (normalTexture)")
        if "occlusionTexture" in entry:
            self.lines.append("shadows that are painted on it (occlusionTexture)")
        if entry.get("alphaMode", "OPAQUE") != "OPAQUE":
            self.lines.append("that it lets light through by its alpha (alphaMode)")

    def _does_nothing(self, name: str) -> bool:
        """Whether the factors of an extension leave the surface as it is without."""
        if name == "KHR_materials_emissive_strength":
            return not any(self._colour(self._entry, "emissiveFactor", 3, default=0.0))
        part = _part(self._extensions, name)
        return name in _NOTHING and all(
            part.get(key, 0.0) in (0, [0, 0, 0]) for key in _NOTHING[name]
        )

    def seen_through(self, surface: GltfSurface) -> GltfSurface:
        """The surface with the body that is left where light passes through, as before black."""
        share = 1.0
        for name in THROUGH:
            part = _part(self._extensions, name)
            share *= 1.0 - _number(part, _NOTHING[name][0], 0.0, 0.0, 1.0)
        if share == 1.0 or surface.metallic > 0.5:
            return surface
        return dataclasses.replace(
            surface, base_color=_as_colour(share * np.asarray(surface.base_color))
        )

    def _colour(
        self,
        holder: dict[str, Any],
        key: str,
        count: int,
        *,
        most: float = 1.0,
        default: float = 1.0,
    ) -> Array:
        """The first three of a list of numbers."""
        if key not in holder:
            return np.full(3, default)
        values = self._document.numbers(holder, key, count)
        if values.min() < 0.0 or values.max() > most:
            raise InputError(f"{key}: expected numbers from 0 to {most:g}; export it again")
        return np.asarray(values[:3])

    def _mean(self, holder: dict[str, Any], key: str, words: str, space: str) -> Array:
        """The mean (4,) of a texture's channels, linear in light; ones where there is none."""
        if key not in holder:
            return np.ones(4)
        use = _part(holder, key)
        texture = self._document.entry("textures", use.get("index"))
        source = texture.get("source", _part(_part(texture, "extensions"), WEBP).get("source"))
        if source is None:
            guess = ", so that the gloss is a guess" if words in _OF_GLOSS else ""
            self.lines.append(
                f"the picture of the {words}, which is of a kind that is not read: its factor "
                f"counts alone{guess}"
            )
            return np.ones(4)
        curve = srgb_decoded if space == _SRGB else None
        mean = picture_mean(self._document.picture(source), curve)
        cut = " (KHR_texture_transform may show a part of it)" if _shows_part(use) else ""
        self.lines.append(f"the picture of the {words}: its mean stands for it{cut}")
        return mean


def _part(holder: dict[str, Any], key: str) -> dict[str, Any]:
    value = holder.get(key, {})
    if not isinstance(value, dict):
        raise InputError(f"{key}: expected an object; export it again")
    return value


def _number(holder: dict[str, Any], key: str, default: float, low: float, high: float) -> float:
    value = holder.get(key, default)
    usable = isinstance(value, int | float) and not isinstance(value, bool)
    if not usable or not low <= value <= high:
        raise InputError(
            f"{key}: expected a number from {low:g} to {high:g}, found {printable(value, 20)}"
        )
    return float(value)


def _as_colour(values: Array) -> Colour:
    red, green, blue = (float(v) for v in values)
    return red, green, blue


def _shows_part(use: dict[str, Any]) -> bool:
    transform = _part(_part(use, "extensions"), TRANSFORM)
    scale = transform.get("scale", [1.0, 1.0])
    return isinstance(scale, list) and any(
        isinstance(v, int | float) and abs(v) < 1.0 for v in scale
    )
