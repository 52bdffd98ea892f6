// SPDX-License-Identifier: Apache-2.0
// What part of the plan is in view, and how fingers, mouse and keys move it.
import type { Bounds } from "../bounds";

/** Centre in m (plan: x right, y up) and pixels a metre. */
export interface PlanView {
  x: number;
  y: number;
  scale: number;
}

const kMin = 4;
const kMax = 800;
const kMargin = 64; // px

const limited = (scale: number) => Math.min(kMax, Math.max(kMin, scale));

export function fitView({ min, max }: Bounds, width: number, height: number): PlanView {
  const margin = Math.min(kMargin, width / 16, height / 8);
  const scale = Math.min((width - 2 * margin) / (max[0] - min[0] + 0.3), (height - 2 * margin) / (max[1] - min[1] + 0.3));
  return { x: (min[0] + max[0]) / 2, y: (min[1] + max[1]) / 2, scale: Math.min(limited(scale), 160) };
}

export const panned = (view: PlanView, dx: number, dy: number): PlanView => ({
  ...view,
  x: view.x - dx / view.scale,
  y: view.y + dy / view.scale,
});

/** Zoomed about a point given in px from the middle of the view. */
export function zoomed(view: PlanView, factor: number, px = 0, py = 0): PlanView {
  const scale = limited(view.scale * factor);
  return {
    scale,
    x: view.x + px / view.scale - px / scale,
    y: view.y - py / view.scale + py / scale,
  };
}

/** Calls back with each change that a gesture makes; returns how to stop listening. */
export function listenToGestures(element: Element, change: (f: (view: PlanView) => PlanView) => void): () => void {
  const pointers = new Map<number, { x: number; y: number }>();
  const middle = () => {
    const box = element.getBoundingClientRect();
    return { x: box.left + box.width / 2, y: box.top + box.height / 2 };
  };
  const down = (event: Event) => {
    const { pointerId, clientX, clientY, button } = event as PointerEvent;
    if (button === 0) pointers.set(pointerId, { x: clientX, y: clientY });
  };
  const move = (event: Event) => {
    const { pointerId, clientX: x, clientY: y } = event as PointerEvent;
    const old = pointers.get(pointerId);
    if (!old) return;
    const other = [...pointers].find(([id]) => id !== pointerId)?.[1];
    pointers.set(pointerId, { x, y });
    if (!other) return change((view) => panned(view, x - old.x, y - old.y));
    const factor = Math.hypot(x - other.x, y - other.y) / Math.max(1, Math.hypot(old.x - other.x, old.y - other.y));
    const centre = middle();
    const about = { x: (x + other.x) / 2 - centre.x, y: (y + other.y) / 2 - centre.y };
    change((view) => zoomed(panned(view, (x - old.x) / 2, (y - old.y) / 2), factor, about.x, about.y));
  };
  const up = (event: Event) => pointers.delete((event as PointerEvent).pointerId);
  const wheel = (event: Event) => {
    const { deltaY, deltaMode, clientX, clientY } = event as WheelEvent;
    event.preventDefault();
    const centre = middle();
    const lines = deltaMode === 1 ? 16 : 1;
    change((view) => zoomed(view, Math.exp(-deltaY * lines * 0.0015), clientX - centre.x, clientY - centre.y));
  };
  const listeners: [EventTarget, string, (event: Event) => void][] = [
    [element, "pointerdown", down],
    [window, "pointermove", move],
    [window, "pointerup", up],
    [window, "pointercancel", up],
    [element, "wheel", wheel],
  ];
  for (const [target, type, listener] of listeners) target.addEventListener(type, listener, { passive: false });
  return () => {
    for (const [target, type, listener] of listeners) target.removeEventListener(type, listener);
  };
}
