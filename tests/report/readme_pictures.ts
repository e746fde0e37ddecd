// Takes the pictures of README from a page of `polhode report`:  node readme_pictures.cjs PAGE OUTPUT SCENE METHOD
// report.png shows the findings and the work-precision diagram, SCENE.gif the truth beside a method over two flips. The
// URL fragment sets the time of each frame.

import { existsSync, mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { gunzipSync } from "node:zlib";
import { applyPalette, GIFEncoder, quantize, type Palette } from "gifenc";
import puppeteer, { type Browser, type Page } from "puppeteer-core";
import type { Motion, ReportData } from "../../src/report/page/source/data.ts";
import { flips } from "./motion_flips.ts";
import { type Picture, readPng, writePng } from "./motion_png.ts";

class Fault extends Error {}

const frames = 84;
const delay = 60; // ms per frame
const colors = 40;

function documentOf(page: string): ReportData {
  const found = /<script id="polhode-data"[^>]*>([^<]*)<\/script>/.exec(readFileSync(page, "utf8"));
  if (found?.[1] === undefined || found[1] === "") throw new Fault(`${page} contains no report data; create it with \`polhode report DIR\``);
  try {
    return JSON.parse(gunzipSync(Buffer.from(found[1], "base64")).toString("utf8")) as ReportData;
  } catch {
    throw new Fault(`${page}: cannot read its data; create it again with \`polhode report DIR\``);
  }
}

/** The scene of this name, or a variation of it, with a motion by this method. */
function shownBy(data: ReportData, scene: string, method: string): { name: string; motion: Motion } {
  const of = data.scenes.filter((one) => one.motion !== null && (one.name === scene || one.name.startsWith(`${scene}{`)));
  for (const one of of) {
    const motion = data.motions[one.motion ?? -1];
    if (motion?.methods.some((run) => run.label === method && run.track !== null) === true) return { name: one.name, motion };
  }
  const methods = of.flatMap((one) => data.motions[one.motion ?? -1]?.methods.filter((run) => run.track !== null).map((run) => run.label) ?? []);
  throw new Fault(of.length === 0
    ? `the page has no motion of ${scene}; report a directory with results for it`
    : `the page has no motion of ${scene} with ${method}; report a directory with results for it, or choose ${[...new Set(methods)].slice(0, 8).join(", ") || "another scene"}`);
}

const pause = (milliseconds: number): Promise<void> => new Promise((done) => setTimeout(done, milliseconds));

async function open(browser: Browser, page: string, fragment: string, width: number, height: number): Promise<Page> {
  const tab = await browser.newPage();
  await tab.setViewport({ width, height });
  await tab.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: "reduce" }]);
  await tab.goto(`${pathToFileURL(page).href}#theme=light&${fragment}`);
  await tab.waitForSelector("html[data-ready]", { timeout: 120000 });
  if ((await tab.$eval("html", (one) => one.dataset.ready)) !== "yes") throw new Fault(`${page} cannot be shown: ${await tab.$eval("#content", (one) => one.textContent ?? "")}`);
  return tab;
}

function write(file: string, bytes: Uint8Array): void {
  writeFileSync(`${file}.part`, bytes);
  renameSync(`${file}.part`, file);
  process.stdout.write(`${file}: ${Math.round(bytes.length / 1000)} kB\n`);
}

/** Takes a picture of the findings and the work-precision diagram. */
async function overviewPicture(browser: Browser, page: string): Promise<Uint8Array> {
  const tab = await open(browser, page, "section=work-precision", 1280, 900);
  if ((await tab.$("#section-work-precision")) === null) throw new Fault(`${page} has no work-precision diagram; report a directory with results of a sweep`);
  await tab.addStyleTag({
    content: `main > section:not(#section-overview):not(#section-work-precision) { display: none }
      #section-overview .body > :not(.lead, .cards) { display: none }
      .bar { position: static } nav { visibility: hidden }`,
  });
  await tab.evaluate(() => document.querySelector("#section-work-precision")?.scrollIntoView());
  await tab.waitForSelector("#section-work-precision .plot .main-svg", { timeout: 120000 });
  await pause(1500);
  await tab.evaluate(() => window.scrollTo(0, 0));
  await pause(300);
  const clip = await tab.evaluate(() => {
    const box = (selector: string): DOMRect | undefined => document.querySelector(selector)?.getBoundingClientRect();
    const plot = box("#section-work-precision .with-legend") ?? box("#section-work-precision .plot");
    const main = box("main");
    return { x: main?.x ?? 0, y: main?.y ?? 0, width: main?.width ?? 0, height: (plot?.bottom ?? 0) - (main?.y ?? 0) + 12 };
  });
  const picture = readPng(await tab.screenshot({ clip, captureBeyondViewport: true }));
  await tab.close();
  return writePng(picture);
}

