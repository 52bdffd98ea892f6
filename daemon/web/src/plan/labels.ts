// SPDX-License-Identifier: Apache-2.0
// Which names the plan shows, and where: none over another, over a number or over another object. In px, y down, from the map's origin.
import { heading, objectName, shortSize } from "../format";
import { inside, quietSpot, roomAt } from "../geometry";
import type { MapDocument, MapObject, Vec2 } from "../model";
import { type Dimension, kGap as kOff } from "./dimensions";

export interface Label {
  key: string;
  kind: "room" | "object" | "selected";
  lines: string[];
  /** Middle of the text. */
  at: Vec2;
}

interface Box {
  owner: string;
  at: Vec2;
  half: Vec2;
}
interface Wanted extends Omit<Label, "at"> {
  /** Where it may stand, best first. */
  places: Vec2[];
}

export const kLineHeight = { room: 18, object: 14.5, selected: 14.5 };
const kCharWidth = { room: 7.4, object: 6.3, selected: 6.3 };
const kGap = 3;
const kAcross = 44; // half the extent of a number beside its line

const overlap = (a: Box, b: Box) =>
  Math.abs(a.at[0] - b.at[0]) < a.half[0] + b.half[0] + kGap && Math.abs(a.at[1] - b.at[1]) < a.half[1] + b.half[1] + kGap;

const halfOf = ({ kind, lines }: Wanted): Vec2 => [
  (Math.max(...lines.map((line) => line.length)) * kCharWidth[kind]) / 2,
  (lines.length * kLineHeight[kind]) / 2,
];

/** The upright box round an object. */
function boxOf(object: MapObject, scale: number): Box {
  const around = object.corners ?? [[-0.21, -0.21], [0.21, 0.21]].map(([u = 0, v = 0]) => [object.pose.position[0] + u, object.pose.position[1] + v]);
  const xs = around.map(([x = 0]) => x * scale);
  const ys = around.map(([, y = 0]) => -y * scale);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  return { owner: `object ${object.id}`, at: [(x0 + x1) / 2, (y0 + y1) / 2], half: [(x1 - x0) / 2, (y1 - y0) / 2] };
}

function dimensionBox({ from, to, inward }: Dimension, scale: number): Box {
  const at: Vec2 = [((from[0] + to[0]) / 2) * scale + inward[0] * kOff, -((from[1] + to[1]) / 2) * scale - inward[1] * kOff];
  const level = Math.abs(inward[1]);
  return { owner: "dimension", at, half: [level > 0.7 ? kAcross / 2 : 8, level > 0.7 ? 8 : kAcross / 2] };
}

function wantedObject(object: MapObject, map: MapDocument, scale: number, selected: boolean): Wanted | undefined {
  if (object.type === "wall" && !selected) return undefined;
  const kind = selected ? ("selected" as const) : ("object" as const);
  const key = `object ${object.id}`;
  const box = boxOf(object, scale);
  const [x, y] = box.at;
  const name = objectName(object);
  const level = object.plane && Math.abs(object.plane.normal[2]) > 0.5;
  if (level) {
    const whole: Wanted = { key, kind, lines: [name, shortSize(object)], places: [] };
    const half = halfOf(whole);
    if (half[0] < box.half[0] && half[1] < box.half[1]) return { ...whole, places: [[x, y]] };
  }
  const wanted: Wanted = { key, kind, lines: [name], places: [] };
  const [w, h] = halfOf(wanted);
  const [right, down] = [box.half[0] + w + 5, box.half[1] + h + 4];
  const sides: Vec2[] = [1, 1.8].flatMap((far): Vec2[] => [[x, y + down * far], [x, y - down * far], [x + right * far, y], [x - right * far, y]]);
  // What stands at a wall has its name on the side from which it was touched.
  const turn = heading(object.pose) + (object.type === "chair" ? Math.PI : 0);
  const front = (p: Vec2) => -((p[0] - x) * Math.cos(turn) - (p[1] - y) * Math.sin(turn)) / Math.hypot(p[0] - x, p[1] - y);
  const room = roomAt([object.pose.position[0], object.pose.position[1]], map);
  const leaves = ([px, py]: Vec2) => room !== undefined && !inside([px / scale, -py / scale], room.polygon);
  const rank = (place: Vec2, i: number) => front(place) + (i < 4 ? 0 : 0.9) + (leaves(place) ? 3 : 0);
  wanted.places = sides.map((place, i) => ({ place, rank: rank(place, i) })).sort((a, b) => a.rank - b.rank).map(({ place }) => place);
  return wanted;
}

export function placeLabels(map: MapDocument, dimensions: Dimension[], selected: number | undefined, scale: number): Label[] {
  const taken: Box[] = dimensions.map((dimension) => dimensionBox(dimension, scale));
  for (const object of map.objects) if (object.type !== "wall") taken.push(boxOf(object, scale));
  const objects = [...map.objects].sort((a, b) => Number(b.id === selected) - Number(a.id === selected));
  const wanted: Wanted[] = objects.flatMap((object) => wantedObject(object, map, scale, object.id === selected) ?? []);
  const rooms = map.rooms.map((room): Wanted => {
    const [x, y] = quietSpot(room, map);
    return { key: `room ${room.id}`, kind: "room", lines: [`Room ${room.id}`, `${room.area.toFixed(1)} m²`], places: [[x * scale, -y * scale]] };
  });
  const labels: Label[] = [];
  for (const { places, ...label } of [...rooms, ...wanted]) {
    const half = halfOf({ places, ...label });
    const free = (at: Vec2) => !taken.some((box) => box.owner !== label.key && overlap(box, { owner: label.key, at, half }));
    const at = places.find(free) ?? (label.kind === "selected" ? places[0] : undefined);
    if (!at) continue;
    labels.push({ ...label, at });
    taken.push({ owner: label.key, at, half });
  }
  return labels;
}
