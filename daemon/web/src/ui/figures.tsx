// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import { degrees, metres, percent } from "../format";
import type { Wearer } from "../live";
import type { State } from "../store";

const kRefreshMs = 500;

/** Part of the suit's samples that never came. */
export function loss({ status }: State): number | undefined {
  if (!status || status.suit.stream.frames === 0) return undefined;
  const { frames, lost_samples: lost } = status.suit.stream;
  return lost / (frames + lost);
}

export function useDrift(wearer: Wearer) {
  const [drift, setDrift] = useState(wearer.drift);
  useEffect(() => {
    const timer = setInterval(() => setDrift(wearer.drift), kRefreshMs);
    return () => clearInterval(timer);
  }, [wearer]);
  return drift;
}

function Figure({ name, value, unit, title }: { name: string; value: string | undefined; unit?: string; title: string }) {
  return (
    <div class="figure" title={title}>
      <dt>{name}</dt>
      <dd>
        {value ?? "–"}
        {value !== undefined && unit && <small>{unit}</small>}
      </dd>
    </div>
  );
}

/** The title block: what one wants to know at a glance, laid out as on a drawing. */
export function Figures({ state, wearer }: { state: State; wearer: Wearer }) {
  const drift = useDrift(wearer);
  const lost = loss(state);
  const { map, status } = state;
  const area = map.rooms.reduce((sum, room) => sum + room.area, 0);
  const receiving = status?.suit.receiving && state.link.phase === "open";
  return (
    <dl class="figures" aria-label="At a glance">
      <Figure name="Suit rate" title="Frames a second that arrive now" value={receiving ? status?.suit.rate_hz?.toFixed(0) : undefined} unit="Hz" />
      <Figure name="Loss" title="Part of the suit's samples that never came" value={lost === undefined ? undefined : percent(lost).replace(" %", "")} unit="%" />
      <Figure name="Drift removed" title={drift ? `How far the suit believes to be from where it is: ${metres(drift.distance)} and ${degrees(drift.heading, 1)}` : "How far the suit believes to be from where it is"} value={drift?.distance.toFixed(2)} unit="m" />
      <Figure name="Floor area" title="Of the rooms whose walls are closed" value={map.rooms.length > 0 ? area.toFixed(1) : undefined} unit="m²" />
    </dl>
  );
}
