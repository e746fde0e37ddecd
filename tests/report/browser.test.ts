// Tests the page in browsers from file://: every section, the tools, links, both themes, wide and narrow screens,
// accessibility, hostile data, and the time to interactive with 10^5 rows.

import assert from "node:assert/strict";
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import puppeteer, { type Browser, type Page } from "puppeteer-core";
import { embed } from "./embed.ts";
import { emptyDocument, hostileNames, manyRows, nothingKnown, oneRow, richDocument } from "./sample.ts";
import type { ReportData } from "../../src/report/page/source/data.ts";

const work = process.env.POLHODE_REPORT_WORK ?? "build/report";
const template = readFileSync(join(work, "page.html"), "utf8");
const axe = readFileSync(join(work, "node_modules/axe-core/axe.min.js"), "utf8");
const screenshots = join(work, "screenshots");
const folder = mkdtempSync(join(tmpdir(), "polhode-page-"));
const allSections = [
  "overview", "trajectories", "scenes", "work-precision", "comparison", "convergence", "drift", "motion", "stability", "gains", "engines", "mechanisms", "inertia", "lessons", "tables",
];

const chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const firefox = ["/usr/bin/firefox-esr", "/usr/bin/firefox"].find(existsSync);
const software = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

function launchChromium(more: string[]): Promise<Browser> {
  assert.ok(chromium, "no Chromium: install it (Debian: chromium)");
  return puppeteer.launch({ executablePath: chromium, headless: true, args: ["--no-sandbox", "--disable-dev-shm-usage", ...more] });
}

function write(name: string, data: ReportData): string {
  const file = join(folder, `${name}.html`);
  writeFileSync(file, embed(template, data));
  return `file://${file}`;
}

interface Watched {
  page: Page;
  faults: string[];
}

/** Opens a page and collects its errors: exceptions, console errors, dialogs, and requests for other addresses. */
async function open(browser: Browser, address: string, options: { width?: number; dark?: boolean; before?: (page: Page) => Promise<void> } = {}): Promise<Watched> {
  const page = await browser.newPage();
  const faults: string[] = [];
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (fault) => faults.push(`thrown: ${fault instanceof Error ? fault.message : String(fault)}`));
  page.on("dialog", (dialog) => {
    faults.push(`dialog: ${dialog.message()}`);
    void dialog.dismiss();
  });
  page.on("request", (request) => {
    const url = request.url();
    if (url.split("#")[0] !== address.split("#")[0] && !/^(data|blob):/.test(url)) faults.push(`request: ${url.slice(0, 200)}`);
  });
  await page.setViewport({ width: options.width ?? 1440, height: 900 });
  if (options.dark !== undefined) await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: options.dark ? "dark" : "light" }]);
  await options.before?.(page);
  await page.goto(address);
  await page.waitForSelector("html[data-ready]", { timeout: 60000 });
  return { page, faults };
}

const pause = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** Scrolls through the page until every section is rendered and every visible plot is drawn. */
async function drawAll(page: Page): Promise<void> {
  for (let round = 0; round < 200; ++round) {
    const left = await page.evaluate(() => {
      const waiting = document.querySelector(".body.waiting");
      waiting?.scrollIntoView({ block: "start" });
      return waiting !== null;
    });
    if (!left) break;
    await pause(60);
  }
  await page.waitForFunction(
    () => document.querySelector(".body.waiting") === null && [...document.querySelectorAll<HTMLElement>(".plot")].every((plot) => plot.offsetParent === null || plot.querySelector(".main-svg") !== null),
    { timeout: 60000 },
  );
  await page.evaluate(() => window.scrollTo(0, 0));
  await pause(300);
}

/** Horizontal overflow of the page, px. */
function tooWide(page: Page): Promise<number> {
  return page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
}

async function violations(page: Page): Promise<string[]> {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const { axe: runner } = window as unknown as { axe: { run(context: object, options: object): Promise<{ violations: { id: string; help: string; nodes: { html: string; failureSummary?: string }[] }[] }> } };
    // motion_browser.test.ts tests the motion view
    const result = await runner.run({ exclude: [[".motion"]] }, { resultTypes: ["violations"] });
    return result.violations.map((one) => `${one.id}: ${one.help}: ${one.nodes.slice(0, 3).map((node) => `${node.html.slice(0, 160)} ${(node.failureSummary ?? "").slice(0, 300)}`).join(" | ")} (${one.nodes.length})`);
  });
}

