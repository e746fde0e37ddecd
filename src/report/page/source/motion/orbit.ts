// The camera of a view, controlled by pointer, wheel, pinch and buttons.

import { element } from "../dom.ts";
import type { Vector } from "./algebra.ts";

const steepest = (Math.PI / 2) * 0.985; // below the pole, where the up direction is undefined
const nearest = 0.25;
const furthest = 6;

/** Direction of the camera from the target (rad; z up), and zoom (1 shows everything). */
export class Orbit {
  azimuth: number;
  elevation: number;
  zoom = 1;

  constructor(private readonly home: { azimuth: number; elevation: number }, private readonly changed: () => void, private readonly settled: () => void = () => undefined) {
    this.azimuth = home.azimuth;
    this.elevation = home.elevation;
  }

  /** Unit vector from the target to the camera. */
  direction(): Vector {
    const c = Math.cos(this.elevation);
    return [c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }

  /** Unit vectors to the right and upward in the image. */
  axes(): [Vector, Vector] {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    return [[-sa, ca, 0], [-se * ca, -se * sa, ce]];
  }

  set(azimuth: number, elevation: number, zoom: number): void {
    if (![azimuth, elevation, zoom].every(Number.isFinite)) return;
    this.azimuth = azimuth;
    this.elevation = Math.max(-steepest, Math.min(steepest, elevation));
    this.zoom = Math.max(nearest, Math.min(furthest, zoom));
  }

  /** Changes the home direction. A camera at its home direction moves to the new one. */
  setHome(azimuth: number): void {
    const isHome = this.text() === "";
    this.home.azimuth = azimuth;
    if (isHome) this.azimuth = azimuth;
  }

  /** Azimuth, elevation (degrees) and zoom as text; "" at home. */
  text(): string {
    const { home } = this;
    if (this.azimuth === home.azimuth && this.elevation === home.elevation && this.zoom === 1) return "";
    const degrees = (angle: number): string => ((angle * 180) / Math.PI).toFixed(1);
    return `${degrees(this.azimuth)},${degrees(this.elevation)},${this.zoom.toFixed(2)}`;
  }

  read(text: string): void {
    const numbers = text.split(",").map(Number);
    if (text === "" || numbers.length !== 3) this.set(this.home.azimuth, this.home.elevation, 1);
    else this.set(((numbers[0] ?? 0) * Math.PI) / 180, ((numbers[1] ?? 0) * Math.PI) / 180, numbers[2] ?? 1);
  }

  turn(azimuth: number, elevation: number, factor = 1): void {
    this.set(this.azimuth + azimuth, this.elevation + elevation, this.zoom * factor);
    this.changed();
  }

  reset(): void {
    this.set(this.home.azimuth, this.home.elevation, 1);
    this.changed();
    this.settled();
  }

  /** Attaches pointer and wheel control to an element. On touch screens, vertical drags scroll the page. */
  attach(canvas: HTMLElement): void {
    const pointers = new Map<number, [number, number]>();
    const spread = (): number => {
      const [a, b] = [...pointers.values()];
      return a !== undefined && b !== undefined ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
    };
    canvas.style.touchAction = "pan-y";
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (before === undefined) return;
      const apart = spread();
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      if (pointers.size === 2) {
        const now = spread();
        if (apart > 0 && now > 0) this.turn(0, 0, now / apart);
        return;
      }
      const perPixel = Math.PI / Math.max(200, canvas.clientWidth);
      this.turn(-(event.clientX - before[0]) * perPixel, (event.clientY - before[1]) * perPixel);
    });
    const release = (event: PointerEvent): void => {
      if (pointers.delete(event.pointerId)) this.settled();
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    // the wheel without Ctrl or Meta scrolls the page
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      this.turn(0, 0, Math.exp(-event.deltaY / 300));
      this.settled();
    }, { passive: false });
  }

  /** Buttons for rotation, zoom and reset. */
  buttons(what: string): HTMLElement {
    const step = Math.PI / 12;
    const button = (sign: string, title: string, act: () => void): HTMLElement =>
      element("button", {
        type: "button", title, "aria-label": `${title}: ${what}`,
        onclick: () => {
          act();
          this.settled();
        },
      }, sign);
    return element("div", { class: "motion-turn", role: "group", "aria-label": `Camera: ${what}` },
      button("←", "Turn left", () => this.turn(-step, 0)),
      button("→", "Turn right", () => this.turn(step, 0)),
      button("↑", "Look from above", () => this.turn(0, step)),
      button("↓", "Look from below", () => this.turn(0, -step)),
      button("+", "Zoom in", () => this.turn(0, 0, 1.2)),
      button("−", "Zoom out", () => this.turn(0, 0, 1 / 1.2)),
      button("Reset", "Reset the view", () => this.reset()),
    );
  }
}
