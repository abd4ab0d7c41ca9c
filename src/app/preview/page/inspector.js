// The pixel under the mouse, the finger or the keyboard's cursor: its colour at once, and what it sees as soon as the pointer
// rests.

/** How long the pointer rests before the server is asked, in milliseconds. */
const REST = 70;

export class Inspector {
  #root;
  #view;
  #pictures;
  /** The pixel that was under the mouse last, and the one that is held. */
  #pointed = null;
  #held = null;
  /** What the rows tell of: picture and pixel. */
  #told = "";
  #timer = null;
  #asked = null;
  #sample = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });

  constructor(root, view, pictures) {
    this.#root = root;
    this.#view = view;
    this.#pictures = pictures;
  }

  /** The mouse is over `pixel`; what is told of the last one stays when it leaves. */
  point(pixel) {
    this.#pointed = pixel ?? this.#pointed;
    if (!this.#held) this.refresh();
  }

  /** Holds a pixel that was tapped; a second tap, or one beside the picture, lets go. */
  tap(pixel) {
    const again = pixel && this.#held && pixel.x === this.#held.x && pixel.y === this.#held.y;
    this.hold(again ? null : pixel);
  }

  /** Holds `pixel`, or none. */
  hold(pixel) {
    this.#held = pixel;
    this.#view.mark = pixel;
    this.#view.draw();
    this.refresh();
  }

  /** The pixel that is held, or null. */
  get held() {
    return this.#held;
  }

  /** Tells of the pixel again: it or the picture has changed. */
  refresh() {
    const pixel = this.#held ?? this.#pointed;
    const isBefore = pixel && this.#view.isBefore(pixel);
    const entry = isBefore ? this.#pictures.before : this.#pictures.now;
    const outside = pixel && entry && (pixel.x >= entry.info.width || pixel.y >= entry.info.height);
    if (!pixel || !entry || outside) return;
    const code = this.#code(entry, pixel);
    this.#part("#pixel-hint").hidden = true;
    this.#part("#pixel-color").hidden = false;
    this.#part("#pixel-at").textContent = `${pixel.x}, ${pixel.y}`;
    this.#part("#pixel-code").textContent = code + (entry.info.level === "coarse" ? " (coarse)" : "");
    this.#part("#swatch").style.setProperty("--color", code);
    this.#ask(entry, pixel, isBefore);
  }

  /** The colour code of a pixel; of a coarse picture, of the large pixel that lies there. */
  #code({ bitmap, info }, { x, y }) {
    const sx = Math.floor(((x + 0.5) * bitmap.width) / info.width);
    const sy = Math.floor(((y + 0.5) * bitmap.height) / info.height);
    this.#sample.clearRect(0, 0, 1, 1);
    this.#sample.drawImage(bitmap, sx, sy, 1, 1, 0, 0, 1, 1);
    const [r, g, b] = this.#sample.getImageData(0, 0, 1, 1).data;
    return `#${[r, g, b].map((v) => v.toString(16).padStart(2, "0")).join("")}`;
  }

  #ask(entry, { x, y }, isBefore) {
    const about = `${entry.key} ${x},${y}`;
    if (about === this.#told) return;
    clearTimeout(this.#timer);
    this.#asked?.abort();
    this.#part("#pixel-seen").classList.add("old");
    // The server knows the scene of the newest finished picture alone.
    if (isBefore || entry.info.level !== "final") return;
    this.#timer = setTimeout(async () => {
      this.#asked = new AbortController();
      try {
        const response = await fetch(`/explain?x=${x}&y=${y}`, { signal: this.#asked.signal });
        if (!response.ok) return;
        const { picture, sight } = await response.json();
        if (picture !== entry.info.id || entry !== this.#pictures.now) return;
        this.#told = about;
        this.#tell(sight);
      } catch {
        // Another pixel is asked for, or the connection is lost, which is told elsewhere.
      }
    }, REST);
  }

  #tell(sight) {
    const list = this.#part("#pixel-seen");
    list.classList.remove("old");
    list.replaceChildren();
    const row = (name, values, className = "code") => {
      const dt = document.createElement("dt");
      dt.textContent = name;
      list.append(dt, ...[values].flat().map((value) => element("dd", className, value)));
    };
    if (!sight) {
      list.append(element("dd", "what", "background"));
      return;
    }
    list.append(element("dd", "what", sight.what));
    row("made at", [...placeAndText(sight.made_at), ...sight.calls]);
    row("material", placeAndText(sight.material));
    row("distance", sight.distance);
    row("lights", sight.lights.length ? sight.lights : "none in the scene");
    row("color", sight.color);
    row("point", sight.point);
    row("normal", sight.normal);
  }

  #part(selector) {
    return this.#root.querySelector(selector);
  }
}

/** Place and text, to be shown on lines of their own: parted by two spaces, of which the text may have more. */
function placeAndText(made) {
  return made.match(/^(.*?:\d+:\d+) {2}(.*)$/s)?.slice(1) ?? [made];
}

function element(tag, className, text) {
  const made = document.createElement(tag);
  made.className = className;
  // A long path breaks at its folders, not within a line's number.
  text.split(/(?<=\/)/).forEach((piece, i) => made.append(...(i ? [document.createElement("wbr")] : []), piece));
  return made;
}
