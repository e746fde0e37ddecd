// Reads the contents of the page's elements: base64, gzip.

/** Decompressed text of an element; `what` names it in messages. */
export async function readCompressed(holder: Element | null, what: string): Promise<string> {
  const text = holder?.textContent?.trim() ?? "";
  if (text === "" || text.startsWith("<!--")) throw new Error(`the page contains no ${what}; create it with \`polhode report DIR\``);
  if (typeof DecompressionStream === "undefined") {
    throw new Error(`this browser cannot decompress the ${what} (it has no DecompressionStream); use Chrome 80, Firefox 113, Safari 16.4 or later`);
  }
  let bytes: Uint8Array<ArrayBuffer>;
  try {
    const binary = atob(text);
    bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  } catch {
    throw new Error(`the ${what} is not base64: the page was modified or truncated; create it again`);
  }
  try {
    return await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  } catch {
    throw new Error(`the ${what} cannot be decompressed: the page was modified or truncated; create it again`);
  }
}

/** Reads the page's document. */
export async function readDocument(holder: Element | null): Promise<unknown> {
  const json = await readCompressed(holder, "data");
  try {
    return JSON.parse(json);
  } catch (fault) {
    throw new Error(`the data is not JSON (${fault instanceof Error ? fault.message : String(fault)}); create the page again`);
  }
}
