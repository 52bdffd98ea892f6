// SPDX-License-Identifier: Apache-2.0
// The panel on a phone: a sheet at the lower edge with three heights, pulled by its handle.
import { useCallback, useRef, useState } from "preact/hooks";

export const kStops = ["peek", "half", "full"] as const;
export type Stop = (typeof kStops)[number];

const kDrag = 40; // px: less is a tap

export function useSheet() {
  const [stop, setStop] = useState<Stop>("peek");
  const from = useRef<number | undefined>(undefined);
  const dragged = useRef(false);

  const step = useCallback((by: number) => {
    setStop((old) => kStops[Math.min(kStops.length - 1, Math.max(0, kStops.indexOf(old) + by))] ?? old);
  }, []);
  const handle = {
    onPointerDown: (event: PointerEvent) => {
      from.current = event.clientY;
      dragged.current = false;
      (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
    },
    onPointerMove: (event: PointerEvent) => {
      if (from.current === undefined) return;
      const pulled = from.current - event.clientY;
      if (Math.abs(pulled) < kDrag) return;
      // Each further pull in one go takes it one stop on.
      from.current = event.clientY + Math.sign(pulled) * -140;
      dragged.current = true;
      step(Math.sign(pulled));
    },
    onPointerUp: () => (from.current = undefined),
    onPointerCancel: () => (from.current = undefined),
    onClick: () => {
      if (!dragged.current) setStop((old) => (old === "peek" ? "half" : "peek"));
    },
  };
  return { stop, setStop, handle };
}
