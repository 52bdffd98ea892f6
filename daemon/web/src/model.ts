// SPDX-License-Identifier: Apache-2.0
// What the daemon sends; protocol/README.md and daemon/README.md are the specification. Metres, radians, seconds of stream time.

export type Vec2 = [number, number];
export type Vec3 = [number, number, number];
/** w, x, y, z */
export type Quaternion = [number, number, number, number];

export interface Pose {
  position: Vec3;
  orientation: Quaternion;
}

export interface MapObject {
  id: number;
  type: string;
  functions: string[];
  pose: Pose;
  plane?: { normal: Vec3; offset: number };
  corners?: Vec3[];
  size?: Vec2;
  height_assumed?: boolean;
  /** Walls: why it ends at the first and second of its corners; "open": nobody knows whether it goes on. */
  ends?: ("corner" | "inferred" | "open")[];
  sigma?: { position?: number; heading?: number; size?: number[] };
  observations: number;
  first_seen: number;
  last_seen: number;
  visits?: Vec2[];
}

export interface Room {
  id: number;
  polygon: Vec2[];
  area: number;
  height?: number;
  height_assumed?: boolean;
  walls: number[];
  inferred_sides?: number[];
}

export interface Doorway {
  position: Vec2;
  heading: number;
  rooms: number[];
}

export interface MapDocument {
  revision: number;
  /** Tells this run of the daemon from others. */
  run?: string;
  time: number;
  objects: MapObject[];
  rooms: Room[];
  doorways?: Doorway[];
  correction?: Pose;
  graph?: { loop_closures: number; loop_closures_revoked: number; key_poses: number };
}

/** What changed since another revision: of lists with ids only what is new or changed. */
export interface MapDelta extends Partial<MapDocument> {
  revision: number;
  since: number;
  removed?: { objects: number[]; rooms: number[] };
}

/** Of each segment x, y, z, then w, x, y, z. */
export interface BodyNews {
  time: number;
  segments: number[][];
}

export interface LiveEvent {
  number: number;
  event: string;
  time: number;
  message: string;
  object?: number;
  objects?: number[];
  type?: string;
}

export interface PoseNews extends Pose {
  time: number;
  odometry?: Pose;
}

export interface TrackPose extends Pose {
  time: number;
  odometry?: Pose;
}

export interface Status {
  version: string;
  uptime_s: number;
  suit: {
    receiving: boolean;
    transport: string;
    address: string;
    port: number;
    rate_hz?: number;
    silence_s?: number;
    sender?: string;
    refusal?: string;
    wearer: { name?: string; stature?: number };
    stream: { frames: number; lost_samples: number; incomplete: number; datagrams: number };
    socket: { kernel_drops: number };
  };
  tracker: { path_m: number; traces: number; traces_rejected: number; sittings: number; frames: number };
  map: {
    revision: number;
    loop_closures: number;
    loop_closures_revoked: number;
    hand?: { part: string; probability: number };
  };
  clients: { streams: number };
}
