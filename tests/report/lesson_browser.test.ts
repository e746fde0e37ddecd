// Tests live lessons in Chromium from file://: sliders moved by a script against the program, accessibility, narrow
// screens, printing, export.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import puppeteer, { type Browser, type Page } from "puppeteer-core";
import { angleBetween, normalized } from "../../src/report/page/source/motion/algebra.ts";
import { embed } from "./embed.ts";
import { freeLesson, topLesson } from "./lesson_sample.ts";
import { emptyDocument, richDocument } from "./sample.ts";

const work = process.env.POLHODE_REPORT_WORK ?? "build/report";
const program = process.env.POLHODE_PROGRAM ?? "build/polhode";
const template = readFileSync(join(work, "page.html"), "utf8");
const axe = readFileSync(join(work, "node_modules/axe-core/axe.min.js"), "utf8");
const screenshots = join(work, "screenshots");
const folder = mkdtempSync(join(tmpdir(), "polhode-lesson-"));
let browser: Browser;
let address: string;
let rich: string;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  const write = (name: string, text: string): string => {
    writeFileSync(join(folder, name), text);
    return `file://${join(folder, name)}`;
  };
  address = write("lesson.html", embed(template, { ...emptyDocument(), folder: "Lessons", lessons: [freeLesson(), topLesson()], lesson_page: true }));
  rich = write("rich.html", embed(template, richDocument()));
  const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
  assert.ok(executablePath, "no Chromium: install it (Debian: chromium)");
  browser = await puppeteer.launch({ executablePath, headless: true, args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

async function open(url: string, options: { width?: number; dark?: boolean } = {}): Promise<{ page: Page; faults: string[] }> {
  const page = await browser.newPage();
  const faults: string[] = [];
  page.on("console", (message) => void (message.type() === "error" && faults.push(message.text())));
  page.on("pageerror", (fault) => faults.push(String(fault)));
  page.on("request", (request) => void (/^(file|data|blob):/.test(request.url()) || faults.push(`request: ${request.url()}`)));
  await page.setViewport({ width: options.width ?? 1280, height: 900 });
  if (options.dark !== undefined) await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: options.dark ? "dark" : "light" }]);
  await page.goto(url);
  await page.waitForSelector("html[data-ready]", { timeout: 60000 });
  await page.waitForSelector(".lesson[data-result]", { timeout: 60000 });
  return { page, faults };
}

interface Result {
  update: string;
  steps: number;
  duration: number;
  q: [number, number, number, number];
  error: number;
}
const resultOf = (page: Page): Promise<Result> => page.$eval(".lesson", (one) => JSON.parse((one as HTMLElement).dataset.result ?? "null") as Result);

/** Moves a slider like a user and waits for the new result. */
async function move(page: Page, quantity: string, position: number): Promise<void> {
  const before = await page.$eval(".lesson", (one) => (one as HTMLElement).dataset.result);
  await page.$eval(`input[data-quantity=${quantity}]`, (one, value) => {
    (one as HTMLInputElement).value = String(value);
    one.dispatchEvent(new Event("input", { bubbles: true }));
  }, position);
  await page.waitForFunction((old) => document.querySelector<HTMLElement>(".lesson")?.dataset.result !== old, { timeout: 20000 }, before);
}

