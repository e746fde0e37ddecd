// The motion view of a scene: the truth and methods in three dimensions, their errors, and the polhode. MotionView
// connects the page's state with the clock, the cameras and the three drawings (bodies, errors, polhode). It redraws
// after changes only, at most once per frame.
//
// State: scene (else motion), motion_methods (list of labels), motion_layout (side, overlay), motion_time (s),
// motion_show (momentum, angular_velocity, contacts, axes, ellipsoid, trail, path, follow), motion_point, motion_body, motion_speed, motion_view (azimuth and
// elevation in degrees, zoom).

import type { PageContext } from "../context.ts";
import type { Motion, MotionMethod, ReportData } from "../data.ts";
import { Choice, element, fill, vector } from "../dom.ts";
import { quantity, significant } from "../format.ts";
import { parseList, writeList } from "../fragment.ts";
import { swatch } from "../marks.ts";
import { oneLine, sceneLabel, shorten } from "../text.ts";
import { type Actor, chosenMethods, errorAt, firstMethods, isDrawn, methodActor, mostMethods, settingOf, titleOf, truthActor } from "./actors.ts";
import { dot, scale, unit, type Vector, vectorAt } from "./algebra.ts";
import { BodyView, type Palette, type Pane, type Shown } from "./body_view.ts";
import { Clock, rateOf } from "./clock.ts";
import { ContactPlots } from "./contacts.ts";
import { CoordinatePlots } from "./coordinate_plot.ts";
import { errorAxes, errorCurves, errorTitle } from "./error_plot.ts";
import { composePanes, download, encodeGif, Recording, videoType } from "./export.ts";
import style from "./motion.css" with { type: "text" };
import { ModeStrip, modesText } from "./mode_strip.ts";
import { Orbit } from "./orbit.ts";
import { PolhodeView } from "./polhode_view.ts";
import { contactSentence, gravitySentence, methodSentence, thinningSentence, truthSentence, windowSentence } from "./sentences.ts";
import { TimePlot } from "./time_plot.ts";

const speeds = ["0.1", "0.25", "0.5", "1", "2", "5", "10"];
/** What is shown at first, as the key motion_show. */
const atFirst = (motion: Motion): string => motion.contacts.length > 0 ? "angular_velocity,contacts" : "angular_velocity,momentum";
// GIF: delay between frames, ms; frames; width, pixels
const gifDelay = 80;
const mostFrames = 250;
const gifWidth = 640;
// delay of texts for screen readers, ms
const quiet = 1500;

/** A mounted view. */
export interface MotionHandle {
  /** Draws the motions of another document. Keeps the time, the camera and all choices. */
  replace(data: ReportData): void;
}

/** Mounts the view in an empty element; null if there is no motion to draw. `choosesMethods`: with lists of methods. */
export function mountMotion(host: HTMLElement, data: ReportData, page: PageContext, choosesMethods = true): MotionHandle | null {
  if (data.motions.length === 0) {
    host.append(element("p", {}, "The directory has no scene with a motion to draw."));
    return null;
  }
  if (document.getElementById("motion-style") === null) document.head.append(element("style", { id: "motion-style" }, style));
  const view = new MotionView(host, data, page, choosesMethods);
  view.start();
  return view;
}

class MotionView implements MotionHandle {
  private motion: Motion;
  private actors: Actor[] = [];
  private panes: (Pane & { figure: HTMLElement; labels: HTMLElement; value: HTMLElement; ended: HTMLElement; axes: SVGElement })[] = [];
  private readonly clock: Clock;
  private readonly orbit: Orbit;
  private readonly polhodeOrbit: Orbit;
  private readonly bodies: BodyView;
  private readonly errors: TimePlot;
  private readonly modes: ModeStrip;
  private readonly contacts: ContactPlots;
  private readonly coordinates: CoordinatePlots;
  private readonly polhode: PolhodeView;
  private asked = ""; // state of the last build()
  private frame = 0;
  private spoken = 0;

