// The three-dimensional view of the bodies (three.js). One WebGL renderer draws all panes in turn; each image is copied
// to the pane's canvas. show() builds one Figure per actor, pose() moves it to a time, draw() renders. Without WebGL, the
// edges of the bodies are drawn on the canvas.

import {
  AmbientLight, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide, Group, HemisphereLight, LineBasicMaterial,
  LineSegments, Float32BufferAttribute, InterleavedBufferAttribute, Material, Mesh, MeshStandardMaterial, Object3D, PerspectiveCamera, Quaternion as ThreeQuaternion, Scene,
  SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import type { ContactCurves, Motion } from "../data.ts";
import type { Actor } from "./actors.ts";
import { across, add, length, multiply, type Quaternion, rotate, scale, subtract, type Vector, vectorAt, zero } from "./algebra.ts";
import { type Extent, extentOf, middleOf } from "./extent.ts";
import { type Surface, surfacesOf, tipOf } from "./geometry.ts";
import type { Orbit } from "./orbit.ts";
import { contactAt, frictionOf, slipOf } from "./contacts.ts";
import { semiAxes, toPrincipal, twiceEnergy } from "./ellipsoid.ts";
import type { Keyframes } from "./interpolation.ts";
import { type Inertia, inertiaOf, spinAt } from "./spin.ts";

const fieldOfView = 30; // degrees, along the narrower side
const trailPoints = 200;
const pathPoints = 1500;
/** Length of the trail as a fraction of the motion shown. */
export const trailPart = 0.08;

/** The point of a body that leaves a trace: its tip, or the end of one of its axes. */
export type TracedPoint = "tip" | "x" | "y" | "z";

export interface Palette {
  ground: string;
  ink: string;
  muted: string;
  line: string;
  dark: boolean;
}

export interface Shown {
  momentum: boolean;
  angularVelocity: boolean;
  trail: boolean;
  path: boolean; // trace from the start to the present time
  axes: boolean; // body axes
  ellipsoid: boolean; // inertia ellipsoid
  contacts: boolean; // contact points, forces and slips, of the truth
  follow: boolean; // the camera follows the bodies
  point: TracedPoint;
  body: number; // index of the body with arrows
}

/** A pane: its canvas and the motions that it shows. */
export interface Pane {
  canvas: HTMLCanvasElement;
  actors: readonly Actor[];
}

/** A text over a pane, in its pixels. */
export interface Label {
  text: string;
  x: number;
  y: number;
  actor: Actor | null;
}

const vector3 = (v: Vector): Vector3 => new Vector3(v[0], v[1], v[2]);
const quaternion3 = (q: Quaternion): ThreeQuaternion => new ThreeQuaternion(q[1], q[2], q[3], q[0]);
const up = new Vector3(0, 0, 1);

// for the light and the dark theme
const axisColors = [["#b3261e", "#ff9a8a"], ["#1b7f3b", "#7fd79b"], ["#0b57d0", "#9cc2ff"]] as const;
const unitVectors: readonly Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const axisNames = ["x", "y", "z"] as const;
/** Length of body axes in sizes of the largest body. */
const axisLength = 1.15;

/** Length of the longest arrow, m. */
const arrowReach = (extent: Extent, motion: Motion): number =>
  1.1 * (motion.pivot !== null ? extent.radius : Math.max(extent.size, 0.4 * extent.radius));

/** The three.js objects of one actor. */
interface Figure {
  actor: Actor;
  root: Group;
  solid: MeshStandardMaterial;
  opacity: number; // before its last sample
  bodies: Group[];
  joints: { mark: Object3D; links: { mesh: Mesh; body: number }[] }[];
  pivotLink: Mesh | null;
  momentum: Arrow;
  angularVelocity: Arrow;
  axes: Arrow[][]; // by body: x, y, z
  ellipsoid: Mesh;
  trails: Trail[];
  paths: Trail[];
  contacts: ContactArrows[]; // empty for methods
}

/** Arrows at a contact: normal force, friction and slip, each scaled to the largest value of all contacts. */
interface ContactArrows {
  contact: ContactCurves;
  point: Mesh;
  normal: Arrow;
  friction: Arrow;
  slip: Arrow;
}

const contactColors = { normal: ["#a4141d", "#ff8f8f"], friction: ["#5b3fa0", "#b9a4f0"], slip: ["#00518a", "#7cc0ff"] } as const;
const contactLetters = [["normal", "N"], ["friction", "F"], ["slip", "u"]] as const;

/** An arrow along z with unit length before scaling. */
class Arrow {
  readonly root = new Group();
  private readonly shaft: Mesh;
  private readonly head: Mesh;

  /** `inside`: opacity of the parts that a body hides. */
  constructor(private readonly thick: number, color: string, keep: <T extends { dispose(): void }>(one: T) => T, inside = 0.3) {
    const material = keep(new MeshStandardMaterial({ color, roughness: 0.5 }));
    this.shaft = new Mesh(keep(new CylinderGeometry(thick, thick, 1, 16).rotateX(Math.PI / 2).translate(0, 0, 0.5)), material);
    this.head = new Mesh(keep(new ConeGeometry(2.6 * thick, 7 * thick, 20).rotateX(Math.PI / 2).translate(0, 0, 3.5 * thick)), material);
    const through = keep(new MeshStandardMaterial({ color, roughness: 0.5, transparent: true, opacity: inside, depthTest: false, depthWrite: false }));
    for (const solid of [this.shaft, this.head]) {
      const behind = new Mesh(solid.geometry, through);
      behind.renderOrder = 5;
      solid.add(behind);
    }
    this.root.add(this.shaft, this.head);
  }

  set(from: Vector, along: Vector): void {
    const size = length(along);
    this.root.visible = size > 7.5 * this.thick;
    if (!this.root.visible) return;
    this.root.position.set(...from);
    this.root.quaternion.setFromUnitVectors(up, vector3(scale(1 / size, along)));
    this.shaft.scale.set(1, 1, size - 6.5 * this.thick);
    this.head.position.set(0, 0, size - 7 * this.thick);
  }
}

/** The path of a body's tip over the preceding time window. */
class Trail {
  readonly line: Line2;
  private readonly data: Float32Array;

  constructor(readonly body: number, readonly tip: Vector, private readonly count: number, material: LineMaterial, keep: <T extends { dispose(): void }>(one: T) => T) {
    const geometry = keep(new LineGeometry());
    geometry.setPositions(new Array<number>(3 * count).fill(0));
    this.data = (geometry.getAttribute("instanceStart") as InterleavedBufferAttribute).data.array as Float32Array;
    this.line = new Line2(geometry, material);
    this.line.frustumCulled = false;
  }

  set(actor: Actor, t: number, window: number, origin: Vector, point: Vector): void {
    const { keyframes } = actor;
    if (keyframes === null) return;
    const { count } = this;
    const end = Math.min(t, keyframes.end);
    const begin = Math.max(0, end - window);
    let before: Vector = zero;
    for (let i = 0; i < count; ++i) {
      const placed = keyframes.at(this.body, begin + ((end - begin) * i) / (count - 1));
      const at = subtract(add(placed.position, rotate(placed.attitude, point)), origin);
      if (i > 0) this.data.set([...before, ...at], 6 * (i - 1));
      before = at;
    }
    (this.line.geometry.getAttribute("instanceStart") as InterleavedBufferAttribute).data.needsUpdate = true;
  }
}

export class BodyView {
  /** Why the bodies are drawn as wireframes, or "". */
  fault = "";
  extent: Extent = { size: 1, center: zero, radius: 1, azimuth: 0, follows: false };
  private renderer: WebGLRenderer | null = null;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(fieldOfView, 1, 0.01, 100);
  private readonly lamp = new DirectionalLight(0xffffff, 2.9);
  private motion: Motion | null = null;
  private figures: Figure[] = [];
  private planes: { mesh: Object3D; normal: Vector; offset: number; spacing: number }[] = [];
  private disposables: { dispose(): void }[] = [];
  private lineMaterials: LineMaterial[] = [];
  private largestL = 0;
  private largestW = 0;
  private largestContact = { normal: 0, friction: 0, slip: 0 };
  private palette: Palette = { ground: "#ffffff", ink: "#1c2127", muted: "#59616b", line: "#d9dde2", dark: false };

  constructor(private readonly changed: () => void) {
    try {
      const renderer = new WebGLRenderer({ antialias: true });
      this.renderer = renderer;
      renderer.autoClear = false;
      const canvas = renderer.domElement;
      canvas.addEventListener("webglcontextlost", (event) => {
        event.preventDefault();
        this.fault = "The browser released the WebGL context: bodies are drawn as wireframes until it restores the context.";
        this.changed();
      });
      canvas.addEventListener("webglcontextrestored", () => {
        this.fault = "";
        this.changed();
      });
    } catch {
      this.fault = "This browser provides no WebGL context: bodies are drawn as wireframes. For solid bodies, enable hardware acceleration or use a browser with WebGL 2.";
    }
    this.camera.up.set(0, 0, 1);
    this.camera.add(this.lamp);
    this.lamp.position.set(-0.6, 0.9, 0.6);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0x8890a0, 1.7), new AmbientLight(0xffffff, 0.4));
  }

  /** Removes and disposes all objects of the scene. */
  clear(): void {
    for (const figure of this.figures) this.scene.remove(figure.root);
    for (const plane of this.planes) this.scene.remove(plane.mesh);
    for (const one of this.disposables) one.dispose();
    this.figures = [];
    this.planes = [];
    this.disposables = [];
    this.lineMaterials = [];
  }

  /** Builds the scene. Overlaid methods are translucent, with coloured edges dashed by their place; otherwise solid. */
  show(motion: Motion, actors: readonly Actor[], overlaid: boolean, palette: Palette, body: number): void {
    this.clear();
    this.motion = motion;
    this.palette = palette;
    this.scene.background = new Color(palette.ground);
    const truth = actors.find((actor) => actor.method === null)?.keyframes ?? null;
    if (truth === null) return;
    const surfaces = motion.bodies.map(surfacesOf);
    for (const one of surfaces.flat()) this.keep(one.geometry);
    this.extent = extentOf(motion, truth, surfaces);
    const inertia = inertiaOf(motion, body);
    this.largestL = this.largestW = 0;
    for (const t of truth.dense(2)) {
      const { w, L } = spinAt(truth, inertia, body, t);
      this.largestL = Math.max(this.largestL, length(L));
      this.largestW = Math.max(this.largestW, length(w));
    }
    const largest = (values: number[]): number => values.reduce((most, one) => Math.max(most, one), 0);
    this.largestContact = {
      normal: largest(motion.contacts.flatMap((one) => one.normal_force)), friction: largest(motion.contacts.flatMap(frictionOf)), slip: largest(motion.contacts.flatMap(slipOf)),
    };
    for (const actor of actors) {
      if (actor.keyframes === null) continue;
      const figure = this.figure(motion, actor, surfaces, overlaid && actor.method !== null);
      this.figures.push(figure);
      this.scene.add(figure.root);
    }
    for (const plane of motion.planes) this.addPlane(vectorAt(plane.normal), plane.offset);
  }

  private keep = <T extends { dispose(): void }>(one: T): T => {
    this.disposables.push(one);
    return one;
  };

  private lines(color: string, width: number, dash: number, size: number): LineMaterial {
    const material = this.keep(new LineMaterial({ color, linewidth: width, dashed: dash > 0 }));
    if (dash > 0) {
      // dashes for the second method, dots for the third
      material.dashSize = (dash === 1 ? 0.09 : 0.03) * size;
      material.gapSize = (dash === 1 ? 0.05 : 0.04) * size;
    }
    this.lineMaterials.push(material);
    return material;
  }

  private figure(motion: Motion, actor: Actor, surfaces: Surface[][], ghost: boolean): Figure {
    const { keep } = this;
    const { size } = this.extent;
    const root = new Group();
    const solid = keep(new MeshStandardMaterial({
      color: actor.color, vertexColors: true, roughness: 0.62, metalness: 0, side: DoubleSide,
      transparent: ghost || actor.endsEarly, opacity: ghost ? 0.22 : 1, depthWrite: !ghost,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    const hole = keep(new MeshStandardMaterial({ color: this.palette.muted, transparent: true, opacity: 0.15, depthWrite: false, side: DoubleSide }));
    const plain = keep(new MeshStandardMaterial({ color: actor.color, roughness: 0.6 }));
    const edges = this.lines(ghost ? actor.color : this.palette.ink, ghost ? 2 : 1, ghost ? actor.place - 1 : 0, size);
    if (!ghost) edges.opacity = 0.45;
    edges.transparent = !ghost;
    const bodies = surfaces.map((list) => {
      const group = new Group();
      for (const surface of list) {
        const mesh = new Mesh(surface.geometry, surface.hole ? hole : solid);
        // opaque surfaces first, then translucent ones
        mesh.renderOrder = surface.hole ? 2 : ghost ? 1 : 0;
        group.add(mesh);
        if (surface.lines.length > 0) {
          const geometry = keep(new LineSegmentsGeometry());
          geometry.setPositions(surface.lines);
          const line = new LineSegments2(geometry, edges);
          line.computeLineDistances();
          line.frustumCulled = false;
          group.add(line);
        }
      }
      const tip = tipOf(list);
      const ball = new Mesh(keep(new SphereGeometry(0.045 * size, 20, 12)), plain);
      ball.position.set(...tip);
      group.add(ball);
      root.add(group);
      return group;
    });

    const mark = keep(new MeshStandardMaterial({ color: ghost ? actor.color : this.palette.ink, roughness: 0.7 }));
    const rod = keep(new CylinderGeometry(1, 1, 1, 12).rotateX(Math.PI / 2).translate(0, 0, 0.5));
    const link = (): Mesh => {
      const mesh = new Mesh(rod, mark);
      root.add(mesh);
      return mesh;
    };
    const joints = motion.joints.map((joint) => {
      const made = jointMark(joint.type, joint.axis === null ? null : vectorAt(joint.axis), 0.05 * size, mark, keep);
      root.add(made);
      const links = [joint.parent, joint.child].filter((body) => body >= 0).map((body) => ({ mesh: link(), body }));
      return { mark: made, links };
    });
    let pivotLink: Mesh | null = null;
    if (motion.pivot !== null) {
      const ball = new Mesh(keep(new SphereGeometry(0.05 * size, 20, 12)), mark);
      ball.position.set(...subtract(zero, this.extent.center));
      root.add(ball);
      pivotLink = link();
    }

    // labels and thickness distinguish the arrows
    const thick = (ghost ? 0.6 : 1) * 0.011 * arrowReach(this.extent, motion);
    const { dark } = this.palette;
    const momentum = new Arrow(1.7 * thick, ghost ? actor.color : dark ? "#f0b429" : "#a06400", keep);
    const angularVelocity = new Arrow(thick, ghost ? actor.color : dark ? "#5cc8b0" : "#00735c", keep);
    root.add(momentum.root, angularVelocity.root);
    const path = this.lines(actor.color, 2, ghost ? actor.place - 1 : 0, size);
    const traces = (count: number): Trail[] => surfaces.map((list, body) => {
      const trail = new Trail(body, tipOf(list), count, path, keep);
      root.add(trail.line);
      return trail;
    });
    const trails = traces(trailPoints);
    const paths = traces(pathPoints);
    const axes = bodies.map((group) => axisColors.map((pair, i) => {
      const arrow = new Arrow(0.011 * size, pair[dark ? 1 : 0], keep);
      arrow.set(zero, scale(axisLength * size, unitVectors[i] ?? zero));
      group.add(arrow.root);
      return arrow;
    }));
    const ellipsoid = new Mesh(keep(new SphereGeometry(1, 48, 32)), keep(new MeshStandardMaterial({
      color: ghost ? actor.color : dark ? "#5cc8b0" : "#00735c", transparent: true, opacity: 0.22, depthWrite: false, side: DoubleSide, roughness: 0.7,
    })));
    ellipsoid.renderOrder = 3;
    root.add(ellipsoid);
    const contacts = actor.method === null ? motion.contacts.map((contact) => this.contactArrows(contact, root, thick)) : [];
    return { actor, root, solid, opacity: solid.opacity, bodies, joints, pivotLink, momentum, angularVelocity, axes, ellipsoid, trails, paths, contacts };
  }

  private contactArrows(contact: ContactCurves, root: Group, thick: number): ContactArrows {
    const { keep } = this;
    const color = (which: keyof typeof contactColors): string => contactColors[which][this.palette.dark ? 1 : 0];
    const point = new Mesh(keep(new SphereGeometry(2.2 * thick, 16, 10)), keep(new MeshStandardMaterial({ color: this.palette.ink, roughness: 0.6, depthTest: false })));
    point.renderOrder = 6;
    const made = { contact, point, normal: new Arrow(1.3 * thick, color("normal"), keep, 0.8), friction: new Arrow(1.3 * thick, color("friction"), keep, 0.8), slip: new Arrow(thick, color("slip"), keep, 0.8) };
    root.add(point, made.normal.root, made.friction.root, made.slip.root);
    return made;
  }

  private poseContact(arrows: ContactArrows, motion: Motion, t: number, origin: Vector, visible: boolean): void {
    const state = visible ? contactAt(arrows.contact, t) : null;
    const plane = motion.planes[arrows.contact.plane];
    const { point, normal, friction, slip } = arrows;
    point.visible = state !== null;
    if (state === null || plane === undefined) {
      for (const arrow of [normal, friction, slip]) arrow.root.visible = false;
      return;
    }
    const at = subtract(state.point, origin);
    const reach = arrowReach(this.extent, motion);
    const { largestContact: largest } = this;
    const unitNormal = scale(1 / (length(vectorAt(plane.normal)) || 1), vectorAt(plane.normal));
    point.position.set(...at);
    normal.set(at, scale(largest.normal > 0 ? (0.75 * reach * state.normal) / largest.normal : 0, unitNormal));
    friction.set(at, scale(largest.friction > 0 ? (0.75 * reach) / largest.friction : 0, state.friction));
    slip.set(at, scale(largest.slip > 0 ? (0.75 * reach) / largest.slip : 0, state.slip));
  }

  private addPlane(normal: Vector, offset: number): void {
    const n = length(normal) > 0 ? scale(1 / length(normal), normal) : ([0, 0, 1] as const);
    const [x, y] = across(n);
    // a round spacing, about twenty squares over the view
    const wanted = this.extent.radius / 5;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const spacing = power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
    const half = Math.ceil((2 * this.extent.radius) / spacing);
    const points: number[] = [];
    for (let i = -half; i <= half; ++i) {
      for (const [a, b] of [[x, y], [y, x]] as [Vector, Vector][]) {
        points.push(...add(scale(i * spacing, a), scale(-half * spacing, b)), ...add(scale(i * spacing, a), scale(half * spacing, b)));
      }
    }
    const geometry = this.keep(new BufferGeometry());
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    const mesh = new LineSegments(geometry, this.keep(new LineBasicMaterial({ color: this.palette.muted, transparent: true, opacity: 0.45 })));
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    this.planes.push({ mesh, normal: n, offset: offset / (length(normal) || 1), spacing });
  }

  private origin(t: number, follow: boolean): Vector {
    const truth = this.figures.find((figure) => figure.actor.method === null)?.actor.keyframes;
    if (!(this.extent.follows || follow) || this.motion === null || truth === undefined || truth === null) return this.extent.center;
    return middleOf(this.motion, truth, t);
  }

  private pose(t: number, shown: Shown): void {
    const { motion, extent } = this;
    if (motion === null) return;
    const origin = this.origin(t, shown.follow);
    const inertia = inertiaOf(motion, shown.body);
    const window = trailPart * motion.duration;
    for (const figure of this.figures) {
      const { keyframes } = figure.actor;
      if (keyframes === null) continue;
      figure.solid.opacity = figure.actor.endsEarly && t > figure.actor.end ? 0.5 * figure.opacity : figure.opacity;
      const placements = figure.bodies.map((_, body) => keyframes.at(body, t));
      figure.bodies.forEach((group, body) => {
        const placed = placements[body];
        if (placed === undefined) return;
        group.position.set(...subtract(placed.position, origin));
        group.quaternion.copy(quaternion3(placed.attitude));
      });
      const put = (mesh: Mesh, from: Vector, to: Vector): void => {
        const along = subtract(to, from);
        const size = length(along);
        mesh.visible = size > 1e-6 * extent.size;
        if (!mesh.visible) return;
        mesh.position.set(...from);
        mesh.quaternion.setFromUnitVectors(up, vector3(scale(1 / size, along)));
        mesh.scale.set(0.008 * extent.size, 0.008 * extent.size, size);
      };
      motion.joints.forEach((joint, i) => {
        const made = figure.joints[i];
        if (made === undefined) return;
        const pointOf = (body: number, point: readonly number[]): Vector => {
          const placed = placements[body];
          return subtract(placed === undefined ? vectorAt(point) : add(placed.position, rotate(placed.attitude, vectorAt(point))), origin);
        };
        const parent = pointOf(joint.parent, joint.parent_point);
        const child = pointOf(joint.child, joint.child_point);
        const at = joint.child >= 0 ? child : parent;
        made.mark.position.set(...at);
        const carried = placements[joint.child];
        if (carried !== undefined) made.mark.quaternion.copy(quaternion3(carried.attitude));
        for (const one of made.links) {
          const center = placements[one.body]?.position;
          const point = one.body === joint.child ? child : parent;
          // a rod between the two points
          if (joint.type === "distance") put(one.mesh, parent, child);
          else if (center !== undefined) put(one.mesh, point, subtract(center, origin));
        }
      });
      const first = placements[0];
      if (figure.pivotLink !== null && first !== undefined) put(figure.pivotLink, subtract(zero, origin), subtract(first.position, origin));
      const watched = placements[shown.body];
      const { w, L } = spinAt(keyframes, inertia, shown.body, t);
      const from = subtract(motion.pivot !== null ? zero : watched?.position ?? zero, origin);
      // different lengths, because L and w are often parallel
      const reach = arrowReach(extent, motion);
      figure.momentum.set(from, scale(this.largestL > 0 ? reach / this.largestL : 0, L));
      figure.angularVelocity.set(from, scale(this.largestW > 0 ? (0.8 * reach) / this.largestW : 0, w));
      if (!shown.momentum) figure.momentum.root.visible = false;
      if (!shown.angularVelocity) figure.angularVelocity.root.visible = false;
      const axis = axisNames.indexOf(shown.point as (typeof axisNames)[number]);
      for (const [list, visible, span] of [[figure.trails, shown.trail, window], [figure.paths, shown.path, Infinity]] as const) {
        for (const trail of list) {
          trail.line.visible = visible;
          if (visible) trail.set(figure.actor, t, span, origin, axis < 0 ? trail.tip : scale(axisLength * extent.size, unitVectors[axis] ?? zero));
        }
      }
      figure.axes.forEach((arrows, body) => arrows.forEach((arrow) => (arrow.root.visible = shown.axes && body === shown.body)));
      this.poseEllipsoid(figure, keyframes, inertia, shown, t, from);
      for (const arrows of figure.contacts) this.poseContact(arrows, motion, t, origin, shown.contacts);
    }
    for (const plane of this.planes) {
      // moves the grid by whole squares
      const [x, y] = across(plane.normal);
      const part = (axis: Vector): number => {
        const along = origin[0] * axis[0] + origin[1] * axis[1] + origin[2] * axis[2];
        return Math.round(along / plane.spacing) * plane.spacing;
      };
      const foot = add(scale(plane.offset, plane.normal), add(scale(part(x), x), scale(part(y), y)));
      plane.mesh.position.set(...subtract(foot, origin));
    }
  }

  /** The ellipsoid of constant kinetic energy in the scale of the arrow of w: its tip is on the ellipsoid. */
  private poseEllipsoid(figure: Figure, keyframes: Keyframes, inertia: Inertia, shown: Shown, t: number, from: Vector): void {
    const { ellipsoid } = figure;
    const placed = keyframes.at(shown.body, t);
    const axes = semiAxes(inertia.moments, twiceEnergy(inertia.moments, toPrincipal(inertia.principal, placed.angularVelocity)));
    const reach = this.motion === null || !(this.largestW > 0) ? 0 : (0.8 * arrowReach(this.extent, this.motion)) / this.largestW;
    ellipsoid.visible = shown.ellipsoid && reach > 0 && axes.every((one) => one > 0);
    if (!ellipsoid.visible) return;
    ellipsoid.position.set(...from);
    ellipsoid.scale.set(...scale(reach, axes));
    ellipsoid.quaternion.copy(quaternion3(multiply(placed.attitude, inertia.principal)));
  }

  /** Draws the panes and returns the labels of each. */
  draw(panes: readonly Pane[], t: number, orbit: Orbit, shown: Shown, ratio: number): Label[][] {
    const boxes = panes.map(({ canvas }) => [Math.max(1, Math.round(canvas.clientWidth * ratio)), Math.max(1, Math.round(canvas.clientHeight * ratio))] as const);
    const { renderer } = this;
    const solid = renderer !== null && this.fault === "";
    const [width, height] = [Math.max(1, ...boxes.map((box) => box[0])), Math.max(1, ...boxes.map((box) => box[1]))];
    if (solid && (renderer.domElement.width !== width || renderer.domElement.height !== height)) renderer.setSize(width, height, false);
    this.pose(t, shown);
    return panes.map((pane, i) => {
      const [w, h] = boxes[i] ?? [1, 1];
      const { canvas } = pane;
      if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
      const context = canvas.getContext("2d");
      if (context === null) return [];
      this.aim(w / h, orbit);
      context.fillStyle = this.palette.ground;
      context.fillRect(0, 0, w, h);
      if (solid) {
        for (const figure of this.figures) figure.root.visible = pane.actors.includes(figure.actor);
        for (const material of this.lineMaterials) material.resolution.set(w, h);
        for (const material of this.lineMaterials) material.linewidth = (material.userData.width as number | undefined ?? (material.userData.width = material.linewidth)) * ratio;
        renderer.setViewport(0, 0, w, h);
        renderer.setScissor(0, 0, w, h);
        renderer.setScissorTest(true);
        renderer.clear();
        renderer.render(this.scene, this.camera);
        // the viewport is at the lower left corner of the renderer's canvas
        context.drawImage(renderer.domElement, 0, height - h, w, h, 0, 0, w, h);
      } else this.wires(context, pane, w, h, ratio);
      return this.labels(pane, canvas.clientWidth, canvas.clientHeight, shown);
    });
  }

  private aim(aspect: number, orbit: Orbit): void {
    const { camera, extent, motion } = this;
    // the bounding sphere fits into the view at any aspect ratio
    const half = (fieldOfView * Math.PI) / 360;
    camera.aspect = aspect;
    camera.fov = aspect >= 1 ? fieldOfView : (360 / Math.PI) * Math.atan(Math.tan(half) / aspect);
    const reach = motion === null ? 0 : arrowReach(extent, motion);
    const distance = (1.05 * Math.max(extent.radius, reach)) / Math.sin(half) / orbit.zoom;
    camera.position.copy(vector3(scale(distance, orbit.direction())));
    camera.near = Math.max(distance / 100, distance - 6 * extent.radius);
    camera.far = distance + 8 * extent.radius;
    camera.lookAt(0, 0, 0);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
  }

  private project(point: Vector3, width: number, height: number): [number, number] | null {
    const seen = point.clone().project(this.camera);
    return Math.abs(seen.z) <= 1 ? [((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height] : null;
  }

  private labels(pane: Pane, width: number, height: number, shown: Shown): Label[] {
    const labels: Label[] = [];
    const put = (text: string, at: Vector3, actor: Actor | null): void => {
      const place = this.project(at, width, height);
      if (place !== null) labels.push({ text, x: place[0], y: place[1], actor });
    };
    for (const figure of this.figures) {
      if (!pane.actors.includes(figure.actor)) continue;
      figure.root.updateMatrixWorld(true);
      const isLead = figure.actor === pane.actors[0];
      const head = (arrow: Arrow): Vector3 => new Vector3(0, 0, arrow.root.children[1]?.position.z ?? 0).multiplyScalar(1.12).applyMatrix4(arrow.root.matrixWorld);
      if (isLead && shown.momentum && figure.momentum.root.visible) put("L", head(figure.momentum), null);
      if (isLead && shown.angularVelocity && figure.angularVelocity.root.visible) put("ω", head(figure.angularVelocity), null);
      for (const arrows of figure.contacts) {
        for (const [which, letter] of contactLetters) if (arrows[which].root.visible) put(letter, head(arrows[which]), null);
      }
      if (isLead && shown.axes) figure.axes[shown.body]?.forEach((arrow, i) => {
        arrow.root.updateWorldMatrix(true, true);
        put(axisNames[i] ?? "", head(arrow), null);
      });
      const body = figure.bodies[shown.body];
      const tip = figure.trails[shown.body]?.tip;
      if (pane.actors.length > 1 && body !== undefined && tip !== undefined) put(figure.actor.name, vector3(tip).multiplyScalar(1.05).applyMatrix4(body.matrixWorld), figure.actor);
    }
    // moves overlapping names downward
    const names = labels.filter((label) => label.actor !== null).sort((a, b) => a.y - b.y);
    names.forEach((label, i) => {
      for (const other of names.slice(0, i)) {
        if (Math.abs(other.x - label.x) < 110 && label.y < other.y + 16) label.y = other.y + 16;
      }
    });
    return labels;
  }

  /** Draws the edges of the bodies without WebGL. */
  private wires(context: CanvasRenderingContext2D, pane: Pane, width: number, height: number, ratio: number): void {
    for (const figure of this.figures) {
      if (!pane.actors.includes(figure.actor)) continue;
      figure.root.updateMatrixWorld(true);
      context.strokeStyle = figure.actor.method === null ? this.palette.ink : figure.actor.color;
      context.lineWidth = 1.4 * ratio;
      context.setLineDash(figure.actor.place > 1 ? [4 * ratio, 3 * ratio] : []);
      for (const body of figure.bodies) {
        for (const child of body.children) {
          if (!(child instanceof LineSegments2)) continue;
          const start = child.geometry.getAttribute("instanceStart");
          const end = child.geometry.getAttribute("instanceEnd");
          context.beginPath();
          for (let i = 0; i < start.count; ++i) {
            const a = this.project(new Vector3().fromBufferAttribute(start, i).applyMatrix4(body.matrixWorld), width, height);
            const b = this.project(new Vector3().fromBufferAttribute(end, i).applyMatrix4(body.matrixWorld), width, height);
            if (a === null || b === null) continue;
            context.moveTo(...a);
            context.lineTo(...b);
          }
          context.stroke();
        }
      }
    }
    context.setLineDash([]);
  }
}

/** Mark of a joint: a pin along its axis, a ball for spherical and universal joints, a block for fixed joints. */
function jointMark(type: string, axis: Vector | null, size: number, material: Material, keep: <T extends { dispose(): void }>(one: T) => T): Object3D {
  const root = new Group();
  if (axis === null || type === "spherical" || type === "universal") {
    const flat = type === "fixed" ? 4 : 20;
    root.add(new Mesh(keep(new SphereGeometry(size, flat, flat === 4 ? 2 : 12)), material));
    return root;
  }
  // round for revolute joints, square for prismatic joints
  const pin = new Mesh(keep(new CylinderGeometry(0.6 * size, 0.6 * size, 5 * size, type === "prismatic" ? 4 : 20).rotateX(Math.PI / 2)), material);
  pin.quaternion.setFromUnitVectors(up, vector3(length(axis) > 0 ? scale(1 / length(axis), axis) : [0, 0, 1]));
  root.add(pin);
  return root;
}
