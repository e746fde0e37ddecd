// Creates elements without markup: strings become text nodes.

type Value = string | number | boolean | null | undefined | ((event: never) => void);
export type Child = Node | string | null | undefined | false;

/** Creates an element. A function sets a listener ("onclick"), true an empty attribute; false and null are skipped. */
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

/** A labelled drop-down list. */
export class Choice {
  readonly root: HTMLElement;
  private readonly select: HTMLSelectElement;
  private shown = "";

  constructor(label: string, changed: (value: string) => void) {
    this.select = element("select", { onchange: () => changed(this.select.value) });
    this.root = element("label", { class: "choice" }, element("span", {}, label), this.select);
  }

  /** Sets the options as [value, text]. Hides the list if it has fewer than two. */
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

/** Writes to the clipboard. Returns false if the browser does not allow it. */
export async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // the older interface, which needs no permission
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