let browser: Browser;
let rich: string;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  rich = write("rich", richDocument());
  browser = await launchChromium(software);
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

test("the template has one placeholder each for the title and the data, and contains the licences", () => {
  assert.equal(template.split("<!--polhode:title-->").length, 2);
  assert.equal(template.split("<!--polhode:data-->").length, 2);
  assert.match(template, /<title><!--polhode:title--><\/title>/);
  assert.match(template, /<script id="polhode-data" type="application\/gzip"><!--polhode:data--><\/script>/);
  assert.equal(template.match(/<\/script/gi)?.length, 5, "the end of a script inside a script");
  assert.match(template, /default-src 'none'/);
  for (const name of ["plotly.js-basic-dist-min", "three"]) assert.ok(template.includes(`${name} `) && template.includes("Permission is hereby granted"), `the licence of ${name}`);
  assert.match(template, /Plotly/);
});

test("renders every section without errors or requests", async () => {
  const { page, faults } = await open(browser, rich);
  await drawAll(page);
  const sections = await page.$$eval("main > section", (all) => all.map((one) => one.id.replace("section-", "")));
  assert.deepEqual(sections, allSections);
  assert.deepEqual(await page.$$eval("#sections a", (all) => all.length), allSections.length);
  assert.deepEqual(await page.$$eval("main .fault:not([hidden])", (all) => all.filter((one) => one.closest(".motion") === null).map((one) => one.textContent)), []);
  for (const name of ["work-precision", "comparison", "convergence", "drift", "gains", "engines", "mechanisms", "inertia", "trajectories"]) {
    const points = await page.$$eval(`#section-${name} .plot .scatterlayer path.point, #section-${name} .plot .scatterlayer .js-line`, (all) => all.length);
    assert.ok(points > 2, `${name} has ${points} marks`);
  }
  assert.ok((await page.$$eval("#section-stability canvas", (all) => all.length)) >= 2);
  assert.equal(await page.title(), "results");
  assert.deepEqual(faults, []);
  await page.close();
});

test("the legend highlights at most twelve methods, by mouse and keyboard", async () => {
  const { page, faults } = await open(browser, `${rich}#section=work-precision`);
  await page.waitForSelector("#section-work-precision .entry");
  const lit = (): Promise<string[]> => page.$$eval('#section-work-precision .entry[aria-pressed="true"]', (all) => all.map((one) => one.textContent ?? ""));
  assert.equal((await lit()).length, 12);
  await page.click('#section-work-precision .entry[aria-pressed="false"]');
  await pause(400);
  assert.equal((await lit()).length, 12, "a thirteenth method replaces the oldest");
  await page.focus('#section-work-precision .entry[aria-pressed="true"]');
  const first = (await lit())[0];
  await page.keyboard.press("Enter");
  await pause(400);
  assert.equal((await lit()).length, 11);
  assert.ok(!(await lit()).includes(first ?? ""));
  const focused = await page.evaluate(() => document.activeElement?.textContent);
  assert.equal(focused, first, "the focus stays with the method");
  assert.match(await page.$eval("#announcements", (one) => one.textContent ?? ""), /dimmed/);
  assert.match(await page.evaluate(() => location.hash), /lit=/);
  assert.deepEqual(faults, []);
  await page.close();
});

test("marks failures at the edge and lists unsupported methods with the reason", async () => {
  const { page, faults } = await open(browser, `${rich}#section=work-precision&scene=stiff_drag`);
  await page.waitForSelector("#section-work-precision .main-svg");
  await pause(500);
  const crosses = await page.$$eval("#section-work-precision .plot", (plots) =>
    plots.flatMap((plot) => ((plot as unknown as { data: { name?: string; y: number[]; yaxis?: string }[] }).data ?? []).filter((trace) => /^failures/.test(trace.name ?? "")).map((trace) => trace.yaxis ?? "y")));
  assert.ok(crosses.includes("y2"), "runs without an error value are marked at the top");
  assert.match(await page.$eval("#section-work-precision .unsupported", (one) => one.textContent ?? ""), /only torque-free motion of one body.*exact/s);
  assert.deepEqual(faults, []);
  await page.close();
});

