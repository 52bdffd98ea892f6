// SPDX-License-Identifier: Apache-2.0
// One group for each object of the map. What was not observed looks so: walls of assumed height fade out towards the top.
import {
  BackSide,
  BoxGeometry,
  BufferGeometry,
  DoubleSide,
  Float32BufferAttribute,
  FrontSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Quaternion,
  Vector3,
} from "three";
import { RoundedBoxGeometry } from "three/addons/geometries/RoundedBoxGeometry.js";
import type { MapObject } from "../model";
import type { Palette } from "./palette";

const kSlab = 0.03; // thickness for the eye only: it is not observed
const kSeat = 0.42;

const vector = (p: readonly number[]) => new Vector3(p[0], p[1], p[2]);

function lines(points: Vector3[], material: LineBasicMaterial): LineSegments {
  const segments = new LineSegments(new BufferGeometry().setFromPoints(points), material);
  segments.raycast = () => {};
  return segments;
}

/** The rectangle's centre, its sides as vectors, and its normal towards the side that was touched. */
function rectangle(object: MapObject) {
  const [a, b, , d] = (object.corners ?? []).map(vector);
  if (!a || !b || !d) return undefined;
  const along = b.clone().sub(a);
  const across = d.clone().sub(a);
  const normal = object.plane ? vector(object.plane.normal) : along.clone().cross(across).normalize();
  const centre = a.clone().addScaledVector(along, 0.5).addScaledVector(across, 0.5);
  return { corners: [a, b, b.clone().add(across), d] as const, along, across, normal, centre };
}

/** A panel that is clear from the side that was touched and hardly there from behind, so that one looks into rooms from outside. */
function wall(object: MapObject, palette: Palette, selected: boolean): Group {
  const group = new Group();
  const shape = rectangle(object);
  if (!shape) return group;
  const { along, across, normal } = shape;
  const forward = along.clone().cross(across).dot(normal) > 0;
  const order = forward ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
  const colour = selected ? palette.get("accent") : palette.type(object.type);
  const lowest = Math.min(...shape.corners.map((corner) => corner.z));
  const geometry = new BufferGeometry().setFromPoints([...shape.corners]);
  const fade = shape.corners.flatMap((corner) => {
    const top = object.height_assumed && corner.z > lowest + 0.01;
    return [colour.r, colour.g, colour.b, top ? 0.22 : 1];
  });
  geometry.setAttribute("color", new Float32BufferAttribute(fade, 4));
  geometry.setIndex(order);
  const panel = (side: typeof FrontSide | typeof BackSide, opacity: number) => {
    const material = new MeshBasicMaterial({ vertexColors: true, transparent: true, opacity, side, depthWrite: false });
    return new Mesh(geometry, material);
  };
  const back = panel(BackSide, selected ? 0.16 : 0.07);
  back.raycast = () => {}; // a click from outside goes to what is inside
  group.add(panel(FrontSide, selected ? 0.5 : 0.34), back);

  const foot = shape.corners.filter((corner) => corner.z <= lowest + 0.01);
  const head = shape.corners.filter((corner) => corner.z > lowest + 0.01);
  const ink = (opacity: number) => new LineBasicMaterial({ color: colour, transparent: true, opacity });
  group.add(lines(foot, ink(0.95)), lines(head, ink(object.height_assumed ? 0.22 : 0.7)));
  const posts = foot.flatMap((low) => {
    const high = head.find((corner) => Math.hypot(corner.x - low.x, corner.y - low.y) < 0.05);
    return high ? [low, high] : [];
  });
  group.add(lines(posts, ink(object.height_assumed ? 0.3 : 0.6)));
  return group;
}

/** Tables and screens: a thin slab on its rectangle. */
function slab(object: MapObject, material: Material): { mesh: Mesh; shape: NonNullable<ReturnType<typeof rectangle>> } | undefined {
  const shape = rectangle(object);
  if (!shape) return undefined;
  const geometry = new BoxGeometry(shape.along.length(), shape.across.length(), kSlab);
  const mesh = new Mesh(geometry, material);
  const x = shape.along.clone().normalize();
  const z = shape.normal.clone();
  mesh.matrixAutoUpdate = false;
  mesh.matrix.makeBasis(x, z.clone().cross(x), z).setPosition(shape.centre.clone().addScaledVector(z, -kSlab / 2));
  return { mesh, shape };
}

