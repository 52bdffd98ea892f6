// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from "preact/hooks";
import type { Wearer } from "../live";
import type { Vec3 } from "../model";

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
export function LiveWearer({ wearer, onMove }: { wearer: Wearer; onMove: (position: Vec3) => void }) {
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
