// SPDX-License-Identifier: Apache-2.0
// The floor plan from above, as SVG: needs no WebGL, stays sharp, and its objects can be reached by keyboard.
import { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import { type Bounds, boundsOf, holds } from "../bounds";
import { heading, metres, objectName, shortSize } from "../format";
import type { Wearer } from "../live";
import type { MapDocument, MapObject, Room, TrackPose, Vec2, Vec3 } from "../model";
import { allDimensions, type Dimension, footOf, kGap, readable } from "./dimensions";
import { kLineHeight, type Label, placeLabels } from "./labels";
import { fitView, listenToGestures, type PlanView, zoomed } from "./view";

interface Props {
  map: MapDocument;
  track: TrackPose[];
  wearer: Wearer;
  selected: number | undefined;
  follow: boolean;
  /** Counts up: each new number asks for the whole plan in view. */
  fits: number;
  /** Counts up or down with each press of the buttons + and −. */
  zooms: number;
  onSelect: (id: number | undefined) => void;
}

// Screens look down: y is turned over.
const points = (list: (readonly number[])[]) => list.map(([x = 0, y = 0]) => `${x},${-y}`).join(" ");

function Sided({ dimension, scale }: { dimension: Dimension; scale: number }) {
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

function RoomShape({ room }: { room: Room }) {
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

function Name({ label: { kind, lines, at }, scale }: { label: Label; scale: number }) {
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

/** What one must not see twice: tables below, walls above, what is selected on top. */
function inOrder(objects: MapObject[], selected: number | undefined): MapObject[] {
  const rank = (o: MapObject) => (o.id === selected ? 9 : (["table", "wall", "screen", "chair"].indexOf(o.type) + 5) % 5);
  return [...objects].sort((a, b) => rank(a) - rank(b) || a.id - b.id);
}

function ObjectShape({ object, selected, onSelect }: { object: MapObject; selected: boolean; onSelect: Props["onSelect"] }) {
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

function Tracks({ track }: { track: TrackPose[] }) {
  const corrected = useMemo(() => points(track.map((pose) => pose.position)), [track]);
  const raw = useMemo(() => points(track.flatMap((pose) => (pose.odometry ? [pose.odometry.position] : []))), [track]);
  return (
    <g>
      <polyline class="track raw" points={raw} />
      <polyline class="track" points={corrected} />
    </g>
  );
}

const kBones = [[0, 4], [4, 6], [8, 12], [8, 9], [9, 10], [12, 13], [13, 14], [15, 19], [15, 16], [16, 17], [17, 18], [19, 20], [20, 21], [21, 22]];

function bonesPath(joints: Vec3[]): string {
  return kBones
    .map(([from = 0, to = 0]) => {
      const a = joints[from];
      const b = joints[to];
      return a && b ? `M${a[0]} ${-a[1]}L${b[0]} ${-b[1]}` : "";
    })
    .join("");
}

/** Moves at frame rate beside Preact, which need not look at the map for that. */
function LiveWearer({ wearer, onMove }: { wearer: Wearer; onMove: (position: Vec3) => void }) {
  const group = useRef<SVGGElement>(null);
  useEffect(() => {
    let frame = 0;
    const show = (now: number) => {
      frame = 0;
      const sample = wearer.shown(now);
      const node = group.current;
      if (!node) return;
      node.toggleAttribute("hidden", !sample);
      if (!sample) return;
      const [dot, arrow, bones] = [...node.children];
      const [x, y] = sample.position;
      dot?.setAttribute("transform", `translate(${x} ${-y})`);
      arrow?.setAttribute("transform", `translate(${x} ${-y}) rotate(${(-sample.heading * 180) / Math.PI})`);
      bones?.setAttribute("d", bonesPath(sample.joints));
      onMove(sample.position);
      if (wearer.moving(now)) request();
    };
    const request = () => (frame ||= requestAnimationFrame(show));
    request();
    const stop = wearer.onSample(request);
    return () => {
      stop();
      cancelAnimationFrame(frame);
    };
  }, [wearer]);
  return (
    <g class="wearer" ref={group} hidden>
      <circle r={0.16} />
      <path d="M0.2 -0.09L0.34 0L0.2 0.09" class="nose" />
      <path class="bones" />
    </g>
  );
}

/** The metre grid of what is in view. */
function Grid({ view, width, height }: { view: PlanView; width: number; height: number }) {
  const step = view.scale < 14 ? 5 : 1;
  const [w, h] = [width / view.scale / 2, height / view.scale / 2];
  const path: string[] = [];
  for (let x = Math.ceil((view.x - w) / step) * step; x <= view.x + w; x += step) path.push(`M${x} ${-view.y - h}V${-view.y + h}`);
  for (let y = Math.ceil((view.y - h) / step) * step; y <= view.y + h; y += step) path.push(`M${view.x - w} ${-y}H${view.x + w}`);
  return <path class="grid" d={path.join("")} />;
}

function ScaleBar({ scale }: { scale: number }) {
  const length = [0.5, 1, 2, 5, 10, 20].find((candidate) => candidate * scale >= 60) ?? 20;
  return (
    <div class="scale-bar" style={{ width: `${length * scale}px` }} aria-hidden="true">
      {metres(length, length < 1 ? 1 : 0)}
    </div>
  );
}

export function Plan({ map, track, wearer, selected, follow, fits, zooms, onSelect }: Props) {
  const svg = useRef<SVGSVGElement>(null);
  const [size, setSize] = useState({ width: 0, height: 0 });
  const [view, setView] = useState<PlanView>({ x: 0, y: 0, scale: 60 });
  const [auto, setAuto] = useState(true);
  const following = useRef(follow);
  following.current = follow;
  const moved = useRef(zooms);
  const pressed = useRef({ x: 0, y: 0 });
  const framed = useRef<Bounds | undefined>(undefined);
  const [outings, setOutings] = useState(0); // how often the wearer has left what was in view

  useLayoutEffect(() => {
    const element = svg.current;
    if (!element) return;
    const measure = () => setSize({ width: element.clientWidth, height: element.clientHeight });
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(element);
    const stop = listenToGestures(element, (f) => {
      setAuto(false);
      setView(f);
    });
    return () => {
      observer.disconnect();
      stop();
    };
  }, []);
  useEffect(() => setAuto(true), [fits]);
  useEffect(() => {
    if (zooms === moved.current) return;
    setAuto(false);
    const factor = zooms > moved.current ? 1.4 : 1 / 1.4;
    moved.current = zooms;
    setView((v) => zoomed(v, factor));
  }, [zooms]);
  useLayoutEffect(() => {
    if (!auto || follow || size.width === 0) return;
    framed.current = boundsOf(map, track, wearer.shown(performance.now())?.position);
    setView(fitView(framed.current, size.width, size.height));
  }, [auto, follow, map, track, size.width, size.height, outings]);
  const wearerMoved = (position: Vec3) => {
    if (following.current) setView((v) => ({ ...v, x: position[0], y: position[1] }));
    else if (framed.current && !holds(framed.current, position)) {
      framed.current = undefined; // once, until all is in view again
      setOutings((n) => n + 1);
    }
  };

  const keys = (event: KeyboardEvent) => {
    const step = 40 / view.scale;
    const moves: Record<string, (v: PlanView) => PlanView> = {
      ArrowLeft: (v) => ({ ...v, x: v.x - step }),
      ArrowRight: (v) => ({ ...v, x: v.x + step }),
      ArrowUp: (v) => ({ ...v, y: v.y + step }),
      ArrowDown: (v) => ({ ...v, y: v.y - step }),
      "+": (v) => zoomed(v, 1.25),
      "-": (v) => zoomed(v, 0.8),
    };
    const move = moves[event.key];
    if (!move) return;
    event.preventDefault();
    setAuto(false);
    setView(move);
  };

  const { width, height } = size;
  const [w, h] = [Math.max(width, 1) / view.scale, Math.max(height, 1) / view.scale];
  const ordered = useMemo(() => inOrder(map.objects, selected), [map, selected]);
  const dimensions = useMemo(() => allDimensions(map).filter((dimension) => readable(dimension, view.scale)), [map, view.scale]);
  const labels = useMemo(() => placeLabels(map, dimensions, selected, view.scale), [map, dimensions, selected, view.scale]);
  return (
    <div class="plan">
      <svg
        ref={svg}
        tabindex={0}
        role="group"
        aria-label="Floor plan from above. Arrow keys move it, plus and minus zoom."
        viewBox={`${view.x - w / 2} ${-view.y - h / 2} ${w} ${h}`}
        style={{ "--px": 1 / view.scale } as Record<string, number>}
        onPointerDown={(event) => (pressed.current = { x: event.clientX, y: event.clientY })}
        onClickCapture={(event) => {
          // The end of a pull is no click.
          const { x, y } = pressed.current;
          if (Math.hypot(event.clientX - x, event.clientY - y) > 5) event.stopPropagation();
        }}
        onClick={() => onSelect(undefined)}
        onKeyDown={keys}
      >
        <Grid view={view} width={width} height={height} />
        {map.rooms.map((room) => (
          <RoomShape key={room.id} room={room} />
        ))}
        <Tracks track={track} />
        {ordered.map((object) => (
          <ObjectShape key={object.id} object={object} selected={object.id === selected} onSelect={onSelect} />
        ))}
        {dimensions.map((dimension) => (
          <Sided dimension={dimension} scale={view.scale} />
        ))}
        {(map.doorways ?? []).map((door) => (
          <g class="doorway" transform={`translate(${door.position[0]} ${-door.position[1]}) rotate(${(-door.heading * 180) / Math.PI})`}>
            <title>Doorway: the wearer walked through here; its width is not known</title>
            <path class="gap" d="M0 -0.36V0.36" />
            <path d="M-0.34 0H0.34M-0.24 -0.08L-0.34 0L-0.24 0.08M0.24 -0.08L0.34 0L0.24 0.08" />
          </g>
        ))}
        <LiveWearer wearer={wearer} onMove={wearerMoved} />
        {labels.map((label) => (
          <Name key={label.key} label={label} scale={view.scale} />
        ))}
      </svg>
      <ScaleBar scale={view.scale} />
    </div>
  );
}
