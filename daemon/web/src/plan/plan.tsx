// SPDX-License-Identifier: Apache-2.0
// The floor plan from above, as SVG: needs no WebGL, stays sharp, and its objects can be reached by keyboard.
import { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import { type Bounds, boundsOf, holds } from "../bounds";
import type { Wearer } from "../live";
import type { MapDocument, MapObject, TrackPose, Vec3 } from "../model";
import { allDimensions, readable } from "./dimensions";
import { placeLabels } from "./labels";
import { LiveWearer } from "./live_wearer";
import { Grid, Name, ObjectShape, RoomShape, ScaleBar, Sided, Tracks } from "./shapes";
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

/** What one must not see twice: tables below, walls above, what is selected on top. */
function inOrder(objects: MapObject[], selected: number | undefined): MapObject[] {
  const rank = (o: MapObject) => (o.id === selected ? 9 : (["table", "wall", "screen", "chair"].indexOf(o.type) + 5) % 5);
  return [...objects].sort((a, b) => rank(a) - rank(b) || a.id - b.id);
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
