// SPDX-License-Identifier: Apache-2.0
import { eventItem, type Happening } from "../events";
import type { MapDocument } from "../model";

interface Props {
  events: Happening[];
  map: MapDocument;
  onSelect: (id: number) => void;
}

export function EventList({ events, map, onSelect }: Props) {
  if (events.length === 0) return <p class="empty">Nothing has happened yet. What the wearer finds, visits again and corrects appears here.</p>;
  return (
    <ol class="events">
      {events.map((happening) => {
        const { label, kind, text, object } = eventItem(happening, map);
        const content = (
          <>
            <time>{label}</time>
            <span>{text}</span>
          </>
        );
        return (
          <li key={happening.order} class={`event-${kind}`}>
            {object === undefined ? (
              <div>{content}</div>
            ) : (
              <button type="button" onClick={() => onSelect(object)}>
                {content}
              </button>
            )}
          </li>
        );
      })}
    </ol>
  );
}
