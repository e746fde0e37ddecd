// The document out of the page: base64, gzip, JSON.

export async function readDocument(holder: Element | null): Promise<unknown> {
  const text = holder?.textContent?.trim() ?? "";
  if (text === "" || text.startsWith("<!--")) throw new Error("the page holds no data; `polhode report DIR` makes one that does");
  if (typeof DecompressionStream === "undefined") {
    throw new Error("this browser cannot decompress the data (it has no DecompressionStream); Chrome 80, Firefox 113, Safari 16.4 and later can");
  }
  let bytes: Uint8Array<ArrayBuffer>;
  try {
    const binary = atob(text);
    bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  } catch {
    throw new Error("the data is not base64: the page was changed or cut short; make it anew");
  }
  let json: string;
  try {
    json = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  } catch {
    throw new Error("the data does not decompress: the page was changed or cut short; make it anew");
  }
  try {
    return JSON.parse(json);
  } catch (fault) {
    throw new Error(`the data is not JSON (${fault instanceof Error ? fault.message : String(fault)}); make the page anew`);
  }
}
