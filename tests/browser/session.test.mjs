// A session as it is meant: the editor on one side, the page on the other.

import assert from "node:assert/strict";
import { test } from "node:test";
import { SCENE, drag, finished, reads, seen, watching } from "./support.mjs";

test("the page loads and shows the picture", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    await seen(page, "#ff0000");
    assert.equal(await page.title(), "ball.scene – rtdsl");
    await reads(page, "#file", "ball.scene");
    await reads(page, "#report-rows", /320 × 240 pixels.*rays.*tiles.*kB/s);
    assert.equal(await page.isVisible("#badge"), false);
    assert.equal(await page.isVisible("#errors"), false);
    assert.equal(await page.isVisible("#banner"), false);
  }));

test("a saved edit shows", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    await seen(page, "#ff0000");
    watched.edit(SCENE.replace("#ff0000", "#00ff00"));
    await seen(page, "#00ff00");
    // Another size: the picture fits again.
    watched.edit(SCENE.replace("#ff0000", "#0000ff").replace("[320, 240]", "[96, 128]"));
    await seen(page, "#0000ff");
    await reads(page, "#report-rows", /96 × 128 pixels/);
  }));

test("an error lies over the last good picture, and goes", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    watched.edit(SCENE.replace("sphere(at: at", "spheer(at: at").replace("#ff0000", "#00ff00"));
    await page.waitForSelector("#errors:not([hidden])");
    await reads(page, "#errors-title", /^Error at ball\.scene:13:\d+$/);
    await reads(page, "#errors-text", /`spheer` is unknown[^]*13 \|[^]*\^\^\^\^\^\^ did you mean `sphere`\?/);
    await reads(page, "#badge", /earlier text/);
    await reads(page, "#live", /spheer/);
    await seen(page, "#ff0000");
    // It can be put aside, and taken up again.
    await page.keyboard.press("e");
    assert.equal(await page.isVisible("#errors-text"), false);
    await page.click("#errors-fold");
    assert.equal(await page.isVisible("#errors-text"), true);

    watched.edit(SCENE.replace("#ff0000", "#0000ff"));
    await seen(page, "#0000ff");
    assert.equal(await page.isVisible("#errors"), false);
    assert.equal(await page.isVisible("#badge"), false);
  }));

test("a scene that is wrong from the start shows why, and then its picture", () =>
  watching("sphere(", async (watched) => {
    const page = await watched.open({}, false);
    await page.waitForSelector("#errors:not([hidden])");
    assert.equal(await page.isVisible("#badge"), false, "there is no earlier picture");
    watched.edit(SCENE);
    await seen(page, "#ff0000");
  }));

test("warnings are discreet", () =>
  watching("background(#00ff00)\nrender(size: [320, 240])\n", async (watched) => {
    const page = await watched.open();
    await seen(page, "#00ff00");
    await reads(page, "#warnings summary", "1 warning");
    await reads(page, "#warnings pre", /there is nothing to show/);
    assert.equal(await page.isVisible("#errors"), false);
    watched.edit(SCENE);
    await seen(page, "#ff0000");
    assert.equal(await page.isVisible("#warnings"), false);
  }));

test("a slider is moved, and the picture follows", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    // Beside the ball is the background.
    await seen(page, "#000000", [0.2, 0]);
    const shares = Array.from({ length: 30 }, (_, i) => i / 29);
    await drag(page, "size", shares);
    await reads(page, "#param-size", "2");
    await seen(page, "#ff0000", [0.2, 0]);
    await finished(page);
    await reads(page, "#param-size", "2");
    await reads(page, "#set-line", "--set size=2");
    await page.click(".param:has(#param-size) .param-reset");
    await seen(page, "#000000", [0.2, 0]);
    await reads(page, "#param-size", "1");
    await reads(page, "#set-line", "");
  }));

test("two pages are in step", () =>
  watching(SCENE, async (watched) => {
    const [one, two] = [await watched.open(), await watched.open()];
    await one.fill("#param-tint", "#00ff00");
    for (const page of [one, two]) {
      await seen(page, "#00ff00");
      await reads(page, "#param-tint", "#00ff00");
      await reads(page, "#set-line", "--set 'tint=#00ff00'");
    }
    await drag(two, "size", [0.5, 1]);
    for (const page of [one, two]) {
      await seen(page, "#00ff00", [0.2, 0]);
      await reads(page, "#param-size", "2");
    }
    await one.click("#reset-all");
    for (const page of [one, two]) {
      await seen(page, "#ff0000");
      await reads(page, "#param-size", "1");
    }
  }));

test("the connection comes back after a restart", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    await page.fill("#param-tint", "#00ff00");
    await seen(page, "#00ff00");
    assert.equal(await watched.stop(), 0, "it ends well with an open page");
    await page.waitForSelector("#banner:not([hidden])");
    await seen(page, "#00ff00");

    watched.edit(SCENE.replace("#ff0000", "#0000ff"));
    await watched.start();
    await page.waitForSelector("#banner", { state: "hidden" });
    // The new run knows nothing of the old one's parameters.
    await seen(page, "#0000ff");
    await reads(page, "#param-tint", "#0000ff");
    await reads(page, "#set-line", "");
    await page.fill("#param-tint", "#ffffff");
    await seen(page, "#ffffff");
  }));

test("a name that was made to point here is refused", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open();
    const foreign = await page.context().newPage();
    const answer = await foreign.goto(watched.url.replace("127.0.0.1", "foreign.test"));
    assert.equal(answer.status(), 403);
    const local = await foreign.goto(watched.url.replace("127.0.0.1", "localhost"));
    assert.equal(local.status(), 200);
    // Another site's page can neither set nor read.
    await foreign.goto("data:text/html,<p>elsewhere");
    const tried = await foreign.evaluate(async (url) => {
      const outcome = async (options, path) => {
        const answer = await fetch(url + path, options).catch(() => null);
        return answer ? answer.type : "failed";
      };
      const headers = { "Content-Type": "application/json" };
      return [
        await outcome({}, "explain?x=1&y=1"),
        await outcome({ method: "POST", headers, body: '{"tint": "#00ff00"}' }, "set"),
        await outcome({ method: "POST", mode: "no-cors", body: '{"tint": "#00ff00"}' }, "set"),
      ];
    }, watched.url);
    assert.deepEqual(tried.slice(0, 2), ["failed", "failed"]);
    await reads(page, "#set-line", "");
    await seen(page, "#ff0000");
  }));
