// Tests the motion view in Chromium from file://: the drawing, pointer and keyboard control, the state in the address,
// remarks on methods, missing WebGL, a lost context, and that the view is idle and leaks nothing when unused.

import assert from "node:assert/strict";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import puppeteer, { type Browser, type Page } from "puppeteer-core";
import { embed } from "./embed.ts";
import { motionDocument } from "./motion_sample.ts";

const work = process.env.POLHODE_REPORT_WORK ?? "build/report";
const template = readFileSync(join(work, "page.html"), "utf8");
const axe = readFileSync(join(work, "node_modules/axe-core/axe.min.js"), "utf8");
const screenshots = join(work, "screenshots");
const folder = mkdtempSync(join(tmpdir(), "polhode-motion-"));
const file = join(folder, "motions.html");
const chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const software = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

let browser: Browser;
const launch = (more: string[]): Promise<Browser> => {
  assert.ok(chromium, "no Chromium: install it (Debian: chromium)");
  return puppeteer.launch({ executablePath: chromium, headless: true, args: ["--no-sandbox", "--disable-dev-shm-usage", ...more] });
};

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  writeFileSync(file, embed(template, motionDocument()));
  browser = await launch(software);
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

const pause = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));

async function open(fragment: string, options: { width?: number; dark?: boolean; reduced?: boolean; in?: Browser } = {}): Promise<{ page: Page; faults: string[] }> {
  const page = await (options.in ?? browser).newPage();
  const faults: string[] = [];
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (fault) => faults.push(`thrown: ${fault instanceof Error ? fault.message : String(fault)}`));
  await page.setViewport({ width: options.width ?? 1280, height: 900 });
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: options.dark === true ? "dark" : "light" }, { name: "prefers-reduced-motion", value: options.reduced === true ? "reduce" : "no-preference" },
  ]);
  await page.goto(`file://${file}#section=motion&${fragment}`);
  await page.waitForSelector(".motion-view[data-drawn]", { timeout: 60000 });
  await settled(page);
  return { page, faults };
}

/** Waits until a change is drawn and written to the address, which happens 150 ms later. */
const settled = (page: Page): Promise<void> => page.evaluate(async () => {
  const frame = (): Promise<number> => new Promise((resolve) => requestAnimationFrame(resolve));
  for (let i = 0; i < 3; ++i) await frame();
  await new Promise((resolve) => setTimeout(resolve, 250));
  for (let i = 0; i < 2; ++i) await frame();
});

const drawn = (page: Page): Promise<number> => page.$eval(".motion-view", (view) => Number((view as HTMLElement).dataset.drawn));
const textOf = (page: Page, selector: string): Promise<string> => page.$$eval(selector, (all) => all.map((one) => one.textContent ?? "").join("\n"));

/** Waits until playback has started or stopped. */
const playing = async (page: Page, wanted: boolean): Promise<void> => {
  await page.waitForFunction((text) => document.querySelector(".motion-time .play")?.textContent === text, { timeout: 60000 }, wanted ? "Pause" : "Play");
};

/** Fraction of a pane's pixels that differ from its background. */
const filled = (page: Page, pane: number): Promise<number> => page.evaluate((at) => {
  const canvas = document.querySelectorAll<HTMLCanvasElement>(".motion-pane canvas")[at];
  const context = canvas?.getContext("2d");
  if (canvas === undefined || context === null || context === undefined) return -1;
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (Math.abs((data[i] ?? 0) - (data[0] ?? 0)) + Math.abs((data[i + 1] ?? 0) - (data[1] ?? 0)) + Math.abs((data[i + 2] ?? 0) - (data[2] ?? 0)) > 24) ++count;
  }
  return count / (data.length / 4);
}, pane);

async function violations(page: Page): Promise<string[]> {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const { axe: runner } = window as unknown as { axe: { run(context: object, options: object): Promise<{ violations: { id: string; help: string; nodes: { html: string; failureSummary?: string }[] }[] }> } };
    const result = await runner.run({ include: [[".motion-view"]] }, { resultTypes: ["violations"] });
    return result.violations.map((one) => `${one.id}: ${one.help}: ${one.nodes.slice(0, 3).map((node) => `${node.html.slice(0, 160)} ${(node.failureSummary ?? "").slice(0, 300)}`).join(" | ")}`);
  });
}

