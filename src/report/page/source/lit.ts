// Which curves are lit: never more than twelve, for more cannot be told apart.

export const mostLit = 12;

/** A method is lit, and the oldest goes dark where there are too many; or it goes dark if it was lit. The last is the
 * youngest. */
export function toggleLit<T>(lit: readonly T[], one: T, most = mostLit): T[] {
  if (lit.includes(one)) return lit.filter((other) => other !== one);
  return [...lit, one].slice(-most);
}

/** Lights several, as far as there is room; the first of them are kept where there is none. */
export function light<T>(several: readonly T[], most = mostLit): T[] {
  return [...new Set(several)].slice(0, most);
}
