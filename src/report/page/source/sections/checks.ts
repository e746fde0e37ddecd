import { element } from "../dom.ts";
import { errorDecades, quantity, significant } from "../format.ts";
import { axis, Plot, type Layout, type Trace } from "../plot.ts";
import { fileName, named, namedScene, sceneName, type Section, type Tools } from "../tools.ts";
import { oneLine, plotText, shorten } from "../text.ts";
import { writeFragment } from "../fragment.ts";
import { swatch } from "../marks.ts";
import type { Check } from "../data.ts";
import { palette } from "./inertia.ts";
import { positive } from "./work_precision.ts";

const symbols = ["circle", "square", "triangle-up", "diamond", "triangle-down", "pentagon"];

function blockTable(check: Check): HTMLElement | null {
  if (check.blocks.length === 0) return null;
  const head = ["", "largest error", "limit", "at (s)", ""].map((text, i) => element("th", { scope: "col", class: i > 0 && i < 4 ? "number plain" : "plain" }, text || element("span", { class: "unseen" }, i === 0 ? "quantity" : "verdict")));
  return element(
    "table", { class: "blocks" },
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...check.blocks.map((block) =>
      element("tr", {}, element("th", { scope: "row", class: "plain" }, shorten(oneLine(block.name), 60)), element("td", { class: "number" }, quantity(block.error, shorten(oneLine(block.unit), 20)) || "–"),
        element("td", { class: "number" }, block.limit === null ? "none" : quantity(block.limit, shorten(oneLine(block.unit), 20))), element("td", { class: "number" }, significant(block.at, 4)),
        element("td", { class: block.passed === false ? "bad" : null }, block.passed === null ? "" : block.passed ? "within limit" : "over limit")))),
  );
}

function errorPlot(tools: Tools, check: Check): HTMLElement | null {
  const drawable = check.errors.filter((error) => error.values.some((value) => positive(value) !== null && value !== 0));
  if (drawable.length === 0) return null;
  const plot = new Plot(tools.page, `Errors over time: ${shorten(oneLine(check.file), 60)}`, "", () => fileName("check", check.file), 320);
  const limits = check.blocks.filter((block) => block.limit !== null && block.limit > 0 && drawable.some((error) => error.name === block.name));
  const colorAt = (i: number, dark: boolean): string => (dark ? palette[i % palette.length]?.dark : palette[i % palette.length]?.light) ?? "#808080";
  const symbolAt = (i: number): string => symbols[i % symbols.length] ?? "circle";
  const label = (error: Check["errors"][number]): string => shorten(oneLine(error.name), 40) + (error.unit === "" ? "" : ` (${shorten(oneLine(error.unit), 20)})`);
  // the first sample has only the rounding of the start, many decades below the others
  const decades = errorDecades([...drawable.flatMap((error) => error.values.slice(1)), ...limits.map((block) => block.limit)]);
  plot.draw((theme) => {
    const traces = drawable.map((error, i): Trace => ({
      type: "scatter", mode: "lines+markers", name: plotText(label(error)), x: check.t, y: error.values.map((value) => (value === 0 ? null : positive(value))), connectgaps: false,
      text: error.values.map((value, n) => `${plotText(error.name, 40)}: ${plotText(quantity(value, error.unit), 40)}<br>at ${significant(check.t[n], 4)} s`), hoverinfo: "text",
      line: { color: colorAt(i, theme.dark), width: 1.6 }, marker: { color: colorAt(i, theme.dark), size: 6, symbol: symbolAt(i), maxdisplayed: 16 },
    } as Trace));
    const layout: Layout = {
      xaxis: axis(theme, "time (s)", false), yaxis: axis(theme, "error", true, decades === null ? {} : { range: [decades[0] - 0.1, decades[1] + 0.2], autorange: false }),
      shapes: limits.map((block) => ({ type: "line", xref: "paper", x0: 0, x1: 1, y0: block.limit, y1: block.limit, line: { color: colorAt(drawable.findIndex((error) => error.name === block.name), theme.dark), width: 1.4, dash: "dash" } })) as Layout["shapes"],
      // equal limits share a label
      annotations: [...new Set(limits.map((block) => block.limit))].map((limit) => ({
        xref: "paper", x: 0.01, xanchor: "left", y: Math.log10(limit ?? 1), yanchor: "bottom", showarrow: false, font: { size: 11, color: theme.faint },
        text: plotText(`limit: ${limits.filter((block) => block.limit === limit).map((block) => block.name).join(", ")}`, 60),
      })) as Layout["annotations"],
    };
    return { traces, layout };
  });
  const legend = element("ul", { class: "inline-legend" }, ...drawable.map((error, i) => {
    const [onLight, onDark] = [swatch({ symbol: symbolAt(i), dash: "solid" }, colorAt(i, false), true), swatch({ symbol: symbolAt(i), dash: "solid" }, colorAt(i, true), true)];
    onLight.classList.add("on-light");
    onDark.classList.add("on-dark");
    return element("li", {}, onLight, onDark, ` ${label(error)}`);
  }));
  return element("div", { class: "body" }, legend, plot.root);
}

export const checks: Section = {
  name: "trajectories",
  title: "Checked trajectories",
  present: (data) => data.checks.length > 0,
  render(host, tools) {
    for (const check of tools.data.checks) {
      const scene = sceneName(tools, check.scene);
      host.append(element(
        "article", { class: "check" },
        element("h3", {}, named(check.file, 70), " ", element("span", { class: check.passed === false ? "verdict bad" : check.passed === true ? "verdict good" : "verdict" }, shorten(oneLine(check.verdict), 200))),
        element("p", { class: "faint" }, "scene ", namedScene(scene, 60),
          check.motion_method !== null && tools.data.motions.length > 0
            ? element("span", {}, " · ", element("a", { href: `#${writeFragment({ section: "motion", scene })}` }, "show its motion"))
            : null),
        check.diagnoses.length > 0 ? element("div", { class: "warning" }, element("strong", {}, "Diagnosis"), element("ul", {}, ...check.diagnoses.slice(0, 20).map((text) => element("li", {}, shorten(oneLine(text), 500))))) : null,
        check.remarks.length > 0 ? element("ul", { class: "remarks" }, ...check.remarks.slice(0, 20).map((text) => element("li", {}, shorten(oneLine(text), 600)))) : null,
        blockTable(check),
        errorPlot(tools, check),
        check.lines.length > 0 ? element("details", {}, element("summary", {}, "Full report"), ...check.lines.slice(0, 200).map((line) => element("p", {}, shorten(oneLine(line), 500)))) : null,
      ));
    }
  },
};