test("sliders change the motion at once, to the program's numbers", async () => {
  const { page, faults } = await open(`${address}#lesson.update=gyroscopic_implicit`);
  assert.deepEqual(await page.$$eval("main > section", (all) => all.map((one) => one.id)), ["section-lessons"], "a lesson page has only lessons");
  const before = await resultOf(page);
  await move(page, "step", 150);
  await move(page, "angular_velocity_y", 110);
  await move(page, "moment_y", 100);
  const after = await resultOf(page);
  assert.equal(after.update, "gyroscopic_implicit");
  assert.ok(after.steps < before.steps && after.error > 0);
  // the page writes its address 150 ms after the first of several changes
  await page.waitForFunction(() => /lesson\.values=[^&]*moment_y/.test(location.hash), { timeout: 20000 });
  // the same scene by the program: I = (1, 2.5, 3), w = (1, 0.5, 1)
  const scene = join(folder, "scene.json");
  writeFileSync(scene, JSON.stringify({ name: "lesson", duration: after.duration, body: { mass: 1, inertia: [1, 2.5, 3] }, initial: { angular_velocity: [1, 0.5, 1] } }));
  assert.ok(existsSync(program), `${program} does not exist: build it, or set POLHODE_PROGRAM`);
  const lines = execFileSync(program, ["solve", scene, "--method", after.update, "--steps", String(after.steps), "--samples", String(after.steps)], { encoding: "utf8" }).trim().split("\n");
  const columns = (lines[0] ?? "").split(",");
  const last = (lines[lines.length - 1] ?? "").split(",").map(Number);
  const value = (name: string): number => last[columns.indexOf(name)] ?? NaN;
  const angle = angleBetween(after.q, normalized([value("qw"), value("qx"), value("qy"), value("qz")]));
  assert.ok(angle < 1e-12, `${angle} rad`);
  // a copied address restores the sliders
  const copy = await open(await page.evaluate(() => location.href));
  assert.deepEqual(await resultOf(copy.page), after);
  // and the button resets them
  await page.bringToFront();
  await page.$$eval(".lesson button", (all) => all.find((one) => one.textContent === "Reset the sliders")?.click());
  await page.waitForFunction((steps) => JSON.parse(document.querySelector<HTMLElement>(".lesson")?.dataset.result ?? "{}").steps === steps, { timeout: 20000 }, before.steps);
  assert.deepEqual([...faults, ...copy.faults], []);
  await page.close();
  await copy.page.close();
});

test("moments that no body has are refused with a message", async () => {
  const { page, faults } = await open(address);
  await page.$eval("input[data-quantity=moment_y]", (one) => {
    (one as HTMLInputElement).value = "200"; // 4 = 1 + 3
    one.dispatchEvent(new Event("input", { bubbles: true }));
  });
  assert.equal(await page.$eval(".lesson > .note", (one) => (one as HTMLElement).hidden), true);
  await page.$eval("input[data-quantity=moment_y]", (one) => {
    (one as HTMLInputElement).value = "60"; // 1.9 + 1 < 3
    one.dispatchEvent(new Event("input", { bubbles: true }));
  });
  await page.waitForFunction(() => /No rigid body/.test(document.querySelector(".lesson > .note:not([hidden])")?.textContent ?? ""), { timeout: 20000 });
  assert.deepEqual(faults, []);
  await page.close();
});

for (const dark of [false, true]) {
  for (const width of [1280, 390]) {
    test(`${dark ? "dark" : "light"}, ${width} px: accessible, and no wider than the screen`, async () => {
      const { page, faults } = await open(`${address}#lesson=spinning_top&lesson.motion_show=axes,ellipsoid,momentum,path&lesson.motion_time=2`, { width, dark });
      await new Promise((resolve) => setTimeout(resolve, 800));
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth), 0);
      await page.evaluate(axe);
      const violations = await page.evaluate(async () => {
        const { axe: runner } = window as unknown as { axe: { run(): Promise<{ violations: { id: string; nodes: { html: string; failureSummary?: string }[] }[] }> } };
        return (await runner.run()).violations.map((one) => `${one.id}: ${one.nodes.map((node) => `${node.html.slice(0, 160)} ${node.failureSummary ?? ""}`).join(" | ").slice(0, 600)}`);
      });
      assert.deepEqual(violations, []);
      assert.ok((await page.$$eval(".lesson-graph .curve", (all) => all.filter((one) => (one.getAttribute("d") ?? "").length > 100).length)) >= 6);
      await page.screenshot({ path: join(screenshots, `lesson_${dark ? "dark" : "light"}_${width}.png`), fullPage: true });
      assert.deepEqual(faults, []);
      await page.close();
    });
  }
}

