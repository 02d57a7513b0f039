// Which passes still hold. The twin of picture/gpu/held.py.

// What follows from a pass, and no longer holds where it is drawn again.
const FOLLOWING = {
  grain: ["shade"],
  shade: ["split"],
  split: ["extremes", "tone"],
  coverage: ["tone"],
};

/** The passes that hold, by name, with the numbers they were drawn from. */
export class Held {
  constructor() {
    this._keys = new Map();
  }

  /** Note what a pass is drawn from; true where it must be drawn again. */
  renew(name, ...parts) {
    const key = JSON.stringify(parts);
    if (this._keys.get(name) === key) return false;
    this.forget(name);
    this._keys.set(name, key);
    return true;
  }

  forget(name) {
    this._keys.delete(name);
    for (const following of FOLLOWING[name] ?? []) this.forget(following);
  }

  clear() {
    this._keys.clear();
  }
}