function table(object: MapObject, palette: Palette, selected: boolean, floor: number): Group {
  const group = new Group();
  const colour = selected ? palette.get("accent") : palette.type("table");
  const made = slab(object, new MeshLambertMaterial({ color: colour }));
  if (!made) return group;
  group.add(made.mesh);
  const legs = made.shape.corners.flatMap((corner) => {
    const inset = corner.clone().lerp(made.shape.centre, 0.08);
    return [new Vector3(inset.x, inset.y, corner.z - kSlab), new Vector3(inset.x, inset.y, floor)];
  });
  group.add(lines(legs, new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.6 })));
  group.add(shadow(made.shape.corners.map((corner) => new Vector3(corner.x, corner.y, floor + 0.004)), palette));
  return group;
}

function shadow(corners: Vector3[], palette: Palette): Mesh {
  const geometry = new BufferGeometry().setFromPoints(corners);
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const material = new MeshBasicMaterial({
    color: palette.get("ink"), transparent: true, opacity: 0.1, side: DoubleSide, depthWrite: false,
  });
  const mesh = new Mesh(geometry, material);
  mesh.raycast = () => {};
  return mesh;
}

function screen(object: MapObject, palette: Palette, selected: boolean): Group {
  const group = new Group();
  const colour = selected ? palette.get("accent") : palette.type("screen");
  const made = slab(object, new MeshLambertMaterial({ color: colour, emissive: colour, emissiveIntensity: 0.25, side: DoubleSide }));
  if (!made) return group;
  const [a, b, c, d] = made.shape.corners;
  group.add(made.mesh, lines([a, b, b, c, c, d, d, a], new LineBasicMaterial({ color: colour })));
  return group;
}

/** A seat with a back rest: which way one sits is observed, how the chair looks is not. */
function seat(object: MapObject, palette: Palette, selected: boolean, floor: number): Group {
  const group = new Group();
  const colour = selected ? palette.get("accent") : palette.type("chair");
  const material = new MeshLambertMaterial({ color: colour });
  const pad = new Mesh(new RoundedBoxGeometry(kSeat, kSeat, 0.06, 3, 0.03), material);
  pad.position.z = -0.03;
  const back = new Mesh(new RoundedBoxGeometry(0.05, kSeat, 0.36, 3, 0.025), material);
  back.position.set(-kSeat / 2 + 0.02, 0, 0.28);
  const drop = floor - object.pose.position[2];
  const leg = kSeat / 2 - 0.05;
  const legs = [[-leg, -leg], [-leg, leg], [leg, -leg], [leg, leg]].flatMap(([x = 0, y = 0]) => [
    new Vector3(x, y, -0.06),
    new Vector3(x, y, drop),
  ]);
  const ink = new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.6 });
  const arrow = [[0.3, 0, 0.62, 0], [0.62, 0, 0.53, 0.07], [0.62, 0, 0.53, -0.07]].flatMap(([x0 = 0, y0 = 0, x1 = 0, y1 = 0]) => [
    new Vector3(x0, y0, drop + 0.01),
    new Vector3(x1, y1, drop + 0.01),
  ]);
  group.add(pad, back, lines(legs, ink), lines(arrow, ink));
  const half = kSeat / 2;
  group.add(shadow([[-half, -half], [half, -half], [half, half], [-half, half]].map(([x, y]) => new Vector3(x, y, drop + 0.004)), palette));
  const [w, x, y, z] = object.pose.orientation;
  group.quaternion.copy(new Quaternion(x, y, z, w));
  group.position.copy(vector(object.pose.position));
  return group;
}

/** Whatever type it is: something to see and to click on. */
function marker(object: MapObject, palette: Palette, selected: boolean): Group {
  const group = new Group();
  const colour = selected ? palette.get("accent") : palette.type(object.type);
  const made = slab(object, new MeshLambertMaterial({ color: colour }));
  const mesh = made?.mesh ?? new Mesh(new RoundedBoxGeometry(0.3, 0.3, 0.3, 3, 0.05), new MeshLambertMaterial({ color: colour }));
  if (!made) mesh.position.copy(vector(object.pose.position));
  group.add(mesh);
  return group;
}

/** `floor`: the height of the floor below the object, m. */
export function objectGroup(object: MapObject, palette: Palette, selected: boolean, floor: number): Group {
  const make = { wall, table, screen, chair: seat }[object.type] ?? marker;
  const group = make(object, palette, selected, floor);
  group.userData.object = object.id;
  return group;
}

export function disposeGroup(group: Group): void {
  group.traverse((node) => {
    if (!(node instanceof Mesh || node instanceof LineSegments)) return;
    node.geometry.dispose();
    const { material } = node as { material: Material | Material[] };
    for (const one of Array.isArray(material) ? material : [material]) one.dispose();
  });
}
