// Surfaces of bodies: the shapes of scene files (centred on their origins, axis along z), and the box of a body's
// moments. Two tones make rotation visible on round bodies.

import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, EdgesGeometry, Float32BufferAttribute,
  LatheGeometry, Quaternion as ThreeQuaternion, SphereGeometry, TorusGeometry, Vector2, Vector3,
} from "three";
import type { BodyShape, Part } from "../data.ts";
import { cross, dot, length, type Quaternion, quaternionAt, rotate, subtract, type Vector, vectorAt } from "./algebra.ts";
import { circle } from "./ellipsoid.ts";

// smallest thickness of flat and thin bodies, relative to the largest extent
const leastThickness = 0.02;
const round = 48; // sides of a circle; a multiple of 4, because tones change at quarters

/** Half extents of the box with a body's mass and principal moments, a_i^2 = 3 (I_j + I_k - I_i) / (2 m), with a minimum
 * thickness. */
export function boxOfMoments(mass: number, moments: Vector): Vector {
  const square = (i: 0 | 1 | 2, j: 0 | 1 | 2, k: 0 | 1 | 2): number =>
    mass > 0 ? Math.max(0, (3 * (moments[j] + moments[k] - moments[i])) / (2 * mass)) : 0;
  const extents: Vector = [Math.sqrt(square(0, 1, 2)), Math.sqrt(square(1, 2, 0)), Math.sqrt(square(2, 0, 1))];
  const least = leastThickness * Math.max(...extents);
  return [Math.max(extents[0], least), Math.max(extents[1], least), Math.max(extents[2], least)];
}

/** Height of a frustum's centre of mass above its base: h (R^2 + 2 R r + 3 r^2) / (4 (R^2 + R r + r^2)). */
export function frustumCenter(bottom: number, top: number, height: number): number {
  const whole = bottom * bottom + bottom * top + top * top;
  return whole > 0 ? (height * (bottom * bottom + 2 * bottom * top + 3 * top * top)) / (4 * whole) : height / 2;
}

const lengthOf = (part: Part, key: string): number => {
  const value = part.sizes[key];
  return typeof value === "number" && Number.isFinite(value) ? Math.abs(value) : 0;
};
const listOf = (part: Part, key: string): number[] => {
  const value = part.sizes[key];
  return Array.isArray(value) ? value.flat() : [];
};

const alongZ = <G extends BufferGeometry>(geometry: G): G => geometry.rotateX(Math.PI / 2); // three's axis is y

