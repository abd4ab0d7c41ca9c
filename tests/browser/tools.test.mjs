// The tools of the page: zoom, pixel, comparison, saving; controls of every kind; all of it by keyboard too.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { SCENE, finished, reads, seen, watching } from "./support.mjs";

/** Zoom as the page tells it, as a number. */
async function zoom(page) {
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  return parseFloat(await page.textContent("#zoom-now"));
}

/** Client coordinates of the middle of the picture. */
async function middle(page) {
  const box = await page.locator("#canvas").boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

test("the keyboard zooms and pans", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const fit = await zoom(page);
    assert.ok(fit > 100, "a small picture is enlarged");
    await page.keyboard.press("1");
    assert.equal(await zoom(page), 100);
    await page.keyboard.press("+");
    assert.ok((await zoom(page)) > 100);
    await page.keyboard.press("-");
    assert.equal(await zoom(page), 100);
    for (let i = 0; i < 20; i++) await page.keyboard.press("+");
    assert.equal(await zoom(page), 6400);
    await seen(page, "#ff0000");
    // Far to the right there is no ball.
    for (let i = 0; i < 40; i++) await page.keyboard.press("Shift+ArrowRight");
    await seen(page, "#000000");
    await page.keyboard.press("0");
    assert.equal(await zoom(page), fit);
    await seen(page, "#ff0000");
    // An edit doesn't move what is looked at.
    await page.keyboard.press("1");
    watched.edit(SCENE.replace("#ff0000", "#00ff00"));
    await seen(page, "#00ff00");
    assert.equal(await zoom(page), 100);
  }));

test("the wheel zooms where the mouse is, and dragging pans", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const [x, y] = await middle(page);
    await page.mouse.move(x + 40, y);
    await reads(page, "#pixel-at", /\d/);
    const at = await page.textContent("#pixel-at");
    for (let i = 0; i < 10; i++) await page.mouse.wheel(0, -200);
    assert.ok((await zoom(page)) > 1000);
    await page.mouse.move(x + 40.5, y);
    await reads(page, "#pixel-at", at);
    await page.mouse.down();
    await page.mouse.move(x - 200, y, { steps: 5 });
    await page.mouse.up();
    await reads(page, "#pixel-at", at);
    await page.mouse.move(x + 40, y);
    await page.waitForFunction((at) => document.querySelector("#pixel-at").textContent !== at, at);
  }));

test("two fingers zoom", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open({ viewport: { width: 400, height: 800 }, hasTouch: true, isMobile: true });
    const before = await zoom(page);
    const [x, y] = await middle(page);
    const touch = await page.context().newCDPSession(page);
    const fingers = (type, apart) => {
      const touchPoints = type === "touchEnd" ? [] : [{ x: x - apart, y, id: 0 }, { x: x + apart, y, id: 1 }];
      return touch.send("Input.dispatchTouchEvent", { type, touchPoints });
    };
    await fingers("touchStart", 20);
    for (let apart = 25; apart <= 80; apart += 5) await fingers("touchMove", apart);
    await fingers("touchEnd");
    const ratio = (await zoom(page)) / before;
    assert.ok(ratio > 2.5 && ratio < 5, `${ratio}`);
  }));

test("a pixel is explained under the mouse, a tap and the keyboard's cursor", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const [x, y] = await middle(page);
    await page.mouse.move(x, y);
    await reads(page, "#pixel-code", "#ff0000");
    await reads(page, "#pixel-seen", /^sphere "ball"made atball\.scene:13:\d+sphere\(at: at/);
    await page.mouse.move(x + 280, y - 180);
    await reads(page, "#pixel-seen", "background");
    // A click holds it, wherever the mouse goes.
    await page.mouse.click(x, y);
    await reads(page, "#pixel-seen", /^sphere/);
    await page.mouse.move(x + 280, y - 180);
    await reads(page, "#pixel-code", "#ff0000");
    // It is told anew of a new picture.
    watched.edit(SCENE.replace("#ff0000", "#00ff00").replace('"ball"', '"moon"'));
    await reads(page, "#pixel-code", "#00ff00");
    await reads(page, "#pixel-seen", /^sphere "moon"/);
    await page.keyboard.press("Escape");

    await page.keyboard.press("i");
    await reads(page, "#pixel-at", "160, 120");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("Shift+ArrowDown");
    await reads(page, "#pixel-at", "161, 130");
    await reads(page, "#pixel-seen", /^sphere/);
    for (let i = 0; i < 40; i++) await page.keyboard.press("Shift+ArrowLeft");
    await reads(page, "#pixel-at", "0, 130");
    await reads(page, "#pixel-seen", "background");
    await page.keyboard.press("Escape");
  }));

test("the picture is compared with the one before", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    assert.equal(await page.isDisabled("#compare"), true, "there is nothing to compare with yet");
    await page.keyboard.press("c");
    assert.equal(await page.isVisible("#wipe"), false);
    watched.edit(SCENE.replace("#ff0000", "#00ff00"));
    await seen(page, "#00ff00");
    await finished(page);
    await page.keyboard.press("c");
    await page.waitForSelector("#wipe:not([hidden])");
    await seen(page, "#ff0000", [-0.05, 0]);
    await seen(page, "#00ff00", [0.05, 0]);
    // The line has the focus: arrow keys move it.
    for (let i = 0; i < 3; i++) await page.keyboard.press("Shift+ArrowRight");
    await seen(page, "#ff0000", [0.05, 0]);
    await page.keyboard.press("Home");
    await seen(page, "#00ff00", [-0.05, 0]);
    assert.equal(await page.getAttribute("#wipe", "aria-valuenow"), "0");
    // And so does the mouse.
    const box = await page.locator("#wipe").boundingBox();
    const [x] = await middle(page);
    await page.mouse.move(box.x + box.width / 2, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(x + 100, box.y + 100, { steps: 4 });
    await page.mouse.up();
    await seen(page, "#ff0000", [0.05, 0]);
    // A new picture makes the last one the one before.
    watched.edit(SCENE.replace("#ff0000", "#0000ff"));
    await seen(page, "#00ff00");
    await page.keyboard.press("Escape");
    await seen(page, "#0000ff");
    assert.equal(await page.isVisible("#wipe"), false);
  }));

