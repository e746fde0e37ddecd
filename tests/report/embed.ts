// Inserts a document into the template like the program.

import { gzipSync } from "node:zlib";
import type { ReportData } from "../../src/report/page/source/data.ts";

const escaped: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;" };

export function embed(template: string, data: ReportData): string {
  const title = data.folder.replace(/[&<>]/g, (found) => escaped[found] ?? found);
  const base64 = gzipSync(JSON.stringify(data), { level: 6 }).toString("base64");
  return template.replace("<!--polhode:title-->", () => title).replace("<!--polhode:data-->", () => base64);
}
