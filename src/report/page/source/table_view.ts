// A table with sorting, filtering, paging, a choice of columns, and copying as CSV and LaTeX.

import { add, copyText, element, fill, identity } from "./dom.ts";
import { parseFilter } from "./filter.ts";
import { parseList, writeList } from "./fragment.ts";
import { count, counted, significant } from "./format.ts";
import type { Page } from "./state.ts";
import { csv, latex, oneLine, shorten, type Cell } from "./text.ts";

export interface Column {
  name: string;
  numeric: boolean;
  integral?: boolean;
  hidden?: boolean; // not shown by default
}

export interface Content {
  caption: string;
  columns: Column[];
  rows: readonly (readonly Cell[])[];
  total?: number; // rows in the file, if more than given
  /** Custom rendering of a cell; null for the default. */
  render?: (column: number, cell: Cell, row: readonly Cell[]) => Node | null;
}

const rowsPerPage = 100;

/** Displayed text of a cell. */
export function shownCell(column: Column, cell: Cell | undefined): string {
  if (cell === null || cell === undefined) return "";
  if (typeof cell === "number") return column.integral === true ? String(cell) : significant(cell, 4);
  return oneLine(cell);
}

/** Sorts row indices stably: numbers before texts before empty cells. */
export function sortedPlaces(rows: readonly (readonly Cell[])[], places: number[], column: number, descending: boolean): number[] {
  const sign = descending ? -1 : 1;
  const kind = (cell: Cell | undefined): number => (typeof cell === "number" ? 0 : cell === null || cell === undefined || cell === "" ? 2 : 1);
  return [...places].sort((a, b) => {
    const left = rows[a]?.[column] ?? null;
    const right = rows[b]?.[column] ?? null;
    const kinds = kind(left) - kind(right);
    if (kinds !== 0) return kinds;
    if (typeof left === "number" && typeof right === "number") return sign * (left - right) || a - b;
    const [first, second] = [String(left), String(right)];
    return sign * (first < second ? -1 : first > second ? 1 : 0) || a - b;
  });
}

export class TableView {
  readonly root: HTMLElement;
  private readonly state: HTMLElement;
  private readonly fault: HTMLElement;
  private readonly scroller: HTMLElement;
  private readonly pager: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly tools: HTMLElement;
  private places: number[] = [];
  private at = 0;
  private timer = 0;

  /** `key` is the prefix of the table's keys in the state; "" does not store them. */
  constructor(
    private readonly page: Page,
    private readonly key: string,
    private content: Content,
  ) {
    const help = identity("filter");
    this.fault = element("p", { class: "fault", id: help, hidden: true });
    this.input = element("input", {
      type: "search", placeholder: "word  -word  column:word  column>1e-9", spellcheck: "false", autocomplete: "off",
      "aria-describedby": help, "aria-label": `Filter: ${shorten(content.caption, 60)}`,
      oninput: () => {
        window.clearTimeout(this.timer);
        this.timer = window.setTimeout(() => this.store("filter", this.input.value), 180);
      },
    });
    this.state = element("span", { class: "state" });
    this.scroller = element("div", { class: "scroller", tabindex: 0, role: "group", "aria-label": shorten(oneLine(content.caption), 80) });
    this.pager = element("p", { class: "pager" });
    this.tools = element("div", { class: "table-tools" });
    this.root = element("div", { class: "table-view" }, this.tools, this.fault, this.scroller, this.pager);
    if (key !== "") page.watch(["filter", "sort", "columns"].map((name) => `${key}.${name}`), () => this.refresh());
    this.build();
  }

  show(content: Content): void {
    this.content = content;
    this.scroller.setAttribute("aria-label", shorten(oneLine(content.caption), 80));
    this.build();
  }

  private readonly own: Record<string, string> = {};

  private load(name: string): string {
    return this.key === "" ? (this.own[name] ?? "") : this.page.get(`${this.key}.${name}`);
  }

  private store(name: string, value: string): void {
    if (this.key === "") {
      this.own[name] = value;
      this.refresh();
    } else this.page.set({ [`${this.key}.${name}`]: value });
  }

