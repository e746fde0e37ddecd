// Takes the picture of README from a page of `polhode report`:  node readme_pictures.cjs PAGE OUTPUT CHROMIUM
// report.png shows the findings and the work-precision diagram.

import { existsSync, mkdirSync, renameSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer, { type Browser, type Page } from "puppeteer-core";
import { readPng, writePng } from "./motion_png.ts";

class Fault extends Error {}

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

async function main(): Promise<void> {
  const [page = "", output = "", chromium = ""] = process.argv.slice(2);
  if (!existsSync(page)) throw new Fault(`${page} does not exist; create it with \`polhode report DIR\`, or name another page with --page`);
  mkdirSync(output, { recursive: true });
  const browser = await puppeteer.launch({ executablePath: chromium, headless: true, args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
  try {
    write(join(output, "report.png"), await overviewPicture(browser, resolve(page)));
  } finally {
    await browser.close();
  }
}

main().catch((fault: unknown) => {
  process.stderr.write(`readme_pictures: ${fault instanceof Fault ? fault.message : fault instanceof Error ? (fault.stack ?? fault.message) : String(fault)}\n`);
  process.exitCode = fault instanceof Fault ? 2 : 1;
});
