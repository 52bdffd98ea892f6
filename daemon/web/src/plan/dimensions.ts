// SPDX-License-Identifier: Apache-2.0
// Where the plan writes lengths: one dimension line along each side of a room that says something new.
import type { MapDocument, MapObject, Room, Vec2 } from "../model";

export interface Dimension {
  from: Vec2;
  to: Vec2;
  /** Unit vector from the side towards where the line stands, the room's inside. */
  inward: Vec2;
  length: number;
}

const kShortest = 0.5; // m: shorter sides have no room for a number
const kSameLength = 0.03; // m: opposite sides that agree are written once
const kParallel = 0.1; // rad
const kReadable = 58; // px: shorter lines have no room for a number
export const kGap = 15; // px between a side and its dimension line

function sideOf(from: Vec2, to: Vec2): Dimension {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const along: Vec2 = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  return { from, to, inward: [-along[1], along[0]], length };
}

const parallel = (a: Dimension, b: Dimension) => Math.abs(a.inward[0] * b.inward[1] - a.inward[1] * b.inward[0]) < kParallel;

/** Of a room, whose corners go counter-clockwise. */
function roomDimensions(room: Room): Dimension[] {
  const sides = room.polygon.map((corner, i) => sideOf(corner, room.polygon[(i + 1) % room.polygon.length] ?? corner));
  const kept: Dimension[] = [];
  for (const side of sides) {
    if (side.length < kShortest) continue;
    if (kept.some((other) => parallel(side, other) && Math.abs(side.length - other.length) < kSameLength)) continue;
    kept.push(side);
  }
  return kept;
}

/** Of a wall that belongs to no room yet: on the side that was touched. */
function wallDimension(wall: MapObject): Dimension | undefined {
  const foot = footOf(wall);
  if (!foot || !wall.plane) return undefined;
  const side = sideOf(...foot);
  if (side.length < kShortest) return undefined;
  const [nx, ny] = wall.plane.normal;
  const towards = side.inward[0] * nx + side.inward[1] * ny;
  return towards > 0 ? side : { ...side, inward: [-side.inward[0], -side.inward[1]] };
}

/** The lower edge of an upright rectangle, seen from above. */
export function footOf(object: MapObject): [Vec2, Vec2] | undefined {
  const corners = object.corners;
  if (!corners) return undefined;
  const [a, b] = [...corners].sort((p, q) => p[2] - q[2]);
  return a && b ? [[a[0], a[1]], [b[0], b[1]]] : undefined;
}

/** Of all rooms, and of the walls that are in none. */
export function allDimensions(map: MapDocument): Dimension[] {
  const inRooms = new Set(map.rooms.flatMap(({ walls }) => walls));
  const loose = map.objects.filter(({ id, type }) => type === "wall" && !inRooms.has(id));
  return [...map.rooms.flatMap(roomDimensions), ...loose.flatMap((wall) => wallDimension(wall) ?? [])];
}

/** Whether a dimension can be read at so many px a metre. */
export const readable = ({ length }: Dimension, scale: number) => length * scale >= kReadable;
