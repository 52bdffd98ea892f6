// SPDX-License-Identifier: Apache-2.0
import { degrees, duration, metres, percent } from "../format";
import type { Wearer } from "../live";
import type { State } from "../store";
import { loss, useDrift } from "./figures";

function rowsOf(state: State, drift: Wearer["drift"]): [string, string][] {
  const { status, map } = state;
  if (!status) return [];
  const { suit, tracker } = status;
  const lost = loss(state);
  const count = (n: number) => n.toLocaleString("en").replaceAll(",", "\u202f");
  const rows: [string, string | undefined][] = [
    ["Wearer", suit.wearer.name],
    ["Body height", suit.wearer.stature === undefined ? undefined : metres(suit.wearer.stature)],
    ["Sender", suit.sender],
    ["Rate", suit.receiving && suit.rate_hz !== undefined ? `${suit.rate_hz.toFixed(1)} Hz` : undefined],
    ["Frames", count(suit.stream.frames)],
    ["Lost samples", lost === undefined ? undefined : `${count(suit.stream.lost_samples)} (${percent(lost)})`],
    ["Dropped by the kernel", suit.socket.kernel_drops > 0 ? count(suit.socket.kernel_drops) : undefined],
    ["Walked", metres(tracker.path_m, 0)],
    ["Drift removed", drift ? `${metres(drift.distance)}, ${degrees(drift.heading, 1)}` : undefined],
    ["Loops closed", map.graph ? String(map.graph.loop_closures) : undefined],
    ["Traces", `${tracker.traces}${tracker.traces_rejected > 0 ? `, ${tracker.traces_rejected} rejected` : ""}`],
    ["Map revision", String(map.revision)],
    ["Kinemap", `${status.version}, up for ${duration(status.uptime_s)}`],
  ];
  return rows.filter((row): row is [string, string] => row[1] !== undefined && row[1] !== "");
}

export function SuitPanel({ state, wearer }: { state: State; wearer: Wearer }) {
  const drift = useDrift(wearer);
  return (
    <div class="suit">
      <dl class="rows">
        {rowsOf(state, drift).map(([name, value]) => (
          <div>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
    </div>
  );
}
