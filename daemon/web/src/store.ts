// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import type { Happening } from "./events";
import type { MapDocument, Status, TrackPose } from "./model";

export type LinkPhase = "connecting" | "open" | "lost";

export interface Link {
  phase: LinkPhase;
  /** Since when it is so, ms since the epoch. */
  since: number;
  /** When the next attempt is due, ms since the epoch; only while lost. */
  retryAt?: number;
}

export type View = "3d" | "plan";

/** All that the page shows, but for what changes at frame rate (live.ts). Replaced, never changed in place. */
export interface State {
  link: Link;
  map: MapDocument;
  track: TrackPose[];
  status?: Status;
  /** Newest first. */
  events: Happening[];
  selected?: number;
  view: View;
  /** Why there is no 3-D view, when there is none. */
  no3d?: string;
  follow: boolean;
  /** Set while the daemon wants a token: whether it was shown one, which it does not know. */
  locked?: "missing" | "wrong";
}

export const emptyMap: MapDocument = { revision: 0, time: 0, objects: [], rooms: [], doorways: [] };

export class Store {
  private listeners = new Set<() => void>();
  constructor(private state: State) {}

  get(): State {
    return this.state;
  }
  set(patch: Partial<State>): void {
    this.state = { ...this.state, ...patch };
    for (const listener of this.listeners) listener();
  }
  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }
}

export function useStore(store: Store): State {
  const [state, setState] = useState(store.get());
  useEffect(() => {
    setState(store.get());
    return store.subscribe(() => setState(store.get()));
  }, [store]);
  return state;
}

/** The time of day, again every second: for what says how long something has lasted. */
export function useNow(): number {
  const [now, setNow] = useState(Date.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), 1000);
    return () => clearInterval(timer);
  }, []);
  return now;
}