/** Surface of a shape in the shape's axes; null for unknown types. */
export function surfaceOf(part: Part): BufferGeometry | null {
  switch (part.type) {
    case "box": {
      const [x, y, z] = vectorAt(listOf(part, "half_extents"));
      return sided(new BoxGeometry(2 * x, 2 * y, 2 * z));
    }
    case "plate": {
      const [x = 0, y = 0] = listOf(part, "half_extents");
      return sided(new BoxGeometry(2 * x, 2 * y, leastThickness * Math.max(x, y)));
    }
    case "sphere":
      return toned(alongZ(new SphereGeometry(lengthOf(part, "radius"), round, round / 2)), true);
    case "hollow_sphere":
      return toned(alongZ(new SphereGeometry(lengthOf(part, "outer_radius"), round, round / 2)), true);
    case "ellipsoid": {
      const [x, y, z] = vectorAt(listOf(part, "semi_axes"));
      return toned(alongZ(new SphereGeometry(1, round, round / 2)).scale(x, y, z), true);
    }
    case "cylinder":
      return toned(alongZ(new CylinderGeometry(lengthOf(part, "radius"), lengthOf(part, "radius"), 2 * lengthOf(part, "half_height"), round)));
    case "hollow_cylinder": {
      const [outer, inner, half] = [lengthOf(part, "outer_radius"), lengthOf(part, "inner_radius"), lengthOf(part, "half_height")];
      const profile = [[outer, -half], [outer, half], [inner, half], [inner, -half], [outer, -half]];
      // doubled corners keep the edges sharp in the lathe geometry
      const points = profile.flatMap(([r = 0, z = 0], i) => (i === 0 || i === profile.length - 1 ? [new Vector2(r, z)] : [new Vector2(r, z), new Vector2(r, z)]));
      return toned(alongZ(new LatheGeometry(points, round)));
    }
    case "capsule":
      return toned(alongZ(new CapsuleGeometry(lengthOf(part, "radius"), 2 * lengthOf(part, "half_height"), round / 4, round)), true);
    case "cone":
      return frustum(lengthOf(part, "radius"), 0, lengthOf(part, "height"));
    case "frustum":
      return frustum(lengthOf(part, "bottom_radius"), lengthOf(part, "top_radius"), lengthOf(part, "height"));
    case "torus":
      return toned(new TorusGeometry(lengthOf(part, "major_radius"), lengthOf(part, "minor_radius"), round / 2, 2 * round), true);
    case "rod": {
      const thick = (leastThickness / 2) * lengthOf(part, "length");
      return toned(alongZ(new CylinderGeometry(thick, thick, lengthOf(part, "length"), round / 2)));
    }
    case "disc": {
      const radius = lengthOf(part, "radius");
      return toned(alongZ(new CylinderGeometry(radius, radius, leastThickness * radius, round)));
    }
    case "tetrahedron": {
      const corners = listOf(part, "vertices");
      const [a, b, c, d] = [0, 3, 6, 9].map((at) => vectorAt(corners, at)) as [Vector, Vector, Vector, Vector];
      // outward normals for any order of the corners
      const isRight = dot(subtract(b, a), cross(subtract(c, a), subtract(d, a))) > 0;
      return sided(mesh(corners, isRight ? [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3] : [0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2]));
    }
    default:
      return null;
  }
}

function frustum(bottom: number, top: number, height: number): BufferGeometry {
  const middle = height / 2 - frustumCenter(bottom, top, height);
  return toned(alongZ(new CylinderGeometry(top, bottom, height, round)).translate(0, 0, middle));
}

/** Triangle mesh with one normal per face. */
export function mesh(vertices: readonly number[], faces: readonly number[]): BufferGeometry {
  const positions: number[] = [];
  for (const corner of faces) positions.push(...vectorAt(vertices, 3 * corner));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.computeVertexNormals();
  return geometry;
}

const light = 1;
const dark = 0.62;

/** Colours the quarters of a round body alternately in two tones; with `halved`, the tones swap at z = 0. */
function toned(geometry: BufferGeometry, halved = false): BufferGeometry {
  return paint(geometry, (x, y, z) => {
    const quarter = Math.floor((Math.atan2(y, x) / (Math.PI / 2) + 4) % 4);
    return (quarter + (halved && z < 0 ? 1 : 0)) % 2 === 0 ? light : dark;
  });
}

/** Colours flat sides by their normals; sides along +x, +y and +z are lighter than the opposite ones. */
function sided(geometry: BufferGeometry): BufferGeometry {
  return paint(geometry, (_x, _y, _z, n) => {
    const size = [Math.abs(n[0]), Math.abs(n[1]), Math.abs(n[2])];
    const axis = size.indexOf(Math.max(...size));
    return (n[axis] ?? 0) >= 0 ? [0.95, 1, 0.9][axis] ?? 1 : [0.7, 0.75, 0.65][axis] ?? 1;
  });
}

