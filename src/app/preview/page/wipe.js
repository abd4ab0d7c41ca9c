// The comparison with the picture before: a line over the picture that is dragged or moved with arrow keys. Left of it is the
// picture before, right of it the one of now.

/** What an arrow key moves, and with Shift or Page keys, as shares of the width. */
const STEP = 0.02;
const LEAP = 0.1;

export class Wipe {
  #handle;
  #button;
  #view;
  #pictures;
  #share = 0.5;
  #possible = false;

  /** `handle` is the line, `button` turns it on and off. */
  constructor(handle, button, view, pictures) {
    this.#handle = handle;
    this.#button = button;
    this.#view = view;
    this.#pictures = pictures;
    button.addEventListener("click", () => this.toggle());
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      handle.focus();
    });
    handle.addEventListener("pointermove", (event) => {
      if (handle.hasPointerCapture(event.pointerId)) this.#moveToClient(event.clientX);
    });
    handle.addEventListener("keydown", (event) => this.#key(event));
  }

  get isOn() {
    return this.#view.wipe !== null;
  }

  /** Turns the comparison on or off. */
  toggle() {
    if (!this.isOn && !this.#possible) return;
    this.#view.wipe = this.isOn ? null : this.#share;
    this.#pictures.wantBefore = this.isOn;
    this.#button.setAttribute("aria-pressed", this.isOn);
    this.#view.draw();
    this.place();
    if (this.isOn) this.#handle.focus();
    else if (document.activeElement === this.#handle) this.#button.focus();
  }

  /** Takes note of what there is to compare. */
  show({ picture, previous }) {
    this.#possible = Boolean(picture && previous);
    this.#button.disabled = !this.#possible;
    if (!this.#possible && this.isOn) this.toggle();
  }

  /** Puts the line where the view has it; called after each drawing. */
  place() {
    const { now, before } = this.#pictures;
    this.#handle.hidden = !this.isOn || !now || !before;
    if (this.#handle.hidden) return;
    const { from, to } = this.#view.span;
    this.#handle.style.left = `${from + this.#share * (to - from)}px`;
    this.#handle.querySelector("#wipe-before").textContent = before.info.made;
    this.#handle.querySelector("#wipe-now").textContent = now.info.made;
    const percent = Math.round(this.#share * 100);
    this.#handle.setAttribute("aria-valuenow", percent);
    this.#handle.setAttribute("aria-valuetext", `${percent} % of ${before.info.made}, the rest of ${now.info.made}`);
  }

  #moveToClient(x) {
    const { from, to } = this.#view.span;
    const left = this.#handle.parentElement.getBoundingClientRect().left;
    this.#moveTo((x - left - from) / Math.max(to - from, 1));
  }

  #moveTo(share) {
    this.#share = Math.min(Math.max(share, 0), 1);
    this.#view.wipe = this.#share;
    this.#view.draw();
  }

  #key(event) {
    const by = event.shiftKey ? LEAP : STEP;
    const to = {
      ArrowLeft: this.#share - by,
      ArrowDown: this.#share - by,
      ArrowRight: this.#share + by,
      ArrowUp: this.#share + by,
      PageDown: this.#share - LEAP,
      PageUp: this.#share + LEAP,
      Home: 0,
      End: 1,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.#moveTo(to);
  }
}
