// Bundles script and style and inserts both into the page:  node bundle.mjs SOURCE NODE_MODULES > OUTPUT
// The result is one file that makes no requests and contains the licences of its packages.
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const [source, modules] = process.argv.slice(2);
const esbuild = createRequire(join(modules, "here.js"))("esbuild");

const fail = (text) => {
  process.stderr.write(`${text}\n`);
  process.exit(1);
};

/** Returns the file bundled by esbuild. */
const bundle = (file) => {
  try {
    const result = esbuild.buildSync({
      entryPoints: [join(source, file)],
      bundle: true,
      minify: true,
      format: "iife",
      target: "es2022",
      charset: "utf8",
      legalComments: "inline",
      nodePaths: [modules],
      tsconfigRaw: "{}",
      write: false,
      outdir: "/",
      logLevel: "silent",
    });
    return result.outputFiles[0].text.trim();
  } catch (fault) {
    const first = fault.errors?.[0];
    const place = first?.location ? `${first.location.file}:${first.location.line}: ` : `${file}: `;
    return fail(`${place}${first?.text ?? fault.message}`);
  }
};

/** The licence of a package as a comment. The page redistributes the package. */
const licence = (name) => {
  const about = JSON.parse(readFileSync(join(modules, name, "package.json"), "utf8"));
  const file = ["LICENSE", "LICENSE.md"].map((one) => join(modules, name, one)).find(existsSync);
  const text = readFileSync(file, "utf8").trim().replaceAll("*/", "* /");
  return `/*!\n${about.name} ${about.version}\n\n${text}\n*/\n`;
};

const style = bundle("style.css");
if (/<\/style/i.test(style)) fail("style.css: contains the end of a style element; remove it");

// Sequences that the HTML parser reads as the end of the script element or the start of a comment are replaced by
// equivalent ones inside JavaScript strings.
const loader =
  ["plotly.js-basic-dist-min", "three", "gifenc"].map(licence).join("").replaceAll(/<(?=[!/])/g, "< ") +
  bundle("loader.ts")
    .replaceAll(/<\/script/gi, (found) => `<\\/${found.slice(2)}`)
    .replaceAll("<!--", "\\x3c!--");
// a third of the size, which leaves room for data
const script = gzipSync(bundle("main.ts"), { level: 9 }).toString("base64");

let page = readFileSync(join(source, "page.html"), "utf8");
for (const [place, text] of [["/*polhode:style*/", style], ["/*polhode:script*/", script], ["/*polhode:loader*/", loader]]) {
  if (page.split(place).length !== 2) fail(`page.html: must contain ${place} exactly once`);
  page = page.replace(place, () => text);
}
for (const place of ["<!--polhode:title-->", "<!--polhode:data-->"]) {
  if (page.split(place).length !== 2) fail(`page.html: must contain ${place} exactly once`);
}
process.stdout.write(page);
