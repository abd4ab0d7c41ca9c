// The picture on the screen: where it lies, how large, and how it is drawn. In canvas pixels, which are those of the screen.

/** Steps of the zoom keys and buttons: screen pixels for a pixel of the picture. */
const STEPS = [1 / 32, 1 / 16, 1 / 8, 1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];
const LARGEST = STEPS.at(-1);

/** A picture that is fitted is smoothed up to here; beyond, its pixels are large enough to be seen as what they are. */
const FITTED_SMOOTH = 4;

/** Room around a picture that fits, on a narrow window less; and how far its edge may be panned inwards. In CSS pixels. */
const MARGIN = 14;
const NARROW = { width: 500, margin: 5 };
const OVERPAN = 60;

/** A picture that would be enlarged by less is shown pixel for pixel: sharp is better than a little larger. */
const WORTH_ENLARGING = 1.2;

export class View {
  /** Zoom, in screen pixels for a pixel of the picture. */
  zoom = 1;
  /** Whether the zoom follows the window. */
  fitted = true;
  /** Pixel that is marked, or null. */
  mark = null;
  /** Share of the picture's visible width that shows the picture before, or null. */
  wipe = null;

  #canvas;
  #context;
  #onDraw;
  #now = null;
  #before = null;
  #size = { width: 0, height: 0 };
  #centre = { x: 0, y: 0 };
  #asked = false;

  /** `onDraw` is called after each change on the screen. */
  constructor(canvas, onDraw) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d");
    this.#onDraw = onDraw;
    const observer = new ResizeObserver(([entry]) => this.#resize(entry));
    try {
      // Also when the window goes to a screen of another density.
      observer.observe(canvas, { box: "device-pixel-content-box" });
    } catch {
      // Safari doesn't know that box.
      observer.observe(canvas);
    }
  }

  /** Shows these entries (see pictures.js); each may be null. */
  show(now, before) {
    const { width, height } = now?.info ?? this.#size;
    if (width !== this.#size.width || height !== this.#size.height) {
      this.#centre.x *= this.#size.width ? width / this.#size.width : 1;
      this.#centre.y *= this.#size.height ? height / this.#size.height : 1;
      this.#size = { width, height };
      if (!now || this.fitted) this.fit();
    }
    this.#now = now;
    this.#before = before;
    this.draw();
  }

  /** Shows the whole picture as large as it can be. */
  fit() {
    this.fitted = true;
    this.zoom = this.#fitZoom();
    this.#centre = { x: this.#size.width / 2, y: this.#size.height / 2 };
    this.draw();
  }

