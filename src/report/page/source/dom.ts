// Elements, made without markup: texts are set as texts.

type Value = string | number | boolean | null | undefined | ((event: never) => void);
export type Child = Node | string | null | undefined | false;

/** An element with attributes; a function is a listener ("onclick"), true an empty attribute, false and null none. */
export function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  attributes: Record<string, Value> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(key.slice(2), value as EventListener);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, String(value));
  }
  add(made, ...children);
  return made;
}

export function vector(name: string, attributes: Record<string, string>, ...children: Node[]): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

export function add(to: Element, ...children: Child[]): void {
  for (const child of children) if (child !== null && child !== undefined && child !== false) to.append(child);
}

export function fill(host: Element, ...children: Child[]): void {
  host.replaceChildren();
  add(host, ...children);
}

let next = 0;
export function identity(kind: string): string {
  return `${kind}-${++next}`;
}

/** A labelled choice of one among several. */
export class Choice {
  readonly root: HTMLElement;
  private readonly select: HTMLSelectElement;
  private shown = "";

  constructor(label: string, changed: (value: string) => void) {
    this.select = element("select", { onchange: () => changed(this.select.value) });
    this.root = element("label", { class: "choice" }, element("span", {}, label), this.select);
  }

  /** The options as [value, text]; hidden where there is nothing to choose. */
  update(options: [string, string][], value: string): void {
    const all = JSON.stringify(options);
    if (all !== this.shown) {
      this.shown = all;
      fill(this.select, ...options.map(([key, text]) => element("option", { value: key, title: text }, text)));
    }
    this.select.value = value;
    this.root.hidden = options.length < 2;
  }
}

/** Writes to the clipboard by the ways there are; false where none is. */
export async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // the older way, which needs no permission
    const area = element("textarea", { class: "unseen", "aria-hidden": "true", tabindex: -1 });
    area.value = text;
    document.body.append(area);
    const before = document.activeElement;
    area.select();
    let done = false;
    try {
      done = document.execCommand("copy");
    } catch {
      done = false;
    }
    area.remove();
    if (before instanceof HTMLElement) before.focus();
    return done;
  }
}
