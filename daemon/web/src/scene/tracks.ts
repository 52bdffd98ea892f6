// SPDX-License-Identifier: Apache-2.0
import { Group, Vector2 } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { TrackPose, Vec3 } from "../model";
import type { Palette } from "./palette";

/** The way of the pelvis, as corrected and as the suit has it, drawn on the floor it was walked on. */
export class Tracks {
  readonly group = new Group();
  private corrected: Line2;
  private raw: Line2;

  constructor(palette: Palette) {
    this.corrected = this.line(2.5, palette.get("track"), false);
    this.raw = this.line(1.5, palette.get("raw"), true);
  }

  recolour(palette: Palette): void {
    this.corrected.material.color.copy(palette.get("track"));
    this.raw.material.color.copy(palette.get("raw"));
  }
  resize(width: number, height: number): void {
    for (const line of [this.corrected, this.raw]) line.material.resolution = new Vector2(width, height);
  }
  show(track: TrackPose[]): void {
    this.set(this.corrected, track.map((pose) => pose.position));
    this.set(this.raw, track.flatMap((pose) => (pose.odometry ? [pose.odometry.position] : [])));
  }

  private line(width: number, color: LineMaterial["color"], dashed: boolean): Line2 {
    const material = new LineMaterial({ color, linewidth: width, dashed, dashSize: 0.1, gapSize: 0.08, fog: false, transparent: true, opacity: 0.9 });
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
    line.geometry.setPositions(points.flat());
    line.computeLineDistances();
  }
}
