// SPDX-License-Identifier: Apache-2.0
import type { MapDocument, MapObject } from "./model";
import type { EventItem } from "./store";
import { objectName, shortSize } from "./format";

const kKept = 200;

function visitItems(object: MapObject, known: number): EventItem[] {
  const visits = object.visits ?? [];
  return visits.slice(known).map(([, end], i) => {
    const first = known + i === 0;
    const size = shortSize(object);
    return {
      key: `${object.id}/${known + i}/${end}`,
      time: end,
      kind: first ? "found" : "visit",
      text: first ? `${objectName(object)} found${size && `, ${size}`}` : `${objectName(object)} visited again`,
      object: object.id,
    };
  });
}

/** What a new map says that the one before did not; with an empty `before` the whole history. */
export function mapEvents(before: MapDocument, after: MapDocument): EventItem[] {
  const known = new Map(before.objects.map((object) => [object.id, object]));
  const items = after.objects.flatMap((object) => {
    const old = known.get(object.id);
    return old === object ? [] : visitItems(object, old?.visits?.length ?? 0);
  });
  const loops = (after.graph?.loop_closures ?? 0) - (before.graph?.loop_closures ?? 0);
  if (before.revision > 0 && loops > 0)
    items.push({
      key: `loop/${after.revision}`,
      time: after.time,
      kind: "loop",
      text: loops === 1 ? "Loop closed: drift taken out" : `${loops} loops closed: drift taken out`,
    });
  return items.sort((a, b) => (b.time ?? 0) - (a.time ?? 0));
}

export const withEvents = (list: EventItem[], items: EventItem[]) => [...items, ...list].slice(0, kKept);
