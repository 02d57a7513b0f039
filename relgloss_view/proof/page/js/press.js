// A finger that rests reads a colour; one that moves turns the object.

const PRESS_MS = 500; // of a finger at rest until it reads
const REST_PX = 8; // CSS pixels that a finger at rest may move

/** What one finger is about to do: nothing yet, to read, or to drag. */
export class Press {
  /** read(place): called when the finger has rested, and for each of its moves from then on. */
  constructor(read) {
    this.read = read;
    this.end();
  }

  /** A finger comes down, [x, y] in CSS pixels. */
  begin(place) {
    this.end();
    this.from = place;
    this.timer = setTimeout(() => {
      this.reads = true;
      this.read(this.from);
    }, PRESS_MS);
  }

  /** Whether a move to a place turns the object; where it does not, it reads or is no move yet. */
  drags(place) {
    if (this.reads) this.read(place);
    else if (this.from !== null
      && Math.hypot(place[0] - this.from[0], place[1] - this.from[1]) > REST_PX) this.end();
    return !this.reads && this.from === null;
  }

  /** The finger is away, drags, or is not alone. */
  end() {
    clearTimeout(this.timer);
    this.from = null; // where it waits
    this.reads = false;
  }
}
