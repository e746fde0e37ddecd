// Measures pages of `polhode report`:  node page_speed.cjs OUTPUT CHROMIUM PAGE..
// For each page: size, times of the first paint and of the first idle moment, pictures per second while the motion plays,
// and for a lesson the time from a move of a slider to the new result. Chromium draws without a graphics processor.

import { readFileSync, statSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer, { type Browser, type Page } from "puppeteer-core";

const repeats = 3;
const playTime = 3000; // ms

interface Row {
  page: string;
  megabytes: number;
  paint: number; // ms
  idle: number; // ms
  frames: number; // per second
  slider: number | null; // ms
}

async function open(browser: Browser, file: string): Promise<Page> {
  const tab = await browser.newPage();
  await tab.setViewport({ width: 1280, height: 900 });
  await tab.goto(pathToFileURL(file).href, { timeout: 120000 });
  await tab.waitForSelector("html[data-ready=yes]", { timeout: 120000 });
  return tab;
}

async function loadTimes(browser: Browser, file: string): Promise<[number, number]> {
  const tab = await open(browser, file);
  const times = await tab.evaluate(async () => {
    await new Promise((done) => requestIdleCallback(done));
    const idle = performance.now();
    const paint = performance.getEntriesByType("paint").find((one) => one.name === "first-contentful-paint");
    return [paint?.startTime ?? NaN, idle] as [number, number];
  });
  await tab.close();
  return times;
}

/** Pictures per second while the motion plays, repeated from the start where it ends. */
async function framesPerSecond(tab: Page): Promise<number> {
  await tab.evaluate(() => (document.querySelector(".motion") ?? document.querySelector("#section-motion"))?.scrollIntoView());
  await tab.waitForSelector(".motion-view[data-drawn]", { timeout: 120000 });
  await tab.$eval(".motion-view", (view) => view.scrollIntoView());
  await tab.$eval(".motion-time .play", (play) => (play as HTMLButtonElement).click());
  return tab.evaluate(async (time) => {
    const view = document.querySelector<HTMLElement>(".motion-view");
    const play = document.querySelector<HTMLButtonElement>(".motion-time .play");
    const begin = performance.now();
    let [last, count] = ["", 0];
    while (performance.now() - begin < time) {
      await new Promise((done) => requestAnimationFrame(done));
      if (play?.textContent === "Play") play.click();
      if (view?.dataset.drawn !== last) ++count;
      last = view?.dataset.drawn ?? "";
    }
    return (1000 * count) / (performance.now() - begin);
  }, playTime);
}

/** Time from a move of the lesson's first slider to the new result, the median of several, ms. */
async function sliderTime(tab: Page): Promise<number | null> {
  if ((await tab.$(".lesson[data-result]")) === null) return null;
  const times: number[] = [];
  for (const position of [60, 90, 120, 150, 110]) {
    times.push(await tab.evaluate(async (value) => {
      const lesson = document.querySelector<HTMLElement>(".lesson");
      const slider = document.querySelector<HTMLInputElement>(".lesson-slider input");
      if (lesson === null || slider === null) return NaN;
      const before = lesson.dataset.result;
      const begin = performance.now();
      slider.value = String(value);
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      while (lesson.dataset.result === before && performance.now() - begin < 20000) await new Promise((done) => requestAnimationFrame(done));
      return performance.now() - begin;
    }, position));
  }
  return times.sort((a, b) => a - b)[2] ?? null;
}

async function measure(browser: Browser, file: string): Promise<Row> {
  let [paint, idle] = [Infinity, Infinity];
  for (let i = 0; i < repeats; ++i) {
    const [first, last] = await loadTimes(browser, file);
    [paint, idle] = [Math.min(paint, first), Math.min(idle, last)];
  }
  const tab = await open(browser, file);
  const slider = await sliderTime(tab);
  const frames = await framesPerSecond(tab);
  await tab.close();
  return { page: basename(file, ".html"), megabytes: statSync(file).size / 1e6, paint, idle, frames, slider };
}

function table(rows: readonly Row[]): string {
  const head = ["page", "size (MB)", "first paint (ms)", "idle (ms)", "pictures per second", "slider (ms)"];
  const cells = rows.map((row) => [row.page, row.megabytes.toFixed(2), ...[row.paint, row.idle, row.frames].map((x) => x.toFixed(0)), row.slider === null ? "" : row.slider.toFixed(0)]);
  const widths = head.map((one, i) => Math.max(one.length, ...cells.map((row) => row[i]?.length ?? 0)));
  const line = (row: readonly string[]): string => `| ${row.map((one, i) => one.padEnd(widths[i] ?? 0)).join(" | ")} |`;
  return [line(head), `| ${widths.map((width) => "-".repeat(width)).join(" | ")} |`, ...cells.map(line)].join("\n") + "\n";
}

async function main(): Promise<void> {
  const [output = "", chromium = "", ...files] = process.argv.slice(2);
  const browser = await puppeteer.launch({ executablePath: chromium, headless: true, args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
  try {
    const rows: Row[] = [];
    for (const file of files) rows.push(await measure(browser, resolve(file)));
    const markdown = table(rows);
    writeFileSync(join(output, "page_speed.md"), markdown);
    process.stdout.write(markdown);
    const record = join(output, "provenance.json");
    let entries: Record<string, unknown> = {};
    try {
      entries = JSON.parse(readFileSync(record, "utf8")) as Record<string, unknown>;
    } catch {
      // a new directory
    }
    const cpu = /^model name\s*:\s*(.*)$/m.exec(readFileSync("/proc/cpuinfo", "utf8"))?.[1] ?? "";
    entries.page_speed = { date: new Date().toISOString().replace(/\.\d+Z/, "Z"), command_line: "tests/report/page_speed", versions: { browser: await browser.version() }, cpu };
    writeFileSync(record, `${JSON.stringify(entries, null, 2)}\n`);
  } finally {
    await browser.close();
  }
}

main().catch((fault: unknown) => {
  process.stderr.write(`page_speed: ${fault instanceof Error ? (fault.stack ?? fault.message) : String(fault)}\n`);
  process.exitCode = 1;
});
