// The view of a live lesson: text, sliders, the motion in three dimensions, graphs and numbers. Every change of a slider
// computes the reference and the update again in the page.
//
// State: lesson (its name), lesson.update, lesson.values (list of QUANTITY:VALUE), and the keys of the motion view with
// the prefix "lesson.".

import type { PageContext } from "../context.ts";
import type { Lesson, Motion, ReportData } from "../data.ts";
import { Choice, element, fill } from "../dom.ts";
import { quantity, significant } from "../format.ts";
import { length } from "../motion/algebra.ts";
import { mountMotion, type MotionHandle } from "../motion/motion.ts";
import { oneLine, shorten } from "../text.ts";
import { type Curve, Graph } from "./graph.ts";
import { kernels } from "./kernels.ts";
import style from "./lesson.css" with { type: "text" };
import { type Sample, tiltOf } from "./mechanics.ts";
import {
  energyAt, errorOfSteps, heightAt, kernelOf, kernelsOf, momentFault, momentumAt, mostSteps, type Results, type Setup, setupOf, simulate, slipAt, spinAt, type Values, valueOf,
} from "./simulate.ts";

const defaultShow = "angular_velocity,momentum";
const positions = 200; // steps of every slider

const quantities: Record<string, [string, string]> = {
  angular_velocity_x: ["ω x", "rad/s"], angular_velocity_y: ["ω y", "rad/s"], angular_velocity_z: ["ω z", "rad/s"],
  moment_x: ["moment about x", "kg m²"], moment_y: ["moment about y", "kg m²"], moment_z: ["moment about z", "kg m²"],
  velocity_x: ["velocity x", "m/s"], velocity_y: ["velocity y", "m/s"], friction: ["friction", ""], tilt: ["tilt", "rad"], gravity: ["gravity", "m/s²"], step: ["step", "s"], duration: ["duration", "s"],
};

/** Slider value at a position, with three digits; the step's slider is logarithmic. */
export function sliderValue(slider: Lesson["sliders"][number], position: number): number {
  const part = position / positions;
  const value = slider.quantity === "step" ? slider.from * (slider.to / slider.from) ** part : slider.from + (slider.to - slider.from) * part;
  return Number(value.toPrecision(3));
}

export function sliderPosition(slider: Lesson["sliders"][number], value: number): number {
  const part = slider.quantity === "step" ? Math.log(value / slider.from) / Math.log(slider.to / slider.from) : (value - slider.from) / (slider.to - slider.from);
  return Math.round(positions * Math.min(1, Math.max(0, part)));
}

/** Parses "step:0.01,tilt:0.3"; ignores what is not a slider of the lesson or out of its range. */
export function parseValues(lesson: Lesson, text: string): Record<string, number> {
  const values: Record<string, number> = {};
  for (const part of text.split(",")) {
    const [name = "", number = ""] = part.split(":");
    const slider = lesson.sliders.find((one) => one.quantity === name);
    const value = Number(number);
    if (slider !== undefined && number !== "" && value >= slider.from && value <= slider.to) values[name] = value;
  }
  return values;
}

const writeValues = (values: Values): string => Object.entries(values).map(([name, value]) => `${name}:${value}`).join(",");

/** The state of the motion view under the prefix "lesson.", with the lesson's own choice of arrows. */
class LessonContext implements PageContext {
  show = "";
  constructor(private readonly page: PageContext) {}
  get(key: string): string {
    return this.page.get(`lesson.${key}`) || (key === "motion_show" ? this.show : "");
  }
  set(values: Record<string, string>): void {
    this.page.set(Object.fromEntries(Object.entries(values).map(([key, value]) => [`lesson.${key}`, key === "motion_show" && value === "" ? defaultShow : value])));
  }
  onState = (listener: () => void): void => this.page.onState(listener);
  dark = (): boolean => this.page.dark();
  onTheme = (listener: () => void): void => this.page.onTheme(listener);
  reducedMotion = (): boolean => this.page.reducedMotion();
  announce = (text: string): void => this.page.announce(text);
}

