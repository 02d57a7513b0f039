"""Keys: who signed a proof (Ed25519, RFC 8032), and whom this reader knows.

A private key is a PEM file of PKCS #8 that its owner alone can read; the public one lies beside it,
to be given away. A signature shows that the owner of a key has signed. Who that is, is the
reader's own knowledge: a table in the user's settings, never the proof itself.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import read_json
from relgloss_view.base.reading import named, printable, read_bytes, text
from relgloss_view.base.writing import fresh_file, make_folder, together, whole_file
from relgloss_view.proof.proof import Proof, Signature

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

PRIVATE = "a private key (PEM, from `relgloss proof key -o FILE`)"
PUBLIC = "a public key (FILE.pub, from `relgloss proof key -o FILE`)"
KNOWN = "the table of known keys"
SUFFIX = ".pub"
MAX_KEY_BYTES, MAX_KNOWN_BYTES = 10_000, 1_000_000
FILE = "proof-keys.json"  #: in the user's settings
MOST_NAME = 80  #: characters of a key owner's name
_KEY = re.compile(r"[0-9a-f]{64}")
GROUP, GROUPS = 4, 8  #: digits of a fingerprint's group, and groups


@dataclass(frozen=True)
class Signed:
    """A signature that was checked.

    message: index of the last message that it covers. key: hexadecimal. name: of its owner, as this
    reader knows it, '' of an unknown key. is_right: whether the owner of the key has signed this.
    """

    message: int
    key: str
    name: str
    is_right: bool

    @property
    def words(self) -> str:
        """One clause for people, which never calls an unknown key valid."""
        if not self.is_right:
            return f"wrong signature: {fingerprint(self.key)} has not signed this"
        if self.name:
            return f"signed by {printable(self.name, MOST_NAME)} ({fingerprint(self.key)})"
        return f"signed by an unknown key {fingerprint(self.key)}"


def make_key(path: str | os.PathLike[str]) -> str:
    """Write a new private key, and its public key beside it; returns the public one, hexadecimal.

    The public key's name is the private one's with .pub behind it. Raises InputError where one of
    the two exists already.
    """
    from cryptography.hazmat.primitives import serialization as form
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    key = Ed25519PrivateKey.generate()
    private = key.private_bytes(form.Encoding.PEM, form.PrivateFormat.PKCS8, form.NoEncryption())
    public = key.public_key().public_bytes(
        form.Encoding.PEM, form.PublicFormat.SubjectPublicKeyInfo
    )
    with (
        together(),
        fresh_file(path, private=True) as own,
        fresh_file(f"{os.fspath(path)}{SUFFIX}") as given,
    ):
        own.write_bytes(private)
        given.write_bytes(public)
    return public_of(key)


def read_private(path: str | os.PathLike[str]) -> Ed25519PrivateKey:
    """The private key of a file. Raises InputError."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    data = read_bytes(path, MAX_KEY_BYTES, PRIVATE)
    try:
        key = load_pem_private_key(data, password=None)
    except TypeError:
        raise InputError(
            f"{named(path)}: this key has a password; give {PRIVATE}, which has none"
        ) from None
    except Exception:  # the library's own kinds: ValueError, UnsupportedAlgorithm
        key = None
    if not isinstance(key, Ed25519PrivateKey):
        raise InputError(f"{named(path)}: not a private Ed25519 key; give {PRIVATE}")
    return key