/** GIF with a global palette; unchanged pixels are transparent. */
function animation(pictures: readonly Picture[]): Uint8Array {
  const [first] = pictures;
  if (first === undefined) throw new Fault("no frames to encode");
  const { width, height } = first;
  // one palette from a sample of the frames
  const some = pictures.filter((_, i) => i % 12 === 0);
  const sample = new Uint8Array(some.reduce((sum, one) => sum + one.rgba.length, 0));
  some.reduce((at, one) => (sample.set(one.rgba, at), at + one.rgba.length), 0);
  const ground = [first.rgba[0] ?? 255, first.rgba[1] ?? 255, first.rgba[2] ?? 255];
  const palette: Palette = [ground, ...quantize(sample, colors)];
  const transparentIndex = palette.length;
  const gif = GIFEncoder();
  let before: Uint8Array | null = null;
  pictures.forEach((picture, i) => {
    const index = applyPalette(picture.rgba, palette);
    const last = before;
    const shown = last === null ? index : index.map((color, at) => (color === last[at] ? transparentIndex : color));
    gif.writeFrame(shown, width, height, {
      ...(i === 0 ? { palette: [...palette, ground], repeat: 0 } : { transparent: true, transparentIndex }),
      // pause at the end
      delay: i === pictures.length - 1 ? 1200 : delay, dispose: 1,
    });
    before = index;
  });
  gif.finish();
  return gif.bytes();
}

async function motionPicture(browser: Browser, page: string, data: ReportData, scene: string, method: string): Promise<Uint8Array> {
  const { name, motion } = shownBy(data, scene, method);
  const [first, second] = flips(motion);
  const [begin, end] = first === undefined || second === undefined ? [0, motion.duration] : [0, Math.min(motion.duration, second + (second - first) / 2)];
  const state = (t: number): string => `section=motion&scene=${encodeURIComponent(name)}&motion_methods=${encodeURIComponent(method)}&motion_layout=side&motion_show=momentum&motion_view=35,20,1.05&motion_time=${t}`;
  const tab = await open(browser, page, state(begin), 600, 620);
  await tab.waitForSelector(".motion-view[data-drawn]", { timeout: 120000 });
  await tab.addStyleTag({ content: ".bar, nav, .motion-turn, main > section:not(#section-motion) { display: none !important }" });
  const fault = await tab.$eval(".motion-view .fault", (one) => (one as HTMLElement).hidden ? "" : one.textContent ?? "");
  if (fault !== "") process.stderr.write(`readme_pictures: ${fault}\n`);
  const stage = await tab.$(".motion-panes");
  if (stage === null) throw new Fault(`${page} has no motion view; create it again with \`polhode report DIR\``);
  const pictures: Picture[] = [];
  for (let i = 0; i < frames; ++i) {
    const t = Number((begin + ((end - begin) * i) / (frames - 1)).toPrecision(6));
    await tab.evaluate((fragment) => (location.hash = fragment), `#theme=light&${state(t)}`);
    await tab.waitForFunction((wanted) => {
      const drawn = document.querySelector<HTMLElement>(".motion-view")?.dataset.drawn;
      return drawn !== undefined && Math.abs(Number(drawn) - wanted) <= 2e-5 * Math.max(1e-30, Math.abs(wanted));
    }, { timeout: 60000 }, t);
    pictures.push(readPng(await stage.screenshot()));
  }
  await tab.close();
  return animation(pictures);
}

async function main(): Promise<void> {
  const [page = "", output = "", scene = "", method = "", chromium = ""] = process.argv.slice(2);
  if (!existsSync(page)) throw new Fault(`${page} does not exist; create it with \`polhode report DIR\`, or name another page with --page`);
  const data = documentOf(page);
  shownBy(data, scene, method);
  mkdirSync(output, { recursive: true });
  const browser = await puppeteer.launch({ executablePath: chromium, headless: true, args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
  try {
    // nothing is written unless both pictures succeed
    const overview = await overviewPicture(browser, resolve(page));
    const moving = await motionPicture(browser, resolve(page), data, scene, method);
    write(join(output, "report.png"), overview);
    write(join(output, `${scene.replace(/[^\w-]+/g, "_")}.gif`), moving);
  } finally {
    await browser.close();
  }
}

main().catch((fault: unknown) => {
  process.stderr.write(`readme_pictures: ${fault instanceof Fault ? fault.message : fault instanceof Error ? (fault.stack ?? fault.message) : String(fault)}\n`);
  process.exitCode = fault instanceof Fault ? 2 : 1;
});