test("draws every motion in both layouts and themes, on wide and narrow screens, without overflow", async () => {
  for (const [width, dark] of [[1440, false], [400, true]] as const) {
    for (const scene of ["t_handle", "lagrange_top", "double_pendulum", "every_shape", "small_and_far", "sliding_ball", "slider"]) {
      for (const layout of ["side", "overlay"]) {
        const { page, faults } = await open(`scene=${scene}&motion_layout=${layout}&motion_show=angular_velocity,momentum,trail`, { width, dark });
        // go to a time within the motion
        await page.$eval(".motion-time input", (one) => {
          const slider = one as HTMLInputElement;
          slider.value = String(0.3 * Number(slider.max));
          slider.dispatchEvent(new Event("input"));
          slider.dispatchEvent(new Event("change"));
        });
        await settled(page);
        const panes = await page.$$eval(".motion-pane", (all) => all.length);
        assert.ok(panes >= 1);
        for (let pane = 0; pane < panes; ++pane) {
          const share = await filled(page, pane);
          assert.ok(share > 0.008 && share < 0.7, `${scene}, ${layout}, ${width}: ${share} of pane ${pane} is filled`);
        }
        assert.ok((await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth)) <= 0, `${scene} at ${width}`);
        const view = await page.$(".motion-view");
        await view?.screenshot({ path: join(screenshots, `motion_${scene}_${layout}_${width}.png`) as `${string}.png` });
        assert.deepEqual(faults, []);
        await page.close();
      }
    }
  }
});

test("is accessible in both themes", async () => {
  for (const dark of [false, true]) {
    for (const scene of ["t_handle", "double_pendulum", "sliding_ball", "slider", "unknown"]) {
      const { page, faults } = await open(`scene=${scene}`, { dark });
      // with all tables open
      await page.$$eval(".motion-table", (all) => all.forEach((one) => ((one as HTMLDetailsElement).open = true)));
      await settled(page);
      assert.deepEqual(await violations(page), []);
      assert.deepEqual(faults, []);
      await page.close();
    }
  }
});

test("plays only on request, at the chosen speed, to the end; pauses when out of view", async () => {
  const { page, faults } = await open("scene=t_handle", { reduced: true });
  await pause(700);
  assert.equal(await drawn(page), 0);
  // nothing is redrawn without a change
  const frames = await page.evaluate(async () => {
    let count = 0;
    const observer = new MutationObserver(() => ++count);
    observer.observe(document.querySelector(".motion-view") as Element, { attributes: true, childList: true, subtree: true });
    await new Promise((resolve) => setTimeout(resolve, 2500));
    observer.disconnect();
    return count;
  });
  // at most the text for screen readers changes
  assert.ok(frames <= 2, `${frames} changes while nothing happens`);
  const started = performance.now();
  await page.click(".motion-time .play");
  await pause(1500);
  assert.equal(await textOf(page, ".motion-time .play"), "Pause");
  await page.click(".motion-time .play");
  const played = (performance.now() - started) / 1000;
  await settled(page);
  const reached = await drawn(page);
  // long frames of slow machines count as 0.1 s each
  assert.ok(reached > 0.2 && reached < played + 0.7, `${reached} s after ${played} s`);
  assert.match(page.url(), /motion_time=/);
  await page.click(".motion-time .play");
  await playing(page, true);
  await page.evaluate(() => {
    const gap = document.createElement("div");
    gap.style.height = "4000px";
    document.body.prepend(gap);
    window.scrollTo(0, 0);
  });
  await playing(page, false);
  await page.evaluate(() => (document.body.firstElementChild as HTMLElement).remove());
  await page.select(".motion-time select", "10");
  await page.$eval(".motion-view", (view) => view.scrollIntoView());
  await page.click(".motion-time .play");
  await playing(page, true);
  await playing(page, false);
  assert.equal(await drawn(page), 10.47);
  assert.deepEqual(faults, []);
  await page.close();
});