  private readonly root = element("div", { class: "motion-view" });
  private readonly which: Choice;
  private readonly methodChoices: Choice[];
  private readonly layout: Choice;
  private readonly bodyChoice: Choice;
  private readonly speed: Choice;
  private readonly pointChoice: Choice;
  private recording: Recording | null = null;
  private makesGif = false;
  private readonly toggles: [string, HTMLButtonElement][];
  private readonly stage = element("div", { class: "motion-panes" });
  private readonly fault = element("p", { class: "fault", role: "alert", hidden: true });
  private readonly substitute = element("p", { class: "note", hidden: true });
  private readonly play = element("button", { type: "button", class: "play" }, "Play");
  private readonly png = element("button", { type: "button", title: "Save the bodies as PNG", onclick: () => this.savePicture() }, "PNG");
  private readonly video = element("button", { type: "button", title: "Record the motion from now to its end as a video", hidden: videoType() === "", onclick: () => this.record() }, "Video");
  private readonly gif = element("button", { type: "button", title: "Save the motion from now to its end as an animated GIF", onclick: () => void this.saveGif() }, "GIF");
  private readonly slider = element("input", { type: "range", min: 0, step: "any", "aria-label": "Time" });
  private readonly clockText = element("output", {});
  private readonly now = element("p", { class: "motion-now" });
  private readonly live = element("p", { class: "unseen", "aria-live": "polite" });
  private readonly legend = element("ul", { class: "motion-legend" });
  private readonly remarks = element("ul", { class: "motion-remarks" });
  private readonly plots = element("div", { class: "motion-plots" });
  private readonly eventSteps = ([[-1, "‹ event", "Previous event (key [)"], [1, "event ›", "Next event (key ])"]] as const)
    .map(([sign, text, title]) => element("button", { type: "button", title, "aria-label": title, onclick: () => this.stepToEvent(sign) }, text));
  private readonly polhodeText = element("figcaption");
  private readonly worldText = element("figcaption");

  constructor(private readonly host: HTMLElement, private data: ReportData, private readonly page: PageContext, private readonly choosesMethods: boolean) {
    this.motion = this.chosenMotion();
    this.clock = new Clock(this.motion.duration, () => this.redraw(), () => this.paused());
    this.orbit = new Orbit({ azimuth: 0.7, elevation: 0.36 }, () => this.redraw(), () => this.remember({ motion_view: this.orbit.text() }));
    this.polhodeOrbit = new Orbit({ azimuth: 0.7, elevation: 0.42 }, () => this.redraw());
    this.bodies = new BodyView(() => this.redraw());
    const go = (time: number, done: boolean): void => this.scrub(time, done);
    this.errors = new TimePlot(errorTitle, go, 220, "motion-errors");
    this.modes = new ModeStrip(go);
    this.contacts = new ContactPlots(go);
    this.coordinates = new CoordinatePlots(go);
    this.polhode = new PolhodeView(element("canvas", { role: "img" }), element("canvas", { role: "img" }));

    this.which = new Choice("Scene", (name) => this.page.set({ motion: name }));
    this.methodChoices = Array.from({ length: mostMethods }, (_, i) => new Choice(["Method", "Second method", "Third method"][i] ?? "", () => this.chooseMethods()));
    this.layout = new Choice("Layout", (value) => this.page.set({ motion_layout: value }));
    this.bodyChoice = new Choice("Arrows and curves of body", (value) => this.page.set({ motion_body: value }));
    this.speed = new Choice("Speed", (value) => this.page.set({ motion_speed: value === "1" ? "" : value }));
    this.pointChoice = new Choice("Trace of", (value) => this.page.set({ motion_point: value === "tip" ? "" : value }));
    this.toggles = ([["momentum", "L", "Arrow of L, the angular momentum"], ["angular_velocity", "ω", "Arrow of ω, the angular velocity"], ["contacts", "Contact", "Contact points with arrows of the normal force N, the friction F and the slip u"], ["axes", "Axes", "Body axes"],
      ["ellipsoid", "Ellipsoid", "Inertia ellipsoid, on which the tip of ω moves"], ["trail", "Trail", "Trail of a point of the body"], ["path", "Path", "Path of a point of the body from the start"],
      ["follow", "Follow", "Follow the bodies with the camera"]] as const)
      .map(([key, text, title]) => [key, element("button", { type: "button", title, "aria-label": title, onclick: () => this.toggle(key) }, text)]);
  }