test("the picture is saved as the program made it", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const waiting = page.waitForEvent("download");
    await page.keyboard.press("s");
    const download = await waiting;
    assert.equal(download.suggestedFilename(), "ball.png");
    const saved = readFileSync(await download.path());
    const id = (await page.getAttribute("#canvas", "data-picture")).split(" ")[0];
    const served = Buffer.from(await (await fetch(`${watched.url}picture/${id}.png`)).arrayBuffer());
    assert.ok(saved.equals(served));
    assert.ok(saved.includes("rtdsl:scene"), "with its recipe");
  }));

test("controls of every kind", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const line = (text) => reads(page, "#set-line", text);
    await page.fill("#param-count", "5");
    await line("--set count=5");
    await page.fill("#param-turn", "30");
    await line("--set count=5 --set turn=30deg");
    await page.fill("#param-gap", "0.25");
    await line("--set count=5 --set turn=30deg --set gap=0.25");
    await page.click("#reset-all");
    await line("");
    await page.click("#param-finish >> text=shiny");
    await line("--set finish=shiny");
    await page.selectOption("#param-ground", "light and even");
    await line("--set finish=shiny --set 'ground=light and even'");
    await page.uncheck("#param-lamp");
    await line("--set finish=shiny --set 'ground=light and even' --set lamp=false");
    await page.click("#reset-all");
    await line("");
    assert.equal(await page.isChecked("#param-lamp"), true);

    await page.fill("#param-title", 'the "odd" {one}');
    await page.keyboard.press("Enter");
    await line(`--set 'title=the "odd" {one}'`);
    await reads(page, "#param-title", 'the "odd" {one}');
    await page.fill("#param-lift", "[0, 9, 0]");
    await page.keyboard.press("Enter");
    await seen(page, "#000000");
    // What is out of range isn't sent, and doesn't stay; what is no value is told, and stays to be mended.
    await page.fill("#param-count", "500");
    await page.fill("#param-lift", "[0, 0,");
    await reads(page, "#param-count", "3");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#errors:not([hidden])");
    await reads(page, "#param-lift", "[0, 0,");
    await reads(page, "#set-line", /lift=\[0, 9, 0\]/);
    await page.click(".param:has(#param-lift) .param-reset");
    await page.waitForSelector("#errors", { state: "hidden" });
    await reads(page, "#param-lift", "[0, 0, 0]");
    await seen(page, "#ff0000");
  }));

test("controls follow the text", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    await page.focus("#param-gap");
    watched.edit(SCENE.replace('param count: 3 in 1..=9 "stones below the ball"', 'param count: 4 in 1..=20 "pebbles"'));
    await reads(page, ".param:has(#param-count) .param-help", "pebbles");
    await reads(page, "#param-count", "4");
    assert.equal(await page.getAttribute("#param-count", "max"), "20");
    assert.equal(await page.evaluate(() => document.activeElement.id), "param-gap", "the focus stays");
    watched.edit(SCENE.replace(/param lift.*\n/, "").replace("ball(lift)", "ball([0, 0, 0])"));
    await page.waitForSelector("#param-lift", { state: "detached" });
    watched.edit("sphere(at: [0, 0, 0], r: 1)\nlight(at: [0, 0, 9])\ncamera(from: [0, 0, 5], at: [0, 0, 0])\n");
    await page.waitForSelector("#params", { state: "hidden" });
  }));

test("the arguments are copied", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open({ permissions: ["clipboard-read", "clipboard-write"] });
    await page.fill("#param-count", "7");
    await reads(page, "#set-line", "--set count=7");
    await page.click("#set-copy");
    await reads(page, "#set-copy", "Copied");
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), "--set count=7");
    // Where there is no clipboard, the text is selected.
    await page.evaluate(() => Object.defineProperty(navigator, "clipboard", { value: undefined }));
    await page.click("#set-copy");
    assert.equal(await page.evaluate(() => String(getSelection())), "--set count=7");
  }));

test("the keyboard reaches everything", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const reached = new Set();
    for (let i = 0; i < 40; i++) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement.id));
    }
    for (const id of ["view", "zoom-in", "zoom-out", "zoom-fit", "zoom-one", "save", "keys", "param-size", "param-tint", "param-title"]) {
      assert.ok(reached.has(id), `${id} of ${[...reached]}`);
    }
    await page.focus("#view");
    await page.keyboard.press("?");
    assert.equal(await page.isVisible("#help"), true);
    // The list of keys swallows the others.
    await page.keyboard.press("1");
    await page.keyboard.press("Escape");
    assert.equal(await page.isVisible("#help"), false);
    assert.notEqual(await zoom(page), 100);
    // A field that is typed in keeps its keys.
    await page.fill("#param-title", "");
    await page.focus("#param-title");
    await page.keyboard.type("c1?");
    await reads(page, "#param-title", "c1?");
    assert.equal(await page.isVisible("#help"), false);
  }));
