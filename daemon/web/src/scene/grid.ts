// SPDX-License-Identifier: Apache-2.0
import { BufferGeometry, Float32BufferAttribute, LineBasicMaterial, LineSegments } from "three";
import type { Bounds } from "../bounds";
import type { Palette } from "./palette";

const kBeyond = 5; // m of grid round the map, fading

/** A metre grid on the level of the start that fades away beyond the map. */
export function gridLines({ min, max }: Bounds, palette: Palette): LineSegments {
  const { r, g, b } = palette.get("grid");
  const positions: number[] = [];
  const colours: number[] = [];
  const low = [Math.floor(min[0]), Math.floor(min[1])];
  const high = [Math.ceil(max[0]), Math.ceil(max[1])];
  // How strong a line through a coordinate is: full over the map, nothing at the rim.
  const strength = (value: number, axis: 0 | 1) => {
    const outside = Math.max(0, (low[axis] ?? 0) - value, value - (high[axis] ?? 0));
    return Math.max(0, 1 - outside / kBeyond);
  };
  for (const axis of [0, 1] as const) {
    const other = axis === 0 ? 1 : 0;
    const stops = [(low[other] ?? 0) - kBeyond, low[other] ?? 0, high[other] ?? 0, (high[other] ?? 0) + kBeyond];
    for (let at = (low[axis] ?? 0) - kBeyond; at <= (high[axis] ?? 0) + kBeyond; ++at)
      for (let i = 0; i < 3; ++i)
        for (const along of [stops[i] ?? 0, stops[i + 1] ?? 0]) {
          positions.push(axis === 0 ? at : along, axis === 0 ? along : at, -0.02);
          colours.push(r, g, b, strength(at, axis) * strength(along, other));
        }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 4));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
  lines.renderOrder = -1;
  return lines;
}