test("tables can be sorted, filtered, paged and copied", async () => {
  const { page, faults } = await open(browser, `${rich}#section=tables&table=long_list`, {
    before: async (one) => {
      await one.evaluateOnNewDocument(() => {
        Object.defineProperty(navigator, "clipboard", { value: { writeText: async (text: string) => void ((window as unknown as { copied: string }).copied = text) } });
      });
    },
  });
  const place = "#section-tables";
  await page.waitForSelector(`${place} tbody tr`);
  const column = (n: number): Promise<string[]> => page.$$eval(`${place} tbody tr td:nth-child(${n})`, (all) => all.map((one) => one.getAttribute("title") ?? one.textContent ?? ""));
  const copied = (): Promise<string> => page.evaluate(() => (window as unknown as { copied: string }).copied);
  const button = async (text: string): Promise<void> => {
    await page.evaluate((place, text) => [...document.querySelectorAll<HTMLButtonElement>(`${place} button`)].find((one) => one.textContent === text)?.click(), place, text);
    await pause(150);
  };
  assert.equal((await column(1)).length, 100, "a page has a hundred rows");
  await button("Next");
  assert.equal((await column(1))[0], "row 100");
  await page.click(`${place} thead th:nth-child(2) button`);
  await pause(200);
  const ascending = (await column(2)).map(Number);
  assert.deepEqual(ascending, [...ascending].sort((a, b) => a - b));
  assert.equal(await page.$eval(`${place} thead th:nth-child(2)`, (one) => one.getAttribute("aria-sort")), "ascending");
  await page.click(`${place} thead th:nth-child(2) button`);
  await pause(200);
  assert.equal(await page.$eval(`${place} thead th:nth-child(2)`, (one) => one.getAttribute("aria-sort")), "descending");
  await page.type(`${place} input[type=search]`, "value>1e3 row");
  await pause(500);
  const kept = (await column(2)).map(Number);
  assert.ok(kept.length > 0 && kept.length < 100 && kept.every((value) => value > 1e3));
  await button("Copy LaTeX");
  assert.match(await copied(), /\\begin\{tabular\}\{lrr\}/);
  assert.equal((await copied()).split("\n").filter((line) => line.includes("row ")).length, kept.length);
  await button("Copy CSV");
  const lines = (await copied()).trim().split("\n");
  assert.equal(lines[0], "name,value,count");
  assert.equal(lines.length, kept.length + 1);
  assert.equal(Number(lines[1]?.split(",")[1]), kept[0], "a copy has all digits");
  assert.deepEqual(faults, []);
  await page.close();
});

test("a link restores the view in another tab", async () => {
  const { page, faults } = await open(browser, `${rich}#section=work-precision`);
  await page.waitForSelector("#section-work-precision .main-svg");
  await page.select("#scene", "lagrange_top");
  await pause(300);
  await page.select("#section-work-precision .choices label:nth-child(2) select", "evaluations");
  await pause(300);
  await page.click('#section-work-precision .entry[aria-pressed="false"]');
  await page.focus("#section-work-precision .plot");
  await page.keyboard.press("+");
  await pause(300);
  await page.keyboard.press("ArrowRight");
  await pause(500);
  await page.evaluate(() => document.querySelector<HTMLButtonElement>(".theme")?.click());
  await pause(500);
  const seen = (one: Page): Promise<unknown> => one.evaluate(() => {
    const plot = document.querySelector("#section-work-precision .plot") as unknown as { layout: { xaxis: { range: number[] }; yaxis: { range: number[] } } };
    return {
      scene: document.querySelector<HTMLSelectElement>("#scene")?.value, theme: document.documentElement.dataset.theme,
      lit: [...document.querySelectorAll('#section-work-precision .entry[aria-pressed="true"]')].map((entry) => entry.textContent),
      ranges: [...plot.layout.xaxis.range, ...plot.layout.yaxis.range].map((value) => value.toPrecision(4)),
      against: document.querySelector<HTMLSelectElement>("#section-work-precision .choices label:nth-child(2) select")?.value,
    };
  });
  const before = await seen(page);
  const address = await page.evaluate(() => location.href);
  assert.match(address, /work\.zoom=/);
  const other = await open(browser, address);
  await other.page.waitForSelector("#section-work-precision .main-svg");
  await pause(800);
  assert.deepEqual(await seen(other.page), before);
  assert.ok(await other.page.$eval("#section-work-precision h2", (one) => Math.abs(one.getBoundingClientRect().top) < 300), "the section is in view");
  assert.deepEqual([...faults, ...other.faults], []);
  await page.close();
  await other.page.close();
});

