// SPDX-License-Identifier: Apache-2.0
// The wearer: a capsule for each bone between the suit's 23 segments.
import { CapsuleGeometry, Group, Mesh, MeshLambertMaterial, SphereGeometry, Vector3 } from "three";
import type { WearerSample } from "../live";
import type { Vec3 } from "../model";
import type { Palette } from "./palette";

/** Origin of a segment, origin of the next, radius in m; in stream order (core/body.hpp). */
const kBones: readonly (readonly [number, number, number])[] = [
  [0, 1, 0.1], [1, 2, 0.1], [2, 3, 0.105], [3, 4, 0.11], [4, 5, 0.075], [5, 6, 0.05],
  [4, 7, 0.06], [7, 8, 0.055], [8, 9, 0.045], [9, 10, 0.036],
  [4, 11, 0.06], [11, 12, 0.055], [12, 13, 0.045], [13, 14, 0.036],
  [0, 15, 0.08], [15, 16, 0.072], [16, 17, 0.052], [17, 18, 0.038],
  [0, 19, 0.08], [19, 20, 0.072], [20, 21, 0.052], [21, 22, 0.038],
];
const kHandBones: readonly (readonly [number, number])[] = [[9, 10], [13, 14]];
const kHandLength = 0.16;
const kHeadRadius = 0.1;
const kUp = new Vector3(0, 1, 0);

export class Figure {
  readonly group = new Group();
  private material: MeshLambertMaterial;
  private bones: { mesh: Mesh; length: number }[] = [];
  private hands: Mesh[] = [];
  private head: Mesh;

  constructor(palette: Palette) {
    this.material = new MeshLambertMaterial({ color: palette.get("wearer") });
    this.bones = kBones.map(() => ({ mesh: this.add(new Mesh(undefined, this.material)), length: -1 }));
    this.hands = kHandBones.map(() => this.add(new Mesh(new CapsuleGeometry(0.032, kHandLength - 0.06, 4, 10), this.material)));
    this.head = this.add(new Mesh(new SphereGeometry(kHeadRadius, 24, 18), this.material));
    this.head.scale.set(0.9, 0.85, 1.15);
    this.group.visible = false;
  }

  recolour(palette: Palette): void {
    this.material.color.copy(palette.get("wearer"));
  }

  show(sample: WearerSample | undefined): void {
    this.group.visible = sample !== undefined;
    if (sample) this.pose(sample.joints);
  }

  private add(mesh: Mesh): Mesh {
    this.group.add(mesh);
    return mesh;
  }

  private pose(joints: Vec3[]): void {
    const at = (i: number) => new Vector3(...(joints[i] ?? [0, 0, 0]));
    kBones.forEach(([from, to, radius], i) => {
      const bone = this.bones[i];
      if (!bone) return;
      const a = at(from);
      const b = at(to);
      const length = a.distanceTo(b);
      // Bones keep their length; what is measured anew is drawn anew.
      if (Math.abs(length - bone.length) > 0.01) {
        bone.mesh.geometry.dispose();
        bone.mesh.geometry = new CapsuleGeometry(radius, length, 4, 12);
        bone.length = length;
      }
      bone.mesh.position.copy(a).lerp(b, 0.5);
      bone.mesh.quaternion.setFromUnitVectors(kUp, b.sub(a).normalize());
    });
    kHandBones.forEach(([elbow, wrist], i) => {
      const direction = at(wrist).sub(at(elbow)).normalize();
      this.hands[i]?.position.copy(at(wrist)).addScaledVector(direction, kHandLength / 2);
      this.hands[i]?.quaternion.setFromUnitVectors(kUp, direction);
    });
    const neck = at(6).sub(at(5)).normalize();
    this.head.position.copy(at(6)).addScaledVector(neck, kHeadRadius);
  }
}