  start(): void {
    const { root, clock, page } = this;
    this.play.addEventListener("click", () => this.playOrPause());
    this.slider.addEventListener("input", () => this.scrub(Number(this.slider.value), false));
    this.slider.addEventListener("change", () => this.scrub(Number(this.slider.value), true));
    const step = (sign: number, text: string, title: string): HTMLElement =>
      element("button", { type: "button", title, "aria-label": title, onclick: () => this.step(sign) }, text);
    this.orbit.attach(this.stage);
    this.polhodeOrbit.attach(this.polhode.polhodeCanvas);
    root.addEventListener("keydown", (event) => this.key(event));
    fill(root,
      element("div", { class: "motion-controls" }, this.which.root, ...this.methodChoices.map((choice) => choice.root), this.layout.root, this.bodyChoice.root,
        element("div", { class: "motion-toggles", role: "group", "aria-label": "Arrows and traces" }, ...this.toggles.map(([, button]) => button)), this.pointChoice.root,
        element("div", { class: "motion-toggles", role: "group", "aria-label": "Export" }, this.png, this.gif, this.video)),
      this.substitute, this.fault,
      element("div", { class: "motion-stage" }, this.stage, this.orbit.buttons("bodies")),
      element("div", { class: "motion-time" }, this.play, step(-1, "‹", "One step back (key ,)"), step(1, "›", "One step forward (key .)"), this.slider, ...this.eventSteps, this.clockText, this.speed.root),
      this.now, this.modes.root, this.live, this.legend,
      element("div", { class: "motion-curves" },
        element("figure", { class: "errors" }, this.errors.root as unknown as HTMLElement, element("figcaption", {}, "Attitude error over time. Click to set the time.")),
        element("figure", { class: "polhode" }, element("div", { class: "turned" }, this.polhode.polhodeCanvas, this.polhodeOrbit.buttons("polhode")), this.polhodeText),
        element("figure", { class: "herpolhode" }, this.polhode.worldCanvas, this.worldText)),
      this.plots,
      this.remarks);
    this.host.append(root);
    fill(this.plots, ...this.contacts.figures, ...this.coordinates.figures);
    page.onState(() => this.follow());
    page.onTheme(() => {
      this.asked = "";
      this.follow();
    });
    new ResizeObserver(() => this.redraw()).observe(root);
    // pauses when out of view
    new IntersectionObserver((entries) => {
      if (entries.every((entry) => !entry.isIntersecting)) clock.pause();
    }).observe(root);
    this.follow();
  }

  replace(data: ReportData): void {
    this.data = data;
    this.motion = this.chosenMotion();
    this.clock.duration = this.motion.duration;
    this.clock.go(this.clock.time);
    this.asked = "";
    this.follow();
  }

  private chosenMotion(): Motion {
    const { scenes, motions } = this.data;
    const of = (name: string): Motion | undefined => {
      const scene = scenes.find((one) => one.name === name);
      return scene?.motion === null || scene === undefined ? undefined : motions[scene.motion];
    };
    return of(this.page.get("scene") || (scenes[0]?.name ?? "")) ?? of(this.page.get("motion")) ?? (motions[0] as Motion);
  }

  private nameOf(motion: Motion): string {
    return this.data.scenes[motion.scene]?.name ?? "";
  }

