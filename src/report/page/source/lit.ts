// Selection of highlighted ("lit") curves: at most twelve, because more are not distinguishable.

export const mostLit = 12;

/** Removes the method if it is highlighted. Otherwise appends it, and removes the oldest if there are too many. */
export function toggleLit<T>(lit: readonly T[], one: T, most = mostLit): T[] {
  if (lit.includes(one)) return lit.filter((other) => other !== one);
  return [...lit, one].slice(-most);
}

/** Highlights the first distinct entries of a list, up to the limit. */
export function light<T>(several: readonly T[], most = mostLit): T[] {
  return [...new Set(several)].slice(0, most);
}
