// What the page's parts share: the state in the URL's fragment, the theme, and whether things may move by themselves.

export interface PageContext {
  /** A value of the state, "" where there is none. */
  get(key: string): string;
  /** Sets values of the state (an empty one is taken out) and writes them to the fragment. */
  set(values: Record<string, string>): void;
  /** Called whenever the state was changed by anybody, or the reader followed a link or went back. */
  onState(listener: () => void): void;
  dark(): boolean;
  onTheme(listener: () => void): void;
  /** The reader asked for less motion: nothing plays by itself. */
  reducedMotion(): boolean;
  /** Tells screen readers. */
  announce(text: string): void;
}