  private methods(): MotionMethod[] {
    const asked = this.page.get("motion_methods");
    return asked === "" ? firstMethods(this.motion) : chosenMethods(this.motion, parseList(asked));
  }

  private shown(): Shown {
    const keys = (this.page.get("motion_show") || atFirst(this.motion)).split(",");
    const body = this.motion.bodies.findIndex((one) => one.name === this.page.get("motion_body"));
    const has = (key: string): boolean => keys.includes(key);
    const point = (["x", "y", "z"] as const).find((one) => one === this.page.get("motion_point")) ?? "tip";
    return { momentum: has("momentum"), angularVelocity: has("angular_velocity"), trail: has("trail"), path: has("path"), axes: has("axes"), ellipsoid: has("ellipsoid"), contacts: has("contacts"), follow: has("follow"), point, body: Math.max(0, body) };
  }

  /** Applies the state. Expensive parts are rebuilt only after a change. */
  private follow(): void {
    const { page } = this;
    const motion = this.chosenMotion();
    if (motion !== this.motion) {
      this.clock.pause();
      this.motion = motion;
      this.clock.duration = motion.duration;
      this.clock.go(0);
    }
    const time = Number(page.get("motion_time"));
    if (!this.clock.playing) this.clock.go(time);
    this.clock.speed = Number(page.get("motion_speed") || "1") || 1;
    const methods = this.methods();
    const overlaid = page.get("motion_layout") === "overlay";
    const { body } = this.shown();
    const asked = JSON.stringify([motion.scene, methods.map((one) => one.label), overlaid, body, page.dark()]);
    if (asked !== this.asked) {
      this.asked = asked;
      this.build(methods, overlaid, body);
    }
    this.orbit.read(page.get("motion_view"));
    const shown = this.shown();
    for (const [key, button] of this.toggles) {
      const field = (key === "angular_velocity" ? "angularVelocity" : key) as "momentum" | "angularVelocity" | "contacts" | "trail" | "path" | "axes" | "ellipsoid" | "follow";
      button.setAttribute("aria-pressed", String(shown[field]));
      button.hidden = (key === "follow" && (!motion.moving || motion.pivot !== null)) || (key === "contacts" && motion.contacts.length === 0);
    }
    this.pointChoice.update([["tip", "tip"], ["x", "x axis"], ["y", "y axis"], ["z", "z axis"]], shown.point);
    this.pointChoice.root.hidden = !shown.trail && !shown.path;
    this.speed.update(speeds.map((value) => [value, `${value}×`]), String(this.clock.speed));
    this.redraw();
  }

