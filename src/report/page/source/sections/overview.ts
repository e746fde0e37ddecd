import { element } from "../dom.ts";
import { count, counted } from "../format.ts";
import { statuses } from "../rows.ts";
import { oneLine, sceneLabel, shorten } from "../text.ts";
import type { Experiment } from "../data.ts";
import type { Section, Tools } from "../tools.ts";

/** Facts shared by more than half of the experiments. */
export function sharedFacts(experiments: readonly Experiment[]): [string, string][] {
  const held = new Map<string, Map<string, number>>();
  for (const { facts } of experiments) {
    for (const [name, value] of facts) {
      const values = held.get(name) ?? new Map<string, number>();
      held.set(name, values.set(value, (values.get(value) ?? 0) + 1));
    }
  }
  return [...held.entries()].flatMap(([name, values]) =>
    [...values.entries()].filter(([, times]) => 2 * times > experiments.length).map(([value]): [string, string] => [name, value]));
}

function factList(facts: readonly [string, string][]): HTMLElement | null {
  if (facts.length === 0) return null;
  return element(
    "dl",
    { class: "facts" },
    ...facts.flatMap(([name, value]) => [
      element("dt", {}, shorten(oneLine(name), 60)),
      element("dd", { title: oneLine(value).slice(0, 2000) }, shorten(oneLine(value), 240)),
    ]),
  );
}

function statusCounts(tools: Tools): HTMLElement | null {
  const rows = tools.data.rows;
  if (rows.count === 0) return null;
  const counts = statuses.map(() => 0);
  for (const status of rows.status) counts[status] = (counts[status] ?? 0) + 1;
  return element(
    "ul",
    { class: "figures" },
    ...statuses.flatMap((status, i) =>
      (counts[i] ?? 0) > 0 ? [element("li", {}, element("strong", {}, count(counts[i])), ` ${status}`)] : [],
    ),
  );
}

/** Replaces the names of varied scenes in a text by their readable names. */
function labelScenes(tools: Tools, text: string): string {
  return text.includes("{/") ? tools.data.scenes.filter((scene) => scene.name.includes("{/")).reduce((all, { name }) => all.replaceAll(oneLine(name), sceneLabel(name)), text) : text;
}

export const overview: Section = {
  name: "overview",
  title: "Overview",
  present: (data) => !data.lesson_page,
  render(host, tools) {
    const { data } = tools;
    const used = new Set(data.rows.method);
    for (const drift of data.drift) used.add(drift.method);
    const quick = data.experiments.filter((one) => one.quick);
    const parts = [
      data.scenes.length > 0 ? counted(data.scenes.length, "scene") : "",
      used.size > 0 ? counted(used.size, "method") : "",
      data.rows.total > 0 ? counted(data.rows.total, "result row") : "",
      data.tables.length > 0 ? counted(data.tables.length, "table") : "",
    ].filter((part) => part !== "");
    host.append(
      element("p", { class: "lead" }, parts.length > 0 ? `${parts.join(", ")}.` : "The directory contains no results that this page can show."),
    );
    const counts = statusCounts(tools);
    if (counts !== null) host.append(counts);
    if (quick.length > 0) {
      host.append(
        element("p", { class: "warning" },
          `${quick.length === data.experiments.length ? "These are quick runs" : `Quick runs: ${shorten(quick.map((one) => one.name).join(", "), 200)}`}: fewer scenes, settings and repeats; run times are approximate.`),
      );
    }
    if (data.findings.length > 0) {
      host.append(
        element(
          "ul",
          { class: "cards" },
          ...data.findings.slice(0, 3).map((finding) =>
            element("li", {}, element("a", { class: "card", href: /^#/.test(finding.link) ? finding.link : "#section=overview" },
              element("strong", {}, shorten(labelScenes(tools, oneLine(finding.title)), 120)), element("span", {}, shorten(labelScenes(tools, oneLine(finding.text)), 400)))),
          ),
        ),
      );
    }
    if (data.experiments.length > 0) {
      const shared = sharedFacts(data.experiments);
      host.append(element("h3", {}, "Provenance"));
      const facts = factList(shared);
      if (facts !== null) host.append(facts);
      const rows = new Map<number, number>();
      for (const experiment of data.rows.experiment) rows.set(experiment, (rows.get(experiment) ?? 0) + 1);
      const list = element(
          "ul",
          { class: "experiments" },
          ...data.experiments.map((one, i) => {
            const own = one.facts.filter((fact) => !shared.includes(fact) && !shared.some(([n, v]) => n === fact[0] && v === fact[1]));
            const line = [
              element("strong", {}, shorten(oneLine(one.name), 60)), one.quick ? element("span", { class: "badge" }, "quick") : null,
              one.about === "" ? null : ` ${shorten(oneLine(one.about), 300)}`,
              element("span", { class: "faint" }, [one.kind, one.date.slice(0, 10), (rows.get(i) ?? 0) > 0 ? counted(rows.get(i) ?? 0, "row") : ""].filter((part) => part !== "").map((part) => ` · ${oneLine(part)}`).join("")),
            ];
            return own.length === 0
              ? element("li", {}, ...line)
              : element("li", {}, element("details", {}, element("summary", {}, ...line), factList(own)));
          }),
        );
      const told = data.experiments.some((one) => one.facts.some(([n, v]) => !shared.some((fact) => fact[0] === n && fact[1] === v)));
      host.append(
        data.experiments.length > 6
          ? element("details", { class: "numbers" }, element("summary", {}, `${counted(data.experiments.length, "experiment")}${told ? ", some with different provenance" : ""}`), list)
          : list,
      );
    }
    if (data.remarks.length > 0) {
      host.append(element("h3", {}, "Remarks"), element("ul", { class: "remarks" }, ...data.remarks.map((remark) => element("li", {}, shorten(oneLine(remark), 600)))));
    }
    host.append(
      element("p", { class: "faint" }, `Created by polhode ${shorten(oneLine(data.version), 60)} on ${oneLine(data.made).slice(0, 40)}. This page makes no network requests and can be shared as a single file.`),
    );
  },
};
