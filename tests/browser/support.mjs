// What the browser tests share: a watched scene in a folder of its own, and pages of Debian's Chromium that show it.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before } from "node:test";

const { chromium } = createRequire(join(resolve(process.env.PLAYWRIGHT ?? "target/browser"), "x"))("playwright-core");
const RTDSL = resolve(process.env.RTDSL ?? "target/release/rtdsl");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

/** Where screenshots go, for people to look at. */
export const SHOTS = resolve(process.env.SHOTS ?? "target/browser/shots");

/** How long a wish may take on a busy machine, in milliseconds: an end for what never comes, no measure. */
const PATIENCE = 60_000;

/** A ball of one colour in the middle of the picture, with a parameter of every kind. */
export const SCENE = `rtdsl 1
param tint: #ff0000 "of the ball"
param size: 1 in 0.5..=2 "of the ball"
param count: 3 in 1..=9 "stones below the ball"
param turn: 0deg in 0deg..=90deg "of the stones"
param gap: 0.5 "between stones"
param finish: "matte" of ["matte", "shiny"] "of the stones"
param ground: "none at all" of ["none at all", "dark and even", "light and even"]
param lamp: true "whether it is lit"
param title: "ball" "name of the ball"
param lift: [0, 0, 0] "where the ball is"

fn ball(at) { sphere(at: at, r: size, mat: phong(color: tint, diffuse: 0, specular: 0), name: title) }
ball(lift)
let skin = if finish == "shiny" { phong(color: #888, specular: 0.8) } else { phong(color: #888) }
for i in 0..count { sphere(at: [cos(turn) * (i - count / 2) * gap, -1.4, sin(turn) * i], r: 0.15, mat: skin) }
if ground != "none at all" { plane(y: -2, mat: phong(color: if ground == "light and even" { #ddd } else { #333 })) }
ambient(1)
background(#000000)
if lamp { light(at: [3, 5, 9]) }
camera(from: [0, 0, 6], at: [0, 0, 0], fov: 45deg)
render(size: [320, 240])
`;

let browser;
before(async () => {
  mkdirSync(SHOTS, { recursive: true });
  const rules = "--host-resolver-rules=MAP foreign.test 127.0.0.1";
  browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox", rules] });
});
after(() => browser?.close());

/** Runs `rtdsl watch --serve` on `text` while `work` lasts, which gets a `Watched`. */
export async function watching(text, work) {
  const folder = mkdtempSync(join(tmpdir(), "rtdsl-browser-"));
  const watched = new Watched(folder);
  try {
    watched.edit(text);
    await watched.start();
    await work(watched);
    assert.deepEqual(watched.faults, [], "the page has no faults");
  } finally {
    await watched.stop();
    await Promise.all(watched.contexts.map((c) => c.close()));
    rmSync(folder, { recursive: true });
  }
}

class Watched {
  contexts = [];
  /** What went wrong in pages. */
  faults = [];
  #child = null;
  #exit = null;

  constructor(folder) {
    this.folder = folder;
    this.file = join(folder, "ball.scene");
  }

  edit(text) {
    writeFileSync(this.file, text);
  }

  /** Starts the program; where it ran before, at the same port. */
  async start() {
    const at = this.url ? new URL(this.url).host : "127.0.0.1:0";
    this.#child = spawn(RTDSL, ["watch", "ball.scene", "--serve", at], { cwd: this.folder, stdio: ["ignore", "inherit", "pipe"] });
    this.#exit = new Promise((done) => this.#child.once("exit", (code) => done(code)));
    this.url = await new Promise((found, failed) => {
      let told = "";
      this.#child.stderr.on("data", (data) => {
        told += data;
        const url = told.match(/live page: (http:\S+)/);
        if (url) found(url[1]);
      });
      this.#exit.then((code) => failed(new Error(`rtdsl ended with ${code}:\n${told}`)));
    });
  }

  /** Ends the program as Ctrl-C does; its exit code. */
  async stop() {
    this.#child?.kill("SIGINT");
    return this.#exit;
  }

  /** Opens the page, with the browser set up as told, and waits for the finished picture if there will be one. */
  async open(options = {}, waits = true) {
    const context = await browser.newContext({ viewport: { width: 1100, height: 700 }, ...options });
    this.contexts.push(context);
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    page.on("pageerror", (e) => this.faults.push(String(e.stack)));
    page.on("console", (m) => {
      // A lost connection and a picture that is gone are no faults of the page.
      if (m.type() === "error" && !/Failed to load resource|ERR_/.test(m.text())) this.faults.push(m.text());
    });
    page.on("request", (r) => {
      if (!r.url().startsWith(this.url) && !r.url().startsWith("blob:")) this.faults.push(`it asks for ${r.url()}`);
    });
    await page.goto(this.url);
    if (waits) await finished(page);
    return page;
  }
}

/** Waits until the finished picture of the newest text is on show. */
export async function finished(page) {
  await page.waitForFunction(() => {
    const busy = document.body.classList.contains("busy");
    return !busy && document.querySelector("#canvas").dataset.picture?.endsWith("final");
  });
}

/** Waits until the screen shows `color` at the picture's middle, or beside it by shares of the canvas. */
export async function seen(page, color, [dx, dy] = [0, 0]) {
  const arrived = await page
    .waitForFunction(([color, dx, dy]) => {
      const canvas = document.querySelector("#canvas");
      const at = [canvas.width * (0.5 + dx), canvas.height * (0.5 + dy), 1, 1].map(Math.floor);
      const code = canvas.getContext("2d").getImageData(at[0], at[1], 1, 1).data;
      const [r, g, b] = [...code].map((v) => v.toString(16).padStart(2, "0"));
      window.seenColor = `#${r}${g}${b}`;
      return window.seenColor === color;
    }, [color, dx, dy])
    .catch(() => false);
  if (!arrived) assert.fail(`${color} never came; the picture shows ${await page.evaluate("window.seenColor")}`);
}

/** Waits until an element's text (a field's: its value) is `text`, or matches it. */
export async function reads(page, selector, text) {
  const [source, flags] = text instanceof RegExp ? [text.source, text.flags] : [null, null];
  const get = ([selector, text, source, flags]) => {
    const element = document.querySelector(selector);
    window.readText = element?.matches("input, select") ? element.value : element?.textContent;
    return source ? new RegExp(source, flags).test(window.readText) : window.readText === text;
  };
  const arrived = await page.waitForFunction(get, [selector, source ? null : text, source, flags]).catch(() => false);
  if (!arrived) assert.fail(`${selector} reads ${await page.evaluate("window.readText")}, not ${text}`);
}

/** The slider of a parameter. */
export function slider(page, name) {
  return page.locator(`.param:has(#param-${name}) input[type=range]`);
}

/** Takes hold of a slider and moves it to shares of its width, one after another. */
export async function drag(page, name, shares) {
  const handle = slider(page, name);
  await handle.scrollIntoViewIfNeeded();
  const box = await handle.boundingBox();
  const to = (share) => page.mouse.move(box.x + 8 + share * (box.width - 16), box.y + box.height / 2);
  await to(shares[0]);
  await page.mouse.down();
  for (const share of shares) await to(share);
  await page.mouse.up();
}
