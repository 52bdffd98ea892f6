// SPDX-License-Identifier: Apache-2.0
import type { LiveEvent, MapDocument } from "./model";
import { clock, objectName, shortSize, timeOfDay, typeName } from "./format";

const kKept = 300;
/** The optimiser's everyday work, and what the next event says better. */
const kUntold = new Set(["object_changed", "trace"]);

/** What the list of events is made of: what the daemon tells, and what the page itself noticed of its link. */
export type Happening = { order: number; event: LiveEvent } | { order: number; text: string; at: number };

export interface EventItem {
  /** When: stream time, or the time of day for what happened to the link. */
  label: string;
  kind: "found" | "loop" | "warning" | "plain";
  text: string;
  /** Id of an object that is in the map. */
  object?: number;
}

const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

function kindOf(event: string): EventItem["kind"] {
  if (event === "object_found") return "found";
  if (event === "loop_closed") return "loop";
  return event === "suit_lost" || event === "loop_revoked" ? "warning" : "plain";
}

function textOf(event: LiveEvent, map: MapDocument): string {
  const id = event.object ?? event.objects?.[0];
  const object = map.objects.find((candidate) => candidate.id === id);
  if (event.event === "object_found" && object) return [`${objectName(object)} found`, shortSize(object)].filter(Boolean).join(", ");
  if (event.event === "object_found" && event.type) return `${typeName(event.type)} ${id} found`;
  if (event.event === "object_removed" && event.type) return `${typeName(event.type)} ${id} was part of another`;
  if (event.event === "loop_closed") return object ? `Loop closed at ${objectName(object).toLowerCase()}` : "Loop closed";
  return capital(event.message);
}

export function eventItem(happening: Happening, map: MapDocument): EventItem {
  if (!("event" in happening)) return { label: timeOfDay(happening.at), kind: "warning", text: happening.text };
  const { event } = happening;
  const id = event.object ?? event.objects?.[0];
  const known = map.objects.some((object) => object.id === id);
  return { label: clock(event.time), kind: kindOf(event.event), text: textOf(event, map), ...(known && id !== undefined ? { object: id } : {}) };
}

export const happenings = (events: LiveEvent[]): Happening[] =>
  events.filter(({ event }) => !kUntold.has(event)).map((event) => ({ order: event.number, event }));

/** Newest first, each once. */
export function withEvents(list: Happening[], news: Happening[]): Happening[] {
  const all = new Map([...list, ...news].map((item) => [item.order, item]));
  return [...all.values()].sort((a, b) => b.order - a.order).slice(0, kKept);
}

/** What the page itself noticed, after all that it knows of: the daemon's events have whole numbers, these stand between. */
export function noteOf(list: Happening[], text: string, at: number): Happening {
  const newest = list[0]?.order ?? 0;
  return { order: newest + (Math.floor(newest) + 1 - newest) / 2, text, at };
}

/** The number of the newest event of the daemon that is known. */
export const newestNumber = (list: Happening[]) => Math.floor(list[0]?.order ?? 0);
