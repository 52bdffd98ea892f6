// SPDX-License-Identifier: Apache-2.0
import { clock } from "../format";
import type { EventItem } from "../store";

export function EventList({ events, onSelect }: { events: EventItem[]; onSelect: (id: number) => void }) {
  if (events.length === 0) return <p class="empty">Nothing has happened yet. What the wearer finds, visits again and corrects appears here.</p>;
  return (
    <ol class="events">
      {events.map((event) => {
        const content = (
          <>
            <time>{event.time === undefined ? "" : clock(event.time)}</time>
            <span>{event.text}</span>
          </>
        );
        const { object } = event;
        return (
          <li key={event.key} class={`event-${event.kind}`}>
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
