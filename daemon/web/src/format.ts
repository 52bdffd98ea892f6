// SPDX-License-Identifier: Apache-2.0
import type { MapObject, Pose } from "./model";

export const minus = (text: string) => text.replace("-", "\u2212");

export const metres = (value: number, digits = 2) => `${minus(value.toFixed(digits))} m`;
export const degrees = (radians: number, digits = 0) => `${minus(((radians * 180) / Math.PI).toFixed(digits))}°`;

/** A length with its standard deviation: "1.06 ± 0.05". */
export const plusMinus = (value: number, sigma?: number) =>
  minus(value.toFixed(2)) + (sigma === undefined ? "" : ` ± ${Math.max(sigma, 0.01).toFixed(2)}`);

/** Stream time as a clock: "4:07", "1:02:33". */
export function clock(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const two = (n: number) => String(n).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** How long something has lasted: "8 s", "3 min", "2 h 5 min". */
export function duration(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)} min`;
  return `${Math.floor(whole / 3600)} h ${Math.floor(whole / 60) % 60} min`;
}

export const timeOfDay = (ms: number) =>
  new Date(ms).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit", second: "2-digit", hour12: false });

const typeNames: Record<string, string> = { wall: "Wall", table: "Table", screen: "Screen", chair: "Seat", door: "Door" };
const plurals: Record<string, string> = { wall: "Walls", table: "Tables", screen: "Screens", chair: "Seats", door: "Doors" };
const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

export const typeName = (type: string) => typeNames[type] ?? capital(type);
export const typePlural = (type: string) => plurals[type] ?? capital(type);
export const objectName = (object: MapObject) => `${typeName(object.type)} ${object.id}`;

const functionTexts: Record<string, string> = {
  sit: "one can sit here",
  place: "one can put things down here",
  view: "something is shown here",
  bound: "bounds the room",
};
export const functionText = (name: string) => functionTexts[name] ?? name;

/** The length of a wall; where one of its ends was not touched it is a lower bound, and its standard deviation says how far it may go on. */
export function wallLength(object: MapObject, withSigma: boolean): string {
  const [length] = object.size!;
  if (object.ends?.includes("open")) return `≥ ${metres(length)}`;
  return withSigma ? `${plusMinus(length, object.sigma?.size?.[0])} m` : metres(length);
}

/** What a list shows of an object in a few characters. */
export function shortSize(object: MapObject): string {
  if (object.type === "chair") return `${object.pose.position[2].toFixed(2)} m high`;
  if (!object.size) return "";
  const [long, short] = object.size;
  return object.type === "wall" ? wallLength(object, false) : `${long.toFixed(2)} × ${short.toFixed(2)} m`;
}

/** Rotation about the vertical, rad. */
export function heading({ orientation: [w, x, y, z] }: Pose): number {
  return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
}

export const percent = (part: number) => `${(100 * part).toFixed(part > 0 && part < 0.0995 ? 1 : 0)} %`;
