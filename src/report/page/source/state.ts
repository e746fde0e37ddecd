// The page's state, shared by all sections and stored in the URL fragment.

import type { PageContext } from "./context.ts";
import { parseFragment, writeFragment, type State } from "./fragment.ts";

export class Page implements PageContext {
  private state: State;
  private readonly listeners: (() => void)[] = [];
  private readonly themeListeners: (() => void)[] = [];
  private readonly followers: (() => void)[] = [];
  private readonly darkQuery = window.matchMedia("(prefers-color-scheme: dark)");
  private readonly motionQuery = window.matchMedia("(prefers-reduced-motion: reduce)");
  private written: string;
  private timer = 0;

  constructor(private readonly live: HTMLElement) {
    this.written = location.hash;
    this.state = parseFragment(location.hash);
    window.addEventListener("hashchange", () => this.follow());
    this.darkQuery.addEventListener("change", () => this.themeChanged());
    this.showTheme();
  }

  get(key: string): string {
    return this.state[key] ?? "";
  }

  keys(): string[] {
    return Object.keys(this.state);
  }

  set(values: Record<string, string>): void {
    const before = this.state;
    const after: State = Object.assign(Object.create(null) as State, before);
    // zoom ranges do not apply to another scene
    if (values.scene !== undefined && values.scene !== (before.scene ?? "")) {
      for (const key of Object.keys(after)) if (key.endsWith(".zoom")) delete after[key];
    }
    for (const [key, value] of Object.entries(values)) {
      if (value === "") delete after[key];
      else after[key] = value;
    }
    if (writeFragment(after) === writeFragment(before)) return;
    this.state = after;
    // browsers limit the rate of address changes, which a drag would exceed
    if (this.timer === 0) this.timer = window.setTimeout(() => this.write(), 150);
    this.changed(before);
  }

  /** Address of the current view. */
  address(): string {
    this.write();
    return `${location.href.replace(/#.*$/, "")}#${writeFragment(this.state)}`;
  }

  onState(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Called after a link or the back button changed the address. */
  onFollow(listener: () => void): void {
    this.followers.push(listener);
  }

  /** Called after the value of one of the keys changed. */
  watch(keys: readonly string[], listener: () => void): void {
    const values = (): string => JSON.stringify(keys.map((key) => this.get(key)));
    let before = values();
    this.onState(() => {
      const now = values();
      if (now === before) return;
      before = now;
      listener();
    });
  }

  dark(): boolean {
    const asked = this.get("theme");
    return asked === "dark" || (asked !== "light" && this.darkQuery.matches);
  }

  onTheme(listener: () => void): void {
    this.themeListeners.push(listener);
  }

  reducedMotion(): boolean {
    return this.motionQuery.matches;
  }

  announce(text: string): void {
    // cleared first, because an unchanged text is not announced again
    this.live.textContent = "";
    window.setTimeout(() => (this.live.textContent = text), 30);
  }

  private write(): void {
    window.clearTimeout(this.timer);
    this.timer = 0;
    const fragment = `#${writeFragment(this.state)}`;
    if (fragment === this.written || (fragment === "#" && this.written === "")) return;
    this.written = fragment;
    try {
      history.replaceState(null, "", fragment);
    } catch {
      // some browsers do not allow it on file://
      location.replace(fragment);
    }
  }

  private follow(): void {
    if (location.hash === this.written) return;
    this.written = location.hash;
    const before = this.state;
    this.state = parseFragment(location.hash);
    // theme and scene are kept if the link does not contain them
    for (const key of ["theme", "scene"]) if (this.state[key] === undefined && before[key] !== undefined) this.state[key] = before[key];
    this.changed(before);
    for (const follower of this.followers) follower();
  }

  private changed(before: State): void {
    if ((before.theme ?? "") !== this.get("theme")) this.themeChanged();
    call(this.listeners);
  }

  private themeChanged(): void {
    this.showTheme();
    call(this.themeListeners);
  }

  private showTheme(): void {
    const asked = this.get("theme");
    if (asked === "dark" || asked === "light") document.documentElement.dataset.theme = asked;
    else delete document.documentElement.dataset.theme;
  }
}

/** Calls all listeners. Errors are logged and do not affect other listeners. */
function call(listeners: readonly (() => void)[]): void {
  for (const listener of [...listeners]) {
    try {
      listener();
    } catch (fault) {
      console.error(fault);
    }
  }
}
