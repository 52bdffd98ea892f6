// SPDX-License-Identifier: Apache-2.0
// Plane geometry that plan and 3-D view share; m, map frame.
import type { MapDocument, MapObject, Room, Vec2, Vec3 } from "./model";

export function inside([x, y]: Vec2, polygon: Vec2[]): boolean {
  let odd = false;
  polygon.forEach(([x1, y1], i) => {
    const [x0, y0] = polygon[(i + polygon.length - 1) % polygon.length] ?? [x1, y1];
    if (y1 > y !== y0 > y && x < ((x0 - x1) * (y - y1)) / (y0 - y1) + x1) odd = !odd;
  });
  return odd;
}

function toSegment([x, y]: Vec2, [x0, y0]: Vec2, [x1, y1]: Vec2): number {
  const [u, v] = [x1 - x0, y1 - y0];
  const part = Math.min(1, Math.max(0, ((x - x0) * u + (y - y0) * v) / Math.max(u * u + v * v, 1e-9)));
  return Math.hypot(x - x0 - u * part, y - y0 - v * part);
}

const outlineOf = ({ corners, pose }: MapObject): Vec2[] => (corners ?? [pose.position]).map(([x, y]) => [x, y]);

const toRing = (point: Vec2, ring: Vec2[]) => Math.min(...ring.map((corner, i) => toSegment(point, corner, ring[(i + 1) % ring.length] ?? corner)));

const toOutline = (point: Vec2, outline: Vec2[]) => (inside(point, outline) ? 0 : toRing(point, outline));

/** The height of the floor of a room: that of the lowest corner of its walls. */
export function floorOf(room: Room, map: MapDocument): number {
  const walls = map.objects.filter(({ id }) => room.walls.includes(id));
  const heights = walls.flatMap(({ corners }) => corners ?? []).map((corner) => corner[2]);
  return heights.length > 0 ? Math.min(...heights) : 0;
}

export const roomAt = (point: Vec2, map: MapDocument) => map.rooms.find((room) => inside(point, room.polygon));

/** The height of the floor under a point: that of its room, or of the start. */
export function floorAt(point: Vec2, map: MapDocument): number {
  const room = roomAt(point, map);
  return room ? floorOf(room, map) : 0;
}

const kSteps = 14;

/** Where in a room there is most space for its name: far from its sides and from what stands in it. */
export function quietSpot(room: Room, map: MapDocument): Vec2 {
  const outlines = map.objects.filter(({ type }) => type !== "wall").map(outlineOf);
  const xs = room.polygon.map(([x]) => x);
  const ys = room.polygon.map(([, y]) => y);
  const [x0, y0] = [Math.min(...xs), Math.min(...ys)];
  const [dx, dy] = [(Math.max(...xs) - x0) / kSteps, (Math.max(...ys) - y0) / kSteps];
  let best: Vec2 = room.polygon[0] ?? [0, 0];
  let most = -1;
  for (let i = 1; i < kSteps; ++i)
    for (let j = 1; j < kSteps; ++j) {
      const point: Vec2 = [x0 + i * dx, y0 + j * dy];
      if (!inside(point, room.polygon)) continue;
      // A name is wide: sides count from a little farther away than things.
      const space = Math.min(toRing(point, room.polygon) * 0.9, ...outlines.map((outline) => toOutline(point, outline)));
      if (space > most) [most, best] = [space, point];
    }
  return best;
}

const kWindow = 20;

function median(values: number[]): number {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] ?? 0;
}

/** The trajectory of the pelvis brought down to the floor: less by what the pelvis stood above it at the start, sitting and bending left out. */
export function onFloor(positions: Vec3[]): Vec3[] {
  const standing = median(positions.slice(0, kWindow).map((p) => p[2]));
  return positions.map(([x, y], i) => {
    const near = positions.slice(Math.max(0, i - kWindow), i + kWindow + 1).map((p) => p[2]);
    return [x, y, median(near) - standing];
  });
}

