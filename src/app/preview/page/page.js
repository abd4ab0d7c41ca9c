// The live page: joins what is posted (feed.js) to the parts of the page, and keys and buttons to what they do.

import { Controls } from "./controls.js";
import { follow } from "./feed.js";
import { arrow, listen, listenToKeys, panBy } from "./gestures.js";
import { Inspector } from "./inspector.js";
import { Pictures } from "./pictures.js";
import { Status, baseName } from "./status.js";
import { View } from "./view.js";
import { Wipe } from "./wipe.js";

const part = (selector) => document.querySelector(selector);

/** What was posted last. */
let posted = null;

const pictures = new Pictures(onPicture);
const view = new View(part("#canvas"), onDrawn);
const wipe = new Wipe(part("#wipe"), part("#compare"), view, pictures);
const inspector = new Inspector(part("#pixel"), view, pictures);
const controls = new Controls(part("#params"));
const status = new Status();

follow(onPosted, (is) => status.connected(is));

function onPosted(now) {
  posted = now;
  status.show(now);
  controls.show(now);
  wipe.show(now);
  pictures.show(now);
}

function onPicture() {
  const { now, before } = pictures;
  view.show(now, before);
  inspector.refresh();
  document.body.classList.toggle("shown", now !== null);
  if (!now) return;
  const { width, height, made, level } = now.info;
  document.documentElement.style.setProperty("--aspect", width / height);
  part("#canvas").setAttribute("aria-label", `The picture, ${width} by ${height} pixels, made at ${made}`);
  part("#canvas").dataset.picture = `${now.info.id} ${level}`;
  if (level === "final") offer(now);
}

/** Lets the finished picture be saved: the very bytes that came, under the scene's name. */
function offer({ blob }) {
  const link = part("#save");
  if (link.href) URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(blob);
  link.download = `${baseName(posted.file).replace(/\.[^.]*$/, "") || "picture"}.png`;
  link.removeAttribute("role");
  link.removeAttribute("aria-disabled");
}

function onDrawn() {
  const percent = view.zoom * 100;
  part("#zoom-now").value = `${percent < 10 ? percent.toFixed(1) : Math.round(percent)} %`;
  part("#view").classList.toggle("pannable", view.pannable);
  part("#zoom-fit").setAttribute("aria-pressed", view.fitted);
  wipe.place();
}

listen(part("#view"), view, (pixel) => inspector.point(pixel), (pixel) => {
  inspector.tap(pixel);
  // On a phone what is told of it stands at the top of what scrolls.
  if (pixel) scrollTo({ top: 0 });
});

const doing = {
  "zoom-in": () => view.step(1),
  "zoom-out": () => view.step(-1),
  "zoom-fit": () => view.fit(),
  "zoom-one": () => view.zoomTo(1),
  keys: () => part("#help").showModal(),
};
for (const [id, does] of Object.entries(doing)) part(`#${id}`).addEventListener("click", does);

/** An arrow key moves the pixel cursor if there is one, and the picture otherwise. */
function move(event) {
  const [right, down] = arrow(event);
  const at = inspector.held;
  if (!at) return panBy([right, down], event.shiftKey, view);
  const by = event.shiftKey ? 10 : 1;
  const within = (n, most) => Math.min(Math.max(n, 0), most - 1);
  const { width, height } = pictures.now.info;
  const pixel = { x: within(at.x + right * by, width), y: within(at.y + down * by, height) };
  inspector.hold(pixel);
  view.reveal(pixel);
}

listenToKeys({
  "+": doing["zoom-in"],
  "=": doing["zoom-in"],
  "-": doing["zoom-out"],
  0: doing["zoom-fit"],
  1: doing["zoom-one"],
  "?": doing.keys,
  ArrowLeft: move,
  ArrowRight: move,
  ArrowUp: move,
  ArrowDown: move,
  i() {
    if (!pictures.now) return;
    inspector.hold(inspector.held ? null : view.middle);
    part("#view").focus();
  },
  c: () => wipe.toggle(),
  s: () => part("#save").href && part("#save").click(),
  e: () => status.fold(),
  Escape() {
    inspector.hold(null);
    if (wipe.isOn) wipe.toggle();
  },
});