test("axes, ellipsoid and path of a chosen point are drawn and removed", async () => {
  const { page, faults } = await open(`${address}#lesson.motion_time=3&lesson.motion_show=momentum`);
  const settle = (): Promise<unknown> => new Promise((resolve) => setTimeout(resolve, 600));
  const picture = (): Promise<string> => page.$eval(".motion-pane canvas", (one) => (one as HTMLCanvasElement).toDataURL());
  const toggle = async (text: string): Promise<void> => {
    await page.$$eval(".motion-toggles button", (all, text) => all.find((one) => one.textContent === text)?.click(), text);
    await settle();
  };
  const labels = (): Promise<(string | null)[]> => page.$$eval(".motion-pane:first-child .motion-label", (all) => all.map((one) => one.textContent));
  await settle();
  const plain = await picture();
  assert.deepEqual(await labels(), ["L"]);
  for (const name of ["Axes", "Ellipsoid", "Path"]) {
    await toggle(name);
    const shown = await picture();
    assert.notEqual(shown, plain, name);
    if (name === "Axes") assert.deepEqual(await labels(), ["L", "x", "y", "z"]);
    if (name === "Path") {
      await page.$$eval(".motion-controls label", (all) => {
        const select = all.find((one) => /Trace of/.test(one.textContent ?? ""))?.querySelector("select");
        if (select) select.value = "z";
        select?.dispatchEvent(new Event("change", { bubbles: true }));
      });
      await settle();
      assert.notEqual(await picture(), shown, "the path of another point");
    }
    await toggle(name);
    assert.equal(await picture(), plain, `${name} removed`);
  }
  assert.deepEqual(faults, []);
  await page.close();
});

test("saves a PNG of the panes, a GIF and a video", async () => {
  const { page, faults } = await open(`${address}#lesson.motion_speed=10`);
  const session = await page.createCDPSession();
  await session.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
  const saved = async (text: string, pattern: RegExp): Promise<Buffer> => {
    await page.$$eval(".motion-toggles button", (all, text) => all.find((one) => one.textContent === text)?.click(), text);
    for (let i = 0; i < 300; ++i) {
      await new Promise((resolve) => setTimeout(resolve, 100));
      const name = (await import("node:fs")).readdirSync(folder).find((one) => pattern.test(one));
      if (name !== undefined && readFileSync(join(folder, name)).length > 0) return readFileSync(join(folder, name));
    }
    throw new Error(`no file ${String(pattern)}`);
  };
  const picture = await saved("PNG", /^free_asymmetric.*\.png$/);
  assert.equal(picture.subarray(1, 4).toString(), "PNG");
  writeFileSync(join(screenshots, "lesson_saved.png"), picture);
  const animation = await saved("GIF", /^free_asymmetric.*\.gif$/);
  assert.equal(animation.subarray(0, 6).toString(), "GIF89a");
  assert.ok(animation.length > 20000, `${animation.length} bytes`);
  writeFileSync(join(screenshots, "lesson_saved.gif"), animation);
  const video = await saved("Video", /^free_asymmetric.*\.(webm|mp4)$/);
  // EBML header of WebM, or the box "ftyp" of MP4
  assert.ok(video.readUInt32BE(0) === 0x1a45dfa3 || video.subarray(4, 8).toString() === "ftyp");
  assert.ok(video.length > 2000, `${video.length} bytes`);
  assert.deepEqual(faults, []);
  await page.close();
});

test("prints all sections", async () => {
  const { page, faults } = await open(rich.concat("#section=lessons"));
  await page.emulateMediaType("print");
  await page.pdf({ path: join(folder, "print.pdf") });
  assert.equal(await page.$$eval(".body.waiting", (all) => all.length), 0, "every section is rendered");
  const hidden = await page.$$eval("main > section", (all) => all.filter((one) => one.getBoundingClientRect().height < 30).map((one) => one.id));
  assert.deepEqual(hidden, []);
  assert.ok(readFileSync(join(folder, "print.pdf")).length > 50000);
  assert.deepEqual(faults, []);
  await page.close();
});
