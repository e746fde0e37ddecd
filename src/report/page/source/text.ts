// Text of names and cells: shortened, and escaped for plotly, CSV and LaTeX. No data becomes markup.

/** Replaces control characters, line breaks and bidirectional controls by spaces. */
export function oneLine(text: string): string {
  return text.replace(/[\u0000-\u001f\u007f-\u009f\u2028\u2029\u202a-\u202e\u2066-\u2069]+/g, " ");
}

/** Shortens to `length` characters: a sentence at its end, a name in the middle, because names differ at their ends. */
export function shorten(text: string, length = 40): string {
  const characters = Array.from(text.length > 4 * length + 64 ? `${text.slice(0, 2 * length)}…${text.slice(-2 * length)}` : text);
  if (characters.length <= length) return characters.join("");
  if (characters.filter((one) => one === " ").length >= 4) return `${characters.slice(0, length - 1).join("").trimEnd()}…`;
  const head = Math.ceil((length - 1) / 2);
  return `${characters.slice(0, head).join("")}…${characters.slice(characters.length - (length - 1 - head)).join("")}`;
}

const units: Record<string, string> = {
  duration: "s", mass: "kg", inertia: "kg m²", angular_velocity: "rad/s", position: "m", velocity: "m/s", density: "kg/m³",
};

/** Splits "/a=1,/b=[2,3]" at the commas that start a new JSON pointer. */
function changesOf(text: string): [string, string][] | null {
  const parts = text.split(/,(?=\/[^,{}[\]"]*=)/).map((part) => /^\/([^=]+)=(.+)$/s.exec(part));
  return parts.every((part) => part !== null) ? parts.map((part) => [part?.[1] ?? "", part?.[2] ?? ""]) : null;
}

/** Readable name of a scene and its variation: "free_asymmetric{/duration=20}" becomes "free_asymmetric, duration 20 s".
 * Other names are returned as one line. */
export function sceneLabel(name: string): string {
  const plain = oneLine(name);
  const parts = /^([^{]*)\{(\/.*)\}$/.exec(plain);
  const changes = parts === null ? null : changesOf(parts[2] ?? "");
  if (parts === null || changes === null) return plain;
  return [parts[1] ?? "", ...changes.map(([pointer, value]) => {
    const keys = pointer.split("/");
    const key = keys.filter((one) => !/^\d+$/.test(one)).pop() ?? "";
    const path = keys.map((one, i) => (/^\d+$/.test(one) ? `[${one}]` : (i > 0 ? "." : "") + one)).join("").replace(/_/g, " ");
    const unit = units[key] ?? "";
    return `${path} ${value}${unit === "" ? "" : ` ${unit}`}`;
  })].join(", ");
}

/** Escapes for plotly, which interprets <b>, <a href> and entities in every text. */
export function plotText(text: string, length = 80): string {
  return shorten(oneLine(text), length).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

export type Cell = string | number | null;

/** Text of a cell; numbers with all digits. */
export function cellText(cell: Cell | undefined): string {
  return cell === null || cell === undefined ? "" : String(cell);
}

/** CSV as in RFC 4180, with line feeds. Text that a spreadsheet would run as a formula gets a leading apostrophe. */
export function csv(columns: string[], rows: Cell[][]): string {
  const field = (cell: Cell | undefined): string => {
    let text = cellText(cell);
    if (typeof cell === "string" && /^[=+@\t\r]/.test(text)) text = `'${text}`;
    return /[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  };
  return [columns, ...rows].map((row) => `${row.map(field).join(",")}\n`).join("");
}

const latexSpecials: Record<string, string> = {
  "\\": "\\textbackslash{}",
  "{": "\\{",
  "}": "\\}",
  $: "\\$",
  "&": "\\&",
  "#": "\\#",
  _: "\\_",
  "%": "\\%",
  "^": "\\textasciicircum{}",
  "~": "\\textasciitilde{}",
  "<": "\\textless{}",
  ">": "\\textgreater{}",
  "|": "\\textbar{}",
  '"': "\\textquotedbl{}",
};

export function latexText(text: string): string {
  return oneLine(text).replace(/[\\{}$&#_%^~<>|"]/g, (found) => latexSpecials[found] ?? found);
}

/** Number in math mode: 1.59e-5 becomes $1.59 \times 10^{-5}$. */
export function latexNumber(text: string): string {
  const parts = /^(-?)([\d.]+)e([+-]?)(\d+)$/.exec(text);
  if (parts) return `$${parts[1]}${parts[2]} \\times 10^{${parts[3] === "-" ? "-" : ""}${parts[4]}}$`;
  return /^-/.test(text) ? `$${text}$` : text;
}

/** LaTeX table for the package booktabs. Cells are the displayed texts; numeric columns are right-aligned. */
export function latex(columns: { name: string; numeric: boolean }[], rows: string[][], caption: string): string {
  const line = (cells: string[]): string => `    ${cells.join(" & ")} \\\\\n`;
  const body = rows.map((row) =>
    line(columns.map((column, i) => (column.numeric ? latexNumber(row[i] ?? "") : latexText(row[i] ?? "")))),
  );
  return (
    "% needs \\usepackage{booktabs}\n\\begin{table}\n  \\centering\n" +
    `  \\caption{${latexText(caption)}}\n` +
    `  \\begin{tabular}{${columns.map((column) => (column.numeric ? "r" : "l")).join("")}}\n    \\toprule\n` +
    line(columns.map((column) => latexText(column.name.replace(/_/g, " ")))) +
    `    \\midrule\n${body.join("")}    \\bottomrule\n  \\end{tabular}\n\\end{table}\n`
  );
}