  /** Zooms to `zoom` such that the point at (x, y), in client coordinates, stays; the middle without one. */
  zoomTo(zoom, x, y) {
    const smallest = Math.min(this.#fitZoom(), 1);
    const next = Math.min(Math.max(zoom, smallest), LARGEST);
    if (next <= this.#fitZoom() && next < this.zoom && smallest === this.#fitZoom()) return this.fit();
    const box = this.#canvas.getBoundingClientRect();
    const dx = x === undefined ? 0 : (x - box.left) * this.#ratio() - this.#canvas.width / 2;
    const dy = y === undefined ? 0 : (y - box.top) * this.#ratio() - this.#canvas.height / 2;
    this.#centre.x += dx / this.zoom - dx / next;
    this.#centre.y += dy / this.zoom - dy / next;
    this.zoom = next;
    this.fitted = false;
    this.#clamp();
    this.draw();
  }

  /** The next larger (`by` 1) or smaller (-1) step. */
  step(by) {
    const beyond = by > 0 ? (s) => s > this.zoom * 1.001 : (s) => s < this.zoom * 0.999;
    this.zoomTo((by > 0 ? STEPS.find(beyond) : STEPS.findLast(beyond)) ?? this.zoom);
  }

  /** Moves the picture by CSS pixels. */
  pan(dx, dy) {
    this.#centre.x -= (dx * this.#ratio()) / this.zoom;
    this.#centre.y -= (dy * this.#ratio()) / this.zoom;
    this.#clamp();
    this.draw();
  }

  /** Whether there is more of the picture than is in sight. */
  get pannable() {
    const { w, h } = this.#place();
    return w > this.#canvas.width || h > this.#canvas.height;
  }

  /** The picture's pixel at client coordinates, or null. */
  pixelAt(x, y) {
    const box = this.#canvas.getBoundingClientRect();
    const { left, top } = this.#place();
    const px = Math.floor(((x - box.left) * this.#ratio() - left) / this.zoom);
    const py = Math.floor(((y - box.top) * this.#ratio() - top) / this.zoom);
    const inside = px >= 0 && py >= 0 && px < this.#size.width && py < this.#size.height;
    return inside && this.#now ? { x: px, y: py } : null;
  }

  /** The pixel in the middle of what is in sight. */
  get middle() {
    const at = (c, most) => Math.min(Math.max(Math.floor(c), 0), most - 1);
    return { x: at(this.#centre.x, this.#size.width), y: at(this.#centre.y, this.#size.height) };
  }

  /** Pans such that the pixel is in sight. */
  reveal({ x, y }) {
    const { left, top } = this.#place();
    const past = (a, size, room) => (a < size ? a - size : a > room - size ? a - room + size : 0);
    const edge = 24 * this.#ratio();
    const dx = past(left + (x + 0.5) * this.zoom, edge, this.#canvas.width);
    const dy = past(top + (y + 0.5) * this.zoom, edge, this.#canvas.height);
    if (this.pannable && (dx || dy)) this.pan(-dx / this.#ratio(), -dy / this.#ratio());
  }

  /** Left and right end of what is in sight of the picture, in CSS pixels of the canvas. */
  get span() {
    const { left, w } = this.#place();
    const from = Math.max(left, 0) / this.#ratio();
    return { from, to: Math.min(left + w, this.#canvas.width) / this.#ratio() };
  }

  /** Whether the picture before lies over this pixel. */
  isBefore({ x }) {
    if (this.wipe === null || !this.#before) return false;
    const { left } = this.#place();
    return left + (x + 0.5) * this.zoom < this.#edge();
  }

  /** Draws with the next frame. */
  draw() {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => {
      this.#asked = false;
      this.#paint();
      this.#onDraw();
    });
  }

  #paint() {
    const c = this.#context;
    c.clearRect(0, 0, this.#canvas.width, this.#canvas.height);
    if (this.#now) this.#paintPicture(this.#now);
    if (this.wipe !== null && this.#before) {
      c.save();
      c.beginPath();
      c.rect(0, 0, this.#edge(), this.#canvas.height);
      c.clip();
      this.#paintPicture(this.#before);
      c.restore();
    }
    if (this.mark && this.#now) this.#paintMark();
  }

  #paintPicture({ bitmap, info }) {
    const c = this.#context;
    const { left, top, w, h } = this.#place();
    const large = this.zoom > (this.fitted ? FITTED_SMOOTH : 1);
    c.imageSmoothingEnabled = !large || info.level === "coarse";
    c.imageSmoothingQuality = "high";
    if (this.zoom <= 1) {
      c.drawImage(bitmap, left, top, w, h);
      return;
    }
    // Enlarged, only the pixels in sight: the whole would be larger than any canvas.
    const part = (start, room, most) => {
      const from = Math.max(0, Math.floor(-start / this.zoom) - 1);
      return [from, Math.min(most, Math.ceil((room - start) / this.zoom) + 1) - from];
    };
    const [x, width] = part(left, this.#canvas.width, this.#size.width);
    const [y, height] = part(top, this.#canvas.height, this.#size.height);
    if (width <= 0 || height <= 0) return;
    const [kx, ky] = [bitmap.width / this.#size.width, bitmap.height / this.#size.height];
    const z = this.zoom;
    c.drawImage(bitmap, x * kx, y * ky, width * kx, height * ky, left + x * z, top + y * z, width * z, height * z);
  }

  /** The marked pixel's outline, larger where a pixel is too small to be seen. Dark and light: seen on every colour. */
  #paintMark() {
    const c = this.#context;
    const { left, top } = this.#place();
    const least = 9 * this.#ratio();
    const side = Math.max(this.zoom, least);
    // Lines lie in the middle of the screen's pixels: between two they are blurred.
    const x = Math.round(left + (this.mark.x + 0.5) * this.zoom - side / 2) - 0.5;
    const y = Math.round(top + (this.mark.y + 0.5) * this.zoom - side / 2) - 0.5;
    for (const [color, line] of [["#000", 3], ["#fff", 1]]) {
      c.strokeStyle = color;
      c.lineWidth = line * this.#ratio();
      c.strokeRect(x, y, Math.round(side) + 1, Math.round(side) + 1);
    }
  }

  /** Where the picture lies on the canvas. Edges lie between pixels of the screen only while they move. */
  #place() {
    const [w, h] = [this.#size.width * this.zoom, this.#size.height * this.zoom];
    const left = Math.round(this.#canvas.width / 2 - this.#centre.x * this.zoom);
    const top = Math.round(this.#canvas.height / 2 - this.#centre.y * this.zoom);
    return { left, top, w, h };
  }

  /** Where the comparison's line stands on the canvas. */
  #edge() {
    const { from, to } = this.span;
    return Math.round((from + this.wipe * (to - from)) * this.#ratio());
  }

  #fitZoom() {
    const { width, height } = this.#size;
    if (!width || !height) return 1;
    const { width: w, height: h, clientWidth } = this.#canvas;
    const margin = clientWidth < NARROW.width ? NARROW.margin : MARGIN;
    const room = (side) => Math.max(side - 2 * margin * this.#ratio(), 1);
    const zoom = Math.min(room(w) / width, room(h) / height, LARGEST);
    return zoom < WORTH_ENLARGING && width <= w && height <= h ? 1 : zoom;
  }

  /** Keeps the picture in sight; what is smaller than the window stays in its middle. */
  #clamp() {
    const hold = (centre, most, room) => {
      const half = room / 2 / this.zoom;
      const over = (OVERPAN * this.#ratio()) / this.zoom;
      return most <= 2 * half ? most / 2 : Math.min(Math.max(centre, half - over), most - half + over);
    };
    this.#centre.x = hold(this.#centre.x, this.#size.width, this.#canvas.width);
    this.#centre.y = hold(this.#centre.y, this.#size.height, this.#canvas.height);
  }

  /** Screen pixels for a CSS pixel. */
  #ratio() {
    return this.#canvas.clientWidth ? this.#canvas.width / this.#canvas.clientWidth : devicePixelRatio;
  }

  #resize(entry) {
    const exact = entry.devicePixelContentBoxSize?.[0];
    // Rounding may go either way, which only the browser knows. One that emulates another screen doesn't know either.
    const side = (length, told) => {
      const near = length * devicePixelRatio;
      return Math.max(Math.abs(told - near) < 1 ? told : Math.round(near), 1);
    };
    this.#canvas.width = side(entry.contentRect.width, exact?.inlineSize);
    this.#canvas.height = side(entry.contentRect.height, exact?.blockSize);
    if (this.fitted) this.fit();
    else this.#clamp();
    // Without waiting for a frame: a canvas of another size is empty.
    this.#paint();
    this.#onDraw();
  }
}
