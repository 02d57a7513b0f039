"""Keys and signatures: made, kept apart, checked by Python and by a browser."""

from __future__ import annotations

import json
import stat
import subprocess

import proof_samples as samples
import pytest
from browsers import before_pages, call, open_page

from relgloss_view.base.errors import InputError
from relgloss_view.proof import keys
from relgloss_view.proof.page.parts import Page
from relgloss_view.proof.proof import Message, Proof, Signature
from relgloss_view.proof.read import proof_of


@pytest.fixture
def own(tmp_path):
    keys.make_key(tmp_path / "own.key")
    return tmp_path / "own.key"


def test_key_files(own):
    assert stat.S_IMODE(own.stat().st_mode) == 0o600
    public = keys.read_public(f"{own}.pub")
    assert keys.public_of(keys.read_private(own)) == public
    assert b"BEGIN PRIVATE KEY" in own.read_bytes()
    before = own.read_bytes()
    with pytest.raises(InputError, match=r"own\.key"):
        keys.make_key(own)
    assert own.read_bytes() == before


def test_one_file_that_exists_leaves_the_other_unwritten(tmp_path):
    (tmp_path / "a.key.pub").write_text("mine")
    with pytest.raises(InputError):
        keys.make_key(tmp_path / "a.key")
    assert [p.name for p in tmp_path.iterdir()] == ["a.key.pub"]


def test_openssl_reads_them_and_agrees(own, tmp_path):
    """A program that nobody here wrote verifies what was signed."""
    proof = keys.signed(samples.thread(1), keys.read_private(own))
    (tmp_path / "digest").write_bytes(bytes.fromhex(proof.digest))
    (tmp_path / "signature").write_bytes(bytes.fromhex(proof.signatures[0].signature))
    words = ["openssl", "pkeyutl", "-verify", "-pubin", "-inkey", f"{own}.pub", "-rawin"]
    words += ["-in", str(tmp_path / "digest"), "-sigfile", str(tmp_path / "signature")]
    done = subprocess.run(words, capture_output=True, text=True)
    assert "Verified Successfully" in done.stdout, done.stderr
    (tmp_path / "digest").write_bytes(bytes(32))
    assert subprocess.run(words, capture_output=True).returncode != 0


@pytest.mark.parametrize("data", [b"", b"x", bytes(2000), b"-----BEGIN PRIVATE KEY-----\nAAAA\n"])
def test_files_that_are_no_keys(tmp_path, data):
    (tmp_path / "k").write_bytes(data)
    for read in (keys.read_private, keys.read_public):
        with pytest.raises(InputError, match="k: "):
            read(tmp_path / "k")


def test_keys_of_another_kind(tmp_path, own):
    from cryptography.hazmat.primitives import serialization as form
    from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey

    other = X25519PrivateKey.generate()
    plain, pem = form.NoEncryption(), form.Encoding.PEM
    (tmp_path / "x").write_bytes(other.private_bytes(pem, form.PrivateFormat.PKCS8, plain))
    with pytest.raises(InputError, match="not a private Ed25519"):
        keys.read_private(tmp_path / "x")
    locked = form.BestAvailableEncryption(b"p")
    data = keys.read_private(own).private_bytes(pem, form.PrivateFormat.PKCS8, locked)
    (tmp_path / "x").write_bytes(data)
    with pytest.raises(InputError, match="password"):
        keys.read_private(tmp_path / "x")
    with pytest.raises(InputError, match="this is a private key"):
        keys.read_public(own)


def test_who_signed_is_the_readers_knowledge(own, tmp_path):
    proof = keys.signed(samples.thread(2), keys.read_private(own))
    folder, public = tmp_path / "config", keys.read_public(f"{own}.pub")
    (found,) = keys.checked(proof, keys.known_keys(folder))
    assert found.is_right
    assert found.words.startswith("signed by an unknown key ")
    assert "valid" not in found.words
    keys.trust(folder, public, "Aya")
    (found,) = keys.checked(proof, keys.known_keys(folder))
    assert found.words == f"signed by Aya ({keys.fingerprint(public)})"
    with pytest.raises(InputError, match="another key"):
        keys.trust(folder, "00" * 32, "Aya")
    with pytest.raises(InputError, match="--name"):
        keys.trust(folder, public, " ")
    assert keys.forget(folder, "Aya") == public
    assert keys.known_keys(folder) == {}
    with pytest.raises(InputError, match="no known key"):
        keys.forget(folder, "Aya")
    (folder / keys.FILE).write_text(json.dumps({"keys": [1]}))
    with pytest.raises(InputError, match="add the keys again"):
        keys.known_keys(folder)


def test_wrong_signatures(own):
    proof = keys.signed(samples.thread(2), keys.read_private(own))
    (made,) = proof.signatures
    wrong = {
        "of another message": Signature(0, made.key, made.signature),
        "of another key": Signature(1, "11" * 32, made.signature),
        "of no point": Signature(1, "ff" * 32, made.signature),
        "changed": Signature(1, made.key, ("0" if made.signature[0] != "0" else "1")
                             + made.signature[1:]),
    }  # fmt: skip
    for signature in wrong.values():
        (found,) = keys.checked(Proof(proof.content, proof.messages, (signature,)), {})
        assert not found.is_right
        assert found.words.startswith("wrong signature")


def test_replies_keep_signatures(own):
    private = keys.read_private(own)
    proof = keys.signed(samples.thread(1), private)
    proof = keys.signed(proof.answered(Message(samples.settings(), "yes")), private)
    again = proof_of(Page(samples.page_of(proof)))
    assert [s.message for s in again.signatures] == [0, 1]
    assert all(s.is_right for s in keys.checked(again, {}))
    assert len(keys.signed(again, private).signatures) == 2  # signed again, not twice


def test_browsers_agree(chromium_sw, own, monkeypatch, tmp_path):
    samples.small_page(monkeypatch, tmp_path / "page")
    before_pages(chromium_sw, samples.canonical_module())
    proof = keys.signed(samples.thread(2), keys.read_private(own))
    (made,) = proof.signatures
    made = vars(made)
    open_page(chromium_sw, samples.page_of(proof))
    turned = ("0" if made["signature"][0] != "0" else "1") + made["signature"][1:]
    cases = [
        made, made | {"message": 0}, made | {"key": "11" * 32}, made | {"signature": turned},
        made | {"message": 7}, made | {"key": "x"}, made | {"key": "ff" * 32},
    ]  # fmt: skip
    check = "(d, s) => canon.checkSignatures(d, s)"
    got = call(chromium_sw, check, proof.digests, cases)
    assert [one["state"] for one in got] == ["right", *["wrong"] * 6]
    assert got[0]["fingerprint"] == keys.fingerprint(made["key"])
    without = """async (d, s) => {
      Object.defineProperty(crypto, "subtle", {value: undefined, configurable: true});
      try { return await canon.checkSignatures(d, s); } finally { delete crypto.subtle; }
    }"""
    assert call(chromium_sw, without, proof.digests, [made])[0]["state"] == "unchecked"
