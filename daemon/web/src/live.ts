// SPDX-License-Identifier: Apache-2.0
// The wearer between two messages: samples come at the rate asked for, with the network's jitter; the screen wants a pose each frame.
import type { PoseNews, Vec3 } from "./model";
import { heading } from "./format";

export interface WearerSample {
  /** Pelvis, map frame. */
  position: Vec3;
  heading: number;
  /** Origins of the 23 segments in stream order, map frame. */
  joints: Vec3[];
}

const between = (a: number, b: number, part: number) => a + (b - a) * part;
const turn = (a: number, b: number) => Math.atan2(Math.sin(b - a), Math.cos(b - a));
const mix = (a: Vec3, b: Vec3, part: number): Vec3 => [
  between(a[0], b[0], part),
  between(a[1], b[1], part),
  between(a[2], b[2], part),
];

function blend(a: WearerSample, b: WearerSample, part: number): WearerSample {
  return {
    position: mix(a.position, b.position, part),
    heading: a.heading + turn(a.heading, b.heading) * part,
    joints: b.joints.map((joint, i) => mix(a.joints[i] ?? joint, joint, part)),
  };
}

/** Moves from what is shown to the newest sample in the time that samples usually take to come: at most one sample late. */
export class Wearer {
  private from?: WearerSample;
  private to?: WearerSample;
  private at = 0;
  private interval = 50;
  private listeners = new Set<() => void>();
  /** Metres and radians between where the suit believes to be and where it is. */
  drift?: { distance: number; heading: number };

  /** `now` in ms of the animation clock. */
  push(sample: WearerSample, now: number): void {
    const gap = now - this.at;
    if (gap < 500) this.interval = between(this.interval, gap, 0.1);
    // After a pause there is nothing to move through.
    this.from = gap < 500 ? this.shown(now) : undefined;
    this.to = sample;
    this.at = now;
    for (const listener of this.listeners) listener();
  }
  drifted(news: PoseNews): void {
    if (!news.odometry) return;
    const [x, y, z] = news.position;
    const raw = news.odometry.position;
    this.drift = {
      distance: Math.hypot(x - raw[0], y - raw[1], z - raw[2]),
      heading: Math.abs(turn(heading(news.odometry), heading(news))),
    };
  }

  shown(now: number): WearerSample | undefined {
    if (!this.to || !this.from) return this.to;
    const part = (now - this.at) / Math.max(this.interval, 1);
    return part >= 1 ? this.to : blend(this.from, this.to, Math.max(0, part));
  }
  /** Whether `shown` will still change without a new sample. */
  moving(now: number): boolean {
    return this.from !== undefined && now - this.at < this.interval;
  }
  clear(): void {
    this.from = this.to = this.drift = undefined;
    for (const listener of this.listeners) listener();
  }
  onSample(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }
}