def read_public(path: str | os.PathLike[str]) -> str:
    """The public key of a file, hexadecimal. Raises InputError."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import load_pem_public_key

    data = read_bytes(path, MAX_KEY_BYTES, PUBLIC)
    if b"PRIVATE KEY" in data:
        raise InputError(f"{named(path)}: this is a private key, for its owner; give {PUBLIC}")
    try:
        key: object = load_pem_public_key(data)
    except Exception:
        key = None
    if not isinstance(key, Ed25519PublicKey):
        raise InputError(f"{named(path)}: not a public Ed25519 key; give {PUBLIC}")
    return key.public_bytes_raw().hex()


def public_of(key: Ed25519PrivateKey) -> str:
    """The public key of a private one, hexadecimal."""
    return key.public_key().public_bytes_raw().hex()


def fingerprint(key: str) -> str:
    """A public key's fingerprint, 128 bits of its SHA-256, in groups to be read over a telephone.

    >>> fingerprint("00" * 32)
    '6668 7AAD F862 BD77 6C8F C18B 8E9F 8E20'
    """
    digits = hashlib.sha256(bytes.fromhex(key)).hexdigest().upper()
    return " ".join(digits[k * GROUP : (k + 1) * GROUP] for k in range(GROUPS))


def signed(proof: Proof, key: Ed25519PrivateKey) -> Proof:
    """The proof with a signature of all that it holds, up to its newest message."""
    made = Signature(
        len(proof.messages) - 1, public_of(key), key.sign(bytes.fromhex(proof.digest)).hex()
    )
    others = tuple(s for s in proof.signatures if (s.message, s.key) != (made.message, made.key))
    return dataclasses.replace(proof, signatures=(*others, made))


def checked(proof: Proof, known: Mapping[str, str]) -> tuple[Signed, ...]:
    """The signatures of a proof, each checked. known: names by public key."""
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    found = []
    for signature in proof.signatures:
        try:
            Ed25519PublicKey.from_public_bytes(bytes.fromhex(signature.key)).verify(
                bytes.fromhex(signature.signature),
                bytes.fromhex(proof.digests[signature.message]),
            )
            is_right = True
        except (InvalidSignature, ValueError):
            is_right = False
        name = known.get(signature.key, "")
        found.append(Signed(signature.message, signature.key, name, is_right))
    return tuple(found)


def known_keys(folder: Path) -> dict[str, str]:
    """Names of the keys that the reader knows, by public key. folder: of the user's settings.

    Raises InputError where the table is damaged.
    """
    path = folder / FILE
    if not path.exists():
        return {}
    try:
        table: Any = read_json(path, MAX_KNOWN_BYTES, KNOWN)
    except InputError as error:
        raise InputError(f"{error}; remove the file, and add the keys again") from error
    keys = table.get("keys") if isinstance(table, dict) else None
    if not isinstance(keys, dict) or not all(
        _KEY.fullmatch(key) and isinstance(name, str) for key, name in keys.items()
    ):
        raise InputError(f"{named(path)}: not {KNOWN}; remove the file, and add the keys again")
    return dict(keys)


def trust(folder: Path, key: str, name: str) -> None:
    """Add a key to those that the reader knows, or rename it.

    Raises InputError where the name is empty, too long or another key's.
    """
    keys = known_keys(folder)
    if not text(name, "--name").strip() or len(name) > MOST_NAME:
        raise InputError(f"--name: expected 1 to {MOST_NAME} characters, the key's owner")
    for other, other_name in keys.items():
        if other != key and _alike(other_name) == _alike(name):
            raise InputError(
                f"--name {printable(name)}: another key, {fingerprint(other)}, has this name or "
                "one like it; "
                "forget that key first, or choose another name"
            )
    _write(folder, {**keys, key: name.strip()})


def _alike(name: str) -> str:
    """The same for names that people take for one: other spaces, cases, forms of a letter."""
    return " ".join(unicodedata.normalize("NFKC", name).casefold().split())


def forget(folder: Path, name: str) -> str:
    """Remove the key of a name from those that the reader knows; returns the key."""
    keys = known_keys(folder)
    found = [key for key, owner in keys.items() if owner == name]
    if not found:
        raise InputError(f"--forget {printable(name)}: no known key has this name")
    _write(folder, {key: owner for key, owner in keys.items() if key not in found})
    return found[0]


def _write(folder: Path, keys: Mapping[str, str]) -> None:
    make_folder(folder)
    content = {"format": "relgloss-keys", "version": 1, "keys": dict(keys)}
    with whole_file(folder / FILE, private=True) as temporary:
        temporary.write_text(json.dumps(content, indent=1), encoding="utf-8")
