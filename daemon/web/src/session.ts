// SPDX-License-Identifier: Apache-2.0
// From messages to the state: what the daemon says, applied.
import { fetchWithToken, hasToken, keepToken, streamUrl } from "./access";
import { happenings, newestNumber, noteOf, withEvents } from "./events";
import { heading } from "./format";
import { StreamLink } from "./link";
import type { Wearer } from "./live";
import type { BodyNews, LiveEvent, MapDelta, MapDocument, PoseNews, Status, TrackPose, Vec3 } from "./model";
import { emptyMap, type Link, type Store } from "./store";

const kBodyRateHz = 30; // the page moves on between two samples
const kPoseRateHz = 4; // for the figures
const kTrackPauseMs = 1000; // how often the trajectory is asked for at most

interface Message {
  op: string;
  topic?: string;
  data?: unknown;
}

/** `list` without what is gone, with what is new or changed, by ascending id. */
function patched<Item extends { id: number }>(list: Item[], changed: Item[] = [], removed: number[] = []): Item[] {
  const items = new Map(list.map((item) => [item.id, item]));
  for (const id of removed) items.delete(id);
  for (const item of changed) items.set(item.id, item);
  return [...items.values()].sort((a, b) => a.id - b.id);
}

/** The map with a delta applied; undefined when the delta is not for this map. */
export function applyDelta(map: MapDocument, delta: MapDelta): MapDocument | undefined {
  if (delta.since !== map.revision || (delta.run !== undefined && delta.run !== map.run)) return undefined;
  const { since: _, removed, ...news } = delta;
  return {
    ...map,
    ...news,
    objects: patched(map.objects, delta.objects, removed?.objects),
    rooms: patched(map.rooms, delta.rooms, removed?.rooms),
  };
}

export class Session {
  private send?: (message: object) => void;
  private trackTimer?: ReturnType<typeof setTimeout>;
  private trackRevision = -1;
  private trackClosures = "";
  private stream: StreamLink;

  constructor(
    private store: Store,
    private wearer: Wearer,
    private base: URL,
  ) {
    this.stream = new StreamLink(() => streamUrl(base), {
      onLink: (link) => this.onLink(link),
      onOpen: (send) => this.onOpen(send),
      onMessage: (message) => this.onMessage(message as Message),
    });
  }

  private onOpen(send: (message: object) => void): void {
    this.send = send;
    send({ op: "subscribe", topics: ["status", "events"] });
    send({ op: "subscribe", topics: ["pose"], rate_hz: kPoseRateHz });
    send({ op: "subscribe", topics: ["body"], rate_hz: kBodyRateHz });
    const { revision, run } = this.store.get().map;
    // After a break only what changed meanwhile.
    send({ op: "subscribe", topics: ["map"], ...(run === undefined ? {} : { since: revision, run }) });
    if (run !== undefined) void this.askForEvents();
  }

  private onLink(link: Link): void {
    const before = this.store.get().link;
    this.store.set({ link });
    if (link.phase === "lost") void this.askWhetherLocked();
    if (link.phase === "open") this.store.set({ locked: undefined });
    if (link.phase === "lost" && before.phase === "open") this.note("Link lost", link.since);
    if (link.phase === "open" && before.phase === "lost") this.note("Link back", link.since);
  }

  /** A WebSocket that is refused does not tell a page why; a request does. */
  private async askWhetherLocked(): Promise<void> {
    const answer = await fetchWithToken(new URL("api/v1/status", this.base)).catch(() => undefined);
    if (answer?.status === 401) this.store.set({ locked: hasToken() ? "wrong" : "missing" });
  }

  unlock(token: string): void {
    keepToken(token);
    this.store.set({ locked: undefined });
    this.stream.hurry();
  }

  private note(text: string, at: number): void {
    const { events } = this.store.get();
    this.store.set({ events: withEvents(events, [noteOf(events, text, at)]) });
  }

  private onMessage({ op, topic, data }: Message): void {
    if (op !== "message") return;
    if (topic === "map") this.onMap(data as MapDocument | MapDelta);
    if (topic === "pose") this.wearer.drifted(data as PoseNews);
    if (topic === "body") this.onBody(data as BodyNews);
    if (topic === "events") this.onEvents([data as LiveEvent]);
    if (topic === "status") this.store.set({ status: data as Status });
  }

  private onMap(data: MapDocument | MapDelta): void {
    const before = this.store.get().map;
    const after = "since" in data ? applyDelta(before, data) : data;
    // A delta to a map that is not here: have the whole one.
    if (!after) return this.send?.({ op: "subscribe", topics: ["map"] });
    if (after.run !== before.run) this.begin();
    const { selected } = this.store.get();
    this.store.set({ map: after, selected: after.objects.some(({ id }) => id === selected) ? selected : undefined });
    this.askForTrack();
  }

  /** Another run of the daemon, or the first one: nothing of the one before holds. */
  private begin(): void {
    this.wearer.clear();
    this.trackRevision = -1;
    this.store.set({ map: emptyMap, track: [], events: [] });
    void this.askForEvents();
  }

  /** Those that were told before the page listened. */
  private async askForEvents(): Promise<void> {
    const answer = await this.fetch<{ events: LiveEvent[] }>(`api/v1/events?since=${newestNumber(this.store.get().events)}`);
    if (answer) this.onEvents(answer.events);
  }

  private onEvents(news: LiveEvent[]): void {
    this.store.set({ events: withEvents(this.store.get().events, happenings(news)) });
  }

  private onBody({ segments }: BodyNews): void {
    const joints = segments.map(([x = 0, y = 0, z = 0]): Vec3 => [x, y, z]);
    const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = segments[0] ?? [];
    const pelvis = { position: [x, y, z] as Vec3, orientation: [qw, qx, qy, qz] as [number, number, number, number] };
    this.wearer.push({ position: pelvis.position, heading: heading(pelvis), joints }, performance.now());
  }

  private async fetch<Answer>(path: string): Promise<Answer | undefined> {
    try {
      const answer = await fetchWithToken(new URL(path, this.base));
      return answer.ok ? ((await answer.json()) as Answer) : undefined;
    } catch {
      return undefined; // the link's own watch says so
    }
  }

  /** The whole trajectory moves with a closure and is asked for again; else only what is new. */
  private askForTrack(): void {
    if (this.trackTimer !== undefined || this.store.get().map.revision === this.trackRevision) return;
    this.trackTimer = setTimeout(async () => {
      const { map, track } = this.store.get();
      const closures = `${map.run} ${map.graph?.loop_closures} ${map.graph?.loop_closures_revoked}`;
      const last = closures === this.trackClosures ? track.at(-1)?.time : undefined;
      const answer = await this.fetch<{ poses: TrackPose[] }>(`api/v1/trajectory${last === undefined ? "" : `?since=${last}`}`);
      this.trackTimer = undefined;
      if (!answer) return;
      this.trackRevision = map.revision;
      this.trackClosures = closures;
      this.store.set({ track: last === undefined ? answer.poses : [...track, ...answer.poses.filter(({ time }) => time > last)] });
      this.askForTrack();
    }, this.trackRevision < 0 ? 0 : kTrackPauseMs);
  }
}
