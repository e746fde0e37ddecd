// node make_page.js TEMPLATE OUTPUT rich|names|one|null|empty|many|FILE.json
// Writes a page of a sample document or of a document in a file.

import { readFileSync, writeFileSync } from "node:fs";
import { embed } from "./embed.ts";
import { emptyDocument, hostileNames, manyRows, nothingKnown, oneRow, richDocument } from "./sample.ts";
import type { ReportData } from "../../src/report/page/source/data.ts";

const samples: Record<string, () => ReportData> = {
  rich: richDocument, names: hostileNames, one: oneRow, null: nothingKnown, empty: emptyDocument, many: () => manyRows(100000),
};
const [template, output, kind] = process.argv.slice(2);
if (template === undefined || output === undefined || kind === undefined) {
  process.stderr.write("usage: make_page TEMPLATE OUTPUT SAMPLE\n");
  process.exit(2);
}
const data = samples[kind]?.() ?? (JSON.parse(readFileSync(kind, "utf8")) as ReportData);
writeFileSync(output, embed(readFileSync(template, "utf8"), data));
