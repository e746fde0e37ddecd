import { element } from "../dom.ts";
import { duration, significant } from "../format.ts";
import { TableView } from "../table_view.ts";
import { chosenScene, methodLabel, namedScene, type Section, type Tools } from "../tools.ts";
import type { Cell } from "../text.ts";
import type { Scene } from "../data.ts";

/** Run time of the second fastest method over that of the fastest. */
function factorOf(tools: Tools, entry: Scene["fastest"][number]): number | null {
  const seconds = tools.data.rows.seconds;
  const first = entry.row === null ? null : (seconds[entry.row] ?? null);
  const second = entry.runner_up === null ? null : (seconds[entry.runner_up] ?? null);
  return first === null || second === null || first <= 0 ? null : second / first;
}

export const scenes: Section = {
  name: "scenes",
  title: "Scenes",
  present: (data) => data.scenes.length > 0,
  render(host, tools) {
    const { data, page } = tools;
    const errors = [...new Set(data.scenes.flatMap((scene) => scene.fastest.map((one) => one.error)))].sort((a, b) => b - a);
    const chosen = element("div", { class: "chosen" });
    const columns = [
      { name: "scene", numeric: false },
      ...errors.flatMap((error) => [
        { name: `fastest to ${significant(error)} rad`, numeric: false },
        { name: `factor (${significant(error)})`, numeric: true },
      ]),
      { name: "floor (rad)", numeric: true },
      { name: "duration (s)", numeric: true },
      { name: "about", numeric: false },
    ];
    // one cell more than columns: the index of the scene
    const rows = data.scenes.map((scene, s): Cell[] => [
      scene.name,
      ...errors.flatMap((error): Cell[] => {
        const entry = scene.fastest.find((one) => one.error === error);
        if (entry === undefined) return [null, null];
        const method = entry.row === null ? undefined : data.methods[data.rows.method[entry.row] ?? -1];
        return [method?.name ?? "not reached", method === undefined ? null : factorOf(tools, entry)];
      }),
      scene.floor, scene.duration, scene.about, s,
    ]);
    const placeOf = (row: readonly Cell[]): number => Number(row[row.length - 1]);
    const view = new TableView(page, "scenes", {
      caption: "Scenes, and the fastest method at each accuracy",
      columns,
      rows,
      render: (column, cell, row) => {
        const scene = data.scenes[placeOf(row)];
        if (scene === undefined) return null;
        if (column === 0) {
          const is = placeOf(row) === chosenScene(tools);
          return element("button", { type: "button", class: "pick", "data-scene": placeOf(row), "aria-pressed": String(is), onclick: () => page.set({ scene: scene.name }) }, namedScene(scene.name, 44));
        }
        const among = column - 1 < 2 * errors.length ? column - 1 : -1;
        if (among >= 0 && among % 2 === 0) {
          const entry = scene.fastest.find((one) => one.error === errors[among / 2]);
          const method = entry?.row === null || entry === undefined ? -1 : (data.rows.method[entry.row] ?? -1);
          return method < 0 ? (cell === null ? null : element("span", { class: "faint" }, String(cell))) : methodLabel(tools, method, 26);
        }
        if (among >= 0 && typeof cell === "number") return document.createTextNode(`${significant(cell)}×`);
        return null;
      },
    });
    const show = (): void => {
      const scene = data.scenes[chosenScene(tools)];
      chosen.replaceChildren();
      if (scene === undefined) return;
      chosen.append(
        element("h3", {}, namedScene(scene.name, 90)),
        element("p", {}, [scene.about, scene.source === "" ? "" : `Source: ${scene.source}`].filter((part) => part !== "").map((part) => part.replace(/[^.!?]$/, "$&.")).join(" ").slice(0, 900)),
        element("p", { class: "faint" }, [
          scene.duration === null ? "" : `duration ${duration(scene.duration)}`,
          scene.floor === null ? "" : `binary64 floor ${significant(scene.floor)} rad (error caused by rounding the start)`,
        ].filter((part) => part !== "").join(" · ")),
      );
      for (const button of view.root.querySelectorAll<HTMLElement>("button.pick")) {
        button.setAttribute("aria-pressed", String(Number(button.dataset.scene) === chosenScene(tools)));
      }
    };
    host.append(
      element("p", { class: "explain" }, "All sections below show the selected scene. The factor is the run time of the second fastest method divided by that of the fastest; it is empty if no other method reaches the accuracy."),
      view.root, chosen,
    );
    page.watch(["scene"], show);
    show();
    // scrolls the table, not the page, to the selected scene
    window.setTimeout(() => {
      const row = view.root.querySelector<HTMLElement>('button.pick[aria-pressed="true"]')?.closest("tr");
      const scroller = view.root.querySelector(".scroller");
      if (row && scroller) scroller.scrollTop = Math.max(0, row.offsetTop - 90);
    }, 0);
  },
};
