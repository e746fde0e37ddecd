// The filter of a table: a line of conditions. A row must satisfy all of them.
//
//   word          a cell contains the word, ignoring case           "two words"     quoted words are one word
//   -word         no cell contains the word
//   column:word   the cell of this column contains the word         -column:word    it does not
//   column>1e-9   compares numbers: < <= > >= = != (= and != also compare text)
//
// A column is written as in the header, with _ for each space, or as a unique prefix of it.

import type { Cell } from "./text.ts";

export interface Filter {
  /** Error in the line, or "". */
  fault: string;
  matches(row: readonly Cell[]): boolean;
}

const everything: Filter = { fault: "", matches: () => true };

/** Splits the line into terms; quotation marks protect spaces. */
function termsOf(line: string): string[] {
  return line.match(/(?:"[^"]*"?|[^\s"])+/g) ?? [];
}

const unquoted = (text: string): string => text.replace(/"/g, "");

/** Index of the column with this name or unique prefix; -1 if there is none, -2 if the prefix is ambiguous. */
function columnOf(name: string, columns: readonly string[]): number {
  const plain = (text: string): string => text.toLowerCase().replace(/[\s_]+/g, "_");
  const asked = plain(name);
  const exact = columns.findIndex((column) => plain(column) === asked);
  if (exact >= 0) return exact;
  const begin = columns.flatMap((column, i) => (plain(column).startsWith(asked) ? [i] : []));
  return begin.length === 1 ? (begin[0] ?? -1) : begin.length === 0 ? -1 : -2;
}

export function parseFilter(line: string, columns: readonly string[]): Filter {
  const tests: ((row: readonly Cell[]) => boolean)[] = [];
  for (const term of termsOf(line)) {
    const compared = /^([^<>=!:"]+|"[^"]*")(<=|>=|!=|<|>|=)(.*)$/.exec(term);
    if (compared) {
      const [, name = "", sign = "", rest = ""] = compared;
      const column = columnOf(unquoted(name), columns);
      if (column < 0) return { fault: columnFault(unquoted(name), column), matches: () => true };
      const value = unquoted(rest).trim();
      const number = value === "" ? NaN : Number(value);
      if (Number.isNaN(number) && sign !== "=" && sign !== "!=") {
        return { fault: `${unquoted(name)}${sign} needs a number, such as ${unquoted(name)}${sign}1e-9`, matches: () => true };
      }
      tests.push((row) => compare(row[column] ?? null, sign, value, number));
      continue;
    }
    const negative = term.startsWith("-") && term.length > 1;
    const plain = negative ? term.slice(1) : term;
    const placed = /^([^:"]+|"[^"]*"):(.*)$/.exec(plain);
    const column = placed ? columnOf(unquoted(placed[1] ?? ""), columns) : -1;
    // a colon may belong to the word, as in bullet:default
    const word = unquoted(placed && column >= 0 ? (placed[2] ?? "") : plain).toLowerCase();
    if (word === "") continue;
    // formatting numbers is slow, so it is skipped for words that no number contains
    const numeric = /^[-+.\de]+$/.test(word);
    const holds = (cell: Cell): boolean => (typeof cell === "string" ? cell.toLowerCase().includes(word) : numeric && cell !== null && String(cell).includes(word));
    tests.push((row) => (column >= 0 ? holds(row[column] ?? null) : row.some(holds)) !== negative);
  }
  if (tests.length === 0) return everything;
  return { fault: "", matches: (row) => tests.every((test) => test(row)) };
}

function columnFault(name: string, column: number): string {
  return column === -2 ? `several columns start with ${name}; write more of the name` : `no column is named ${name}`;
}

function compare(cell: Cell, sign: string, value: string, number: number): boolean {
  if (sign === "=" || sign === "!=") {
    const same =
      typeof cell === "number" && !Number.isNaN(number)
        ? cell === number
        : (cell === null ? "" : String(cell)).toLowerCase() === value.toLowerCase();
    return same === (sign === "=");
  }
  const left = typeof cell === "number" ? cell : cell === null || cell.trim() === "" ? NaN : Number(cell);
  switch (sign) {
    case "<":
      return left < number;
    case "<=":
      return left <= number;
    case ">":
      return left > number;
    default:
      return left >= number;
  }
}