test("a double click and the button reset the zoom", async () => {
  const { page, faults } = await open(browser, `${rich}#section=work-precision`);
  await page.waitForSelector("#section-work-precision .main-svg");
  await pause(500);
  const ranges = (): Promise<number[]> => page.$eval("#section-work-precision .plot", (plot) => {
    const { layout } = plot as unknown as { layout: { xaxis: { range: number[] }; yaxis: { range: number[] } } };
    return [...layout.xaxis.range, ...layout.yaxis.range];
  });
  const whole = await ranges();
  const box = await (await page.$("#section-work-precision .plot"))!.boundingBox();
  assert.ok(box);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  for (const reset of ["double click", "button"]) {
    await page.mouse.move(x - 80, y - 60);
    await page.mouse.down();
    await page.mouse.move(x + 80, y + 60, { steps: 5 });
    await page.mouse.up();
    await pause(700);
    assert.notDeepEqual(await ranges(), whole, "dragging zooms in");
    assert.match(await page.evaluate(() => location.hash), /work\.zoom=/);
    if (reset === "button") await page.evaluate(() => [...document.querySelectorAll<HTMLButtonElement>("#section-work-precision .plot-tools button")].find((one) => one.textContent === "Reset")?.click());
    else await page.mouse.click(x + 150, y - 100, { count: 2 });
    await pause(900);
    assert.deepEqual(await ranges(), whole, reset);
    assert.doesNotMatch(await page.evaluate(() => location.hash), /zoom/);
  }
  assert.deepEqual(faults, []);
  await page.close();
});

test("a finding links to its section, and back returns", async () => {
  const { page, faults } = await open(browser, rich);
  const scene = (): Promise<string> => page.$eval("#scene", (one) => (one as HTMLSelectElement).value);
  await pause(400);
  const before = await scene();
  await page.click(".cards li:nth-child(3) a");
  await page.waitForSelector("#section-work-precision .entry");
  await pause(500);
  assert.equal(await scene(), "stiff_drag");
  assert.deepEqual(await page.$$eval('#section-work-precision .entry[aria-pressed="true"] .name', (all) => all.map((one) => one.textContent)), ["radau", "cvode_bdf"]);
  assert.equal(await page.evaluate(() => document.activeElement?.id), "work-precision-heading");
  await page.goBack();
  await pause(500);
  assert.equal(await scene(), before);
  assert.deepEqual(faults, []);
  await page.close();
});

test("saves pictures as SVG and PNG with a legend", async () => {
  const { page, faults } = await open(browser, `${rich}#section=work-precision`);
  await page.waitForSelector("#section-work-precision .main-svg");
  const session = await page.createCDPSession();
  const downloads = join(folder, "downloads");
  mkdirSync(downloads, { recursive: true });
  await session.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: downloads });
  for (const format of ["SVG", "PNG"]) {
    await page.evaluate((format) => [...document.querySelectorAll<HTMLButtonElement>("#section-work-precision .plot-tools button")].find((one) => one.textContent === format)?.click(), format);
    const ending = `.${format.toLowerCase()}`;
    let name: string | undefined;
    for (let i = 0; i < 100 && name === undefined; ++i) {
      await pause(100);
      name = readdirSync(downloads).find((one) => one.endsWith(ending) && statSync(join(downloads, one)).size > 0);
    }
    assert.equal(name, `results_work_precision_free_asymmetric${ending}`);
    const bytes = readFileSync(join(downloads, name));
    writeFileSync(join(screenshots, `saved${ending}`), bytes);
    if (format === "SVG") {
      assert.match(bytes.toString(), /<svg[^>]*xmlns/);
      assert.match(bytes.toString(), /extrapolation/, "the legend contains the method names");
    } else assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  }
  assert.deepEqual(faults, []);
  await page.close();
});

