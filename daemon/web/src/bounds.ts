// SPDX-License-Identifier: Apache-2.0
import type { MapDocument, TrackPose, Vec2 } from "./model";

/** An upright box on the plan, m. */
export interface Bounds {
  min: Vec2;
  max: Vec2;
}

/** What a view of everything must show: map and trajectory, and 3 m × 3 m round the origin when there is nothing yet. */
export function boundsOf(map: MapDocument, track: TrackPose[], wearer?: readonly number[]): Bounds {
  const points: (readonly number[])[] = [];
  for (const object of map.objects) points.push(object.pose.position, ...(object.corners ?? []));
  for (const room of map.rooms) points.push(...room.polygon);
  for (const pose of track) points.push(pose.position);
  if (wearer) points.push(wearer);
  const bounds: Bounds = { min: [-1.5, -1.5], max: [1.5, 1.5] };
  if (points.length > 0) {
    bounds.min = [Infinity, Infinity];
    bounds.max = [-Infinity, -Infinity];
  }
  for (const [x = 0, y = 0] of points) {
    bounds.min = [Math.min(bounds.min[0], x), Math.min(bounds.min[1], y)];
    bounds.max = [Math.max(bounds.max[0], x), Math.max(bounds.max[1], y)];
  }
  return bounds;
}

export const holds = ({ min, max }: Bounds, [x = 0, y = 0]: readonly number[]) => x >= min[0] && x <= max[0] && y >= min[1] && y <= max[1];
