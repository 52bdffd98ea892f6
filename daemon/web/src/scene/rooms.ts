// SPDX-License-Identifier: Apache-2.0
import {
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineDashedMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Shape,
  ShapeGeometry,
  Vector2,
  Vector3,
} from "three";
import { floorAt, floorOf } from "../geometry";
import type { MapDocument } from "../model";
import type { Palette } from "./palette";

function dashed(points: Vector3[], palette: Palette): LineSegments {
  const material = new LineDashedMaterial({ color: palette.type("wall"), dashSize: 0.12, gapSize: 0.1 });
  const segments = new LineSegments(new BufferGeometry().setFromPoints(points), material);
  segments.computeLineDistances();
  return segments;
}

/** Floors, sides that nobody touched (dashed), and doorways: where the wearer went through. */
export function roomsGroup(map: MapDocument, palette: Palette): Group {
  const group = new Group();
  for (const room of map.rooms) {
    const floor = floorOf(room, map);
    const geometry = new ShapeGeometry(new Shape(room.polygon.map(([x, y]) => new Vector2(x, y))));
    const mesh = new Mesh(geometry, new MeshBasicMaterial({ color: palette.get("floor") }));
    mesh.position.z = floor - 0.01;
    group.add(mesh);
    const sides = (room.inferred_sides ?? []).flatMap((side) => {
      const a = room.polygon[side];
      const b = room.polygon[(side + 1) % room.polygon.length];
      return a && b ? [new Vector3(a[0], a[1], floor), new Vector3(b[0], b[1], floor)] : [];
    });
    if (sides.length > 0) group.add(dashed(sides, palette));
  }
  for (const door of map.doorways ?? []) {
    const [x, y] = door.position;
    const arrow = new BufferGeometry().setFromPoints(
      [[-0.45, 0], [0.45, 0], [0.45, 0], [0.33, 0.09], [0.45, 0], [0.33, -0.09], [-0.45, 0], [-0.33, 0.09], [-0.45, 0], [-0.33, -0.09]].map(
        ([u = 0, v = 0]) => new Vector3(u, v, 0),
      ),
    );
    const mark = new LineSegments(arrow, new LineBasicMaterial({ color: palette.get("ink") }));
    mark.position.set(x, y, floorAt(door.position, map) + 0.02);
    mark.rotation.z = door.heading;
    group.add(mark);
  }
  return group;
}
