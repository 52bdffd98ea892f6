// SPDX-License-Identifier: Apache-2.0
// What the plan is drawn of. Lengths in m; what must look the same at each scale is divided by it (px a metre).
import { useMemo } from "preact/hooks";
import { heading, metres, objectName, shortSize } from "../format";
import type { MapObject, Room, TrackPose, Vec2 } from "../model";
import { type Dimension, footOf, kGap } from "./dimensions";
import { kLineHeight, type Label } from "./labels";
import type { PlanView } from "./view";

// Screens look down: y is turned over.
const points = (list: (readonly number[])[]) => list.map(([x = 0, y = 0]) => `${x},${-y}`).join(" ");

export function Sided({ dimension, scale }: { dimension: Dimension; scale: number }) {
  const { from, to, inward, length } = dimension;
  const gap = kGap / scale;
  const tick = 4 / scale;
  const a: Vec2 = [from[0] + inward[0] * gap, from[1] + inward[1] * gap];
  const b: Vec2 = [to[0] + inward[0] * gap, to[1] + inward[1] * gap];
  const along: Vec2 = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
  const half = 21 / scale;
  const middle: Vec2 = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  let angle = (-Math.atan2(along[1], along[0]) * 180) / Math.PI;
  if (angle > 90.5 || angle <= -89.5) angle += 180; // to be read from below or from the right
  const end = ([x, y]: Vec2) => {
    const [u, v] = [(along[0] + inward[0]) * tick, (along[1] + inward[1]) * tick];
    return <line x1={x - u} y1={-(y - v)} x2={x + u} y2={-(y + v)} />;
  };
  return (
    <g class="dimension">
      <line x1={a[0]} y1={-a[1]} x2={middle[0] - along[0] * half} y2={-(middle[1] - along[1] * half)} />
      <line x1={middle[0] + along[0] * half} y1={-(middle[1] + along[1] * half)} x2={b[0]} y2={-b[1]} />
      {end(a)}
      {end(b)}
      <text transform={`translate(${middle[0]} ${-middle[1]}) rotate(${angle})`} dy="0.35em">
        {length.toFixed(2)}
      </text>
    </g>
  );
}

export function RoomShape({ room }: { room: Room }) {
  const n = room.polygon.length;
  return (
    <g>
      <polygon class="room" points={points(room.polygon)} />
      {(room.inferred_sides ?? []).map((side) => (
        <polyline class="inferred" points={points([room.polygon[side] ?? [], room.polygon[(side + 1) % n] ?? []])} />
      ))}
    </g>
  );
}

function Shape({ object }: { object: MapObject }) {
  const [x, y] = object.pose.position;
  if (object.type === "chair") {
    const turn = (-heading(object.pose) * 180) / Math.PI;
    return (
      <g transform={`translate(${x} ${-y}) rotate(${turn})`}>
        <rect x={-0.21} y={-0.21} width={0.42} height={0.42} rx={0.07} />
        <path class="stroke" d="M-0.21 -0.21V0.21" />
        <path class="stroke thin" d="M0.3 0H0.58M0.5 -0.07L0.58 0L0.5 0.07" />
      </g>
    );
  }
  const foot = footOf(object);
  const upright = object.plane && Math.abs(object.plane.normal[2]) < 0.5;
  if (foot && upright) return <polyline class="stroke" points={points(foot)} />;
  if (object.corners) return <polygon points={points(object.corners)} />;
  return <circle cx={x} cy={-y} r={0.18} />;
}

/** A wide invisible line makes thin things easy to hit. */
function Target({ object }: { object: MapObject }) {
  const foot = footOf(object);
  return foot ? <polyline class="target" points={points(foot)} /> : null;
}

export function Name({ label: { kind, lines, at }, scale }: { label: Label; scale: number }) {
  const [x, y] = [at[0] / scale, at[1] / scale];
  const step = kLineHeight[kind] / scale;
  return (
    <text class={`name name-${kind}`}>
      {lines.map((line, i) => (
        <tspan x={x} y={y + (i - (lines.length - 1) / 2) * step} dy="0.35em">
          {line}
        </tspan>
      ))}
    </text>
  );
}

export function ObjectShape({ object, selected, onSelect }: { object: MapObject; selected: boolean; onSelect: (id: number | undefined) => void }) {
  const sigma = object.sigma?.position;
  const [x, y] = object.pose.position;
  return (
    <g
      class={`object type-${object.type}${selected ? " selected" : ""}`}
      role="button"
      tabindex={-1}
      aria-pressed={selected}
      aria-label={`${objectName(object)} ${shortSize(object)}`}
      data-object={object.id}
      onClick={(event) => {
        event.stopPropagation();
        onSelect(object.id);
      }}
    >
      {selected && sigma !== undefined && <circle class="sigma" cx={x} cy={-y} r={Math.max(sigma, 0.01)} />}
      <Target object={object} />
      <Shape object={object} />
    </g>
  );
}

export function Tracks({ track }: { track: TrackPose[] }) {
  const corrected = useMemo(() => points(track.map((pose) => pose.position)), [track]);
  const raw = useMemo(() => points(track.flatMap((pose) => (pose.odometry ? [pose.odometry.position] : []))), [track]);
  return (
    <g>
      <polyline class="track raw" points={raw} />
      <polyline class="track" points={corrected} />
    </g>
  );
}

/** The metre grid of what is in view. */
export function Grid({ view, width, height }: { view: PlanView; width: number; height: number }) {
  const step = view.scale < 14 ? 5 : 1;
  const [w, h] = [width / view.scale / 2, height / view.scale / 2];
  const path: string[] = [];
  for (let x = Math.ceil((view.x - w) / step) * step; x <= view.x + w; x += step) path.push(`M${x} ${-view.y - h}V${-view.y + h}`);
  for (let y = Math.ceil((view.y - h) / step) * step; y <= view.y + h; y += step) path.push(`M${view.x - w} ${-y}H${view.x + w}`);
  return <path class="grid" d={path.join("")} />;
}

export function ScaleBar({ scale }: { scale: number }) {
  const length = [0.5, 1, 2, 5, 10, 20].find((candidate) => candidate * scale >= 60) ?? 20;
  return (
    <div class="scale-bar" style={{ width: `${length * scale}px` }} aria-hidden="true">
      {metres(length, length < 1 ? 1 : 0)}
    </div>
  );
}