  private palette(): Palette {
    const values = getComputedStyle(document.documentElement);
    const dark = this.page.dark();
    const value = (names: string[], otherwise: string): string => names.map((name) => values.getPropertyValue(name).trim()).find((text) => /^#[0-9a-f]{3,8}$/i.test(text)) ?? otherwise;
    return {
      ground: value(["--ground"], dark ? "#14171b" : "#ffffff"), ink: value(["--ink"], dark ? "#e6e9ed" : "#1c2127"),
      muted: value(["--muted", "--faint"], dark ? "#a0a8b2" : "#59616b"), line: value(["--line"], dark ? "#353b43" : "#d9dde2"), dark,
    };
  }

  private build(methods: MotionMethod[], overlaid: boolean, body: number): void {
    const { motion, data, page } = this;
    const dark = page.dark();
    const truth = truthActor(motion, dark);
    const others = truth.keyframes === null ? [] : methods.map((method, i) => methodActor(data, motion, method, truth.keyframes as NonNullable<Actor["keyframes"]>, i + 1, dark));
    this.actors = [truth, ...others];
    this.bodies.show(motion, this.actors, overlaid, this.palette(), body);
    this.orbit.setHome(this.bodies.extent.azimuth);
    this.polhode.show(motion, this.actors, body);
    const errors = errorCurves(this.actors);
    this.errors.show(errors, errorAxes(errors), motion.duration);
    this.modes.show(motion.timeline, motion.duration, dark);
    this.contacts.show(motion, body, dark);
    this.coordinates.show(motion, body, dark);
    for (const button of this.eventSteps) button.hidden = (motion.timeline?.events.length ?? 0) === 0;

    const groups = overlaid ? [this.actors] : this.actors.map((actor) => [actor]);
    this.panes = groups.map((group) => this.pane(group));
    this.stage.dataset.count = String(this.panes.length);
    fill(this.stage, ...this.panes.map((pane) => pane.figure));

    const scenes = [...new Set(data.motions)].map((one) => this.nameOf(one));
    const asked = page.get("scene") || (data.scenes[0]?.name ?? "");
    const isSubstitute = data.scenes.find((one) => one.name === asked)?.motion === null;
    this.which.update(scenes.map((name) => [name, shorten(sceneLabel(name), 44)]), this.nameOf(motion));
    this.which.root.hidden = !isSubstitute || scenes.length < 2;
    this.substitute.hidden = !isSubstitute;
    this.substitute.textContent = isSubstitute ? `No motion is available for ${shorten(sceneLabel(asked), 100)}; showing ${shorten(sceneLabel(this.nameOf(motion)), 100)}.` : "";
    // methods without a motion come last and are marked
    const offered = [true, false].flatMap((drawn) => motion.methods.filter((method) => isDrawn(method) === drawn)
      .map((method): [string, string] => [method.label, `${shorten(titleOf(method), 60)}${drawn ? "" : " (no motion)"}`]));
    this.methodChoices.forEach((choice, i) => {
      const value = methods[i]?.label ?? "";
      choice.update([["", "none"], ...offered], value);
      choice.root.hidden = !this.choosesMethods || motion.methods.length === 0 || i > methods.length;
    });
    this.layout.update([["side", "side by side"], ["overlay", "overlaid"]], overlaid ? "overlay" : "side");
    this.layout.root.hidden = methods.length === 0;
    this.bodyChoice.update(motion.bodies.map((one) => [one.name, shorten(oneLine(one.name), 40)]), motion.bodies[body]?.name ?? "");

    fill(this.legend, ...this.actors.map((actor) => {
      const method = actor.method;
      const setting = method === null ? "" : settingOf(method);
      const greatest = method?.difference === null || method === null ? "" : `largest error ${quantity(method.difference, "rad")}`;
      return element("li", {}, swatch(actor.mark, actor.color, true), element("span", { class: "name", title: actor.name }, setting === "" ? actor.name : `${actor.name}, ${setting}`), element("span", { class: "value" }, greatest));
    }));
    const [ellipsoid, world] = this.polhode.captions();
    this.polhodeText.textContent = ellipsoid;
    this.worldText.textContent = world;
    const rate = rateOf(motion.duration);
    const sentences = [
      ...others.map(methodSentence), thinningSentence(motion), truthSentence(motion), windowSentence(motion), gravitySentence(motion), contactSentence(motion), motion.remark,
      rate === 1 ? "" : `At speed 1×, one second of playback shows ${quantity(rate, "s")} of motion.`,
      this.bodies.extent.follows ? "The camera follows the bodies." : "",
    ];
    fill(this.remarks, ...sentences.filter((text) => text !== "").map((text) => element("li", {}, text)));
    this.slider.max = String(motion.duration);
  }

  private pane(actors: Actor[]): (typeof this.panes)[number] {
    const canvas = element("canvas", { role: "img" });
    const labels = element("div", { "aria-hidden": "true" });
    const value = element("span", { class: "value" });
    const lead = actors[0];
    const name = actors.length === 1 && lead !== undefined ? lead.name : `${actors.map((actor) => actor.name).join(", ")}`;
    const marks = actors.map((actor) => swatch(actor.mark, actor.color, true));
    const ended = element("span", { class: "motion-ended", hidden: true });
    const axes = vector("svg", { class: "motion-axes", viewBox: "-36 -36 72 72", "aria-hidden": "true" });
    const figure = element("figure", { class: "motion-pane" }, element("figcaption", {}, ...marks, element("span", { class: "name", title: name }, name), value), canvas, labels, ended, axes as unknown as HTMLElement);
    return { canvas, actors, figure, labels, value, ended, axes };
  }

  private redraw(): void {
    if (this.frame !== 0) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.draw();
    });
  }

  private draw(): void {
    const t = this.clock.time;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const palette = this.palette();
    const labels = this.bodies.draw(this.panes, t, this.orbit, this.shown(), ratio);
    this.fault.hidden = this.bodies.fault === "";
    if (this.fault.textContent !== this.bodies.fault) this.fault.textContent = this.bodies.fault;
    const told = this.told(t);
    this.panes.forEach((pane, i) => {
      fill(pane.labels, ...(labels[i] ?? []).map((label) => {
        const made = element("span", { class: "motion-label" }, label.actor === null ? null : (swatch(label.actor.mark, label.actor.color, true) as unknown as HTMLElement), label.actor === null ? label.text : shorten(label.text, 24));
        made.style.transform = `translate(${(label.x + 4).toFixed(1)}px, ${(label.y + pane.canvas.offsetTop - 8).toFixed(1)}px)`;
        return made;
      }));
      const only = pane.actors.length === 1 ? pane.actors[0] : undefined;
      pane.value.textContent = only === undefined ? "" : only.method === null ? fixed(t, this.motion.duration) : this.errorText(only, t);
      const over = pane.actors.filter((actor) => actor.method !== null && actor.endsEarly && t > actor.end);
      pane.ended.hidden = over.length === 0;
      pane.ended.textContent = over.map((actor) => (actor.keyframes === null ? `${actor.name}: no motion` : `${pane.actors.length > 1 ? `${actor.name} ` : ""}ended at ${significant(actor.end)} s`)).join("; ");
      pane.canvas.setAttribute("aria-label", `${shorten(oneLine(this.nameOf(this.motion)), 100)}, ${pane.actors.map((actor) => actor.name).join(" and ")}: ${told}`);
      this.drawAxes(pane.axes);
    });
    this.polhode.draw(t, this.polhodeOrbit, palette, ratio);
    const spin = this.polhode.describe(t);
    this.polhode.polhodeCanvas.setAttribute("aria-label", `${this.polhodeText.textContent ?? ""}. At ${significant(t)} s: ${spin}`);
    this.polhode.worldCanvas.setAttribute("aria-label", `${this.worldText.textContent ?? ""}. At ${significant(t)} s: ${spin}`);
    for (const plot of [this.errors, this.modes, this.contacts, this.coordinates]) {
      plot.resize();
      plot.at(t);
    }
    this.slider.value = String(t);
    this.slider.setAttribute("aria-valuetext", `${significant(t)} s`);
    this.clockText.textContent = `${fixed(t, this.motion.duration)} of ${significant(this.motion.duration)} s`;
    this.play.textContent = this.clock.playing ? "Pause" : "Play";
    this.now.textContent = told;
    this.speak(told);
    if (this.recording !== null) composePanes(this.stage, this.recording.canvas, ratio, palette);
    // external drivers of the page wait for this
    this.root.dataset.drawn = t.toPrecision(6);
  }

  /** World axes and the direction of gravity. */
  private drawAxes(svg: SVGElement): void {
    const [right, upward] = this.orbit.axes();
    const place = (v: Vector): [number, number] => [24 * dot(right, v), -24 * dot(upward, v)];
    const made: SVGElement[] = [];
    const axis = (v: Vector, name: string, dash: string): void => {
      const [x, y] = place(v);
      made.push(vector("path", { d: `M0 0L${x.toFixed(1)} ${y.toFixed(1)}`, "stroke-dasharray": dash }));
      const text = vector("text", { x: (1.3 * x).toFixed(1), y: (1.3 * y).toFixed(1) });
      text.textContent = name;
      if (Math.hypot(x, y) > 5) made.push(text);
    };
    axis([1, 0, 0], "x", "none");
    axis([0, 1, 0], "y", "none");
    axis([0, 0, 1], "z", "none");
    const gravity = this.motion.gravity === null ? null : vectorAt(this.motion.gravity);
    if (gravity !== null && Math.hypot(...gravity) > 0) axis(scale(0.9, unit(gravity)), "g", "2 2");
    fill(svg, ...made);
  }

  private errorText(actor: Actor, t: number): string {
    if (actor.method === null) return "";
    const error = errorAt(actor.method, t);
    return error === null ? (actor.keyframes === null ? "not drawn" : t > actor.end ? "ended" : "error unknown") : `error ${quantity(error, "rad", 2)}`;
  }

  private told(t: number): string {
    const errors = this.actors.filter((actor) => actor.method !== null).map((actor) => `${actor.name} ${this.errorText(actor, t)}`);
    const modes = this.motion.timeline === null ? "" : modesText(this.motion.timeline, t);
    const parts = [modes, errors.join(", ")].filter((one) => one !== "");
    return `At ${fixed(t, this.motion.duration)}${parts.length > 0 ? `: ${parts.join("; ")}` : ""}`;
  }

  private speak(text: string): void {
    // no announcements during playback, only after it stops
    window.clearTimeout(this.spoken);
    if (this.clock.playing) return;
    this.spoken = window.setTimeout(() => {
      if (this.live.textContent !== text) this.live.textContent = text;
    }, quiet);
  }

  private remember(values: Record<string, string>): void {
    this.page.set(values);
  }

  private fileName(ending: string): string {
    const name = [this.nameOf(this.motion), ...this.actors.slice(1).map((actor) => actor.name)].join("_").replace(/[^A-Za-z0-9.-]+/g, "_").slice(0, 100);
    return `${name}.${ending}`;
  }

  private savePicture(): void {
    const canvas = element("canvas", {});
    composePanes(this.stage, canvas, Math.min(2, window.devicePixelRatio || 1), this.palette());
    canvas.toBlob((picture) => {
      if (picture === null) this.page.announce("Cannot save the picture");
      else {
        download(picture, this.fileName("png"));
        this.page.announce("PNG saved");
      }
    });
  }

  /** Saves the motion from the present time to its end at the present speed; a second call cancels it. */
  private async saveGif(): Promise<void> {
    if (this.makesGif) {
      this.makesGif = false;
      return;
    }
    this.clock.pause();
    const { duration } = this.clock;
    const start = this.clock.time < duration ? this.clock.time : 0;
    const seconds = (duration - start) / (this.clock.speed * rateOf(duration));
    const frames = Math.max(2, Math.min(mostFrames, Math.round((seconds * 1000) / gifDelay)));
    const canvas = element("canvas", {});
    const ratio = Math.min(1, gifWidth / Math.max(1, this.stage.getBoundingClientRect().width));
    this.makesGif = true;
    this.gif.textContent = "Cancel GIF";
    const draw = (frame: number): void => {
      this.clock.go(start + ((duration - start) * frame) / (frames - 1));
      this.draw();
      composePanes(this.stage, canvas, ratio, this.palette());
    };
    const picture = await encodeGif(canvas, frames, gifDelay, draw, () => this.makesGif && this.root.isConnected);
    this.makesGif = false;
    this.gif.textContent = "GIF";
    this.clock.go(start);
    this.redraw();
    if (picture === null) {
      this.page.announce("No GIF saved");
      return;
    }
    download(picture, this.fileName("gif"));
    this.page.announce("GIF saved");
  }

  /** Records until the motion ends or is paused. */
  private record(): void {
    if (this.recording !== null) {
      if (this.clock.playing) this.clock.pause();
      else this.paused();
      return;
    }
    const recording = new Recording();
    composePanes(this.stage, recording.canvas, Math.min(2, window.devicePixelRatio || 1), this.palette());
    const ready = (): void => {
      if (this.recording === recording) this.clock.play();
    };
    try {
      recording.start(ready, (video, ending) => {
        download(video, this.fileName(ending));
        this.page.announce("Video saved");
      });
    } catch (fault) {
      this.page.announce(`Cannot record: ${fault instanceof Error ? fault.message : String(fault)}`);
      return;
    }
    this.clock.pause();
    this.recording = recording;
    this.video.textContent = "Stop recording";
    this.supplyFrames(recording);
  }

  /** Draws frames of the motion at rest until the recorder has started. */
  private supplyFrames(recording: Recording): void {
    if (this.recording !== recording || this.clock.playing) return;
    this.draw();
    requestAnimationFrame(() => this.supplyFrames(recording));
  }

  private paused(): void {
    this.recording?.stop();
    this.recording = null;
    this.video.textContent = "Video";
    this.remember({ motion_time: this.timeText() });
    this.redraw();
  }

  private timeText(): string {
    const { time } = this.clock;
    // times of events are exact, so that the next event follows from them
    return time > 0 ? String(this.modes.isEvent(time) ? time : Number(time.toPrecision(6))) : "";
  }

  private playOrPause(): void {
    if (this.clock.playing) this.clock.pause();
    else this.clock.play();
    this.play.textContent = this.clock.playing ? "Pause" : "Play";
    this.redraw();
  }

  private scrub(time: number, done: boolean): void {
    if (this.clock.playing) {
      this.clock.go(time);
      this.clock.pause();
    } else this.clock.go(time);
    if (done) this.remember({ motion_time: this.timeText() });
    this.redraw();
  }

  private step(sign: number): void {
    this.scrub(this.clock.time + sign * this.clock.step(), true);
  }

  private stepToEvent(sign: number): void {
    const time = this.modes.neighbour(this.clock.time, sign);
    if (time !== null) this.scrub(time, true);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target instanceof HTMLSelectElement) return;
    if (event.key === "," || event.key === ".") this.step(event.key === "," ? -1 : 1);
    else if (event.key === "[" || event.key === "]") this.stepToEvent(event.key === "[" ? -1 : 1);
    else if (event.key === " " && !(event.target instanceof HTMLButtonElement)) this.playOrPause();
    else return;
    event.preventDefault();
  }

  private chooseMethods(): void {
    const labels = this.methodChoices.filter((choice) => !choice.root.hidden).map((choice) => choice.root.querySelector("select")?.value ?? "");
    const chosen = [...new Set(labels.filter((label) => label !== ""))];
    // "-" stores an empty selection
    this.page.set({ motion_methods: chosen.length > 0 ? writeList(chosen) : "-" });
  }

  private toggle(key: string): void {
    const first = atFirst(this.motion);
    const keys = (this.page.get("motion_show") || first).split(",").filter((one) => one !== "" && one !== "none");
    const after = keys.includes(key) ? keys.filter((one) => one !== key) : [...keys, key];
    const text = after.sort().join(",");
    this.page.set({ motion_show: text === first ? "" : text === "" ? "none" : text });
  }
}

/** A time with a fixed number of decimals for the duration, so that its width is constant. */
function fixed(t: number, duration: number): string {
  const decimals = Math.max(0, Math.min(12, 3 - Math.floor(Math.log10(duration || 1))));
  return duration >= 1e5 || duration < 1e-6 ? quantity(t, "s", 4) : `${t.toFixed(decimals)} s`;
}