/** Colours each triangle by its centre and normal. */
function paint(geometry: BufferGeometry, tone: (x: number, y: number, z: number, normal: Vector) => number): BufferGeometry {
  const flat = geometry.index === null ? geometry : geometry.toNonIndexed();
  if (flat !== geometry) geometry.dispose();
  const positions = flat.getAttribute("position");
  const colors: number[] = [];
  const [a, b, c, normal] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];
  const color = new Color();
  for (let i = 0; i + 2 < positions.count; i += 3) {
    a.fromBufferAttribute(positions, i);
    b.fromBufferAttribute(positions, i + 1);
    c.fromBufferAttribute(positions, i + 2);
    normal.copy(b).sub(a).cross(new Vector3().copy(c).sub(a)).normalize();
    const value = tone((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3, [normal.x, normal.y, normal.z]);
    color.setRGB(value, value, value);
    for (let corner = 0; corner < 3; ++corner) colors.push(color.r, color.g, color.b);
  }
  flat.setAttribute("color", new Float32BufferAttribute(colors, 3));
  return flat;
}

/** Outline of a shape as pairs of points in the shape's axes: edges, and circles for round shapes. */
export function outlineOf(part: Part, surface: BufferGeometry): number[] {
  const lines: number[] = [];
  const curve = (points: Vector[]): void => {
    for (let i = 0; i + 1 < points.length; ++i) lines.push(...(points[i] as Vector), ...(points[i + 1] as Vector));
  };
  const radii = ((): Vector | null => {
    if (part.type === "sphere") return [lengthOf(part, "radius"), lengthOf(part, "radius"), lengthOf(part, "radius")];
    if (part.type === "hollow_sphere") return [lengthOf(part, "outer_radius"), lengthOf(part, "outer_radius"), lengthOf(part, "outer_radius")];
    return part.type === "ellipsoid" ? vectorAt(listOf(part, "semi_axes")) : null;
  })();
  if (radii !== null) {
    const [x, y, z] = radii;
    curve(circle([x, 0, 0], [0, y, 0], round));
    curve(circle([0, y, 0], [0, 0, z], round));
    curve(circle([0, 0, z], [x, 0, 0], round));
    return lines;
  }
  if (part.type === "capsule") {
    const [r, h] = [lengthOf(part, "radius"), lengthOf(part, "half_height")];
    for (const z of [-h, h]) curve(circle([r, 0, 0], [0, r, 0], round).map((p) => [p[0], p[1], z] as const));
    for (const side of [[1, 0, 0], [0, 1, 0]] as Vector[]) {
      const half = circle([r * side[0], r * side[1], 0], [0, 0, r], round);
      const shifted = half.map((p, i) => [p[0], p[1], p[2] + (i <= round / 2 ? h : -h)] as const);
      curve([...shifted, shifted[0] as Vector]);
    }
    return lines;
  }
  if (part.type === "torus") {
    const [R, r] = [lengthOf(part, "major_radius"), lengthOf(part, "minor_radius")];
    for (const [radius, z] of [[R + r, 0], [R - r, 0], [R, r], [R, -r]] as [number, number][]) {
      curve(circle([radius, 0, 0], [0, radius, 0], round).map((p) => [p[0], p[1], z] as const));
    }
    for (const [x, y] of [[1, 0], [0, 1], [-1, 0], [0, -1]] as [number, number][]) {
      curve(circle([r * x, r * y, 0], [0, 0, r], round / 2).map((p) => [p[0] + R * x, p[1] + R * y, p[2]] as const));
    }
    return lines;
  }
  const edges = new EdgesGeometry(surface, 20);
  lines.push(...Array.from(edges.getAttribute("position").array));
  edges.dispose();
  // generators of shapes with an axis
  const ends = ((): [number, number, number, number][] => {
    if (part.type === "cylinder") return [[lengthOf(part, "radius"), -lengthOf(part, "half_height"), lengthOf(part, "radius"), lengthOf(part, "half_height")]];
    if (part.type === "hollow_cylinder") return ["outer_radius", "inner_radius"].map((key) => [lengthOf(part, key), -lengthOf(part, "half_height"), lengthOf(part, key), lengthOf(part, "half_height")]);
    if (part.type === "cone") return [[lengthOf(part, "radius"), -lengthOf(part, "height") / 4, 0, (3 * lengthOf(part, "height")) / 4]];
    if (part.type !== "frustum") return [];
    const base = -frustumCenter(lengthOf(part, "bottom_radius"), lengthOf(part, "top_radius"), lengthOf(part, "height"));
    return [[lengthOf(part, "bottom_radius"), base, lengthOf(part, "top_radius"), base + lengthOf(part, "height")]];
  })();
  for (const [below, low, above, high] of ends) {
    for (const [x, y] of [[1, 0], [0, 1], [-1, 0], [0, -1]] as [number, number][]) lines.push(below * x, below * y, low, above * x, above * y, high);
  }
  return lines;
}

