// SPDX-License-Identifier: Apache-2.0
// Where the camera looks from: all in view while nobody has turned it, the wearer when it follows, and softly from one to the other.
import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { type Bounds, holds } from "../bounds";
import type { Vec3 } from "../model";

const kFrom = new Vector3(-0.45, -0.8, 0.85).normalize(); // from the south-west and above
const kEaseMs = 160; // time in which the camera goes 63 % of its way
const kFollowed = 0.8; // m: height of what it looks at when it follows

export class CameraRig {
  readonly camera = new PerspectiveCamera(38, 1, 0.1, 400);
  readonly controls: OrbitControls;
  private goal?: { target: Vector3; distance: number };
  private framed?: Bounds;
  /** Nobody has turned the camera: it keeps everything in view. */
  auto = true;

  constructor(canvas: HTMLElement, onChange: () => void) {
    this.camera.up.set(0, 0, 1);
    this.camera.position.copy(kFrom).multiplyScalar(9);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.05;
    this.controls.minDistance = 1;
    this.controls.maxDistance = 120;
    this.controls.addEventListener("change", onChange);
    this.controls.addEventListener("start", () => {
      this.auto = false;
      this.goal = undefined;
    });
  }

  /** Looks at all of it; `tall` is its height, m. */
  frame(bounds: Bounds, tall: number): void {
    this.framed = bounds;
    const { min, max } = bounds;
    const target = new Vector3((min[0] + max[0]) / 2, (min[1] + max[1]) / 2, tall * 0.35);
    this.goal = { target, distance: this.distanceFor(target, bounds, tall) };
  }
  /** Whether somebody has left what is in view, though all should be. */
  lost(position: Vec3): boolean {
    return this.auto && this.framed !== undefined && !holds(this.framed, position);
  }
  follow(position: Vec3): void {
    this.goal = { target: new Vector3(position[0], position[1], kFollowed), distance: this.goal?.distance ?? this.distance() };
  }
  zoom(factor: number): void {
    this.auto = false;
    this.goal = { target: this.controls.target.clone(), distance: this.distance() / factor };
  }
  resize(width: number, height: number): void {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }
  /** How large a length looks in a view so many px high, px. */
  pixels(length: number, at: Vector3, height: number): number {
    return (length * height) / (2 * this.camera.position.distanceTo(at) * this.tangent());
  }

  /** Goes on for so many ms, or all the way; false when the camera is where it shall be. */
  move(ms: number | "all"): boolean {
    const easing = this.ease(ms === "all" ? 1 : 1 - Math.exp(-ms / kEaseMs));
    this.controls.update();
    return easing;
  }

  private distance(): number {
    return this.camera.position.distanceTo(this.controls.target);
  }
  private tangent(): number {
    return Math.tan((this.camera.fov * Math.PI) / 360);
  }

  /** How far away the box is whole in view from where the camera looks now. */
  private distanceFor(target: Vector3, { min, max }: Bounds, tall: number): number {
    const look = this.camera.position.clone().sub(this.controls.target).normalize();
    const side = new Vector3(0, 0, 1).cross(look).normalize();
    const up = look.clone().cross(side);
    const tangent = this.tangent();
    let distance = 4;
    for (const x of [min[0], max[0]])
      for (const y of [min[1], max[1]])
        for (const z of [0, tall]) {
          const p = new Vector3(x, y, z).sub(target);
          const depth = p.dot(look);
          distance = Math.max(distance, depth + Math.abs(p.dot(up)) / tangent, depth + Math.abs(p.dot(side)) / (tangent * this.camera.aspect));
        }
    return distance * 1.12;
  }

  /** A part of the way to where the camera shall be; false when it is there. */
  private ease(part: number): boolean {
    if (!this.goal) return false;
    const { target, distance } = this.goal;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = offset.length() + (distance - offset.length()) * part;
    const there = this.controls.target.distanceTo(target) < 0.002 && Math.abs(length - distance) < 0.002;
    this.controls.target.lerp(target, part);
    this.camera.position.copy(this.controls.target).addScaledVector(offset.normalize(), length);
    if (there) this.goal = undefined;
    return !there;
  }
}
