// Converts the page's state to a URL fragment and back: #section=work-precision&scene=free_asymmetric.

export type State = Record<string, string>;

/** Decodes percent escapes; text with invalid escapes is returned unchanged. */
function decode(text: string): string {
  try {
    return decodeURIComponent(text.replace(/\+/g, " "));
  } catch {
    return text;
  }
}

/** Escapes as little as possible, to keep the address readable. */
function encode(text: string): string {
  return encodeURIComponent(text).replace(/%(2F|3A|2C|40|7B|7D)/g, (found) =>
    found === "%7B" || found === "%7D" ? found : decodeURIComponent(found),
  );
}

export function parseFragment(fragment: string): State {
  const state: State = Object.create(null) as State;
  for (const part of fragment.replace(/^#/, "").split("&")) {
    const at = part.indexOf("=");
    if (at <= 0) continue;
    const value = decode(part.slice(at + 1));
    if (value !== "") state[decode(part.slice(0, at))] = value;
  }
  return state;
}

/** Writes keys in a fixed order, so that equal states have equal addresses. */
export function writeFragment(state: State): string {
  const first = ["section", "scene"];
  const rank = (key: string): number => (first.includes(key) ? first.indexOf(key) : first.length);
  const keys = Object.keys(state).filter((key) => state[key] !== "");
  keys.sort((a, b) => rank(a) - rank(b) || (a < b ? -1 : 1));
  return keys.map((key) => `${encode(key)}=${encode(state[key] ?? "")}`).join("&");
}

/** Joins names with commas; commas and backslashes in names are escaped by a backslash. */
export function writeList(names: readonly string[]): string {
  return names.map((name) => name.replace(/[\\,]/g, (found) => `\\${found}`)).join(",");
}

export function parseList(text: string): string[] {
  const names: string[] = [];
  let name = "";
  for (let i = 0; i < text.length; ++i) {
    if (text[i] === "\\" && i + 1 < text.length) name += text[++i];
    else if (text[i] === ",") {
      names.push(name);
      name = "";
    } else name += text[i];
  }
  if (name !== "") names.push(name);
  return names.filter((one) => one !== "");
}