/** One surface of a body, in body axes from its centre of mass. */
export interface Surface {
  geometry: BufferGeometry;
  lines: number[]; // pairs of points
  hole: boolean;
}

function placed(surface: BufferGeometry, lines: number[], position: Vector, orientation: Quaternion, hole: boolean): Surface {
  const [w, x, y, z] = orientation;
  surface.applyQuaternion(new ThreeQuaternion(x, y, z, w)).translate(...position);
  const moved: number[] = [];
  for (let i = 0; i + 2 < lines.length; i += 3) {
    const [px, py, pz] = rotate(orientation, vectorAt(lines, i));
    moved.push(px + position[0], py + position[1], pz + position[2]);
  }
  return { geometry: surface, lines: moved, hole };
}

/** Surfaces of a body: its parts, mesh and points, or the box of its moments if it has none. */
export function surfacesOf(shape: BodyShape): Surface[] {
  const made: Surface[] = [];
  for (const part of shape.parts) {
    const surface = surfaceOf(part);
    if (surface !== null) made.push(placed(surface, outlineOf(part, surface), vectorAt(part.position), quaternionAt(part.orientation), part.hole));
  }
  if (shape.vertices !== null && shape.faces !== null && shape.faces.length > 0) {
    const surface = sided(mesh(shape.vertices, shape.faces));
    made.push({ geometry: surface, lines: outlineOf({ type: "mesh", sizes: {}, position: [], orientation: [], hole: false }, surface), hole: false });
  }
  const points = shape.points ?? [];
  if (points.length > 0) {
    let reach = 0;
    for (let i = 0; i + 2 < points.length; i += 3) reach = Math.max(reach, length(vectorAt(points, i)));
    const radius = 0.07 * (reach || 1);
    for (let i = 0; i + 2 < points.length; i += 3) {
      const at = vectorAt(points, i);
      const ball = toned(alongZ(new SphereGeometry(radius, round / 2, round / 4)), true).translate(...at);
      // with a line to the centre of mass
      made.push({ geometry: ball, lines: [0, 0, 0, ...at], hole: false });
    }
  }
  if (made.every((surface) => surface.hole)) {
    const [x, y, z] = boxOfMoments(shape.mass, vectorAt(shape.moments));
    const box: Part = { type: "box", sizes: { half_extents: [x, y, z] }, position: [0, 0, 0], orientation: [1, 0, 0, 0], hole: false };
    const surface = surfaceOf(box);
    if (surface !== null) made.push(placed(surface, outlineOf(box, surface), [0, 0, 0], quaternionAt(shape.principal), false));
  }
  return made;
}

/** The drawn point with the largest distance from the centre of mass. */
export function tipOf(surfaces: readonly Surface[]): Vector {
  let tip: Vector = [0, 0, 0];
  for (const surface of surfaces) {
    const positions = surface.geometry.getAttribute("position");
    for (let i = 0; i < positions.count; ++i) {
      const at: Vector = [positions.getX(i), positions.getY(i), positions.getZ(i)];
      // the first of points at equal distance, independent of rounding
      if (length(at) > length(tip) * (1 + 1e-4)) tip = at;
    }
  }
  return tip;
}

