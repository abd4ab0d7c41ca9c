// The pictures: fetched and decoded before they are shown, so that nothing flickers and nothing is ever blank.

/** How long after a picture couldn't be fetched it is tried again, in milliseconds: a hiccup is over by then. */
const RETRY = 1000;

/** The longest such pause; it doubles each time. */
const LONGEST_RETRY = 30_000;

/**
 * Holds the picture on show and, when it is wanted, the one before it. One is fetched at a time, and always the newest.
 * An entry is `{ key, info, bitmap, blob }`, where `info` is the picture as it was posted.
 */
export class Pictures {
  /** The entry on show, or null. */
  now = null;
  /** The entry to compare with, or null. */
  before = null;

  #posted = null;
  #wantBefore = false;
  #busy = false;
  #retry = null;
  #pause = RETRY;
  #onChange;

  /** `onChange` is called when either entry has changed. */
  constructor(onChange) {
    this.#onChange = onChange;
  }

  /** Shows what `posted` names. */
  show(posted) {
    this.#posted = posted;
    this.#pause = RETRY;
    this.#catchUp();
  }

  /** Whether the picture before is needed. */
  set wantBefore(want) {
    this.#wantBefore = want;
    this.#catchUp();
  }

  async #catchUp() {
    if (this.#busy) return;
    this.#busy = true;
    clearTimeout(this.#retry);
    let done = true;
    for (let task = this.#next(); task && done; task = this.#next()) done = await task();
    this.#busy = false;
    if (done) return;
    // It is still the newest: nothing else would ask for it again.
    this.#retry = setTimeout(() => this.#catchUp(), this.#pause);
    this.#pause = Math.min(2 * this.#pause, LONGEST_RETRY);
  }

  /** What is to be done next: a function that tells whether it could be done. */
  #next() {
    const { run, picture, previous } = this.#posted ?? {};
    if (picture && this.now?.key !== key(run, picture)) {
      return () => this.#load(run, picture, (entry) => {
        const old = [this.now, this.before];
        this.now = entry;
        // What was on show may be the very picture to compare with.
        this.before = old.find((o) => o?.key === this.#previousKey()) ?? this.before;
        old.forEach((o) => this.#drop(o));
      });
    }
    if ((this.before?.key ?? null) === this.#previousKey()) return null;
    if (previous && this.#wantBefore) return () => this.#load(run, previous, (entry) => this.#compareWith(entry));
    if (this.before) return () => this.#compareWith(null);
    return null;
  }

  #previousKey() {
    const { run, previous } = this.#posted;
    return previous ? key(run, previous) : null;
  }

  #compareWith(entry) {
    const old = this.before;
    this.before = entry;
    this.#drop(old);
    return true;
  }

  /** Frees what is shown nowhere. */
  #drop(entry) {
    if (entry && entry !== this.now && entry !== this.before) {
      this.#onChange();
      entry.bitmap.close();
    }
  }

  async #load(run, info, put) {
    let blob, bitmap;
    try {
      const response = await fetch(`/picture/${info.id}.png?run=${encodeURIComponent(run)}`);
      if (!response.ok) return this.#isPast(run, info);
      blob = await response.blob();
      bitmap = await createImageBitmap(blob);
    } catch {
      return this.#isPast(run, info);
    }
    this.#pause = RETRY;
    put({ key: key(run, info), info, bitmap, blob });
    this.#onChange();
    return true;
  }

  /** Whether something newer than `info` has been posted meanwhile: then that is worth a try. */
  #isPast(run, info) {
    const { run: runNow, picture, previous } = this.#posted;
    return ![picture, previous].some((p) => p && key(runNow, p) === key(run, info));
  }
}

/** Numbers of pictures begin anew with each run of the program. */
function key(run, info) {
  return `${run}/${info.id}`;
}