/** Mounts the lessons of the document in an empty element. */
export function mountLessons(host: HTMLElement, data: ReportData, page: PageContext): void {
  if (document.getElementById("lesson-style") === null) document.head.append(element("style", { id: "lesson-style" }, style));
  new LessonView(host, data, page).start();
}

class LessonView {
  private lesson: Lesson;
  private values: Record<string, number> = {};
  private view: MotionHandle | null = null;
  private asked = "";
  private frame = 0;
  private timer = 0;
  private readonly context: LessonContext;
  private readonly root = element("div", { class: "lesson" });
  private readonly choice = new Choice("Lesson", (name) => this.page.set({ lesson: name, "lesson.values": "", "lesson.update": "", "lesson.motion_time": "", "lesson.motion_show": "" }));
  private readonly updates = new Choice("Update", (name) => this.page.set({ "lesson.update": name === this.lesson.update ? "" : name }));
  private readonly text = element("div", { class: "lesson-text" });
  private readonly sliders = element("div", { class: "lesson-sliders" });
  private readonly fault = element("p", { class: "note", role: "status", hidden: true });
  private readonly numbers = element("p", { class: "lesson-numbers", "aria-live": "polite" });
  private readonly graphs = element("div", { class: "lesson-graphs" });
  private readonly motion = element("div", { class: "motion" });
  private outputs = new Map<string, { input: HTMLInputElement; output: HTMLOutputElement }>();
  private drawn = new Map<string, Graph>();

  constructor(private readonly host: HTMLElement, private readonly data: ReportData, private readonly page: PageContext) {
    this.lesson = data.lessons[0] as Lesson;
    this.context = new LessonContext(page);
  }

  start(): void {
    const reset = element("button", { type: "button", onclick: () => this.page.set({ "lesson.values": "", "lesson.update": "" }) }, "Reset the sliders");
    fill(this.root, this.choice.root, this.text, element("div", { class: "choices" }, this.updates.root, reset), this.sliders, this.fault, this.numbers, this.graphs, this.motion);
    this.host.append(this.root);
    this.page.onState(() => this.follow());
    this.page.onTheme(() => {
      this.asked = "";
      this.follow();
    });
    this.follow();
  }

