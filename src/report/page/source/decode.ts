// What the page holds, out of its elements: base64, gzip.

/** The text of an element that holds it compressed; `what` it is for messages. */
export async function readCompressed(holder: Element | null, what: string): Promise<string> {
  const text = holder?.textContent?.trim() ?? "";
  if (text === "" || text.startsWith("<!--")) throw new Error(`the page holds no ${what}; \`polhode report DIR\` makes one that does`);
  if (typeof DecompressionStream === "undefined") {
    throw new Error(`this browser cannot decompress the ${what} (it has no DecompressionStream); Chrome 80, Firefox 113, Safari 16.4 and later can`);
  }
  let bytes: Uint8Array<ArrayBuffer>;
  try {
    const binary = atob(text);
    bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  } catch {
    throw new Error(`the ${what} is not base64: the page was changed or cut short; make it anew`);
  }
  try {
    return await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  } catch {
    throw new Error(`the ${what} does not decompress: the page was changed or cut short; make it anew`);
  }
}

/** The document that the page shows. */
export async function readDocument(holder: Element | null): Promise<unknown> {
  const json = await readCompressed(holder, "data");
  try {
    return JSON.parse(json);
  } catch (fault) {
    throw new Error(`the data is not JSON (${fault instanceof Error ? fault.message : String(fault)}); make the page anew`);
  }
}