test("keys move the slider, step and play", async () => {
  const { page } = await open("scene=t_handle&motion_time=2");
  assert.equal(await drawn(page), 2);
  await page.focus(".motion-time input");
  await page.keyboard.press(".");
  await settled(page);
  assert.ok(Math.abs((await drawn(page)) - (2 + 1 / 30)) < 1e-4);
  await page.keyboard.press(",");
  await page.keyboard.press(",");
  await settled(page);
  assert.ok(Math.abs((await drawn(page)) - (2 - 1 / 30)) < 1e-4);
  await page.keyboard.press("End");
  await settled(page);
  assert.ok(Math.abs((await drawn(page)) - 10.47) < 1e-3);
  await page.keyboard.press("Home");
  await page.keyboard.press(" ");
  await playing(page, true);
  await page.keyboard.press(" ");
  await playing(page, false);
  await page.close();
});

test("dragging and buttons rotate the view, and the address stores it", async () => {
  const { page } = await open("scene=t_handle");
  const picture = (): Promise<string> => page.$eval(".motion-pane canvas", (canvas) => (canvas as HTMLCanvasElement).toDataURL());
  const first = await picture();
  const box = await (await page.$(".motion-pane canvas"))?.boundingBox();
  assert.ok(box);
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 80, box.y + box.height / 2 - 30, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const dragged = await picture();
  assert.notEqual(dragged, first);
  assert.match(decodeURIComponent(page.url()), /motion_view=-?[\d.]+,-?[\d.]+,1\.00/);
  await page.click('.motion-turn button[title="Zoom in"]');
  await settled(page);
  assert.notEqual(await picture(), dragged);
  await page.click('.motion-turn button[title="Reset the view"]');
  await settled(page);
  assert.equal(await picture(), first);
  assert.doesNotMatch(page.url(), /motion_view/);
  await page.close();
});

test("the address restores scene, methods, layout, time and arrows", async () => {
  const { page } = await open("scene=t_handle&motion_methods=rk4,cvode_adams&motion_layout=overlay&motion_time=1.25&motion_show=trail");
  assert.equal(await drawn(page), 1.25);
  assert.equal(await page.$$eval(".motion-pane", (all) => all.length), 1);
  const names = await textOf(page, ".motion-legend .name");
  assert.match(names, /^truth\nrk4, step .*\ncvode_adams, tolerance 1e-10$/);
  assert.deepEqual(await page.$$eval('.motion-toggles button[aria-pressed="true"]', (all) => all.map((one) => one.textContent)), ["Trail"]);
  // changes in the page are written to the address
  await page.select(".motion-controls .choice:not([hidden]) select", "article_as_written");
  await settled(page);
  assert.match(page.url(), /motion_methods=article_as_written,cvode_adams/);
  await page.evaluate(() => (location.hash = "#section=motion&scene=lagrange_top&motion_time=3"));
  await page.waitForFunction(() => (document.querySelector(".motion-view") as HTMLElement).dataset.drawn === "3.00000");
  assert.match(await textOf(page, ".motion-remarks"), /Gravity: 9\.81 m\/s² along −z/);
  // unknown methods are ignored
  await page.evaluate(() => (location.hash = "#section=motion&scene=lagrange_top&motion_methods=no_such,rk4&motion_time=nonsense&motion_view=a,b,c&motion_body=none"));
  await settled(page);
  assert.equal(await page.$$eval(".motion-pane", (all) => all.length), 2);
  assert.equal(await drawn(page), 0);
  await page.close();
});