  private build(): void {
    const few = this.content.rows.length <= 8;
    fill(
      this.tools,
      few ? null : element("label", { class: "filter" }, element("span", {}, "Filter"), this.input),
      few ? null : this.help(),
      this.state,
      element("span", { class: "gap" }),
      this.content.columns.length > 6 ? this.chooser() : null,
      element("button", { type: "button", onclick: () => void this.copy("CSV") }, "Copy CSV"),
      element("button", { type: "button", onclick: () => void this.copy("LaTeX") }, "Copy LaTeX"),
    );
    this.refresh();
  }

  private help(): HTMLElement {
    const line = (what: string, means: string): HTMLElement => element("li", {}, element("code", {}, what), ` ${means}`);
    const example = this.content.columns.find((column) => column.numeric)?.name.replace(/\s+/g, "_") ?? "column";
    return element(
      "details",
      { class: "pop" },
      element("summary", {}, "syntax"),
      element(
        "div",
        { class: "pop-body" },
        element("p", {}, "Rows must satisfy all conditions:"),
        element(
          "ul",
          {},
          line("word", "a cell contains the word; put “two words” in straight quotation marks"),
          line("-word", "no cell contains the word"),
          line("column:word", "the cell in this column contains the word"),
          line(`${shorten(example, 24)}>1e-9`, "compares numbers: < <= > >= = !="),
        ),
        element("p", {}, "Write a column's name as in the header, with _ for each space, or a unique prefix of it."),
      ),
    );
  }

  private visible(): number[] {
    const asked = this.load("columns");
    const names = asked === "" ? null : new Set(parseList(asked));
    const shown = this.content.columns.flatMap((column, i) => ((names === null ? column.hidden !== true : names.has(column.name)) ? [i] : []));
    return shown.length > 0 ? shown : this.content.columns.map((_, i) => i);
  }

  private chooser(): HTMLElement {
    const boxes = this.content.columns.map((column, i) =>
      element("label", {}, element("input", {
        type: "checkbox", "data-column": i,
        onchange: () => {
          const chosen = this.content.columns.filter((_, j) => boxes[j]?.querySelector("input")?.checked === true);
          this.store("columns", writeList(chosen.map((one) => one.name)));
        },
      }), shorten(oneLine(column.name), 40)),
    );
    return element(
      "details",
      {
        class: "pop", ontoggle: () => {
          const shown = new Set(this.visible());
          boxes.forEach((box, i) => {
            const input = box.querySelector("input");
            if (input !== null) input.checked = shown.has(i);
          });
        },
      },
      element("summary", {}, "columns"),
      element("div", { class: "pop-body checks" }, ...boxes),
    );
  }

  private refresh(): void {
    if (document.activeElement !== this.input) this.input.value = this.load("filter");
    const names = this.content.columns.map((column) => column.name);
    const filter = parseFilter(this.load("filter"), names);
    this.fault.textContent = filter.fault;
    this.fault.hidden = filter.fault === "";
    let places: number[] = [];
    for (let i = 0; i < this.content.rows.length; ++i) if (filter.matches(this.content.rows[i] ?? [])) places.push(i);
    const [column, descending] = this.sorting();
    if (column >= 0) places = sortedPlaces(this.content.rows, places, column, descending);
    this.places = places;
    this.at = 0;
    const all = this.content.rows.length;
    const beyond = (this.content.total ?? all) - all;
    this.state.textContent =
      (places.length === all ? counted(all, "row") : `${count(places.length)} of ${counted(all, "row")}`) +
      (beyond > 0 ? `; ${count(beyond)} more in the file` : "");
    this.fillRows();
  }

  private sorting(): [number, boolean] {
    const asked = this.load("sort");
    const descending = asked.startsWith("-");
    return [this.content.columns.findIndex((column) => column.name === asked.slice(descending ? 1 : 0) && asked !== ""), descending];
  }

