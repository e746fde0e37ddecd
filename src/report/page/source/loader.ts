// Decompresses and runs the page's script after the first paint. The script is compressed to leave room for data.

import { readCompressed } from "./decode.ts";

async function load(): Promise<void> {
  await new Promise((resolve) => requestAnimationFrame(() => window.setTimeout(resolve, 0)));
  try {
    const holder = document.getElementById("polhode-script");
    const script = document.createElement("script");
    script.textContent = await readCompressed(holder, "script");
    holder?.remove();
    document.body.append(script);
  } catch (fault) {
    const told = document.getElementById("progress");
    if (told === null) return;
    told.className = "fault";
    told.setAttribute("role", "alert");
    told.textContent = `The page cannot be shown: ${fault instanceof Error ? fault.message : String(fault)}`;
    document.documentElement.dataset.ready = "no";
  }
}

void load();