test("reports motions that are not drawn, or not drawn exactly", async () => {
  const { page } = await open("scene=t_handle&motion_methods=cvode_adams,odeint_fehlberg78,radau&motion_time=9");
  const said = await textOf(page, ".motion-remarks");
  assert.match(said, /cvode_adams is within [\d.e-]+\srad of the truth and is drawn as the truth\./);
  assert.match(said, /odeint_fehlberg78 diverged after 6\.28 s and does not move from then on: the energy is beyond all bounds\./);
  assert.match(said, /radau failed: only motion under loads; there is no motion to draw\./);
  assert.match(said, /Interpolated between keyframes to within 1\.9\s*mrad\./);
  assert.match(said, /Truth: Jacobi's elliptic functions; error bound 1\.0e-17\./);
  assert.match(said, /Only the first 10\.5\s*s of the scene's 20\s*s are shown\./);
  assert.match(await textOf(page, ".motion-ended:not([hidden])"), /ended at 6\.28 s\n.*no motion/);
  assert.match(await textOf(page, ".motion-now"), /odeint_fehlberg78 ended/);
  assert.match((await page.$eval(".motion-pane canvas", (one) => one.getAttribute("aria-label"))) ?? "", /t_handle, truth: At 9\.00 s/);
  const other = await open("scene=unknown");
  assert.match(await textOf(other.page, ".motion-view .note"), /No motion is available for unknown; showing t_handle\./);
  await other.page.close();
  await page.close();
});

test("a click on the errors sets the time", async () => {
  const { page } = await open("scene=t_handle");
  const plot = await page.$(".motion-errors");
  await plot?.scrollIntoView();
  const box = await plot?.boundingBox();
  assert.ok(box);
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.4);
  await settled(page);
  const at = await drawn(page);
  assert.ok(at > 3.5 && at < 6, `${at}`);
  assert.match((await page.$eval(".motion-errors", (one) => one.getAttribute("aria-label"))) ?? "", /article_as_written [\d.]+ rad/);
  await page.close();
});

test("modes, events and contacts follow the time, by pointer and by keys", async () => {
  const { page, faults } = await open("scene=sliding_ball&motion_methods=-&motion_time=0.2", { width: 390 });
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth)) <= 0);
  assert.match(await textOf(page, ".motion-now"), /At 0\.200 s: lane sliding/);
  const value = (figure: number, row: number): Promise<string> => page.evaluate(([i, k]) =>
    document.querySelectorAll(".motion-plots figure:not([hidden])")[i ?? 0]?.querySelectorAll(".value")[k ?? 0]?.textContent ?? "", [figure, row]);
  // forces, |F|/(mu N) and slip u - 7/2 mu g t
  assert.deepEqual([await value(0, 0), await value(0, 1), await value(1, 0), await value(2, 0)], ["19.6 N", "4.9 N", "1", "1.78 m/s"]);
  const labels = (): Promise<string[]> => page.$$eval(".motion-label", (all) => all.map((one) => one.textContent ?? "").filter((text) => "NFu".includes(text)).sort());
  assert.deepEqual(await labels(), ["F", "N", "u"]);
  // the next event is the end of the slip, after which the ball rolls without friction
  await page.focus(".motion-time input");
  await page.keyboard.press("]");
  await settled(page);
  assert.ok(Math.abs((await drawn(page)) - 7 / 17.15) < 1e-5);
  assert.match(await textOf(page, ".motion-now"), /lane rolling/);
  assert.deepEqual([await value(0, 1), await value(1, 0), await value(2, 0)], ["0 N", "0", "0 m/s"]);
  assert.deepEqual(await labels(), ["N"]);
  assert.match((await page.$eval(".motion-strip", (one) => one.getAttribute("aria-label"))) ?? "", /1 contact or joint, with 1 event\. At 0\.408 s: lane rolling/);
  await page.click(".motion-toggles button[aria-label^='Contact points']");
  await settled(page);
  assert.deepEqual(await labels(), []);
  assert.match(decodeURIComponent(page.url()), /motion_show=angular_velocity(&|$)/);
  assert.deepEqual(faults, []);
  await page.close();
  const joints = await open("scene=slider&motion_time=0");
  await joints.page.click(".motion-time button[aria-label^='Next event']");
  await settled(joints.page);
  assert.equal(await drawn(joints.page), 0.5);
  // a click near an event goes to its time
  const box = await (await joints.page.$(".motion-strip"))?.boundingBox();
  assert.ok(box);
  await joints.page.mouse.click(box.x + 14 + ((box.width - 28) * 3.5) / 8 + 3, box.y + 34);
  await settled(joints.page);
  assert.equal(await drawn(joints.page), 3.5);
  assert.equal(await joints.page.$$eval(".motion-plots .motion-limit", (all) => all.length), 2);
  assert.match(await textOf(joints.page, ".motion-modes figcaption"), /The last 2 of 6 events are omitted/);
  // the table of events is filled when it is opened, and its buttons set the time
  assert.equal(await joints.page.$$eval(".motion-table tbody tr", (all) => all.length), 0);
  await joints.page.click(".motion-table summary");
  await joints.page.waitForSelector(".motion-table tbody tr:nth-child(4)");
  assert.match(await textOf(joints.page, ".motion-table tbody tr:nth-child(1)"), /^0\.5railimpact-2\sN s$/);
  await joints.page.focus(".motion-table tbody tr:nth-child(2) button");
  await joints.page.keyboard.press("Enter");
  await settled(joints.page);
  assert.equal(await drawn(joints.page), 1.5);
  assert.match(await textOf(joints.page, ".motion-remarks"), /Limits are shown as lines/);
  assert.deepEqual(joints.faults, []);
  await joints.page.close();
});

