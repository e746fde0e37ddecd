// Reduces curves to fewer points.

/** Indices of at most `most` points (at least four) that draw the same curve: the first, the last, and the minimum and
 * maximum of each interval between them. An interval without finite values keeps one point. */
export function thinned(y: readonly (number | null)[], most: number): number[] {
  const n = y.length;
  if (n <= Math.max(4, most)) return Array.from({ length: n }, (_, i) => i);
  const stretches = Math.max(1, Math.floor((Math.max(4, most) - 2) / 2));
  const kept = new Set<number>([0, n - 1]);
  for (let s = 0; s < stretches; ++s) {
    const begin = 1 + Math.floor((s * (n - 2)) / stretches);
    const end = 1 + Math.floor(((s + 1) * (n - 2)) / stretches);
    let low = -1;
    let high = -1;
    for (let i = begin; i < end; ++i) {
      const value = y[i];
      if (value === null || value === undefined || !Number.isFinite(value)) continue;
      if (low < 0 || value < (y[low] as number)) low = i;
      if (high < 0 || value > (y[high] as number)) high = i;
    }
    if (low < 0) kept.add(begin);
    else kept.add(low).add(high);
  }
  return [...kept].sort((a, b) => a - b);
}

/** Indices of the Pareto front in ascending x; smaller x and y are better. */
export function front(x: readonly number[], y: readonly number[]): number[] {
  const order = x.map((_, i) => i).sort((a, b) => (x[a] ?? 0) - (x[b] ?? 0) || (y[a] ?? 0) - (y[b] ?? 0));
  const best: number[] = [];
  let lowest = Infinity;
  for (const i of order) {
    const value = y[i] ?? Infinity;
    if (value < lowest) {
      best.push(i);
      lowest = value;
    }
  }
  return best;
}