for (const dark of [false, true]) {
  for (const width of [1440, 390]) {
    test(`${dark ? "dark" : "light"}, ${width} px: fits the screen and is accessible`, async () => {
      const { page, faults } = await open(browser, rich, { width, dark });
      await drawAll(page);
      assert.equal(await tooWide(page), 0, "nothing is wider than the screen");
      await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = !one.classList.contains("pop"))));
      await pause(500);
      assert.deepEqual(await violations(page), []);
      await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = false)));
      await pause(300);
      // one screenshot per section: the whole page is too large
      await page.addStyleTag({ content: ".bar, nav { position: static !important; }" });
      await pause(200);
      for (const section of await page.$$("main > section")) {
        const name = await section.evaluate((one) => one.id.replace("section-", ""));
        await section.screenshot({ path: join(screenshots, `${dark ? "dark" : "light"}_${width}_${name}.png`) });
      }
      await page.screenshot({ path: join(screenshots, `${dark ? "dark" : "light"}_${width}.png`) });
      assert.deepEqual(faults, []);
      await page.close();
    });
  }
}

test("the button switches the theme, and the first Tab reaches the skip link", async () => {
  const { page, faults } = await open(browser, rich, { dark: false });
  const ground = (): Promise<string> => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const before = await ground();
  await page.click(".theme");
  await pause(300);
  assert.notEqual(await ground(), before);
  assert.match(await page.evaluate(() => location.hash), /theme=dark/);
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  assert.notEqual(await ground(), before);
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement?.className), "skip");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement?.id), "content");
  assert.deepEqual(faults, []);
  await page.close();
});

test("renders all other sections without WebGL", async () => {
  const without = await launchChromium(["--disable-gpu", "--disable-3d-apis"]);
  try {
    const { page, faults } = await open(without, rich);
    await drawAll(page);
    assert.equal(await page.evaluate(() => document.createElement("canvas").getContext("webgl2")), null);
    assert.ok((await page.$$eval("#section-work-precision .scatterlayer path.point", (all) => all.length)) > 20);
    assert.ok((await page.$eval("#section-motion", (one) => one.textContent ?? "")).length > 10);
    // messages about missing WebGL are expected
    assert.deepEqual(faults.filter((fault) => !/webgl|WebGL|THREE/.test(fault)), []);
  } finally {
    await without.close();
  }
});

const hostile: [string, () => ReportData][] = [["names", hostileNames], ["nothing known", nothingKnown], ["one row", oneRow], ["empty", emptyDocument]];
for (const [name, make] of hostile) {
  test(`hostile data: ${name}`, async () => {
    for (const width of [1440, 400]) {
      const { page, faults } = await open(browser, write(name.replace(" ", "_"), make()), { width });
      await drawAll(page);
      assert.equal(await page.evaluate(() => document.documentElement.dataset.ready), "yes");
      assert.equal(await page.evaluate(() => (window as unknown as { broken?: number }).broken), undefined, "no script from the data was run");
      assert.equal(await page.$$eval('main img, main iframe, main b, main script, a[href^="javascript"]', (all) => all.length), 0, "no data became markup");
      assert.deepEqual(await page.$$eval(".body > .fault:not([hidden])", (all) => all.map((one) => (one.textContent ?? "").slice(0, 200))), []);
      assert.equal(await tooWide(page), 0);
      await page.screenshot({ path: join(screenshots, `hostile_${name.replace(" ", "_")}_${width}.png`), fullPage: true });
      assert.deepEqual(faults, []);
      await page.close();
    }
  });
}