test("draws wireframes and a message without WebGL, and everything else", async () => {
  const bare = await launch(["--disable-gpu", "--disable-3d-apis"]);
  try {
    const { page } = await open("scene=double_pendulum&motion_time=2", { in: bare });
    assert.match(await textOf(page, ".motion-view .fault:not([hidden])"), /no WebGL/);
    const share = await filled(page, 0);
    assert.ok(share > 0.002, `${share} of the pane`);
    assert.equal(await page.$$eval(".motion-errors .motion-curve", (all) => all.length), 2);
    await page.focus(".motion-time input");
    await page.keyboard.press(".");
    await settled(page);
    assert.ok((await drawn(page)) > 2);
    assert.match(await textOf(page, ".motion-now"), /rk4 error [\d.]+\srad/);
  } finally {
    await bare.close();
  }
});

test("reports a lost context and redraws when it is restored; changing scenes leaks no buffers", async () => {
  const { page, faults } = await open("scene=t_handle&motion_time=1");
  // three.js requests its context once; the hook stores it
  await page.close();
  const kept = await browser.newPage();
  kept.on("pageerror", (fault) => faults.push(String(fault)));
  await kept.evaluateOnNewDocument(() => {
    const original = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
      const context = (original as (...all: unknown[]) => unknown).call(this, kind, ...rest);
      if (kind === "webgl2" && context !== null) Object.assign(window, { keptContext: context });
      return context;
    } as typeof original;
  });
  await kept.setViewport({ width: 1280, height: 900 });
  await kept.goto(`file://${file}#section=motion&scene=t_handle&motion_time=1`);
  await kept.waitForSelector(".motion-view[data-drawn]");
  await kept.evaluate(() => {
    const { keptContext } = window as unknown as { keptContext: WebGL2RenderingContext };
    const lose = keptContext.getExtension("WEBGL_lose_context");
    Object.assign(window, { lose });
    lose?.loseContext();
  });
  await settled(kept);
  assert.match(await textOf(kept, ".motion-view .fault:not([hidden])"), /released the WebGL context/);
  await kept.evaluate(() => (window as unknown as { lose: WEBGL_lose_context }).lose.restoreContext());
  await pause(1000);
  assert.equal(await textOf(kept, ".motion-view .fault:not([hidden])"), "");
  assert.ok((await filled(kept, 0)) > 0.01);
  // counts buffers created and deleted over many changes of scene
  await kept.evaluate(() => {
    const { keptContext: gl } = window as unknown as { keptContext: WebGL2RenderingContext };
    const count = { buffers: 0 };
    const [make, release] = [gl.createBuffer.bind(gl), gl.deleteBuffer.bind(gl)];
    gl.createBuffer = () => (++count.buffers, make());
    gl.deleteBuffer = (buffer) => (buffer !== null && --count.buffers, release(buffer));
    Object.assign(window, { count });
  });
  const buffers = async (): Promise<number> => {
    for (const scene of ["lagrange_top", "double_pendulum", "t_handle"]) {
      await kept.evaluate((name) => (location.hash = `#section=motion&scene=${name}&motion_show=trail&motion_time=1`), scene);
      await settled(kept);
    }
    return kept.evaluate(() => (window as unknown as { count: { buffers: number } }).count.buffers);
  };
  const after = [await buffers(), await buffers(), await buffers()];
  assert.equal(after[1], after[2], `buffers alive: ${after.join(", ")}`);
  assert.deepEqual(faults, []);
  await kept.close();
});
