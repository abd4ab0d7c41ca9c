// Mouse, fingers and keys on the picture.

/** How far, in CSS pixels, a press may stray and still be a tap. */
const TAP = 6;

/** Pixels that an arrow key pans; with Shift, and how much farther. */
const PAN = 60;
const FARTHER = 5;

/** How much a turn of the wheel zooms: a notch (100 units) by a fifth. A pinch on a touchpad comes as small turns with Ctrl. */
const WHEEL = 0.0018;
const PINCH = 0.01;

/**
 * Lets `element` move `view`. `onPoint` is called with the pixel under the mouse, `onTap` with one that was clicked or
 * tapped; both with null beside the picture.
 */
export function listen(element, view, onPoint, onTap) {
  /** Where each pressed pointer is. */
  const pressed = new Map();
  let strayed = false;

  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    element.setPointerCapture(event.pointerId);
    strayed = pressed.size > 0;
    pressed.set(event.pointerId, { x: event.clientX, y: event.clientY, from: [event.clientX, event.clientY] });
  });

  element.addEventListener("pointermove", (event) => {
    const { clientX: x, clientY: y } = event;
    const old = pressed.get(event.pointerId);
    if (!old) {
      if (event.pointerType === "mouse") onPoint(view.pixelAt(x, y));
      return;
    }
    const before = [...pressed.values()].map((p) => ({ ...p }));
    strayed ||= Math.hypot(x - old.from[0], y - old.from[1]) > TAP;
    if (!strayed) return;
    [old.x, old.y] = [x, y];
    element.classList.toggle("panning", view.pannable);
    const after = [...pressed.values()];
    if (after.length === 1) {
      view.pan(x - before[0].x, y - before[0].y);
    } else if (after.length === 2) {
      pinch(before, after);
    }
  });

  function pinch(before, after) {
    const distance = ([a, b]) => Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1);
    const middle = ([a, b]) => [(a.x + b.x) / 2, (a.y + b.y) / 2];
    const [bx, by] = middle(before);
    const [ax, ay] = middle(after);
    view.zoomTo((view.zoom * distance(after)) / distance(before), ax, ay);
    view.pan(ax - bx, ay - by);
  }

  const release = (event) => {
    if (!pressed.delete(event.pointerId)) return;
    element.classList.remove("panning");
    if (event.type === "pointerup" && !strayed) onTap(view.pixelAt(event.clientX, event.clientY));
  };
  element.addEventListener("pointerup", release);
  element.addEventListener("pointercancel", release);

  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    // Some wheels count lines or pages.
    const units = event.deltaY * [1, 33, 400][event.deltaMode];
    view.zoomTo(view.zoom * Math.exp(-units * (event.ctrlKey ? PINCH : WHEEL)), event.clientX, event.clientY);
  }, { passive: false });
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Which way an arrow key points, as [right, down], or undefined. */
export function arrow(event) {
  return ARROWS[event.key];
}

/** Pans by an arrow key. */
export function panBy([right, down], far, view) {
  const by = PAN * (far ? FARTHER : 1);
  view.pan(-right * by, -down * by);
}

/**
 * Calls the action of a key, by `keys[event.key]`, wherever the focus is but in a field that is typed in. Letters work in
 * both cases; keys with Ctrl, Alt or Meta are the browser's.
 */
export function listenToKeys(keys) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
    if (document.querySelector("dialog[open]")) return;
    const target = event.target;
    const typed = target.matches?.("input:not([type=range], [type=checkbox], [type=radio]), select, textarea");
    const moved = arrow(event) && !(target === document.body || target.closest?.("#view"));
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (typed || moved || !keys[name]) return;
    event.preventDefault();
    keys[name](event);
  });
}
