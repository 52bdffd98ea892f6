// SPDX-License-Identifier: Apache-2.0
import { Group, Vector2 } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { onFloor } from "../geometry";
import type { TrackPose, Vec3 } from "../model";
import type { Palette } from "./palette";

const kNarrow = 600; // px: on a phone lines are thin
const kAbove = 0.015; // m above the floor, to be seen

/** The way of the pelvis, as corrected and as the suit has it, drawn on the floor it was walked on. */
export class Tracks {
  readonly group = new Group();
  private corrected: Line2;
  private raw: Line2;

  constructor(palette: Palette) {
    this.corrected = this.line(palette.get("track"), false);
    this.raw = this.line(palette.get("raw"), true);
  }

  recolour(palette: Palette): void {
    this.corrected.material.color.copy(palette.get("track"));
    this.raw.material.color.copy(palette.get("raw"));
  }
  resize(width: number, height: number): void {
    for (const line of [this.corrected, this.raw]) {
      line.material.resolution = new Vector2(width, height);
      line.material.linewidth = line === this.raw || width < kNarrow ? 1.25 : 2;
    }
  }
  show(track: TrackPose[]): void {
    this.set(this.corrected, track.map((pose) => pose.position));
    this.set(this.raw, track.flatMap((pose) => (pose.odometry ? [pose.odometry.position] : [])));
  }

  private line(color: LineMaterial["color"], dashed: boolean): Line2 {
    const material = new LineMaterial({ color, dashed, dashSize: 0.1, gapSize: 0.08, transparent: true, opacity: dashed ? 0.8 : 0.75 });
    const line = new Line2(new LineGeometry(), material);
    line.visible = false;
    line.raycast = () => {};
    this.group.add(line);
    return line;
  }

  private set(line: Line2, points: Vec3[]): void {
    line.visible = points.length > 1;
    if (!line.visible) return;
    line.geometry.dispose();
    line.geometry = new LineGeometry();
    line.geometry.setPositions(onFloor(points).flatMap(([x, y, z]) => [x, y, z + kAbove]));
    line.computeLineDistances();
  }
}
