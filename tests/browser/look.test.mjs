// How it looks: nothing sticks out at any width, texts can be read in light and dark. Leaves screenshots for people to judge.

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { SCENE, SHOTS, finished, reads, seen, watching } from "./support.mjs";

const shoot = (page, name) => page.screenshot({ path: join(SHOTS, `${name}.png`) });

const BROKEN = SCENE.replace("sphere(at: at", "spheer(at: at");

/** Nothing is wider than the window. */
async function fits(page) {
  const [wide, room] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= room, `${wide} of ${room}`);
  const out = await page.evaluate(() =>
    [...document.querySelectorAll("button, input, select, .button, h1, h2, dd, #set-line")]
      .filter((e) => e.checkVisibility({ visibilityProperty: true }))
      .filter((e) => e.getBoundingClientRect().right > innerWidth + 0.5 || e.getBoundingClientRect().left < -0.5)
      .map((e) => e.id || e.textContent));
  assert.deepEqual(out, [], "nothing is cut off");
}

/** Texts stand out from what is behind them by WCAG's ratio for normal text, 4.5. */
async function readable(page) {
  const faint = await page.evaluate(() => {
    const canvas = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
    const rgba = (css) => {
      canvas.clearRect(0, 0, 1, 1);
      canvas.fillStyle = css;
      canvas.fillRect(0, 0, 1, 1);
      return [...canvas.getImageData(0, 0, 1, 1).data];
    };
    const light = ([r, g, b]) => {
      const [x, y, z] = [r, g, b].map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
      return 0.2126 * x + 0.7152 * y + 0.0722 * z;
    };
    const behind = (e) => {
      for (; e; e = e.parentElement) {
        const color = rgba(getComputedStyle(e).backgroundColor);
        if (color[3] > 230) return color;
      }
      return rgba("canvas");
    };
    const own = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    return [...document.querySelectorAll("body *")]
      .filter((e) => own(e) && !e.matches(":disabled, option, #live, dialog *") && e.checkVisibility({ visibilityProperty: true }))
      .map((e) => {
        const [a, b] = [light(rgba(getComputedStyle(e).color)), light(behind(e))].sort((x, y) => y - x);
        return [e.id || e.className || e.tagName, (a + 0.05) / (b + 0.05)];
      })
      .filter(([, ratio]) => ratio < 4.5);
  });
  assert.deepEqual(faint, []);
}

for (const colorScheme of ["light", "dark"]) {
  test(`${colorScheme}`, () =>
    watching(SCENE, async (watched) => {
      const page = await watched.open({ colorScheme });
      await page.mouse.move(350, 300);
      await reads(page, "#pixel-seen", /^sphere/);
      await fits(page);
      await readable(page);
      await shoot(page, colorScheme);
      watched.edit(BROKEN);
      await page.waitForSelector("#errors:not([hidden])");
      await fits(page);
      await readable(page);
      await shoot(page, `${colorScheme}-error`);
      watched.edit(SCENE.replace("#ff0000", "#3366cc"));
      await seen(page, "#3366cc");
      await finished(page);
      await page.keyboard.press("c");
      await page.waitForSelector("#wipe:not([hidden])");
      await seen(page, "#ff0000", [-0.05, 0]);
      await shoot(page, `${colorScheme}-wipe`);
      await page.keyboard.press("Escape");
      await page.keyboard.press("?");
      await shoot(page, `${colorScheme}-keys`);
    }));
}

test("on a phone", () =>
  watching(SCENE, async (watched) => {
    const phone = { viewport: { width: 360, height: 740 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
    const page = await watched.open(phone);
    await fits(page);
    await shoot(page, "phone");
    const top = () => page.evaluate(() => document.querySelector("#canvas").getBoundingClientRect().top);
    await page.evaluate(() => document.querySelector("#param-lift").scrollIntoView());
    assert.equal(await top(), 0, "the picture stays in sight");
    await shoot(page, "phone-below");
    await page.touchscreen.tap(180, 120);
    await reads(page, "#pixel-seen", /^sphere/);
    await shoot(page, "phone-pixel");
    await fits(page);
    watched.edit(BROKEN);
    await page.waitForSelector("#errors:not([hidden])");
    await fits(page);
    await shoot(page, "phone-error");
  }));

test("without motion where none is wanted", () =>
  watching(SCENE, async (watched) => {
    const page = await watched.open({ reducedMotion: "reduce" });
    assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector("#canvas")).transitionDuration), "0s");
  }));