test("reports truncated and empty pages and other formats", async () => {
  const whole = embed(template, oneRow());
  const cases: [string, string, RegExp][] = [
    ["empty", template, /contains no data/],
    ["cut", whole.replace(/(application\/gzip">[A-Za-z0-9+/]{400})[^<]*/, "$1"), /cannot be decompressed/],
    ["letters", whole.replace(/application\/gzip">/, 'application/gzip">%%'), /not base64/],
    ["format", embed(template, { ...oneRow(), format: 2 as 1 }), /format 1/],
  ];
  for (const [name, html, expected] of cases) {
    const file = join(folder, `broken_${name}.html`);
    writeFileSync(file, html);
    const { page, faults } = await open(browser, `file://${file}`);
    assert.match(await page.$eval("main", (one) => one.textContent ?? ""), expected, name);
    assert.deepEqual(faults, []);
    await page.close();
  }
  const { page } = await open(browser, rich, { before: (one) => one.evaluateOnNewDocument(() => void delete (window as { DecompressionStream?: unknown }).DecompressionStream).then(() => undefined) });
  assert.match(await page.$eval("main", (one) => one.textContent ?? ""), /no DecompressionStream/);
  await page.close();
});

test("10^5 rows", async (context) => {
  const address = write("many", manyRows(100000));
  const size = statSync(address.replace("file://", "")).size;
  const times: { paint: number; ready: number; interactive: number }[] = [];
  for (let repeat = 0; repeat < 3; ++repeat) {
    const { page, faults } = await open(browser, address);
    await page.waitForSelector("#section-work-precision .main-svg, #section-scenes tbody tr", { timeout: 60000 });
    const time = await page.evaluate(async () => {
      // wait until the main thread is idle
      await new Promise((resolve) => requestIdleCallback(resolve));
      const interactive = performance.now();
      const paint = performance.getEntriesByType("paint").find((one) => one.name === "first-contentful-paint");
      return { paint: paint?.startTime ?? Infinity, ready: performance.getEntriesByName("polhode-ready")[0]?.startTime ?? Infinity, interactive };
    });
    times.push(time);
    assert.deepEqual(faults, []);
    if (repeat === 2) {
      await drawAll(page);
      const begin = Date.now();
      await page.type("#section-tables input[type=search]", "scene_3 attitude<1e-9");
      await page.waitForFunction(() => /of/.test(document.querySelector("#section-tables .state")?.textContent ?? ""), { timeout: 20000 });
      context.diagnostic(`filtering 10^5 rows while typing: ${Date.now() - begin} ms`);
      assert.deepEqual(faults, []);
    }
    await page.close();
  }
  const best = (key: "paint" | "ready" | "interactive"): number => Math.round(Math.min(...times.map((time) => time[key])));
  context.diagnostic(`page ${(size / 1e6).toFixed(2)} MB; first paint ${best("paint")} ms, data ready ${best("ready")} ms, interactive ${best("interactive")} ms (best of ${times.length})`);
  // twice the targets, because test machines are shared
  assert.ok(best("paint") < 2000, "first paint");
  assert.ok(best("interactive") < 6000, "interactive");
});

test("renders the same sections in Firefox", { skip: firefox === undefined ? "Firefox is not installed" : false }, async () => {
  const other = await puppeteer.launch({ browser: "firefox", executablePath: firefox ?? "", headless: true, protocol: "webDriverBiDi" });
  try {
    const { page, faults } = await open(other, rich, {});
    await drawAll(page);
    assert.deepEqual(await page.$$eval("main > section", (all) => all.map((one) => one.id.replace("section-", ""))), allSections);
    assert.deepEqual(await page.$$eval("main .fault:not([hidden])", (all) => all.filter((one) => one.closest(".motion") === null).map((one) => one.textContent)), []);
    await page.screenshot({ path: join(screenshots, "firefox_1440.png") });
    await page.evaluate(() => document.querySelector<HTMLButtonElement>('#section-work-precision .entry[aria-pressed="false"]')?.click());
    await pause(500);
    assert.match(await page.evaluate(() => location.hash), /lit=/);
    assert.equal(await tooWide(page), 0);
    assert.deepEqual(faults.filter((fault) => !/webgl|WebGL|THREE/.test(fault)), []);
  } finally {
    await other.close();
  }
});
