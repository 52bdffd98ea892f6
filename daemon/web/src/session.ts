// SPDX-License-Identifier: Apache-2.0
// From messages to the state: what the daemon says, applied.
import { mapEvents, withEvents } from "./events";
import { heading, timeOfDay } from "./format";
import { StreamLink } from "./link";
import type { Wearer } from "./live";
import type { MapDocument, PoseNews, Status, TrackPose, Vec3 } from "./model";
import { emptyMap, type Link, type Store } from "./store";

const kBodyRateHz = 30;
const kTrackPauseMs = 2000; // how often the trajectory is asked for at most

interface MapDelta extends Partial<MapDocument> {
  revision: number;
  since: number;
  removed: { objects: number[]; rooms: number[] };
}
interface BodyNews {
  time: number;
  segments: Vec3[];
}
interface Message {
  op: string;
  topic?: string;
  data?: unknown;
}

/** The map with a delta applied; undefined when the delta is not for this map. */
export function applyDelta(map: MapDocument, delta: MapDelta): MapDocument | undefined {
  if (delta.since !== map.revision) return undefined;
  return {
    ...map,
    ...delta,
    objects: merged(map.objects, delta.objects ?? [], delta.removed.objects),
    rooms: merged(map.rooms, delta.rooms ?? [], delta.removed.rooms),
  };
}

function merged<T extends { id: number }>(things: T[], changed: T[], removed: number[]): T[] {
  const byId = new Map(things.map((thing) => [thing.id, thing]));
  for (const id of removed) byId.delete(id);
  for (const thing of changed) byId.set(thing.id, thing);
  return [...byId.values()].sort((a, b) => a.id - b.id);
}

export class Session {
  private send?: (message: object) => void;
  private trackTimer?: ReturnType<typeof setTimeout>;
  private trackRevision = 0;
  private hasBody = false;

  constructor(
    private store: Store,
    private wearer: Wearer,
    private base: URL,
  ) {
    const url = new URL("api/v1/stream", base);
    url.protocol = url.protocol.replace("http", "ws");
    new StreamLink(url.href, {
      onLink: (link) => this.onLink(link),
      onOpen: (send) => this.onOpen(send),
      onMessage: (message) => this.onMessage(message as Message),
    });
  }

  private onOpen(send: (message: object) => void): void {
    this.send = send;
    send({ op: "subscribe", topics: ["map", "pose", "status"] });
  }

  private onLink(link: Link): void {
    const before = this.store.get().link;
    this.store.set({ link });
    if (link.phase === before.phase) return;
    if (link.phase === "lost" && before.phase === "open") this.note("Link lost", link.since);
    if (link.phase === "open" && before.phase === "lost") this.note("Link back", link.since);
  }

  private note(text: string, at: number): void {
    const item = { key: `link/${at}`, kind: "link" as const, text: `${text} at ${timeOfDay(at)}` };
    this.store.set({ events: withEvents(this.store.get().events, [item]) });
  }

  private onMessage(message: Message): void {
    if (message.op !== "message") return;
    if (message.topic === "map") this.onMap(message.data as MapDocument | MapDelta);
    if (message.topic === "pose") this.onPose(message.data as PoseNews);
    if (message.topic === "body") this.onBody(message.data as BodyNews);
    if (message.topic === "status") this.store.set({ status: message.data as Status });
  }

  private onMap(data: MapDocument | MapDelta): void {
    let before = this.store.get().map;
    let after = data as MapDocument | undefined;
    if ("since" in data) {
      after = applyDelta(before, data);
      // A delta to a map that is not here: have the whole one again.
      if (!after) return this.send?.({ op: "subscribe", topics: ["map"] });
    } else if (data.revision < before.revision) {
      before = emptyMap; // the daemon began anew
      this.wearer.clear();
      this.trackRevision = 0;
      this.store.set({ events: [], track: [], selected: undefined });
    }
    if (!after) return;
    const { events, selected } = this.store.get();
    this.store.set({
      map: after,
      events: withEvents(events, mapEvents(before, after)),
      selected: after.objects.some((object) => object.id === selected) ? selected : undefined,
    });
    this.askForTrack();
  }

  private onPose(news: PoseNews): void {
    this.wearer.pushPose(news);
    if (!this.hasBody) this.wearer.push({ position: news.position, heading: heading(news) }, performance.now());
  }

  private onBody(news: BodyNews): void {
    this.hasBody = true;
    const joints = news.segments;
    const position = joints[0];
    if (position) this.wearer.push({ position, heading: 0, joints }, performance.now());
  }

  /** The whole trajectory moves with each closure, so it is asked for again, but never faster than every two seconds. */
  private askForTrack(): void {
    if (this.trackTimer !== undefined || this.store.get().map.revision === this.trackRevision) return;
    this.trackTimer = setTimeout(async () => {
      const { revision } = this.store.get().map;
      try {
        const answer = await fetch(new URL("api/v1/trajectory", this.base));
        if (answer.ok) {
          this.trackRevision = revision;
          this.store.set({ track: ((await answer.json()) as { poses: TrackPose[] }).poses });
        }
      } catch {
        // the link's own watch says so
      }
      this.trackTimer = undefined;
      if (this.store.get().link.phase === "open") this.askForTrack();
    }, this.trackRevision === 0 ? 0 : kTrackPauseMs);
  }
}

export { kBodyRateHz };
