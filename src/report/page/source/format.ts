// Formats numbers.

const thin = "\u202f"; // narrow no-break space
const minus = "\u2212";

/** Significant digits without trailing zeros: 3.59, 0.00133, 1.59e-5. ASCII, so that it can be parsed. */
export function significant(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  if (value === 0) return "0";
  const [mantissa = "", exponent = "0"] = value.toExponential(Math.max(0, digits - 1)).split("e");
  const power = Number(exponent);
  const trimmed = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
  if (power >= -3 && power < Math.max(6, digits)) {
    const text = Number(`${trimmed}e${power}`).toFixed(Math.max(0, digits - 1 - power));
    return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
  }
  return `${trimmed}e${power}`;
}

const prefixes = ["q", "r", "y", "z", "a", "f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P", "E", "Z", "Y", "R", "Q"];
const noPrefix = prefixes.indexOf("");

/** With an SI prefix, so that one to three digits precede the point: 446 ns, 1.5 kN. */
export function engineering(value: number | null | undefined, unit: string, digits = 3): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "";
  if (!Number.isFinite(value)) return `${significant(value)} ${unit}`;
  if (value === 0) return `0 ${unit}`;
  // rounding may carry into the next thousand, so round first
  const rounded = Number(value.toPrecision(digits));
  const third = Math.floor(Math.log10(Math.abs(rounded)) / 3 + 1e-12);
  const place = Math.min(prefixes.length - 1, Math.max(0, third + noPrefix));
  const scaled = rounded / 10 ** (3 * (place - noPrefix));
  return `${significant(scaled, digits)}${thin}${prefixes[place]}${unit}`;
}

/** Seconds, with an SI prefix below 1000 s. */
export function duration(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || Number.isNaN(seconds)) return "";
  return Math.abs(seconds) >= 1000 ? `${significant(seconds, 4)}${thin}s` : engineering(seconds, "s");
}

/** Decades of a logarithmic axis of errors, as exponents of 10: from the smallest to the largest positive value. Values
 * below 1e-18 of the largest are the rounding of a single sample, usually the first, and do not count. */
export function errorDecades(values: readonly (number | null | undefined)[]): [number, number] | null {
  const positive = values.filter((value): value is number => typeof value === "number" && value > 0 && Number.isFinite(value));
  const high = positive.reduce((most, value) => Math.max(most, value), 0);
  if (high === 0) return null;
  const low = positive.reduce((least, value) => (value < 1e-18 * high ? least : Math.min(least, value)), high);
  const bottom = Math.floor(Math.log10(low) + 1e-9);
  const top = Math.ceil(Math.log10(high) - 1e-9) + 0; // no negative zero
  return [bottom, Math.max(top, bottom + 1)];
}

/** An integer with thin spaces: 12 345. */
export function count(value: number | null | undefined): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "";
  const text = Math.abs(value).toFixed(0).replace(/\B(?=(\d{3})+$)/g, thin);
  return value < 0 ? `${minus}${text}` : text;
}

/** A count with the noun in singular or plural. */
export function counted(value: number, one: string, many = `${one}s`): string {
  return `${count(value)} ${value === 1 ? one : many}`;
}

/** A value with its unit, in scientific notation if small. */
export function quantity(value: number | null | undefined, unit: string, digits = 3): string {
  const text = significant(value, digits);
  return text === "" ? "" : unit === "" ? text : `${text}${thin}${unit}`;
}