  private fillRows(): void {
    const columns = this.visible();
    const [sorted, descending] = this.sorting();
    const head = element(
      "tr",
      {},
      ...columns.map((c) => {
        const column = this.content.columns[c] as Column;
        const direction = c === sorted ? (descending ? "descending" : "ascending") : "none";
        return element(
          "th",
          { scope: "col", class: column.numeric ? "number" : null, "aria-sort": direction },
          element(
            "button",
            { type: "button", "data-column": c, title: oneLine(column.name).slice(0, 400), onclick: () => this.sortBy(c) },
            shorten(oneLine(column.name).replace(/_/g, " "), 32),
            element("span", { class: "arrow", "aria-hidden": "true" }, direction === "ascending" ? "▲" : direction === "descending" ? "▼" : ""),
          ),
        );
      }),
    );
    const body = element("tbody");
    for (const place of this.places.slice(this.at, this.at + rowsPerPage)) {
      const row = this.content.rows[place] ?? [];
      const line = element("tr");
      for (const c of columns) {
        const column = this.content.columns[c] as Column;
        const cell = row[c] ?? null;
        const own = this.content.render?.(c, cell, row) ?? null;
        const text = own === null ? shownCell(column, cell) : "";
        const short = own === null ? shorten(text, 120) : "";
        const whole = typeof cell === "number" ? String(cell) : text;
        line.append(
          element(
            "td",
            { class: column.numeric || typeof cell === "number" ? "number" : text.length > 30 ? "long" : "short", title: own === null && whole !== short ? whole.slice(0, 2000) : null },
            own ?? short,
          ),
        );
      }
      body.append(line);
    }
    if (this.places.length === 0) body.append(element("tr", {}, element("td", { colspan: Math.max(1, columns.length), class: "empty" }, "no rows")));
    const focused = document.activeElement instanceof HTMLElement && this.scroller.contains(document.activeElement) ? document.activeElement.dataset.column : undefined;
    fill(this.scroller, element("table", {}, element("caption", { class: "unseen" }, shorten(oneLine(this.content.caption), 200)), element("thead", {}, head), body));
    if (focused !== undefined) this.scroller.querySelector<HTMLElement>(`button[data-column="${focused}"]`)?.focus({ preventScroll: true });
    this.showPager();
  }

  private showPager(): void {
    const pages = Math.ceil(this.places.length / rowsPerPage);
    this.pager.hidden = pages < 2;
    const here = Math.floor(this.at / rowsPerPage);
    const button = (text: string, to: number, label: string): HTMLElement =>
      element("button", {
        type: "button", title: label, disabled: to < 0 || to >= pages || to === here,
        onclick: () => {
          this.at = to * rowsPerPage;
          this.fillRows();
          this.scroller.scrollTop = 0;
          this.page.announce(`page ${to + 1} of ${pages}`);
        },
      }, text);
    fill(
      this.pager,
      button("First", 0, "first page"), button("Previous", here - 1, "previous page"), ` page ${count(here + 1)} of ${count(pages)} `,
      button("Next", here + 1, "next page"), button("Last", pages - 1, "last page"),
    );
  }

  /** Cycles through ascending, descending and original order. */
  private sortBy(column: number): void {
    const name = this.content.columns[column]?.name ?? "";
    const [sorted, descending] = this.sorting();
    const next = sorted !== column ? name : descending ? "" : `-${name}`;
    this.store("sort", next);
    this.page.announce(next === "" ? "original order" : `sorted by ${name}, ${next.startsWith("-") ? "descending" : "ascending"}`);
  }

  private async copy(format: "CSV" | "LaTeX"): Promise<void> {
    const columns = this.visible();
    const heads = columns.map((c) => this.content.columns[c] as Column);
    const rows = this.places.map((place) => this.content.rows[place] ?? []);
    const text =
      format === "CSV"
        ? csv(heads.map((head) => head.name), rows.map((row) => columns.map((c) => row[c] ?? null)))
        : latex(heads, rows.map((row) => columns.map((c, i) => shownCell(heads[i] as Column, row[c]))), this.content.caption);
    if (await copyText(text)) this.page.announce(`${counted(rows.length, "row")} copied as ${format}`);
    else this.offer(text);
    this.state.dataset.copied = format;
  }

  /** Shows the text to copy by hand if the clipboard is not accessible. */
  private offer(text: string): void {
    const area = element("textarea", { rows: 8, readonly: true, "aria-label": "Text to copy" });
    area.value = text;
    this.root.querySelector(".offered")?.remove();
    const box = element("div", { class: "offered" }, element("p", {}, "The browser does not allow copying. Copy this text by hand:"), area);
    add(this.root, box);
    area.select();
  }
}
