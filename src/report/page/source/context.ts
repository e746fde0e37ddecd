// The interface that all parts of the page share: the state in the URL fragment, the theme, reduced motion.

export interface PageContext {
  /** A value of the state, or "". */
  get(key: string): string;
  /** Sets values of the state, removes empty ones, and writes the fragment. */
  set(values: Record<string, string>): void;
  /** Called after every change of the state, including links and the back button. */
  onState(listener: () => void): void;
  dark(): boolean;
  onTheme(listener: () => void): void;
  /** Whether the reader prefers reduced motion. */
  reducedMotion(): boolean;
  /** Announces a text to screen readers. */
  announce(text: string): void;
}