  /** Applies the state; computes only after a change. */
  private follow(): void {
    const { data, page } = this;
    const lesson = data.lessons.find((one) => one.name === page.get("lesson")) ?? (data.lessons[0] as Lesson);
    const update = kernelOf(lesson, page.get("lesson.update"))?.name ?? lesson.update;
    this.values = parseValues(lesson, page.get("lesson.values"));
    const asked = JSON.stringify([lesson.name, update, this.values, page.dark()]);
    if (asked === this.asked) return;
    this.asked = asked;
    if (lesson !== this.lesson || this.outputs.size === 0) this.build(lesson);
    this.updates.update(kernelsOf(lesson).map((one) => [one.name, `${one.name}: ${one.about}`]), update);
    for (const slider of lesson.sliders) this.showValue(slider, this.values[slider.quantity] ?? valueOf(lesson, slider.quantity), true);
    if (this.frame === 0) this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.compute();
    });
  }

  private build(lesson: Lesson): void {
    this.lesson = lesson;
    this.context.show = lesson.show;
    this.choice.update(this.data.lessons.map((one) => [one.name, shorten(oneLine(one.title), 60)]), lesson.name);
    fill(this.text, element("h3", {}, shorten(oneLine(lesson.title), 200)), ...lesson.text.map((paragraph) => element("p", {}, oneLine(paragraph))));
    this.outputs = new Map();
    fill(this.sliders, ...lesson.sliders.map((slider) => this.slider(slider)));
    this.drawn = new Map(lesson.graphs.map((name) => [name, new Graph(titles[name] ?? name)]));
    fill(this.graphs, ...[...this.drawn.values()].map((graph) => graph.root));
  }

  private slider(slider: Lesson["sliders"][number]): HTMLElement {
    const [name = slider.quantity] = quantities[slider.quantity] ?? [];
    const output = element("output", {});
    const input = element("input", { type: "range", min: 0, max: positions, step: 1, "data-quantity": slider.quantity });
    input.addEventListener("input", () => {
      const value = sliderValue(slider, Number(input.value));
      this.showValue(slider, value, false);
      this.page.set({ "lesson.values": writeValues({ ...this.values, [slider.quantity]: value }) });
    });
    this.outputs.set(slider.quantity, { input, output });
    return element("label", { class: "lesson-slider" }, element("span", {}, name), input, output);
  }

  private showValue(slider: Lesson["sliders"][number], value: number, move: boolean): void {
    const made = this.outputs.get(slider.quantity);
    if (made === undefined) return;
    const [, unit = ""] = quantities[slider.quantity] ?? [];
    const text = slider.quantity === "step" ? `${significant(value)} s, ${significant(1 / value, 3)} Hz` : quantity(value, unit);
    if (move && sliderValue(slider, Number(made.input.value)) !== value) made.input.value = String(sliderPosition(slider, value));
    made.output.textContent = text;
    made.input.setAttribute("aria-valuetext", text);
  }

  private compute(): void {
    const { lesson, values } = this;
    const kernel = kernelOf(lesson, this.page.get("lesson.update")) ?? kernelOf(lesson, lesson.update);
    if (kernel === undefined) return;
    const asked = setupOf(lesson, values);
    const fault = momentFault(asked.central);
    this.fault.hidden = fault === "";
    this.fault.textContent = fault;
    if (fault !== "" && Object.keys(values).some((name) => name.startsWith("moment"))) return;
    const results = simulate(lesson, values, kernel);
    this.showMotion(results.motion);
    this.showNumbers(kernel.name, results);
    this.showGraphs(kernel.name, results);
  }

  private showMotion(motion: Motion): void {
    const scene: ReportData["scenes"][number] = {
      name: this.lesson.scene, about: "", source: "", duration: motion.whole, experiments: [], fastest: [], floor: null, motion: 0,
    };
    const data = { ...this.data, scenes: [scene], motions: [motion] };
    if (this.view === null) this.view = mountMotion(this.motion, data, this.context, false);
    else this.view.replace(data);
  }

  private showNumbers(name: string, { setup, truth, update, motion, left }: Results): void {
    const [first, last] = [update[0], update[update.length - 1]] as [Sample, Sample];
    const change = (of: (sample: Sample) => number): string => {
      const before = of(first);
      return before === 0 ? quantity(of(last), "", 3) : `${significant(100 * (of(last) / before - 1), 3)} %`;
    };
    const error = motion.methods[0]?.difference ?? 0;
    const ended = motion.methods[0]?.status === 0 ? "" : ` The update diverges after ${significant(last.t)} s.`;
    const lifts = left === null ? "" : ` The body leaves the plane at ${significant(left)} s; the page follows the contact up to this time.`;
    const limited = setup.steps === mostSteps ? ` The step is limited to ${significant(setup.step)} s, ${mostSteps} steps.` : "";
    this.numbers.textContent = `${name}: ${setup.steps} steps of ${significant(setup.step)} s; largest attitude error ${quantity(error, "rad")}; energy changes by ${change((sample) => energyAt(setup, sample))}, ` +
      `${length(setup.body.weight) > 0 ? "vertical" : ""} angular momentum by ${change((sample) => momentumAt(setup, sample))}.${ended}${lifts}${limited}`.replace(/^ /, "");
    // for programs that drive the page
    this.root.dataset.result = JSON.stringify({ update: name, steps: setup.steps, duration: setup.duration, q: last.q, w: last.w, p: last.at?.p ?? null, truth: truth[truth.length - 1] ?? null, error });
  }

  private showGraphs(name: string, results: Results): void {
    const dark = this.page.dark();
    const [grey, blue] = [dark ? "#b8bec6" : "#6b7480", dark ? "#7cc0ff" : "#00518a"];
    const { setup, truth, update } = results;
    const two = (of: (sample: Sample) => number): Curve[] => [
      { name: "truth", color: grey, dash: "none", x: truth.map(({ t }) => t), y: truth.map(of) },
      { name, color: blue, dash: "6 3", x: update.map(({ t }) => t), y: update.map(of) },
    ];
    const ends = (of: (sample: Sample) => number, unit: string): string =>
      `Truth (grey) ${significant(of(truth[truth.length - 1] as Sample), 4)} ${unit} at the end, ${name} (blue, dashed) ${significant(of(update[update.length - 1] as Sample), 4)} ${unit}.`;
    for (const [graph, place] of this.drawn) {
      const time = { x: "time (s)", log: false };
      const single = singleGraphs[graph];
      if (single !== undefined) place.show(two((sample) => single.of(setup, sample)), { ...time, y: `${single.label} (${single.unit})` }, ends((sample) => single.of(setup, sample), single.unit));
      else if (graph === "angular_velocity") {
        const colors = dark ? ["#ff9a8a", "#7fd79b", "#7cc0ff"] : ["#b3261e", "#1b7f3b", "#00518a"];
        const curves = ([0, 1, 2] as const).flatMap((i): Curve[] => two(({ w }) => w[i]).map((curve) => ({ ...curve, color: colors[i] ?? grey, thin: curve.name !== "truth" })));
        place.show(curves, { ...time, y: "ω (rad/s)" }, `Components in body axes: x red, y green, z blue; truth solid, ${name} dashed.`);
      } else if (graph === "step_error") this.showOrders(place, name, setup, results.motion.methods[0]?.difference ?? null);
    }
  }

  /** Errors of all updates against the step, computed one update after the other, so that the page stays responsive. */
  private showOrders(graph: Graph, name: string, setup: Setup, error: number | null): void {
    window.clearTimeout(this.timer);
    const slider = this.lesson.sliders.find((one) => one.quantity === "step");
    const [from, to] = [slider?.from ?? setup.step / 10, slider?.to ?? 10 * setup.step];
    const steps = [...new Set(Array.from({ length: 9 }, (_, i) => Math.max(1, Math.ceil(setup.duration / (to * (from / to) ** (i / 8))))))].filter((one) => one <= 20000);
    const dark = this.page.dark();
    const curves: Curve[] = [];
    let at = 0;
    const next = (): void => {
      const kernel = kernels[at++];
      if (kernel === undefined) return;
      const own = kernel.name === name;
      curves.push({
        name: kernel.name, color: own ? (dark ? "#7cc0ff" : "#00518a") : dark ? "#6f7883" : "#9aa2ac", dash: "none", thin: !own,
        x: steps.map((one) => setup.duration / one), y: steps.map((one) => errorOfSteps(kernel, setup, one)),
        ...(own && error !== null && error > 0 ? { mark: [setup.step, error] as [number, number] } : {}),
      });
      curves.sort((a, b) => Number(b.thin === true) - Number(a.thin === true));
      graph.show(curves, { x: "step (s)", y: "largest attitude error (rad)", log: true }, `${name} in blue, ${curves.length - 1} other updates in grey.`);
      this.timer = window.setTimeout(next, 0);
    };
    this.timer = window.setTimeout(next, 250);
  }
}

/** Graphs of one quantity over time. */
const singleGraphs: Record<string, { of: (setup: Setup, sample: Sample) => number; label: string; unit: string }> = {
  energy: { of: energyAt, label: "energy", unit: "J" },
  momentum: { of: momentumAt, label: "momentum", unit: "N m s" },
  tilt: { of: (_, { q }) => tiltOf(q), label: "tilt", unit: "rad" },
  slip: { of: slipAt, label: "slip", unit: "m/s" },
  spin: { of: spinAt, label: "vertical rate", unit: "rad/s" },
  height: { of: heightAt, label: "height", unit: "m" },
};

const titles: Record<string, string> = {
  slip: "Speed of the slip at the contact.", spin: "Angular velocity about the vertical.", height: "Height of the centre of mass.",
  energy: "Energy.", momentum: "Angular momentum.", tilt: "Tilt of the body's z axis.", angular_velocity: "Angular velocity.", step_error: "Error against step.",
};
